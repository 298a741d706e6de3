//! Mixed steps for stiff rods: tensions as unknowns of their own.
//!
//! Newton's method on the energy creeps where springs are far stiffer than what bends: every step that turns a link also
//! stretches it. Magisano, Leonetti & Garcea, "Advantages of the mixed format in geometrically nonlinear analysis of
//! beams and shells using solid finite elements", 2017: tensions that follow the linear step, instead of those that the
//! new lengths give, make the stiffness across springs, and steps may be long. What a long step stretches is given back
//! before its energy is looked at, as in the second-order corrections of Fletcher, "Practical methods of optimization",
//! 1987; a step that still does not lower the energy is shortened.

use super::descent::Hill;
use super::elements::vector;
use super::newton::Change;
use super::tangent::{Tangent, along, block, links, moduli, own_bend_stiffness};
use crate::network::Sense;
use crate::sparse::Lanes;
use crate::vector::{dot, length};

/// Most mixed steps.
pub(super) const MOST_MIXED: u32 = 400;

/// Most that a node moves in a step, and the move that is too short to go on with, as shares of the extent of the net.
const LONGEST: f64 = 0.1;
const SHORTEST: f64 = 1e-7;

/// Damping as a share of the stiffness of bends and of what pushing springs do across: the least, the most, and its
/// factor from one that leaves the tangent indefinite to the next.
const LEAST_DAMPING: f64 = 1e-7;
const MOST_DAMPING: f64 = 1e3;
const MORE_DAMPING: f64 = 10.0;

/// Times that a step gives back what it stretched.
const MOST_RESTORED: u32 = 3;

/// Positions after mixed steps, whose energy is not above the start's, and how many.
pub(super) fn mixed(
    hill: Hill<'_>,
    tangent: &mut Tangent,
    positions: &mut Vec<Lanes>,
    tolerance: f64,
    limit: u32,
) -> u32 {
    let mut walk = Walk { hill, tangent, damping: 0.0 };
    // Not those of the start, which may be drawn far longer or shorter than stiff springs are.
    let mut tensions = vec![0.0; hill.network.springs.len()];
    let mut radius = LONGEST * extent(positions);
    let least = SHORTEST * extent(positions);
    let mut pulls = Vec::new();
    let (_, mut residual) = hill.look(positions, &mut pulls);
    for iteration in 0..limit {
        if residual <= tolerance || !residual.is_finite() || !walk.factor(positions, &tensions) {
            return iteration;
        }
        let mut step = pulls.clone();
        walk.tangent.solve(hill.supports, &mut step);
        let farthest = step.iter().map(|&step| length(vector(step))).fold(0.0, f64::max);
        let to_edge = radius / farthest;
        if !(farthest > 0.0 && farthest.is_finite()) {
            return iteration;
        }
        // On a saddle the lowest place within reach lies at its edge.
        let mut share = if walk.damping > 0.0 { to_edge } else { to_edge.min(1.0) };
        let reached = walk.reached(positions, &step);
        let taken = loop {
            if share < 1.0 && share * farthest < least {
                return iteration;
            }
            let part = share.min(1.0);
            let followed: Vec<f64> =
                tensions.iter().zip(&reached).map(|(now, reached)| now + part * (reached - now)).collect();
            let next = positions.iter().zip(&step).map(|(at, step)| sum(at, share, step)).collect();
            if let Some(taken) = walk.lower(positions, residual, next, &followed, &mut pulls) {
                tensions = followed;
                break taken;
            }
            share = 0.25 * share.min(to_edge);
        };
        (*positions, residual) = taken;
        radius = (4.0 * share * farthest).clamp(least, LONGEST * extent(positions));
    }
    limit
}

/// Steps with tensions of their own.
struct Walk<'a> {
    hill: Hill<'a>,
    tangent: &'a mut Tangent,
    damping: f64,
}

