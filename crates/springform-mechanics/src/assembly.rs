//! Assembly: from an expression and an embedding to a network, and from anchors to an embedding.

use crate::embedding::Embedding;
use crate::equilibrium::{Settings, Status, solve};
use crate::network::{Network, Sense};
use crate::vector::{Vector, mean};
use springform_topology::base_mesh::BaseMesh;
use springform_topology::cell_type::Catalogue;
use springform_topology::expression::{Expression, express};
use springform_topology::filters::Method;
use springform_topology::forest::{Content, Forest};
use springform_topology::node_key::NodePlace;
use std::borrow::Cow;

/// Stiffness of the springs of a net by where they lie; all rest lengths are zero.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SpringLaw {
    /// Stiffness of every spring [N/m].
    pub stiffness: f64,
    /// Factor on the stiffness of springs along free rings and rims.
    pub ring_factor: f64,
}

impl Default for SpringLaw {
    fn default() -> Self {
        SpringLaw { stiffness: 1.0, ring_factor: 1.0 }
    }
}

/// The network of an expression: anchors are fixed at their positions, free nodes start at their drawn ones.
pub fn assemble(expression: &Expression, embedding: &Embedding, law: SpringLaw) -> Network<'static> {
    let mut network = Network::default();
    assemble_into(expression, embedding, law, &mut network);
    network
}

/// Writes the network that [`assemble`] gives into one that it gave before, or an empty one, in the same memory.
pub fn assemble_into(
    expression: &Expression,
    embedding: &Embedding,
    law: SpringLaw,
    network: &mut Network<'static>,
) {
    let (nodes, springs) = (expression.nodes.len(), &expression.springs);
    let positions = network.positions.to_mut();
    embedding.draw_positions(&expression.nodes, positions);
    let fixed = refilled(&mut network.fixed, nodes, [false; 3]);
    for (&node, &position) in expression.anchors.iter().zip(&embedding.anchor_positions) {
        positions[node as usize] = position;
        fixed[node as usize] = [true; 3];
    }
    let pairs = network.springs.to_mut();
    pairs.clear();
    pairs.extend(springs.iter().map(|spring| spring.nodes));
    let factor = |ring: bool| if ring { law.ring_factor } else { 1.0 };
    let stiffness = network.stiffness.to_mut();
    stiffness.clear();
    stiffness.extend(springs.iter().map(|spring| law.stiffness * factor(spring.ring)));
    refilled(&mut network.rest_length, springs.len(), 0.0);
    refilled(&mut network.force, springs.len(), 0.0);
    refilled(&mut network.sense, springs.len(), Sense::Both);
    refilled(&mut network.loads, nodes, [0.0; 3]);
}

/// An array of so many equal values, in the memory that it has.
fn refilled<'a, T: Copy>(array: &'a mut Cow<'static, [T]>, count: usize, value: T) -> &'a mut [T] {
    let array = array.to_mut();
    array.clear();
    array.resize(count, value);
    array
}

/// An embedding whose base vertices are drawn at the equilibrium of the base mesh, each cell a plain quad of unit
/// springs; vertices that carry nothing are drawn at the mean of the anchors.
pub fn embed(mesh: &BaseMesh, anchors: &[u32], anchor_positions: Vec<Vector>) -> Embedding {
    let middle = mean(anchor_positions.iter().copied());
    let mut drawn = Embedding::drawn(mesh, anchor_positions, vec![middle; mesh.vertex_count() as usize]);
    let forest = Forest::new(mesh.faces().len() as u32, Content::QUAD);
    // A base mesh without a net has nothing to draw better; growing it says why.
    let Ok(expression) = express(mesh, &forest, &Catalogue::default(), Method::Recursive, anchors) else {
        return drawn;
    };
    let equilibrium = solve(&assemble(&expression, &drawn, SpringLaw::default()), &Settings::default());
    if equilibrium.status == Status::Converged {
        for (node, position) in expression.nodes.iter().zip(equilibrium.positions) {
            if let NodePlace::Vertex(vertex) = node.place() {
                drawn.draw(vertex, position);
            }
        }
    }
    drawn
}
