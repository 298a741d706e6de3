//! Expression: from the genotype to nodes and springs, made whole (the paper §3.2: "a process of growing").
//!
//! Nodes first, springs second: expressed cells put nodes at their corners and named points; then perimeters and
//! fans are stitched through all nodes that lie on them, whoever put them there. Overrides come next, the
//! continuity filter last. Nodes and springs are numbered in the order of node keys, whatever the order of cells.

mod growth;
mod kinship;
mod springs;
mod stitching;

pub use growth::Growth;
pub use kinship::Kinship;

use crate::address::Place;
use crate::base_mesh::{BaseMesh, Groups};
use crate::cell_type::Catalogue;
use crate::filters::Method;
use crate::forest::{CellIndex, Content, Forest};
use crate::node_key::NodeKey;
use thiserror::Error;

/// A cell that stands as a leaf after the switches.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ExpressedCell {
    /// Handle in the forest.
    pub index: CellIndex,
    /// Face, level and square.
    pub place: Place,
    /// Type and turn as expressed: type 1 where a loose anchor needed it.
    pub content: Content,
}

/// A spring of the net.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Spring {
    /// The two nodes, the lower first.
    pub nodes: [u32; 2],
    /// It lies along a free ring or rim.
    pub ring: bool,
}

/// Nodes, springs and who owns them.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Expression {
    /// Key of every node that has a spring, ascending.
    pub nodes: Vec<NodeKey>,
    /// Every spring once, ascending by nodes.
    pub springs: Vec<Spring>,
    /// Expressed cells, ascending by face and child.
    pub cells: Vec<ExpressedCell>,
    /// Node of every anchor, in the order of anchors.
    pub anchors: Vec<u32>,
    /// Springs of every cell, ascending; a shared spring belongs to all its cells. No groups where a
    /// [`Growth`] was not asked for owners.
    pub cell_springs: Groups<u32>,
    /// Cells of every spring, ascending; none for a spring added by hand. No groups where a [`Growth`] was not
    /// asked for owners.
    pub spring_cells: Groups<u32>,
    /// Nodes on the boundary of every cell, corner c0 first and around; nodes without springs are left out.
    pub cell_boundaries: Groups<u32>,
}

/// Why a genotype gives no net.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum ExpressionError {
    /// The method does not allow the type of an expressed cell.
    #[error("cell {place} has type {word}, but method {method} allows {allowed}")]
    Type {
        /// The cell.
        place: Place,
        /// Its type.
        word: String,
        /// The method.
        method: &'static str,
        /// What it allows.
        allowed: &'static str,
    },
    /// No spring is left.
    #[error("no spring lies on a path between two anchors: the net is empty after filtering")]
    Empty,
    /// An anchor has no springs, even with its cells as plain quads.
    #[error("anchor {0}, counted from 0, is left without springs after filtering")]
    LooseAnchor(usize),
}

/// Grows nodes and springs from a forest.
///
/// `anchors` are different base vertices. Under [`Method::Recursive`] the forest must be closed
/// ([`crate::filters::recursive::close`]).
///
/// # Errors
/// A type that the method does not allow, a net without springs, an anchor that can't be attached.
pub fn express(
    mesh: &BaseMesh,
    forest: &Forest,
    catalogue: &Catalogue,
    method: Method,
    anchors: &[u32],
) -> Result<Expression, ExpressionError> {
    let mut growth = Growth::default();
    growth.express(mesh, forest, catalogue, method, anchors)?;
    growth.add_owners();
    Ok(growth.into_expression())
}

/// The cells that stand as leaves after the switches, in order of face and child.
pub fn expressed_cells(forest: &Forest) -> Vec<ExpressedCell> {
    let mut cells = Vec::new();
    forest.visit_expressed(|index, place| {
        cells.push(ExpressedCell { index, place, content: forest.content(index) });
    });
    cells
}

impl Expression {
    /// The number of a node.
    pub fn node(&self, key: NodeKey) -> Option<u32> {
        self.nodes.binary_search(&key).ok().map(|node| node as u32)
    }

    /// Nodes inside a base edge, from its lower vertex.
    pub fn nodes_inside_edge(&self, edge: u32) -> std::ops::Range<u32> {
        let [first, last] = NodeKey::inside_edge(edge);
        let start = self.nodes.partition_point(|&node| node < first);
        let end = self.nodes.partition_point(|&node| node <= last);
        start as u32..end as u32
    }

    /// Cells that have a node on their boundary, ascending.
    pub fn cells_at(&self, node: u32) -> Vec<u32> {
        (0..self.cells.len() as u32).filter(|&cell| self.cell_boundaries.of(cell).contains(&node)).collect()
    }

    /// Every index is in range, everything is ascending, no spring occurs twice.
    pub fn is_valid(&self) -> bool {
        let nodes = self.nodes.len() as u32;
        self.nodes.is_sorted_by(|a, b| a < b)
            && self.springs.is_sorted_by(|a, b| a.nodes < b.nodes)
            && self.springs.iter().all(|spring| spring.nodes[0] < spring.nodes[1] && spring.nodes[1] < nodes)
            && self.anchors.iter().all(|&anchor| anchor < nodes)
            && self.cell_springs.len() == self.cells.len()
            && self.spring_cells.len() == self.springs.len()
    }
}
