//! What every solver starts from and ends with: settings, status, residuals, free nodes.

use super::followers::loads_at;
use super::supports::Supports;
use crate::network::Network;
use crate::sparse::Lanes;
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
    /// Loads that follow the shape drive the net away.
    Unstable,
    /// The residual is within the tolerance, but the energy falls beside this rest, and no stable one was found.
    UnstableRest,
}

/// How an equilibrium was found.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Method {
    /// One linear system.
    #[default]
    Linear,
    /// Quasi-Newton steps in the metric of a scalar stiffness.
    Preconditioned,
    /// Newton steps on the exact tangent.
    Newton,
    /// Newton steps after an interior-point phase.
    Interior,
    /// Time steps, each one linear system.
    ImplicitEuler,
    /// Explicit time steps with kinetic damping.
    DynamicRelaxation,
}

impl Method {
    /// Name in results.
    pub fn name(self) -> &'static str {
        match self {
            Method::Linear => "linear",
            Method::Preconditioned => "preconditioned",
            Method::Newton => "newton",
            Method::Interior => "interior",
            Method::ImplicitEuler => "implicit-euler",
            Method::DynamicRelaxation => "dynamic-relaxation",
        }
    }
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
    /// Node of the largest residual, if any node is out of balance.
    pub worst: Option<u32>,
    /// How the solve ended.
    pub status: Status,
    /// Iterations made.
    pub iterations: u32,
    /// How it was found.
    pub method: Method,
}

impl Default for Equilibrium {
    fn default() -> Self {
        Equilibrium {
            positions: Vec::new(),
            forces: Vec::new(),
            residual: 0.0,
            worst: None,
            status: Status::Converged,
            iterations: 0,
            method: Method::Linear,
        }
    }
}

impl Equilibrium {
    /// The state of a network at positions; a number that is not finite makes it singular.
    pub(super) fn at(network: &Network<'_>, positions: Vec<Vector>, status: Status, iterations: u32) -> Self {
        let forces = network.forces(&positions);
        let (worst, residual) = relative_residual(network, &positions, &forces);
        let finite = residual.is_finite()
            && forces.iter().all(|force| force.is_finite())
            && positions.iter().flatten().all(|coordinate| coordinate.is_finite());
        let status = if finite { status } else { Status::Singular };
        Equilibrium { positions, forces, residual, worst, status, iterations, method: Method::Linear }
    }

    /// Sets the residual and the worst node from what is out of balance at nodes, and the mean force [N].
    pub(super) fn measure(
        &mut self,
        network: &Network<'_>,
        mean_force: f64,
        unbalanced: impl Iterator<Item = (u32, Lanes)>,
    ) {
        let mut largest = 0.0;
        self.worst = None;
        for (node, [x, y, z, _]) in unbalanced {
            let square = x * x + y * y + z * z;
            // What is not a number is the worst.
            if square > largest || square.is_nan() {
                (largest, self.worst) = (square, Some(node));
            }
        }
        let scale = mean_force.max(least_force_scale(network));
        self.residual = if self.worst.is_none() { 0.0 } else { largest.sqrt() / scale };
    }
}

/// Force out of balance at every node [N]; zero along the ways that supports hold.
pub fn residuals(network: &Network<'_>, positions: &[Vector]) -> Vec<Vector> {
    let supports = Supports::from(network);
    let mut residuals = unbalanced(network, positions, &network.forces(positions));
    for (node, residual) in residuals.iter_mut().enumerate() {
        *residual = supports.free_part(node, *residual);
    }
    residuals
}

/// Force that holds every node [N] under the forces of the springs [N], which may have more digits than the positions give
/// them; zero along the ways that are free.
pub fn reactions(network: &Network<'_>, positions: &[Vector], forces: &[f64]) -> Vec<Vector> {
    let supports = Supports::from(network);
    let mut reactions = unbalanced(network, positions, forces);
    for (node, reaction) in reactions.iter_mut().enumerate() {
        // Not −0 where nothing holds.
        *reaction = subtract([0.0; 3], supports.held_part(node, *reaction));
    }
    reactions
}

