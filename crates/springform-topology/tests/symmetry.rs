//! Properties of symmetries: groups that carry cells to cells, edits to edits, and forests that stay symmetric.

mod common;

use common::{cases, dice, edit_dice, grown_designs, stored_cells};
use proptest::prelude::*;
use springform_topology::address::Place;
use springform_topology::base_mesh::BaseMesh;
use springform_topology::cell_type::{Catalogue, QUAD};
use springform_topology::edit::Edit;
use springform_topology::expression::express;
use springform_topology::filters::Method;
use springform_topology::forest::{Content, Forest};
use springform_topology::framework::{Arc, Framework, Grid, Join, Part, Shape, Side};
use springform_topology::orientation::Mirrors;
use springform_topology::symmetry::{MOST, Orbits, Symmetry, SymmetryError, edits_of_orbits, symmetries};
use springform_topology::tree::Tree;
use std::collections::BTreeSet;

fn cylinder(grid: Grid, around: u32, along: u32) -> Framework {
    let part = Part { name: "tube".to_owned(), shape: Shape::Cylinder, around, along };
    Framework { grid, parts: vec![part], joins: Vec::new() }
}

fn mesh(framework: &Framework) -> BaseMesh {
    BaseMesh::from_framework(framework).expect("a framework")
}

fn ring(mesh: &BaseMesh, side: Side, step: usize) -> Vec<u32> {
    let border = mesh.borders().iter().find(|border| border.side == side).expect("a cylinder's ring");
    border.vertices.iter().copied().step_by(step).collect()
}

#[test]
fn a_cylinder_has_its_rotations_and_mirrors() {
    for grid in [Grid::Quad, Grid::Dia] {
        let mesh = mesh(&cylinder(grid, 8, 4));
        let count = |anchors: &[u32]| symmetries(&mesh, anchors).expect("few").len();
        assert_eq!(count(&[]), 32, "8 rotations, mirrored or not, upside down or not");
        let start = ring(&mesh, Side::Start, 1);
        assert_eq!(count(&start), 16, "one ring only is anchored");
        assert_eq!(count(&ring(&mesh, Side::Start, 2)), 8);
        assert_eq!(count(&start[..1]), 2, "one mirror keeps one anchor");
        let both: Vec<u32> = [ring(&mesh, Side::Start, 2), ring(&mesh, Side::End, 2)].concat();
        assert_eq!(count(&both), 16);
    }
}

#[test]
fn three_sheets_on_one_edge_can_be_exchanged() {
    let part = |name: &str| Part { name: name.to_owned(), shape: Shape::Sheet, around: 3, along: 2 };
    let arc = |part| Arc { part, side: Side::Start, start: 0, length: 3 };
    let join = |second| Join { first: arc(0), second: arc(second), reversed: false, cord: true };
    let framework = Framework {
        grid: Grid::Quad,
        parts: ["a", "b", "c"].map(part).into(),
        joins: vec![join(1), join(2)],
    };
    // Six orders of the sheets, mirrored or not.
    assert_eq!(symmetries(&mesh(&framework), &[]).expect("few").len(), 12);
}

#[test]
fn loose_parts_have_too_many_symmetries() {
    let part = |name: &str| Part { name: name.to_owned(), shape: Shape::Cylinder, around: 40, along: 1 };
    let parts = ["a", "b", "c"].map(part).into();
    let framework = Framework { grid: Grid::Quad, parts, joins: Vec::new() };
    assert_eq!(symmetries(&mesh(&framework), &[]), Err(SymmetryError::TooMany));
    assert!(MOST < 80usize.pow(3));
}

#[test]
fn a_type_without_mirror_image_is_refused_where_cells_are_mirrored() {
    let mesh = mesh(&cylinder(Grid::Quad, 4, 2));
    let mut catalogue = Catalogue::default();
    let hook = catalogue.define("hook", &["c0-m1".to_owned()], true, false).expect("a type");
    let group = symmetries(&mesh, &[]).expect("few");
    let types = BTreeSet::from([hook]);
    let orbits = Orbits::new(&group, 8, &catalogue, &types);
    assert_eq!(orbits, Err(SymmetryError::NoMirror("hook".to_owned())));
    catalogue.define("koch", &["c0-m2".to_owned()], true, false).expect("its image");
    assert!(Orbits::new(&group, 8, &catalogue, &types).is_ok());
}

