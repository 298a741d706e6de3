//! Measured curves, rods, supports, loads that follow, and workspaces: each against what defines it.

mod nets;

use nets::common::cases;
use nets::{point, unit_network};
use proptest::array::uniform3;
use proptest::collection::vec;
use proptest::prelude::*;
use springform_mechanics::curve::Curve;
use springform_mechanics::equilibrium::implicit_euler::{self, Motion};
use springform_mechanics::equilibrium::{
    Settings, Solver, Status, loads, press, reactions, residuals, solve,
};
use springform_mechanics::network::{NO_CURVE, Network, Path, Pressure, Sense, Slide};
use springform_mechanics::rod::{Bend, Rod};
use springform_mechanics::vector::{Vector, add, cross, dot, length, scale, subtract};
use springform_topology::base_mesh::Groups;

/// Test points of a cord: a part that is slack or pushes, then ever more force.
fn curves() -> impl Strategy<Value = Vec<[f64; 2]>> {
    let step = (0.01..0.3f64, prop_oneof![Just(0.0), 0.01..10.0f64]);
    (vec(step.clone(), 0..3), vec(step, 1..6), 0.01..10.0f64).prop_map(|(below, above, last)| {
        let mut points = vec![[0.0, 0.0]];
        for (strain, force) in below {
            points.insert(0, [points[0][0] - strain, points[0][1] - force]);
        }
        for (strain, force) in above {
            let end = points[points.len() - 1];
            points.push([end[0] + strain, end[1] + force]);
        }
        points.last_mut().expect("the origin")[1] += last;
        points
    })
}

fn links() -> impl Strategy<Value = [Vector; 2]> {
    (uniform3(-1.0..1.0f64), uniform3(-1.0..1.0f64)).prop_map(|(first, second)| [first, second]).prop_filter(
        "links have a length and are not folded",
        |&[first, second]| {
            let sizes = length(first) * length(second);
            length(first).min(length(second)) > 0.2 && dot(first, second) > -0.98 * sizes
        },
    )
}

fn bends() -> impl Strategy<Value = Bend> {
    (0.2..2.0f64, 0.2..2.0f64, 0.1..10.0f64).prop_map(|(a, b, stiffness)| Bend {
        nodes: [0, 1, 2],
        lengths: [a, b],
        stiffness,
    })
}

/// The quadratic form of a bend's stiffness over moves of its two links.
fn form([uu, uv, vv]: &[[Vector; 3]; 3], [u, v]: [Vector; 2]) -> f64 {
    let times = |block: &[Vector; 3], vector: Vector| block.map(|row| dot(row, vector));
    dot(u, times(uu, u)) + 2.0 * dot(u, times(uv, v)) + dot(v, times(vv, v))
}

