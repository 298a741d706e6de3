//! Dynamic relaxation with kinetic damping: an explicit cross-check of the solvers that factor a matrix.
//!
//! Barnes, "Form finding and analysis of tension structures by dynamic relaxation", International Journal of Space
//! Structures 14(2), 1999. Nodes get fictitious masses, move freely under the forces out of balance, and stop
//! dead whenever their kinetic energy has passed a peak. Springs are worked on several at a time, in lanes, by code that
//! is compiled for the processor's vector units (crate `pulp`).

use super::state::{Equilibrium, Method, Settings, Status, unheld_node};
use super::tangent::own_stiffness;
use crate::network::{Network, Sense};
use pulp::{Arch, NullaryFnOnce};

/// Springs worked on at a time.
const LANES: usize = 8;

/// Factor on the masses that stand on the bound of stability, for what changes between two peaks.
const SAFETY: f64 = 1.05;

/// Whether a network has nothing but springs without curves, dead loads and nodes that are held along axes.
pub fn suits(network: &Network<'_>) -> bool {
    let plain = network.rods.is_empty() && network.slides.is_empty() && !network.has_followers();
    plain && (0..network.springs.len()).all(|spring| network.curve_of(spring).is_none())
}

/// Moves a network that passes [`Network::check`] and [`suits`] to equilibrium; `settings.iterations` counts time steps.
pub fn solve(network: &Network<'_>, settings: &Settings) -> Equilibrium {
    if let Some(node) = unheld_node(network) {
        return Equilibrium::at(network, network.positions.to_vec(), Status::Unheld { node }, 0);
    }
    let (mut net, arch) = (Relaxation::new(network), Arch::new());
    let mut steps = 0;
    loop {
        arch.dispatch(Pull(&mut net));
        let calm = net.largest_unbalanced() <= settings.tolerance * net.mean_force;
        if calm || steps >= settings.iterations || !net.kinetic.is_finite() {
            let result = Equilibrium::at(network, net.vectors(), Status::Converged, steps);
            let result = Equilibrium { method: Method::DynamicRelaxation, ..result };
            if result.residual <= settings.tolerance || result.status != Status::Converged {
                return result;
            }
            if steps >= settings.iterations {
                return Equilibrium { status: Status::IterationLimit, ..result };
            }
        }
        arch.dispatch(Advance(&mut net));
        if net.at_rest {
            net.weigh(network);
        }
        steps += 1;
    }
}

/// A net in motion. Coordinates stand in one row, x y z x y z …; time steps are of length one.
struct Relaxation {
    springs: Vec<Lanes>,
    /// Number of springs, at least 1.
    count: f64,
    /// Loads [N].
    loads: Vec<f64>,
    /// One over the mass of every coordinate [m/N]; zero where it is held.
    mobility: Vec<f64>,
    /// Which coordinates are free.
    free: Vec<bool>,
    position: Vec<f64>,
    velocity: Vec<f64>,
    unbalanced: Vec<f64>,
    mean_force: f64,
    kinetic: f64,
    /// The next step starts from rest.
    at_rest: bool,
}

/// The ends and laws of several springs; lanes left over hold springs of no stiffness.
struct Lanes {
    ends: [[u32; 2]; LANES],
    stiffness: [f64; LANES],
    /// Force at length zero [N].
    offset: [f64; LANES],
    /// Bounds of the force by the spring's sense [N].
    least: [f64; LANES],
    most: [f64; LANES],
}

impl Relaxation {
    fn new(network: &Network<'_>) -> Self {
        let springs: Vec<usize> = (0..network.springs.len()).collect();
        let position: Vec<f64> = network.positions.iter().flatten().copied().collect();
        let mut net = Relaxation {
            count: springs.len().max(1) as f64,
            springs: springs.chunks(LANES).map(|some| Lanes::new(network, some)).collect(),
            loads: network.loads.iter().flatten().copied().collect(),
            mobility: Vec::new(),
            free: network.fixed.iter().flatten().map(|&held| !held).collect(),
            velocity: vec![0.0; position.len()],
            unbalanced: vec![0.0; position.len()],
            position,
            mean_force: 0.0,
            kinetic: 0.0,
            at_rest: true,
        };
        net.weigh(network);
        net
    }

    /// Gives every coordinate the least mass at which steps of length one are stable: half the sum of its springs' stiffness.
    fn weigh(&mut self, network: &Network<'_>) {
        let mut masses = vec![0.0; network.positions.len()];
        let lengths = network.lengths(&self.vectors());
        for (spring, ends) in network.springs.iter().enumerate() {
            let own = 0.5 * SAFETY * own_stiffness(network, spring, lengths[spring]);
            ends.iter().for_each(|&node| masses[node as usize] += own);
        }
        let masses = masses.iter().flat_map(|&mass| [mass; 3]).zip(&self.free);
        self.mobility =
            masses.map(|(mass, &free)| if free && mass > 0.0 { 1.0 / mass } else { 0.0 }).collect();
    }

