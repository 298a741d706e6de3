//! Properties of nets without rest lengths: balance, uniqueness, symmetry, bounds, closed forms.

mod nets;

use nets::common::cases;
use nets::{Net, eliminate, largest_distance, nets, point, unit_network};
use proptest::collection::vec;
use proptest::prelude::*;
use springform_mechanics::assembly::{SpringLaw, assemble, embed};
use springform_mechanics::equilibrium::implicit_euler::{self, Motion};
use springform_mechanics::equilibrium::{Settings, Status, residuals, solve};
use springform_mechanics::network::{Network, NetworkError};
use springform_mechanics::vector::{Vector, add, cross, length, scale, subtract};
use springform_topology::base_mesh::BaseMesh;
use springform_topology::cell_type::Catalogue;
use springform_topology::expression::express;
use springform_topology::filters::Method;
use springform_topology::forest::{Content, Forest};
use springform_topology::framework::{Framework, Grid, Part, Shape};
use springform_topology::node_key::NodeKey;

/// Rotation about an axis by an angle (Rodrigues).
fn rotated(vector: Vector, axis: Vector, angle: f64) -> Vector {
    let unit = scale(axis, 1.0 / length(axis));
    let along: f64 = (0..3).map(|at| unit[at] * vector[at]).sum();
    let turned = add(scale(vector, angle.cos()), scale(cross(unit, vector), angle.sin()));
    add(turned, scale(unit, along * (1.0 - angle.cos())))
}

/// Free nodes by a dense system, assembled spring by spring.
fn dense_solution(network: &Network<'_>) -> Vec<Vector> {
    let free: Vec<usize> = (0..network.positions.len()).filter(|&node| !network.fixed[node][0]).collect();
    let mut matrix = vec![vec![0.0; free.len()]; free.len()];
    let mut sides: Vec<Vector> = free.iter().map(|&node| network.loads[node]).collect();
    let row = |node: u32| free.iter().position(|&known| known == node as usize);
    for (spring, &[a, b]) in network.springs.iter().enumerate() {
        let k = network.stiffness[spring];
        for (here, there) in [(a, b), (b, a)] {
            let Some(at) = row(here) else { continue };
            matrix[at][at] += k;
            match row(there) {
                Some(far) => matrix[at][far] -= k,
                None => sides[at] = add(sides[at], scale(network.positions[there as usize], k)),
            }
        }
    }
    let mut positions = network.positions.to_vec();
    for (node, position) in free.iter().zip(eliminate(matrix, sides)) {
        positions[*node] = position;
    }
    positions
}

fn solved(network: &Network<'_>) -> Vec<Vector> {
    let equilibrium = solve(network, &Settings::default());
    assert_eq!(equilibrium.status, Status::Converged, "residual {:.3e}", equilibrium.residual);
    equilibrium.positions
}

/// The net with its anchors elsewhere.
fn with_anchors(net: &Net, place: impl Fn(Vector) -> Vector) -> Network<'static> {
    let mut network = net.network.clone();
    for &anchor in &net.expression.anchors {
        let position = &mut network.positions.to_mut()[anchor as usize];
        *position = place(*position);
    }
    network
}

