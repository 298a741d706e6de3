//! Properties of expression: nodes, springs, owners and boundaries against a slow, independent net.

mod common;

use common::oracle::{Flow, SlowNet, slow_net};
use common::{Design, cases, edit_dice, grown_designs, leaves};
use proptest::prelude::*;
use springform_topology::address::Place;
use springform_topology::base_mesh::BaseMesh;
use springform_topology::cell_type::{Catalogue, CellTypeId, DYNAMIC, NULL};
use springform_topology::edit::Edit;
use springform_topology::expression::{Expression, ExpressionError, Growth, Kinship, express};
use springform_topology::filters::Method;
use springform_topology::filters::continuity::carrying;
use springform_topology::forest::{Content, Forest, NodePair, Override};
use springform_topology::framework::{Framework, Grid, Part, Shape};
use springform_topology::node_key::NodeKey;
use springform_topology::notation::{read_top_cell, write_cell};
use std::collections::BTreeSet;

fn expressed(design: &Design) -> Result<Expression, ExpressionError> {
    express(&design.mesh, &design.forest, &design.catalogue, design.method, &design.anchors)
}

/// Plain quads of a sheet, anchored at given vertices.
fn sheet(around: u32, along: u32, anchors: &[u32]) -> Design {
    let part = Part { name: "sheet".to_owned(), shape: Shape::Sheet, around, along };
    let framework = Framework { grid: Grid::Quad, parts: vec![part], joins: Vec::new() };
    let mesh = BaseMesh::from_framework(&framework).expect("a valid sheet");
    let forest = Forest::new(mesh.faces().len() as u32, Content::QUAD);
    Design {
        mesh,
        catalogue: Catalogue::default(),
        method: Method::Dynamic,
        anchors: anchors.to_vec(),
        forest,
    }
}

/// What only one of two nets has, in words.
fn differences(found: &SlowNet, expected: &SlowNet) -> Vec<String> {
    let missing = |here: &SlowNet, there: &SlowNet, name: &str| -> Vec<String> {
        let springs = here.springs.iter().filter(|&(ends, spring)| there.springs.get(ends) != Some(spring));
        let mut words: Vec<String> = springs.map(|spring| format!("{name}: {spring:?}")).collect();
        for (cell, boundary) in here.boundaries.iter().enumerate() {
            if there.boundaries.get(cell) != Some(boundary) {
                words.push(format!("{name}: boundary of {cell} {boundary:?}"));
            }
        }
        if here.contents != there.contents {
            words.push(format!("{name}: {:?}", here.contents));
        }
        words
    };
    [missing(found, expected, "found"), missing(expected, found, "expected")].concat()
}

fn apply(design: &mut Design, edits: &[&str]) {
    for text in edits {
        let edit = Edit::parse(text, &design.mesh, &design.catalogue).expect("a readable edit");
        edit.apply(&mut design.forest).expect("an edit that fits");
    }
}

fn has_spring(design: &Design, expression: &Expression, a: &str, b: &str) -> bool {
    let node = |text| expression.node(NodeKey::parse(text, &design.mesh).expect("a readable key"));
    let (Some(a), Some(b)) = (node(a), node(b)) else { return false };
    expression.springs.iter().any(|spring| spring.nodes == [a.min(b), a.max(b)])
}

/// The same forest in another store: cells written and read again, faces last to first.
fn stored_anew(design: &Design) -> Design {
    let mut forest = Forest::new(design.forest.top_level(), Content::QUAD);
    for face in (0..forest.top_level()).rev() {
        let text = write_cell(&design.forest, design.forest.top(face), &design.catalogue);
        read_top_cell(&mut forest, face, &text, &design.catalogue).expect("written cells can be read");
    }
    for (&pair, &what) in design.forest.overrides() {
        Edit::Override { pair, what, set: true }.apply(&mut forest).expect("an override that fits");
    }
    Design { forest, ..design.clone() }
}

/// The same design with its faces numbered from last to first; no overrides.
fn faces_reversed(design: &Design) -> Design {
    let faces: Vec<[u32; 4]> = design.mesh.faces().iter().rev().copied().collect();
    let last = design.forest.top_level() - 1;
    let mesh = BaseMesh::from_faces(design.mesh.vertex_count(), faces).expect("the same faces");
    let mut forest = Forest::new(last + 1, Content::QUAD);
    for face in 0..=last {
        let text = write_cell(&design.forest, design.forest.top(face), &design.catalogue);
        read_top_cell(&mut forest, last - face, &text, &design.catalogue).expect("written cells can be read");
    }
    Design { mesh, forest, ..design.clone() }
}