    /// Sums forces out of balance.
    #[inline(always)]
    fn pull(&mut self) {
        self.unbalanced.copy_from_slice(&self.loads);
        let mut total = [0.0; LANES];
        for lanes in &self.springs {
            lanes.pull(&self.position, &mut self.unbalanced, &mut total);
        }
        self.mean_force = total.iter().sum::<f64>() / self.count;
    }

    fn largest_unbalanced(&self) -> f64 {
        let nodes = self.unbalanced.as_chunks::<3>().0.iter().zip(self.free.as_chunks::<3>().0);
        let square = |(force, free): (&[f64; 3], &[bool; 3])| -> f64 {
            (0..3).map(|axis| if free[axis] { force[axis] * force[axis] } else { 0.0 }).sum()
        };
        nodes.map(square).fold(0.0, f64::max).sqrt()
    }

    /// Makes one time step, or stops the net where its kinetic energy was largest.
    #[inline(always)]
    fn advance(&mut self) {
        let share = if self.at_rest { 0.5 } else { 1.0 };
        let mut kinetic = [0.0; LANES];
        let coordinates = self.velocity.chunks_mut(LANES).zip(self.position.chunks_mut(LANES));
        let forces = self.unbalanced.chunks(LANES).zip(self.mobility.chunks(LANES));
        for ((velocity, position), (force, mobility)) in coordinates.zip(forces) {
            for lane in 0..velocity.len() {
                let gained = force[lane] * mobility[lane];
                velocity[lane] += share * gained;
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
        for at in 0..self.position.len() {
            self.position[at] -= 1.5 * self.velocity[at] - 0.5 * self.unbalanced[at] * self.mobility[at];
            self.velocity[at] = 0.0;
        }
        (self.kinetic, self.at_rest) = (0.0, true);
    }

    fn vectors(&self) -> Vec<[f64; 3]> {
        self.position.as_chunks().0.to_vec()
    }
}

struct Pull<'a>(&'a mut Relaxation);

impl NullaryFnOnce for Pull<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.0.pull();
    }
}

struct Advance<'a>(&'a mut Relaxation);

impl NullaryFnOnce for Advance<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.0.advance();
    }
}

impl Lanes {
    fn new(network: &Network<'_>, springs: &[usize]) -> Self {
        let value = |read: &dyn Fn(usize) -> f64| -> [f64; LANES] {
            std::array::from_fn(|lane| springs.get(lane).map_or(0.0, |&spring| read(spring)))
        };
        Lanes {
            ends: std::array::from_fn(|lane| springs.get(lane).map_or([0; 2], |&at| network.springs[at])),
            stiffness: value(&|at| network.stiffness[at]),
            offset: value(&|at| network.force[at] - network.stiffness[at] * network.rest_length[at]),
            least: value(&|at| if network.sense[at] == Sense::Tension { 0.0 } else { f64::NEG_INFINITY }),
            most: value(&|at| if network.sense[at] == Sense::Compression { 0.0 } else { f64::INFINITY }),
        }
    }

    /// Adds the pull of these springs at their ends, and the size of their forces to `total`.
    #[inline(always)]
    fn pull(&self, position: &[f64], unbalanced: &mut [f64], total: &mut [f64; LANES]) {
        let mut along = [[0.0; LANES]; 3];
        for (lane, ends) in self.ends.iter().enumerate() {
            let [a, b] = ends.map(|node| 3 * node as usize);
            let (a, b) = (&position[a..a + 3], &position[b..b + 3]);
            for axis in 0..3 {
                along[axis][lane] = b[axis] - a[axis];
            }
        }
        let [x, y, z] = &mut along;
        for lane in 0..LANES {
            let length = (x[lane] * x[lane] + y[lane] * y[lane] + z[lane] * z[lane]).sqrt();
            let elastic = self.offset[lane] + self.stiffness[lane] * length;
            let force = elastic.max(self.least[lane]).min(self.most[lane]);
            total[lane] += force.abs();
            let density = if length > 0.0 { force / length } else { 0.0 };
            x[lane] *= density;
            y[lane] *= density;
            z[lane] *= density;
        }
        for (lane, ends) in self.ends.iter().enumerate() {
            let [a, b] = ends.map(|node| 3 * node as usize);
            for (axis, pull) in along.iter().enumerate() {
                unbalanced[a + axis] += pull[lane];
                unbalanced[b + axis] -= pull[lane];
            }
        }
    }
}
