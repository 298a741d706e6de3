//! Addresses and places of cells: `face.child.child…` and the same as a square of its face.
//!
//! ```text
//!   ┌───┬───┐      child k holds its parent's corner k and keeps its parent's axes;
//!   │ 3 │ 2 │      a cell of level l is the square (i, j) of the 2^l × 2^l squares
//!   ├───┼───┤      of its face, i along side 0 and j along side 1.
//!   │ 0 │ 1 │
//!   └───┴───┘
//! ```

use crate::MAX_LEVEL;
use std::fmt;
use thiserror::Error;

/// Squares of children 0–3 within their parent.
const CHILD_SQUARES: [(u32, u32); 4] = [(0, 0), (1, 0), (1, 1), (0, 1)];

/// A cell as a square of its face.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Place {
    /// Top-level cell.
    pub face: u32,
    /// Number of subdivisions above the cell.
    pub level: u8,
    /// Column of the square, 0 ≤ i < 2^level.
    pub i: u32,
    /// Row of the square, 0 ≤ j < 2^level.
    pub j: u32,
}

impl Place {
    /// The place of a top-level cell.
    pub fn top(face: u32) -> Place {
        Place { face, level: 0, i: 0, j: 0 }
    }

    /// The place of child `k`.
    pub fn child(self, k: u8) -> Place {
        let (di, dj) = CHILD_SQUARES[usize::from(k)];
        Place { level: self.level + 1, i: 2 * self.i + di, j: 2 * self.j + dj, ..self }
    }

    /// The cell above at `level`, which is no deeper than the cell's own.
    pub fn ancestor(self, level: u8) -> Place {
        let shift = self.level - level;
        Place { level, i: self.i >> shift, j: self.j >> shift, ..self }
    }

    /// The cell is the other one or lies above it.
    pub fn contains(self, other: Place) -> bool {
        self.level <= other.level && other.ancestor(self.level) == self
    }

    /// Which child of its parent the ancestor at `level` (1 or deeper) is.
    pub fn child_at(self, level: u8) -> u8 {
        let shift = self.level - level;
        match ((self.i >> shift) & 1, (self.j >> shift) & 1) {
            (0, 0) => 0,
            (1, 0) => 1,
            (1, 1) => 2,
            _ => 3,
        }
    }

    /// Children's numbers from the top-level cell down to this cell.
    pub fn path(self) -> impl Iterator<Item = u8> {
        (1..=self.level).map(move |level| self.child_at(level))
    }

    /// Parses `face.child.child…`.
    ///
    /// # Errors
    /// Not an address, or deeper than [`MAX_LEVEL`].
    pub fn parse(text: &str) -> Result<Place, AddressError> {
        let malformed = || AddressError::Malformed(text.to_owned());
        let mut words = text.split('.');
        let face = words.next().and_then(whole_number).ok_or_else(malformed)?;
        let mut place = Place::top(face);
        for word in words {
            let child = match word {
                "0" => 0,
                "1" => 1,
                "2" => 2,
                "3" => 3,
                _ => return Err(malformed()),
            };
            if place.level == MAX_LEVEL {
                return Err(AddressError::TooDeep(text.to_owned()));
            }
            place = place.child(child);
        }
        Ok(place)
    }
}

impl fmt::Display for Place {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}", self.face)?;
        self.path().try_for_each(|child| write!(formatter, ".{child}"))
    }
}

/// Why a text is no cell address.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum AddressError {
    /// Not numbers with dots.
    #[error("'{0}' is not a cell address: write the top-level cell and children 0-3, such as 12.0.3")]
    Malformed(String),
    /// Too many children.
    #[error("'{0}' is deeper than level {MAX_LEVEL}, the deepest possible")]
    TooDeep(String),
}

/// A whole number in the one way in which it is written, so that no cell or node has two names: no sign, no
/// leading zero.
pub(crate) fn whole_number(text: &str) -> Option<u32> {
    let plain = text == "0" || text.starts_with(|first: char| matches!(first, '1'..='9'));
    if plain { text.parse().ok() } else { None }
}
