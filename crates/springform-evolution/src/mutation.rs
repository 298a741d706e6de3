//! Mutation in three steps, as lists of edits (the paper §3.4, Fig. 13).

use crate::draws::Draws;
use crate::selection::{SumTree, WEIGHTINGS, Weighting, WeightingParameters, weight};
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
    /// Factor on its weight; 0: it may not be drawn.
    factor: f64,
    /// Among owners, the one right above; `NONE` for a top-level cell.
    above: usize,
}

impl Candidate {
    /// A favoured cell is to grow: what it owns is turned off that much more rarely, not more often.
    fn toggling_factor(&self) -> f64 {
        if self.on && self.factor > 1.0 { 1.0 / self.factor } else { self.factor }
    }
}

const NONE: usize = usize::MAX;

/// The steps of a mutation.
const INSERT: usize = 0;
const SWITCH: usize = 1;
const TOGGLE: usize = 2;

/// What can be mutated in a parent, listed once for all its mutants.
#[derive(Clone, Debug)]
pub struct Candidates {
    /// Expressed cells without stored children, above the deepest level, as indices of `expressed`.
    divisible: Vec<usize>,
    expressed: Vec<Candidate>,
    /// Reachable cells that own children.
    owners: Vec<Candidate>,
    /// How many of the expressed cells and of the owners may be drawn.
    switchable: usize,
    togglable: usize,
    deepest: u8,
    weighed: Vec<Weighed>,
}

/// Candidates under one weighting, step by step.
#[derive(Clone, Debug)]
struct Weighed {
    weighting: Weighting,
    parameters: WeightingParameters,
    steps: [SumTree; 3],
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
            while above.last().is_some_and(|&owner| !owners[owner].place.contains(place)) {
                above.pop();
            }
            let candidate = Candidate {
                place,
                content: forest.content(cell),
                on: forest.is_on(cell),
                force: 0.0,
                factor: 1.0,
                above: above.last().copied().unwrap_or(NONE),
            };
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
                if !stored && place.level < MAX_LEVEL {
                    divisible.push(expressed.len());
                }
                expressed.push(Candidate { force, ..candidate });
            }
        });
        let (switchable, togglable) = (expressed.len(), owners.len());
        Candidates { divisible, expressed, owners, switchable, togglable, deepest, weighed: Vec::new() }
    }

    /// Works out the weights under a weighting ahead of the mutants that need them.
    pub fn weigh(&mut self, weighting: Weighting, parameters: &WeightingParameters) {
        if self.weighed_by(weighting, parameters).is_none() {
            let steps = [INSERT, SWITCH, TOGGLE].map(|step| self.sums(step, weighting, parameters));
            self.weighed.push(Weighed { weighting, parameters: *parameters, steps });
        }
    }

    fn weighed_by(&self, weighting: Weighting, parameters: &WeightingParameters) -> Option<&Weighed> {
        self.weighed.iter().find(|one| one.weighting == weighting && one.parameters == *parameters)
    }

    fn sums(&self, step: usize, weighting: Weighting, parameters: &WeightingParameters) -> SumTree {
        let weight = |candidate: &Candidate| {
            let level = candidate.place.level;
            let factor = if step == TOGGLE { candidate.toggling_factor() } else { candidate.factor };
            factor * weight(weighting, parameters, level, self.deepest, candidate.force)
        };
        match step {
            INSERT => SumTree::new(self.divisible.iter().map(|&at| weight(&self.expressed[at]))),
            SWITCH => SumTree::new(self.expressed.iter().map(weight)),
            _ => SumTree::new(self.owners.iter().map(weight)),
        }
    }

    /// Multiplies weights by a factor a cell; cells of factor 0 are never drawn nor counted.
    ///
    /// Comes before [`Candidates::weigh`].
    pub fn favour(&mut self, factor: impl Fn(Place) -> f64) {
        for list in [&mut self.expressed, &mut self.owners] {
            list.iter_mut().for_each(|candidate| candidate.factor = factor(candidate.place));
        }
        self.divisible.retain(|&at| self.expressed[at].factor > 0.0);
        let drawable = |list: &[Candidate]| list.iter().filter(|candidate| candidate.factor > 0.0).count();
        (self.switchable, self.togglable) = (drawable(&self.expressed), drawable(&self.owners));
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
    let mut edits = Vec::new();
    Mutator::default().mutate(candidates, strategy, palette, draws, &mut edits);
    edits
}

/// Draws one mutant after the other without asking for new memory, once it has drawn one of the size.
#[derive(Clone, Debug, Default)]
pub struct Mutator {
    sums: SumTree,
    drawn: Vec<usize>,
    /// Cells that are divided, as indices of the expressed ones.
    divided: Vec<usize>,
}

impl Mutator {
    /// Appends the edits of one mutant, as the function [`mutate`] gives them.
    pub fn mutate(
        &mut self,
        candidates: &Candidates,
        strategy: &Strategy,
        palette: &Palette<'_>,
        draws: &mut Draws,
        edits: &mut Vec<Edit>,
    ) {
        let Candidates { divisible, expressed, owners, .. } = candidates;
        self.divided.clear();
        self.weigh(candidates, INSERT, strategy, palette);
        self.draw(strategy.insertions.of(divisible.len()), draws);
        for &at in &self.drawn {
            let cell = expressed[divisible[at]].place;
            edits.push(Edit::Subdivide { cell, children: std::array::from_fn(|_| palette.draw(draws)) });
            self.divided.push(divisible[at]);
        }
        self.weigh(candidates, SWITCH, strategy, palette);
        self.divided.iter().for_each(|&newborn| self.sums.clear(newborn));
        self.draw(strategy.switches.of(candidates.switchable), draws);
        for &at in &self.drawn {
            let Candidate { place: cell, content: from, .. } = expressed[at];
            let to = palette.draw(draws);
            if from != to {
                edits.push(Edit::Retype { cell, from, to });
            }
        }
        self.weigh(candidates, TOGGLE, strategy, palette);
        for &newborn in &self.divided {
            let mut owner = expressed[newborn].above;
            while owner != NONE {
                self.sums.clear(owner);
                owner = owners[owner].above;
            }
        }
        self.draw(strategy.toggles.of(candidates.togglable), draws);
        for &at in &self.drawn {
            let Candidate { place: cell, on, .. } = owners[at];
            edits.push(Edit::Toggle { cell, on: !on });
        }
    }

    fn weigh(&mut self, candidates: &Candidates, step: usize, strategy: &Strategy, palette: &Palette<'_>) {
        match candidates.weighed_by(strategy.weighting, palette.weights) {
            Some(weighed) => self.sums.clone_from(&weighed.steps[step]),
            None => self.sums = candidates.sums(step, strategy.weighting, palette.weights),
        }
    }

    fn draw(&mut self, count: usize, draws: &mut Draws) {
        self.drawn.clear();
        self.sums.draw(count, draws, &mut self.drawn);
    }
}
