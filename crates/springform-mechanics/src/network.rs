//! Network: the phenotype's inputs. Results live in [`crate::equilibrium::Equilibrium`].

use crate::curve::Curve;
use crate::rod::Rod;
use crate::vector::{Vector, length, subtract};
use springform_topology::base_mesh::Groups;
use std::borrow::Cow;
use thiserror::Error;

/// In place of the number of a curve: the spring has none.
pub const NO_CURVE: u32 = u32::MAX;

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

/// Springs between nodes, loads and supports; n nodes, m springs. The arrays may be borrowed from a caller's.
///
/// Spring force F = T + k (L − r) [N], tension positive, within the spring's sense. It holds the laws
/// - Hooke: k, r;
/// - axial stiffness, F = EA (L − L0)/L0 with EA referring to the unstressed length L0: k = EA/L0, r = L0;
/// - constant force: T, k = 0;
/// - force density: k = q, r = 0;
/// - measured curve g: F = k r g((L − r)/r), T = 0, see [`Curve`].
///
/// Temperature changes the unstressed length r before a network is made: r (1 + α Δϑ).
#[derive(Clone, PartialEq, Debug, Default)]
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
    /// Number of the curve of every spring, or [`NO_CURVE`], m; empty if no spring has one.
    pub curve: Cow<'a, [u32]>,
    /// Measured curves.
    pub curves: Cow<'a, [Curve]>,
    /// Rods that bend; their links are springs among the others.
    pub rods: Cow<'a, [Rod]>,
    /// Dead load on every node [N], n.
    pub loads: Cow<'a, [Vector]>,
    /// Weight of every spring along −z per length that it takes [N/m], half at each end, m; empty if none has any.
    pub weight: Cow<'a, [f64]>,
    /// Pressure that stays square to its cells.
    pub pressure: Pressure,
    /// Axes x, y, z along which every node is held, n.
    pub fixed: Cow<'a, [[bool; 3]]>,
    /// Nodes that slide; each is held along no axis and listed once.
    pub slides: Cow<'a, [Slide]>,
}

/// Follower pressure on cells, each a polygon of nodes around it.
#[derive(Clone, PartialEq, Debug)]
pub struct Pressure {
    /// Nodes around every cell.
    pub cells: Groups<u32>,
    /// Pressure on every cell [Pa], positive along the normal of the right-hand rule.
    pub values: Vec<f64>,
}

impl Default for Pressure {
    fn default() -> Self {
        Pressure { cells: Groups::collect(0, std::iter::empty()), values: Vec::new() }
    }
}

/// A node that moves along a line or in a plane through its start.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Slide {
    /// The node.
    pub node: u32,
    /// Where it may go.
    pub path: Path,
}

