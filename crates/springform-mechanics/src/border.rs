//! Borders as the net has them: which nodes lie along a ring or side, and how far along.

use springform_topology::base_mesh::{BaseMesh, Border};
use springform_topology::expression::Expression;
use springform_topology::node_key::{NodeKey, NodePlace, UNITS};

/// A node along a border.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BorderNode {
    /// The node.
    pub node: u32,
    /// Units of [`UNITS`] a base edge, from the border's first vertex.
    pub units: u64,
}

/// Nodes of the net along a border, in its order, whether or not cords run along it.
pub fn nodes_along(mesh: &BaseMesh, expression: &Expression, border: &Border) -> Vec<BorderNode> {
    let path = &border.path;
    let whole = u64::from(UNITS);
    let mut nodes = Vec::new();
    for (at, &vertex) in path.iter().enumerate() {
        let start = at as u64 * whole;
        let corner = expression.node(NodeKey::vertex(vertex));
        nodes.extend(corner.map(|node| BorderNode { node, units: start }));
        if at + 1 == path.len() && !border.closed {
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

/// Units from a border's first vertex to its last, or around.
pub fn units_along(border: &Border) -> u64 {
    let edges = if border.closed { border.path.len() } else { border.path.len().saturating_sub(1) };
    edges as u64 * u64::from(UNITS)
}
