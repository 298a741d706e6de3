//! Force as stiffness times length: one Laplacian system with three right-hand sides (Schek 1974).

use super::state::{Equilibrium, Method, Settings, Status};
use super::supports::Supports;
use super::tangent::Layout;
use crate::network::Network;
use crate::sparse::{Graph, Lanes, ScalarFactor};
use crate::stage::Stage;
use pulp::{Arch, NullaryFnOnce};

/// Workspace of linear solves.
#[derive(Clone, PartialEq, Debug, Default)]
pub(super) struct Linear {
    diagonal: Vec<f64>,
    weights: Vec<f64>,
    factor: ScalarFactor,
    /// Pattern that the factor is laid out for.
    pattern: u64,
    sides: Vec<Lanes>,
    positions: Vec<Lanes>,
    pulls: Vec<Lanes>,
    loads: Vec<Lanes>,
    forces: Vec<f64>,
}

/// Refinements stop helping after very few; what is left then is rounding.
const MOST_REFINEMENTS: u32 = 5;

impl Linear {
    /// Solves a network that is linear ([`Network::is_linear`]) and held.
    ///
    /// The start is the origin: the outcome is to depend on nothing but topology, anchors and loads.
    pub(super) fn solve(
        &mut self,
        network: &Network<'_>,
        supports: &Supports,
        layout: &Layout,
        settings: &Settings,
        result: &mut Equilibrium,
        observe: &mut impl FnMut(Stage),
    ) {
        self.assemble(network, supports, layout);
        if self.pattern != layout.pattern {
            self.factor.lay_out(&layout.graph, &layout.symbolic);
            self.pattern = layout.pattern;
        }
        result.method = Method::Linear;
        result.iterations = 0;
        if self.factor.factor(&layout.graph, &layout.symbolic, &self.diagonal, &self.weights).is_err() {
            *result = Equilibrium::at(network, network.positions.to_vec(), Status::Singular, 0);
            return;
        }
        observe(Stage::Factor);
        loop {
            self.factor.solve(&mut self.sides);
            for (&node, step) in supports.nodes.iter().zip(&self.sides) {
                let position = &mut self.positions[node as usize];
                (0..3).for_each(|axis| position[axis] += step[axis]);
            }
            result.iterations += 1;
            self.look(network, supports, result);
            if result.residual <= settings.tolerance {
                result.status = Status::Converged;
                break;
            }
            if !result.residual.is_finite() {
                result.status = Status::Singular;
                break;
            }
            if result.iterations >= settings.iterations.min(MOST_REFINEMENTS) {
                result.status = Status::IterationLimit;
                break;
            }
            self.sides.clear();
            self.sides.extend(supports.nodes.iter().map(|&node| self.pulls[node as usize]));
        }
        result.positions.clear();
        result.positions.extend(self.positions.iter().map(|&[x, y, z, _]| [x, y, z]));
        result.forces.clone_from(&self.forces);
        observe(Stage::Solve);
    }

    fn assemble(&mut self, network: &Network<'_>, supports: &Supports, layout: &Layout) {
        let rows = supports.nodes.len();
        self.diagonal.clear();
        self.diagonal.resize(rows, 0.0);
        self.weights.clear();
        self.weights.extend(network.stiffness.iter().map(|k| -k));
        self.loads.clear();
        self.loads.extend(network.loads.iter().map(|&[x, y, z]| [x, y, z, 0.0]));
        self.positions.clear();
        self.positions.resize(network.positions.len(), [0.0; 4]);
        self.sides.clear();
        self.sides.extend(supports.nodes.iter().map(|&node| self.loads[node as usize]));
        for (node, &row) in supports.rows.iter().enumerate() {
            if row == Graph::OUTSIDE {
                let [x, y, z] = network.positions[node];
                self.positions[node] = [x, y, z, 0.0];
            }
        }
        for (spring, &[a, b]) in layout.ends.iter().enumerate() {
            let k = network.stiffness[spring];
            for (row, other, end) in [(a, b, 1), (b, a, 0)] {
                if row == Graph::OUTSIDE {
                    continue;
                }
                self.diagonal[row as usize] += k;
                if other == Graph::OUTSIDE {
                    let held = self.positions[network.springs[spring][end] as usize];
                    let side = &mut self.sides[row as usize];
                    (0..3).for_each(|axis| side[axis] += k * held[axis]);
                }
            }
        }
    }

    /// Forces, pulls, and the largest residual over the mean force.
    fn look(&mut self, network: &Network<'_>, supports: &Supports, result: &mut Equilibrium) {
        self.pulls.clone_from(&self.loads);
        self.forces.clear();
        self.forces.resize(network.springs.len(), 0.0);
        let total = Arch::new().dispatch(Pull {
            springs: &network.springs,
            stiffness: &network.stiffness,
            positions: &self.positions,
            pulls: &mut self.pulls,
            forces: &mut self.forces,
        });
        let mean = total / network.springs.len().max(1) as f64;
        result.measure(network, mean, supports.nodes.iter().map(|&node| (node, self.pulls[node as usize])));
    }
}

struct Pull<'a> {
    springs: &'a [[u32; 2]],
    stiffness: &'a [f64],
    positions: &'a [Lanes],
    pulls: &'a mut [Lanes],
    forces: &'a mut [f64],
}

impl NullaryFnOnce for Pull<'_> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        for ((&[a, b], &k), force) in self.springs.iter().zip(self.stiffness).zip(&mut *self.forces) {
            let (from, to) = (self.positions[a as usize], self.positions[b as usize]);
            let along: Lanes = std::array::from_fn(|axis| to[axis] - from[axis]);
            *force = along[0].mul_add(along[0], along[1].mul_add(along[1], along[2] * along[2]));
            let first = &mut self.pulls[a as usize];
            (0..4).for_each(|axis| first[axis] += k * along[axis]);
            let second = &mut self.pulls[b as usize];
            (0..4).for_each(|axis| second[axis] -= k * along[axis]);
        }
        let mut total = 0.0;
        for (force, &k) in self.forces.iter_mut().zip(self.stiffness) {
            *force = k * force.sqrt();
            total += *force;
        }
        total
    }
}
