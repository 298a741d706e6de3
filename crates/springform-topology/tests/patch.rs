//! Properties of orientations, patches, grafts and mirrors on random designs, meshes and catalogues.

mod common;

use common::{Design, Dice, cases, dice, grown_designs};
use proptest::prelude::*;
use springform_topology::address::Place;
use springform_topology::base_mesh::BaseMesh;
use springform_topology::cell_type::Point;
use springform_topology::edit::Edit;
use springform_topology::expression::{ExpressionError, express};
use springform_topology::filters::Method;
use springform_topology::forest::{CellIndex, Content, Forest};
use springform_topology::graft::{Placed, Why, best_frame, graft};
use springform_topology::node_key::NodeKey;
use springform_topology::orientation::{Barrier, Frame, Mirrors, Orientation};
use springform_topology::patch::{LiftError, Patch, Viewpoint, Walk, lift};
use springform_topology::selection::Selection;
use springform_topology::tree::Tree;
use std::collections::BTreeSet;

fn turned(dice: &mut Dice) -> Orientation {
    Orientation::new(dice.below(4) as u8, dice.percent(50))
}

/// A region of some cells, of any levels.
fn region(design: &Design, dice: &mut Dice) -> Selection {
    let faces = design.forest.top_level();
    let (centre, rings) = (dice.below(design.mesh.vertex_count()), dice.between(1, 3));
    let round = Selection::rings(&design.mesh, &[NodeKey::vertex(centre)], rings, 0);
    match dice.below(4) {
        0 => Selection::new((0..dice.between(1, 4)).map(|_| Place::top(dice.below(faces)))),
        1 => {
            let cells = common::stored_cells(&design.forest);
            Selection::new((0..dice.between(1, 5)).map(|_| dice.pick(&cells).1))
        }
        2 => Selection::all(&design.mesh),
        _ => round,
    }
}

fn frame(design: &Design, dice: &mut Dice) -> Frame {
    Frame { face: dice.below(design.forest.top_level()), orientation: turned(dice) }
}

fn grafted(design: &mut Design, patch: &Patch, frame: Frame) -> (Placed, Vec<Edit>) {
    let (mirrors, mut edits) = (Mirrors::new(&design.catalogue), Vec::new());
    let (mesh, mut taken) = (&design.mesh, BTreeSet::new());
    let placed = graft(mesh, &mut design.forest, (patch, frame), &mirrors, &mut taken, |_| true, &mut edits);
    (placed.expect("a patch from a shallow forest fits"), edits)
}

/// The same design with its cells numbered from elsewhere and their corners from another one.
fn renumbered(design: &Design, dice: &mut Dice) -> (Design, Vec<Frame>) {
    let faces = design.mesh.faces();
    let mut order: Vec<u32> = (0..faces.len() as u32).collect();
    dice.shuffle(&mut order);
    let turns: Vec<u8> = order.iter().map(|_| dice.below(4) as u8).collect();
    let mut vertices: Vec<u32> = (0..design.mesh.vertex_count()).collect();
    dice.shuffle(&mut vertices);
    // Where each old face goes: old corner k becomes corner k + turn.
    let mut images = vec![Frame { face: 0, orientation: Orientation::UPRIGHT }; faces.len()];
    let mut moved = Vec::new();
    for (at, (&old, &turn)) in order.iter().zip(&turns).enumerate() {
        let corners = faces[old as usize];
        let corner = |k: usize| vertices[corners[(k + 4 - usize::from(turn)) % 4] as usize];
        moved.push(std::array::from_fn(corner));
        images[old as usize] = Frame { face: at as u32, orientation: Orientation::new(turn, false) };
    }
    let mesh = BaseMesh::from_faces(design.mesh.vertex_count(), moved).expect("the same mesh");
    let mirrors = Mirrors::new(&design.catalogue);
    let mut forest = Forest::new(design.forest.top_level(), Content::QUAD);
    for (&Frame { face, orientation }, old) in images.iter().zip(0..) {
        let tree =
            Tree::of(&design.forest, CellIndex(old)).oriented(orientation, &mirrors).expect("no mirror");
        tree.write_over(&mut forest, Place::top(face), &mut Vec::new()).expect("an empty forest");
    }
    let anchors = design.anchors.iter().map(|&vertex| vertices[vertex as usize]).collect();
    (Design { mesh, forest, anchors, ..design.clone() }, images)
}