proptest! {
    #![proptest_config(cases(3000))]

    /// A curve passes through its points, never falls, and its slope and area are those of its values.
    #[test]
    fn curves_are_monotone_and_whole(points in curves(), share in -0.5..1.5f64) {
        let curve = Curve::new(&points).expect("points of a cord");
        let scale = curve.axial_stiffness();
        let most = points.iter().map(|point| point[1].abs()).fold(0.0, f64::max) / scale;
        for &[strain, force] in &points {
            prop_assert!((curve.value(strain) - force / scale).abs() <= 1e-12 * most);
        }
        prop_assert!(curve.area(0.0).abs() <= 1e-14 * most);
        let [first, last] = curve.range();
        let strain = first + share * (last - first);
        let step = 1e-5 * (last - first);
        let (before, after) = (curve.value(strain - step), curve.value(strain + step));
        prop_assert!(before <= after + 1e-12 * most);
        prop_assert!(curve.slope(strain) >= 0.0);
        prop_assert!(curve.slope(last) > 0.0 && curve.slope(last + 1.0) == curve.slope(last));
        let found = curve.strain(curve.value(strain));
        prop_assert!(curve.value(found - step) <= curve.value(strain) + 1e-12 * most);
        prop_assert!((curve.value(found) - curve.value(strain)).abs() <= 1e-12 * most);
        let kink = points.iter().any(|point| (point[0] - strain).abs() <= step);
        prop_assume!(!kink);
        let steepest = points.windows(2).map(|pair| (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0]));
        let steepest = steepest.fold(0.0, f64::max) / scale;
        prop_assert!(((after - before) / (2.0 * step) - curve.slope(strain)).abs() <= 1e-5 * steepest);
        let grown = (curve.area(strain + step) - curve.area(strain - step)) / (2.0 * step);
        prop_assert!((grown - curve.value(strain)).abs() <= 1e-6 * most);
    }

    /// Forces and stiffness of a bend are the first and second differences of its energy.
    #[test]
    fn a_bend_agrees_with_differences(bend in bends(), links in links(), way in (uniform3(-1.0..1.0f64), uniform3(-1.0..1.0f64))) {
        let way = [way.0, way.1];
        let moved = |share: f64| [0, 1].map(|at| add(links[at], scale(way[at], share)));
        let at = |share: f64| bend.bending(moved(share), false);
        let (here, step) = (at(0.0), 1e-5);
        let slope = dot(here.forces[0], way[0]) + dot(here.forces[1], way[1]);
        let size = bend.stiffness / (bend.lengths[0] * bend.lengths[1]);
        let rise = (at(step).energy - at(-step).energy) / (2.0 * step);
        prop_assert!((slope - rise).abs() <= 1e-5 * size * 100.0, "{slope} {rise}");
        let along = |share: f64| {
            let forces = at(share).forces;
            dot(forces[0], way[0]) + dot(forces[1], way[1])
        };
        let turn = (along(step) - along(-step)) / (2.0 * step);
        let found = form(&here.stiffness, way);
        prop_assert!((turn - found).abs() <= 1e-4 * (size * 100.0 + found.abs()), "{turn} {found}");
    }

    /// Without what makes it indefinite a bend's stiffness is never negative, and it is the whole one where it is
    /// straight.
    #[test]
    fn a_bend_leaves_out_only_what_pushes(bend in bends(), links in links(), way in (uniform3(-1.0..1.0f64), uniform3(-1.0..1.0f64))) {
        let way = [way.0, way.1];
        let half = bend.bending(links, true);
        let size = 1e-12 * half.stiffness.iter().flatten().flatten().fold(0.0, |most: f64, value| most.max(value.abs()));
        prop_assert!(form(&half.stiffness, way) >= -size);
        let straight = [links[0], scale(links[0], 1.7)];
        let [half, whole] = [true, false].map(|part| form(&bend.bending(straight, part).stiffness, way));
        prop_assert!((half - whole).abs() <= 1e-9 * half.abs().max(1e-9), "{half} {whole}");
    }

    /// Nearly straight links keep the digits of their energy, EI α² / (a + b).
    #[test]
    fn a_nearly_straight_bend_has_its_small_energy(bend in bends(), angle in -8.0..-1.0f64) {
        let angle = 10.0_f64.powf(angle);
        let [a, b] = bend.lengths;
        let links = [[a, 0.0, 0.0], [b * angle.cos(), b * angle.sin(), 0.0]];
        let energy = bend.bending(links, false).energy;
        let small = bend.stiffness * angle * angle / (a + b);
        prop_assert!((energy - small).abs() <= (angle * angle + 1e-6) * small, "{energy:e} {small:e}");
    }

    /// The pulls of a bend hold each other in balance, as forces and as moments.
    #[test]
    fn a_rod_pulls_on_nothing_but_itself(nodes in vec(point(), 3..9), closed: bool, stiffness in 0.1..10.0f64) {
        let count = nodes.len();
        let far = |node: usize| length(subtract(nodes[(node + 1) % count], nodes[node]));
        let links = if closed { count } else { count - 1 };
        prop_assume!((0..links).all(|node| far(node) > 0.1));
        let mut network = unit_network(nodes.clone(), vec![[0, 1]], &[]);
        network.stiffness.to_mut()[0] = 1e-300;
        network.rods = vec![Rod {
            nodes: (0..count as u32).collect(),
            closed,
            lengths: (0..links).map(far).collect(),
            bending_stiffness: stiffness,
        }].into();
        let pulls = residuals(&network, &nodes);
        let total = pulls.iter().copied().fold([0.0; 3], add);
        let moment = nodes.iter().zip(&pulls).map(|(&at, &pull)| cross(at, pull)).fold([0.0; 3], add);
        let shortest = (0..links).map(far).fold(f64::MAX, f64::min);
        let size = pulls.iter().map(|&pull| length(pull)).fold(stiffness / shortest.powi(2), f64::max);
        prop_assert!(length(total) <= 1e-11 * size * count as f64);
        prop_assert!(length(moment) <= 1e-9 * size * count as f64);
    }

    /// Pressure in a closed box of bent cells pushes it nowhere and turns it nowhere, and does the work p ΔV.
    #[test]
    fn pressure_in_a_closed_volume_balances(corners in vec(point(), 8), moves in vec(point(), 8), pressure in -5.0..5.0f64) {
        const FACES: [[u32; 4]; 6] =
            [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
        let on_all = |positions: &[Vector]| {
            let mut loads = vec![[0.0; 3]; 8];
            FACES.iter().for_each(|face| press(face, pressure, positions, &mut loads));
            loads
        };
        let loads = on_all(&corners);
        let size = loads.iter().map(|&load| length(load)).fold(1e-9, f64::max);
        let total = loads.iter().copied().fold([0.0; 3], add);
        let moment = corners.iter().zip(&loads).map(|(&at, &load)| cross(at, load)).fold([0.0; 3], add);
        prop_assert!(length(total) <= 1e-12 * size * 8.0, "{total:?}");
        prop_assert!(length(moment) <= 1e-11 * size * 80.0, "{moment:?}");
        let volume = |positions: &[Vector]| -> f64 {
            FACES.iter().map(|face| {
                let at = |place: usize| positions[face[place % 4] as usize];
                let middle = scale((0..4).map(at).fold([0.0; 3], add), 0.25);
                (0..4).map(|place| dot(middle, cross(at(place), at(place + 1))) / 6.0).sum::<f64>()
            }).sum()
        };
        let step = 1e-4;
        let moved = |share: f64| -> Vec<Vector> {
            corners.iter().zip(&moves).map(|(&at, &way)| add(at, scale(way, share))).collect()
        };
        let grown = (volume(&moved(step)) - volume(&moved(-step))) / (2.0 * step);
        let work: f64 = loads.iter().zip(&moves).map(|(&load, &way)| dot(load, way)).sum();
        prop_assert!((work - pressure * grown).abs() <= 1e-6 * (size * 80.0).max(1.0), "{work} {grown}");
    }
}

