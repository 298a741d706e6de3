//! Network: the phenotype's inputs. Results live in [`crate::equilibrium::Equilibrium`].

use crate::vector::{Vector, length, subtract};
use std::borrow::Cow;
use thiserror::Error;

/// Springs between nodes; n nodes, m springs. The arrays may be borrowed from a caller's.
#[derive(Clone, PartialEq, Debug)]
pub struct Network<'a> {
    /// Start position of every node [m], n.
    pub positions: Cow<'a, [Vector]>,
    /// The two nodes of every spring, m.
    pub springs: Cow<'a, [[u32; 2]]>,
    /// Stiffness k of every spring [N/m], m.
    pub stiffness: Cow<'a, [f64]>,
    /// Rest length r of every spring [m], m.
    pub rest_length: Cow<'a, [f64]>,
    /// Load on every node [N], n.
    pub loads: Cow<'a, [Vector]>,
    /// Nodes held in place, n.
    pub fixed: Cow<'a, [bool]>,
}

/// What is wrong with a network.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum NetworkError {
    /// Arrays that should be of one length are not.
    #[error("{name} has {found} rows instead of {expected}")]
    Length {
        /// Which array.
        name: &'static str,
        /// Its rows.
        found: usize,
        /// The rows that it should have.
        expected: usize,
    },
    /// A spring to a node that does not exist, or from a node to itself.
    #[error("spring {0} joins nodes that do not exist or are the same")]
    Spring(usize),
    /// A number that is not finite, or a stiffness or rest length that is not allowed.
    #[error("{name}[{index}] must be {rule}")]
    Value {
        /// Which array.
        name: &'static str,
        /// Which row.
        index: usize,
        /// What is allowed.
        rule: &'static str,
    },
}

impl Network<'_> {
    /// Checks shapes and values.
    ///
    /// # Errors
    /// The first thing that is wrong.
    pub fn check(&self) -> Result<(), NetworkError> {
        let (nodes, springs) = (self.positions.len(), self.springs.len());
        for (name, found, expected) in [
            ("loads", self.loads.len(), nodes),
            ("fixed", self.fixed.len(), nodes),
            ("stiffness", self.stiffness.len(), springs),
            ("rest_length", self.rest_length.len(), springs),
        ] {
            if found != expected {
                return Err(NetworkError::Length { name, found, expected });
            }
        }
        let exists = |node: u32| (node as usize) < nodes;
        if let Some(spring) = self.springs.iter().position(|&[a, b]| a == b || !exists(a) || !exists(b)) {
            return Err(NetworkError::Spring(spring));
        }
        let finite = |vector: &Vector| vector.iter().all(|value| value.is_finite());
        let bad_row = |rows: &[Vector]| rows.iter().position(|row| !finite(row));
        let positive = |k: &f64| *k > 0.0 && k.is_finite();
        let not_negative = |r: &f64| *r >= 0.0 && r.is_finite();
        for (name, index, rule) in [
            ("positions", bad_row(&self.positions), "finite"),
            ("loads", bad_row(&self.loads), "finite"),
            ("stiffness", self.stiffness.iter().position(|k| !positive(k)), "finite and above 0"),
            ("rest_length", self.rest_length.iter().position(|r| !not_negative(r)), "finite and not below 0"),
        ] {
            if let Some(index) = index {
                return Err(NetworkError::Value { name, index, rule });
            }
        }
        Ok(())
    }

    /// All rest lengths are zero: equilibrium is linear.
    pub fn is_linear(&self) -> bool {
        self.rest_length.iter().all(|&r| r == 0.0)
    }

    /// Length of every spring [m].
    pub fn lengths(&self, positions: &[Vector]) -> Vec<f64> {
        let spring_length =
            |&[a, b]: &[u32; 2]| length(subtract(positions[b as usize], positions[a as usize]));
        self.springs.iter().map(spring_length).collect()
    }

    /// Force of every spring, F = k (L − r) [N], tension positive.
    pub fn forces(&self, positions: &[Vector]) -> Vec<f64> {
        let lengths = self.lengths(positions).into_iter();
        lengths.enumerate().map(|(s, length)| self.stiffness[s] * (length - self.rest_length[s])).collect()
    }
}
