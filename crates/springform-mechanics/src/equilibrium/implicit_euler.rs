//! The animated solver: implicit Euler steps, each one linear system solved by BiCGSTAB (the paper, footnote 1).
//!
//! Baraff & Witkin, "Large steps in cloth simulation", 1998; van der Vorst, "Bi-CGSTAB: a fast and smoothly
//! converging variant of Bi-CG", 1992. Departures from the particle library that the paper used: anchors are
//! taken out of the system instead of made heavy, and positions stay in double precision.

use super::state::{Equilibrium, Settings, Status, residuals, unheld_node};
use super::tangent::{own_stiffness, spring_tangent};
use crate::network::Network;
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
        ImplicitEuler {
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
        let system = System { euler: self, tangents: self.tangents(), step };
        let force = residuals(&self.network, &self.positions);
        let stiff = system.stiffness_times(&self.velocities);
        let side: Vec<Vector> = (0..force.len())
            .map(|node| {
                let drag = scale(self.velocities[node], self.motion.drag * self.masses[node]);
                let pull = subtract(subtract(force[node], drag), scale(stiff[node], step));
                free_part(&self.network, node, scale(pull, step), [0.0; 3])
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
        if state.status == Status::Converged && state.residual > settings.tolerance {
            state.status = Status::IterationLimit;
        }
        state
    }

    fn tangents(&self) -> Vec<[Vector; 3]> {
        let along = |&[a, b]: &[u32; 2]| subtract(self.positions[b as usize], self.positions[a as usize]);
        let springs = self.network.springs.iter().enumerate();
        springs.map(|(spring, ends)| spring_tangent(&self.network, spring, along(ends), true)).collect()
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
    tangents: Vec<[Vector; 3]>,
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
        product
    }

    fn times(&self, x: &[Vector]) -> Vec<Vector> {
        let mut product = self.stiffness_times(x);
        let inertia = 1.0 + self.step * self.euler.motion.drag;
        for (node, row) in product.iter_mut().enumerate() {
            let still = scale(x[node], inertia * self.euler.masses[node]);
            let moving = add(still, scale(*row, self.step * self.step));
            *row = free_part(&self.euler.network, node, moving, x[node]);
        }
        product
    }
}

/// `free` along the axes on which a node is free, `held` along the others.
fn free_part(network: &Network<'_>, node: usize, free: Vector, held: Vector) -> Vector {
    let axes = network.fixed[node];
    std::array::from_fn(|axis| if axes[axis] { held[axis] } else { free[axis] })
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