/// A net of every kind of part: cords and bars under all laws, a rod, supports of all kinds, loads that follow.
fn mixed() -> impl Strategy<Value = Network<'static>> {
    let numbers =
        (vec(point(), 4..9), vec(0u32..64, 8..40), vec(0.05..1.0f64, 40), vec(point(), 9), curves());
    (numbers, any::<[bool; 6]>()).prop_map(|((positions, dice, shares, loads, points), parts)| {
        let [curved, rods, slides, axes, weighs, presses] = parts;
        let count = positions.len() as u32;
        let mut springs: Vec<[u32; 2]> = (1..count).map(|node| [node - 1, node]).collect();
        for pair in dice.chunks_exact(2) {
            let pair = [pair[0] % count, pair[1] % count];
            if pair[0] != pair[1] && !springs.contains(&pair) && !springs.contains(&[pair[1], pair[0]]) {
                springs.push(pair);
            }
        }
        let mut network = unit_network(positions, springs, &[0, count as usize - 1]);
        let lengths = network.lengths(&network.positions);
        for (spring, length) in lengths.iter().enumerate() {
            let share = shares[spring % shares.len()];
            network.stiffness.to_mut()[spring] = 10.0 * share;
            network.rest_length.to_mut()[spring] = if spring % 3 == 2 { 0.0 } else { share * length };
            network.sense.to_mut()[spring] =
                [Sense::Both, Sense::Tension, Sense::Tension][dice[spring % dice.len()] as usize % 3];
        }
        network.loads = (0..count as usize).map(|node| scale(loads[node], 0.3)).collect::<Vec<_>>().into();
        if curved {
            network.curves = vec![Curve::new(&points).expect("points of a cord")].into();
            let has = |spring: usize| spring.is_multiple_of(2) && network.rest_length[spring] > 0.0;
            network.curve = (0..lengths.len())
                .map(|spring| if has(spring) { 0 } else { NO_CURVE })
                .collect::<Vec<_>>()
                .into();
        }
        if rods {
            network.rods = vec![Rod {
                nodes: vec![0, 1, 2, 3],
                closed: false,
                lengths: lengths[..3].to_vec(),
                bending_stiffness: 5.0,
            }]
            .into();
        }
        if slides {
            let path = if shares[0] > 0.5 {
                Path::Line([1.0, shares[1], 0.3])
            } else {
                Path::Plane([shares[1], 1.0, 2.0])
            };
            network.slides = vec![Slide { node: 1, path }].into();
        }
        if axes {
            network.fixed.to_mut()[2] = [false, true, shares[2] > 0.5];
        }
        if weighs {
            network.weight = vec![0.02; lengths.len()].into();
        }
        if presses {
            network.pressure =
                Pressure { cells: Groups::collect(1, (0..4).map(|node| (0, node))), values: vec![0.02] };
        }
        network
    })
}

