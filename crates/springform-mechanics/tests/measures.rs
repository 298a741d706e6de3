//! Measures against hand computation, and what holds for the measures of every net.

mod nets;

use nets::common::cases;
use nets::{Net, nets, point};
use proptest::collection::vec;
use proptest::prelude::*;
use springform_mechanics::assembly::{SpringLaw, assemble, embed};
use springform_mechanics::equilibrium::{Equilibrium, Settings, solve};
use springform_mechanics::measures::{Measures, apertures, inner_forces, spring_utilization};
use springform_mechanics::network::Network;
use springform_mechanics::vector::{Vector, add, cross, dot, length, scale};
use springform_topology::address::Place;
use springform_topology::base_mesh::BaseMesh;
use springform_topology::cell_type::{Catalogue, CellTypeId};
use springform_topology::edit::Edit;
use springform_topology::expression::{Expression, express};
use springform_topology::filters::Method;
use springform_topology::forest::{Content, Forest};
use springform_topology::framework::{Framework, Grid, Part, Shape, Side};
use std::f64::consts::PI;

fn part(shape: Shape, around: u32, along: u32) -> BaseMesh {
    let part = Part { name: "p".to_owned(), shape, around, along };
    let framework = Framework { grid: Grid::Quad, parts: vec![part], joins: vec![] };
    BaseMesh::from_framework(&framework).expect("a valid part")
}

/// A mesh of cells of one content at equilibrium under the default law.
fn hung(
    mesh: &BaseMesh,
    forest: &Forest,
    anchors: &[u32],
    positions: Vec<Vector>,
) -> (Expression, Network<'static>, Equilibrium) {
    let expression = express(mesh, forest, &Catalogue::default(), Method::Dynamic, anchors).expect("a net");
    let embedding = embed(mesh, anchors, positions);
    let network = assemble(&expression, &embedding, SpringLaw::default());
    let equilibrium = solve(&network, &Settings::default());
    (expression, network, equilibrium)
}

/// Measures and inner forces of four cells hung by the corners of a square of 2 m.
fn four_cells() -> (Measures, Vec<f64>) {
    let mesh = part(Shape::Sheet, 2, 2);
    let forest = Forest::new(4, Content::QUAD);
    let corners = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [2.0, 2.0, 0.0]];
    let (expression, network, equilibrium) = hung(&mesh, &forest, &[0, 2, 6, 8], corners);
    let measures = Measures::new(&expression, &network, &equilibrium.positions, &equilibrium.forces);
    (measures, inner_forces(&expression, &equilibrium.forces))
}

fn measured(net: &Net) -> (Equilibrium, Measures) {
    let equilibrium = solve(&net.network, &Settings::default());
    let measures = Measures::new(&net.expression, &net.network, &equilibrium.positions, &equilibrium.forces);
    (equilibrium, measures)
}

#[track_caller]
fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{found} instead of {expected}");
}

