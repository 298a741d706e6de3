//! Springs without rest length: one Laplacian system with three right-hand sides (Schek 1974).

use super::cholesky::{Factor, NotPositiveDefinite, SymmetricMatrix};
use super::state::{Equilibrium, FIXED, FreeNodes, Settings, Status, residuals};
use crate::network::Network;
use crate::vector::{Vector, add};

/// Solves the network whatever its rest lengths, as if they were zero. Every free node must be held.
pub(super) fn solve(network: &Network<'_>, settings: &Settings) -> Equilibrium {
    let free = FreeNodes::new(&network.fixed);
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
