//! Memory: once a workspace has seen individuals of the size, making and measuring them asks for none, the solver aside.

mod runs;

use runs::{Start, cylinder};
use springform_evolution::evolve::{Evolution, Parameters};
use springform_evolution::fitness::{Criterion, Fitness};
use springform_evolution::mutation::{Amount, Strategy};
use springform_evolution::selection::Weighting;
use springform_evolution::workspace::Workspace;
use springform_mechanics::stage::{STAGES, Stage};
use springform_topology::cell_type::{DYNAMIC, NULL, QUAD};
use springform_topology::filters::Method;
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

const POPULATION: u32 = 60;

/// Times that memory was asked for so far. Nothing else runs in this process meanwhile: it holds one test.
fn asked() -> usize {
    let stats = ALLOCATOR.stats();
    stats.allocations + stats.reallocations
}

/// A run whose mutants are all that mutation can make them, a few generations on.
fn evolution(method: Method) -> Evolution {
    let Start { mut setting, forest } = cylinder();
    setting.method = method;
    let types = if method == Method::Recursive { vec![QUAD] } else { vec![NULL, QUAD, DYNAMIC] };
    let criterion = Criterion::by(Fitness::Differential);
    let parameters = Parameters { self_adapt: true, criterion, ..Parameters::new(POPULATION, 1, types) };
    let strategy = Strategy {
        insertions: Amount::Count(4.0),
        switches: Amount::Share(0.05),
        toggles: Amount::Count(2.0),
        weighting: Weighting::Exponential,
    };
    let mut evolution =
        Evolution::new(setting, parameters, forest, strategy, None, 1).expect("the cylinder gives a net");
    (0..5).for_each(|_| drop(evolution.advance().expect("a winner has been evaluated")));
    evolution
}

#[test]
fn stages_ask_for_no_memory() {
    for method in [Method::Dynamic, Method::Recursive] {
        let evolution = evolution(method);
        let mut workspace = Workspace::default();
        let mut round = |asked_in: &mut [usize; STAGES.len()]| {
            for index in 0..POPULATION {
                let mut last = asked();
                evolution.individual_in(6, index, &mut workspace, &mut |stage| {
                    asked_in[stage as usize] += asked() - last;
                    last = asked();
                });
            }
        };
        round(&mut [0; STAGES.len()]);
        let mut asked_in = [0; STAGES.len()];
        round(&mut asked_in);
        for stage in [Stage::Mutate, Stage::Filter, Stage::Nodes, Stage::Measure] {
            assert_eq!(asked_in[stage as usize], 0, "{stage:?} under {method:?}");
        }
    }
}