proptest! {
    #![proptest_config(cases(1500))]

    /// Definitions, computed again from positions, forces and owners.
    #[test]
    fn measures_follow_their_definitions(net in nets(20)) {
        let (equilibrium, measures) = measured(&net);
        let forces = &equilibrium.forces;
        let lengths = net.network.lengths(&equilibrium.positions);
        let near = |found: f64, expected: f64| (found - expected).abs() <= 1e-9 * expected.abs() + 1e-12;
        prop_assert_eq!(measures.springs as usize, forces.len());
        prop_assert_eq!(measures.nodes as usize, net.expression.nodes.len());
        prop_assert_eq!(measures.cells as usize, net.expression.cells.len());
        let mut sorted = forces.clone();
        sorted.sort_by(f64::total_cmp);
        let (least, most) = (sorted[0], sorted[sorted.len() - 1]);
        prop_assert_eq!((measures.force_min, measures.force_max), (least, most));
        prop_assert_eq!(measures.force_differential.is_some(), least >= 1e-12 * most);
        prop_assert!(measures.force_differential.is_none_or(|found| near(found, most / least)));
        prop_assert!(near(measures.force_range, most - least));
        let mean = sorted.iter().sum::<f64>() / sorted.len() as f64;
        let squares: f64 = sorted.iter().map(|force| (force - mean) * (force - mean)).sum();
        let deviation = (squares / sorted.len() as f64).sqrt();
        prop_assert!(near(measures.force_mean, mean));
        prop_assert!((measures.force_deviation - deviation).abs() <= 1e-7 * most);
        prop_assert!(near(measures.force_variation, measures.force_deviation / mean));
        prop_assert!(near(measures.total_length, lengths.iter().sum()));
        prop_assert!(near(measures.load_path, lengths.iter().zip(forces).map(|(l, f)| l * f).sum()));
        prop_assert_eq!(measures.shortest_spring, lengths.iter().copied().fold(f64::INFINITY, f64::min));
        prop_assert!(measures.area >= 0.0);
        prop_assert!(
            measures.area == 0.0 || near(measures.length_per_area, measures.total_length / measures.area)
        );
    }

    /// Inner forces count every spring once for each of its cells.
    #[test]
    fn inner_forces_share_springs(net in nets(20)) {
        let (equilibrium, _) = measured(&net);
        let total: f64 = inner_forces(&net.expression, &equilibrium.forces).into_iter().sum();
        let owners = |spring: usize| net.expression.spring_cells.of(spring as u32).len() as f64;
        let expected: f64 =
            equilibrium.forces.iter().enumerate().map(|(spring, force)| force * owners(spring)).sum();
        prop_assert!((total - expected).abs() <= 1e-9 * expected);
    }

    /// A larger net of the same form: lengths grow by the factor, areas by its square, ratios stay.
    #[test]
    fn measures_scale(net in nets(12), factor in 0.01..100.0f64) {
        let (_, small) = measured(&net);
        let mut larger = net.clone();
        for position in larger.network.positions.to_mut() {
            *position = scale(*position, factor);
        }
        let (_, large) = measured(&larger);
        let near = |found: f64, expected: f64| (found - expected).abs() <= 1e-7 * expected.abs();
        prop_assert!(near(large.total_length, factor * small.total_length));
        prop_assert!(near(large.load_path, factor * factor * small.load_path));
        prop_assert!(
            (large.area - factor * factor * small.area).abs() <= 1e-7 * (factor * net.extent()).powi(2)
        );
        if let (Some(small), Some(large)) = (small.force_differential, large.force_differential) {
            prop_assert!(small > 1e6 || near(large, small));
        }
    }

    /// Apertures run along the cords of the rings, whatever the levels of the cells there.
    #[test]
    fn apertures_follow_the_cords(around in 3u32..9, divided in vec((0u32..9, 0u8..4), 0..12)) {
        let mesh = part(Shape::Cylinder, around, 1);
        let mut forest = Forest::new(around, Content::QUAD);
        for (face, child) in divided {
            let mut cell = Place::top(face % around);
            while forest.find(cell).is_some_and(|index| forest.children(index).is_some()) {
                cell = cell.child(child);
            }
            Edit::Subdivide { cell, children: [Content::QUAD; 4] }.apply(&mut forest).expect("it fits");
        }
        let anchors = [0, 1, around, around + 1];
        let positions = vec![[0.0, 0.0, 0.0], [2.0, 0.5, 0.0], [0.0, 0.0, 3.0], [0.5, 2.0, 3.0]];
        let (expression, network, equilibrium) = hung(&mesh, &forest, &anchors, positions);
        let lengths = network.lengths(&equilibrium.positions);
        let rings = expression.springs.iter().zip(&lengths).filter(|(spring, _)| spring.ring);
        let cords: f64 = rings.map(|(_, length)| length).sum();
        let openings = apertures(&mesh, &expression, &equilibrium.positions);
        let perimeters: f64 = openings.iter().map(|opening| opening.perimeter).sum();
        prop_assert!((perimeters - cords).abs() <= 1e-9 * cords, "{perimeters} against {cords}");
    }

    /// The apertures of a cylinder between two regular polygons are those polygons.
    #[test]
    fn apertures_of_regular_polygons(
        around in 3u32..40, radius in 0.1..10.0f64, axis in point(), centre in point(),
    ) {
        prop_assume!(length(axis) > 0.5);
        let normal = scale(axis, 1.0 / length(axis));
        let aside = if normal[0].abs() < 0.7 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let right = cross(normal, aside);
        let right = scale(right, 1.0 / length(right));
        let up = cross(normal, right);
        let count = f64::from(around);
        let on_ring = |k: u32, height: f64| {
            let angle = 2.0 * PI * f64::from(k) / count;
            let spoke = add(scale(right, radius * angle.cos()), scale(up, radius * angle.sin()));
            add(add(centre, spoke), scale(normal, height))
        };
        let mesh = part(Shape::Cylinder, around, 1);
        let anchors: Vec<u32> = (0..2 * around).collect();
        let positions = anchors.iter().map(|&k| on_ring(k % around, f64::from(k / around))).collect();
        let forest = Forest::new(around, Content::QUAD);
        let (expression, _, equilibrium) = hung(&mesh, &forest, &anchors, positions);
        let found = apertures(&mesh, &expression, &equilibrium.positions);
        prop_assert_eq!(
            found.iter().map(|opening| opening.side).collect::<Vec<_>>(), vec![Side::Start, Side::End]
        );
        for opening in found {
            prop_assert_eq!(&opening.part, "p");
            prop_assert!(
                (opening.perimeter - 2.0 * count * radius * (PI / count).sin()).abs() <= 1e-9 * radius
            );
            let area = 0.5 * count * radius * radius * (2.0 * PI / count).sin();
            prop_assert!((opening.area - area).abs() <= 1e-9 * radius * radius);
            prop_assert!((dot(opening.normal, normal) - 1.0).abs() <= 1e-9);
        }
    }
}

