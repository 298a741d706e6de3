//! Sensitivity: how an equilibrium changes with stiffness, rest lengths, forces, loads and supports.
//!
//! At equilibrium the pulls R(x, p) on all nodes vanish along the ways that are free. So K dx = (∂R/∂p) dp with the
//! tangent K = −∂R/∂x, and the gradient of any scalar J(x, F) takes one more solve with K, the adjoint method
//! (Haftka & Gürdal, "Elements of structural optimization", 1992, chapter 7): with K λ = dJ/dx, dJ/dp = λ ∂R/∂p + ∂J/∂p.
//! For a net of force densities K is the scalar factor of the linear solver.

use super::state::unheld_node;
use super::supports::Supports;
use super::tangent::{Layout, Tangent, block, moduli, own_bend_stiffness};
use crate::network::Network;
use crate::rod::Bend;
use crate::sparse::{Block, Graph, Lanes, ScalarFactor};
use crate::vector::{Vector, add, dot, length, scale, subtract};
use thiserror::Error;

/// Condition of the tangent beyond which derivatives would have no digits left.
const MOST_CONDITION: f64 = 1e13;

/// Solves that estimate the condition.
const CONDITION_SOLVES: usize = 4;

/// Why an equilibrium has no derivatives.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Error)]
pub enum SensitivityError {
    /// Weight by length or pressure: the tangent of such loads is not symmetric.
    #[error("loads that follow the shape have no sensitivity here; give them as dead loads")]
    Followers,
    /// A free node without springs that lead to a fixed node.
    #[error("node {node} is held by no springs that lead to a fixed node")]
    Unheld {
        /// The node.
        node: u32,
    },
    /// A node that nothing holds along some way, as slack springs leave it, or an equilibrium that is not stable.
    #[error(
        "the tangent stiffness is singular: near node {node} the net is slack, or its equilibrium not stable"
    )]
    Singular {
        /// The node.
        node: u32,
    },
}

/// Numbers that belong to a network's parameters: the gradient by each, or a change of each; n nodes, m springs.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Parameters {
    /// Stiffness k, m; a change in [N/m]. Rest lengths stay, so that for EA = k r it is r times the gradient by EA.
    pub stiffness: Vec<f64>,
    /// Rest length r, m; a change in [m]. Stiffness k stays: with EA = k r held instead, add −k/r times the gradient by k.
    pub rest_length: Vec<f64>,
    /// Constant force T, m; a change in [N].
    pub force: Vec<f64>,
    /// Dead loads, n; a change in [N].
    pub loads: Vec<Vector>,
    /// Positions of supports, n; a change in [m]. Zero along the ways that are free.
    pub supports: Vec<Vector>,
}

/// Change of an equilibrium: n nodes, m springs.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Response {
    /// Moves of the nodes [m], n.
    pub positions: Vec<Vector>,
    /// Changes of the spring forces [N], m.
    pub forces: Vec<f64>,
}

/// A spring at equilibrium.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Part {
    ends: [u32; 2],
    /// Direction from the first end to the second; zero without a length.
    unit: Vector,
    /// Tangent stiffness along and across [N/m].
    moduli: [f64; 2],
    /// Changes of the force with k, r and T at the same length.
    by_stiffness: f64,
    by_rest_length: f64,
    by_force: f64,
}

/// The factored tangent at an equilibrium; memory and ordering are used again for the next one.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Sensitivity {
    supports: Supports,
    layout: Layout,
    parts: Vec<Part>,
    bends: Vec<Bend>,
    /// Stiffness of every bend over its two links.
    bending: Vec<[Block; 3]>,
    scalar: bool,
    tangent: Tangent,
    factor: ScalarFactor,
    /// Pattern that the scalar factor is laid out for.
    pattern: u64,
}

impl Sensitivity {
    /// Factors the tangent of a network that passes [`Network::check`] at its equilibrium positions.
    ///
    /// # Errors
    /// A network without derivatives there.
    pub fn build(&mut self, network: &Network<'_>, positions: &[Vector]) -> Result<(), SensitivityError> {
        if network.has_followers() {
            return Err(SensitivityError::Followers);
        }
        if let Some(node) = unheld_node(network) {
            return Err(SensitivityError::Unheld { node });
        }
        self.supports.build(network);
        self.bends.clear();
        self.bends.extend(network.rods.iter().flat_map(|rod| rod.bends()));
        self.layout.build(network, &self.bends, &self.supports, None);
        self.parts.clear();
        self.parts.extend((0..network.springs.len()).map(|spring| part(network, spring, positions)));
        let bending = self.bends.iter().map(|bend| bend.bending(bend.links(positions), false).stiffness);
        self.bending.clear();
        self.bending.extend(bending);
        self.scalar = network.is_linear();
        if self.scalar { self.factor_scalar() } else { self.factor_blocks() }
    }

