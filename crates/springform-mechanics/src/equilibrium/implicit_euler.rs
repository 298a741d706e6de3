//! The animated solver: implicit Euler steps, each one linear system solved by BiCGSTAB (the paper, footnote 1).
//!
//! Baraff & Witkin, "Large steps in cloth simulation", 1998; van der Vorst, "Bi-CGSTAB: a fast and smoothly
//! converging variant of Bi-CG", 1992. Departures from the particle library that the paper used: anchors are
//! taken out of the system instead of made heavy, and positions stay in double precision.

use super::state::{Equilibrium, Method, Settings, Status, residuals, unheld_node};
use super::supports::Supports;
use super::tangent::{own_bend_stiffness, own_stiffness, spring_tangent};
use crate::network::Network;
use crate::rod::Bend;
use crate::sparse::Block;
use crate::vector::{Vector, add, dot, scale, subtract};

/// How the net moves.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Motion {
    /// First time step, in units in which a node's mass equals the sum of its springs' stiffness.
    pub step: f64,
    /// Factor on the time step after every step; 1 for an even animation.
    pub growth: f64,
    /// Longest time step.
    pub longest_step: f64,
    /// Drag: force against velocity per unit of mass.
    pub drag: f64,
}

impl Default for Motion {
    fn default() -> Self {
        Motion { step: 0.5, growth: 1.25, longest_step: 1e3, drag: 1.0 }
    }
}

/// Relative residual at which a step's linear system counts as solved.
const LINEAR_TOLERANCE: f64 = 1e-5;

/// A net on its way to equilibrium.
#[derive(Clone, Debug)]
pub struct ImplicitEuler<'a> {
    network: Network<'a>,
    positions: Vec<Vector>,
    velocities: Vec<Vector>,
    masses: Vec<f64>,
    motion: Motion,
    supports: Supports,
    bends: Vec<Bend>,
}

impl<'a> ImplicitEuler<'a> {
    /// A net at rest at its start positions.
    pub fn new(network: Network<'a>, motion: Motion) -> Self {
        let mut masses = vec![0.0; network.positions.len()];
        let lengths = network.lengths(&network.positions);
        for (spring, &[a, b]) in network.springs.iter().enumerate() {
            let own = own_stiffness(&network, spring, lengths[spring]);
            masses[a as usize] += own;
            masses[b as usize] += own;
        }
        let bends: Vec<Bend> = network.rods.iter().flat_map(|rod| rod.bends()).collect();
        for bend in &bends {
            bend.nodes.iter().for_each(|&node| masses[node as usize] += own_bend_stiffness(bend));
        }
        ImplicitEuler {
            supports: Supports::from(&network),
            bends,
            positions: network.positions.to_vec(),
            velocities: vec![[0.0; 3]; network.positions.len()],
            network,
            masses,
            motion,
        }
    }

    /// The network that moves.
    pub fn network(&self) -> &Network<'a> {
        &self.network
    }

    /// Makes one time step: (M + h C + h² K) Δv = h (f − C v − h K v), x ← x + h (v + Δv).
    pub fn advance(&mut self) {
        let step = self.motion.step;
        let system = System { euler: self, tangents: self.tangents(), bends: self.bend_tangents(), step };
        let force = residuals(&self.network, &self.positions);
        let stiff = system.stiffness_times(&self.velocities);
        let side: Vec<Vector> = (0..force.len())
            .map(|node| {
                let drag = scale(self.velocities[node], self.motion.drag * self.masses[node]);
                let pull = subtract(subtract(force[node], drag), scale(stiff[node], step));
                self.supports.free_part(node, scale(pull, step))
            })
            .collect();
        let change = bicgstab(&system, &side);
        for (node, change) in change.into_iter().enumerate() {
            self.velocities[node] = add(self.velocities[node], change);
            self.positions[node] = add(self.positions[node], scale(self.velocities[node], step));
        }
        self.motion.step = (step * self.motion.growth).min(self.motion.longest_step);
    }

    /// The state now as a result; converged where the residual is within the tolerance.
    pub fn state(&self, settings: &Settings, steps: u32) -> Equilibrium {
        let mut state = Equilibrium::at(&self.network, self.positions.clone(), Status::Converged, steps);
        state.method = Method::ImplicitEuler;
        if state.status == Status::Converged && state.residual > settings.tolerance {
            state.status = Status::IterationLimit;
        }
        state
    }

    fn tangents(&self) -> Vec<Block> {
        let along = |&[a, b]: &[u32; 2]| subtract(self.positions[b as usize], self.positions[a as usize]);
        let springs = self.network.springs.iter().enumerate();
        springs.map(|(spring, ends)| spring_tangent(&self.network, spring, along(ends), true)).collect()
    }

    fn bend_tangents(&self) -> Vec<[Block; 3]> {
        let stiffness = |bend: &Bend| bend.bending(bend.links(&self.positions), true).stiffness;
        self.bends.iter().map(stiffness).collect()
    }
}

