//! Whether a rest is stable, and a way off it if it is not.
//!
//! A straight strut above its buckling load is in balance, and Newton's steps end there: only the second change of the
//! energy tells that it is no rest. Inverse iteration with the exact tangent, shifted until it is positive definite, finds
//! the direction of least curvature (Wilkinson, "The algebraic eigenvalue problem", 1965), and the net goes along it as
//! far as the energy falls. What turns on the way also stretches, by the square of the way, which hides the fall where links
//! are stiff and the load is just above the one that buckles: every move gives back what it stretched.

use super::descent::Hill;
use super::elements::vector;
use super::mixed::{excess, extent};
use super::newton::Change;
use super::tangent::{Tangent, along, links, moduli, own_bend_stiffness, own_stiffness, spring_tangent};
use crate::network::{Network, Sense};
use crate::sparse::Lanes;
use crate::vector::{dot, length};

/// The least shift, as a share of what may make the tangent indefinite, and its factor from one to the next.
const LEAST_SHIFT: f64 = 1e-10;
const SHIFT_FACTOR: f64 = 4.0;

/// Shifts that are tried; the last is larger than what any tangent can need.
const MOST_SHIFTS: u32 = 20;

/// Share of a spring's own stiffness in the shift, for nodes that slack springs alone hold.
const SLACK_SHARE: f64 = 1e-6;

/// Inverse iterations towards the direction of least curvature.
const INVERSE_STEPS: u32 = 40;

/// Shortest and longest move off an unstable rest, as shares of the extent of the net; each is twice the last.
const SHORTEST_MOVE: f64 = 1e-7;
const LONGEST_MOVE: f64 = 0.1;

/// Times that a move gives back what it stretched.
const MOST_RESTORED: u32 = 2;

/// Whether a net has anything that can make a rest unstable: springs that may push, or rods. A spring that pulls can't,
/// nor can dead loads.
pub(super) fn may_be_unstable(network: &Network<'_>) -> bool {
    !network.rods.is_empty() || network.sense.iter().any(|&sense| sense != Sense::Tension)
}

/// Whether anything in a net pushes: rods, or springs by more than the residual lets pass, `tolerance` times the scale of
/// forces. Springs that carry nothing come out on either side of zero.
pub(super) fn pushes(hill: Hill<'_>, positions: &[Lanes], tolerance: f64) -> bool {
    let Hill { network, least_force, .. } = hill;
    let (mut least, mut most) = (0.0_f64, least_force);
    for spring in 0..network.springs.len() {
        let force = network.force_at(spring, length(along(network, spring, positions)));
        (least, most) = (least.min(force), most.max(force.abs()));
    }
    !network.rods.is_empty() || least < -tolerance * most
}

/// Positions of a lower energy beside an unstable rest; `None` if the rest is stable as far as rounding shows.
pub(super) fn way_off(hill: Hill<'_>, tangent: &mut Tangent, positions: &[Lanes]) -> Option<Vec<Lanes>> {
    if factor(hill, tangent, positions, 0.0) {
        return None;
    }
    let mut shift = LEAST_SHIFT;
    let shifted = (0..MOST_SHIFTS).any(|_| {
        let factored = factor(hill, tangent, positions, shift);
        shift *= SHIFT_FACTOR;
        factored
    });
    if !shifted {
        return None;
    }
    // Different at each node and axis, so that no symmetry hides the direction.
    let mut way: Vec<Lanes> = (0..positions.len())
        .map(|node| [1.0, 1.1, 1.3, 0.0].map(|part: f64| part * (1.0 + 0.1 * (node % 7) as f64)))
        .collect();
    hill.supports.keep_free(&mut way);
    for _ in 0..INVERSE_STEPS {
        tangent.solve(hill.supports, &mut way);
        let longest = way.iter().map(|way| length(vector(*way))).fold(0.0, f64::max);
        if !(longest > 0.0 && longest.is_finite()) {
            return None;
        }
        way.iter_mut().flatten().for_each(|part| *part /= longest);
    }
    lowest_along(hill, tangent, positions, &way)
}

/// The first low place along a direction, either way, if the energy falls at all; the tangent is factored with its shift.
fn lowest_along(
    hill: Hill<'_>,
    tangent: &mut Tangent,
    positions: &[Lanes],
    way: &[Lanes],
) -> Option<Vec<Lanes>> {
    let extent = extent(positions);
    let network = hill.network;
    let tensions: Vec<f64> = (0..network.springs.len())
        .map(|spring| network.force_at(spring, length(along(network, spring, positions))))
        .collect();
    let mut lowest: Option<(f64, Vec<Lanes>)> = None;
    let mut share = SHORTEST_MOVE;
    while share <= LONGEST_MOVE {
        let moved = [share * extent, -share * extent].map(|size| {
            let step =
                |(position, way): (&Lanes, &Lanes)| std::array::from_fn(|at| position[at] + size * way[at]);
            let mut moved: Vec<Lanes> = positions.iter().zip(way).map(step).collect();
            hill.supports.put_back(network, &mut moved);
            let mut lowest = (Change::new(hill, positions, &moved), moved);
            for _ in 0..MOST_RESTORED {
                let moved = restored(hill, tangent, way, &lowest.1, &tensions);
                let change = Change::new(hill, positions, &moved);
                if change.energy >= lowest.0.energy {
                    break;
                }
                lowest = (change, moved);
            }
            lowest
        });
        let [one, other] = moved;
        let (change, moved) = if other.0.energy < one.0.energy { other } else { one };
        let falls = change.energy < -10.0 * change.noise;
        match &lowest {
            Some((least, _)) if !falls || change.energy >= *least => break,
            _ if falls => lowest = Some((change.energy, moved)),
            _ => {}
        }
        share *= 2.0;
    }
    lowest.map(|(_, moved)| moved)
}

/// Positions that have given back what springs were stretched beyond their tensions, without a move along the way.
fn restored(
    hill: Hill<'_>,
    tangent: &mut Tangent,
    way: &[Lanes],
    positions: &[Lanes],
    tensions: &[f64],
) -> Vec<Lanes> {
    let mut moves = excess(hill, positions, tensions);
    tangent.solve(hill.supports, &mut moves);
    let product =
        |a: &[Lanes], b: &[Lanes]| -> f64 { a.iter().zip(b).map(|(&a, &b)| dot(vector(a), vector(b))).sum() };
    let share = product(&moves, way) / product(way, way);
    let mut restored: Vec<Lanes> = positions
        .iter()
        .zip(moves.iter().zip(way))
        .map(|(position, (moved, way))| std::array::from_fn(|at| position[at] + moved[at] - share * way[at]))
        .collect();
    hill.supports.put_back(hill.network, &mut restored);
    restored
}

/// Factors the exact tangent plus a share of what may make it indefinite; false if that is not positive definite.
pub(super) fn factor(hill: Hill<'_>, tangent: &mut Tangent, positions: &[Lanes], shift: f64) -> bool {
    let Hill { network, elements, supports, layout, .. } = hill;
    let springs = (0..network.springs.len()).map(|spring| {
        let along = along(network, spring, positions);
        let size = length(along);
        // What springs do across their direction may make a tangent indefinite.
        let across = moduli(network, spring, size)[1].abs();
        let own = across.max(SLACK_SHARE * own_stiffness(network, spring, size));
        (spring_tangent(network, spring, along, false), shift * own)
    });
    let bends = elements.bends.iter().map(|bend| {
        let stiffness = bend.bending(links(bend, positions), false).stiffness;
        (stiffness, shift * own_bend_stiffness(bend))
    });
    tangent.factor(layout, supports, springs, bends).is_ok()
}
