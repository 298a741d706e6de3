//! Dynamic relaxation with kinetic damping: an explicit cross-check of the solvers that factor a matrix.
//!
//! Barnes, "Form finding and analysis of tension structures by dynamic relaxation", International Journal of Space
//! Structures 14(2), 1999. Nodes get fictitious masses, move freely under the forces out of balance, and stop
//! dead whenever their kinetic energy has passed a peak.

use super::descent::Hill;
use super::elements::{Elements, vector};
use super::followers::follow;
use super::state::{Equilibrium, Method, Settings, Status, least_force_scale, unheld_node};
use super::supports::Supports;
use super::tangent::{Layout, along, own_bend_stiffness, own_stiffness};
use crate::network::Network;
use crate::sparse::Lanes;
use crate::vector::{Vector, length};

/// Factor on the masses that stand on the bound of stability, for what changes between two peaks.
const SAFETY: f64 = 1.05;

/// Moves a network that passes [`Network::check`] to equilibrium; `settings.iterations` counts time steps.
pub fn solve(network: &Network<'_>, settings: &Settings) -> Equilibrium {
    if let Some(node) = unheld_node(network) {
        return Equilibrium::at(network, network.positions.to_vec(), Status::Unheld { node }, 0);
    }
    let supports = Supports::from(network);
    let mut elements = Elements::default();
    elements.build(network, &[]);
    let layout = Layout::default();
    let least_force = least_force_scale(network);
    let hill = Hill { network, elements: &elements, supports: &supports, layout: &layout, least_force };
    let mut net = Relaxation::new(hill);
    let mut steps = 0;
    loop {
        let residual = net.pull(hill);
        if residual <= settings.tolerance || steps >= settings.iterations || !net.kinetic.is_finite() {
            let result = Equilibrium::at(network, net.vectors(), Status::Converged, steps);
            let result = Equilibrium { method: Method::DynamicRelaxation, ..result };
            if result.residual <= settings.tolerance || result.status != Status::Converged {
                return result;
            }
            if steps >= settings.iterations {
                return Equilibrium { status: Status::IterationLimit, ..result };
            }
        }
        net.advance(hill);
        steps += 1;
    }
}

/// A net in motion; time steps are of length one.
struct Relaxation {
    positions: Vec<Lanes>,
    velocities: Vec<Lanes>,
    pulls: Vec<Lanes>,
    /// One over the mass of every node [m/N].
    mobility: Vec<f64>,
    /// Loads that follow the shape [N]; empty if there are none.
    following: Vec<Vector>,
    kinetic: f64,
    /// The next step starts from rest.
    at_rest: bool,
}

impl Relaxation {
    fn new(hill: Hill<'_>) -> Self {
        let positions: Vec<Lanes> = hill.network.positions.iter().map(|&[x, y, z]| [x, y, z, 0.0]).collect();
        let mut net = Relaxation {
            velocities: vec![[0.0; 4]; positions.len()],
            pulls: Vec::new(),
            mobility: Vec::new(),
            following: if hill.network.has_followers() {
                vec![[0.0; 3]; positions.len()]
            } else {
                Vec::new()
            },
            positions,
            kinetic: 0.0,
            at_rest: true,
        };
        net.weigh(hill);
        net
    }

    /// Gives every node the least mass at which steps of length one are stable: half the sum of its springs' stiffness.
    fn weigh(&mut self, hill: Hill<'_>) {
        let mut masses = vec![0.0; self.positions.len()];
        for (spring, ends) in hill.network.springs.iter().enumerate() {
            let size = length(along(hill.network, spring, &self.positions));
            let own = 0.5 * SAFETY * own_stiffness(hill.network, spring, size);
            ends.iter().for_each(|&node| masses[node as usize] += own);
        }
        for bend in &hill.elements.bends {
            // A bend turns both links: its middle node takes four times the share of an end.
            let own = 4.0 * SAFETY * own_bend_stiffness(bend);
            bend.nodes.iter().for_each(|&node| masses[node as usize] += own);
        }
        let mobility = masses.into_iter().map(|mass| if mass > 0.0 { 1.0 / mass } else { 0.0 });
        self.mobility.clear();
        self.mobility.extend(mobility);
    }

    /// Sums forces out of balance; the largest over the mean spring force.
    fn pull(&mut self, hill: Hill<'_>) -> f64 {
        let (state, residual) = hill.look(&self.positions, &mut self.pulls);
        if self.following.is_empty() {
            return residual;
        }
        self.following.fill([0.0; 3]);
        follow(hill.network, &self.vectors(), &mut self.following);
        for (pull, load) in self.pulls.iter_mut().zip(&self.following) {
            (0..3).for_each(|axis| pull[axis] += load[axis]);
        }
        hill.supports.keep_free(&mut self.pulls);
        let largest = self.pulls.iter().map(|&pull| length(vector(pull))).fold(0.0, f64::max);
        largest / state.mean_force.max(hill.least_force)
    }

    /// Makes one time step, or stops the net where its kinetic energy was largest.
    fn advance(&mut self, hill: Hill<'_>) {
        let share = if self.at_rest { 0.5 } else { 1.0 };
        let mut kinetic = [0.0; 4];
        let nodes = self.velocities.iter_mut().zip(&mut self.positions);
        for ((velocity, position), (pull, mobility)) in nodes.zip(self.pulls.iter().zip(&self.mobility)) {
            for lane in 0..4 {
                velocity[lane] += share * pull[lane] * mobility;
                position[lane] += velocity[lane];
                // Twice the kinetic energy over a mass that is alike everywhere but near the border.
                kinetic[lane] += velocity[lane] * velocity[lane];
            }
        }
        let kinetic: f64 = kinetic.iter().sum();
        if kinetic >= self.kinetic || self.at_rest {
            (self.kinetic, self.at_rest) = (kinetic, false);
            return;
        }
        // The peak lay half a step before the middle of the last step (Barnes, eq. 9).
        let nodes = self.velocities.iter_mut().zip(&mut self.positions);
        for ((velocity, position), (pull, mobility)) in nodes.zip(self.pulls.iter().zip(&self.mobility)) {
            for lane in 0..4 {
                position[lane] -= 1.5 * velocity[lane] - 0.5 * pull[lane] * mobility;
                velocity[lane] = 0.0;
            }
        }
        (self.kinetic, self.at_rest) = (0.0, true);
        self.weigh(hill);
    }

    fn vectors(&self) -> Vec<Vector> {
        self.positions.iter().map(|&position| vector(position)).collect()
    }
}
