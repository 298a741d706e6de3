//! Properties of edits and of everything written as text: exact inverses, refusals, round trips, bad input.

mod common;

use common::{Design, Dice, POINTS, cases, designs, edit_dice, grown_designs, stored_cells};
use proptest::prelude::*;
use springform_topology::MAX_LEVEL;
use springform_topology::address::{AddressError, Place};
use springform_topology::base_mesh::BaseMesh;
use springform_topology::cell_type::{Catalogue, CellTypeError, CellTypeId, NULL};
use springform_topology::edit::{Edit, EditError};
use springform_topology::forest::{Content, Forest, NodePair, Override};
use springform_topology::node_key::{NodeKey, RESOLUTION, UNITS};
use springform_topology::notation::{NotationError, parse_content, read_top_cell, write_cell, write_content};

/// Any edit, whether or not it fits.
fn any_edit(design: &Design, dice: &mut Dice) -> Edit {
    let cells = stored_cells(&design.forest);
    let mut cell = dice.pick(&cells).1;
    if dice.percent(30) && cell.level < MAX_LEVEL {
        cell = cell.child(dice.below(4) as u8);
    }
    if dice.percent(10) {
        cell.face += 3;
    }
    let contents: [Content; 4] =
        std::array::from_fn(|_| common::content(dice, design.method, &design.catalogue));
    match dice.below(5) {
        0 => Edit::Subdivide { cell, children: contents },
        1 => Edit::Merge { cell, children: contents },
        2 => Edit::Retype { cell, from: contents[0], to: contents[1] },
        3 => Edit::Toggle { cell, on: dice.percent(50) },
        _ => {
            let pair = NodePair::new(NodeKey::vertex(dice.below(4)), NodeKey::vertex(4 + dice.below(2)));
            let what = dice.pick(&[Override::Cut, Override::Added]);
            Edit::Override { pair: pair.expect("two nodes"), what, set: dice.percent(60) }
        }
    }
}

fn read_again(design: &Design) -> Forest {
    let mut forest = Forest::new(design.forest.top_level(), Content { kind: NULL, turn: 0 });
    for face in 0..forest.top_level() {
        let text = write_cell(&design.forest, design.forest.top(face), &design.catalogue);
        read_top_cell(&mut forest, face, &text, &design.catalogue).expect("written cells can be read");
    }
    for (&pair, &what) in design.forest.overrides() {
        Edit::Override { pair, what, set: true }.apply(&mut forest).expect("an override that fits");
    }
    forest
}

