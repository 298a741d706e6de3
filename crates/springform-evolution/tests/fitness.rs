//! Fitness, niche bands and ending conditions, as tables of the design's rules.

mod runs;

use proptest::collection::vec;
use proptest::prelude::*;
use runs::common::cases;
use runs::standing;
use springform_evolution::ending::{Ending, Reason};
use springform_evolution::fitness::{Criterion, Fitness, Score, Standing, SufReference};

const SUF: Criterion = Criterion::by(Fitness::Suf);

/// Springs and force differential of the start and of the parent.
const START: Standing = Standing { springs: 100, differential: Some(10.0) };
const PARENT: Standing = Standing { springs: 140, differential: Some(14.0) };

/// Score of a net with so many springs and this force differential.
fn score(criterion: &Criterion, springs: u32, differential: Option<f64>) -> Score {
    let measures = standing(springs, differential, 0.5);
    criterion.score(&measures, START, PARENT)
}

/// What the rules of the design make of springs and differential against the start: class, then value.
fn by_the_rules(springs: u32, differential: Option<f64>) -> (u8, f64) {
    match differential {
        Some(now) if springs > 100 && now <= 10.0 => (0, now),
        Some(now) if springs > 100 => (1, (now - 10.0) / f64::from(springs - 100)),
        _ => (2, 0.0),
    }
}

proptest! {
    #![proptest_config(cases(3000))]

    /// Any two nets rank by the rules.
    #[test]
    fn utilization_ranks_by_the_rules(
        first in (80u32..130, prop::option::weighted(0.9, 5.0..20.0f64)),
        second in (80u32..130, prop::option::weighted(0.9, 5.0..20.0f64)),
    ) {
        let (a, b) = (score(&SUF, first.0, first.1), score(&SUF, second.0, second.1));
        let (expected_a, expected_b) = (by_the_rules(first.0, first.1), by_the_rules(second.0, second.1));
        prop_assert_eq!(a.is_defined(), expected_a.0 < 2);
        prop_assert_eq!(a.partial_cmp(&b), expected_a.partial_cmp(&expected_b));
    }

    /// The fittest in the band around the median wins, the first among equals.
    #[test]
    fn the_fittest_in_the_band_wins(
        nets in vec((95u32..125, prop::option::weighted(0.8, (1u32..12).prop_map(f64::from))), 0..12),
        niche in prop::option::of(0u32..10), differential: bool,
    ) {
        let fitness = if differential { Fitness::Differential } else { Fitness::Suf };
        let criterion = Criterion { fitness, niche, ..SUF };
        let generation: Vec<(Score, u32)> =
            nets.iter().map(|&(springs, force)| (score(&criterion, springs, force), springs)).collect();
        let mut defined: Vec<u32> =
            generation.iter().filter(|one| one.0.is_defined()).map(|one| one.1).collect();
        defined.sort_unstable();
        let median = defined.get(defined.len() / 2).copied().unwrap_or(0);
        let contends = |one: &(Score, u32)| {
            one.0.is_defined() && niche.is_none_or(|width| one.1.abs_diff(median) <= width)
        };
        match criterion.choose(&generation) {
            None => prop_assert!(!generation.iter().any(contends)),
            Some(winner) => {
                prop_assert!(contends(&generation[winner]));
                for (index, other) in generation.iter().enumerate().filter(|(_, one)| contends(one)) {
                    prop_assert!(generation[winner].0 <= other.0);
                    prop_assert!(index >= winner || other.0 > generation[winner].0);
                }
            }
        }
    }
}

#[test]
fn utilization_against_three_references() {
    let suf = |reference, springs, differential| {
        let criterion = Criterion { reference, ..SUF };
        criterion.suf(&standing(springs, differential, 0.5), START, PARENT)
    };
    for (reference, springs, differential, expected) in [
        (SufReference::Start, 120, Some(15.0), Some(0.25)),
        (SufReference::Start, 120, Some(5.0), Some(-0.25)),
        (SufReference::Start, 100, Some(15.0), None),
        (SufReference::Start, 90, Some(5.0), None),
        (SufReference::Start, 120, None, None),
        (SufReference::Parent, 120, Some(15.0), None),
        (SufReference::Parent, 142, Some(15.0), Some(0.5)),
        (SufReference::Zero, 50, Some(15.0), Some(0.3)),
        (SufReference::Zero, 50, None, None),
    ] {
        assert_eq!(
            suf(reference, springs, differential),
            expected,
            "{reference:?} {springs} {differential:?}"
        );
    }
}

