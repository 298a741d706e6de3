//! Equilibrium: positions at which springs, rods and loads balance at every free node.
//!
//! ```text
//! solver ─ linear      force is stiffness times length: one sparse factor
//!        ├ descent     strong prestress: many cheap steps in the metric of one such factor
//!        ├ newton      weak prestress, rods, last digits: the exact tangent
//!        ├ mixed       rods first: tensions that follow the step, which may be long
//!        ├ interior    stiff and far-off nets: tensions as unknowns of their own
//!        ├ stability   springs that push, rods: is it a rest that lasts, and where to if not
//!        ├ refinement  stiff nets: the digits that rounding of positions takes
//!        └ followers   around all of these: loads that follow the shape
//! ```
//!
//! [`sensitivity`] holds derivatives of what they find. [`implicit_euler`] moves a net to the same equilibrium step by step. A solve returns its status; it never prints and
//! never panics on a bad net.

mod descent;
pub mod dynamic_relaxation;
mod elements;
mod followers;
pub mod implicit_euler;
mod interior;
mod linear;
mod mixed;
mod newton;
mod refinement;
pub mod sensitivity;
mod solver;
mod stability;
mod state;
mod supports;
mod tangent;

pub use followers::press;
pub use solver::{Solver, solve};
pub use state::{Equilibrium, Method, Settings, Status, loads, reactions, residuals};