#[test]
fn four_cells_by_hand() {
    // Middles of the sides: 3 y = 0 + 0 + 1. So eight springs of √10/3 along the sides and four of 2/3
    // inside.
    let (measures, inner) = four_cells();
    let (long, short) = (10f64.sqrt() / 3.0, 2.0 / 3.0);
    assert_eq!((measures.springs, measures.nodes, measures.cells), (12, 9, 4));
    close(measures.force_differential.expect("all springs carry force"), 10f64.sqrt() / 2.0);
    close(measures.force_min, short);
    close(measures.force_max, long);
    close(measures.force_range, long - short);
    let mean = (8.0 * long + 4.0 * short) / 12.0;
    close(measures.force_mean, mean);
    // Two thirds of the springs lie (long − mean) off, one third twice as far: σ = √2/3 (long − short).
    close(measures.force_deviation, 2f64.sqrt() / 3.0 * (long - short));
    close(measures.force_variation, measures.force_deviation / mean);
    close(measures.total_length, 8.0 * long + 4.0 * short);
    close(measures.load_path, 8.0 * 10.0 / 9.0 + 4.0 * 4.0 / 9.0);
    close(measures.area, 8.0 / 3.0);
    close(measures.shortest_spring, short);
    close(measures.length_per_area, measures.total_length * 3.0 / 8.0);
    for force in inner {
        close(force, 2.0 * long + 2.0 * short);
    }
}

#[test]
fn a_void_has_no_area_and_owns_no_springs() {
    let mesh = part(Shape::Sheet, 3, 3);
    let measured = |kind: u8| {
        let mut forest = Forest::new(9, Content::QUAD);
        let to = Content { kind: CellTypeId(kind), turn: 0 };
        let edit = Edit::Retype { cell: Place::top(4), from: Content::QUAD, to };
        edit.apply(&mut forest).expect("an edit that fits");
        let corners = vec![[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0], [3.0, 3.0, 0.0]];
        let (expression, network, equilibrium) = hung(&mesh, &forest, &[0, 3, 12, 15], corners);
        let measures = Measures::new(&expression, &network, &equilibrium.positions, &equilibrium.forces);
        (measures, inner_forces(&expression, &equilibrium.forces)[4])
    };
    let ((whole, inner), (holed, nothing)) = (measured(1), measured(0));
    // Neighbours give the springs around the void: it stays a square of the springs' length.
    assert_eq!(holed.springs, whole.springs);
    assert_eq!(nothing, 0.0);
    close(whole.area - holed.area, (inner / 4.0).powi(2));
}

#[test]
fn utilization_is_differential_gained_per_spring_gained() {
    let (measures, _) = four_cells();
    let gained = 10f64.sqrt() / 2.0;
    close(spring_utilization(&measures, (Some(0.0), 0)).expect("defined"), gained / 12.0);
    close(spring_utilization(&measures, (Some(1.0), 4)).expect("defined"), (gained - 1.0) / 8.0);
    close(spring_utilization(&measures, (Some(2.0), 11)).expect("defined"), gained - 2.0);
    for undefined in [(Some(1.0), 12), (Some(1.0), 13), (None, 4)] {
        assert_eq!(spring_utilization(&measures, undefined), None);
    }
    let vanishing = Measures { force_differential: None, ..measures };
    assert_eq!(spring_utilization(&vanishing, (Some(1.0), 4)), None);
}

#[test]
fn a_spring_that_carries_nothing_leaves_the_differential_undefined() {
    // Corners c0 and c2 stand at one point: the diagonal has no length.
    let mesh = part(Shape::Sheet, 1, 1);
    let forest = Forest::new(1, Content { kind: CellTypeId(3), turn: 0 });
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3]];
    let (expression, network, equilibrium) = hung(&mesh, &forest, &[0, 1, 2, 3], positions);
    let measures = Measures::new(&expression, &network, &equilibrium.positions, &equilibrium.forces);
    assert_eq!((measures.force_min, measures.force_differential), (0.0, None));
}