proptest! {
    #![proptest_config(cases(800))]

    /// What a workspace solved before changes not a bit of what it solves next.
    #[test]
    fn a_workspace_forgets(a in mixed(), b in mixed()) {
        let settings = Settings::default();
        prop_assert_eq!(a.check(), Ok(()));
        let [first, second] = [&a, &b].map(|network| solve(network, &settings));
        let mut solver = Solver::default();
        for (network, fresh) in [(&a, &first), (&b, &second), (&a, &first), (&a, &first), (&b, &second)] {
            prop_assert_eq!(&format!("{:?}", solver.solve(network, &settings)), &format!("{fresh:?}"));
        }
    }

    /// Supports hold what they say, reactions act only there, and what converged balances as a whole.
    #[test]
    fn supports_and_loads_balance(network in mixed()) {
        let result = solve(&network, &Settings::default());
        prop_assert!(result.positions.iter().flatten().all(|value| value.is_finite()), "{:?}", result.status);
        let size = result.positions.iter().flatten().fold(1.0, |most: f64, value| most.max(value.abs()));
        let holding = reactions(&network, &result.positions, &result.forces);
        for (node, &position) in result.positions.iter().enumerate() {
            let moved = subtract(position, network.positions[node]);
            let slide = network.slides.iter().find(|slide| slide.node as usize == node);
            match slide.map(|slide| slide.path) {
                Some(Path::Line(along)) => {
                    prop_assert!(length(cross(moved, along)) <= 1e-12 * size * length(along));
                    prop_assert!(dot(holding[node], along).abs() <= 1e-12 * length(holding[node]) * length(along));
                }
                Some(Path::Plane(normal)) => {
                    prop_assert!(dot(moved, normal).abs() <= 1e-12 * size * length(normal));
                    prop_assert!(length(cross(holding[node], normal)) <= 1e-12 * length(holding[node]) * length(normal));
                }
                None => for axis in 0..3 {
                    if network.fixed[node][axis] {
                        prop_assert_eq!(moved[axis], 0.0);
                    } else {
                        prop_assert_eq!(holding[node][axis], 0.0);
                    }
                },
            }
        }
        if result.status != Status::Converged {
            return Ok(());
        }
        prop_assert!(result.residual <= 1e-9);
        let outer: Vec<Vector> =
            loads(&network, &result.positions).into_iter().zip(&holding).map(|(load, &held)| add(load, held)).collect();
        let total = outer.iter().copied().fold([0.0; 3], add);
        let moment = result.positions.iter().zip(&outer).map(|(&at, &force)| cross(at, force)).fold([0.0; 3], add);
        let most = result.forces.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
        let most = outer.iter().map(|&force| length(force)).fold(most, f64::max);
        prop_assert!(length(total) <= 1e-9 * most * outer.len() as f64);
        prop_assert!(length(moment) <= 1e-9 * most * size * outer.len() as f64);
    }

    /// The net that is solved again from its equilibrium stays there.
    #[test]
    fn a_warm_start_stays(network in mixed()) {
        let result = solve(&network, &Settings::default());
        prop_assume!(result.status == Status::Converged && !network.is_linear());
        let mut warm = network.clone();
        warm.positions = result.positions.clone().into();
        let again = solve(&warm, &Settings::default());
        prop_assert_eq!(again.status, Status::Converged);
        prop_assert_eq!(again.iterations, 0);
        prop_assert_eq!(again.positions, result.positions);
    }
}

proptest! {
    #![proptest_config(cases(300))]

    /// The animated solver comes to rest where the direct one finds an equilibrium, or where the energy is no higher.
    #[test]
    fn implicit_euler_rests_where_the_net_does(network in mixed()) {
        let settings = Settings { iterations: 5000, ..Settings::default() };
        let moved = implicit_euler::solve(&network, &settings, Motion::default());
        prop_assert!(moved.positions.iter().flatten().all(|value| value.is_finite()));
        prop_assume!(moved.status == Status::Converged);
        let mut warm = network.clone();
        warm.positions = moved.positions.clone().into();
        let direct = solve(&warm, &Settings::default());
        prop_assert_eq!(direct.status, Status::Converged);
        prop_assert!(direct.iterations <= 1, "{} {:e} {:e} {:?}", direct.iterations, moved.residual, direct.residual, network.is_linear());
    }
}
