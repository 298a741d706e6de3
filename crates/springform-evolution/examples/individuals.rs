//! Evaluates mutants of one parent: `individuals [COUNT] [SPRINGS] [recursive]`.
//!
//! Prints the median time of each stage, and a digest of all measures, which is the same for whatever way they are
//! computed. `valgrind --tool=callgrind --toggle-collect='individuals::evaluate'` counts its instructions.

use springform_evolution::evolve::{Evolution, Individual, Parameters};
use springform_evolution::fitness::{Criterion, Fitness};
use springform_evolution::mutation::{Amount, Strategy};
use springform_evolution::phenotype::{PhenotypeError, Setting};
use springform_evolution::selection::Weighting;
use springform_evolution::workspace::Workspace;
use springform_mechanics::stage::STAGES;
use springform_topology::base_mesh::BaseMesh;
use springform_topology::cell_type::{DYNAMIC, QUAD};
use springform_topology::filters::Method;
use springform_topology::forest::{Content, Forest};
use springform_topology::framework::{Framework, Grid, Part, Shape, Side};
use std::time::Instant;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number =
        |at: usize, default: u32| arguments.get(at).and_then(|word| word.parse().ok()).unwrap_or(default);
    let (count, springs) = (number(0, 500), number(1, 2000));
    let recursive = arguments.iter().any(|word| word == "recursive");
    let evolution = grown(recursive, springs).expect("the cylinder gives a net");
    println!("{} springs, digest {:016x}", evolution.parent().measures.springs, evaluate(&evolution, count));
    for (name, seconds) in stage_times(&evolution, count) {
        println!("{name:>8} {:8.1} us", 1e6 * seconds);
    }
}

/// Median seconds of each stage and of all together.
fn stage_times(evolution: &Evolution, count: u32) -> Vec<(&'static str, f64)> {
    let mut times: Vec<Vec<f64>> = vec![Vec::new(); STAGES.len() + 1];
    let mut workspace = Workspace::default();
    for index in 0..count {
        let mut spent = vec![0.0; STAGES.len()];
        let mut last = Instant::now();
        evolution.individual_in(evolution.generation() + 1, index, &mut workspace, &mut |stage| {
            let now = Instant::now();
            spent[stage as usize] += (now - last).as_secs_f64();
            last = now;
        });
        spent.push(spent.iter().sum());
        times.iter_mut().zip(spent).for_each(|(times, spent)| times.push(spent));
    }
    let median = |mut times: Vec<f64>| {
        times.sort_unstable_by(f64::total_cmp);
        times[times.len() / 2]
    };
    let names = STAGES.iter().map(|&(_, name)| name).chain(["all"]);
    names.zip(times.into_iter().map(median)).collect()
}

/// A digest of the measures of `count` mutants.
#[inline(never)]
fn evaluate(evolution: &Evolution, count: u32) -> u64 {
    let number = evolution.generation() + 1;
    let mut workspace = Workspace::default();
    let mut individual = |index| evolution.individual_in(number, index, &mut workspace, &mut |_| {});
    (0..count).fold(0xcbf2_9ce4_8422_2325, |hash, index| absorb(hash, &individual(index)))
}

fn absorb(hash: u64, individual: &Individual) -> u64 {
    let mix = |hash: u64, value: u64| (hash ^ value).wrapping_mul(0x0100_0000_01b3).rotate_left(29);
    let Some(measures) = individual.measures else { return mix(hash, individual.fingerprint) };
    let numbers = [
        measures.force_min,
        measures.force_max,
        measures.force_deviation,
        measures.load_path,
        measures.area,
        measures.shortest_spring,
        measures.total_length,
    ];
    let hash = mix(mix(hash, individual.fingerprint), u64::from(measures.springs));
    numbers.into_iter().fold(hash, |hash, number| mix(hash, number.to_bits()))
}

/// A run at the generation at which its parent first has so many springs.
fn grown(recursive: bool, springs: u32) -> Result<Evolution, PhenotypeError> {
    let setting = cylinder(if recursive { Method::Recursive } else { Method::Dynamic });
    let forest = Forest::new(setting.mesh.faces().len() as u32, Content::QUAD);
    let types = if recursive { vec![QUAD] } else { vec![QUAD, DYNAMIC] };
    let criterion = Criterion::by(Fitness::Differential);
    let parameters = Parameters { criterion, ..Parameters::new(20, 1, types) };
    let strategy = Strategy {
        insertions: Amount::Count(if recursive { 8.0 } else { 20.0 }),
        switches: Amount::Count(3.0),
        toggles: Amount::Count(1.0),
        weighting: Weighting::Exponential,
    };
    let mut evolution = Evolution::new(setting.clone(), parameters.clone(), forest, strategy, None, 1)?;
    while evolution.parent().measures.springs < springs {
        evolution.advance()?;
    }
    let few = Strategy { insertions: Amount::Count(3.0), ..strategy };
    let resumed = Some((evolution.generation(), evolution.start(), evolution.parent().suf));
    Evolution::new(setting, parameters, evolution.parent().forest.clone(), few, resumed, 1)
}

/// A dia-grid cylinder with four anchors a ring, pulled outward.
fn cylinder(method: Method) -> Setting {
    let part = Part { name: "c".to_owned(), shape: Shape::Cylinder, around: 24, along: 12 };
    let framework = Framework { grid: Grid::Dia, parts: vec![part], joins: vec![] };
    let mesh = BaseMesh::from_framework(&framework).expect("a valid cylinder");
    let corners = [[1.6, 1.6], [-1.6, 1.6], [-1.6, -1.6], [1.6, -1.6]];
    let rings = [(Side::Start, 0.0), (Side::End, 4.0)];
    let anchor = |side: Side, k: usize| mesh.border_vertex("c", side, 6 * k).expect("a vertex of the ring");
    let anchors: Vec<u32> =
        rings.iter().flat_map(|&(side, _)| (0..4).map(move |k| anchor(side, k))).collect();
    let target = |height: f64| corners.map(|[x, y]| [x, y, height]);
    let positions = rings.iter().flat_map(|&(_, height)| target(height)).collect();
    Setting::new(mesh, method, anchors, positions)
}