proptest! {
    #![proptest_config(cases(1500))]

    /// Every net converges to 1e-9 of the mean force, all springs in tension, with or without loads.
    #[test]
    fn residuals_are_within_tolerance(net in nets(24), loads in vec(point(), 7), loaded: bool) {
        let mut network = net.network.clone();
        if loaded {
            let count = network.positions.len();
            network.loads = (0..count).map(|node| loads[node % loads.len()]).collect::<Vec<_>>().into();
        }
        prop_assert_eq!(network.check(), Ok(()));
        let equilibrium = solve(&network, &Settings::default());
        prop_assert_eq!(equilibrium.status, Status::Converged);
        prop_assert!(equilibrium.residual <= 1e-9);
        let mean = equilibrium.forces.iter().sum::<f64>() / equilibrium.forces.len() as f64;
        let largest = residuals(&network, &equilibrium.positions).into_iter().map(length).fold(0.0, f64::max);
        prop_assert!(largest <= 1e-9 * mean);
        for (spring, &[a, b]) in network.springs.iter().enumerate() {
            let along = subtract(equilibrium.positions[b as usize], equilibrium.positions[a as usize]);
            let force = network.stiffness[spring] * length(along);
            prop_assert!((equilibrium.forces[spring] - force).abs() <= 1e-12 * force);
        }
        for &anchor in &net.expression.anchors {
            prop_assert_eq!(equilibrium.positions[anchor as usize], network.positions[anchor as usize]);
        }
    }

    /// Dense elimination gives the same positions.
    #[test]
    fn agrees_with_dense_elimination(net in nets(8)) {
        prop_assume!(net.network.positions.len() <= 120);
        let distance = largest_distance(&solved(&net.network), &dense_solution(&net.network));
        prop_assert!(distance <= 1e-9 * net.extent(), "{distance:e}");
    }

    /// Where nodes start changes not a bit.
    #[test]
    fn starts_do_not_matter(net in nets(24), elsewhere in vec(point(), 13)) {
        let mut moved = net.network.clone();
        for node in (0..moved.positions.len()).filter(|&node| !net.network.fixed[node][0]) {
            moved.positions.to_mut()[node] = elsewhere[node % elsewhere.len()];
        }
        let (first, second) =
            (solve(&net.network, &Settings::default()), solve(&moved, &Settings::default()));
        prop_assert_eq!(first.positions, second.positions);
        prop_assert_eq!(first.forces, second.forces);
    }

    /// Turned, moved and scaled anchors give the turned, moved and scaled net.
    #[test]
    fn nets_follow_their_anchors(
        net in nets(24), axis in point(), angle in 0.0..6.3f64, shift in point(), factor in 0.01..100.0f64
    ) {
        prop_assume!(length(axis) > 0.1);
        let place = |position: Vector| add(scale(rotated(position, axis, angle), factor), shift);
        let expected: Vec<Vector> = solved(&net.network).into_iter().map(place).collect();
        let found = solved(&with_anchors(&net, place));
        let size = factor * net.extent() + length(shift);
        prop_assert!(largest_distance(&found, &expected) <= 1e-9 * size);
    }

    /// The same factor on every stiffness moves nothing.
    #[test]
    fn stiffness_has_no_unit(net in nets(24), factor in 0.001..1000.0f64) {
        let mut stiffer = net.network.clone();
        stiffer.stiffness.to_mut().iter_mut().for_each(|k| *k *= factor);
        prop_assert!(largest_distance(&solved(&stiffer), &solved(&net.network)) <= 1e-9 * net.extent());
    }

    /// Every node stays within the box of the anchors (maximum principle).
    #[test]
    fn nodes_stay_within_the_box_of_the_anchors(net in nets(24)) {
        let anchors = &net.embedding.anchor_positions;
        let rounding = 1e-10 * net.extent();
        for axis in 0..3 {
            let lowest = anchors.iter().map(|anchor| anchor[axis]).fold(f64::INFINITY, f64::min) - rounding;
            let highest =
                anchors.iter().map(|anchor| anchor[axis]).fold(f64::NEG_INFINITY, f64::max) + rounding;
            for position in solved(&net.network) {
                prop_assert!((lowest..=highest).contains(&position[axis]));
            }
        }
    }

    /// The same net solved twice gives the same bits.
    #[test]
    fn solving_is_deterministic(net in nets(24)) {
        prop_assert_eq!(solve(&net.network, &Settings::default()), solve(&net.network, &Settings::default()));
    }

    /// Springs in a row share the way by their stiffness; alike, they space their nodes evenly.
    #[test]
    fn chains_share_the_way_by_stiffness(
        stiffness in vec(0.1..10.0f64, 1..60), end in point(), uniform: bool,
    ) {
        prop_assume!(length(end) > 0.1);
        let count = stiffness.len();
        let springs = (0..count as u32).map(|node| [node, node + 1]).collect();
        let mut positions = vec![[1.0, -2.0, 3.0]; count + 1];
        positions[0] = [0.0; 3];
        positions[count] = end;
        let mut chain = unit_network(positions, springs, &[0, count]);
        if !uniform {
            chain.stiffness = stiffness.into();
        }
        let way: Vec<f64> = chain.stiffness.iter().map(|k| 1.0 / k).collect();
        let whole: f64 = way.iter().sum();
        let mut passed = 0.0;
        for (spring, position) in solved(&chain).into_iter().skip(1).enumerate() {
            passed += way[spring];
            prop_assert!(length(subtract(position, scale(end, passed / whole))) <= 1e-9 * length(end));
        }
    }

    /// A sheet whose rim lies on a hyperbolic paraboloid is one inside: every node bilinear, the total force
    /// that of straight lines.
    #[test]
    fn sheets_on_a_bilinear_rim_are_bilinear(
        across in 1u32..9, along in 1u32..9, corners in vec(point(), 4),
    ) {
        let part = Part { name: "s".to_owned(), shape: Shape::Sheet, around: across, along };
        let framework = Framework { grid: Grid::Quad, parts: vec![part], joins: vec![] };
        let mesh = BaseMesh::from_framework(&framework).expect("a valid sheet");
        let bilinear = |i: f64, j: f64| {
            let row = |a: Vector, b: Vector| add(scale(a, 1.0 - i), scale(b, i));
            add(scale(row(corners[0], corners[1]), 1.0 - j), scale(row(corners[3], corners[2]), j))
        };
        // Vertices are numbered row by row.
        let place = |vertex: u32| (vertex % (across + 1), vertex / (across + 1));
        let target = |vertex: u32| {
            let (i, j) = place(vertex);
            bilinear(f64::from(i) / f64::from(across), f64::from(j) / f64::from(along))
        };
        let on_rim = |vertex: &u32| {
            let (i, j) = place(*vertex);
            i == 0 || i == across || j == 0 || j == along
        };
        let anchors: Vec<u32> = (0..mesh.vertex_count()).filter(on_rim).collect();
        let forest = Forest::new(mesh.faces().len() as u32, Content::QUAD);
        let expression =
            express(&mesh, &forest, &Catalogue::default(), Method::Dynamic, &anchors).expect("a net");
        let positions = anchors.iter().map(|&vertex| target(vertex)).collect();
        let embedding = embed(&mesh, &anchors, positions);
        let network = assemble(&expression, &embedding, SpringLaw::default());
        let equilibrium = solve(&network, &Settings::default());
        let expected: Vec<Vector> = (0..mesh.vertex_count()).map(target).collect();
        prop_assert!(largest_distance(&equilibrium.positions, &expected) <= 1e-10);
        let total: f64 = network.lengths(&expected).iter().sum();
        prop_assert!((equilibrium.forces.iter().sum::<f64>() - total).abs() <= 1e-9 * total);
        // Drawn at the same place, and bilinear within every face.
        prop_assert!(largest_distance(embedding.base_positions(), &expected) <= 1e-9);
        let middle = NodeKey::at(&mesh, 0, 1 << 20, 1 << 20);
        let expected = bilinear(0.5 / f64::from(across), 0.5 / f64::from(along));
        prop_assert!(length(subtract(embedding.drawn_position(middle), expected)) <= 1e-9);
    }
}

