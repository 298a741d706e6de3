//! Rods along paths of base edges, borders most often: their links become springs of the network, behind those of the net.

use super::RiggingError;
use crate::border::{nodes_along, units_along};
use crate::network::{NO_CURVE, Network, Sense};
use crate::rod::Rod;
use crate::vector::{length, subtract};
use springform_topology::base_mesh::BaseMesh;
use springform_topology::expression::Expression;

/// A rod through all nodes that the net has along a path.
#[derive(Clone, PartialEq, Debug)]
pub struct PathRod {
    /// Base vertices, each once, consecutive ones joined by an edge of the base mesh.
    pub path: Vec<u32>,
    /// The last vertex is followed by the first.
    pub closed: bool,
    /// Bending stiffness EI [N m²].
    pub bending_stiffness: f64,
    /// Axial stiffness EA [N], of the unstressed length.
    pub axial_stiffness: f64,
    /// Unstressed length of the whole rod [m], shared out by base edges; `None`: every link as drawn.
    pub length: Option<f64>,
    /// Area of the cross-section [m²].
    pub area: Option<f64>,
    /// Weight per length [N/m].
    pub weight: f64,
}

impl PathRod {
    /// Number of the rod's links in a net.
    pub fn links(&self, mesh: &BaseMesh, expression: &Expression) -> usize {
        let count = nodes_along(mesh, expression, &self.path, self.closed).len();
        if self.closed { count } else { count.saturating_sub(1) }
    }

    /// Adds the rod and its links to a network, and the links' weights per length [N/m].
    pub(super) fn add(
        &self,
        number: usize,
        mesh: &BaseMesh,
        expression: &Expression,
        network: &mut Network<'static>,
        weights: &mut Vec<f64>,
    ) -> Result<(), RiggingError> {
        let refuse = |problem: &str| RiggingError { key: format!("rods[{number}]"), problem: problem.into() };
        let found = nodes_along(mesh, expression, &self.path, self.closed);
        if found.len() < 3 {
            return Err(refuse("the net has fewer than three nodes along this rod"));
        }
        let nodes: Vec<u32> = found.iter().map(|node| node.node).collect();
        let count = nodes.len();
        let links = if self.closed { count } else { count - 1 };
        let ends = |link: usize| [nodes[link], nodes[(link + 1) % count]];
        let whole = units_along(&self.path, self.closed);
        let share = |link: usize| {
            let next = (link + 1) % count;
            let around = if next == 0 { whole } else { 0 };
            (found[next].units + around - found[link].units) as f64 / whole as f64
        };
        let drawn = |link: usize| {
            let [a, b] = ends(link).map(|node| network.positions[node as usize]);
            length(subtract(b, a))
        };
        let lengths: Vec<f64> =
            (0..links).map(|link| self.length.map_or_else(|| drawn(link), |all| all * share(link))).collect();
        if !lengths.iter().all(|length| *length > 0.0 && length.is_finite()) {
            return Err(refuse("two nodes along this rod are drawn in one place; give the rod's length"));
        }
        for (link, &rest) in lengths.iter().enumerate() {
            network.springs.to_mut().push(ends(link));
            network.stiffness.to_mut().push(self.axial_stiffness / rest);
            network.rest_length.to_mut().push(rest);
            network.force.to_mut().push(0.0);
            network.sense.to_mut().push(Sense::Both);
            if !network.curve.is_empty() {
                network.curve.to_mut().push(NO_CURVE);
            }
            weights.push(self.weight);
        }
        let closed = self.closed;
        let bending_stiffness = self.bending_stiffness;
        network.rods.to_mut().push(Rod { nodes, closed, lengths, bending_stiffness });
        Ok(())
    }
}
