//! Topology: from a framework of joined cylinders to the springs of a net, in integers only.
//!
//! ```text
//! framework ─ base_mesh ─ forest ─ filters ─ expression
//! (joins)     (quads)     (cells)  (closure)  (nodes and springs, made whole)
//! ```
//!
//! Source: Ahlquist, Erb & Menges, "Evolutionary structural and spatial adaptation of topologically
//! differentiated tensile systems in architectural design", AI EDAM 29(4), 2015, "the paper" in this crate.
//! No floating-point number and no coordinate occurs here: the paper's cell identifier notation
//! "does not contain any geometry" (§3.2).
#![deny(clippy::float_arithmetic, clippy::disallowed_types)]

pub mod address;
pub mod base_mesh;
pub mod cell_type;
pub mod edit;
pub mod expression;
pub mod filters;
pub mod forest;
pub mod framework;
pub mod gene;
pub mod graft;
pub mod node_key;
pub mod notation;
pub mod orientation;
pub mod patch;
pub mod selection;
pub mod sides;
pub mod symmetry;
pub mod tree;

/// Deepest level of subdivision that a cell may have.
pub const MAX_LEVEL: u8 = 20;

/// Largest number of top-level cells that a base mesh may have (node keys hold a face in 20 bits).
pub const MAX_FACES: usize = (1 << 20) - 1;

/// Largest number of cells that a forest is grown to; a mutant with more is invalid.
pub const MAX_CELLS: usize = 4_000_000;
