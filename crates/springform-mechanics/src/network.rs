//! Network: the phenotype's inputs. Results live in [`crate::equilibrium::Equilibrium`].

use crate::vector::{Vector, length, subtract};
use std::borrow::Cow;
use thiserror::Error;

/// Whether a spring pulls, pushes, or both.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Sense {
    /// A cord: no force where it would push.
    Tension,
    /// A bar.
    Both,
    /// A strut that may lift off: no force where it would pull.
    Compression,
}

/// Springs between nodes; n nodes, m springs. The arrays may be borrowed from a caller's.
///
/// Spring force F = T + k (L − r) [N], tension positive, within the spring's sense. It holds the laws
/// - Hooke: k, r;
/// - axial stiffness, F = EA (L − L0)/L0 with EA referring to the unstressed length L0: k = EA/L0, r = L0;
/// - constant force: T, k = 0;
/// - force density: k = q, r = 0.
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
    /// Constant part T of the force of every spring [N], m.
    pub force: Cow<'a, [f64]>,
    /// Sense of every spring, m.
    pub sense: Cow<'a, [Sense]>,
    /// Load on every node [N], n.
    pub loads: Cow<'a, [Vector]>,
    /// Axes x, y, z along which every node is held, n.
    pub fixed: Cow<'a, [[bool; 3]]>,
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
            ("force", self.force.len(), springs),
            ("sense", self.sense.len(), springs),
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
        let not_negative = |r: &f64| *r >= 0.0 && r.is_finite();
        let idle = |spring: &usize| self.stiffness[*spring] == 0.0 && self.force[*spring] == 0.0;
        for (name, index, rule) in [
            ("positions", bad_row(&self.positions), "finite"),
            ("loads", bad_row(&self.loads), "finite"),
            ("stiffness", self.stiffness.iter().position(|k| !not_negative(k)), "finite and not below 0"),
            ("stiffness", (0..springs).find(idle), "above 0, or the spring needs a constant force"),
            ("force", self.force.iter().position(|force| !force.is_finite()), "finite"),
            ("rest_length", self.rest_length.iter().position(|r| !not_negative(r)), "finite and not below 0"),
        ] {
            if let Some(index) = index {
                return Err(NetworkError::Value { name, index, rule });
            }
        }
        Ok(())
    }

    /// Force is stiffness times length in every spring, and nodes are held along all axes or none.
    pub fn is_linear(&self) -> bool {
        let plain = |spring: usize| {
            self.rest_length[spring] == 0.0
                && self.force[spring] == 0.0
                && self.sense[spring] != Sense::Compression
        };
        let whole = |axes: &[bool; 3]| axes[0] == axes[1] && axes[1] == axes[2];
        (0..self.springs.len()).all(plain) && self.fixed.iter().all(whole)
    }

    /// Force of a spring at a length [N], tension positive.
    pub fn force_at(&self, spring: usize, length: f64) -> f64 {
        let elastic = self.force[spring] + self.stiffness[spring] * (length - self.rest_length[spring]);
        match self.sense[spring] {
            Sense::Tension => elastic.max(0.0),
            Sense::Both => elastic,
            Sense::Compression => elastic.min(0.0),
        }
    }

    /// Strain energy of a spring at a length [J], up to a constant.
    pub fn energy_at(&self, spring: usize, length: f64) -> f64 {
        let (force, k) = (self.force_at(spring, length), self.stiffness[spring]);
        if k > 0.0 { 0.5 * force * force / k } else { force * length }
    }

    /// Change of a spring's force with its length, at a length [N/m].
    pub fn stiffness_at(&self, spring: usize, length: f64) -> f64 {
        let slack = self.sense[spring] != Sense::Both && self.force_at(spring, length) == 0.0;
        if slack { 0.0 } else { self.stiffness[spring] }
    }

    /// Length of every spring [m].
    pub fn lengths(&self, positions: &[Vector]) -> Vec<f64> {
        let spring_length =
            |&[a, b]: &[u32; 2]| length(subtract(positions[b as usize], positions[a as usize]));
        self.springs.iter().map(spring_length).collect()
    }

    /// Force of every spring [N], tension positive.
    pub fn forces(&self, positions: &[Vector]) -> Vec<f64> {
        let lengths = self.lengths(positions).into_iter();
        lengths.enumerate().map(|(spring, length)| self.force_at(spring, length)).collect()
    }
}
