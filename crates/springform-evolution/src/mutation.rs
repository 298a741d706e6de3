//! Mutation in three steps, as lists of edits (the paper §3.4, Fig. 13).

use crate::draws::Draws;
use crate::selection::{WEIGHTINGS, Weighting, WeightingParameters, draw_without_replacement, weight};
use springform_topology::MAX_LEVEL;
use springform_topology::address::Place;
use springform_topology::cell_type::{Catalogue, CellTypeId};
use springform_topology::edit::Edit;
use springform_topology::forest::{Content, Forest};

/// How many cells a step draws.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Amount {
    /// A number of cells, rounded to the nearest whole.
    Count(f64),
    /// A share of the cells that could be drawn, rounded up.
    Share(f64),
}

impl Amount {
    /// Number of cells drawn from `candidates`.
    pub fn of(self, candidates: usize) -> usize {
        match self {
            Amount::Count(count) => count.round() as usize,
            // 7 % of 100 is 7, though 0.07 × 100 is a little more.
            Amount::Share(share) => (share * candidates as f64 * (1.0 - 1e-12)).ceil() as usize,
        }
    }

    fn times(self, factor: f64) -> Amount {
        match self {
            Amount::Count(count) => Amount::Count(count * factor),
            Amount::Share(share) => Amount::Share((share * factor).min(1.0)),
        }
    }
}

/// Strategy parameters: with self-adaptation they belong to the individual and mutate with it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Strategy {
    /// Step 1: cells that are subdivided.
    pub insertions: Amount,
    /// Step 2: cells that switch type.
    pub switches: Amount,
    /// Step 3: subdivisions that are toggled off or on.
    pub toggles: Amount,
    /// How cells are weighted.
    pub weighting: Weighting,
}

/// Rechenberg's factor of two-point step-size variation.
const STEP_FACTOR: f64 = 1.3;

/// Chance that self-adaptation draws a new weighting.
const WEIGHTING_CHANCE: f64 = 0.1;

impl Strategy {
    /// A mutated strategy: each amount shrinks, stays or grows; insertions stay at one cell or more.
    pub fn mutated(&self, draws: &mut Draws) -> Strategy {
        let mut vary =
            |amount: Amount| amount.times([1.0 / STEP_FACTOR, 1.0, STEP_FACTOR][draws.below(3) as usize]);
        let insertions = match vary(self.insertions) {
            Amount::Count(count) => Amount::Count(count.max(1.0)),
            share => share,
        };
        let (switches, toggles) = (vary(self.switches), vary(self.toggles));
        let weighting = if draws.unit() < WEIGHTING_CHANCE {
            WEIGHTINGS[draws.below(WEIGHTINGS.len() as u32) as usize].0
        } else {
            self.weighting
        };
        Strategy { insertions, switches, toggles, weighting }
    }
}

/// A cell that a step may draw.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    place: Place,
    content: Content,
    /// For owners of children: the switch.
    on: bool,
    /// Inner force of the cell, or of its subtree [N].
    force: f64,
}

/// What can be mutated in a parent, listed once for all its mutants.
#[derive(Clone, Debug)]
pub struct Candidates {
    /// Expressed cells without stored children, above the deepest level.
    divisible: Vec<Candidate>,
    expressed: Vec<Candidate>,
    /// Reachable cells that own children.
    owners: Vec<Candidate>,
    deepest: u8,
}

impl Candidates {
    /// Lists a closed forest; `inner_forces` holds one force [N] an expressed cell, in order of face and child.
    pub fn new(forest: &Forest, inner_forces: &[f64]) -> Candidates {
        let (mut divisible, mut expressed) = (Vec::new(), Vec::new());
        let mut owners: Vec<Candidate> = Vec::new();
        // Ancestors of the cell under visit, as indices of `owners`.
        let mut above: Vec<usize> = Vec::new();
        let mut deepest = 0;
        forest.visit_reachable(|cell, place| {
            above.retain(|&owner| owners[owner].place.contains(place));
            let candidate =
                Candidate { place, content: forest.content(cell), on: forest.is_on(cell), force: 0.0 };
            let stored = forest.children(cell).is_some();
            if stored {
                above.push(owners.len());
                owners.push(candidate);
            }
            if forest.expressed_children(cell).is_none() {
                let force = inner_forces.get(expressed.len()).copied().unwrap_or(0.0);
                for &owner in &above {
                    owners[owner].force += force;
                }
                deepest = deepest.max(place.level);
                let candidate = Candidate { force, ..candidate };
                expressed.push(candidate);
                if !stored && place.level < MAX_LEVEL {
                    divisible.push(candidate);
                }
            }
        });
        Candidates { divisible, expressed, owners, deepest }
    }
}

/// What mutation draws from.
#[derive(Clone, Copy, Debug)]
pub struct Palette<'a> {
    /// Types that may be drawn; not empty.
    pub types: &'a [CellTypeId],
    /// The catalogue they belong to.
    pub catalogue: &'a Catalogue,
    /// Numbers in the weights.
    pub weights: &'a WeightingParameters,
}

impl Palette<'_> {
    fn draw(&self, draws: &mut Draws) -> Content {
        let kind = self.types[draws.below(self.types.len() as u32) as usize];
        let turns = self.catalogue.get(kind).distinct_turns();
        Content { kind, turn: draws.below(u32::from(turns)) as u8 }
    }
}

/// The edits of one mutant: insert, switch type, toggle.
///
/// Newborn cells are immune to the later steps, and their ancestors to toggling, so that they express themselves.
pub fn mutate(
    candidates: &Candidates,
    strategy: &Strategy,
    palette: &Palette<'_>,
    draws: &mut Draws,
) -> Vec<Edit> {
    let drawn = |list: &[Candidate], amount: Amount, immune: &[Place], draws: &mut Draws| {
        let weights: Vec<f64> = list
            .iter()
            .map(|candidate| {
                if immune.iter().any(|&newborn| candidate.place.contains(newborn)) {
                    return 0.0;
                }
                let level = candidate.place.level;
                weight(strategy.weighting, palette.weights, level, candidates.deepest, candidate.force)
            })
            .collect();
        draw_without_replacement(&weights, amount.of(list.len()), draws)
    };
    let mut edits = Vec::new();
    let mut divided = Vec::new();
    for at in drawn(&candidates.divisible, strategy.insertions, &[], draws) {
        let cell = candidates.divisible[at].place;
        edits.push(Edit::Subdivide { cell, children: std::array::from_fn(|_| palette.draw(draws)) });
        divided.push(cell);
    }
    for at in drawn(&candidates.expressed, strategy.switches, &divided, draws) {
        let Candidate { place: cell, content: from, .. } = candidates.expressed[at];
        let to = palette.draw(draws);
        if from != to {
            edits.push(Edit::Retype { cell, from, to });
        }
    }
    for at in drawn(&candidates.owners, strategy.toggles, &divided, draws) {
        let Candidate { place: cell, on, .. } = candidates.owners[at];
        edits.push(Edit::Toggle { cell, on: !on });
    }
    edits
}