    /// Gradient of a scalar J by all parameters, from its changes with positions [per m], n, and with spring forces
    /// [per N], m.
    ///
    /// # Panics
    /// Lengths that are not the network's.
    pub fn gradient(&mut self, by_positions: &[Vector], by_forces: &[f64]) -> Parameters {
        let mut total = by_positions.to_vec();
        for (part, by_force) in self.parts.iter().zip(by_forces) {
            let pull = scale(part.unit, by_force * part.moduli[0]);
            spread(&mut total, part.ends, pull, -1.0);
        }
        let adjoint = self.solve(&total);
        let of_springs = |by: fn(&Part) -> f64| {
            let pairs = self.parts.iter().zip(by_forces);
            let gradient = pairs
                .map(|(part, by_force)| by(part) * (by_force - dot(part.unit, part.difference(&adjoint))));
            gradient.collect::<Vec<f64>>()
        };
        let resisted = self.times(&adjoint);
        let supports = total.iter().zip(&resisted).enumerate();
        let held =
            supports.map(|(node, (&total, &resisted))| self.held(node, subtract(total, resisted))).collect();
        Parameters {
            stiffness: of_springs(|part| part.by_stiffness),
            rest_length: of_springs(|part| part.by_rest_length),
            force: of_springs(|part| part.by_force),
            supports: held,
            loads: adjoint,
        }
    }

    /// Change of the equilibrium with a small change of parameters.
    ///
    /// # Panics
    /// Lengths that are not the network's.
    pub fn response(&mut self, change: &Parameters) -> Response {
        let given: Vec<f64> = self
            .parts
            .iter()
            .enumerate()
            .map(|(spring, part)| {
                part.by_stiffness * change.stiffness[spring]
                    + part.by_rest_length * change.rest_length[spring]
                    + part.by_force * change.force[spring]
            })
            .collect();
        let held: Vec<Vector> =
            change.supports.iter().enumerate().map(|(node, &moved)| self.held(node, moved)).collect();
        let resisted = self.times(&held);
        let mut pulls: Vec<Vector> =
            change.loads.iter().zip(&resisted).map(|(&load, &resisted)| subtract(load, resisted)).collect();
        for (part, &force) in self.parts.iter().zip(&given) {
            spread(&mut pulls, part.ends, scale(part.unit, force), 1.0);
        }
        let moved = self.solve(&pulls);
        let positions: Vec<Vector> = moved.iter().zip(&held).map(|(&free, &held)| add(free, held)).collect();
        let forces = self.parts.iter().zip(&given);
        let forces = forces
            .map(|(part, given)| given + part.moduli[0] * dot(part.unit, part.difference(&positions)))
            .collect();
        Response { positions, forces }
    }

    fn factor_scalar(&mut self) -> Result<(), SensitivityError> {
        let mut diagonal = vec![0.0; self.supports.nodes.len()];
        for (part, ends) in self.parts.iter().zip(&self.layout.ends) {
            for &row in ends.iter().filter(|&&row| row != Graph::OUTSIDE) {
                diagonal[row as usize] += part.moduli[0];
            }
        }
        let weights: Vec<f64> = self.parts.iter().map(|part| -part.moduli[0]).collect();
        if self.pattern != self.layout.pattern {
            self.factor.lay_out(&self.layout.graph, &self.layout.symbolic);
            self.pattern = self.layout.pattern;
        }
        let factored = self.factor.factor(&self.layout.graph, &self.layout.symbolic, &diagonal, &weights);
        factored.map_err(|refused| self.singular(refused.row))
    }

    fn factor_blocks(&mut self) -> Result<(), SensitivityError> {
        let springs = self.parts.iter().map(|part| (part.tangent(), 0.0));
        let bends = self.bending.iter().map(|stiffness| (*stiffness, 0.0));
        let factored = self.tangent.factor(&self.layout, &self.supports, springs, bends);
        factored.map_err(|refused| self.singular(refused.row))?;
        self.check_condition()
    }

