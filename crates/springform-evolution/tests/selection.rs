//! Weights, and draws against exact probabilities.

mod runs;

use proptest::collection::vec;
use proptest::prelude::*;
use runs::common::cases;
use springform_evolution::cell_weights::CellWeights;
use springform_evolution::draws::Draws;
use springform_evolution::mutation::{Amount, Candidates, Palette, Strategy, mutate};
use springform_evolution::selection::{
    WEIGHTINGS, Weighting, WeightingParameters, draw_without_replacement, weight,
};
use springform_topology::address::Place;
use springform_topology::cell_type::{Catalogue, QUAD};
use springform_topology::edit::Edit;
use springform_topology::forest::{Content, Forest};

const PLAIN: WeightingParameters = WeightingParameters { base: 4.0, exponent: 1.0 };

/// Pearson's statistic of counts against probabilities.
fn chi_square(counts: &[u32], probabilities: &[f64]) -> f64 {
    let total: f64 = counts.iter().map(|&count| f64::from(count)).sum();
    let term = |(&count, &probability): (&u32, &f64)| {
        let expected = probability * total;
        (f64::from(count) - expected).powi(2) / expected
    };
    counts.iter().zip(probabilities).map(term).sum()
}

/// Subdivides one cell after the other, drawn by a weighting; counts them by top-level cell.
fn subdivisions(weighting: Weighting, seed: u64, steps: u64) -> Vec<u32> {
    let mut forest = Forest::new(8, Content::QUAD);
    let catalogue = Catalogue::default();
    let palette = Palette { types: &[QUAD], catalogue: &catalogue, weights: &PLAIN };
    let nothing = Amount::Count(0.0);
    let strategy =
        Strategy { insertions: Amount::Count(1.0), switches: nothing, toggles: nothing, weighting };
    let mut counts = vec![0; 8];
    for step in 0..steps {
        let candidates = Candidates::new(&forest, &[]);
        let edits = mutate(&candidates, &strategy, &palette, &mut Draws::new(seed, step, 0));
        let &[Edit::Subdivide { cell, .. }] = edits.as_slice() else { panic!("one insertion: {edits:?}") };
        counts[cell.face as usize] += 1;
        Edit::apply_all(&edits, &mut forest).expect("an edit that fits");
    }
    counts
}

