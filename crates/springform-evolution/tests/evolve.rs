//! The evolutionary algorithm: same bits on any number of threads, resumed or rebuilt; who becomes parent.

mod runs;

use proptest::prelude::*;
use runs::common::{Dice, cases, dice};
use runs::{Start, cords, cylinder, starts};
use springform_evolution::ending::{Ending, Reason};
use springform_evolution::evolve::{Evolution, Generation, Parameters, Selection};
use springform_evolution::fitness::{Criterion, Fitness};
use springform_evolution::mutation::{Amount, Strategy as Rates};
use springform_evolution::selection::Weighting;
use springform_evolution::workspace::Workspace;
use springform_mechanics::stage::Stage;
use springform_topology::cell_type::{Catalogue, DYNAMIC, QUAD};
use springform_topology::edit::Edit;
use springform_topology::forest::{Content, Forest};
use springform_topology::notation::{read_top_cell, write_cell};

/// Generations of a random run.
const GENERATIONS: u32 = 3;

fn random_run(start: &Start, dice: &mut Dice, threads: usize) -> (Parameters, Rates, Evolution) {
    let parameters = runs::parameters(start.setting.method, dice);
    let rates = runs::strategy(dice);
    let evolution = begin(start, &parameters, rates, threads);
    (parameters, rates, evolution)
}

fn begin(start: &Start, parameters: &Parameters, rates: Rates, threads: usize) -> Evolution {
    Evolution::new(start.setting.clone(), parameters.clone(), start.forest.clone(), rates, None, threads)
        .expect("the start gives a net")
}

fn advance(evolution: &mut Evolution, generations: u32) -> Vec<Generation> {
    (0..generations).map(|_| evolution.advance().expect("a winner has been evaluated")).collect()
}

/// The forest as a run folder would give it back: from cell notation, stored anew.
fn read_again(forest: &Forest, catalogue: &Catalogue) -> Forest {
    let mut again = Forest::new(forest.top_level(), Content::QUAD);
    for face in (0..forest.top_level()).rev() {
        let text = write_cell(forest, forest.top(face), catalogue);
        read_top_cell(&mut again, face, &text, catalogue).expect("written cells can be read");
    }
    for (&pair, &what) in forest.overrides() {
        Edit::Override { pair, what, set: true }.apply(&mut again).expect("an override that fits");
    }
    again
}