proptest! {
    #![proptest_config(cases(1500))]

    /// Nodes, springs, rings, owners, boundaries and restored contents are those of the slow net, in which
    /// every spring has two node-disjoint paths to two different anchors and every spring left out has not.
    #[test]
    fn agrees_with_the_slow_net(design in grown_designs(24)) {
        match (expressed(&design), slow_net(&design)) {
            (Ok(expression), Some(slow)) => {
                let found = SlowNet::from_expression(&design.mesh, &expression);
                prop_assert_eq!(differences(&found, &slow), Vec::<String>::new());
            }
            (Err(ExpressionError::Empty | ExpressionError::LooseAnchor(_)), None) => {}
            (found, slow) => prop_assert!(false, "found {found:?}, expected {slow:?}"),
        }
    }

    /// Everything is in range, in order and there once.
    #[test]
    fn is_valid(design in grown_designs(24)) {
        let Ok(expression) = expressed(&design) else { return Ok(()) };
        prop_assert!(expression.is_valid());
        let ends: BTreeSet<[u32; 2]> = expression.springs.iter().map(|spring| spring.nodes).collect();
        prop_assert_eq!(ends.len(), expression.springs.len());
        let joined: BTreeSet<u32> = ends.into_iter().flatten().collect();
        prop_assert!(joined.into_iter().eq(0..expression.nodes.len() as u32), "a node without springs");
        for (cell, expected) in expression.cells.iter().zip(leaves(&design.forest)) {
            prop_assert_eq!((cell.index, cell.place), expected);
        }
        for (anchor, &node) in expression.anchors.iter().enumerate() {
            prop_assert_eq!(expression.nodes[node as usize], NodeKey::vertex(design.anchors[anchor]));
        }
        for node in 0..expression.nodes.len() as u32 {
            for cell in expression.cells_at(node) {
                prop_assert!(expression.cell_boundaries.of(cell).contains(&node));
            }
        }
    }

    /// Cells know their springs exactly as springs know their cells.
    #[test]
    fn owners_go_both_ways(design in grown_designs(24)) {
        let Ok(expression) = expressed(&design) else { return Ok(()) };
        let mut by_cell = BTreeSet::new();
        for cell in 0..expression.cells.len() as u32 {
            by_cell.extend(expression.cell_springs.of(cell).iter().map(|&spring| (spring, cell)));
        }
        let mut by_spring = BTreeSet::new();
        for spring in 0..expression.springs.len() as u32 {
            by_spring.extend(expression.spring_cells.of(spring).iter().map(|&cell| (spring, cell)));
        }
        prop_assert_eq!(by_cell, by_spring);
    }

    /// Filtering what has been filtered changes nothing, and each spring passes the flow oracle by itself.
    #[test]
    fn continuity_is_idempotent(design in grown_designs(24)) {
        let Ok(expression) = expressed(&design) else { return Ok(()) };
        let springs: Vec<[u32; 2]> = expression.springs.iter().map(|spring| spring.nodes).collect();
        let kept = carrying(expression.nodes.len(), &springs, &expression.anchors);
        prop_assert!(kept.into_iter().all(|kept| kept));
        let flow = Flow::new(expression.nodes.len(), &springs, &expression.anchors);
        prop_assert!(springs.iter().all(|&ends| flow.carries(ends)));
    }

    /// Expressed in one memory after whatever else, a forest gives what it gives in fresh memory, owners too, and an
    /// error leaves nothing behind.
    #[test]
    fn memory_that_is_used_again_changes_nothing(designs in prop::collection::vec(grown_designs(24), 1..5)) {
        let mut growth = Growth::default();
        for (at, design) in designs.iter().chain(&designs).enumerate() {
            let Design { mesh, forest, catalogue, method, anchors } = design;
            let fresh = expressed(design);
            let again = growth.express(mesh, forest, catalogue, *method, anchors).cloned();
            let unowned = fresh.clone().map(|net| Expression {
                cell_springs: Default::default(),
                spring_cells: Default::default(),
                ..net
            });
            prop_assert_eq!(again, unowned);
            if at % 2 == 0 && fresh.is_ok() {
                growth.add_owners();
                prop_assert_eq!(Ok(growth.expression().clone()), fresh);
            }
        }
    }

    /// Nodes and springs of a mutant are found again in its parent exactly if the parent has them.
    #[test]
    fn kinship_finds_what_both_have(design in grown_designs(16), edits in edit_dice(6)) {
        let mut mutant = design.clone();
        mutant.grow(edits);
        let (Ok(parent), Ok(child)) = (expressed(&design), expressed(&mutant)) else { return Ok(()) };
        let mut kinship = Kinship::default();
        kinship.find(&parent, &child);
        kinship.find(&child, &parent);
        let found = |number: u32| (number != Kinship::NONE).then_some(number as usize);
        prop_assert_eq!(kinship.nodes.len(), child.nodes.len());
        for (key, &node) in child.nodes.iter().zip(&kinship.nodes) {
            prop_assert_eq!(found(node), parent.nodes.binary_search(key).ok());
        }
        let named = |net: &Expression, at: usize| {
            let spring = net.springs[at];
            (spring.nodes.map(|node| net.nodes[node as usize]), spring.ring)
        };
        let all: Vec<_> = (0..parent.springs.len()).map(|at| named(&parent, at)).collect();
        prop_assert_eq!(kinship.springs.len(), child.springs.len());
        for (at, &spring) in kinship.springs.iter().enumerate() {
            let before = all.iter().position(|spring| *spring == named(&child, at));
            prop_assert_eq!(found(spring), before);
        }
    }

    /// Where cells stand in memory does not matter.
    #[test]
    fn numbering_does_not_depend_on_the_order_of_cells(design in grown_designs(24)) {
        let again = stored_anew(&design);
        prop_assert_eq!(&design.forest, &again.forest);
        match (expressed(&design), expressed(&again)) {
            (Ok(mut first), Ok(mut second)) => {
                for cell in first.cells.iter_mut().chain(&mut second.cells) {
                    cell.index = springform_topology::forest::CellIndex(0);
                }
                prop_assert_eq!(first, second);
            }
            (first, second) => prop_assert_eq!(first.err(), second.err()),
        }
    }

    /// Nor does the order of faces, up to the names of what lies inside faces.
    #[test]
    fn springs_do_not_depend_on_the_order_of_faces(design in grown_designs(24)) {
        let count = |design: &Design| expressed(design).map(|net| (net.nodes.len(), net.springs.len())).ok();
        let mut bare = design.clone();
        for (&pair, &what) in design.forest.overrides() {
            Edit::Override { pair, what, set: false }.apply(&mut bare.forest).expect("it is set");
        }
        prop_assert_eq!(count(&bare), count(&faces_reversed(&bare)));
    }

    /// Every anchor is attached, or there is an error that names a loose one.
    #[test]
    fn anchors_are_attached_or_named(design in grown_designs(24)) {
        match expressed(&design) {
            Ok(expression) => {
                let ends: BTreeSet<u32> = expression.springs.iter().flat_map(|spring| spring.nodes).collect();
                prop_assert!(expression.anchors.iter().all(|anchor| ends.contains(anchor)));
            }
            Err(ExpressionError::LooseAnchor(anchor)) => prop_assert!(anchor < design.anchors.len()),
            Err(ExpressionError::Empty) => {}
            Err(error @ ExpressionError::Type { .. }) => prop_assert!(false, "{error}"),
        }
    }

    /// A method refuses the types that it does not allow, whatever else the forest holds.
    #[test]
    fn refuses_types_that_the_method_does_not_allow(
        mut design in grown_designs(12), at in any::<prop::sample::Index>(),
    ) {
        let cells = leaves(&design.forest);
        let (cell, place) = cells[at.index(cells.len())];
        let from = design.forest.content(cell);
        let to = Content { kind: DYNAMIC, turn: 0 };
        Edit::Retype { cell: place, from, to }.apply(&mut design.forest).expect("an edit that fits");
        let refused =
            matches!(expressed(&design), Err(ExpressionError::Type { place: at, .. }) if at == place);
        prop_assert_eq!(refused, design.method != Method::Dynamic);
    }
}