proptest! {
    #![proptest_config(cases(2000))]

    /// The formulas of the paper, types 0 to 3, and the inner force.
    #[test]
    fn weights_follow_their_formulas(level in 0u8..=20, above in 0u8..=20, force in 0.0..1e6f64) {
        let deepest = level.max(above);
        let of = |weighting| weight(weighting, &PLAIN, level, deepest, force);
        prop_assert_eq!(of(Weighting::Unweighted), 1.0);
        prop_assert_eq!(of(Weighting::Linear), f64::from(deepest) + 1.0 - f64::from(level));
        prop_assert_eq!(of(Weighting::Exponential), 1.0 / (1u64 << (2 * level)) as f64);
        prop_assert_eq!(of(Weighting::Deep), f64::from(level) + 1.0);
        prop_assert_eq!(of(Weighting::Stress), force);
        let squared = WeightingParameters { base: 2.0, exponent: 2.0 };
        let of = |weighting| weight(weighting, &squared, level, deepest, force);
        prop_assert_eq!(of(Weighting::Unweighted), 1.0);
        prop_assert_eq!(of(Weighting::Exponential), 1.0 / (1u64 << level) as f64);
        prop_assert!((of(Weighting::Stress) - force * force).abs() <= 1e-9 * force * force);
    }

    /// No item twice, none of weight zero, as many as asked for or all there are.
    #[test]
    fn draws_are_different_and_have_weight(
        weights in vec(prop_oneof![Just(0.0), 1e-12..1e12f64, 0.5..2.0f64], 0..60),
        count in 0usize..70,
        seed: u64,
    ) {
        let drawn = draw_without_replacement(&weights, count, &mut Draws::new(seed, 1, 2));
        let mut once = drawn.clone();
        once.sort_unstable();
        once.dedup();
        prop_assert_eq!(once.len(), drawn.len());
        prop_assert!(drawn.iter().all(|&item| weights[item] > 0.0));
        let possible = weights.iter().filter(|&&weight| weight > 0.0).count();
        prop_assert_eq!(drawn.len(), count.min(possible));
    }

    /// Numbers below a bound are below it, for every bound.
    #[test]
    fn numbers_are_below_their_bound(bound: u32, seed: u64) {
        let mut draws = Draws::new(seed, 0, 0);
        let number = draws.below(bound);
        prop_assert!(number < bound || bound == 0 && number == 0);
        prop_assert!((0.0..1.0).contains(&draws.unit()));
    }

    /// Different individuals draw differently, the same one alike.
    #[test]
    fn draws_belong_to_their_individual(seed: u64, generation: u64, individual: u64) {
        let first = |draws: &mut Draws| (draws.below(u32::MAX), draws.unit());
        let of = |seed, generation, individual| first(&mut Draws::new(seed, generation, individual));
        let drawn = of(seed, generation, individual);
        prop_assert_eq!(drawn, of(seed, generation, individual));
        prop_assert!(drawn != of(seed ^ 1, generation, individual));
        prop_assert!(drawn != of(seed, generation ^ 1, individual));
        prop_assert!(drawn != of(seed, generation, individual ^ 1));
    }

    /// A percentage of n cells is rounded up, exactly.
    #[test]
    fn percentages_are_rounded_up(percent in 0u32..=100, cells in 0usize..100_000) {
        let expected = (percent as usize * cells).div_ceil(100);
        prop_assert_eq!(Amount::Share(f64::from(percent) / 100.0).of(cells), expected);
        let tenths = (percent as usize * cells).div_ceil(1000);
        prop_assert_eq!(Amount::Share(f64::from(percent) / 1000.0).of(cells), tenths);
        prop_assert_eq!(Amount::Count(f64::from(percent)).of(cells), percent as usize);
    }

    /// Whatever is subdivided, the exponential weights of a top-level cell's leaves add up to one.
    #[test]
    fn exponential_weights_add_up_to_one(edits in runs::common::edit_dice(60)) {
        let mut forest = Forest::new(3, Content::QUAD);
        for mut dice in edits {
            let (_, cell) = dice.pick(&runs::common::leaves(&forest));
            if cell.level < 15 {
                let edit = Edit::Subdivide { cell, children: [Content::QUAD; 4] };
                edit.apply(&mut forest).expect("an undivided cell");
            }
        }
        for face in 0..3 {
            let leaves = runs::common::leaves(&forest).into_iter().filter(|(_, place)| place.face == face);
            let total: f64 =
                leaves.map(|(_, place)| weight(Weighting::Exponential, &PLAIN, place.level, 15, 0.0)).sum();
            prop_assert_eq!(total, 1.0);
        }
    }
}

