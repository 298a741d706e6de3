//! Properties of selections: sets of squares in one form, whatever they were made of, grown and shrunk.

mod common;

use common::{Dice, cases, dice, grown_designs};
use proptest::prelude::*;
use springform_topology::MAX_LEVEL;
use springform_topology::address::Place;
use springform_topology::base_mesh::BaseMesh;
use springform_topology::framework::{Framework, Grid, Part, Shape};
use springform_topology::node_key::NodeKey;
use springform_topology::selection::{Selection, lattice_places, squares_at};
use std::collections::BTreeSet;

const FACES: u32 = 3;
const FINEST: u8 = 3;

fn place(dice: &mut Dice) -> Place {
    let level = dice.below(u32::from(FINEST) + 1);
    (0..level).fold(Place::top(dice.below(FACES)), |place, _| place.child(dice.below(4) as u8))
}

fn places(dice: &mut Dice) -> Vec<Place> {
    (0..dice.below(12)).map(|_| place(dice)).collect()
}

/// The finest squares that some places cover.
fn squares(places: impl IntoIterator<Item = Place>) -> BTreeSet<Place> {
    let mut covered = BTreeSet::new();
    let mut open: Vec<Place> = places.into_iter().collect();
    while let Some(place) = open.pop() {
        if place.level == FINEST {
            covered.insert(place);
        } else {
            open.extend((0..4).map(|k| place.child(k)));
        }
    }
    covered
}

proptest! {
    #![proptest_config(cases(1500))]

    /// Uniting, subtracting and intersecting regions is what it is for the squares they cover.
    #[test]
    fn selections_are_sets_of_squares(mut dice in dice(200)) {
        let (a, b) = (places(&mut dice), places(&mut dice));
        let (left, right) = (squares(a.clone()), squares(b.clone()));
        let (a, b) = (Selection::new(a), Selection::new(b));
        let covered = |selection: &Selection| squares(selection.places());
        prop_assert_eq!(covered(&a.union(&b)), &left | &right);
        prop_assert_eq!(covered(&a.difference(&b)), &left - &right);
        prop_assert_eq!(covered(&a.intersection(&b)), &left & &right);
        // One form: whatever covers the same is the same.
        prop_assert_eq!(&Selection::new(left.iter().copied()), &a);
        prop_assert_eq!(a.union(&b).difference(&b.difference(&a)), a.clone());
        let probe = place(&mut dice);
        prop_assert_eq!(a.contains(probe), squares([probe]).is_subset(&left));
        prop_assert_eq!(a.is_empty(), left.is_empty());
    }

    /// Growing by one ring takes in what touches; shrinking is growing what is left out, but for the border.
    #[test]
    fn growing_and_shrinking_are_each_others_other_side(design in grown_designs(6), mut dice in dice(30)) {
        let mesh = &design.mesh;
        let faces = mesh.faces().len() as u32;
        let all = Selection::all(mesh);
        let level = dice.below(3) as u8;
        let chosen = (0..dice.between(1, 4)).map(|_| {
            (0..level).fold(Place::top(dice.below(faces)), |place, _| place.child(dice.below(4) as u8))
        });
        let selection = Selection::new(chosen.collect::<Vec<_>>());
        let times = dice.below(3);
        let grown = selection.grown(mesh, times, level);
        prop_assert_eq!(grown.intersection(&selection), selection.clone());
        prop_assert_eq!(
            all.difference(&selection).shrunk(mesh, times, level), all.difference(&grown)
        );
        prop_assert_eq!(all.shrunk(mesh, times, level), all.clone());
        prop_assert_eq!(all.grown(mesh, times, level), all.clone());
        let twice = selection.grown(mesh, 1, level).grown(mesh, 1, level);
        prop_assert_eq!(selection.grown(mesh, 2, level), twice);
    }

    /// The first ring round a vertex are the cells at it; a forest's cells in a region are found at all levels.
    #[test]
    fn rings_lie_round_their_node(design in grown_designs(20), mut dice in dice(8)) {
        let mesh = &design.mesh;
        let vertex = dice.below(mesh.vertex_count());
        let node = [NodeKey::vertex(vertex)];
        let ring = Selection::rings(mesh, &node, 1, 0);
        let at: BTreeSet<u32> = mesh.faces_at_vertex(vertex).iter().copied().collect();
        prop_assert_eq!(ring.faces(), at);
        prop_assert_eq!(Selection::rings(mesh, &node, 2, 0), ring.grown(mesh, 1, 0));
        prop_assert_eq!(Selection::rings(mesh, &node, 0, 0), Selection::default());
        let fine = Selection::rings(mesh, &node, 1, MAX_LEVEL);
        prop_assert_eq!(fine.places().count(), mesh.faces_at_vertex(vertex).len());
        let cells = ring.expressed(&design.forest);
        prop_assert!(cells.iter().all(|&cell| ring.contains(cell)));
        prop_assert_eq!(&Selection::new(cells), &ring);
        prop_assert!(squares_at(mesh, node[0], 0).iter().all(|square| ring.contains(*square)));
    }
}

fn cylinder(grid: Grid) -> BaseMesh {
    let part = Part { name: "tube".to_owned(), shape: Shape::Cylinder, around: 6, along: 4 };
    BaseMesh::from_framework(&Framework { grid, parts: vec![part], joins: Vec::new() }).expect("a cylinder")
}

#[test]
fn columns_run_on_round_a_cylinder() {
    let mesh = cylinder(Grid::Quad);
    let some = Selection::lattice(&mesh, 0, [4, 1], [1, 2]);
    assert_eq!(some.to_string(), "6 + 7 + 10 + 11 + 12 + 13 + 16 + 17");
    assert_eq!(Selection::lattice(&mesh, 0, [0, 5], [0, 3]), Selection::all(&mesh));
    assert_eq!(Selection::lattice(&mesh, 1, [0, 5], [0, 3]).to_string(), "none");
}

#[test]
fn every_diamond_has_a_column_and_a_row_of_its_own() {
    let mesh = cylinder(Grid::Dia);
    let places: BTreeSet<_> = lattice_places(&mesh).into_iter().collect();
    assert_eq!(places.len(), mesh.faces().len());
    assert!(places.iter().all(|place| place.column < 6 && place.row <= 4));
}

#[test]
fn a_region_of_the_map_holds_the_cells_whose_centre_is_in_it() {
    let mesh = cylinder(Grid::Quad);
    let forest = springform_topology::forest::Forest::new(24, springform_topology::forest::Content::QUAD);
    let unit = 1i64 << Selection::MAP_BITS;
    let half = unit / 2;
    let some = Selection::on_map(&mesh, &forest, 0, [half, unit + half, half, half]);
    assert_eq!(some.to_string(), "0 + 1");
    let none = Selection::on_map(&mesh, &forest, 0, [half + 1, unit, 0, 4 * unit]);
    assert!(none.is_empty());
}
