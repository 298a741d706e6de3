//! Springs with rest lengths: Newton's method on the potential energy with a line search.
//!
//! The transverse part of a compressed spring's tangent is left out where the exact tangent is indefinite (Choi &
//! Ko, "Stable but responsive cloth", 2002), so that every step descends.

use super::cholesky::{Factor, SymmetricMatrix};
use super::linear;
use super::state::{Equilibrium, FIXED, FreeNodes, Settings, Status, residuals};
use crate::network::Network;
use crate::vector::{Vector, add, dot, length, scale, subtract};

/// Transverse stiffness that a metric keeps at least, as a share of k.
const TRANSVERSE_FLOOR: f64 = 1e-6;

pub(super) fn solve(network: &Network<'_>, settings: &Settings) -> Equilibrium {
    let free = FreeNodes::new(&network.fixed);
    let mut positions = start(network, settings);
    let mut energy = Potential::new(network, &positions);
    let mut iterations = 0;
    loop {
        let result = Equilibrium::at(network, positions, Status::Converged, iterations);
        if result.residual <= settings.tolerance || result.status != Status::Converged {
            return result;
        }
        if iterations >= settings.iterations {
            return Equilibrium { status: Status::IterationLimit, ..result };
        }
        positions = result.positions;
        let out_of_balance = residuals(network, &positions);
        let Some(step) = newton_step(network, &free, &positions, &out_of_balance) else {
            return Equilibrium::at(network, positions, Status::Singular, iterations);
        };
        let slope: f64 =
            free.nodes.iter().zip(&step).map(|(&n, &s)| dot(out_of_balance[n as usize], s)).sum();
        let (moved, lower) = search(network, &free, &positions, &step, energy, slope);
        positions = moved;
        energy = lower;
        iterations += 1;
    }
}

/// The given positions, or the net without rest lengths where a spring has no direction.
fn start(network: &Network<'_>, settings: &Settings) -> Vec<Vector> {
    let lengths = network.lengths(&network.positions);
    let directed =
        lengths.iter().zip(network.rest_length.iter()).all(|(&length, &rest)| rest == 0.0 || length > 0.0);
    if directed { network.positions.to_vec() } else { linear::solve(network, settings).positions }
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
        let stretch = |(spring, length): (usize, f64)| {
            0.5 * network.stiffness[spring] * (length - network.rest_length[spring]).powi(2)
        };
        let springs: f64 = lengths.map(stretch).sum();
        let work = || network.loads.iter().zip(positions).map(|(&load, &position)| dot(load, position));
        let loads: f64 = work().sum();
        let size = springs + work().map(f64::abs).sum::<f64>();
        Potential { energy: springs - loads, noise: 1e-14 * size }
    }
}

/// The exact tangent where it is positive definite, else the clamped one.
fn newton_step(
    network: &Network<'_>,
    free: &FreeNodes,
    positions: &[Vector],
    out_of_balance: &[Vector],
) -> Option<Vec<Vector>> {
    let factor = Factor::new(&tangent(network, free, positions, false))
        .or_else(|_| Factor::new(&tangent(network, free, positions, true)))
        .ok()?;
    let mut sides: Vec<[f64; 1]> =
        free.nodes.iter().flat_map(|&node| out_of_balance[node as usize].map(|value| [value])).collect();
    factor.solve(&mut sides);
    Some(sides.chunks_exact(3).map(|row| [row[0][0], row[1][0], row[2][0]]).collect())
}

fn tangent(network: &Network<'_>, free: &FreeNodes, positions: &[Vector], clamped: bool) -> SymmetricMatrix {
    let mut diagonal = vec![0.0; 3 * free.nodes.len()];
    let mut entries = Vec::with_capacity(15 * network.springs.len());
    for (spring, &[a, b]) in network.springs.iter().enumerate() {
        let block =
            spring_tangent(network, spring, subtract(positions[b as usize], positions[a as usize]), clamped);
        let rows = [free.rows[a as usize], free.rows[b as usize]];
        for row in rows.into_iter().filter(|&row| row != FIXED) {
            for i in 0..3 {
                diagonal[3 * row as usize + i] += block[i][i];
                entries.extend((0..i).map(|j| (3 * row + i as u32, 3 * row + j as u32, block[i][j])));
            }
        }
        if rows.iter().all(|&row| row != FIXED) {
            let place = |i: usize, j: usize| (3 * rows[0] + i as u32, 3 * rows[1] + j as u32, -block[i][j]);
            entries.extend((0..9).map(|at| place(at / 3, at % 3)));
        }
    }
    SymmetricMatrix::new(diagonal, &entries)
}

/// k [(1 − r/L)(I − n nᵀ) + n nᵀ], with the first factor kept above a floor when `clamped`.
pub(super) fn spring_tangent(
    network: &Network<'_>,
    spring: usize,
    along: Vector,
    clamped: bool,
) -> [Vector; 3] {
    let (k, rest, length) = (network.stiffness[spring], network.rest_length[spring], length(along));
    let exact = if rest == 0.0 { 1.0 } else { 1.0 - rest / length.max(f64::MIN_POSITIVE) };
    let transverse = if clamped { exact.max(TRANSVERSE_FLOOR) } else { exact };
    let normal = if length > 0.0 { scale(along, 1.0 / length) } else { [0.0; 3] };
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let identity = f64::from(u8::from(i == j));
            k * (transverse * identity + (1.0 - transverse) * normal[i] * normal[j])
        })
    })
}

/// Halves the step until the energy falls enough (Armijo); near equilibrium rounding hides the fall, and the
/// full step is taken if it does not raise the energy noticeably.
fn search(
    network: &Network<'_>,
    free: &FreeNodes,
    positions: &[Vector],
    step: &[Vector],
    before: Potential,
    slope: f64,
) -> (Vec<Vector>, Potential) {
    let mut share = 1.0;
    loop {
        let mut moved = positions.to_vec();
        for (&node, &step) in free.nodes.iter().zip(step) {
            moved[node as usize] = add(moved[node as usize], scale(step, share));
        }
        let reached = Potential::new(network, &moved);
        if reached.energy <= before.energy - 1e-4 * share * slope + before.noise || share < 1e-10 {
            return (moved, reached);
        }
        share *= 0.5;
    }
}