proptest! {
    #![proptest_config(cases(1500))]

    /// Undoing all edits gives the same forest and fingerprint, doing them again gives the other back.
    #[test]
    fn edits_invert_exactly(mut design in designs(), edits in edit_dice(40)) {
        let before = design.forest.clone();
        let done = design.grow(edits);
        let after = design.forest.clone();
        Edit::apply_all(&Edit::invert_all(&done), &mut design.forest).expect("edits invert");
        prop_assert_eq!(&design.forest, &before);
        prop_assert_eq!(design.forest.fingerprint(), before.fingerprint());
        prop_assert_eq!(design.forest.stored(), before.stored());
        Edit::apply_all(&done, &mut design.forest).expect("edits repeat");
        prop_assert_eq!(&design.forest, &after);
        prop_assert_eq!(design.forest.fingerprint(), after.fingerprint());
    }

    /// Every single edit inverts, and its inverse's inverse is the edit.
    #[test]
    fn each_edit_inverts(mut design in grown_designs(16), mut dice in common::dice(14)) {
        let before = design.forest.clone();
        let edit = design.random_edit(&mut dice);
        edit.apply(&mut design.forest).expect("a random edit fits");
        prop_assert_eq!(edit.inverse().inverse(), edit);
        edit.inverse().apply(&mut design.forest).expect("the inverse fits");
        prop_assert_eq!(design.forest, before);
    }

    /// An edit either fits, and then so does its inverse, or leaves the forest untouched.
    #[test]
    fn refused_edits_change_nothing(mut design in grown_designs(16), mut dice in common::dice(20)) {
        let before = design.forest.clone();
        let edit = any_edit(&design, &mut dice);
        if edit.apply(&mut design.forest).is_ok() {
            edit.inverse().apply(&mut design.forest).expect("the inverse fits");
        }
        prop_assert_eq!(&design.forest, &before);
        prop_assert_eq!(design.forest.fingerprint(), before.fingerprint());
    }

    /// A list with an edit that does not fit changes nothing either.
    #[test]
    fn refused_lists_change_nothing(
        mut design in grown_designs(8), edits in edit_dice(12), mut dice in common::dice(20)
    ) {
        let before = design.forest.clone();
        let mut done = design.clone().grow(edits);
        done.push(any_edit(&design, &mut dice));
        if Edit::apply_all(&done, &mut design.forest).is_err() {
            prop_assert_eq!(&design.forest, &before);
            prop_assert_eq!(design.forest.fingerprint(), before.fingerprint());
        }
    }

    /// Different forests have different fingerprints, as far as single edits go.
    #[test]
    fn fingerprints_tell_forests_apart(mut design in grown_designs(16), mut dice in common::dice(14)) {
        let before = design.forest.clone();
        let edit = design.random_edit(&mut dice);
        edit.apply(&mut design.forest).expect("a random edit fits");
        prop_assert_eq!(design.forest == before, design.forest.fingerprint() == before.fingerprint());
    }

    /// Edits, read from what was written, are the same.
    #[test]
    fn edits_are_read_as_written(mut design in designs(), edits in edit_dice(20)) {
        for edit in design.grow(edits) {
            let text = edit.write(&design.catalogue);
            prop_assert_eq!(Edit::parse(&text, &design.mesh, &design.catalogue), Ok(edit));
        }
    }

    /// Cells, read from what was written, are the same forest; written again, the same text.
    #[test]
    fn cells_are_read_as_written(design in grown_designs(40)) {
        let again = read_again(&design);
        prop_assert_eq!(&again, &design.forest);
        prop_assert_eq!(again.fingerprint(), design.forest.fingerprint());
        for (cell, place) in stored_cells(&design.forest) {
            let twin = again.find(place).expect("the same places");
            let text = write_cell(&design.forest, cell, &design.catalogue);
            prop_assert_eq!(write_cell(&again, twin, &design.catalogue), text);
        }
    }

    /// Contents, read from what was written, are the same.
    #[test]
    fn contents_are_read_as_written(mut dice in common::dice(40), number in 0u8..9, turn in 0u8..4) {
        let catalogue = common::catalogue(&mut dice);
        let content = Content { kind: CellTypeId(number), turn };
        prop_assert_eq!(parse_content(&write_content(content, &catalogue), &catalogue), Ok(content));
    }

    /// Addresses, read from what was written, are the same place.
    #[test]
    fn addresses_are_read_as_written(face in 0u32..1_000_000, path in prop::collection::vec(0u8..4, 0..=20)) {
        let place = path.iter().fold(Place::top(face), |place, &child| place.child(child));
        prop_assert_eq!(Place::parse(&place.to_string()), Ok(place));
        prop_assert_eq!(place.path().collect::<Vec<_>>(), path);
    }

    /// Places know their ancestors.
    #[test]
    fn places_know_what_they_contain(
        path in prop::collection::vec(0u8..4, 0..=20), level in 0u8..21, child in 0u8..4,
    ) {
        let place = path.iter().fold(Place::top(7), |place, &child| place.child(child));
        let ancestor = place.ancestor(level.min(place.level));
        prop_assert!(ancestor.contains(place));
        prop_assert_eq!(place.contains(ancestor), place == ancestor);
        if place.level < MAX_LEVEL {
            prop_assert_eq!(place.child(child).ancestor(place.level), place);
            prop_assert_eq!(place.child(child).child_at(place.level + 1), child);
        }
    }

    /// Node keys, read from what was written, are the same, on every kind of place.
    #[test]
    fn node_keys_are_read_as_written(
        mut dice in common::dice(90), i in 0..=UNITS, j in 0..=UNITS, coarse in 0u32..=20,
    ) {
        let mesh = common::mesh(&mut dice);
        let face = dice.below(mesh.faces().len() as u32);
        // Coarse coordinates fall on corners and edges often.
        let round = |units: u32| units >> (coarse + 1) << (coarse + 1);
        let key = NodeKey::at(&mesh, face, round(i), round(j));
        prop_assert_eq!(NodeKey::parse(&key.to_string(), &mesh), Ok(key));
    }

    /// A point of an edge has one key, from whichever face it is seen.
    #[test]
    fn faces_agree_on_edge_points(mut dice in common::dice(90), along in 0..=UNITS) {
        let mesh = common::mesh(&mut dice);
        let edge = dice.below(mesh.edges().len() as u32);
        let keys: Vec<NodeKey> = mesh
            .faces_at_edge(edge)
            .iter()
            .map(|at| {
                let along = if at.reversed { UNITS - along } else { along };
                let (i, j) = match at.side {
                    0 => (along, 0),
                    1 => (UNITS, along),
                    2 => (UNITS - along, UNITS),
                    _ => (0, UNITS - along),
                };
                NodeKey::at(&mesh, at.face, i, j)
            })
            .collect();
        prop_assert!(keys.windows(2).all(|keys| keys[0] == keys[1]), "{keys:?}");
    }
}

