//! Exact names of nodes, so that neighbours find each other across faces and levels without any distance test.
//!
//! ```text
//! bits 63–62   61–42   41–21   20–0
//!      0       –       –       vertex          base vertex
//!      1       edge (over 61–21)   parameter   point on a base edge
//!      2       face    i       j               point inside a face
//! ```
//! Parameters count units of 2^−[`RESOLUTION`], from the lower vertex of the edge, along side 0 (i) and side 1 (j).

use crate::MAX_LEVEL;
use crate::address::whole_number;
use crate::base_mesh::BaseMesh;
use std::fmt;
use thiserror::Error;

/// log2 of the units along a base edge: one level finer than the deepest cell, for middles and centres.
pub const RESOLUTION: u8 = MAX_LEVEL + 1;

/// Units along a base edge.
pub const UNITS: u32 = 1 << RESOLUTION;

const COORDINATE_BITS: u32 = RESOLUTION as u32;
const COORDINATE_MASK: u64 = (1 << COORDINATE_BITS) - 1;
const TAG_SHIFT: u32 = 62;

/// A node's name; keys sort vertices before edge points before face points.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct NodeKey(u64);

/// Where on the base mesh a node lies.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum NodePlace {
    /// On a base vertex.
    Vertex(u32),
    /// On a base edge, `parameter` units from its lower vertex, 0 < parameter < [`UNITS`].
    Edge {
        /// The edge.
        edge: u32,
        /// Units from the lower vertex.
        parameter: u32,
    },
    /// Inside a face, 0 < i, j < [`UNITS`].
    Face {
        /// The face.
        face: u32,
        /// Units along side 0.
        i: u32,
        /// Units along side 1.
        j: u32,
    },
}

impl NodeKey {
    /// The key of a base vertex.
    pub fn vertex(vertex: u32) -> NodeKey {
        NodeKey(u64::from(vertex))
    }

    /// The keys between which those of all points inside a base edge lie, ascending from its lower vertex.
    pub fn inside_edge(edge: u32) -> [NodeKey; 2] {
        [NodeKey::edge(edge, 1), NodeKey::edge(edge, UNITS - 1)]
    }

    pub(crate) fn edge(edge: u32, parameter: u32) -> NodeKey {
        NodeKey(1 << TAG_SHIFT | u64::from(edge) << COORDINATE_BITS | u64::from(parameter))
    }

    pub(crate) fn face(face: u32, i: u32, j: u32) -> NodeKey {
        let face = u64::from(face) << (2 * COORDINATE_BITS);
        NodeKey(2 << TAG_SHIFT | face | u64::from(i) << COORDINATE_BITS | u64::from(j))
    }

    /// The key of the point (i, j) of a face, 0 ≤ i, j ≤ [`UNITS`].
    pub fn at(mesh: &BaseMesh, face: u32, i: u32, j: u32) -> NodeKey {
        let corners = &mesh.faces()[face as usize];
        let (side, along) = match (i, j) {
            (0, 0) => return NodeKey::vertex(corners[0]),
            (UNITS, 0) => return NodeKey::vertex(corners[1]),
            (UNITS, UNITS) => return NodeKey::vertex(corners[2]),
            (0, UNITS) => return NodeKey::vertex(corners[3]),
            (_, 0) => (0, i),
            (UNITS, _) => (1, j),
            (_, UNITS) => (2, UNITS - i),
            (0, _) => (3, UNITS - j),
            _ => return NodeKey::face(face, i, j),
        };
        let under = mesh.side_edge(face, side);
        NodeKey::edge(under.edge, if under.reversed { UNITS - along } else { along })
    }

    /// The face of a point inside a face, in its place among the bits.
    pub(crate) fn face_bits(self) -> u64 {
        self.0 >> (2 * COORDINATE_BITS)
    }

    /// The key as a number.
    pub fn to_bits(self) -> u64 {
        self.0
    }

    /// Where the node lies.
    pub fn place(self) -> NodePlace {
        let coordinate = |shift: u32| ((self.0 >> shift) & COORDINATE_MASK) as u32;
        match self.0 >> TAG_SHIFT {
            0 => NodePlace::Vertex(self.0 as u32),
            1 => NodePlace::Edge {
                edge: ((self.0 & !(3 << TAG_SHIFT)) >> COORDINATE_BITS) as u32,
                parameter: coordinate(0),
            },
            _ => NodePlace::Face {
                face: ((self.0 & !(3 << TAG_SHIFT)) >> (2 * COORDINATE_BITS)) as u32,
                i: coordinate(COORDINATE_BITS),
                j: coordinate(0),
            },
        }
    }

    /// Parses `v12`, `e7:3/8` or `f5:1/2,3/4` and checks that the place exists on the mesh.
    ///
    /// # Errors
    /// Not a key, a fraction that is not dyadic and between 0 and 1, or a place that does not exist.
    pub fn parse(text: &str, mesh: &BaseMesh) -> Result<NodeKey, NodeKeyError> {
        let malformed = || NodeKeyError::Malformed(text.to_owned());
        let missing = || NodeKeyError::Missing(text.to_owned());
        let number = |word: &str| whole_number(word).ok_or_else(malformed);
        let (tag, rest) = text.split_at_checked(1).ok_or_else(malformed)?;
        match (tag, rest.split_once(':')) {
            ("v", None) => {
                let vertex = number(rest)?;
                (vertex < mesh.vertex_count()).then(|| NodeKey::vertex(vertex)).ok_or_else(missing)
            }
            ("e", Some((edge, parameter))) => {
                let (edge, parameter) = (number(edge)?, fraction(parameter).ok_or_else(malformed)?);
                let exists = (edge as usize) < mesh.edges().len();
                exists.then(|| NodeKey::edge(edge, parameter)).ok_or_else(missing)
            }
            ("f", Some((face, point))) => {
                let (i, j) = point.split_once(',').ok_or_else(malformed)?;
                let (i, j) = (fraction(i).ok_or_else(malformed)?, fraction(j).ok_or_else(malformed)?);
                let face = number(face)?;
                let exists = (face as usize) < mesh.faces().len();
                exists.then(|| NodeKey::face(face, i, j)).ok_or_else(missing)
            }
            _ => Err(malformed()),
        }
    }
}

impl fmt::Display for NodeKey {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let dyadic = |parameter: u32| {
            let shift = parameter.trailing_zeros();
            format!("{}/{}", parameter >> shift, UNITS >> shift)
        };
        match self.place() {
            NodePlace::Vertex(vertex) => write!(formatter, "v{vertex}"),
            NodePlace::Edge { edge, parameter } => write!(formatter, "e{edge}:{}", dyadic(parameter)),
            NodePlace::Face { face, i, j } => write!(formatter, "f{face}:{},{}", dyadic(i), dyadic(j)),
        }
    }
}

/// Why a text is no node key.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum NodeKeyError {
    /// Not written as a key.
    #[error("'{0}' is not a node: write v12, e7:3/8 or f5:1/2,3/4 (fractions with a power of two below)")]
    Malformed(String),
    /// The base mesh has no such vertex, edge or face.
    #[error("node '{0}' does not exist on this framework")]
    Missing(String),
}

fn fraction(text: &str) -> Option<u32> {
    let (above, below) = text.split_once('/')?;
    let (above, below) = (whole_number(above)?, whole_number(below)?);
    let proper = below.is_power_of_two() && below <= UNITS && 0 < above && above < below;
    proper.then(|| above * (UNITS / below))
}
