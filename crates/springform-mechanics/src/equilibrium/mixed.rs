//! Mixed steps for stiff rods: tensions as unknowns of their own.
//!
//! Newton's method on the energy creeps where springs are far stiffer than what bends: every step that turns a link also
//! stretches it. Magisano, Leonetti & Garcea, "Advantages of the mixed format in geometrically nonlinear analysis of
//! beams and shells using solid finite elements", 2017: tensions that follow the linear step, instead of those that the
//! new lengths give, make the stiffness across springs, and steps may be long. The steps don't watch the energy;
//! who calls decides whether the shape that they end at is worth having.

use super::descent::Hill;
use super::tangent::{Tangent, along, block, links, moduli, own_bend_stiffness};
use crate::sparse::Lanes;
use crate::vector::{dot, length};

/// Most mixed steps.
pub(super) const MOST_MIXED: u32 = 40;

/// Most that a node moves in a step, as a share of the extent of the net.
const LONGEST: f64 = 0.1;

/// Damping as a share of the stiffness of bends, the first at which the tangent is positive definite.
const DAMPINGS: [f64; 6] = [0.0, 1e-6, 1e-4, 1e-2, 1.0, 1e2];

/// Positions after mixed steps, and how many; the residual may have fallen or not.
pub(super) fn mixed(
    hill: Hill<'_>,
    tangent: &mut Tangent,
    positions: &[Lanes],
    tolerance: f64,
    limit: u32,
) -> (Vec<Lanes>, u32) {
    let Hill { network, elements, supports, layout, .. } = hill;
    let mut positions = positions.to_vec();
    let mut pulls = Vec::new();
    // Not those of the start, which may be drawn far longer or shorter than stiff springs are.
    let mut tensions = vec![0.0; network.springs.len()];
    for iteration in 0..limit {
        let (_, residual) = hill.look(&positions, &mut pulls);
        if residual <= tolerance || !residual.is_finite() {
            return (positions, iteration);
        }
        let factored = DAMPINGS.into_iter().any(|damping| {
            let springs = (0..network.springs.len()).map(|spring| {
                let along = along(network, spring, &positions);
                let size = length(along);
                let across = if size > 0.0 { tensions[spring] / size } else { 0.0 };
                (block(along, size, moduli(network, spring, size)[0], across), 0.0)
            });
            let bends = elements.bends.iter().map(|bend| {
                let stiffness = bend.bending(links(bend, &positions), false).stiffness;
                (stiffness, damping * own_bend_stiffness(bend))
            });
            tangent.factor(layout, supports, springs, bends).is_ok()
        });
        if !factored {
            return (positions, iteration);
        }
        tangent.solve(supports, &mut pulls);
        let farthest = pulls.iter().map(|&[x, y, z, _]| length([x, y, z])).fold(0.0, f64::max);
        let share = (LONGEST * extent(&positions) / farthest).min(1.0);
        for (spring, tension) in tensions.iter_mut().enumerate() {
            let (now, moved) = (along(network, spring, &positions), along(network, spring, &pulls));
            let size = length(now);
            let [axial, _] = moduli(network, spring, size);
            let longer = if size > 0.0 { dot(now, moved) / size } else { 0.0 };
            let reached = network.force_at(spring, size) + axial * longer;
            *tension += share * (reached - *tension);
        }
        for (position, step) in positions.iter_mut().zip(&pulls) {
            (0..3).for_each(|axis| position[axis] += share * step[axis]);
        }
        supports.put_back(network, &mut positions);
    }
    (positions, limit)
}

/// Largest extent of the nodes along an axis [m].
fn extent(positions: &[Lanes]) -> f64 {
    let along = |axis: usize| {
        let along = || positions.iter().map(|position| position[axis]);
        along().fold(f64::MIN, f64::max) - along().fold(f64::MAX, f64::min)
    };
    (0..3).map(along).fold(0.0, f64::max)
}