/// Pieces from which bad texts are made: words of the formats, near misses, and letters of several bytes.
const PIECES: [&str; 40] = [
    "0",
    "1",
    "12",
    "3",
    "4294967295",
    "99999999999999999999",
    ".",
    "..",
    ".0",
    ".3",
    ".4",
    " ",
    "  ",
    "\t",
    "\n",
    "(",
    ")",
    "[",
    "]",
    "@",
    "@1",
    "@3",
    "@9",
    "v",
    "e",
    "f",
    ":",
    "/",
    ",",
    "1/2",
    "3/8",
    "1/2097152",
    "-",
    "subdivide",
    "retype",
    "merge",
    "off",
    "cut",
    "é",
    "🕸",
];

/// A well-formed text of one of the formats.
fn good_text(design: &Design, dice: &mut Dice) -> String {
    let (cell, place) = dice.pick(&stored_cells(&design.forest));
    match dice.below(4) {
        0 => design.random_edit(dice).write(&design.catalogue),
        1 => write_cell(&design.forest, cell, &design.catalogue),
        2 => place.to_string(),
        _ => design.key(place, dice.below(3), dice.below(3)).to_string(),
    }
}

/// Inserts, drops and doubles pieces of a text.
fn mutated(mut text: Vec<char>, dice: &mut Dice) -> String {
    for _ in 0..=dice.below(4) {
        let at = dice.below(text.len() as u32 + 1) as usize;
        let end = (at + dice.below(4) as usize).min(text.len());
        match dice.below(3) {
            0 => drop(text.splice(at..at, dice.pick(&PIECES).chars())),
            1 => drop(text.drain(at..end)),
            _ => drop(text.splice(at..end, dice.pick(&PIECES).chars())),
        }
    }
    text.into_iter().collect()
}

proptest! {
    #![proptest_config(cases(10_000))]

    /// No parser panics; what it accepts, it writes and reads as the same.
    #[test]
    fn parsers_never_panic(design in grown_designs(6), mut dice in common::dice(40)) {
        let text = mutated(good_text(&design, &mut dice).chars().collect(), &mut dice);
        let Design { mesh, catalogue, .. } = &design;
        if let Ok(edit) = Edit::parse(&text, mesh, catalogue) {
            prop_assert_eq!(Edit::parse(&edit.write(catalogue), mesh, catalogue), Ok(edit));
            let _ = edit.apply(&mut design.forest.clone());
        }
        if let Ok(place) = Place::parse(&text) {
            prop_assert_eq!(place.to_string(), text.clone(), "only what is written so is an address");
        }
        if let Ok(key) = NodeKey::parse(&text, mesh) {
            prop_assert_eq!(NodeKey::parse(&key.to_string(), mesh), Ok(key));
        }
        if let Ok(content) = parse_content(&text, catalogue) {
            prop_assert_eq!(parse_content(&write_content(content, catalogue), catalogue), Ok(content));
        }
        let mut forest = Forest::new(1, Content::QUAD);
        if read_top_cell(&mut forest, 0, &text, catalogue).is_ok() {
            let written = write_cell(&forest, forest.top(0), catalogue);
            let mut again = Forest::new(1, Content::QUAD);
            prop_assert_eq!(read_top_cell(&mut again, 0, &written, catalogue), Ok(()));
            prop_assert_eq!(again, forest);
        }
        let _ = Catalogue::default().define(&text, std::slice::from_ref(&text), true, true);
    }
}

fn one_face() -> BaseMesh {
    BaseMesh::from_faces(4, vec![[0, 1, 2, 3]]).expect("one quad")
}

#[test]
fn refusals_say_why() {
    let quads = [Content::QUAD; 4];
    let mut forest = Forest::new(1, Content::QUAD);
    let (top, child) = (Place::top(0), Place::top(0).child(0));
    let mut refused = |edit: Edit| edit.apply(&mut forest).expect_err("the edit does not fit");
    assert_eq!(refused(Edit::Subdivide { cell: child, children: quads }), EditError::NoCell(child));
    assert_eq!(refused(Edit::Merge { cell: top, children: quads }), EditError::Merge(top));
    assert!(matches!(refused(Edit::Toggle { cell: top, on: false }), EditError::Toggle(..)));
    let null = Content { kind: NULL, turn: 0 };
    assert_eq!(refused(Edit::Retype { cell: top, from: null, to: null }), EditError::Retype(top));
}

