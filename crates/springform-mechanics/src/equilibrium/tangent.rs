//! Tangent stiffness of springs of any law, over the axes along which nodes are free.

use super::cholesky::{Factor, Symbolic, SymmetricMatrix};
use super::state::force_density;
use crate::network::Network;
use crate::vector::{Vector, length, scale, subtract};

/// Numbers of the axes along which nodes are free, and the way back.
pub(super) struct FreeAxes {
    /// Rows of the three axes of every node, or `FIXED`.
    rows: Vec<[u32; 3]>,
    /// Node and axis of every row.
    pub(super) axes: Vec<(u32, usize)>,
    /// Pattern of all tangents.
    symbolic: Symbolic,
}

const FIXED: u32 = u32::MAX;

impl FreeAxes {
    /// Numbers the free axes of a network and orders their elimination.
    pub(super) fn new(network: &Network<'_>) -> Self {
        let mut axes = Vec::new();
        let mut number = |node: usize, axis: usize| {
            if network.fixed[node][axis] {
                return FIXED;
            }
            axes.push((node as u32, axis));
            (axes.len() - 1) as u32
        };
        let rows = (0..network.positions.len()).map(|node| [0, 1, 2].map(|axis| number(node, axis)));
        let rows: Vec<[u32; 3]> = rows.collect();
        let symbolic = Symbolic::new(&tangent(network, &rows, axes.len(), |_, _| ([[0.0; 3]; 3], 0.0)));
        FreeAxes { rows, axes, symbolic }
    }

    /// Moves of the free axes under forces, where each spring has a stiffness and a share of both nodes' diagonal;
    /// `None` if they hold no step.
    pub(super) fn solve(
        &self,
        network: &Network<'_>,
        forces: &[Vector],
        stiffness: impl Fn(usize, [usize; 2]) -> ([Vector; 3], f64),
    ) -> Option<Vec<[f64; 1]>> {
        let matrix = tangent(network, &self.rows, self.axes.len(), stiffness);
        let factor = Factor::with_symbolic(&matrix, self.symbolic.clone()).ok()?;
        let mut step: Vec<[f64; 1]> =
            self.axes.iter().map(|&(node, axis)| [forces[node as usize][axis]]).collect();
        factor.solve(&mut step);
        Some(step)
    }
}

/// Sum of the stiffness of springs.
fn tangent(
    network: &Network<'_>,
    rows: &[[u32; 3]],
    size: usize,
    stiffness: impl Fn(usize, [usize; 2]) -> ([Vector; 3], f64),
) -> SymmetricMatrix {
    let mut diagonal = vec![0.0; size];
    let mut entries = Vec::with_capacity(15 * network.springs.len());
    for (spring, &ends) in network.springs.iter().enumerate() {
        let (block, own) = stiffness(spring, ends.map(|node| node as usize));
        let rows = ends.map(|node| rows[node as usize]);
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
    let exact = force_density(network, spring, length);
    // A spring that starts at its rest length counts as taut: rounding would decide otherwise.
    let (k, rest) = (network.stiffness[spring], network.rest_length[spring]);
    let at_rest = (network.force[spring] + k * (length - rest)).abs() <= 1e-14 * k * rest;
    let axial = if at_rest { k } else { network.stiffness_at(spring, length) };
    block(along, length, axial, if clamped { exact.max(0.0) } else { exact })
}

/// Stiffness of a spring along and across its direction.
pub(super) fn block(along: Vector, length: f64, axial: f64, transverse: f64) -> [Vector; 3] {
    let normal = if length > 0.0 { scale(along, 1.0 / length) } else { [0.0; 3] };
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let identity = f64::from(u8::from(i == j));
            transverse * identity + (axial - transverse) * normal[i] * normal[j]
        })
    })
}

/// From the first node of a spring to the second.
pub(super) fn along(network: &Network<'_>, spring: usize, of: &[Vector]) -> Vector {
    let [a, b] = network.springs[spring];
    subtract(of[b as usize], of[a as usize])
}
