//! Springs of any law: Newton's method on the potential energy, damped after Levenberg and Marquardt.
//!
//! The undamped exact tangent is tried first. Where it is indefinite, or its step does not lower the energy, the
//! transverse part of pushing springs is left out (Choi & Ko, "Stable but responsive cloth", 2002) and a share of each
//! node's own stiffness is added to the diagonal (Marquardt, "An algorithm for least-squares estimation of nonlinear
//! parameters", 1963), more and more until the energy falls.
//!
//! Stiff cords that have to swing far make the energy a narrow, curved valley, along which such steps are short. A net
//! that has not converged soon is therefore moved by an interior-point method first, which takes tensions as unknowns
//! of their own: a cord may be too long for its tension on the way, so no valley is followed. So a net needs no good
//! start: springs may be slack, straight under transverse load, or far off.

use super::interior::{MOST_INTERIOR, interior};
use super::state::{Equilibrium, Settings, Status, residuals};
use super::tangent::{FreeAxes, along, own_stiffness, spring_tangent};
use crate::network::Network;
use crate::vector::{Vector, add, dot, largest, length, scale, subtract};

/// Damping after a refused undamped step, and the least that is kept, as a share of a node's own stiffness.
const LEAST_DAMPING: f64 = 1e-9;

/// Damping beyond which a step is too short to matter.
const MOST_DAMPING: f64 = 1e12;

/// Part of a spring's length by which nodes that coincide are parted, so that it has a direction.
const PARTING: f64 = 1e-6;

/// Newton steps after which tensions become unknowns of their own.
const PATIENCE: u32 = 60;

pub(super) fn solve(network: &Network<'_>, settings: &Settings) -> Equilibrium {
    let free = FreeAxes::new(network);
    let first = Settings { iterations: settings.iterations.min(PATIENCE), ..*settings };
    let result = newton(network, &free, &first, parted(network), 0);
    let overflowed = !result.residual.is_finite();
    if result.status == Status::Converged || overflowed || result.iterations >= settings.iterations {
        return result;
    }
    let limit = MOST_INTERIOR.min(settings.iterations - result.iterations);
    let Some((moved, steps)) = interior(network, &free, &result.positions, limit) else {
        return newton(network, &free, settings, result.positions, result.iterations);
    };
    let iterations = result.iterations + steps;
    let lower = Change::new(network, &result.positions, &moved).energy < 0.0;
    newton(network, &free, settings, if lower { moved } else { result.positions }, iterations)
}

/// Newton steps from positions that took some iterations.
fn newton(
    network: &Network<'_>,
    free: &FreeAxes,
    settings: &Settings,
    mut positions: Vec<Vector>,
    mut iterations: u32,
) -> Equilibrium {
    let mut damping = 0.0;
    loop {
        let result = Equilibrium::at(network, positions, Status::Converged, iterations);
        if result.residual <= settings.tolerance || result.status != Status::Converged {
            return result;
        }
        if iterations >= settings.iterations {
            return Equilibrium { status: Status::IterationLimit, ..result };
        }
        let Some((moved, used)) = descend(network, free, &result, damping) else {
            // A tangent that is positive definite leaves nothing but rounding in the way.
            let forces = residuals(network, &result.positions);
            let solid = newton_step(network, free, &result.positions, &forces, 0.0).is_some();
            let status = if solid { Status::IterationLimit } else { Status::Singular };
            return Equilibrium { status, ..result };
        };
        positions = moved;
        damping = if used > LEAST_DAMPING { 0.1 * used } else { 0.0 };
        iterations += 1;
    }
}

