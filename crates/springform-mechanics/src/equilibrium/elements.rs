//! Springs and bends compiled for evaluation: pull on every node, energy and mean force in one pass.

use super::state::force_density;
use crate::network::{NO_CURVE, Network, Sense};
use crate::rod::Bend;
use crate::sparse::Lanes;
use crate::vector::{Vector, length, scale, subtract};
use pulp::{Arch, NullaryFnOnce};

/// Springs that are evaluated side by side.
const WIDTH: usize = 4;

/// Numbers of [`WIDTH`] springs; springs of no force fill the last ones up.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Pack {
    ends: [[u32; 2]; WIDTH],
    stiffness: Lanes,
    rest: Lanes,
    constant: Lanes,
    least: Lanes,
    most: Lanes,
    compliance: Lanes,
    /// Constant force of springs without stiffness.
    pull: Lanes,
}

const NONE: Pack = Pack {
    ends: [[0; 2]; WIDTH],
    stiffness: [0.0; WIDTH],
    rest: [0.0; WIDTH],
    constant: [0.0; WIDTH],
    least: [0.0; WIDTH],
    most: [0.0; WIDTH],
    compliance: [0.0; WIDTH],
    pull: [0.0; WIDTH],
};

/// What a network's springs and rods do, ready to be evaluated at any positions.
#[derive(Clone, PartialEq, Debug, Default)]
pub(super) struct Elements {
    packs: Vec<Pack>,
    /// Springs of a measured curve.
    curved: Vec<u32>,
    pub(super) bends: Vec<Bend>,
    loads: Vec<Lanes>,
    springs: usize,
}

/// A network's state at positions.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(super) struct State {
    /// Energy of springs, rods and dead loads [J].
    pub(super) energy: f64,
    /// Rounding of the energy [J].
    pub(super) noise: f64,
    /// Mean size of the spring forces [N].
    pub(super) mean_force: f64,
}

impl Elements {
    /// Compiles a network's springs and bends, and its dead loads with `more` on top.
    pub(super) fn build(&mut self, network: &Network<'_>, more: &[Vector]) {
        self.springs = network.springs.len();
        self.curved.clear();
        self.packs.clear();
        self.packs.resize(self.springs.div_ceil(WIDTH), NONE);
        for (spring, &ends) in network.springs.iter().enumerate() {
            let (pack, lane) = (&mut self.packs[spring / WIDTH], spring % WIDTH);
            pack.ends[lane] = ends;
            if network.curve.get(spring).is_some_and(|&curve| curve != NO_CURVE) {
                self.curved.push(spring as u32);
                continue;
            }
            let (k, constant) = (network.stiffness[spring], network.force[spring]);
            pack.stiffness[lane] = k;
            pack.rest[lane] = network.rest_length[spring];
            pack.constant[lane] = constant;
            (pack.least[lane], pack.most[lane]) = match network.sense[spring] {
                Sense::Tension => (0.0, f64::INFINITY),
                Sense::Both => (f64::NEG_INFINITY, f64::INFINITY),
                Sense::Compression => (f64::NEG_INFINITY, 0.0),
            };
            (pack.compliance[lane], pack.pull[lane]) = if k > 0.0 { (1.0 / k, 0.0) } else { (0.0, 1.0) };
        }
        self.bends.clear();
        self.bends.extend(network.rods.iter().flat_map(|rod| rod.bends()));
        self.loads.clear();
        self.loads.extend(network.loads.iter().map(|&[x, y, z]| [x, y, z, 0.0]));
        for (load, more) in self.loads.iter_mut().zip(more) {
            (0..3).for_each(|axis| load[axis] += more[axis]);
        }
    }

    /// Dead load on every node [N].
    pub(super) fn loads(&self) -> &[Lanes] {
        &self.loads
    }

