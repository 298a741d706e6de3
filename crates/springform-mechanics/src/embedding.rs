//! Embedding: where anchors stand and where free nodes are drawn. Coordinates are no part of the topology.

use crate::equilibrium::{Settings, Status, solve};
use crate::network::{Network, SpringLaw};
use crate::vector::{Vector, add, scale};
use springform_topology::base_mesh::BaseMesh;
use springform_topology::cell_type::Catalogue;
use springform_topology::expression::express;
use springform_topology::filters::Method;
use springform_topology::forest::{Content, Forest};
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

    /// An embedding in which base vertices are drawn at the equilibrium of the base mesh, each cell a plain quad
    /// of unit springs; vertices that carry nothing are drawn at the mean of the anchors.
    pub fn from_anchors(mesh: &BaseMesh, anchors: &[u32], anchor_positions: Vec<Vector>) -> Embedding {
        let middle = crate::vector::mean(anchor_positions.iter().copied());
        let mut drawn = Self::drawn(mesh, anchor_positions, vec![middle; mesh.vertex_count() as usize]);
        let forest = Forest::new(mesh.faces().len() as u32, Content::QUAD);
        let expression = express(mesh, &forest, &Catalogue::default(), Method::Recursive, anchors);
        if let Ok(expression) = expression {
            let network = Network::from_expression(&expression, &drawn, SpringLaw::default());
            let equilibrium = solve(&network, &Settings::default());
            if equilibrium.status == Status::Converged {
                for (node, position) in expression.nodes.iter().zip(equilibrium.positions) {
                    if let NodePlace::Vertex(vertex) = node.place() {
                        drawn.base_positions[vertex as usize] = position;
                    }
                }
            }
        }
        drawn
    }

    /// Drawn positions of the base vertices [m].
    pub fn base_positions(&self) -> &[Vector] {
        &self.base_positions
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