/// The way of a node that slides; of any length but zero.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Path {
    /// Along a direction.
    Line(Vector),
    /// Square to a normal.
    Plane(Vector),
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
    /// A part that names a node, spring or curve that it can't.
    #[error("{name}[{index}] {problem}")]
    Part {
        /// Which list.
        name: &'static str,
        /// Which entry.
        index: usize,
        /// What is wrong.
        problem: &'static str,
    },
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
        // Empty stands for none.
        let curves = if self.curve.is_empty() { springs } else { self.curve.len() };
        let weights = if self.weight.is_empty() { springs } else { self.weight.len() };
        for (name, found, expected) in [
            ("curve", curves, springs),
            ("weight", weights, springs),
            ("pressure", self.pressure.values.len(), self.pressure.cells.len()),
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
            ("weight", self.weight.iter().position(|weight| !weight.is_finite()), "finite"),
            ("pressure", self.pressure.values.iter().position(|value| !value.is_finite()), "finite"),
        ] {
            if let Some(index) = index {
                return Err(NetworkError::Value { name, index, rule });
            }
        }
        self.check_parts()
    }

    fn check_parts(&self) -> Result<(), NetworkError> {
        let exists = |node: &u32| (*node as usize) < self.positions.len();
        let wrong = |name, index, problem| Err(NetworkError::Part { name, index, problem });
        for (spring, &curve) in self.curve.iter().enumerate().filter(|&(_, &curve)| curve != NO_CURVE) {
            if curve as usize >= self.curves.len() {
                return wrong("curve", spring, "is no curve");
            }
            let elastic = self.rest_length[spring] > 0.0 && self.stiffness[spring] > 0.0;
            if !elastic || self.force[spring] != 0.0 {
                return wrong(
                    "curve",
                    spring,
                    "needs a stiffness and a rest length above 0, and no constant force",
                );
            }
        }
        for (index, rod) in self.rods.iter().enumerate() {
            let links = if rod.closed { rod.nodes.len() } else { rod.nodes.len().saturating_sub(1) };
            let mut sorted = rod.nodes.clone();
            sorted.sort_unstable();
            sorted.dedup();
            if !rod.nodes.iter().all(exists) || sorted.len() != rod.nodes.len() || rod.nodes.len() < 3 {
                return wrong("rods", index, "needs three different nodes or more");
            }
            if rod.lengths.len() != links
                || !rod.lengths.iter().all(|length| *length > 0.0 && length.is_finite())
            {
                return wrong("rods", index, "needs a length above 0 for each link");
            }
            if !(rod.bending_stiffness >= 0.0 && rod.bending_stiffness.is_finite()) {
                return wrong("rods", index, "needs a bending stiffness that is finite and not below 0");
            }
        }
        let mut sliding: Vec<u32> = self.slides.iter().map(|slide| slide.node).collect();
        sliding.sort_unstable();
        for (index, slide) in self.slides.iter().enumerate() {
            let (Path::Line(along) | Path::Plane(along)) = slide.path;
            if !exists(&slide.node) || self.fixed[slide.node as usize].contains(&true) {
                return wrong("slides", index, "must name a node that is held along no axis");
            }
            if !(length(along) > 0.0 && length(along).is_finite()) {
                return wrong("slides", index, "needs a direction of a length above 0");
            }
        }
        if let Some(pair) = sliding.windows(2).find(|pair| pair[0] == pair[1]) {
            let twice = self.slides.iter().rposition(|slide| slide.node == pair[0]);
            return wrong("slides", twice.unwrap_or(0), "names a node that slides already");
        }
        let lost = |cell: &u32| !self.pressure.cells.of(*cell).iter().all(exists);
        if let Some(cell) = (0..self.pressure.cells.len() as u32).find(lost) {
            return wrong("pressure", cell as usize, "names a node that does not exist");
        }
        Ok(())
    }

    /// Force is stiffness times length in every spring, loads are dead, and nodes are held along all axes or none.
    pub fn is_linear(&self) -> bool {
        let plain = |spring: usize| {
            self.rest_length[spring] == 0.0
                && self.force[spring] == 0.0
                && self.sense[spring] != Sense::Compression
        };
        let whole = |axes: &[bool; 3]| axes[0] == axes[1] && axes[1] == axes[2];
        (0..self.springs.len()).all(plain)
            && self.rods.is_empty()
            && self.slides.is_empty()
            && !self.has_followers()
            && self.fixed.iter().all(whole)
    }

    /// Loads depend on where the nodes are.
    pub fn has_followers(&self) -> bool {
        !self.weight.is_empty() || !self.pressure.values.is_empty()
    }

    /// The curve of a spring.
    pub fn curve_of(&self, spring: usize) -> Option<&Curve> {
        let number = *self.curve.get(spring)?;
        (number != NO_CURVE).then(|| &self.curves[number as usize])
    }

    /// Force of a spring at a length [N], tension positive.
    pub fn force_at(&self, spring: usize, length: f64) -> f64 {
        self.force_beyond(spring, length - self.rest_length[spring])
    }

    /// Force of a spring that is longer than its rest length by so much [N], tension positive.
    pub fn force_beyond(&self, spring: usize, longer: f64) -> f64 {
        let (k, rest) = (self.stiffness[spring], self.rest_length[spring]);
        let stretched = match self.curve_of(spring) {
            None => k * longer,
            Some(curve) => k * rest * curve.value(longer / rest),
        };
        let elastic = self.force[spring] + stretched;
        match self.sense[spring] {
            Sense::Tension => elastic.max(0.0),
            Sense::Both => elastic,
            Sense::Compression => elastic.min(0.0),
        }
    }

    /// Strain energy of a spring at a length [J], up to a constant.
    pub fn energy_at(&self, spring: usize, length: f64) -> f64 {
        let (k, rest, force) =
            (self.stiffness[spring], self.rest_length[spring], self.force_at(spring, length));
        if let Some(curve) = self.curve_of(spring) {
            let slack = self.sense[spring] != Sense::Both && force == 0.0;
            return if slack { 0.0 } else { k * rest * rest * curve.area((length - rest) / rest) };
        }
        if k > 0.0 { 0.5 * force * force / k } else { force * length }
    }

    /// Change of a spring's force with its length, at a length [N/m].
    pub fn stiffness_at(&self, spring: usize, length: f64) -> f64 {
        let slack = self.sense[spring] != Sense::Both && self.force_at(spring, length) == 0.0;
        let (k, rest) = (self.stiffness[spring], self.rest_length[spring]);
        match self.curve_of(spring) {
            _ if slack => 0.0,
            None => k,
            Some(curve) => k * curve.slope((length - rest) / rest),
        }
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

    /// Strain energy of every spring [J], up to a constant for constant forces.
    pub fn spring_energies(&self, positions: &[Vector]) -> Vec<f64> {
        let lengths = self.lengths(positions).into_iter();
        lengths.enumerate().map(|(spring, length)| self.energy_at(spring, length)).collect()
    }

    /// The same network, with arrays of its own.
    pub fn into_owned(self) -> Network<'static> {
        Network {
            positions: Cow::Owned(self.positions.into_owned()),
            springs: Cow::Owned(self.springs.into_owned()),
            stiffness: Cow::Owned(self.stiffness.into_owned()),
            rest_length: Cow::Owned(self.rest_length.into_owned()),
            force: Cow::Owned(self.force.into_owned()),
            sense: Cow::Owned(self.sense.into_owned()),
            curve: Cow::Owned(self.curve.into_owned()),
            curves: Cow::Owned(self.curves.into_owned()),
            rods: Cow::Owned(self.rods.into_owned()),
            loads: Cow::Owned(self.loads.into_owned()),
            weight: Cow::Owned(self.weight.into_owned()),
            pressure: self.pressure,
            fixed: Cow::Owned(self.fixed.into_owned()),
            slides: Cow::Owned(self.slides.into_owned()),
        }
    }
}
