//! Properties of the recursive filter: balance, idempotence, order, inheritance, support springs.

mod common;

use common::oracle::{is_balanced, neighbours, supports};
use common::{Design, Dice, cases, designs, edit_dice, grown_designs, leaves, stored_cells};
use proptest::prelude::*;
use springform_topology::address::Place;
use springform_topology::base_mesh::BaseMesh;
use springform_topology::cell_type::{Catalogue, Point};
use springform_topology::edit::Edit;
use springform_topology::filters::Method;
use springform_topology::filters::recursive::{Closure, Support, close, support_springs};
use springform_topology::forest::{Content, Forest};
use springform_topology::notation::{read_top_cell, write_cell};
use springform_topology::sides::expressed_neighbours;
use std::collections::BTreeSet;

/// Deepest level for properties that subdivide again and again.
const DEEPEST: u8 = 7;

/// Random subdivisions, switches, merges and types, not closed, whatever the method.
fn unbalanced(edits: usize) -> impl Strategy<Value = Design> {
    (designs(), edit_dice(edits)).prop_map(|(mut design, edits)| {
        design.method = Method::Dynamic;
        design.grow(edits);
        design
    })
}

/// Subdivides into plain quads the expressed cell that covers a random place.
fn subdivide_somewhere(design: &mut Design, dice: &mut Dice) {
    let cells = leaves(&design.forest);
    let young = if dice.percent(60) { cells.len().saturating_sub(8) } else { 0 };
    let (cell, place) = dice.pick(&cells[young..]);
    if place.level < DEEPEST && design.forest.children(cell).is_none() {
        let edit = Edit::Subdivide { cell: place, children: [Content::QUAD; 4] };
        edit.apply(&mut design.forest).expect("an undivided cell");
    }
}

/// A row of plain quads, read from cell notation.
fn strip(cells: &[&str]) -> (BaseMesh, Forest) {
    let faces: Vec<[u32; 4]> =
        (0..cells.len() as u32).map(|k| [2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1]).collect();
    let mesh = BaseMesh::from_faces(2 * cells.len() as u32 + 2, faces).expect("a row of quads");
    let mut forest = Forest::new(cells.len() as u32, Content::QUAD);
    for (face, text) in cells.iter().enumerate() {
        read_top_cell(&mut forest, face as u32, text, &Catalogue::default()).expect("readable cells");
    }
    (mesh, forest)
}

fn written(forest: &Forest) -> Vec<String> {
    let catalogue = Catalogue::default();
    (0..forest.top_level()).map(|face| write_cell(forest, forest.top(face), &catalogue)).collect()
}

/// The address of a cell without its top-level cell.
fn below(edit: &Edit) -> u32 {
    match *edit {
        Edit::Subdivide { cell, .. } | Edit::Merge { cell, .. } => cell.face,
        Edit::Retype { cell, .. } | Edit::Toggle { cell, .. } => cell.face,
        Edit::Override { .. } | Edit::Refer { .. } => u32::MAX,
    }
}

