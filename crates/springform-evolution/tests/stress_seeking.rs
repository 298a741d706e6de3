//! Direct stress-seeking: the hottest cell is refined, every step adds springs, nothing else changes.

mod runs;

use proptest::prelude::*;
use runs::common::{Dice, cases, stored_cells};
use runs::starts;
use springform_evolution::stress_seeking::StressSeeking;
use springform_topology::address::Place;
use springform_topology::cell_type::CellTypeId;
use springform_topology::edit::Edit;
use springform_topology::filters::Method;
use springform_topology::forest::{Content, Forest};
use springform_topology::symmetry::{Orbits, symmetries};
use std::collections::BTreeSet;

/// Steps of one random run.
const STEPS: u32 = 5;

fn child_type(method: Method, number: u32) -> CellTypeId {
    let types: &[u8] = match method {
        Method::Recursive => &[1],
        Method::Extensible => &[1, 2, 3, 4, 5],
        Method::Dynamic => &[1, 2, 3, 4, 5, 6],
    };
    CellTypeId(Dice::new(vec![number]).pick(types))
}

proptest! {
    #![proptest_config(cases(1000))]

    /// Each step refines the first of the hottest cells into children of one type and closes the forest.
    #[test]
    fn each_step_refines_the_hottest_cell(start in starts(8), number: u32) {
        let kind = child_type(start.setting.method, number);
        let mut seeking = StressSeeking::new(&start.setting, start.forest).expect("the start gives a net");
        for _ in 0..STEPS {
            let inner = seeking.phenotype().inner_forces();
            let highest = inner.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let hottest = inner.iter().position(|&force| force == highest).expect("a cell");
            let cell = seeking.phenotype().expression.cells[hottest];
            let stored = seeking.forest().children(cell.index).is_some();
            let mut before = seeking.forest().clone();
            let Ok(edits) = seeking.advance(&start.setting, kind, None) else {
                prop_assert_eq!(seeking.forest(), &before, "a refused step changes nothing");
                break;
            };
            let expected = if stored {
                Edit::Toggle { cell: cell.place, on: true }
            } else {
                Edit::Subdivide { cell: cell.place, children: [Content { kind, turn: 0 }; 4] }
            };
            prop_assert_eq!(edits.first(), Some(&expected));
            prop_assert!(edits.len() == 1 || start.setting.method == Method::Recursive);
            prop_assert_eq!(Edit::apply_all(&edits, &mut before), Ok(()));
            prop_assert_eq!(&before, seeking.forest());
            prop_assert_eq!(Ok(seeking.phenotype().clone()), start.setting.evaluate(seeking.forest()));
        }
    }

    /// On plain quads, every step adds cells and springs; under the recursive method the support springs of a
    /// cell with four hanging nodes are those that its children bring, so that a step may add none.
    #[test]
    fn each_step_adds_springs_to_plain_quads(start in starts(0), number: u32) {
        let plain =
            stored_cells(&start.forest).iter().all(|&(cell, _)| start.forest.content(cell) == Content::QUAD);
        prop_assume!(plain);
        let kind = child_type(start.setting.method, number);
        let mut seeking = StressSeeking::new(&start.setting, start.forest).expect("the start gives a net");
        for _ in 0..STEPS {
            let before = seeking.phenotype().measures;
            seeking.advance(&start.setting, kind, None).expect("a refined net is a net");
            let after = seeking.phenotype().measures;
            let least = before.springs + u32::from(start.setting.method != Method::Recursive);
            prop_assert!(after.springs >= least, "{} after {}", after.springs, before.springs);
            prop_assert!(after.cells >= before.cells + 3);
        }
    }

    /// With orbits a step refines the whole orbit of a hottest cell, and the forest keeps the symmetries.
    #[test]
    fn with_orbits_a_step_refines_a_whole_orbit(start in starts(0), number: u32) {
        let setting = &start.setting;
        let Ok(group) = symmetries(&setting.mesh, &setting.anchors) else { return Ok(()) };
        let kind = child_type(setting.method, number);
        let plain = Forest::new(start.forest.top_level(), Content::QUAD);
        let types = BTreeSet::from([kind]);
        let orbits = Orbits::new(&group, plain.top_level(), &setting.catalogue, &types).expect("types have images");
        let Ok(mut seeking) = StressSeeking::new(setting, plain) else { return Ok(()) };
        for _ in 0..STEPS {
            let inner = seeking.phenotype().inner_forces();
            let highest = inner.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let hottest = inner.iter().position(|&force| force == highest).expect("a cell");
            let cell = seeking.phenotype().expression.cells[hottest].place;
            let mut before = seeking.forest().clone();
            let Ok(edits) = seeking.advance(setting, kind, Some(&orbits)) else { break };
            let images: BTreeSet<Place> = group.iter().map(|one| one.place(cell)).collect();
            let divided: BTreeSet<Place> = edits.iter().filter(|edit| matches!(edit, Edit::Subdivide { .. }))
                .filter_map(Edit::cell).collect();
            prop_assert!(images.is_subset(&divided));
            prop_assert!(images == divided || setting.method == Method::Recursive);
            prop_assert_eq!(Edit::apply_all(&edits, &mut before), Ok(()));
            prop_assert_eq!(&before, seeking.forest());
            prop_assert_eq!(orbits.check(&setting.mesh, seeking.forest(), &group), Ok(()));
        }
    }
}