/// Loads on every node [N]: dead ones, and those that follow the shape.
pub fn loads(network: &Network<'_>, positions: &[Vector]) -> Vec<Vector> {
    loads_at(network, positions)
}

/// Pull of springs, rods and loads at every node [N].
fn unbalanced(network: &Network<'_>, positions: &[Vector], forces: &[f64]) -> Vec<Vector> {
    let mut sums = loads_at(network, positions);
    for (spring, (&[a, b], &force)) in network.springs.iter().zip(forces).enumerate() {
        let (a, b) = (a as usize, b as usize);
        let along = subtract(positions[b], positions[a]);
        let pull = scale(along, force_density(network, spring, length(along), force));
        sums[a] = add(sums[a], pull);
        sums[b] = subtract(sums[b], pull);
    }
    for bend in network.rods.iter().flat_map(|rod| rod.bends()) {
        let [a, b, c] = bend.nodes.map(|node| node as usize);
        let [first, second] = bend.bending(bend.links(positions), false).forces;
        sums[a] = add(sums[a], first);
        sums[b] = add(sums[b], subtract(second, first));
        sums[c] = subtract(sums[c], second);
    }
    sums
}

/// Force over length [N/m] of a spring of such a length and force; a spring of no length pulls nowhere.
pub(super) fn force_density(network: &Network<'_>, spring: usize, length: f64, force: f64) -> f64 {
    if network.rest_length[spring] == 0.0 && network.force[spring] == 0.0 {
        return network.stiffness_at(spring, length);
    }
    if length > 0.0 { force / length } else { 0.0 }
}

fn relative_residual(network: &Network<'_>, positions: &[Vector], forces: &[f64]) -> (Option<u32>, f64) {
    let mut worst = (None, 0.0);
    for (node, residual) in residuals(network, positions).into_iter().enumerate() {
        let size = length(residual);
        // What is not a number is the worst.
        if size > worst.1 || size.is_nan() {
            worst = (Some(node as u32), size);
            if size.is_nan() {
                break;
            }
        }
    }
    (worst.0, if worst.1 == 0.0 { 0.0 } else { worst.1 / force_scale(network, forces) })
}

/// Mean spring force [N], or what the loads give where no spring carries force.
fn force_scale(network: &Network<'_>, forces: &[f64]) -> f64 {
    let mean = forces.iter().map(|force| force.abs()).sum::<f64>() / forces.len().max(1) as f64;
    mean.max(least_force_scale(network))
}

/// Force by which residuals are measured where a net has none of its own [N]; far below any.
const LEAST_FORCE: f64 = 1e-100;

/// The least force that residuals are measured by [N]: a share of the loads, and of what springs with a rest length
/// would carry if they were stretched by the span; rounding of positions hides what is less.
pub(super) fn least_force_scale(network: &Network<'_>) -> f64 {
    let stiffness = network.stiffness.iter().zip(network.rest_length.iter());
    let springs = stiffness.filter(|&(_, &rest)| rest > 0.0);
    let stretched = |span: f64| springs.map(|(k, rest)| k * rest.max(span)).fold(0.0, f64::max);
    // A rod reaches as far as it is long, however few of its nodes are held.
    let rod = network.rods.iter().map(|rod| rod.lengths.iter().sum()).fold(0.0, f64::max);
    load_scale(network).max(1e-6 * stretched(span(network).max(rod)))
}

/// The share of the largest load that residuals are measured by at least [N].
pub(super) fn load_scale(network: &Network<'_>) -> f64 {
    1e-6 * loads_at(network, &network.positions).into_iter().map(length).fold(LEAST_FORCE, f64::max)
}

/// Largest extent of the held nodes along an axis [m].
fn span(network: &Network<'_>) -> f64 {
    let extent = |axis: usize| {
        let nodes = || network.positions.iter().zip(network.fixed.iter());
        let along = || nodes().filter(|(_, axes)| axes[axis]).map(|(position, _)| position[axis]);
        along().fold(f64::MIN, f64::max) - along().fold(f64::MAX, f64::min)
    };
    (0..3).map(extent).fold(0.0, f64::max)
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
    network.slides.iter().for_each(|slide| held[slide.node as usize] = true);
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