proptest! {
    #![proptest_config(cases(1500))]

    /// The eight orientations are a group, and sides go where their corners go.
    #[test]
    fn orientations_are_a_group(mut dice in dice(8), k in 0u8..4) {
        let (a, b) = (turned(&mut dice), turned(&mut dice));
        prop_assert_eq!(a.after(b).corner(k), a.corner(b.corner(k)));
        prop_assert_eq!(a.after(b).side(k), a.side(b.side(k)));
        prop_assert_eq!(a.after(a.inverse()), Orientation::UPRIGHT);
        let ends = BTreeSet::from([a.corner(k), a.corner((k + 1) % 4)]);
        prop_assert_eq!(ends, BTreeSet::from([a.side(k), (a.side(k) + 1) % 4]));
    }

    /// Mirroring twice gives every type back that has an image, and the image shows the mirrored springs.
    #[test]
    fn contents_turn_as_their_cells_do(mut dice in dice(60)) {
        let catalogue = common::catalogue(&mut dice);
        let mirrors = Mirrors::new(&catalogue);
        let (a, b) = (turned(&mut dice), turned(&mut dice));
        let content = common::content(&mut dice, Method::Dynamic, &catalogue);
        if let Ok(image) = a.content(content, &mirrors) {
            prop_assert_eq!(a.inverse().content(image, &mirrors), Ok(content));
            prop_assert_eq!(b.content(image, &mirrors), b.after(a).content(content, &mirrors));
            let moved = |point: Point| match point {
                Point::Corner(k) => Point::Corner(a.corner(k)),
                Point::Middle(k) => Point::Middle(a.side(k)),
                centre => centre,
            };
            let expected = catalogue.get(content.kind).springs_at(|point| moved(point.turned(content.turn)));
            prop_assert_eq!(catalogue.get(image.kind).springs_at(|point| point.turned(image.turn)), expected);
        } else {
            prop_assert!(a.mirrored);
        }
    }

    /// A step across a side and back leads home, and the two views share the edge.
    #[test]
    fn frames_cross_edges_and_come_back(design in grown_designs(0), mut dice in dice(8), side in 0u8..4) {
        let here = frame(&design, &mut dice);
        match here.across(&design.mesh, side) {
            Ok(beyond) => {
                prop_assert_eq!(beyond.across(&design.mesh, (side + 2) % 4), Ok(here));
                let corner = |frame: Frame, k: u8| {
                    design.mesh.faces()[frame.face as usize][usize::from(frame.orientation.corner(k % 4))]
                };
                prop_assert_eq!(corner(here, side), corner(beyond, side + 3));
                prop_assert_eq!(corner(here, side + 1), corner(beyond, side + 2));
            }
            Err(Barrier::Border) => prop_assert!(here.is_free(&design.mesh, side)),
            Err(Barrier::Branching) => prop_assert!(!here.is_free(&design.mesh, side)),
        }
    }

    /// Trees come back from notation, from orientations, and from being written over anything.
    #[test]
    fn trees_are_kept(design in grown_designs(30), mut dice in dice(20)) {
        let cells = common::stored_cells(&design.forest);
        let tree = Tree::of(&design.forest, dice.pick(&cells).0);
        let text = tree.write(&design.catalogue);
        prop_assert_eq!(Tree::read(&text, &design.catalogue), Ok(tree.clone()));
        let (mirrors, turn) = (Mirrors::new(&design.catalogue), turned(&mut dice));
        if let Ok(image) = tree.oriented(turn, &mirrors) {
            prop_assert_eq!(image.oriented(turn.inverse(), &mirrors), Ok(tree.clone()));
        }
        let (mut forest, mut edits) = (design.forest.clone(), Vec::new());
        let place = dice.pick(&cells).1;
        tree.write_over(&mut forest, place, &mut edits).expect("shallow trees fit");
        let written = forest.find(place).map(|cell| Tree::of(&forest, cell));
        prop_assert_eq!(written, Some(tree));
        Edit::apply_all(&Edit::invert_all(&edits), &mut forest).expect("edits invert");
        prop_assert_eq!(forest, design.forest);
    }

    /// A patch that is grafted where it was lifted changes nothing.
    #[test]
    fn grafting_back_is_the_identity(mut design in grown_designs(40), mut dice in dice(40)) {
        let (selection, mirrors) = (region(&design, &mut dice), Mirrors::new(&design.catalogue));
        let viewpoint = match dice.below(3) {
            0 => Viewpoint::Anywhere,
            1 => Viewpoint::Frame(Frame { face: dice.pick(&Vec::from_iter(selection.faces())), orientation: turned(&mut dice) }),
            _ => Viewpoint::Anchor(design.anchors[0]),
        };
        let lifted = match lift(&design.mesh, &design.forest, &selection, viewpoint, &mirrors) {
            Ok(lifted) => lifted,
            Err(LiftError::NoSeed) => {
                let shown = |place: Place| {
                    let above = (0..place.level).filter_map(|level| design.forest.find(place.ancestor(level)));
                    design.forest.find(place).is_some() && above.into_iter().all(|cell| design.forest.is_on(cell))
                };
                prop_assert!(viewpoint != Viewpoint::Anywhere || !selection.places().any(shown));
                return Ok(());
            }
        };
        let before = design.forest.clone();
        let (placed, edits) = grafted(&mut design, &lifted.patch, lifted.frame);
        prop_assert!(placed.skipped.is_empty() && edits.is_empty(), "{:?} {:?}", placed, edits);
        prop_assert_eq!(design.forest, before);
    }

    /// Grafting turned by r, then turned by 4 − r from there, and mirrored twice, is grafting as it is.
    #[test]
    fn turning_there_and_back_is_the_identity(mut design in grown_designs(40), mut dice in dice(60)) {
        let (selection, mirrors) = (region(&design, &mut dice), Mirrors::new(&design.catalogue));
        let lifted = lift(&design.mesh, &design.forest, &selection, Viewpoint::Anywhere, &mirrors);
        let Ok(lifted) = lifted else { return Ok(()) };
        let turn = turned(&mut dice);
        let Ok(moved) = lifted.patch.oriented(turn, &mirrors) else { return Ok(()) };
        prop_assert_eq!(moved.oriented(turn.inverse(), &mirrors), Ok(lifted.patch.clone()));
        // On any place of any mesh.
        let here = frame(&design, &mut dice);
        let mut other = design.clone();
        let (straight, edits) = grafted(&mut design, &lifted.patch, here);
        let there = Frame { orientation: here.orientation.after(turn.inverse()), ..here };
        let (around, _) = grafted(&mut other, &moved, there);
        if straight.skipped.iter().chain(&around.skipped).all(|skip| skip.why != Why::Twice) {
            prop_assert_eq!(&other.forest, &design.forest);
            prop_assert_eq!(BTreeSet::from_iter(straight.faces), BTreeSet::from_iter(around.faces));
        }
        Edit::apply_all(&Edit::invert_all(&edits), &mut design.forest).expect("a graft is undone");
    }

    /// What is lifted does not tell how cells and corners are numbered.
    #[test]
    fn the_same_region_is_the_same_patch(design in grown_designs(40), mut dice in dice(200)) {
        let mirrors = Mirrors::new(&design.catalogue);
        let anchor = dice.below(design.anchors.len() as u32) as usize;
        let rings = dice.between(1, 2);
        let anchored = dice.percent(60);
        let patch = |design: &Design| {
            let vertex = design.anchors[anchor];
            let round = Selection::rings(&design.mesh, &[NodeKey::vertex(vertex)], rings, 0);
            let viewpoint = if anchored { Viewpoint::Anchor(vertex) } else { Viewpoint::Anywhere };
            lift(&design.mesh, &design.forest, &round, viewpoint, &mirrors).expect("cells at an anchor")
        };
        let (other, images) = renumbered(&design, &mut dice);
        let (here, there) = (patch(&design), patch(&other));
        prop_assert_eq!(&here.patch, &there.patch);
        prop_assert_eq!(here.left_out.len(), there.left_out.len());
        prop_assert_eq!(images.len(), design.mesh.faces().len());
    }

    /// A graft leaves other cells alone, is undone by its inverse, and what it skips it says.
    #[test]
    fn grafts_touch_their_cells_only(
        design in grown_designs(30), mut other in grown_designs(30), mut dice in dice(60)
    ) {
        let (selection, mirrors) = (region(&design, &mut dice), Mirrors::new(&design.catalogue));
        let lifted = lift(&design.mesh, &design.forest, &selection, Viewpoint::Anywhere, &mirrors);
        let Ok(lifted) = lifted else { return Ok(()) };
        // Another mesh, the same types.
        other.catalogue = design.catalogue.clone();
        other.method = design.method;
        other.forest = Forest::new(other.forest.top_level(), Content::QUAD);
        let before = other.forest.clone();
        let here = frame(&other, &mut dice);
        let (placed, mut edits) = grafted(&mut other, &lifted.patch, here);
        prop_assert_eq!(placed.faces.len() + placed.skipped.len(), lifted.patch.cells.len());
        let written: BTreeSet<u32> = placed.faces.iter().copied().collect();
        prop_assert_eq!(written.len(), placed.faces.len());
        for face in (0..before.top_level()).filter(|face| !written.contains(face)) {
            prop_assert_eq!(Tree::of(&other.forest, CellIndex(face)), Tree::of(&before, CellIndex(face)));
        }
        // What is grafted grows like any other net.
        if other.method == Method::Recursive {
            edits.extend(other.close());
        }
        match express(&other.mesh, &other.forest, &other.catalogue, other.method, &other.anchors) {
            Ok(net) => prop_assert!(net.is_valid()),
            Err(ExpressionError::Type { word, .. }) => {
                prop_assert!(false, "type {} is not allowed", word);
            }
            Err(_) => {}
        }
        Edit::apply_all(&Edit::invert_all(&edits), &mut other.forest).expect("a graft is undone");
        prop_assert_eq!(other.forest, before);
    }

    /// Round every anchor a patch finds the frame from which it was lifted, or one as good.
    #[test]
    fn patches_fit_their_own_anchor(mut design in grown_designs(30), mut dice in dice(20)) {
        let mirrors = Mirrors::new(&design.catalogue);
        let anchor = dice.pick(&design.anchors);
        let round = Selection::rings(&design.mesh, &[NodeKey::vertex(anchor)], dice.between(1, 2), 0);
        let lifted = lift(&design.mesh, &design.forest, &round, Viewpoint::Anchor(anchor), &mirrors);
        let lifted = lifted.expect("cells at an anchor");
        let best = best_frame(&design.mesh, &lifted.patch, anchor, &mirrors).expect("cells at an anchor");
        let corner = design.mesh.faces()[best.face as usize][usize::from(best.orientation.corner(0))];
        prop_assert_eq!(corner, anchor);
        prop_assert_eq!(grafted(&mut design, &lifted.patch, best).0.skipped, vec![]);
    }

    /// Walks are read as written, and only a first step leads back.
    #[test]
    fn walks_are_read_as_written(text in "[flrbx]{0,6}") {
        match Walk::parse(&text) {
            Some(walk) => prop_assert_eq!(walk.to_string(), text),
            None => prop_assert!(text.contains('x') || text.chars().skip(1).any(|step| step == 'b')),
        }
    }
}