proptest! {
    #![proptest_config(cases(1500))]

    /// Levels of cells that share an edge differ by one at most.
    #[test]
    fn closing_balances_levels(mut design in unbalanced(40)) {
        design.close();
        prop_assert!(is_balanced(&design.mesh, &design.forest));
    }

    /// A closed forest needs nothing.
    #[test]
    fn closing_is_idempotent(mut design in unbalanced(40)) {
        design.close();
        let once = design.forest.clone();
        prop_assert_eq!(design.close(), vec![]);
        prop_assert_eq!(design.forest, once);
    }

    /// A forest that is balanced already is left alone.
    #[test]
    fn closing_does_no_more_than_needed(design in unbalanced(16)) {
        let mut closed = design.clone();
        let edits = closed.close();
        prop_assert_eq!(edits.is_empty(), is_balanced(&design.mesh, &design.forest));
    }

    /// What closing did can be undone exactly, and done again.
    #[test]
    fn closing_inverts_exactly(mut design in unbalanced(40)) {
        let before = design.forest.clone();
        let edits = design.close();
        let after = design.forest.clone();
        Edit::apply_all(&Edit::invert_all(&edits), &mut design.forest).expect("edits invert");
        prop_assert_eq!(&design.forest, &before);
        prop_assert_eq!(design.forest.fingerprint(), before.fingerprint());
        Edit::apply_all(&edits, &mut design.forest).expect("edits repeat");
        prop_assert_eq!(design.forest, after);
    }

    /// Edits of different top-level cells may come in any order.
    #[test]
    fn closing_does_not_depend_on_the_order_of_edits(
        mut design in designs(), edits in edit_dice(30), mut order in common::dice(60)
    ) {
        design.method = Method::Extensible;
        let start = design.clone();
        let done: Vec<Edit> = design.grow(edits).into_iter().filter(|edit| below(edit) != u32::MAX).collect();
        // A random merge of the top-level cells' own sequences.
        let mut faces: Vec<u32> = done.iter().map(below).collect();
        order.shuffle(&mut faces);
        let mut queues: Vec<Vec<Edit>> = (0..design.forest.top_level())
            .map(|face| done.iter().rev().filter(|edit| below(edit) == face).copied().collect())
            .collect();
        let shuffled: Vec<Edit> = faces.into_iter().filter_map(|face| queues[face as usize].pop()).collect();
        let (mut first, mut second) = (start.clone(), start);
        Edit::apply_all(&done, &mut first.forest).expect("edits that fit");
        Edit::apply_all(&shuffled, &mut second.forest).expect("edits of other cells commute");
        let (by_first, by_second) = (first.close(), second.close());
        prop_assert_eq!(first.forest.fingerprint(), second.forest.fingerprint());
        prop_assert_eq!(first.forest, second.forest);
        prop_assert_eq!(by_first, by_second);
    }

    /// Closing after every subdivision or once at the end gives the same forest.
    #[test]
    fn closing_is_confluent(mut design in designs(), subdivisions in edit_dice(14)) {
        design.method = Method::Recursive;
        design.forest = Forest::new(design.forest.top_level(), Content::QUAD);
        let mut eager = design.clone();
        for mut dice in subdivisions {
            subdivide_somewhere(&mut design, &mut dice);
            for (_, place) in leaves(&design.forest) {
                // Whatever the lazy forest subdivides, the eager one does too, then closes.
                for level in 0..place.level {
                    let cell = place.ancestor(level);
                    let edit = Edit::Subdivide { cell, children: [Content::QUAD; 4] };
                    if edit.apply(&mut eager.forest).is_ok() {
                        eager.close();
                    }
                }
            }
        }
        design.close();
        prop_assert_eq!(&design.forest, &eager.forest);
    }

    /// Forced children inherit type and turn, and nothing but subdivisions and switches happens.
    #[test]
    fn forced_children_inherit(mut design in unbalanced(40)) {
        let mut replayed = design.clone();
        for edit in design.close() {
            match edit {
                Edit::Subdivide { cell, children } => {
                    let parent = replayed.forest.find(cell).expect("the cell exists");
                    prop_assert_eq!(children, [replayed.forest.content(parent); 4]);
                }
                Edit::Toggle { cell, on: true } => {
                    let parent = replayed.forest.find(cell).expect("the cell exists");
                    prop_assert!(replayed.forest.children(parent).is_some());
                }
                // Only children of a cell that the closure just switched on lose their own subdivisions.
                Edit::Toggle { cell, on: false } => prop_assert!(cell.level > 0),
                other => prop_assert!(false, "{other:?}"),
            }
            edit.apply(&mut replayed.forest).expect("edits fit in order");
        }
        prop_assert_eq!(replayed.forest, design.forest);
    }

    /// Closing only refines: each expressed cell lies within one that was expressed before.
    #[test]
    fn closing_only_refines(mut design in unbalanced(40)) {
        let before: Vec<Place> = leaves(&design.forest).into_iter().map(|(_, place)| place).collect();
        design.close();
        for (_, place) in leaves(&design.forest) {
            prop_assert!(before.iter().any(|coarse| coarse.contains(place)));
        }
    }

    /// Neighbours by search over sides are those whose sides overlap.
    #[test]
    fn neighbours_are_those_whose_sides_overlap(design in unbalanced(24)) {
        let mut found = BTreeSet::new();
        for (_, place) in leaves(&design.forest) {
            for other in expressed_neighbours(&design.mesh, &design.forest, place) {
                found.insert([place.min(other), place.max(other)]);
            }
        }
        prop_assert_eq!(found, neighbours(&design.mesh, &design.forest));
    }

    /// Closing after edits of a closed forest, from where they were, does what closing all of it does, edit by
    /// edit, whatever the same memory closed before.
    #[test]
    fn closing_after_edits_is_closing(
        designs in prop::collection::vec((unbalanced(30), edit_dice(10)), 1..4)
    ) {
        let mut closure = Closure::default();
        for (mut design, dice) in designs {
            design.close();
            let edits = design.grow(dice);
            let mut after = edits.clone();
            let mut forest = design.forest.clone();
            closure.close_after(&design.mesh, &mut forest, &mut after).expect("a valid forest closes");
            let whole = design.close();
            prop_assert_eq!(&after[..edits.len()], &edits[..]);
            prop_assert_eq!(&after[edits.len()..], &whole[..]);
            prop_assert_eq!(&forest, &design.forest);
        }
    }

    /// Stored cells survive every closure: nothing is merged.
    #[test]
    fn closing_loses_nothing(design in grown_designs(30)) {
        let mut closed = design.clone();
        closed.close();
        for (cell, place) in stored_cells(&design.forest) {
            let kept = closed.forest.find(place).map(|kept| closed.forest.content(kept));
            prop_assert_eq!(kept, Some(design.forest.content(cell)));
        }
    }
}

