//! Borders and other paths along base edges as the net has them: which nodes lie along, and how far.

use springform_topology::base_mesh::BaseMesh;
use springform_topology::expression::Expression;
use springform_topology::node_key::{NodeKey, NodePlace, UNITS};

/// A node along a path.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BorderNode {
    /// The node.
    pub node: u32,
    /// Units of [`UNITS`] a base edge, from the path's first vertex.
    pub units: u64,
}

/// Nodes of the net along a path of base vertices, in its order, whether or not cords run along it; a closed path goes on
/// from its last vertex to its first.
pub fn nodes_along(mesh: &BaseMesh, expression: &Expression, path: &[u32], closed: bool) -> Vec<BorderNode> {
    let whole = u64::from(UNITS);
    let mut nodes = Vec::new();
    for (at, &vertex) in path.iter().enumerate() {
        let start = at as u64 * whole;
        let corner = expression.node(NodeKey::vertex(vertex));
        nodes.extend(corner.map(|node| BorderNode { node, units: start }));
        if at + 1 == path.len() && !closed {
            break;
        }
        let next = path[(at + 1) % path.len()];
        let Some(edge) = mesh.edge_between(vertex, next) else { continue };
        let inside = expression.nodes_inside_edge(edge);
        let reversed = vertex > next;
        let placed = |node: u32| {
            let NodePlace::Edge { parameter, .. } = expression.nodes[node as usize].place() else {
                return BorderNode { node, units: start };
            };
            let along = u64::from(parameter);
            BorderNode { node, units: start + if reversed { whole - along } else { along } }
        };
        if reversed { nodes.extend(inside.rev().map(placed)) } else { nodes.extend(inside.map(placed)) }
    }
    nodes
}

/// Units from a path's first vertex to its last, or around.
pub fn units_along(path: &[u32], closed: bool) -> u64 {
    let edges = if closed { path.len() } else { path.len().saturating_sub(1) };
    edges as u64 * u64::from(UNITS)
}
