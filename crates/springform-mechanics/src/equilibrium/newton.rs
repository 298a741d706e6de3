//! Newton's method on the potential energy, damped after Levenberg and Marquardt.
//!
//! The undamped exact tangent is tried first. Where it is indefinite, or its step does not lower the energy, the
//! transverse part of pushing springs is left out (Choi & Ko, "Stable but responsive cloth", 2002) and a share of each
//! node's own stiffness is added to the diagonal (Marquardt, "An algorithm for least-squares estimation of nonlinear
//! parameters", 1963), more and more until the energy falls.

use super::descent::Hill;
use super::elements::vector;
use super::mixed::extent;
use super::state::Settings;
use super::tangent::{Tangent, along, links, own_bend_stiffness, own_stiffness, spring_tangent};
use crate::network::Network;
use crate::sparse::Lanes;
use crate::vector::{Vector, add, dot, length, scale, subtract};

/// Damping after a refused undamped step, and the least that is kept, as a share of a node's own stiffness.
const LEAST_DAMPING: f64 = 1e-9;

/// Damping beyond which a step is too short to matter.
const MOST_DAMPING: f64 = 1e12;

/// Change of strain below which the energy of a curve is integrated and not a difference.
const SHORT: f64 = 1e-3;

/// Short damped steps in a row after which the exact tangent tells whether they creep off a saddle, where damping lets
/// each go a few hundredths farther than the last; and how short, as a share of the extent of the net.
const CREEPING: u32 = 10;
const SHORT_STEP: f64 = 1e-3;

/// Workspace of Newton's method.
#[derive(Clone, PartialEq, Debug, Default)]
pub(super) struct Newton {
    pub(super) tangent: Tangent,
    pulls: Vec<Lanes>,
    next_pulls: Vec<Lanes>,
    next: Vec<Lanes>,
    step: Vec<Lanes>,
}

/// How Newton's method ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Ended {
    /// The residual is within the tolerance.
    Converged,
    /// The most steps were made.
    Limit,
    /// The energy falls no further and the tangent is positive definite: rounding.
    Rounding,
    /// The energy falls no further and the tangent holds no step.
    Singular,
    /// Steps creep where the exact tangent is indefinite.
    Saddle,
    /// A number overflowed.
    Overflow,
}

impl Newton {
    /// Moves positions by Newton steps, for `limit` steps at most; how it ended and the steps made. Ends on saddles only if
    /// it is to `leave_saddles` to others.
    pub(super) fn solve(
        &mut self,
        hill: Hill<'_>,
        positions: &mut Vec<Lanes>,
        settings: &Settings,
        limit: u32,
        leave_saddles: bool,
    ) -> (Ended, u32) {
        let mut damping = 0.0;
        let mut short_steps = 0;
        let short = SHORT_STEP * extent(positions);
        let mut pulls = std::mem::take(&mut self.pulls);
        let (_, mut residual) = hill.look(positions, &mut pulls);
        let mut iterations = 0;
        let ended = loop {
            if residual <= settings.tolerance {
                break Ended::Converged;
            }
            if !residual.is_finite() {
                break Ended::Overflow;
            }
            if iterations >= limit {
                break Ended::Limit;
            }
            let Some((used, next_residual)) = self.descend(hill, positions, &pulls, residual, damping) else {
                let solid = self.aim(hill, positions, &pulls, 0.0);
                break if solid { Ended::Rounding } else { Ended::Singular };
            };
            std::mem::swap(positions, &mut self.next);
            std::mem::swap(&mut pulls, &mut self.next_pulls);
            residual = next_residual;
            damping = if used > LEAST_DAMPING { 0.1 * used } else { 0.0 };
            iterations += 1;
            let farthest = self.step.iter().map(|&step| length(vector(step))).fold(0.0, f64::max);
            short_steps = if used > 0.0 && farthest < short { short_steps + 1 } else { 0 };
            if leave_saddles && short_steps == CREEPING && residual > settings.tolerance {
                if !self.aim(hill, positions, &pulls, 0.0) {
                    break Ended::Saddle;
                }
                short_steps = 0;
            }
        };
        self.pulls = pulls;
        (ended, iterations)
    }

    /// A step that lowers the energy, in `next` and `next_pulls`: the damping that it took and the residual there.
    fn descend(
        &mut self,
        hill: Hill<'_>,
        positions: &[Lanes],
        pulls: &[Lanes],
        residual: f64,
        damping: f64,
    ) -> Option<(f64, f64)> {
        let mut damping = damping;
        while damping <= MOST_DAMPING {
            if self.aim(hill, positions, pulls, damping) {
                let fall: f64 = self.step.iter().zip(pulls).map(|(step, pull)| product(step, pull)).sum();
                self.next.clear();
                self.next
                    .extend(positions.iter().zip(&self.step).map(|(position, step)| sum(position, step)));
                hill.supports.put_back(hill.network, &mut self.next);
                let (_, next_residual) = hill.look(&self.next, &mut self.next_pulls);
                let change = Change::new(hill, positions, &self.next);
                let falls = change.energy <= -1e-4 * fall && next_residual.is_finite();
                // Near equilibrium rounding hides the fall of energy, not that of the residual.
                let level = change.energy <= change.noise && next_residual < residual;
                if falls || level {
                    return Some((damping, next_residual));
                }
            }
            damping = if damping == 0.0 { LEAST_DAMPING } else { 10.0 * damping };
        }
        None
    }