proptest! {
    #![proptest_config(cases(1000))]

    /// Implicit Euler steps end at the same equilibrium.
    #[test]
    fn implicit_euler_agrees(net in nets(10)) {
        let moved = implicit_euler::solve(&net.network, &Settings::default(), Motion::default());
        prop_assert_eq!(
            moved.status, Status::Converged, "residual {:e} after {}", moved.residual, moved.iterations
        );
        prop_assert!(largest_distance(&moved.positions, &solved(&net.network)) <= 1e-6 * net.extent());
    }

    /// Bare networks of any springs end in a status, finite numbers and no panic.
    #[test]
    fn bare_networks_end_in_a_status(
        positions in vec(point(), 1..12),
        ends in vec((0u32..12, 0u32..12), 0..24),
        fixed in vec(0usize..12, 0..4),
    ) {
        let count = positions.len() as u32;
        let springs: Vec<[u32; 2]> =
            ends.into_iter().map(|(a, b)| [a % count, b % count]).filter(|[a, b]| a != b).collect();
        let network = unit_network(positions, springs, &fixed);
        prop_assert_eq!(network.check(), Ok(()));
        let reaches = reached(&network);
        for equilibrium in [
            solve(&network, &Settings::default()),
            implicit_euler::solve(&network, &Settings::default(), Motion::default()),
        ] {
            match equilibrium.status {
                Status::Unheld { node } => prop_assert!(!reaches[node as usize]),
                status => {
                    prop_assert!(reaches.iter().all(|&reached| reached));
                    prop_assert!(status == Status::Converged || equilibrium.residual > 1e-9);
                }
            }
            prop_assert!(equilibrium.positions.iter().flatten().all(|value| value.is_finite()));
        }
    }
}