    /// Pull of springs, rods and loads on every node [N], and the state.
    pub(super) fn evaluate(
        &self,
        network: &Network<'_>,
        positions: &[Lanes],
        pulls: &mut Vec<Lanes>,
    ) -> State {
        pulls.clear();
        pulls.extend_from_slice(&self.loads);
        let mut sums = Arch::new().dispatch(Evaluate { packs: &self.packs, positions, pulls });
        for &spring in &self.curved {
            let [a, b] = network.springs[spring as usize].map(|node| node as usize);
            let along = subtract(vector(positions[b]), vector(positions[a]));
            let size = length(along);
            let force = network.force_at(spring as usize, size);
            let pull = scale(along, force_density(network, spring as usize, size));
            (0..3).for_each(|axis| {
                pulls[a][axis] += pull[axis];
                pulls[b][axis] -= pull[axis];
            });
            sums.energy += network.energy_at(spring as usize, size);
            sums.force += force.abs();
            sums.work += (force * size).abs();
        }
        for bend in &self.bends {
            let [a, b, c] = bend.nodes.map(|node| node as usize);
            let [first, second] =
                [(a, b), (b, c)].map(|(a, b)| subtract(vector(positions[b]), vector(positions[a])));
            let bending = bend.bending([first, second], false);
            for axis in 0..3 {
                let [first, second] = bending.forces.map(|force| force[axis]);
                pulls[a][axis] += first;
                pulls[b][axis] += second - first;
                pulls[c][axis] -= second;
            }
            sums.energy += bending.energy;
            sums.work += bending.energy;
        }
        for (load, position) in self.loads.iter().zip(positions) {
            let work: f64 = (0..3).map(|axis| load[axis] * position[axis]).sum();
            sums.energy -= work;
            sums.work += work.abs();
        }
        State {
            energy: sums.energy,
            noise: 1e-15 * sums.work,
            mean_force: sums.force / self.springs.max(1) as f64,
        }
    }
}

#[derive(Clone, Copy)]
struct Sums {
    energy: f64,
    force: f64,
    /// Force times length, whose rounding the energy has.
    work: f64,
}

struct Evaluate<'a> {
    packs: &'a [Pack],
    positions: &'a [Lanes],
    pulls: &'a mut [Lanes],
}

impl NullaryFnOnce for Evaluate<'_> {
    type Output = Sums;

    #[inline(always)]
    fn call(self) -> Sums {
        let (mut energy, mut force_sum, mut work) = ([0.0; WIDTH], [0.0; WIDTH], [0.0; WIDTH]);
        for pack in self.packs {
            let ends = pack.ends.map(|[a, b]| [self.positions[a as usize], self.positions[b as usize]]);
            let along = ends.map(|[a, b]| [b[0] - a[0], b[1] - a[1], b[2] - a[2], 0.0]);
            let mut square = [0.0; WIDTH];
            for lane in 0..WIDTH {
                let [x, y, z, _] = along[lane];
                square[lane] = x.mul_add(x, y.mul_add(y, z * z));
            }
            let mut density = [0.0; WIDTH];
            for lane in 0..WIDTH {
                let size = square[lane].sqrt();
                let elastic = pack.stiffness[lane].mul_add(size - pack.rest[lane], pack.constant[lane]);
                // A number that is lost stays lost: `max` and `min` would hide it.
                let force = if elastic < pack.least[lane] { pack.least[lane] } else { elastic };
                let force = if force > pack.most[lane] { pack.most[lane] } else { force };
                // A spring of no length pulls nowhere, with whatever force.
                density[lane] = force / if size > 0.0 { size } else { 1.0 };
                energy[lane] += force * (0.5 * force).mul_add(pack.compliance[lane], pack.pull[lane] * size);
                force_sum[lane] += force.abs();
                work[lane] += force.abs() * size;
            }
            for lane in 0..WIDTH {
                let [a, b] = pack.ends[lane];
                let pull = along[lane].map(|value| value * density[lane]);
                let first = &mut self.pulls[a as usize];
                (0..4).for_each(|axis| first[axis] += pull[axis]);
                let second = &mut self.pulls[b as usize];
                (0..4).for_each(|axis| second[axis] -= pull[axis]);
            }
        }
        Sums { energy: total(energy), force: total(force_sum), work: total(work) }
    }
}

fn total(lanes: Lanes) -> f64 {
    (lanes[0] + lanes[1]) + (lanes[2] + lanes[3])
}

/// The first three numbers.
pub(super) fn vector(lanes: Lanes) -> Vector {
    [lanes[0], lanes[1], lanes[2]]
}
