//! Mutation: counts, immunity of newborns, types drawn, and self-adaptation.

mod runs;

use proptest::prelude::*;
use runs::common::{cases, dice, grown_designs, leaves, stored_cells};
use springform_evolution::draws::Draws;
use springform_evolution::mutation::{Amount, Candidates, Palette, Strategy as Rates, mutate};
use springform_evolution::selection::{Weighting, WeightingParameters};
use springform_topology::MAX_LEVEL;
use springform_topology::address::Place;
use springform_topology::cell_type::CellTypeId;
use springform_topology::edit::Edit;
use springform_topology::forest::Content;
use std::collections::BTreeSet;

/// Inner forces that differ, some of them zero.
fn forces(count: usize) -> Vec<f64> {
    (0..count).map(|cell| f64::from((cell * 7 % 5) as u32)).collect()
}

fn amount_or_all(amount: Amount, count: usize) -> usize {
    amount.of(count).min(count)
}

/// Cells of a step's edits, in order.
fn cells(edits: &[Edit], of: impl Fn(&Edit) -> Option<Place>) -> Vec<Place> {
    edits.iter().filter_map(of).collect()
}

proptest! {
    #![proptest_config(cases(2000))]

    /// Each step draws as many cells as asked for, no cell twice, in the order of the steps; newborns and
    /// their ancestors are left alone by the later steps; what is drawn comes from the palette; and all of it
    /// fits.
    #[test]
    fn mutants_follow_the_rules(mut design in grown_designs(30), mut dice in dice(40), seed: u64) {
        let types = runs::palette(design.method, &mut dice);
        let rates = runs::strategy(&mut dice);
        let weights = WeightingParameters::default();
        let palette = Palette { types: &types, catalogue: &design.catalogue, weights: &weights };
        let before = leaves(&design.forest);
        let candidates = Candidates::new(&design.forest, &forces(before.len()));
        let edits = mutate(&candidates, &rates, &palette, &mut Draws::new(seed, 1, 1));

        let divided = cells(&edits, |edit| match edit {
            Edit::Subdivide { cell, .. } => Some(*cell),
            _ => None,
        });
        let retyped = cells(&edits, |edit| match edit {
            Edit::Retype { cell, .. } => Some(*cell),
            _ => None,
        });
        let switched = cells(&edits, |edit| match edit {
            Edit::Toggle { cell, .. } => Some(*cell),
            _ => None,
        });
        prop_assert_eq!(divided.len() + retyped.len() + switched.len(), edits.len());
        for step in [&divided, &retyped, &switched] {
            prop_assert_eq!(step.iter().collect::<BTreeSet<_>>().len(), step.len());
        }
        let stored = |&(cell, _): &(_, Place)| design.forest.children(cell).is_some();
        let divisible = before.iter().filter(|leaf| !stored(leaf) && leaf.1.level < MAX_LEVEL).count();
        let owners = stored_cells(&design.forest).iter().filter(|&cell| stored(cell)).count();
        if rates.weighting != Weighting::Stress {
            prop_assert_eq!(divided.len(), amount_or_all(rates.insertions, divisible));
        }
        prop_assert!(retyped.len() <= amount_or_all(rates.switches, before.len()));
        prop_assert!(switched.len() <= amount_or_all(rates.toggles, owners));

        for newborn in &divided {
            prop_assert!(before.iter().any(|(_, place)| place == newborn));
            prop_assert!(!retyped.iter().chain(&switched).any(|cell| cell.contains(*newborn)));
        }
        let drawn: Vec<Content> = edits.iter().flat_map(|edit| match *edit {
            Edit::Subdivide { children, .. } => children.to_vec(),
            Edit::Retype { to, .. } => vec![to],
            _ => vec![],
        }).collect();
        for content in drawn {
            prop_assert!(types.contains(&content.kind));
            prop_assert!(content.turn < design.catalogue.get(content.kind).distinct_turns());
        }
        prop_assert_eq!(Edit::apply_all(&edits, &mut design.forest), Ok(()));
        for newborn in &divided {
            let expressed =
                leaves(&design.forest).into_iter().filter(|(_, place)| newborn.contains(*place)).count();
            prop_assert_eq!(expressed, 4, "newborns express themselves");
        }
    }

    /// Where nothing is immune, as many cells switch as asked for.
    #[test]
    fn toggles_are_counted(design in grown_designs(30), share in 0u32..=100, seed: u64) {
        let nothing = Amount::Count(0.0);
        let rates = Rates {
            insertions: nothing, switches: nothing, toggles: Amount::Share(f64::from(share) / 100.0),
            weighting: Weighting::Linear,
        };
        let weights = WeightingParameters::default();
        let palette = Palette { types: &[CellTypeId(1)], catalogue: &design.catalogue, weights: &weights };
        let candidates = Candidates::new(&design.forest, &[]);
        let edits = mutate(&candidates, &rates, &palette, &mut Draws::new(seed, 1, 1));
        let hidden = |place: Place| (0..place.level).any(|level| {
            design.forest.find(place.ancestor(level)).is_some_and(|above| !design.forest.is_on(above))
        });
        let owners = stored_cells(&design.forest)
            .into_iter()
            .filter(|&(cell, place)| design.forest.children(cell).is_some() && !hidden(place))
            .count();
        prop_assert_eq!(edits.len(), (share as usize * owners).div_ceil(100));
        let others = edits.iter().filter(|edit| !matches!(edit, Edit::Toggle { .. })).count();
        prop_assert_eq!(others, 0);
    }

    /// The same draws give the same mutant.
    #[test]
    fn mutants_depend_on_their_draws_only(design in grown_designs(20), mut dice in dice(40), seed: u64) {
        let types = runs::palette(design.method, &mut dice);
        let rates = runs::strategy(&mut dice);
        let weights = WeightingParameters::default();
        let palette = Palette { types: &types, catalogue: &design.catalogue, weights: &weights };
        let candidates = Candidates::new(&design.forest, &forces(leaves(&design.forest).len()));
        let mutant = || mutate(&candidates, &rates, &palette, &mut Draws::new(seed, 3, 4));
        prop_assert_eq!(mutant(), mutant());
    }

    /// Self-adapted rates stay within reason and insertions at one cell or more.
    #[test]
    fn strategies_stay_within_reason(mut dice in dice(40), seed: u64) {
        let mut rates = runs::strategy(&mut dice);
        let mut draws = Draws::new(seed, 0, 0);
        for _ in 0..50 {
            rates = rates.mutated(&mut draws);
            for amount in [rates.insertions, rates.switches, rates.toggles] {
                match amount {
                    Amount::Count(count) => prop_assert!(count >= 0.0 && count.is_finite()),
                    Amount::Share(share) => prop_assert!((0.0..=1.0).contains(&share)),
                }
            }
            if let Amount::Count(count) = rates.insertions {
                prop_assert!(count >= 1.0);
            }
        }
    }
}