#[test]
fn draws_without_replacement_have_their_probabilities() {
    let weights = [1.0, 2.0, 0.0, 3.0, 6.0];
    let total: f64 = weights.iter().sum();
    let (mut pairs, mut probabilities) = (Vec::new(), Vec::new());
    for first in 0..5 {
        for second in
            (0..5).filter(|&second| second != first && weights[first] > 0.0 && weights[second] > 0.0)
        {
            pairs.push(vec![first, second]);
            probabilities.push(weights[first] / total * weights[second] / (total - weights[first]));
        }
    }
    assert!((probabilities.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    let mut counts = vec![0; pairs.len()];
    for individual in 0..200_000 {
        let drawn = draw_without_replacement(&weights, 2, &mut Draws::new(7, 1, individual));
        counts[pairs.iter().position(|pair| *pair == drawn).expect("a pair of items with weight")] += 1;
    }
    // 12 pairs, 11 degrees of freedom: above 31.3 in one of a thousand.
    assert!(chi_square(&counts, &probabilities) < 31.3, "{counts:?}");
}

#[test]
fn whole_numbers_are_equally_likely() {
    let mut counts = vec![0; 7];
    let mut draws = Draws::new(3, 4, 5);
    (0..140_000).for_each(|_| counts[draws.below(7) as usize] += 1);
    // 6 degrees of freedom.
    assert!(chi_square(&counts, &[1.0 / 7.0; 7]) < 22.5, "{counts:?}");
}

#[test]
fn exponential_weighting_subdivides_top_level_cells_alike() {
    let mut counts = vec![0; 8];
    for seed in 0..20 {
        let one = subdivisions(Weighting::Exponential, seed, 200);
        counts.iter_mut().zip(one).for_each(|(count, more)| *count += more);
    }
    // 7 degrees of freedom.
    assert!(chi_square(&counts, &[1.0 / 8.0; 8]) < 24.3, "{counts:?}");
}

#[test]
fn favoured_cells_are_drawn_in_proportion() {
    let forest = Forest::new(4, Content::QUAD);
    let cell = |face| Place::top(face);
    let weights = CellWeights::new([(cell(1), 3.0), (cell(2), 0.0), (cell(3), 0.5)]);
    let mut candidates = Candidates::new(&forest, &[]);
    candidates.favour(|place| weights.of(place));
    let (catalogue, nothing) = (Catalogue::default(), Amount::Count(0.0));
    let palette = Palette { types: &[QUAD], catalogue: &catalogue, weights: &PLAIN };
    let insertions = Amount::Share(0.3);
    let strategy =
        Strategy { insertions, switches: nothing, toggles: nothing, weighting: Weighting::Unweighted };
    let mut counts = [0; 4];
    for individual in 0..45_000 {
        let edits = mutate(&candidates, &strategy, &palette, &mut Draws::new(5, 1, individual));
        let &[Edit::Subdivide { cell, .. }] = edits.as_slice() else {
            panic!("a third of three cells: {edits:?}")
        };
        counts[cell.face as usize] += 1;
    }
    assert_eq!(counts[2], 0);
    // 2 degrees of freedom: above 13.8 in one of a thousand.
    let drawn = [counts[0], counts[1], counts[3]];
    assert!(chi_square(&drawn, &[1.0 / 4.5, 3.0 / 4.5, 0.5 / 4.5]) < 13.8, "{counts:?}");
}

#[test]
fn what_grew_in_favoured_cells_is_turned_off_more_rarely_and_on_more_often() {
    for on in [true, false] {
        let mut forest = Forest::new(4, Content::QUAD);
        for face in 0..4 {
            let cell = Place::top(face);
            Edit::Subdivide { cell, children: [Content::QUAD; 4] }.apply(&mut forest).expect("a leaf");
            if !on {
                Edit::Toggle { cell, on }.apply(&mut forest).expect("it has children");
            }
        }
        let weights = CellWeights::new([(Place::top(1), 4.0)]);
        let mut candidates = Candidates::new(&forest, &[]);
        candidates.favour(|place| weights.of(place));
        let catalogue = Catalogue::default();
        let palette = Palette { types: &[QUAD], catalogue: &catalogue, weights: &PLAIN };
        let nothing = Amount::Count(0.0);
        let strategy = Strategy {
            insertions: nothing,
            switches: nothing,
            toggles: Amount::Count(1.0),
            weighting: Weighting::Unweighted,
        };
        let mut counts = [0; 4];
        for individual in 0..26_000 {
            let edits = mutate(&candidates, &strategy, &palette, &mut Draws::new(7, 1, individual));
            let &[Edit::Toggle { cell, .. }] = edits.as_slice() else { panic!("one toggle: {edits:?}") };
            counts[cell.face as usize] += 1;
        }
        let weight = if on { 0.25 } else { 4.0 };
        let shares = [1.0, weight, 1.0, 1.0].map(|one| one / (3.0 + weight));
        // 3 degrees of freedom: above 16.3 in one of a thousand.
        assert!(chi_square(&counts, &shares) < 16.3, "{counts:?}");
    }
}

#[test]
fn factors_go_on_to_descendants() {
    let cell = |address: &str| Place::parse(address).expect("an address");
    let weights = CellWeights::new([(cell("4"), 2.0), (cell("4.1"), 5.0), (cell("4.2.3"), 0.0)]);
    let factors = ["4.0", "4.0.3", "4.1", "4.1.2.2", "4.2.1", "7", "4", "4.2", "4.2.3", "4.2.3.0"];
    let expected = [2.0, 2.0, 5.0, 5.0, 2.0, 1.0, 0.0, 0.0, 0.0, 0.0];
    assert_eq!(factors.map(|address| weights.of(cell(address))), expected);
}

#[test]
fn without_weights_the_subdivided_are_subdivided_more() {
    let spread = |weighting| -> f64 {
        (0..20).map(|seed| chi_square(&subdivisions(weighting, seed, 200), &[1.0 / 8.0; 8])).sum::<f64>()
            / 20.0
    };
    let (unweighted, exponential) = (spread(Weighting::Unweighted), spread(Weighting::Exponential));
    // Independent draws spread by the degrees of freedom, 7.
    assert!((3.0..14.0).contains(&exponential), "{exponential}");
    assert!(unweighted > 5.0 * exponential, "{unweighted} against {exponential}");
}

#[test]
fn weightings_are_found_by_name() {
    for (weighting, name) in WEIGHTINGS {
        assert_eq!((Weighting::parse(name), weighting.name()), (Some(weighting), name));
    }
    assert_eq!(Weighting::parse("Linear"), None);
}