    /// Estimates the largest entry of the inverse by powers of it: rounding factors what is singular, too.
    fn check_condition(&mut self) -> Result<(), SensitivityError> {
        let mut stiffness = vec![0.0; self.supports.rows.len()];
        for part in &self.parts {
            let own = part.moduli[0].abs().max(part.moduli[1].abs());
            part.ends.iter().for_each(|&node| stiffness[node as usize] += own);
        }
        for bend in &self.bends {
            bend.nodes.iter().for_each(|&node| stiffness[node as usize] += own_bend_stiffness(bend));
        }
        let stiffest = stiffness.into_iter().fold(0.0, f64::max);
        // Different at each node and axis, so that it is square to no shape that matters.
        let entry = |node: usize, axis: usize| 1.0 + 0.1 * ((3 * node + axis) % 7) as f64;
        let mut shape: Vec<Vector> =
            (0..self.supports.rows.len()).map(|node| [0, 1, 2].map(|axis| entry(node, axis))).collect();
        for _ in 0..CONDITION_SOLVES {
            let size = shape.iter().map(|&vector| dot(vector, vector)).sum::<f64>().sqrt();
            if size == 0.0 {
                break;
            }
            shape = self.solve(&shape.iter().map(|&vector| scale(vector, 1.0 / size)).collect::<Vec<_>>());
            let grown = shape.iter().map(|&vector| dot(vector, vector)).sum::<f64>().sqrt();
            if !grown.is_finite() || grown * stiffest > MOST_CONDITION {
                let sizes = shape.iter().map(|&vector| length(vector));
                let most = sizes.enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b));
                return Err(SensitivityError::Singular { node: most.map_or(0, |(node, _)| node as u32) });
            }
        }
        Ok(())
    }

    fn singular(&self, row: u32) -> SensitivityError {
        SensitivityError::Singular { node: self.supports.nodes[row as usize] }
    }

    /// Moves of nodes along their free ways under pulls.
    fn solve(&mut self, pulls: &[Vector]) -> Vec<Vector> {
        let mut lanes: Vec<Lanes> = pulls.iter().map(|&[x, y, z]| [x, y, z, 0.0]).collect();
        self.supports.keep_free(&mut lanes);
        if self.scalar {
            let mut side: Vec<Lanes> = self.supports.nodes.iter().map(|&node| lanes[node as usize]).collect();
            self.factor.solve(&mut side);
            for (&node, value) in self.supports.nodes.iter().zip(side) {
                lanes[node as usize] = value;
            }
        } else {
            self.tangent.solve(&self.supports, &mut lanes);
        }
        lanes.into_iter().map(|[x, y, z, _]| [x, y, z]).collect()
    }

    /// K v over all nodes, held ones too.
    fn times(&self, moves: &[Vector]) -> Vec<Vector> {
        let mut forces = vec![[0.0; 3]; moves.len()];
        for part in &self.parts {
            let resisted = times(&part.tangent(), part.difference(moves));
            spread(&mut forces, part.ends, resisted, -1.0);
        }
        for (bend, [first, mixed, second]) in self.bends.iter().zip(&self.bending) {
            let [a, b, c] = bend.nodes;
            let [here, middle, there] = [a, b, c].map(|node| moves[node as usize]);
            let (u, v) = (subtract(middle, here), subtract(there, middle));
            let by_first = add(times(first, u), times(mixed, v));
            let by_second = add(turned_times(mixed, u), times(second, v));
            spread(&mut forces, [a, b], by_first, -1.0);
            spread(&mut forces, [b, c], by_second, -1.0);
        }
        forces
    }

    fn held(&self, node: usize, vector: Vector) -> Vector {
        self.supports.held_part(node, vector)
    }
}

impl Part {
    fn tangent(&self) -> Block {
        // A spring of no length is as stiff along as across.
        block(self.unit, length(self.unit), self.moduli[0], self.moduli[1])
    }

    fn difference(&self, of: &[Vector]) -> Vector {
        subtract(of[self.ends[1] as usize], of[self.ends[0] as usize])
    }
}

fn part(network: &Network<'_>, spring: usize, positions: &[Vector]) -> Part {
    let ends = network.springs[spring];
    let along = subtract(positions[ends[1] as usize], positions[ends[0] as usize]);
    let size = length(along);
    let unit = if size > 0.0 { scale(along, 1.0 / size) } else { [0.0; 3] };
    let moduli = moduli(network, spring, size);
    let (k, rest) = (network.stiffness[spring], network.rest_length[spring]);
    let slack = moduli[0] == 0.0 && network.force_at(spring, size) == 0.0;
    let [by_stiffness, by_rest_length] = match network.curve_of(spring) {
        _ if slack => [0.0; 2],
        None => [size - rest, -k],
        Some(curve) => {
            let (value, slope) = (curve.value((size - rest) / rest), curve.slope((size - rest) / rest));
            [rest * value, k * (value - slope * size / rest)]
        }
    };
    let by_force = if slack { 0.0 } else { 1.0 };
    Part { ends, unit, moduli, by_stiffness, by_rest_length, by_force }
}

/// Adds a vector to the first end and takes it from the second, times a sign.
fn spread(of: &mut [Vector], ends: [u32; 2], vector: Vector, sign: f64) {
    let [first, second] = ends.map(|node| node as usize);
    of[first] = add(of[first], scale(vector, sign));
    of[second] = subtract(of[second], scale(vector, sign));
}

fn times(block: &Block, vector: Vector) -> Vector {
    block.map(|row| dot(row, vector))
}

fn turned_times(block: &Block, vector: Vector) -> Vector {
    std::array::from_fn(|column| (0..3).map(|row| block[row][column] * vector[row]).sum())
}
