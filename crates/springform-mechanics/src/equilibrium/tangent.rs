//! Tangent stiffness of springs of any law and of rods, in blocks of three by three.

use super::elements::vector;
use super::supports::Supports;
use crate::network::{Network, Sense};
use crate::rod::Bend;
use crate::sparse::{Block, BlockFactor, Graph, Lanes, NotPositiveDefinite, Symbolic};
use crate::vector::{Vector, add, dot, length, scale, subtract};

/// The rows of a network, their links, and where the entries of its factors stand.
#[derive(Clone, PartialEq, Debug, Default)]
pub(super) struct Layout {
    pub(super) graph: Graph,
    pub(super) symbolic: Symbolic,
    /// Rows of every link: springs first, then three a bend.
    pub(super) ends: Vec<[u32; 2]>,
    /// Another number for each pattern, from 1.
    pub(super) pattern: u64,
    order: Vec<u32>,
}

impl Layout {
    /// Numbers rows and links and orders the elimination: as the nodes are given, each once, or by minimum degree.
    pub(super) fn build(
        &mut self,
        network: &Network<'_>,
        bends: &[Bend],
        supports: &Supports,
        order: Option<&[u32]>,
    ) {
        let rows = |pair: [u32; 2]| pair.map(|node| supports.rows[node as usize]);
        let pairs = bends.iter().map(|bend| bend.nodes).flat_map(|[a, b, c]| [[a, b], [b, c], [a, c]]);
        let links = network.springs.iter().copied().chain(pairs).map(rows);
        let known = self.pattern > 0 && supports.nodes.len() == self.graph.rows();
        if order.is_none() && known && links.clone().eq(self.ends.iter().copied()) {
            return;
        }
        self.pattern += 1;
        self.ends.clear();
        self.ends.extend(links);
        self.graph.build(supports.nodes.len(), self.ends.iter().copied());
        let Some(order) = order else { return self.symbolic.build(&self.graph) };
        self.order.clear();
        let rows = order.iter().map(|&node| supports.rows[node as usize]);
        self.order.extend(rows.filter(|&row| row != Graph::OUTSIDE));
        self.symbolic.build_ordered(&self.graph, &self.order);
    }
}

/// A tangent being assembled, and its factor.
#[derive(Clone, PartialEq, Debug, Default)]
pub(super) struct Tangent {
    diagonal: Vec<Block>,
    links: Vec<Block>,
    factor: BlockFactor,
    /// Pattern that the factor is laid out for.
    pattern: u64,
}

/// What a spring adds: its stiffness, and how much of the identity both nodes get on top [N/m].
pub(super) type SpringPart = (Block, f64);

impl Tangent {
    /// Factors the stiffness of springs and rods.
    ///
    /// # Errors
    /// A stiffness that is not positive definite.
    pub(super) fn factor(
        &mut self,
        layout: &Layout,
        supports: &Supports,
        springs: impl Iterator<Item = SpringPart>,
        bends: impl Iterator<Item = ([Block; 3], f64)>,
    ) -> Result<(), NotPositiveDefinite> {
        self.diagonal.clear();
        self.diagonal.resize(supports.nodes.len(), [[0.0; 3]; 3]);
        self.links.clear();
        for (&ends, (block, own)) in layout.ends.iter().zip(springs) {
            for row in ends.into_iter().filter(|&row| row != Graph::OUTSIDE) {
                accumulate(&mut self.diagonal[row as usize], &block, 1.0);
                stiffen(&mut self.diagonal[row as usize], own);
            }
            self.links.push(block.map(|row| row.map(|value| -value)));
        }
        for (links, (blocks, own)) in layout.ends[self.links.len()..].chunks_exact(3).zip(bends) {
            self.add_bend([links[0][0], links[0][1], links[1][1]], &blocks, own);
        }
        self.hold(layout, supports);
        if self.pattern != layout.pattern {
            self.factor.lay_out(&layout.graph, &layout.symbolic);
            self.pattern = layout.pattern;
        }
        self.factor.factor(&layout.graph, &layout.symbolic, &self.diagonal, &self.links, &layout.ends)
    }

    /// Moves of nodes under pulls, both one a node; moves of held nodes are zero.
    pub(super) fn solve(&mut self, supports: &Supports, vectors: &mut [Lanes]) {
        let mut side: Vec<Lanes> = supports.nodes.iter().map(|&node| vectors[node as usize]).collect();
        self.factor.solve(&mut side);
        vectors.fill([0.0; 4]);
        for (&node, value) in supports.nodes.iter().zip(side) {
            vectors[node as usize] = value;
        }
        supports.keep_free(vectors);
    }