/// The start, with the ends of springs of no length a little apart where their force needs a direction.
fn parted(network: &Network<'_>) -> Vec<Vector> {
    let mut positions = network.positions.to_vec();
    for (spring, &[a, b]) in network.springs.iter().enumerate() {
        let along = subtract(positions[b as usize], positions[a as usize]);
        if length(along) > 0.0 || network.force_at(spring, 0.0) == 0.0 {
            continue;
        }
        let node = if network.fixed[b as usize] == [true; 3] { a } else { b } as usize;
        let size = PARTING * network.rest_length[spring].max(PARTING);
        for axis in (0..3).filter(|&axis| !network.fixed[node][axis]) {
            // Different along each axis and for each spring, so that no symmetry holds them together.
            positions[node][axis] += size * (1.0 + 0.1 * ((spring + axis) % 7) as f64);
        }
    }
    positions
}

/// A step that lowers the energy, and the damping that it took; `None` if there is none.
fn descend(
    network: &Network<'_>,
    free: &FreeAxes,
    now: &Equilibrium,
    damping: f64,
) -> Option<(Vec<Vector>, f64)> {
    let out_of_balance = residuals(network, &now.positions);
    let mut damping = damping;
    while damping <= MOST_DAMPING {
        if let Some(step) = newton_step(network, free, &now.positions, &out_of_balance, damping) {
            let mut moved = now.positions.clone();
            let mut slope = 0.0;
            for (row, &(node, axis)) in free.axes.iter().enumerate() {
                moved[node as usize][axis] += step[row][0];
                slope += step[row][0] * out_of_balance[node as usize][axis];
            }
            let change = Change::new(network, &now.positions, &moved);
            let falls = change.energy <= -1e-4 * slope;
            // Near equilibrium rounding hides the fall of energy, not that of the residual.
            let level = change.energy <= change.noise;
            let calmer = || largest(&residuals(network, &moved)) < largest(&out_of_balance);
            if falls || (level && calmer()) {
                return Some((moved, damping));
            }
        }
        damping = if damping == 0.0 { LEAST_DAMPING } else { 10.0 * damping };
    }
    None
}

/// Change of the potential energy [J] of springs and dead loads between positions.
struct Change {
    energy: f64,
    /// Rounding of `energy`.
    noise: f64,
}

impl Change {
    /// Sums the changes of all parts, which are far smaller than the parts themselves.
    fn new(network: &Network<'_>, from: &[Vector], to: &[Vector]) -> Change {
        let mut change = Change { energy: 0.0, noise: 0.0 };
        let mut add_part = |part: f64, noise: f64| {
            change.energy += part;
            change.noise += 1e-14 * (part.abs() + noise);
        };
        let moves: Vec<Vector> = from.iter().zip(to).map(|(&from, &to)| subtract(to, from)).collect();
        for spring in 0..network.springs.len() {
            let (before, moved) = (along(network, spring, from), along(network, spring, &moves));
            let lengths = [length(before), length(along(network, spring, to))];
            let total = lengths[0] + lengths[1];
            let longer = if total > 0.0 { dot(moved, add(scale(before, 2.0), moved)) / total } else { 0.0 };
            let [first, last] = lengths.map(|length| network.force_at(spring, length));
            // While it pulls all the way, the force is linear.
            let part = if first != 0.0 && last != 0.0 {
                0.5 * (first + last) * longer
            } else {
                network.energy_at(spring, lengths[1]) - network.energy_at(spring, lengths[0])
            };
            add_part(part, network.stiffness[spring] * total * longer.abs());
        }
        for (&moved, &load) in moves.iter().zip(network.loads.iter()) {
            add_part(-dot(load, moved), 0.0);
        }
        change
    }
}

fn newton_step(
    network: &Network<'_>,
    free: &FreeAxes,
    positions: &[Vector],
    out_of_balance: &[Vector],
    damping: f64,
) -> Option<Vec<[f64; 1]>> {
    // The exact tangent without damping; with damping, one that is positive definite.
    let clamped = damping > 0.0;
    free.solve(network, out_of_balance, |spring, ends| {
        let along = subtract(positions[ends[1]], positions[ends[0]]);
        let own = damping * own_stiffness(network, spring, length(along));
        (spring_tangent(network, spring, along, clamped), own)
    })
}