    /// Newton's step in `step`; false if the tangent holds none.
    fn aim(&mut self, hill: Hill<'_>, positions: &[Lanes], pulls: &[Lanes], damping: f64) -> bool {
        let Hill { network, elements, supports, layout, .. } = hill;
        // The exact tangent without damping; with damping, one that is positive definite.
        let clamped = damping > 0.0;
        let springs = (0..network.springs.len()).map(|spring| {
            let along = along(network, spring, positions);
            let own = damping * own_stiffness(network, spring, length(along));
            (spring_tangent(network, spring, along, clamped), own)
        });
        let bends = elements.bends.iter().map(|bend| {
            let stiffness = bend.bending(links(bend, positions), clamped).stiffness;
            (stiffness, damping * own_bend_stiffness(bend))
        });
        if self.tangent.factor(layout, supports, springs, bends).is_err() {
            return false;
        }
        self.step.clear();
        self.step.extend_from_slice(pulls);
        self.tangent.solve(supports, &mut self.step);
        true
    }
}

/// Change of the potential energy [J] of springs, rods and dead loads between positions.
pub(super) struct Change {
    pub(super) energy: f64,
    /// Rounding of `energy`.
    pub(super) noise: f64,
}

impl Change {
    /// Sums the changes of all parts, which are far smaller than the parts themselves.
    pub(super) fn new(hill: Hill<'_>, from: &[Lanes], to: &[Lanes]) -> Change {
        let network = hill.network;
        let mut change = Change { energy: 0.0, noise: 0.0 };
        let mut add_part = |part: f64, noise: f64| {
            change.energy += part;
            change.noise += 1e-14 * (part.abs() + noise);
        };
        let mut moves: Vec<Lanes> = from.iter().zip(to).map(|(from, to)| difference(to, from)).collect();
        // Where supports hold, rounding moves nodes against reactions, which may be large.
        hill.supports.keep_free(&mut moves);
        for (spring, &[a, b]) in network.springs.iter().enumerate() {
            let moved = subtract(vector(moves[b as usize]), vector(moves[a as usize]));
            let ends = [from, to].map(|positions| along(network, spring, positions));
            let (part, noise) = spring_change(network, spring, ends, moved);
            add_part(part, noise);
        }
        for bend in &hill.elements.bends {
            let [before, after] =
                [from, to].map(|positions| bend.bending(links(bend, positions), false).energy);
            // The energy is a difference of lengths that are far larger than itself.
            let [a, b] = bend.lengths;
            add_part(after - before, 0.02 * 2.0 * bend.stiffness * (a + b) / (a * b));
        }
        for (moved, load) in moves.iter().zip(hill.elements.loads()) {
            add_part(-product(load, moved), 0.0);
        }
        change
    }
}

/// Change of a spring's energy, and the size of what its rounding comes from; `moved` holds digits that the difference
/// of both directions has lost.
fn spring_change(network: &Network<'_>, spring: usize, ends: [Vector; 2], moved: Vector) -> (f64, f64) {
    let lengths = ends.map(length);
    let total = lengths[0] + lengths[1];
    let longer = if total > 0.0 { dot(moved, add(scale(ends[0], 2.0), moved)) / total } else { 0.0 };
    let [first, last] = lengths.map(|length| network.force_at(spring, length));
    let pulls = first != 0.0 && last != 0.0;
    // While it pulls all the way, the force is linear, or a curve.
    let part = if pulls && network.curve_of(spring).is_none() {
        0.5 * (first + last) * longer
    } else if pulls && longer.abs() <= SHORT * network.rest_length[spring] {
        // Gauss's rule of two points is exact along a cubic; a difference of areas would lose the digits of short steps.
        let middle = lengths[0] + 0.5 * longer;
        let at = |side: f64| network.force_at(spring, middle + side * longer / 12.0_f64.sqrt());
        0.5 * (at(-1.0) + at(1.0)) * longer
    } else {
        network.energy_at(spring, lengths[1]) - network.energy_at(spring, lengths[0])
    };
    (part, network.stiffness[spring] * total * longer.abs())
}

fn product(a: &Lanes, b: &Lanes) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn difference(a: &Lanes, b: &Lanes) -> Lanes {
    std::array::from_fn(|lane| a[lane] - b[lane])
}

fn sum(a: &Lanes, b: &Lanes) -> Lanes {
    std::array::from_fn(|lane| a[lane] + b[lane])
}
