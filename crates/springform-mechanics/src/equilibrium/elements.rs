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
            let pull = scale(along, force_density(network, spring as usize, size, force));
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
        let Evaluate { packs, positions, pulls } = self;
        let (mut energy, mut force_sum, mut work) = ([0.0; WIDTH], [0.0; WIDTH], [0.0; WIDTH]);
        for pack in packs {
            let mut along = [[0.0; 4]; WIDTH];
            for (along, [a, b]) in along.iter_mut().zip(pack.ends) {
                *along = minus(&positions[b as usize], &positions[a as usize]);
            }
            let [x, y, z] =
                [0, 1, 2].map(|axis| [along[0][axis], along[1][axis], along[2][axis], along[3][axis]]);
            let mut density = [0.0; WIDTH];
            for lane in 0..WIDTH {
                let square = x[lane].mul_add(x[lane], y[lane].mul_add(y[lane], z[lane] * z[lane]));
                let size = square.sqrt();
                let elastic = pack.stiffness[lane].mul_add(size - pack.rest[lane], pack.constant[lane]);
                // A number that is lost stays lost: `max` and `min` would hide it.
                let force = if elastic < pack.least[lane] { pack.least[lane] } else { elastic };
                let force = if force > pack.most[lane] { pack.most[lane] } else { force };
                // A spring of no length pulls nowhere, with whatever force.
                density[lane] = force / if size > 0.0 { size } else { 1.0 };
                let mean = (0.5 * force).mul_add(pack.compliance[lane], pack.pull[lane] * size);
                energy[lane] = force.mul_add(mean, energy[lane]);
                force_sum[lane] += force.abs();
                work[lane] = force.abs().mul_add(size, work[lane]);
            }
            for (([a, b], along), density) in pack.ends.into_iter().zip(&along).zip(density) {
                add_times(&mut pulls[a as usize], along, density);
                add_times(&mut pulls[b as usize], along, -density);
            }
        }
        Sums { energy: total(energy), force: total(force_sum), work: total(work) }
    }
}

#[inline(always)]
fn minus(a: &Lanes, b: &Lanes) -> Lanes {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]]
}

/// a += s b.
#[inline(always)]
fn add_times(a: &mut Lanes, b: &Lanes, s: f64) {
    for lane in 0..4 {
        a[lane] = s.mul_add(b[lane], a[lane]);
    }
}

fn total(lanes: Lanes) -> f64 {
    (lanes[0] + lanes[1]) + (lanes[2] + lanes[3])
}

/// The first three numbers.
pub(super) fn vector(lanes: Lanes) -> Vector {
    [lanes[0], lanes[1], lanes[2]]
}
