//! Dynamic relaxation with kinetic damping: an explicit cross-check of the solvers that factor a matrix.
//!
//! Barnes, "Form finding and analysis of tension structures by dynamic relaxation", International Journal of Space
//! Structures 14(2), 1999. Nodes get fictitious masses, move freely under the forces out of balance, and stop
//! dead whenever their kinetic energy has passed a peak. Springs are worked on several at a time, by code that is
//! compiled for the processor's vector units (crate `pulp`).

use super::state::{Equilibrium, Method, Settings, Status, unheld_node};
use super::tangent::own_stiffness;
use crate::network::{Network, Sense};
use crate::sparse::Lanes;
use crate::vector::Vector;
use pulp::{Arch, NullaryFnOnce};

/// Springs worked on at a time.
const TOGETHER: usize = 8;

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

/// A net in motion; time steps are of length one. What belongs to a node stands in four lanes, x y z and one of zeros.
struct Relaxation {
    springs: Vec<Springs>,
    /// Number of springs, at least 1.
    count: f64,
    /// Loads [N].
    loads: Vec<Lanes>,
    /// One over the mass of every node along each axis [m/N]; zero where it is held.
    mobility: Vec<Lanes>,
    position: Vec<Lanes>,
    velocity: Vec<Lanes>,
    unbalanced: Vec<Lanes>,
    mean_force: f64,
    kinetic: f64,
    /// The next step starts from rest.
    at_rest: bool,
}

/// The ends and laws of several springs; places left over hold springs of no stiffness.
struct Springs {
    ends: [[u32; 2]; TOGETHER],
    stiffness: [f64; TOGETHER],
    /// Force at length zero [N].
    offset: [f64; TOGETHER],
    /// Bounds of the force by the spring's sense [N].
    least: [f64; TOGETHER],
    most: [f64; TOGETHER],
}

fn lanes(&[x, y, z]: &Vector) -> Lanes {
    [x, y, z, 0.0]
}

impl Relaxation {
    fn new(network: &Network<'_>) -> Self {
        let springs: Vec<usize> = (0..network.springs.len()).collect();
        let nodes = network.positions.len();
        let mut net = Relaxation {
            count: springs.len().max(1) as f64,
            springs: springs.chunks(TOGETHER).map(|some| Springs::new(network, some)).collect(),
            loads: network.loads.iter().map(lanes).collect(),
            mobility: vec![[0.0; 4]; nodes],
            position: network.positions.iter().map(lanes).collect(),
            velocity: vec![[0.0; 4]; nodes],
            unbalanced: vec![[0.0; 4]; nodes],
            mean_force: 0.0,
            kinetic: 0.0,
            at_rest: true,
        };
        net.weigh(network);
        net
    }

    /// Gives every node the least mass at which steps of length one are stable: half the sum of its springs' stiffness.
    fn weigh(&mut self, network: &Network<'_>) {
        let mut masses = vec![0.0; network.positions.len()];
        let lengths = network.lengths(&self.vectors());
        for (spring, ends) in network.springs.iter().enumerate() {
            let own = 0.5 * SAFETY * own_stiffness(network, spring, lengths[spring]);
            ends.iter().for_each(|&node| masses[node as usize] += own);
        }
        for ((mobility, mass), held) in self.mobility.iter_mut().zip(masses).zip(network.fixed.iter()) {
            let along = |axis: usize| if held[axis] || mass == 0.0 { 0.0 } else { 1.0 / mass };
            *mobility = [along(0), along(1), along(2), 0.0];
        }
    }

    /// Sums forces out of balance.
    #[inline(always)]
    fn pull(&mut self) {
        self.unbalanced.copy_from_slice(&self.loads);
        let mut total = [0.0; TOGETHER];
        for springs in &self.springs {
            springs.pull(&self.position, &mut self.unbalanced, &mut total);
        }
        self.mean_force = total.iter().sum::<f64>() / self.count;
    }

    /// Largest force out of balance at a node, along the axes on which it moves [N].
    #[inline(always)]
    fn largest_unbalanced(&self) -> f64 {
        let nodes = self.unbalanced.iter().zip(&self.mobility);
        let square = |(force, mobility): (&Lanes, &Lanes)| -> f64 {
            (0..4).map(|lane| if mobility[lane] > 0.0 { force[lane] * force[lane] } else { 0.0 }).sum()
        };
        nodes.map(square).fold(0.0, f64::max).sqrt()
    }

    /// Makes one time step, or stops the net where its kinetic energy was largest.
    #[inline(always)]
    fn advance(&mut self) {
        let share = if self.at_rest { 0.5 } else { 1.0 };
        let mut kinetic = [0.0; 4];
        let moving = self.velocity.iter_mut().zip(&mut self.position);
        for ((velocity, position), (force, mobility)) in
            moving.zip(self.unbalanced.iter().zip(&self.mobility))
        {
            for lane in 0..4 {
                velocity[lane] += share * force[lane] * mobility[lane];
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
        for node in 0..self.position.len() {
            for lane in 0..4 {
                let gained = self.unbalanced[node][lane] * self.mobility[node][lane];
                self.position[node][lane] -= 1.5 * self.velocity[node][lane] - 0.5 * gained;
            }
            self.velocity[node] = [0.0; 4];
        }
        (self.kinetic, self.at_rest) = (0.0, true);
    }

    fn vectors(&self) -> Vec<Vector> {
        self.position.iter().map(|&[x, y, z, _]| [x, y, z]).collect()
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

impl Springs {
    fn new(network: &Network<'_>, springs: &[usize]) -> Self {
        let value = |read: &dyn Fn(usize) -> f64| -> [f64; TOGETHER] {
            std::array::from_fn(|place| springs.get(place).map_or(0.0, |&spring| read(spring)))
        };
        Springs {
            ends: std::array::from_fn(|place| springs.get(place).map_or([0; 2], |&at| network.springs[at])),
            stiffness: value(&|at| network.stiffness[at]),
            offset: value(&|at| network.force[at] - network.stiffness[at] * network.rest_length[at]),
            least: value(&|at| if network.sense[at] == Sense::Tension { 0.0 } else { f64::NEG_INFINITY }),
            most: value(&|at| if network.sense[at] == Sense::Compression { 0.0 } else { f64::INFINITY }),
        }
    }

    /// Adds the pull of these springs at their ends, and the size of their forces to `total`.
    #[inline(always)]
    fn pull(&self, position: &[Lanes], unbalanced: &mut [Lanes], total: &mut [f64; TOGETHER]) {
        let mut along = [[0.0; 4]; TOGETHER];
        let mut density = [0.0; TOGETHER];
        for (place, &[a, b]) in self.ends.iter().enumerate() {
            let (a, b) = (position[a as usize], position[b as usize]);
            let way: Lanes = std::array::from_fn(|lane| b[lane] - a[lane]);
            density[place] = way[0] * way[0] + way[1] * way[1] + way[2] * way[2];
            along[place] = way;
        }
        for place in 0..TOGETHER {
            let length = density[place].sqrt();
            let elastic = self.offset[place] + self.stiffness[place] * length;
            let force = elastic.max(self.least[place]).min(self.most[place]);
            total[place] += force.abs();
            density[place] = if length > 0.0 { force / length } else { 0.0 };
        }
        for (place, &[a, b]) in self.ends.iter().enumerate() {
            let pull = along[place].map(|part| part * density[place]);
            let end = &mut unbalanced[a as usize];
            (0..4).for_each(|lane| end[lane] += pull[lane]);
            let end = &mut unbalanced[b as usize];
            (0..4).for_each(|lane| end[lane] -= pull[lane]);
        }
    }
}
