//! Random settings, strategies and parameters for the tests of evolution.

// Every test file uses another part of this.
#![allow(dead_code)]

#[path = "../../../springform-mechanics/tests/nets/mod.rs"]
pub mod nets;

pub use nets::common;

use common::{Design, Dice};
use nets::{Net, nets};
use proptest::strategy::Strategy as Values;
use springform_evolution::evolve::{Parameters, Selection};
use springform_evolution::fitness::{Criterion, Fitness, SufReference};
use springform_evolution::mutation::{Amount, Strategy};
use springform_evolution::phenotype::Setting;
use springform_evolution::selection::{WEIGHTINGS, WeightingParameters};
use springform_mechanics::assembly::SpringLaw;
use springform_mechanics::equilibrium::Settings;
use springform_mechanics::measures::Measures;
use springform_topology::cell_type::CellTypeId;
use springform_topology::filters::Method;
use springform_topology::forest::Forest;
use std::fmt;

/// A design that gives a net, as evolution sees it.
#[derive(Clone)]
pub struct Start {
    pub setting: Setting,
    pub forest: Forest,
}

/// Short enough to read when a property fails.
impl fmt::Debug for Start {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Setting { mesh, catalogue, method, anchors, .. } = self.setting.clone();
        let design = Design { mesh, catalogue, method, anchors, forest: self.forest.clone() };
        write!(formatter, "{design:?}{:?}", self.setting.embedding.anchor_positions)
    }
}

/// Designs after up to `edits` random edits.
pub fn starts(edits: usize) -> impl Values<Value = Start> {
    nets(edits).prop_map(start)
}

fn start(Net { design, embedding, .. }: Net) -> Start {
    let Design { mesh, catalogue, method, anchors, forest } = design;
    let (law, solver) = (SpringLaw::default(), Settings::default());
    Start { setting: Setting { mesh, catalogue, method, anchors, embedding, law, solver }, forest }
}

/// Types that mutation draws under a method.
pub fn palette(method: Method, dice: &mut Dice) -> Vec<CellTypeId> {
    let choices: &[&[u8]] = match method {
        Method::Recursive => &[&[1]],
        Method::Extensible => &[&[1], &[1, 2], &[1, 2, 3, 4, 5]],
        Method::Dynamic => &[&[1, 6], &[6], &[0, 1, 2, 6]],
    };
    dice.pick(choices).iter().map(|&number| CellTypeId(number)).collect()
}

fn amount(dice: &mut Dice) -> Amount {
    if dice.percent(50) {
        Amount::Count(f64::from(dice.below(5)))
    } else {
        Amount::Share(f64::from(dice.below(31)) / 100.0)
    }
}

pub fn strategy(dice: &mut Dice) -> Strategy {
    let (insertions, switches, toggles) = (amount(dice), amount(dice), amount(dice));
    Strategy { insertions, switches, toggles, weighting: dice.pick(&WEIGHTINGS).0 }
}

pub fn criterion(dice: &mut Dice) -> Criterion {
    Criterion {
        fitness: dice.pick(&[Fitness::Suf, Fitness::Differential]),
        reference: dice.pick(&[SufReference::Start, SufReference::Parent, SufReference::Zero]),
        niche: dice.pick(&[None, Some(4), Some(30)]),
        min_length: dice.pick(&[None, None, Some(0.05)]),
        min_springs: dice.pick(&[None, None, Some(20)]),
        max_springs: dice.pick(&[None, None, Some(60)]),
    }
}

pub fn parameters(method: Method, dice: &mut Dice) -> Parameters {
    Parameters {
        population: dice.between(1, 6),
        seed: u64::from(dice.below(1000)),
        types: palette(method, dice),
        weights: WeightingParameters::default(),
        self_adapt: dice.percent(50),
        criterion: criterion(dice),
        selection: dice.pick(&[Selection::Comma, Selection::Plus]),
    }
}

/// Measures of which only springs, force differential and shortest spring count.
pub fn standing(springs: u32, force_differential: Option<f64>, shortest_spring: f64) -> Measures {
    Measures {
        springs,
        nodes: 4,
        cells: 1,
        force_differential,
        force_min: 1.0,
        force_max: 2.0,
        force_mean: 1.5,
        force_deviation: 0.5,
        force_variation: 0.3,
        force_range: 1.0,
        total_length: 4.0,
        load_path: 4.0,
        area: 1.0,
        shortest_spring,
        length_per_area: 4.0,
    }
}
