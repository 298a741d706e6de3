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
use springform_evolution::variation::Variation;
use springform_mechanics::assembly::SpringLaw;
use springform_mechanics::equilibrium::Settings;
use springform_mechanics::measures::Measures;
use springform_mechanics::rigging::{Law, Rest, Rigging, SpringGroup};
use springform_topology::base_mesh::BaseMesh;
use springform_topology::cell_type::CellTypeId;
use springform_topology::filters::Method;
use springform_topology::forest::{Content, Forest};
use springform_topology::framework::{Framework, Grid, Part, Shape, Side};
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

/// The same, or all springs of a cord that has a rest length and goes slack.
pub fn cords(edits: usize) -> impl Values<Value = Start> {
    (starts(edits), 1e-3..0.2f64).prop_map(|(mut start, rest)| {
        let group = SpringGroup {
            law: Some(Law::Stiffness(2.0)),
            rest: Some(Rest::Length(rest)),
            ..SpringGroup::default()
        };
        start.setting.rigging.groups.push(group);
        // What the tolerance leaves open is then less than what is compared.
        start.setting.solver.tolerance = 1e-12;
        start
    })
}

fn start(Net { design, embedding, .. }: Net) -> Start {
    let Design { mesh, catalogue, method, anchors, forest } = design;
    let (law, rigging, solver) = (SpringLaw::default(), Rigging::default(), Settings::default());
    Start { setting: Setting { mesh, catalogue, method, anchors, embedding, law, rigging, solver }, forest }
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
        variation: Variation::default(),
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

/// A dia-grid cylinder with four anchors a ring, pulled outward.
pub fn cylinder() -> Start {
    let part = Part { name: "c".to_owned(), shape: Shape::Cylinder, around: 8, along: 4 };
    let framework = Framework { grid: Grid::Dia, parts: vec![part], joins: vec![] };
    let mesh = BaseMesh::from_framework(&framework).expect("a valid cylinder");
    let corners = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
    let rings = [(Side::Start, 0.0), (Side::End, 3.0)];
    let anchor = |side: Side, k: usize| mesh.border_vertex("c", side, 2 * k).expect("a vertex of the ring");
    let anchors: Vec<u32> =
        rings.iter().flat_map(|&(side, _)| (0..4).map(move |k| anchor(side, k))).collect();
    let target = |height: f64| corners.map(|[x, y]| [x, y, height]);
    let positions = rings.iter().flat_map(|&(_, height)| target(height)).collect();
    let setting = Setting::new(mesh, Method::Dynamic, anchors, positions);
    let forest = Forest::new(setting.mesh.faces().len() as u32, Content::QUAD);
    Start { setting, forest }
}

/// Measures that differ by rounding only: what a mutant measures in its parent's order of elimination, and what its
/// genotype measures alone.
pub fn alike(a: &Measures, b: &Measures) -> bool {
    let near = |a: f64, b: f64, size: f64| (a - b).abs() <= 1e-9 * size || a.to_bits() == b.to_bits();
    let differentials = match (a.force_differential, b.force_differential) {
        // The smallest force is known as well as the largest, which is more than it is as a share of itself.
        (Some(a), Some(b)) => near(a, b, a * (1.0 + 1e-5 * a)),
        (a, b) => a == b,
    };
    (a.springs, a.nodes, a.cells) == (b.springs, b.nodes, b.cells)
        && differentials
        && near(a.force_min, b.force_min, a.force_max)
        && near(a.force_max, b.force_max, a.force_max)
        && near(a.force_mean, b.force_mean, a.force_max)
        && near(a.force_deviation, b.force_deviation, a.force_max)
        && near(a.force_range, b.force_range, a.force_max)
        && near(a.total_length, b.total_length, a.total_length)
        && near(a.load_path, b.load_path, a.load_path)
        && near(a.area, b.area, a.total_length * a.total_length)
        && near(a.shortest_spring, b.shortest_spring, a.total_length)
}