#[test]
fn one_subdivision_cascades() {
    // Corner 0 is five levels deep and balanced; one more subdivision beside it runs through all levels.
    let (mesh, mut forest) = strip(&["1(1(1(1(1(1 1 1 1) 1 1 1) 1 1 1) 1 1 1) 1 1 1)"]);
    assert_eq!(close(&mesh, &mut forest), Ok(vec![]));
    let start = Place::parse("0.0.0.0.0.1").expect("an address");
    Edit::Subdivide { cell: start, children: [Content::QUAD; 4] }
        .apply(&mut forest)
        .expect("an undivided cell");
    let edits = close(&mesh, &mut forest).expect("a valid forest closes");
    let lines: Vec<String> = edits.iter().map(|edit| edit.write(&Catalogue::default())).collect();
    let expected = ["0.0.0.0.1", "0.0.0.1", "0.0.1", "0.1"].map(|cell| format!("{cell} subdivide 1 1 1 1"));
    assert_eq!(lines, expected);
}

#[test]
fn a_cascade_crosses_top_level_cells() {
    let (mesh, mut forest) = strip(&["1(1 1(1 1(1 1 1 1) 1 1) 1 1)", "1", "1", "1"]);
    let edits = close(&mesh, &mut forest).expect("a valid forest closes");
    assert_eq!(edits.len(), 2);
    assert_eq!(written(&forest)[1..], ["1(1(1 1 1 1) 1 1 1)", "1", "1"]);
}

#[test]
fn a_deep_cell_beside_a_top_level_cell_refines_it_down_to_the_level_below() {
    let (mesh, mut forest) = strip(&["1(1 1(1 1(1 1(1 1 1 1) 1 1) 1 1) 1 1)", "1"]);
    close(&mesh, &mut forest).expect("a valid forest closes");
    assert!(is_balanced(&mesh, &forest));
    assert_eq!(written(&forest)[1], "1(1(1(1 1 1 1) 1 1 1) 1 1 1)");
}

#[test]
fn a_stored_level_is_switched_on_without_its_own_subdivisions() {
    let (mesh, mut forest) = strip(&["1(1 1(1 1 1 1) 1 1)", "1[3@1 1(1 1 1 1) 1 1[1 1 1 1]]"]);
    let edits = close(&mesh, &mut forest).expect("a valid forest closes");
    assert_eq!(written(&forest)[1], "1(3@1 1[1 1 1 1] 1 1[1 1 1 1])");
    let lines: Vec<String> = edits.iter().map(|edit| edit.write(&Catalogue::default())).collect();
    assert_eq!(lines, ["1 on", "1.1 off"]);
}

#[test]
fn types_and_turns_are_inherited() {
    let (mesh, mut forest) = strip(&["1(1 1(1 1 1 1) 1 1)", "4@1"]);
    close(&mesh, &mut forest).expect("a valid forest closes");
    assert_eq!(written(&forest)[1], "4@1(4@1 4@1 4@1 4@1)");
}

#[test]
fn support_springs_of_all_sixteen_patterns() {
    let point = |end: Support| match end {
        Support::Hanging(side) => Point::Middle(side),
        Support::Corner(corner) => Point::Corner(corner),
        Support::Centre => Point::Centre,
    };
    let sorted = |springs: Vec<[Point; 2]>| -> Vec<[Point; 2]> {
        let mut springs: Vec<_> = springs.into_iter().map(|[a, b]| [a.min(b), a.max(b)]).collect();
        springs.sort_unstable();
        springs
    };
    for pattern in 0..16u8 {
        let hanging = std::array::from_fn(|side| pattern >> side & 1 == 1);
        let found = support_springs(hanging).map(|ends| ends.map(point)).collect();
        assert_eq!(sorted(found), sorted(supports(hanging)), "hanging {hanging:?}");
    }
}