#[test]
fn one_cell_is_four_springs() {
    let design = sheet(1, 1, &[0, 3]);
    let expression = expressed(&design).expect("a net");
    assert_eq!((expression.nodes.len(), expression.springs.len()), (4, 4));
    assert!(expression.springs.iter().all(|spring| spring.ring));
}

#[test]
fn springs_of_every_type_on_one_cell() {
    // All four corners are anchors, so that nothing is filtered; type 0 is restored to a quad.
    let springs = |kind: u8| {
        let mut design = sheet(1, 1, &[0, 1, 2, 3]);
        design.forest = Forest::new(1, Content { kind: CellTypeId(kind), turn: 0 });
        expressed(&design).expect("a net").springs.len()
    };
    // The middles of types 4 and 5 stitch the perimeter: 4 + 2 + 1, and 8 + 4.
    assert_eq!((0..7).map(springs).collect::<Vec<_>>(), [4, 4, 8, 5, 7, 12, 4]);
}

#[test]
fn a_hanging_node_is_stitched_into_its_coarse_neighbour() {
    let mut design = sheet(2, 1, &[0, 5]);
    apply(&mut design, &["0 subdivide 1 1 1 1"]);
    let expression = expressed(&design).expect("a net");
    let edge = design.mesh.side_edge(0, 1).edge;
    assert!(has_spring(&design, &expression, "v1", &format!("e{edge}:1/2")));
    assert!(has_spring(&design, &expression, "v4", &format!("e{edge}:1/2")));
    assert!(!has_spring(&design, &expression, "v1", "v4"));
    // Two quads: 7 springs; the subdivision adds four inside and halves four.
    assert_eq!(expression.springs.len(), 15);
}