proptest! {
    #![proptest_config(cases(1000))]

    /// Symmetries are a group that keeps the mesh: neighbours stay neighbours, anchors anchors.
    #[test]
    fn symmetries_are_a_group(design in grown_designs(0), mut dice in dice(8)) {
        let mesh = &design.mesh;
        let Ok(group) = symmetries(mesh, &design.anchors) else { return Ok(()) };
        prop_assert!(group.iter().any(|one| one.is_identity()));
        let (a, b) = (&group[dice.below(group.len() as u32) as usize], &group[dice.below(group.len() as u32) as usize]);
        let composed: Vec<_> = (0..mesh.faces().len() as u32).map(|face| {
            let (first, then) = (a.of(face), b.of(a.of(face).face));
            (then.face, then.orientation.after(first.orientation))
        }).collect();
        let same = |one: &&Symmetry| {
            (0..).zip(&composed).all(|(face, to)| (one.of(face).face, one.of(face).orientation) == *to)
        };
        prop_assert!(group.iter().find(same).is_some());
        let anchors: BTreeSet<u32> = design.anchors.iter().copied().collect();
        for face in 0..mesh.faces().len() as u32 {
            let to = a.of(face);
            for k in 0..4u8 {
                let (vertex, image) = (mesh.faces()[face as usize][usize::from(k)],
                    mesh.faces()[to.face as usize][usize::from(to.orientation.corner(k))]);
                prop_assert_eq!(anchors.contains(&vertex), anchors.contains(&image));
                prop_assert_eq!(mesh.faces_at_vertex(vertex).len(), mesh.faces_at_vertex(image).len());
            }
        }
    }

    /// The images of a cell are where the group carries it; the first stands for all, and what is done to it is done
    /// to all.
    #[test]
    fn orbits_hold_all_images(design in grown_designs(25), mut dice in dice(8)) {
        let Ok(group) = symmetries(&design.mesh, &design.anchors) else { return Ok(()) };
        let faces = design.forest.top_level();
        let Ok(orbits) = Orbits::new(&group, faces, &design.catalogue, &BTreeSet::new()) else { return Ok(()) };
        let (top, first) = (Place::top(dice.below(faces)), dice.below(4) as u8);
        for place in [top, top.child(first), top.child(first).child(dice.below(4) as u8)] {
            let images: BTreeSet<Place> = group.iter().map(|one| one.place(place)).collect();
            prop_assert_eq!(orbits.images(place), Vec::from_iter(images.iter().copied()));
            let first = images.iter().min_by_key(|image| (image.face, Vec::from_iter(image.path())));
            prop_assert_eq!(Some(&orbits.representative(place)), first);
            prop_assert_eq!(orbits.represents(place), first == Some(&place));
        }
        let mut forest = Forest::new(faces, Content::QUAD);
        for level in 0..3 {
            let mut places = Vec::new();
            forest.visit_reachable(|_, place| places.extend((place.level == level).then_some(place)));
            let place = orbits.representative(places[dice.below(places.len() as u32) as usize]);
            let divide = Edit::Subdivide { cell: place, children: [Content::QUAD; 4] };
            prop_assert_eq!(divide.apply(&mut forest), Ok(()));
            prop_assert_eq!(orbits.symmetrise(&mut forest, [place.face], &mut Vec::new()), Ok(()));
            for image in orbits.images(place) {
                let cell = forest.find(image).expect("an image of a cell");
                prop_assert!(forest.children(cell).is_some(), "{image} is divided as {place} is");
            }
        }
    }

    /// A forest that is made symmetric is so, stays so under edits of whole orbits and under closing, and gives as
    /// many springs round every image.
    #[test]
    fn symmetric_forests_stay_symmetric(mut design in grown_designs(25), edits in edit_dice(4)) {
        let mesh = design.mesh.clone();
        let Ok(group) = symmetries(&mesh, &design.anchors) else { return Ok(()) };
        let types = design.catalogue.ids().collect();
        let faces = design.forest.top_level();
        let Ok(orbits) = Orbits::new(&group, faces, &design.catalogue, &types) else { return Ok(()) };
        let mut forest = Forest::new(faces, Content::QUAD);
        std::mem::swap(&mut forest, &mut design.forest);
        // Without overrides, which symmetrising leaves alone.
        let mut plain = Forest::new(faces, Content::QUAD);
        for face in 0..faces {
            let tree = Tree::of(&forest, forest.top(face));
            tree.write_over(&mut plain, Place::top(face), &mut Vec::new()).expect("fits");
        }
        orbits.symmetrise(&mut plain, 0..faces, &mut Vec::new()).expect("symmetrises");
        prop_assert_eq!(orbits.check(&mesh, &plain, &group), Ok(()));
        let mut again = Vec::new();
        orbits.symmetrise(&mut plain, 0..faces, &mut again).expect("symmetrises");
        design.forest = plain;
        for mut dice in edits {
            let edit = design.random_edit(&mut dice);
            let all = edits_of_orbits(&mesh, &group, &[edit], &design.catalogue);
            let Ok(all) = all else { continue };
            let before = design.forest.clone();
            // Turns that make no difference may make an image of a retype or merge refuse.
            if Edit::apply_all(&all, &mut design.forest).is_err() {
                prop_assert_eq!(&design.forest, &before);
                continue;
            }
            prop_assert_eq!(orbits.check(&mesh, &design.forest, &group), Ok(()));
        }
        if design.method == Method::Recursive {
            design.close();
            prop_assert_eq!(orbits.check(&mesh, &design.forest, &group), Ok(()));
        }
        for (_, place) in stored_cells(&design.forest) {
            let images: BTreeSet<_> = group.iter().map(|one| one.place(place)).collect();
            prop_assert_eq!(images.iter().filter(|&&image| orbits.represents(image)).count(), 1);
        }
        let Ok(net) = express(&mesh, &design.forest, &design.catalogue, design.method, &design.anchors) else { return Ok(()) };
        let mirrors = Mirrors::new(&design.catalogue);
        prop_assert!(mirrors.image(QUAD).is_some());
        for one in &group {
            for (at, cell) in net.cells.iter().enumerate() {
                let image = one.place(cell.place);
                let other = net.cells.iter().position(|other| other.place == image).expect("its image is expressed");
                prop_assert_eq!(net.cell_springs.of(at as u32).len(), net.cell_springs.of(other as u32).len());
            }
            for &node in &net.nodes {
                prop_assert!(net.node(one.node(&mesh, node)).is_some());
            }
        }
    }
}
