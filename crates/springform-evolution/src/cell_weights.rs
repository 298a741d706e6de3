//! Weights on cells, as a designer brushes them: grow here, keep out.

use springform_topology::address::Place;
use std::collections::{BTreeMap, BTreeSet};

/// Factors on the chance that mutation draws a cell; a cell without one has that of the cell it descends from, or 1.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct CellWeights {
    factors: BTreeMap<Place, f64>,
    /// Cells of factor 0 and all above them: a change of these would change what is kept.
    kept: BTreeSet<Place>,
}

impl CellWeights {
    /// Takes a factor, finite and not negative, for every cell; the last one counts.
    pub fn new(factors: impl IntoIterator<Item = (Place, f64)>) -> CellWeights {
        let factors = BTreeMap::from_iter(factors);
        let zero = factors.iter().filter(|&(_, &factor)| factor == 0.0);
        let kept = zero.flat_map(|(place, _)| (0..=place.level).map(|level| place.ancestor(level))).collect();
        CellWeights { factors, kept }
    }

    /// Every cell has factor 1.
    pub fn is_empty(&self) -> bool {
        self.factors.is_empty()
    }

    /// Factor on the weight of a cell; 0: mutation never draws it.
    pub fn of(&self, place: Place) -> f64 {
        if self.kept.contains(&place) {
            return 0.0;
        }
        let nearest = (0..=place.level).rev().find_map(|level| self.factors.get(&place.ancestor(level)));
        nearest.copied().unwrap_or(1.0)
    }
}