#[test]
fn null_cells_make_voids() {
    let mut design = sheet(3, 3, &[0, 3, 12, 15]);
    apply(&mut design, &["1 retype 1 0", "4 retype 1 0"]);
    let expression = expressed(&design).expect("a net");
    // Of 24 springs, the rim edge and the edge between the two voids go.
    assert_eq!(expression.springs.len(), 22);
    assert!(!has_spring(&design, &expression, "v1", "v2"));
    assert!(!has_spring(&design, &expression, "v5", "v6"));
    assert!(expression.cells.iter().filter(|cell| cell.content.kind == NULL).count() == 2);
}

#[test]
fn loose_anchors_turn_their_cells_into_quads() {
    let mut design = sheet(3, 3, &[0, 15]);
    apply(&mut design, &["0 subdivide 0 1 0 1"]);
    let expression = expressed(&design).expect("a net");
    let content = |address: &str| {
        let place = Place::parse(address).expect("an address");
        expression.cells.iter().find(|cell| cell.place == place).map(|cell| cell.content)
    };
    assert_eq!(content("0.0"), Some(Content::QUAD));
    assert_eq!(content("0.2"), Some(Content { kind: NULL, turn: 0 }));
    apply(&mut design, &["0.1 retype 1 0", "0.3 retype 1 0"]);
    assert_eq!(expressed(&design), Err(ExpressionError::Empty), "a quad among voids holds nothing");
}

#[test]
fn an_anchor_on_an_island_is_an_error() {
    let faces = vec![[0, 1, 2, 3], [4, 5, 6, 7]];
    let mut design = sheet(1, 1, &[0, 2, 5]);
    design.mesh = BaseMesh::from_faces(8, faces).expect("two quads");
    design.forest = Forest::new(2, Content::QUAD);
    assert_eq!(expressed(&design), Err(ExpressionError::LooseAnchor(2)));
    design.anchors = vec![0, 5];
    assert_eq!(expressed(&design), Err(ExpressionError::Empty));
}

#[test]
fn overrides_add_and_cut_and_sleep_while_a_node_is_absent() {
    let mut design = sheet(2, 2, &[0, 2, 6, 8]);
    let count = |design: &Design| expressed(design).expect("a net").springs.len();
    let before = count(&design);
    apply(&mut design, &["v0 v4 add", "v1 v4 cut"]);
    let expression = expressed(&design).expect("a net");
    assert!(has_spring(&design, &expression, "v0", "v4") && !has_spring(&design, &expression, "v1", "v4"));
    assert_eq!(count(&design), before);

    apply(&mut design, &["v0 v4 unadd", "v1 v4 uncut", "v0 f3:1/2,1/2 add"]);
    assert_eq!(count(&design), before, "dormant");
    apply(&mut design, &["3 subdivide 1 1 1 1"]);
    assert!(has_spring(&design, &expressed(&design).expect("a net"), "v0", "f3:1/2,1/2"), "awake");
    apply(&mut design, &["3 off"]);
    assert_eq!(count(&design), before, "dormant again");
    apply(&mut design, &["3 on"]);
    assert!(has_spring(&design, &expressed(&design).expect("a net"), "v0", "f3:1/2,1/2"), "awake again");
}

#[test]
fn a_spring_that_cells_and_hand_give_exists_once_and_a_cut_takes_all() {
    let mut design = sheet(2, 1, &[0, 2, 3, 5]);
    apply(&mut design, &["v1 v4 add"]);
    let expression = expressed(&design).expect("a net");
    assert_eq!(expression.springs.len(), 7);
    apply(&mut design, &["v1 v4 unadd", "v1 v4 cut"]);
    assert_eq!(expressed(&design).expect("a net").springs.len(), 6);
    let pair = NodePair::new(NodeKey::vertex(1), NodeKey::vertex(4)).expect("two nodes");
    assert_eq!(design.forest.overrides().get(&pair), Some(&Override::Cut));
}

#[test]
fn supports_are_owned_by_the_coarse_cell() {
    let mut design = sheet(2, 1, &[0, 5]);
    design.method = Method::Recursive;
    apply(&mut design, &["0 subdivide 1 1 1 1"]);
    let expression = expressed(&design).expect("a net");
    let middle = format!("e{}:1/2", design.mesh.side_edge(0, 1).edge);
    for corner in ["v2", "v5"] {
        assert!(has_spring(&design, &expression, &middle, corner));
    }
    let coarse =
        expression.cells.iter().position(|cell| cell.place == Place::top(1)).expect("the second cell");
    assert_eq!(expression.cell_springs.of(coarse as u32).len(), 5 + 2);
}