proptest! {
    #![proptest_config(cases(1000))]

    /// One, two and four threads give the same bits.
    #[test]
    fn threads_do_not_matter(start in starts(8), dice in dice(40)) {
        let run = |threads| {
            let (_, _, mut evolution) = random_run(&start, &mut dice.clone(), threads);
            let generations = advance(&mut evolution, GENERATIONS);
            (generations, evolution.parent().forest.fingerprint())
        };
        let one = run(1);
        prop_assert_eq!(&run(2), &one);
        prop_assert_eq!(&run(4), &one);
    }

    /// A run picked up from a stored parent goes on to the same bits.
    #[test]
    fn resumed_runs_go_on_alike(start in starts(8), mut dice in dice(40), stop in 0..GENERATIONS) {
        let (parameters, rates, mut whole) = random_run(&start, &mut dice, 1);
        advance(&mut whole, stop);
        let parent = whole.parent();
        let forest = read_again(&parent.forest, &start.setting.catalogue);
        let strategy = if stop == 0 { rates } else { parent.strategy };
        let picked_up = Some((stop, whole.start(), parent.suf));
        let mut resumed = Evolution::new(start.setting.clone(), parameters, forest, strategy, picked_up, 1)
            .expect("the parent gives a net");
        prop_assert_eq!(resumed.generation(), whole.generation());
        let rest = GENERATIONS - stop;
        prop_assert_eq!(advance(&mut resumed, rest), advance(&mut whole, rest));
        prop_assert_eq!(&resumed.parent().forest, &whole.parent().forest);
        prop_assert_eq!(resumed.start(), whole.start());
    }

    /// Any individual is rebuilt from (parent, seed, generation, index), and its net from its parent and
    /// edits.
    #[test]
    fn individuals_are_rebuilt(start in starts(8), mut dice in dice(40)) {
        let (parameters, _, mut evolution) = random_run(&start, &mut dice, 1);
        for number in 1..=GENERATIONS {
            let parent = evolution.parent().clone();
            let population = advance(&mut begin_again(&evolution, &parameters), 1).remove(0).individuals;
            let rebuilt: Vec<_> =
                (0..population.len() as u32).rev().map(|index| evolution.individual(number, index)).collect();
            let generation = advance(&mut evolution, 1).remove(0);
            prop_assert_eq!(generation.number, number);
            prop_assert!(rebuilt.iter().rev().eq(&generation.individuals));
            prop_assert_eq!(&population, &generation.individuals);
            for individual in generation.individuals {
                let mut forest = parent.forest.clone();
                prop_assert_eq!(Edit::apply_all(&individual.edits, &mut forest), Ok(()));
                prop_assert_eq!(individual.fingerprint, forest.fingerprint());
                let phenotype = start.setting.evaluate(&forest).ok();
                prop_assert_eq!(individual.measures.is_some(), phenotype.is_some());
                if let (Some(measures), Some(net)) = (individual.measures, phenotype) {
                    prop_assert!(runs::alike(&measures, &net.measures), "{measures:?} {:?}", net.measures);
                }
                prop_assert!(individual.residual.is_none_or(|residual| residual <= 1e-9));
            }
        }
    }

    /// Individuals made in one memory after those of other runs are those made in fresh memory, and stages end in
    /// order.
    #[test]
    fn memory_that_is_used_again_changes_nothing(runs in prop::collection::vec((starts(8), dice(40)), 1..4)) {
        let mut workspace = Workspace::default();
        for (start, dice) in &runs {
            let (parameters, _, evolution) = random_run(start, &mut dice.clone(), 1);
            for index in 0..parameters.population {
                let mut stages = Vec::new();
                let mut observe = |stage| stages.push(stage);
                let again = evolution.individual_in(1, index, &mut workspace, &mut observe);
                prop_assert_eq!(&again, &evolution.individual(1, index));
                if again.measures.is_some() {
                    prop_assert_eq!(stages.first(), Some(&Stage::Mutate));
                    prop_assert_eq!(stages.last(), Some(&Stage::Measure));
                }
            }
        }
    }

    /// Cords that go slack: the same bits on any number of threads and when picked up, and measures as of the genotype alone.
    #[test]
    fn cords_evolve_alike(start in cords(8), mut dice in dice(40), stop in 0..GENERATIONS) {
        let (parameters, rates, mut whole) = random_run(&start, &mut dice, 1);
        let mut threaded = begin(&start, &parameters, rates, 3);
        advance(&mut whole, stop);
        advance(&mut threaded, stop);
        let parent = whole.parent().clone();
        let forest = read_again(&parent.forest, &start.setting.catalogue);
        let strategy = if stop == 0 { rates } else { parent.strategy };
        let picked_up = Some((stop, whole.start(), parent.suf));
        let mut resumed = Evolution::new(start.setting.clone(), parameters, forest, strategy, picked_up, 2)
            .expect("the parent gives a net");
        let generation = advance(&mut whole, 1).remove(0);
        prop_assert_eq!(&advance(&mut threaded, 1)[0], &generation);
        prop_assert_eq!(&advance(&mut resumed, 1)[0], &generation);
        for individual in generation.individuals {
            let mut forest = parent.forest.clone();
            prop_assert_eq!(Edit::apply_all(&individual.edits, &mut forest), Ok(()));
            let alone = start.setting.evaluate(&forest).ok();
            prop_assert_eq!(individual.measures.is_some(), alone.is_some());
            let (Some(measures), Some(alone)) = (individual.measures, alone) else { continue };
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * alone.measures.force_max;
            prop_assert!(near(measures.force_max, alone.measures.force_max));
            prop_assert!(near(measures.force_min, alone.measures.force_min));
            // Slack cords rest in more than one place, and next to slack the smallest force has few digits.
            let taut = alone.measures.force_min > 1e-4 * alone.measures.force_max;
            prop_assert!(!taut || runs::alike(&measures, &alone.measures), "{measures:?} {:?}", alone.measures);
        }
    }

    /// The winner is the first of the fittest in its band, and becomes parent; without one the parent stays.
    #[test]
    fn the_fittest_becomes_parent(start in starts(8), mut dice in dice(40)) {
        let (parameters, _, mut evolution) = random_run(&start, &mut dice, 1);
        for _ in 0..GENERATIONS {
            let before = evolution.parent().clone();
            let generation = advance(&mut evolution, 1).remove(0);
            let after = evolution.parent();
            match generation.winner {
                None => prop_assert_eq!(&after.forest, &before.forest),
                Some(winner) => {
                    let individual = &generation.individuals[winner];
                    prop_assert!(individual.score.is_defined());
                    prop_assert_eq!(after.forest.fingerprint(), individual.fingerprint);
                    let measures = individual.measures.expect("a winner is measured");
                    prop_assert!(runs::alike(&after.measures, &measures));
                    prop_assert_eq!(after.suf, individual.suf);
                    prop_assert_eq!(after.strategy, individual.strategy);
                    if parameters.criterion.niche.is_none() {
                        for (index, other) in generation.individuals.iter().enumerate() {
                            let later = index >= winner && other.score == individual.score;
                            prop_assert!(later || other.score > individual.score);
                        }
                    }
                }
            }
            let defined = generation.individuals.iter().any(|one| one.score.is_defined());
            if parameters.selection == Selection::Comma && parameters.criterion.niche.is_none() {
                prop_assert_eq!(generation.winner.is_some(), defined);
            }
        }
    }

    /// With plus selection by force differential the parent never gets worse.
    #[test]
    fn plus_selection_never_gets_worse(start in starts(8), mut dice in dice(40)) {
        let mut parameters = runs::parameters(start.setting.method, &mut dice);
        parameters.selection = Selection::Plus;
        parameters.criterion.fitness = Fitness::Differential;
        parameters.criterion.niche = None;
        parameters.criterion.min_length = None;
        (parameters.criterion.min_springs, parameters.criterion.max_springs) = (None, None);
        let mut evolution = begin(&start, &parameters, runs::strategy(&mut dice), 1);
        let mut best = evolution.parent().measures.force_differential;
        for _ in 0..GENERATIONS {
            advance(&mut evolution, 1);
            let now = evolution.parent().measures.force_differential;
            // What a mutant measures and what it measures as parent differ by rounding.
            let room = |best: f64| best * (1.0 + 1e-9 + 1e-14 * best);
            prop_assert!(
                best.is_none_or(|best| now.is_some_and(|now| now <= room(best))), "{now:?} after {best:?}"
            );
            best = now;
        }
    }

    /// Strategies stay as they are without self-adaptation.
    #[test]
    fn strategies_change_with_self_adaptation_only(start in starts(4), mut dice in dice(40)) {
        let (parameters, rates, mut evolution) = random_run(&start, &mut dice, 1);
        let individuals = advance(&mut evolution, GENERATIONS).into_iter().flat_map(|one| one.individuals);
        prop_assert!(parameters.self_adapt || individuals.into_iter().all(|one| one.strategy == rates));
    }
}

