//! Sparse symmetric systems over the rows of a graph: ordering, factors, solutions.
//!
//! A [`Graph`] says which rows share a link; a [`Symbolic`] where the entries of a factor stand; [`ScalarFactor`] holds
//! one number an entry and solves three sides at once, [`BlockFactor`] three by three numbers an entry.
//!
//! Kernels run compiled for the processor's vector units (crate `pulp`). They fuse multiplications and additions
//! by hand, so that they give the same bits on every processor.

mod blocks;
mod columns;
mod graph;
mod panels;
mod scalar;
mod symbolic;

pub use blocks::{Block, BlockFactor};
pub use graph::Graph;
pub use scalar::ScalarFactor;
pub use symbolic::Symbolic;

use thiserror::Error;

/// Three numbers of a row, and a fourth that is zero: one vector register.
pub type Lanes = [f64; 4];

/// The matrix is not positive definite.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Error)]
#[error("the matrix is not positive definite at row {row}")]
pub struct NotPositiveDefinite {
    /// Row of the matrix whose pivot is not above zero.
    pub row: u32,
}