/// Nodes that springs lead to from fixed nodes, by repeated sweeps.
fn reached(network: &Network<'_>) -> Vec<bool> {
    let mut reached: Vec<bool> = network.fixed.iter().map(|axes| axes[0]).collect();
    for _ in 0..reached.len() {
        for &[a, b] in network.springs.iter() {
            let either = reached[a as usize] || reached[b as usize];
            reached[a as usize] = either;
            reached[b as usize] = either;
        }
    }
    reached
}

#[test]
fn networks_are_checked() {
    let good = || unit_network(vec![[0.0; 3]; 2], vec![[0, 1]], &[0]);
    assert_eq!(good().check(), Ok(()));
    let mut network = good();
    network.springs.to_mut()[0] = [1, 1];
    assert_eq!(network.check(), Err(NetworkError::Spring(0)));
    network.springs.to_mut()[0] = [0, 2];
    assert_eq!(network.check(), Err(NetworkError::Spring(0)));
    let mut network = good();
    network.loads.to_mut().pop();
    assert_eq!(network.check(), Err(NetworkError::Length { name: "loads", found: 1, expected: 2 }));
    for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
        let mut network = good();
        network.stiffness.to_mut()[0] = bad;
        assert!(matches!(network.check(), Err(NetworkError::Value { name: "stiffness", index: 0, .. })));
    }
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        let mut network = good();
        network.rest_length.to_mut()[0] = bad;
        assert!(matches!(network.check(), Err(NetworkError::Value { name: "rest_length", index: 0, .. })));
    }
    let mut network = good();
    network.positions.to_mut()[1][2] = f64::NAN;
    assert!(matches!(network.check(), Err(NetworkError::Value { name: "positions", index: 1, .. })));
}

#[test]
fn an_unheld_node_is_named() {
    let network = unit_network(vec![[0.0; 3]; 4], vec![[0, 1], [2, 3]], &[0]);
    assert_eq!(solve(&network, &Settings::default()).status, Status::Unheld { node: 2 });
}

#[test]
fn anchors_in_one_point_give_a_net_in_one_point() {
    let network = unit_network(vec![[1.0, 2.0, 3.0]; 3], vec![[0, 1], [1, 2]], &[0, 2]);
    let equilibrium = solve(&network, &Settings::default());
    assert_eq!(equilibrium.status, Status::Converged);
    assert!(largest_distance(&equilibrium.positions, &[[1.0, 2.0, 3.0]; 3]) <= 1e-15);
}