/// The run from its present parent on.
fn begin_again(evolution: &Evolution, parameters: &Parameters) -> Evolution {
    let parent = evolution.parent();
    let picked_up = Some((evolution.generation(), evolution.start(), parent.suf));
    let setting = evolution.setting().clone();
    Evolution::new(setting, parameters.clone(), parent.forest.clone(), parent.strategy, picked_up, 2)
        .expect("the parent gives a net")
}

#[test]
fn comma_selection_takes_worse_parents_on_the_way() {
    let criterion = Criterion::by(Fitness::Differential);
    let parameters = Parameters { criterion, ..Parameters::new(3, 1, vec![QUAD, DYNAMIC]) };
    let (some, few) = (Amount::Count(2.0), Amount::Count(1.0));
    let rates = Rates { insertions: some, switches: few, toggles: few, weighting: Weighting::Exponential };
    let mut evolution = begin(&cylinder(), &parameters, rates, 2);
    let ending = Ending { generations: Some(30), ..Ending::default() };
    let mut differentials = vec![evolution.start().differential];
    while evolution.reached(&ending).is_none() {
        advance(&mut evolution, 1);
        differentials.push(evolution.parent().measures.force_differential);
    }
    assert_eq!((evolution.reached(&ending), evolution.generation()), (Some(Reason::Generations), 30));
    assert!(differentials.windows(2).any(|pair| pair[1] > pair[0]), "{differentials:?}");
    assert!(evolution.parent().measures.springs > 2 * 8 * 4 + 4 * 8);
}