impl Walk<'_> {
    /// The next positions, once they have given back what the step stretched, and their residual and `pulls`; `None` if
    /// their energy is not below that of `from`.
    fn lower(
        &mut self,
        from: &[Lanes],
        residual: f64,
        mut next: Vec<Lanes>,
        tensions: &[f64],
        pulls: &mut Vec<Lanes>,
    ) -> Option<(Vec<Lanes>, f64)> {
        let hill = self.hill;
        for restored in 0..=MOST_RESTORED {
            hill.supports.put_back(hill.network, &mut next);
            let change = Change::new(hill, from, &next);
            if change.energy <= change.noise {
                let (_, next_residual) = hill.look(&next, pulls);
                // Near equilibrium rounding hides the fall of energy, not that of the residual.
                let falls = change.energy < -change.noise || next_residual < residual;
                if falls && next_residual.is_finite() {
                    return Some((next, next_residual));
                }
            }
            if restored == MOST_RESTORED || !self.factor(&next, tensions) {
                break;
            }
            let mut moves = excess(hill, &next, tensions);
            self.tangent.solve(hill.supports, &mut moves);
            next.iter_mut().zip(&moves).for_each(|(position, moved)| *position = sum(position, 1.0, moved));
        }
        hill.look(from, pulls);
        None
    }

    /// Factors the tangent with given tensions and the least damping, of those tried, that makes it positive definite.
    fn factor(&mut self, positions: &[Lanes], tensions: &[f64]) -> bool {
        let Hill { network, elements, supports, layout, .. } = self.hill;
        let mut damping = if self.damping > LEAST_DAMPING { self.damping / MORE_DAMPING } else { 0.0 };
        while damping <= MOST_DAMPING {
            let springs = (0..network.springs.len()).map(|spring| {
                let along = along(network, spring, positions);
                let size = length(along);
                let across = if size > 0.0 { tensions[spring] / size } else { 0.0 };
                let tangent = block(along, size, moduli(network, spring, size)[0], across);
                (tangent, damping * (-across).max(0.0))
            });
            let bends = elements.bends.iter().map(|bend| {
                let stiffness = bend.bending(links(bend, positions), false).stiffness;
                (stiffness, damping * own_bend_stiffness(bend))
            });
            if self.tangent.factor(layout, supports, springs, bends).is_ok() {
                self.damping = damping;
                return true;
            }
            damping = (MORE_DAMPING * damping).max(LEAST_DAMPING);
        }
        false
    }

    /// Tensions after the whole of a linear step.
    fn reached(&self, positions: &[Lanes], step: &[Lanes]) -> Vec<f64> {
        let network = self.hill.network;
        let reached = |spring| {
            let (now, moved) = (along(network, spring, positions), along(network, spring, step));
            let size = length(now);
            let [axial, _] = moduli(network, spring, size);
            let longer = if size > 0.0 { dot(now, moved) / size } else { 0.0 };
            let reached = network.force_at(spring, size) + axial * longer;
            match network.sense[spring] {
                Sense::Tension => reached.max(0.0),
                Sense::Both => reached,
                Sense::Compression => reached.min(0.0),
            }
        };
        (0..network.springs.len()).map(reached).collect()
    }
}

/// Pulls of springs beyond given tensions, one of a node.
pub(super) fn excess(hill: Hill<'_>, positions: &[Lanes], tensions: &[f64]) -> Vec<Lanes> {
    let network = hill.network;
    let mut pulls = vec![[0.0; 4]; positions.len()];
    for (spring, &[a, b]) in network.springs.iter().enumerate() {
        let along = along(network, spring, positions);
        let size = length(along);
        let density =
            if size > 0.0 { (network.force_at(spring, size) - tensions[spring]) / size } else { 0.0 };
        for axis in 0..3 {
            pulls[a as usize][axis] += density * along[axis];
            pulls[b as usize][axis] -= density * along[axis];
        }
    }
    hill.supports.keep_free(&mut pulls);
    pulls
}

/// Largest extent of the nodes along an axis [m].
pub(super) fn extent(positions: &[Lanes]) -> f64 {
    let along = |axis: usize| {
        let along = || positions.iter().map(|position| position[axis]);
        along().fold(f64::MIN, f64::max) - along().fold(f64::MAX, f64::min)
    };
    (0..3).map(along).fold(0.0, f64::max)
}

/// a + s b.
fn sum(a: &Lanes, s: f64, b: &Lanes) -> Lanes {
    std::array::from_fn(|lane| a[lane] + s * b[lane])
}