#[test]
fn cells_reach_the_deepest_level_and_no_further() {
    let mut forest = Forest::new(1, Content::QUAD);
    let mut cell = Place::top(0);
    for _ in 0..MAX_LEVEL {
        Edit::Subdivide { cell, children: [Content::QUAD; 4] }
            .apply(&mut forest)
            .expect("above the deepest level");
        cell = cell.child(2);
    }
    let deeper = Edit::Subdivide { cell, children: [Content::QUAD; 4] };
    assert!(matches!(deeper.apply(&mut forest), Err(EditError::Subdivide(..))));
    let catalogue = Catalogue::default();
    let text = write_cell(&forest, forest.top(0), &catalogue);
    let mut again = Forest::new(1, Content::QUAD);
    read_top_cell(&mut again, 0, &text, &catalogue).expect("written cells can be read");
    assert_eq!(again, forest);
    let innermost = text.rfind("1 1 1 1").expect("the deepest children");
    let deeper = format!("{}1(1 1 1 1) {}", &text[..innermost], &text[innermost + 2..]);
    let mut again = Forest::new(1, Content::QUAD);
    let refused = read_top_cell(&mut again, 0, &deeper, &catalogue);
    assert!(matches!(refused, Err(NotationError::TooDeep { .. })), "{refused:?}");
    let address = format!("{cell}.0");
    assert_eq!(Place::parse(&address), Err(AddressError::TooDeep(address)));
}

#[test]
fn notation_errors_name_the_column() {
    let catalogue = Catalogue::default();
    let column = |text: &str| match read_top_cell(&mut Forest::new(1, Content::QUAD), 0, text, &catalogue) {
        Err(NotationError::Expected { column, .. } | NotationError::UnknownType { column, .. }) => column,
        other => panic!("{text}: {other:?}"),
    };
    for (text, expected) in [
        ("", 1),
        ("7", 1),
        ("1(1 1 1)", 8),
        ("1(1 1 1 1", 10),
        ("1(1 1 1 1 1)", 11),
        ("1@4", 3),
        ("1 1", 3),
        ("1(1 star 1 1)", 5),
    ] {
        assert_eq!(column(text), expected, "{text}");
    }
}

#[test]
fn keys_reach_one_level_below_the_deepest_cell() {
    let mesh = one_face();
    let text = format!("f0:1/{UNITS},{}/{UNITS}", UNITS - 1);
    assert_eq!(UNITS, 1 << RESOLUTION);
    assert_eq!(NodeKey::parse(&text, &mesh).expect("a key").to_string(), text);
    for bad in [
        "",
        "v",
        "v4",
        "e0:0/2",
        "e0:2/2",
        "e0:1/3",
        "e9:1/2",
        "f0:1/2",
        "f1:1/2,1/2",
        "f0:1/4194304,1/2",
        "x1",
    ] {
        assert!(NodeKey::parse(bad, &mesh).is_err(), "{bad}");
    }
}

#[test]
fn numbers_have_one_way_to_be_written() {
    let mesh = one_face();
    for bad in ["+0", "00", "0.+1", "+0.1", "01.0"] {
        assert!(Place::parse(bad).is_err(), "{bad}");
    }
    for bad in ["v+1", "v01", "e+0:1/2", "e0:+1/2", "e0:1/+2", "f0:01/2,1/2"] {
        assert!(NodeKey::parse(bad, &mesh).is_err(), "{bad}");
    }
    for bad in ["+1", "01"] {
        assert_eq!(Catalogue::default().find(bad), None, "{bad}");
    }
}

#[test]
fn catalogues_take_what_they_say() {
    let mut catalogue = Catalogue::default();
    for name in ["", "1star", "Star", "st ar", "quad", "stär"] {
        assert_eq!(catalogue.define(name, &[], true, false), Err(CellTypeError::Name(name.to_owned())));
    }
    for spring in ["", "c0", "c0-c0", "c0-c4", "m4-x", "c0-x-c1"] {
        let refused = catalogue.define("star", &[spring.to_owned()], true, false);
        assert_eq!(refused, Err(CellTypeError::Spring(spring.to_owned())));
    }
    for number in 0..249 {
        catalogue.define(&format!("t{number}"), &[], true, false).expect("249 types can be defined");
    }
    assert_eq!(catalogue.define("more", &[], true, false), Err(CellTypeError::TooMany));
    assert_eq!(catalogue.find("t248"), Some(CellTypeId(255)));
}

#[test]
fn turns_that_look_alike_are_not_distinct() {
    let mut catalogue = Catalogue::default();
    let all: Vec<String> = POINTS[..8].iter().map(|(name, _)| format!("{name}-x")).collect();
    catalogue.define("sun", &all, false, false).expect("a valid type");
    catalogue.define("hand", &["c0-x".to_owned()], false, false).expect("a valid type");
    let turns = |number: u8| catalogue.get(CellTypeId(number)).distinct_turns();
    assert_eq!((0..9).map(turns).collect::<Vec<_>>(), [1, 1, 1, 2, 2, 1, 1, 1, 4]);
}
