//! Evolution: the hybrid evolutionary algorithm and direct stress-seeking (the paper §3.1, §3.3–3.6).
//!
//! ```text
//! parent ─ mutation (edits) ─ closure ─ expression ─ equilibrium ─ measures ─ fitness ─ next parent
//! ```
//!
//! All randomness of springFORM lives here; every draw comes from (seed, generation, individual), so results do
//! not depend on the number of threads, nor on interruptions. There is no clock here and no input or output.

pub mod cell_weights;
pub mod census;
pub mod draws;
pub mod ending;
pub mod evolve;
pub mod fitness;
pub mod lineage;
pub mod mutation;
pub mod phenotype;
pub mod selection;
pub mod stress_seeking;
pub mod variation;
pub mod workspace;
