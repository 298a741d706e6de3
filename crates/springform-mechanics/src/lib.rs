//! Mechanics: from springs to equilibrium and measures, in SI units and f64, without randomness.
//!
//! ```text
//! expression + embedding ─ network ─ equilibrium ─ measures
//!                          (inputs)  (results)
//! ```
//!
//! Spring force F = T + k (L − r) [N]; by default k = 1 N/m, r = 0 and T = 0, so that force equals length and equilibrium is
//! one symmetric positive definite system: the force density system of Schek, "The force density method for form
//! finding and computation of general networks", 1974, with q = k.

pub mod assembly;
pub mod border;
pub mod bounded;
pub mod curve;
pub mod embedding;
pub mod equalisation;
pub mod equilibrium;
pub mod measures;
pub mod network;
pub mod rigging;
pub mod rod;
pub mod sparse;
pub mod stage;
pub mod vector;
