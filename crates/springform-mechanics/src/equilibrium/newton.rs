//! Springs of any law: Newton's method on the potential energy, damped after Levenberg and Marquardt.
//!
//! The undamped exact tangent is tried first. Where it is indefinite, or its step does not lower the energy, the
//! transverse part of pushing springs is left out (Choi & Ko, "Stable but responsive cloth", 2002) and a share of each
//! node's own stiffness is added to the diagonal (Marquardt, "An algorithm for least-squares estimation of nonlinear
//! parameters", 1963), more and more until the energy falls. So a net needs no good start: springs may be slack,
//! straight under transverse load, or far off.

use super::cholesky::{Factor, SymmetricMatrix};
use super::state::{Equilibrium, Settings, Status, force_density, residuals};
use crate::network::Network;
use crate::vector::{Vector, dot, length, scale, subtract};

/// Damping after a refused undamped step, and the least that is kept, as a share of a node's own stiffness.
const LEAST_DAMPING: f64 = 1e-9;

/// Damping beyond which a step is too short to matter.
const MOST_DAMPING: f64 = 1e12;

/// Part of a spring's length by which nodes that coincide are parted, so that it has a direction.
const PARTING: f64 = 1e-6;

pub(super) fn solve(network: &Network<'_>, settings: &Settings) -> Equilibrium {
    let free = FreeAxes::new(network);
    let mut positions = parted(network);
    let mut damping = 0.0;
    let mut iterations = 0;
    loop {
        let result = Equilibrium::at(network, positions, Status::Converged, iterations);
        if result.residual <= settings.tolerance || result.status != Status::Converged {
            return result;
        }
        if iterations >= settings.iterations {
            return Equilibrium { status: Status::IterationLimit, ..result };
        }
        let Some((moved, used)) = descend(network, &free, &result, damping) else {
            return Equilibrium { status: Status::Singular, ..result };
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
    let before = Potential::new(network, &now.positions);
    let mut damping = damping;
    while damping <= MOST_DAMPING {
        if let Some(step) = newton_step(network, free, &now.positions, &out_of_balance, damping) {
            let mut moved = now.positions.clone();
            let mut slope = 0.0;
            for (row, &(node, axis)) in free.axes.iter().enumerate() {
                moved[node as usize][axis] += step[row][0];
                slope += step[row][0] * out_of_balance[node as usize][axis];
            }
            let after = Potential::new(network, &moved);
            let falls = after.energy <= before.energy - 1e-4 * slope;
            // Near equilibrium rounding hides the fall of energy, not that of the residual.
            let level = after.energy <= before.energy + before.noise;
            let calmer = || largest(&residuals(network, &moved)) < largest(&out_of_balance);
            if falls || (level && calmer()) {
                return Some((moved, damping));
            }
        }
        damping = if damping == 0.0 { LEAST_DAMPING } else { 10.0 * damping };
    }
    None
}

fn largest(vectors: &[Vector]) -> f64 {
    vectors.iter().map(|&vector| length(vector)).fold(0.0, f64::max)
}

/// Potential energy [J] of springs and dead loads.
#[derive(Clone, Copy)]
struct Potential {
    energy: f64,
    /// Rounding of `energy`: its terms may be far larger than their sum.
    noise: f64,
}

impl Potential {
    fn new(network: &Network<'_>, positions: &[Vector]) -> Potential {
        let lengths = network.lengths(positions).into_iter().enumerate();
        let springs: f64 = lengths.map(|(spring, length)| network.energy_at(spring, length)).sum();
        let work = || network.loads.iter().zip(positions).map(|(&load, &position)| dot(load, position));
        let loads: f64 = work().sum();
        let size = springs.abs() + work().map(f64::abs).sum::<f64>();
        Potential { energy: springs - loads, noise: 1e-14 * size }
    }
}

fn newton_step(
    network: &Network<'_>,
    free: &FreeAxes,
    positions: &[Vector],
    out_of_balance: &[Vector],
    damping: f64,
) -> Option<Vec<[f64; 1]>> {
    let factor = Factor::new(&tangent(network, free, positions, damping)).ok()?;
    let mut step: Vec<[f64; 1]> =
        free.axes.iter().map(|&(node, axis)| [out_of_balance[node as usize][axis]]).collect();
    factor.solve(&mut step);
    Some(step)
}

/// The exact tangent without damping; with damping, one that is positive definite.
fn tangent(network: &Network<'_>, free: &FreeAxes, positions: &[Vector], damping: f64) -> SymmetricMatrix {
    let clamped = damping > 0.0;
    let mut diagonal = vec![0.0; free.axes.len()];
    let mut entries = Vec::with_capacity(15 * network.springs.len());
    for (spring, &ends) in network.springs.iter().enumerate() {
        let along = subtract(positions[ends[1] as usize], positions[ends[0] as usize]);
        let block = spring_tangent(network, spring, along, clamped);
        let own = damping * own_stiffness(network, spring, length(along));
        let rows = ends.map(|node| free.rows[node as usize]);
        for rows in rows {
            for i in (0..3).filter(|&i| rows[i] != FIXED) {
                diagonal[rows[i] as usize] += block[i][i] + own;
                let below = (0..i).filter(|&j| rows[j] != FIXED);
                entries.extend(below.map(|j| (rows[i], rows[j], block[i][j])));
            }
        }
        for (i, j) in (0..9).map(|at| (at / 3, at % 3)) {
            if rows[0][i] != FIXED && rows[1][j] != FIXED {
                entries.push((rows[0][i], rows[1][j], -block[i][j]));
            }
        }
    }
    SymmetricMatrix::new(diagonal, &entries)
}

/// Stiffness that a spring has of its own, slack or not [N/m].
pub(super) fn own_stiffness(network: &Network<'_>, spring: usize, length: f64) -> f64 {
    let constant = network.force[spring].abs();
    network.stiffness[spring].max(if length > 0.0 { constant / length } else { constant })
}

/// k n nᵀ + (F/L)(I − n nᵀ), the second term not below zero when `clamped`.
pub(super) fn spring_tangent(
    network: &Network<'_>,
    spring: usize,
    along: Vector,
    clamped: bool,
) -> [Vector; 3] {
    let length = length(along);
    let (axial, exact) = (network.stiffness_at(spring, length), force_density(network, spring, length));
    let transverse = if clamped { exact.max(0.0) } else { exact };
    let normal = if length > 0.0 { scale(along, 1.0 / length) } else { [0.0; 3] };
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let identity = f64::from(u8::from(i == j));
            transverse * identity + (axial - transverse) * normal[i] * normal[j]
        })
    })
}

/// Numbers of the axes along which nodes are free, and the way back.
struct FreeAxes {
    /// Rows of the three axes of every node, or `FIXED`.
    rows: Vec<[u32; 3]>,
    /// Node and axis of every row.
    axes: Vec<(u32, usize)>,
}

const FIXED: u32 = u32::MAX;

impl FreeAxes {
    fn new(network: &Network<'_>) -> Self {
        let mut axes = Vec::new();
        let mut number = |node: usize, axis: usize| {
            if network.fixed[node][axis] {
                return FIXED;
            }
            axes.push((node as u32, axis));
            (axes.len() - 1) as u32
        };
        let rows = (0..network.positions.len()).map(|node| [0, 1, 2].map(|axis| number(node, axis)));
        let rows = rows.collect();
        FreeAxes { rows, axes }
    }
}