#[test]
fn the_order_of_a_generation() {
    // From fittest to least fit: gains without loss by differential, then gains by utilization, then
    // undefined.
    let nets = [
        (160, Some(8.0)),
        (101, Some(9.0)),
        (130, Some(10.0)),
        (150, Some(11.0)),
        (110, Some(11.0)),
        (105, Some(11.0)),
    ];
    for pair in nets.windows(2) {
        let (fitter, other) = (score(&SUF, pair[0].0, pair[0].1), score(&SUF, pair[1].0, pair[1].1));
        assert!(fitter < other, "{pair:?}");
    }
    for undefined in [(100, Some(1.0)), (99, Some(1.0)), (150, None)] {
        let score = score(&SUF, undefined.0, undefined.1);
        assert!(!score.is_defined(), "{undefined:?}");
        assert!(score > self::score(&SUF, 105, Some(1e9)));
    }
}

#[test]
fn differential_fitness_needs_no_springs_gained() {
    let criterion = Criterion { fitness: Fitness::Differential, ..SUF };
    assert!(score(&criterion, 50, Some(4.0)) < score(&criterion, 500, Some(5.0)));
    assert!(!score(&criterion, 50, None).is_defined());
}

#[test]
fn springs_that_are_too_short_make_a_net_undefined() {
    let criterion = Criterion { min_length: Some(0.2), ..SUF };
    let defined = |shortest| {
        let measures = standing(120, Some(9.0), shortest);
        criterion.score(&measures, START, PARENT).is_defined()
    };
    assert_eq!([0.19, 0.2, 0.21].map(defined), [false, true, true]);
}

#[test]
fn too_few_or_too_many_springs_make_a_net_undefined() {
    let criterion = Criterion { min_springs: Some(110), max_springs: Some(120), ..SUF };
    let defined = |springs| score(&criterion, springs, Some(9.0)).is_defined();
    assert_eq!([109, 110, 120, 121].map(defined), [false, true, true, false]);
}

#[test]
fn a_parent_against_itself_yields_to_lower_differentials_only() {
    let criterion = Criterion { reference: SufReference::Parent, ..SUF };
    let incumbent = criterion.incumbent(&standing(140, Some(14.0), 0.5), START);
    assert!(score(&criterion, 150, Some(13.9)) < incumbent);
    assert!(score(&criterion, 150, Some(14.1)) > incumbent);
    assert!(incumbent.is_defined());
}

#[test]
fn without_a_reference_the_differential_counts() {
    let start = Standing { differential: None, ..START };
    let against = |springs, differential| SUF.score(&standing(springs, differential, 0.5), start, PARENT);
    assert!(against(90, Some(4.0)) < against(500, Some(5.0)));
    assert!(!against(500, None).is_defined());
}

#[test]
fn a_generation_without_defined_nets_has_no_winner() {
    assert_eq!(SUF.choose(&[(Score::UNDEFINED, 4), (Score::UNDEFINED, 5)]), None);
    assert_eq!(SUF.choose(&[]), None);
}

#[test]
fn ending_conditions() {
    let none = Ending::default();
    let after = |ending: Ending, generation, springs, differential, suf| {
        ending.reached(generation, START, Standing { springs, differential }, suf)
    };
    let generations = Ending { generations: Some(3), ..none };
    let springs = Ending { springs: Some(200), ..none };
    let lower = Ending { differential: Some(5.0), ..none };
    let higher = Ending { differential: Some(50.0), ..none };
    let suf = Ending { suf: Some(0.1), ..none };
    let all = Ending { generations: Some(3), springs: Some(200), differential: Some(5.0), suf: Some(0.1) };
    for (ending, generation, spring_count, differential, utilization, expected) in [
        (none, 1_000_000, 1_000_000, Some(1.0), Some(0.0), None),
        (generations, 2, 100, Some(10.0), None, None),
        (generations, 3, 100, Some(10.0), None, Some(Reason::Generations)),
        (generations, 4, 100, None, None, Some(Reason::Generations)),
        (springs, 9, 199, Some(10.0), None, None),
        (springs, 9, 200, Some(10.0), None, Some(Reason::Springs)),
        // The start's differential is 10: 5 is reached from above, 50 from below.
        (lower, 1, 150, Some(5.1), None, None),
        (lower, 1, 150, Some(5.0), None, Some(Reason::Differential)),
        (higher, 1, 150, Some(49.0), None, None),
        (higher, 1, 150, Some(51.0), None, Some(Reason::Differential)),
        (lower, 1, 150, None, None, None),
        (suf, 1, 150, Some(10.0), None, None),
        (suf, 1, 150, Some(10.0), Some(0.2), None),
        (suf, 1, 150, Some(10.0), Some(0.1), Some(Reason::Suf)),
        (suf, 1, 150, Some(10.0), Some(-1.0), Some(Reason::Suf)),
        (all, 3, 200, Some(1.0), Some(0.0), Some(Reason::Springs)),
        (all, 3, 150, Some(1.0), Some(0.0), Some(Reason::Differential)),
        (all, 3, 150, Some(9.0), Some(0.0), Some(Reason::Suf)),
        (all, 3, 150, Some(9.0), Some(0.5), Some(Reason::Generations)),
    ] {
        let found = after(ending, generation, spring_count, differential, utilization);
        assert_eq!(found, expected, "{ending:?} after {generation}");
    }
}