    /// Adds a bend over the rows of its three nodes; blocks are over its two links u = b − a and v = c − b.
    fn add_bend(&mut self, rows: [u32; 3], [uu, uv, vv]: &[Block; 3], own: f64) {
        let turned = |block: &Block| -> Block { std::array::from_fn(|i| [0, 1, 2].map(|j| block[j][i])) };
        let vu = turned(uv);
        let mut of_nodes = [[[0.0; 3]; 3]; 3];
        accumulate(&mut of_nodes[0], uu, 1.0);
        for (block, sign) in [(uu, 1.0), (uv, -1.0), (&vu, -1.0), (vv, 1.0)] {
            accumulate(&mut of_nodes[1], block, sign);
        }
        accumulate(&mut of_nodes[2], vv, 1.0);
        for (row, block) in rows.into_iter().zip(&of_nodes).filter(|(row, _)| *row != Graph::OUTSIDE) {
            accumulate(&mut self.diagonal[row as usize], block, 1.0);
            stiffen(&mut self.diagonal[row as usize], own);
        }
        let mut between = [[[0.0; 3]; 3]; 3];
        accumulate(&mut between[0], uu, -1.0);
        accumulate(&mut between[0], uv, 1.0);
        accumulate(&mut between[1], uv, 1.0);
        accumulate(&mut between[1], vv, -1.0);
        accumulate(&mut between[2], uv, -1.0);
        self.links.extend(between);
    }

    /// Takes the ways that supports hold out of the system.
    fn hold(&mut self, layout: &Layout, supports: &Supports) {
        for (node, projection) in &supports.partial {
            let row = supports.rows[*node as usize];
            let diagonal = &mut self.diagonal[row as usize];
            let held = (diagonal[0][0] + diagonal[1][1] + diagonal[2][2]).abs().max(f64::MIN_POSITIVE);
            let mut kept = product(projection, &product(diagonal, projection));
            for (i, entries) in kept.iter_mut().enumerate() {
                for (j, entry) in entries.iter_mut().enumerate() {
                    *entry += held * (f64::from(u8::from(i == j)) - projection[i][j]);
                }
            }
            *diagonal = kept;
            for (_, link) in layout.graph.of(row) {
                let block = &mut self.links[link as usize];
                let first = layout.ends[link as usize][0] == row;
                *block = if first { product(projection, block) } else { product(block, projection) };
            }
        }
    }
}

/// Stiffness that a spring has of its own, slack or not [N/m].
pub(super) fn own_stiffness(network: &Network<'_>, spring: usize, length: f64) -> f64 {
    let constant = network.force[spring].abs();
    network.stiffness[spring].max(if length > 0.0 { constant / length } else { constant })
}

/// Stiffness against turning that a bend has of its own [N/m].
pub(super) fn own_bend_stiffness(bend: &Bend) -> f64 {
    let [a, b] = bend.lengths;
    2.0 * bend.stiffness / (a * b * (a + b))
}

/// Stiffness of a spring along and across its direction [N/m].
pub(super) fn moduli(network: &Network<'_>, spring: usize, length: f64) -> [f64; 2] {
    let (k, rest, constant) = (network.stiffness[spring], network.rest_length[spring], network.force[spring]);
    let force = network.force_at(spring, length);
    let slack = force == 0.0 && network.sense[spring] != Sense::Both;
    // A spring that starts at its rest length counts as taut: rounding would decide otherwise.
    let at_rest = (constant + k * (length - rest)).abs() <= 1e-14 * k * rest;
    let axial = match network.curve_of(spring) {
        _ if slack && !at_rest => 0.0,
        None => k,
        Some(curve) => k * curve.slope((length - rest) / rest),
    };
    let across = match (rest, constant) {
        (0.0, 0.0) => axial,
        _ if length > 0.0 => force / length,
        _ => 0.0,
    };
    [axial, across]
}

/// k n nᵀ + (F/L)(I − n nᵀ), the second term not below zero when `clamped`.
pub(super) fn spring_tangent(network: &Network<'_>, spring: usize, along: Vector, clamped: bool) -> Block {
    let length = length(along);
    let [axial, across] = moduli(network, spring, length);
    block(along, length, axial, if clamped { across.max(0.0) } else { across })
}

/// Stiffness of a spring along and across its direction.
pub(super) fn block(along: Vector, length: f64, axial: f64, transverse: f64) -> Block {
    let normal = if length > 0.0 { scale(along, 1.0 / length) } else { [0.0; 3] };
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let identity = f64::from(u8::from(i == j));
            transverse * identity + (axial - transverse) * normal[i] * normal[j]
        })
    })
}

/// From the first node of a spring to the second.
pub(super) fn along(network: &Network<'_>, spring: usize, of: &[Lanes]) -> Vector {
    let [a, b] = network.springs[spring];
    subtract(vector(of[b as usize]), vector(of[a as usize]))
}

/// The two links of a bend.
pub(super) fn links(bend: &Bend, of: &[Lanes]) -> [Vector; 2] {
    let [a, b, c] = bend.nodes.map(|node| vector(of[node as usize]));
    [subtract(b, a), subtract(c, b)]
}

fn accumulate(sum: &mut Block, block: &Block, factor: f64) {
    for (sum, row) in sum.iter_mut().zip(block) {
        *sum = add(*sum, scale(*row, factor));
    }
}

fn stiffen(sum: &mut Block, own: f64) {
    (0..3).for_each(|axis| sum[axis][axis] += own);
}

fn product(a: &Block, b: &Block) -> Block {
    let column = |j: usize| [b[0][j], b[1][j], b[2][j]];
    std::array::from_fn(|i| [0, 1, 2].map(|j| dot(a[i], column(j))))
}
