//! What every solver starts from and ends with: settings, status, residuals, free nodes.

use crate::network::Network;
use crate::vector::{Vector, add, length, scale, subtract};

/// When to stop.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Settings {
    /// Largest residual at a free node over the mean spring force.
    pub tolerance: f64,
    /// Most iterations: refinements of the linear system, Newton steps, or Euler steps.
    pub iterations: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { tolerance: 1e-9, iterations: 500 }
    }
}

/// How a solve ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Status {
    /// The residual is within the tolerance.
    Converged,
    /// The most iterations were made; the result is the best so far.
    IterationLimit,
    /// A free node is not held by any springs that lead to a fixed node.
    Unheld {
        /// The node.
        node: u32,
    },
    /// The tangent is singular or a number overflowed.
    Singular,
}

/// Result of a solve; n nodes, m springs.
#[derive(Clone, PartialEq, Debug)]
pub struct Equilibrium {
    /// Position of every node [m], n.
    pub positions: Vec<Vector>,
    /// Force of every spring [N], tension positive, m.
    pub forces: Vec<f64>,
    /// Largest residual at a free node over the mean spring force.
    pub residual: f64,
    /// How the solve ended.
    pub status: Status,
    /// Iterations made.
    pub iterations: u32,
}

impl Equilibrium {
    /// The state of a network at positions; a number that is not finite makes it singular.
    pub(super) fn at(network: &Network<'_>, positions: Vec<Vector>, status: Status, iterations: u32) -> Self {
        let forces = network.forces(&positions);
        let residual = relative_residual(network, &positions, &forces);
        let finite = residual.is_finite()
            && forces.iter().all(|force| force.is_finite())
            && positions.iter().flatten().all(|coordinate| coordinate.is_finite());
        let status = if finite { status } else { Status::Singular };
        Equilibrium { positions, forces, residual, status, iterations }
    }
}

/// Force out of balance at every node [N]; zero along axes that hold it.
pub fn residuals(network: &Network<'_>, positions: &[Vector]) -> Vec<Vector> {
    let mut residuals = unbalanced(network, positions);
    for (residual, axes) in residuals.iter_mut().zip(network.fixed.iter()) {
        *residual = std::array::from_fn(|axis| if axes[axis] { 0.0 } else { residual[axis] });
    }
    residuals
}

/// Force that holds every node [N]; zero along axes that are free.
pub fn reactions(network: &Network<'_>, positions: &[Vector]) -> Vec<Vector> {
    let mut reactions = unbalanced(network, positions);
    for (reaction, axes) in reactions.iter_mut().zip(network.fixed.iter()) {
        *reaction = std::array::from_fn(|axis| if axes[axis] { -reaction[axis] } else { 0.0 });
    }
    reactions
}

/// Pull of springs and loads at every node [N].
fn unbalanced(network: &Network<'_>, positions: &[Vector]) -> Vec<Vector> {
    let mut sums = network.loads.to_vec();
    for (spring, &[a, b]) in network.springs.iter().enumerate() {
        let (a, b) = (a as usize, b as usize);
        let along = subtract(positions[b], positions[a]);
        let pull = scale(along, force_density(network, spring, length(along)));
        sums[a] = add(sums[a], pull);
        sums[b] = subtract(sums[b], pull);
    }
    sums
}

/// Force over length [N/m]; a spring of no length pulls nowhere.
pub(super) fn force_density(network: &Network<'_>, spring: usize, length: f64) -> f64 {
    if network.rest_length[spring] == 0.0 && network.force[spring] == 0.0 {
        return network.stiffness_at(spring, length);
    }
    if length > 0.0 { network.force_at(spring, length) / length } else { 0.0 }
}

fn relative_residual(network: &Network<'_>, positions: &[Vector], forces: &[f64]) -> f64 {
    // `f64::max` would pass over what is not a number.
    let larger = |a: f64, b: f64| if a >= b { a } else { b };
    let largest = residuals(network, positions).into_iter().map(length).fold(0.0, larger);
    if largest == 0.0 { 0.0 } else { largest / force_scale(network, forces) }
}

/// Mean spring force [N], or what the loads give where no spring carries force.
fn force_scale(network: &Network<'_>, forces: &[f64]) -> f64 {
    let mean = forces.iter().map(|force| force.abs()).sum::<f64>() / forces.len().max(1) as f64;
    let loads = network.loads.iter().map(|&load| length(load)).fold(0.0, f64::max);
    let stiffness = network.stiffness.iter().zip(network.rest_length.iter());
    let unstressed = stiffness.map(|(k, rest)| k * rest).fold(0.0, f64::max);
    mean.max(1e-6 * loads).max(1e-6 * unstressed)
}

/// A free node from which no springs lead to a fixed node.
pub(super) fn unheld_node(network: &Network<'_>) -> Option<u32> {
    let nodes = network.positions.len();
    let mut starts = vec![0u32; nodes + 1];
    for &[a, b] in network.springs.iter() {
        starts[a as usize + 1] += 1;
        starts[b as usize + 1] += 1;
    }
    for node in 0..nodes {
        starts[node + 1] += starts[node];
    }
    let mut next = starts.clone();
    let mut neighbours = vec![0u32; 2 * network.springs.len()];
    for &[a, b] in network.springs.iter() {
        for (from, to) in [(a, b), (b, a)] {
            neighbours[next[from as usize] as usize] = to;
            next[from as usize] += 1;
        }
    }
    // A node that is held along one axis may still be loose along another; the tangent finds out.
    let mut held: Vec<bool> = network.fixed.iter().map(|axes| axes.contains(&true)).collect();
    let mut open: Vec<u32> = (0..nodes as u32).filter(|&node| held[node as usize]).collect();
    while let Some(node) = open.pop() {
        for at in starts[node as usize]..starts[node as usize + 1] {
            let far = neighbours[at as usize];
            if !held[far as usize] {
                held[far as usize] = true;
                open.push(far);
            }
        }
    }
    held.iter().position(|&held| !held).map(|node| node as u32)
}
