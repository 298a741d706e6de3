//! Equilibrium: positions at which springs and loads balance at every free node.
//!
//! Where force is stiffness times length, one linear system is solved directly. Other nets are solved by Newton's
//! method, damped so that the energy falls. [`implicit_euler`] moves a net to the same equilibrium step by step.
//! A solve returns its status; it never prints and never panics on a bad net.

pub mod cholesky;
pub mod dynamic_relaxation;
pub mod implicit_euler;
mod interior;
mod linear;
mod newton;
mod state;
mod tangent;

pub use state::{Equilibrium, Settings, Status, reactions, residuals};

use crate::network::Network;
use state::unheld_node;

/// Solves a network that passes [`Network::check`].
pub fn solve(network: &Network<'_>, settings: &Settings) -> Equilibrium {
    if let Some(node) = unheld_node(network) {
        return Equilibrium::at(network, network.positions.to_vec(), Status::Unheld { node }, 0);
    }
    if network.is_linear() { linear::solve(network, settings) } else { newton::solve(network, settings) }
}
