//! Direct stress-seeking: the hottest cell is refined, every step adds springs, nothing else changes.

mod runs;

use proptest::prelude::*;
use runs::common::{Dice, cases, stored_cells};
use runs::starts;
use springform_evolution::stress_seeking::StressSeeking;
use springform_topology::cell_type::CellTypeId;
use springform_topology::edit::Edit;
use springform_topology::filters::Method;
use springform_topology::forest::Content;

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
            let Ok(edits) = seeking.advance(&start.setting, kind) else {
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
            seeking.advance(&start.setting, kind).expect("a refined net is a net");
            let after = seeking.phenotype().measures;
            let least = before.springs + u32::from(start.setting.method != Method::Recursive);
            prop_assert!(after.springs >= least, "{} after {}", after.springs, before.springs);
            prop_assert!(after.cells >= before.cells + 3);
        }
    }
}