/// Moves a network that passes [`Network::check`] to equilibrium; `settings.iterations` counts time steps.
pub fn solve(network: &Network<'_>, settings: &Settings, motion: Motion) -> Equilibrium {
    if let Some(node) = unheld_node(network) {
        return Equilibrium::at(network, network.positions.to_vec(), Status::Unheld { node }, 0);
    }
    let mut euler = ImplicitEuler::new(network.clone(), motion);
    let mut steps = 0;
    loop {
        let state = euler.state(settings, steps);
        if state.status != Status::IterationLimit || steps >= settings.iterations {
            return state;
        }
        euler.advance();
        steps += 1;
    }
}

/// The matrix of one time step, never assembled.
struct System<'a> {
    euler: &'a ImplicitEuler<'a>,
    tangents: Vec<Block>,
    /// Over the two links of every bend.
    bends: Vec<[Block; 3]>,
    step: f64,
}

impl System<'_> {
    fn stiffness_times(&self, x: &[Vector]) -> Vec<Vector> {
        let network = &self.euler.network;
        let mut product = vec![[0.0; 3]; x.len()];
        for (&[a, b], tangent) in network.springs.iter().zip(&self.tangents) {
            let (a, b) = (a as usize, b as usize);
            let difference = subtract(x[a], x[b]);
            let pull = tangent.map(|row| dot(row, difference));
            product[a] = add(product[a], pull);
            product[b] = subtract(product[b], pull);
        }
        for (bend, [uu, uv, vv]) in self.euler.bends.iter().zip(&self.bends) {
            let [a, b, c] = bend.nodes.map(|node| node as usize);
            let (first, second) = (subtract(x[b], x[a]), subtract(x[c], x[b]));
            let on_first = add(uu.map(|row| dot(row, first)), uv.map(|row| dot(row, second)));
            let turned: Vector = std::array::from_fn(|i| (0..3).map(|j| uv[j][i] * first[j]).sum());
            let on_second = add(turned, vv.map(|row| dot(row, second)));
            product[a] = subtract(product[a], on_first);
            product[b] = add(product[b], subtract(on_first, on_second));
            product[c] = add(product[c], on_second);
        }
        product
    }

    fn times(&self, x: &[Vector]) -> Vec<Vector> {
        let mut product = self.stiffness_times(x);
        let inertia = 1.0 + self.step * self.euler.motion.drag;
        for (node, row) in product.iter_mut().enumerate() {
            let still = scale(x[node], inertia * self.euler.masses[node]);
            let moving = add(still, scale(*row, self.step * self.step));
            *row = add(
                self.euler.supports.free_part(node, moving),
                self.euler.supports.held_part(node, x[node]),
            );
        }
        product
    }
}

fn bicgstab(system: &System<'_>, side: &[Vector]) -> Vec<Vector> {
    let inner = |a: &[Vector], b: &[Vector]| -> f64 { a.iter().zip(b).map(|(&a, &b)| dot(a, b)).sum() };
    let combine = |a: &[Vector], s: f64, b: &[Vector]| -> Vec<Vector> {
        a.iter().zip(b).map(|(&a, &b)| add(a, scale(b, s))).collect()
    };
    let mut x = vec![[0.0; 3]; side.len()];
    let goal = LINEAR_TOLERANCE * LINEAR_TOLERANCE * inner(side, side);
    let mut residual = side.to_vec();
    let shadow = residual.clone();
    let mut direction = residual.clone();
    let mut rho = inner(&shadow, &residual);
    for _ in 0..3 * side.len() + 100 {
        if inner(&residual, &residual) <= goal || rho == 0.0 {
            break;
        }
        let moved = system.times(&direction);
        let alpha = rho / inner(&shadow, &moved);
        let half = combine(&residual, -alpha, &moved);
        let turned = system.times(&half);
        let norm = inner(&turned, &turned);
        let omega = if norm > 0.0 { inner(&turned, &half) / norm } else { 0.0 };
        x = combine(&combine(&x, alpha, &direction), omega, &half);
        residual = combine(&half, -omega, &turned);
        let next = inner(&shadow, &residual);
        if omega == 0.0 || !next.is_finite() {
            break;
        }
        let beta = (next / rho) * (alpha / omega);
        direction = combine(&residual, beta, &combine(&direction, -omega, &moved));
        rho = next;
    }
    x
}
