//! Which way nodes may move: rows of the systems, and projections of what can't.

use crate::network::{Network, Path};
use crate::sparse::{Block, Graph, Lanes};
use crate::vector::{Vector, dot, length, scale, subtract};

/// Nodes that are free, held, or free in part.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Supports {
    /// Row of every node in the systems; [`Graph::OUTSIDE`] where the node is held.
    pub(super) rows: Vec<u32>,
    /// Node of every row.
    pub(super) nodes: Vec<u32>,
    /// Nodes that are free in part, ascending, and the projection onto where they may go.
    pub(super) partial: Vec<(u32, Block)>,
}

impl Supports {
    /// Reads the supports of a network.
    pub(super) fn build(&mut self, network: &Network<'_>) {
        self.rows.clear();
        self.nodes.clear();
        self.partial.clear();
        for (node, axes) in network.fixed.iter().enumerate() {
            if *axes == [true; 3] {
                self.rows.push(Graph::OUTSIDE);
                continue;
            }
            self.rows.push(self.nodes.len() as u32);
            self.nodes.push(node as u32);
            if axes.contains(&true) {
                let free = |i: usize, j: usize| f64::from(u8::from(i == j && !axes[i]));
                self.partial.push((node as u32, std::array::from_fn(|i| [0, 1, 2].map(|j| free(i, j)))));
            }
        }
        self.partial.extend(network.slides.iter().map(|slide| (slide.node, projection(slide.path))));
        self.partial.sort_by_key(|&(node, _)| node);
    }

    /// Leaves of vectors, one a node, what nodes can follow.
    pub(super) fn keep_free(&self, vectors: &mut [Lanes]) {
        for (vector, &row) in vectors.iter_mut().zip(&self.rows) {
            if row == Graph::OUTSIDE {
                *vector = [0.0; 4];
            }
        }
        self.keep_partial(vectors);
    }

    /// Leaves of the vectors of nodes that are free in part what those can follow.
    pub(super) fn keep_partial(&self, vectors: &mut [Lanes]) {
        for (node, projection) in &self.partial {
            let vector = &mut vectors[*node as usize];
            let [x, y, z] = projection.map(|row| dot(row, [vector[0], vector[1], vector[2]]));
            *vector = [x, y, z, 0.0];
        }
    }

    /// Puts nodes that are free in part back to where they may be, off which rounding has led them.
    pub(super) fn put_back(&self, network: &Network<'_>, positions: &mut [Lanes]) {
        for (node, projection) in &self.partial {
            let (start, position) = (network.positions[*node as usize], &mut positions[*node as usize]);
            let moved = subtract([position[0], position[1], position[2]], start);
            let [x, y, z] = projection.map(|row| dot(row, moved));
            *position = [start[0] + x, start[1] + y, start[2] + z, 0.0];
        }
    }

    /// The part of a node's vector that the node can follow.
    pub(super) fn free_part(&self, node: usize, vector: Vector) -> Vector {
        if self.rows[node] == Graph::OUTSIDE {
            return [0.0; 3];
        }
        match self.partial.binary_search_by_key(&(node as u32), |&(node, _)| node) {
            Ok(at) => self.partial[at].1.map(|row| dot(row, vector)),
            Err(_) => vector,
        }
    }

    /// The part of a node's vector that its support takes.
    pub(super) fn held_part(&self, node: usize, vector: Vector) -> Vector {
        subtract(vector, self.free_part(node, vector))
    }
}

impl From<&Network<'_>> for Supports {
    fn from(network: &Network<'_>) -> Self {
        let mut supports = Supports::default();
        supports.build(network);
        supports
    }
}

fn projection(path: Path) -> Block {
    let outer = |along: Vector| {
        let unit = scale(along, 1.0 / length(along));
        unit.map(|value| scale(unit, value))
    };
    match path {
        Path::Line(along) => outer(along),
        Path::Plane(normal) => {
            let across = outer(normal);
            std::array::from_fn(|i| [0, 1, 2].map(|j| f64::from(u8::from(i == j)) - across[i][j]))
        }
    }
}
