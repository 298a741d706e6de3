//! Force as stiffness times length: one Laplacian system with three right-hand sides (Schek 1974).

use super::cholesky::{Factor, NotPositiveDefinite, SymmetricMatrix};
use super::state::{Equilibrium, Settings, Status, residuals};
use crate::network::Network;
use crate::vector::{Vector, add};

/// Solves a network that is linear ([`Network::is_linear`]) and held.
pub(super) fn solve(network: &Network<'_>, settings: &Settings) -> Equilibrium {
    let free = FreeNodes::new(network);
    let mut positions = network.positions.to_vec();
    let Ok(factor) = laplacian(network, &free) else {
        return Equilibrium::at(network, positions, Status::Singular, 0);
    };
    // The start is the origin: the outcome is to depend on nothing but topology and anchors.
    for &node in &free.nodes {
        positions[node as usize] = [0.0; 3];
    }
    let mut iterations = 0;
    loop {
        let out_of_balance = residuals(network, &positions);
        let mut moves: Vec<Vector> = free.nodes.iter().map(|&node| out_of_balance[node as usize]).collect();
        factor.solve(&mut moves);
        for (&node, step) in free.nodes.iter().zip(moves) {
            positions[node as usize] = add(positions[node as usize], step);
        }
        iterations += 1;
        let result = Equilibrium::at(network, positions, Status::Converged, iterations);
        if result.residual <= settings.tolerance || result.status != Status::Converged {
            return result;
        }
        if iterations >= settings.iterations.min(MOST_REFINEMENTS) {
            return Equilibrium { status: Status::IterationLimit, ..result };
        }
        positions = result.positions;
    }
}

/// Refinements stop helping after very few; what is left then is rounding.
const MOST_REFINEMENTS: u32 = 5;

fn laplacian(network: &Network<'_>, free: &FreeNodes) -> Result<Factor, NotPositiveDefinite> {
    let mut diagonal = vec![0.0; free.nodes.len()];
    let mut entries = Vec::with_capacity(network.springs.len());
    for (&[a, b], &k) in network.springs.iter().zip(network.stiffness.iter()) {
        let (a, b) = (free.rows[a as usize], free.rows[b as usize]);
        for row in [a, b] {
            if row != FIXED {
                diagonal[row as usize] += k;
            }
        }
        if a != FIXED && b != FIXED {
            entries.push((a, b, -k));
        }
    }
    Factor::new(&SymmetricMatrix::new(diagonal, &entries))
}

/// Numbers of free nodes in the system, and the way back.
struct FreeNodes {
    /// Row of every node, or `FIXED`.
    rows: Vec<u32>,
    /// Node of every row.
    nodes: Vec<u32>,
}

const FIXED: u32 = u32::MAX;

impl FreeNodes {
    fn new(network: &Network<'_>) -> Self {
        let fixed = |node: &u32| network.fixed[*node as usize].contains(&true);
        let nodes: Vec<u32> = (0..network.positions.len() as u32).filter(|node| !fixed(node)).collect();
        let mut rows = vec![FIXED; network.positions.len()];
        for (row, &node) in nodes.iter().enumerate() {
            rows[node as usize] = row as u32;
        }
        FreeNodes { rows, nodes }
    }
}
