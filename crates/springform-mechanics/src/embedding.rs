//! Embedding: where anchors stand and where free nodes are drawn. Coordinates are no part of the topology.

use crate::vector::{Vector, add, scale};
use springform_topology::base_mesh::BaseMesh;
use springform_topology::node_key::{NodeKey, NodePlace, UNITS};

/// Positions of anchors and of the base mesh.
#[derive(Clone, PartialEq, Debug)]
pub struct Embedding {
    /// Target position of every anchor [m], in the order of anchors.
    pub anchor_positions: Vec<Vector>,
    base_positions: Vec<Vector>,
    edges: Vec<[u32; 2]>,
    faces: Vec<[u32; 4]>,
}

impl Embedding {
    /// An embedding with given positions of base vertices [m].
    pub fn drawn(mesh: &BaseMesh, anchor_positions: Vec<Vector>, base_positions: Vec<Vector>) -> Embedding {
        Embedding {
            anchor_positions,
            base_positions,
            edges: mesh.edges().to_vec(),
            faces: mesh.faces().to_vec(),
        }
    }

    /// Draws a base vertex elsewhere [m].
    pub fn draw(&mut self, vertex: u32, position: Vector) {
        self.base_positions[vertex as usize] = position;
    }

    /// Drawn positions of the base vertices [m].
    pub fn base_positions(&self) -> &[Vector] {
        &self.base_positions
    }

    /// Writes the drawn positions of nodes [m].
    pub(crate) fn draw_positions(&self, nodes: &[NodeKey], positions: &mut Vec<Vector>) {
        positions.clear();
        positions.extend(nodes.iter().map(|&node| self.drawn_position(node)));
    }

    /// Drawn position of a node [m]: bilinear between the corners of its face.
    pub fn drawn_position(&self, node: NodeKey) -> Vector {
        let base = |vertex: u32| self.base_positions[vertex as usize];
        let part = |units: u32| f64::from(units) / f64::from(UNITS);
        let between = |a: Vector, b: Vector, t: f64| add(scale(a, 1.0 - t), scale(b, t));
        match node.place() {
            NodePlace::Vertex(vertex) => base(vertex),
            NodePlace::Edge { edge, parameter } => {
                let [a, b] = self.edges[edge as usize];
                between(base(a), base(b), part(parameter))
            }
            NodePlace::Face { face, i, j } => {
                let [c0, c1, c2, c3] = self.faces[face as usize].map(base);
                between(between(c0, c1, part(i)), between(c3, c2, part(i)), part(j))
            }
        }
    }
}
