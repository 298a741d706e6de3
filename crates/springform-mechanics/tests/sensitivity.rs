//! Derivatives of equilibria against central finite differences, over nets of all laws and supports.

mod nets;

use nets::common::cases;
use nets::{nets, point, unit_network};
use proptest::collection::vec;
use proptest::prelude::*;
use springform_mechanics::curve::Curve;
use springform_mechanics::equilibrium::sensitivity::{Parameters, Sensitivity, SensitivityError};
use springform_mechanics::equilibrium::{Equilibrium, Settings, Status, solve};
use springform_mechanics::network::{NO_CURVE, Network, Path, Sense, Slide};
use springform_mechanics::rod::Rod;
use springform_mechanics::vector::{Vector, add, dot, length, scale, subtract};

/// Tighter than any user's, so that differences over small steps keep their digits.
const EXACT: Settings = Settings { tolerance: 1e-13, iterations: 500 };

/// Force against strain of a measured cord.
const POINTS: [[f64; 2]; 4] = [[-0.5, -1.0], [0.0, 0.0], [0.3, 2.0], [1.0, 3.0]];

/// What is drawn for a network besides its net: numbers that springs and nodes take in turn.
#[derive(Clone, Debug)]
struct Draw {
    laws: Vec<u8>,
    shares: Vec<f64>,
    loads: Vec<Vector>,
    loaded: bool,
    support: u8,
    rod: bool,
}

fn draws() -> impl Strategy<Value = Draw> {
    let support = 0..5u8;
    let parts = (vec(0..6u8, 7), vec(0.1..1.3f64, 5), vec(point(), 5), any::<bool>(), support, any::<bool>());
    parts.prop_map(|(laws, shares, loads, loaded, support, rod)| Draw {
        laws,
        shares,
        loads,
        loaded,
        support,
        rod,
    })
}

/// A network of many laws at its equilibrium, if it has one.
fn settled(net: &nets::Net, draw: &Draw) -> Option<(Network<'static>, Equilibrium)> {
    let mut network = net.network.clone();
    let drawn = solve(&network, &EXACT);
    let lengths = network.lengths(&drawn.positions);
    let count = lengths.len();
    network.positions = drawn.positions.into();
    let curve = Curve::new(&POINTS).expect("it ascends");
    network.curves = vec![curve].into();
    network.curve = vec![NO_CURVE; count].into();
    for (spring, &length) in lengths.iter().enumerate() {
        let share = draw.shares[spring % draw.shares.len()];
        let rest = share * length;
        // Strong constant forces pull nodes onto each other, where springs have no direction.
        let weak = 0.1 * network.stiffness[spring] * length.max(0.1) * share;
        match draw.laws[spring % draw.laws.len()] {
            0 => {}
            1 => network.rest_length.to_mut()[spring] = rest,
            2 => {
                network.rest_length.to_mut()[spring] = rest;
                network.sense.to_mut()[spring] = Sense::Tension;
            }
            3 => network.force.to_mut()[spring] = weak,
            4 if rest > 0.0 => {
                network.rest_length.to_mut()[spring] = rest;
                network.curve.to_mut()[spring] = 0;
            }
            _ => {
                network.force.to_mut()[spring] = weak;
                network.stiffness.to_mut()[spring] = 0.0;
            }
        }
    }
    if draw.loaded {
        let loads = (0..network.positions.len()).map(|node| draw.loads[node % draw.loads.len()]);
        network.loads = loads.collect::<Vec<_>>().into();
    }
    support(&mut network, draw);
    if draw.rod {
        network.rods = rod(&network, &lengths).into_iter().collect();
    }
    network.check().ok()?;
    let equilibrium = solve(&network, &EXACT);
    (equilibrium.residual <= 1e-11).then_some((network, equilibrium))
}

/// Frees one anchor in part.
fn support(network: &mut Network<'static>, draw: &Draw) {
    let anchor = network.fixed.iter().position(|axes| axes[0]).expect("a net is held");
    let along = draw.loads[0];
    if length(along) < 0.1 {
        return;
    }
    match draw.support {
        0 => network.fixed.to_mut()[anchor] = [true, false, true],
        1 => network.fixed.to_mut()[anchor] = [false, true, false],
        2 | 3 => {
            network.fixed.to_mut()[anchor] = [false; 3];
            let path = if draw.support == 2 { Path::Line(along) } else { Path::Plane(along) };
            network.slides = vec![Slide { node: anchor as u32, path }].into();
        }
        _ => {}
    }
}

/// A rod along the first two springs that meet.
fn rod(network: &Network<'_>, lengths: &[f64]) -> Option<Rod> {
    let [a, b] = *network.springs.first()?;
    let (next, ends) = network.springs.iter().enumerate().skip(1).find(|(_, ends)| ends.contains(&b))?;
    let c = if ends[0] == b { ends[1] } else { ends[0] };
    let links = vec![lengths[0], lengths[next]];
    let bending_stiffness = links[0].powi(3);
    (c != a && links.iter().all(|link| *link > 1e-3)).then(|| Rod {
        nodes: vec![a, b, c],
        closed: false,
        lengths: links,
        bending_stiffness,
    })
}

/// The network with parameters changed, started at positions that move with the supports.
fn moved(network: &Network<'static>, at: &[Vector], change: &Parameters, step: f64) -> Network<'static> {
    let mut other = network.clone();
    let plus =
        |of: &[f64], by: &[f64]| -> Vec<f64> { of.iter().zip(by).map(|(a, b)| a + step * b).collect() };
    other.stiffness = plus(&network.stiffness, &change.stiffness).into();
    other.rest_length = plus(&network.rest_length, &change.rest_length).into();
    other.force = plus(&network.force, &change.force).into();
    let loads = network.loads.iter().zip(&change.loads).map(|(&a, &b)| add(a, scale(b, step)));
    other.loads = loads.collect::<Vec<_>>().into();
    let start = at.iter().zip(&change.supports).map(|(&a, &b)| add(a, scale(b, step)));
    other.positions = start.collect::<Vec<_>>().into();
    other
}

/// A change of the parameters of one kind that keeps every spring's law.
fn change(network: &Network<'_>, kind: usize, numbers: &[f64]) -> Parameters {
    let (nodes, springs) = (network.positions.len(), network.springs.len());
    let number = |at: usize| numbers[at % numbers.len()];
    let vector = |at: usize| [number(3 * at), number(3 * at + 1), number(3 * at + 2)];
    let of = |on: bool, unit: &dyn Fn(usize) -> f64| -> Vec<f64> {
        (0..springs).map(|spring| if on { number(spring) * unit(spring) } else { 0.0 }).collect()
    };
    let of_nodes =
        |on: bool| (0..nodes).map(|node| if on { vector(node) } else { [0.0; 3] }).collect::<Vec<_>>();
    let curved = |spring: usize| network.curve_of(spring).is_some();
    let mut supports = of_nodes(kind == 4);
    for (node, moved) in supports.iter_mut().enumerate() {
        let held = |axis: usize| network.fixed[node][axis];
        let slides = network.slides.iter().any(|slide| slide.node as usize == node);
        (0..3).filter(|&axis| !held(axis) && !slides).for_each(|axis| moved[axis] = 0.0);
    }
    Parameters {
        stiffness: of(kind == 0, &|spring| network.stiffness[spring]),
        rest_length: of(kind == 1, &|spring| network.rest_length[spring]),
        force: of(kind == 2, &|spring| if curved(spring) { 0.0 } else { network.force[spring] + 0.1 }),
        loads: of_nodes(kind == 3),
        supports,
    }
}

/// Which springs carry force, and the piece of the curve that they are on: differences must not cross from one to another.
fn regime(network: &Network<'_>, equilibrium: &Equilibrium) -> Vec<(bool, usize)> {
    let lengths = network.lengths(&equilibrium.positions);
    let piece = |spring: usize| {
        let strain = lengths[spring] / network.rest_length[spring] - 1.0;
        network.curve_of(spring).map_or(0, |_| POINTS.iter().filter(|point| point[0] < strain).count())
    };
    equilibrium.forces.iter().enumerate().map(|(spring, force)| (*force != 0.0, piece(spring))).collect()
}

/// Differences of fourth order; `None` across a kink or where the solver can't keep the digits.
fn difference(
    network: &Network<'static>,
    equilibrium: &Equilibrium,
    change: &Parameters,
) -> Option<(Vec<Vector>, Vec<f64>)> {
    let step = 0.02;
    let mut positions = vec![[0.0; 3]; network.positions.len()];
    let mut forces = vec![0.0; network.springs.len()];
    for (factor, at) in [(-1.0, 2.0), (8.0, 1.0), (-8.0, -1.0), (1.0, -2.0)] {
        let other_network = moved(network, &equilibrium.positions, change, at * step);
        let other = solve(&other_network, &EXACT);
        if other.residual > 1e-11 || regime(&other_network, &other) != regime(network, equilibrium) {
            return None;
        }
        let by = factor / (12.0 * step);
        for (sum, (&there, &here)) in
            positions.iter_mut().zip(other.positions.iter().zip(&equilibrium.positions))
        {
            *sum = add(*sum, scale(subtract(there, here), by));
        }
        for (sum, (there, here)) in forces.iter_mut().zip(other.forces.iter().zip(&equilibrium.forces)) {
            *sum += by * (there - here);
        }
    }
    Some((positions, forces))
}

fn inner(a: &[Vector], b: &[Vector]) -> f64 {
    a.iter().zip(b).map(|(&a, &b)| dot(a, b)).sum()
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// dJ = gradient · change.
fn times(gradient: &Parameters, change: &Parameters) -> f64 {
    product(&gradient.stiffness, &change.stiffness)
        + product(&gradient.rest_length, &change.rest_length)
        + product(&gradient.force, &change.force)
        + inner(&gradient.loads, &change.loads)
        + inner(&gradient.supports, &change.supports)
}

proptest! {
    #![proptest_config(cases(400))]

    /// The response agrees with differences, and the gradient with the response, for every kind of parameter.
    #[test]
    fn derivatives_agree_with_differences(
        net in nets(8), draw in draws(), numbers in vec(-1.0..1.0f64, 11), weights in vec(point(), 7), kind in 0..5usize
    ) {
        let Some((network, equilibrium)) = settled(&net, &draw) else { return Ok(()) };
        let mut sensitivity = Sensitivity::default();
        if let Err(error) = sensitivity.build(&network, &equilibrium.positions) {
            prop_assert!(matches!(error, SensitivityError::Singular { .. }), "{error}");
            return Ok(());
        }
        let change = change(&network, kind, &numbers);
        let response = sensitivity.response(&change);

        let by_positions: Vec<Vector> = (0..network.positions.len()).map(|at| weights[at % 7]).collect();
        let by_forces: Vec<f64> = (0..network.springs.len()).map(|at| weights[at % 7][at % 3]).collect();
        let gradient = sensitivity.gradient(&by_positions, &by_forces);
        let forward = inner(&by_positions, &response.positions) + product(&by_forces, &response.forces);
        let sizes = |a: &[Vector], b: &[Vector]| -> f64 { a.iter().zip(b).map(|(&a, &b)| length(a) * length(b)).sum() };
        let terms = sizes(&by_positions, &response.positions)
            + by_forces.iter().zip(&response.forces).map(|(a, b)| (a * b).abs()).sum::<f64>();
        prop_assert!((times(&gradient, &change) - forward).abs() <= 1e-7 * terms, "{forward} of {terms}");

        // Beyond moves of a tenth of the lengths, differences tell of curvature.
        let moves = response.positions.iter().map(|&moved| length(moved)).fold(0.0, f64::max);
        let shortest = network.lengths(&equilibrium.positions).into_iter().fold(f64::INFINITY, f64::min);
        let small = (0.1 * shortest / moves.max(f64::MIN_POSITIVE)).min(1.0) ;
        prop_assume!(small > 1e-3);
        let scaled = |of: &[f64]| of.iter().map(|value| small * value).collect::<Vec<_>>();
        let scaled_rows = |of: &[Vector]| of.iter().map(|&row| scale(row, small)).collect::<Vec<_>>();
        let change = Parameters {
            stiffness: scaled(&change.stiffness),
            rest_length: scaled(&change.rest_length),
            force: scaled(&change.force),
            loads: scaled_rows(&change.loads),
            supports: scaled_rows(&change.supports),
        };
        let response = sensitivity.response(&change);
        let Some((positions, forces)) = difference(&network, &equilibrium, &change) else { return Ok(()) };
        let off = response.positions.iter().zip(&positions).map(|(&a, &b)| length(subtract(a, b))).fold(0.0, f64::max);
        let largest = positions.iter().map(|&moved| length(moved)).fold(0.0, f64::max);
        let extent = net.extent();
        prop_assert!(off <= 1e-5 * largest + 1e-9 * extent, "{off:e} of {largest:e}, {:?} {kind}", draw);
        let off = response.forces.iter().zip(&forces).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let largest = forces.iter().map(|force| force.abs()).fold(0.0, f64::max);
        let most = equilibrium.forces.iter().map(|force| force.abs()).fold(0.0, f64::max);
        prop_assert!(off <= 1e-5 * largest + 1e-9 * most, "{off:e} of {largest:e}, {:?} {kind}", draw);
    }
}

/// A spring that hangs under a load is r + W / k long: its end sinks by −W / k² with k, by 1 with r, by 1 / k with W.
#[test]
fn a_hanging_spring_has_closed_form_derivatives() {
    let mut network = unit_network(vec![[0.0; 3], [0.0, 0.0, -1.0]], vec![[0, 1]], &[0]);
    network.stiffness.to_mut()[0] = 4.0;
    network.rest_length.to_mut()[0] = 0.5;
    network.loads.to_mut()[1] = [0.0, 0.0, -3.0];
    let equilibrium = solve(&network, &EXACT);
    let mut sensitivity = Sensitivity::default();
    sensitivity.build(&network, &equilibrium.positions).expect("it hangs");
    let gradient = sensitivity.gradient(&[[0.0; 3], [0.0, 0.0, 1.0]], &[0.0]);
    assert!((gradient.stiffness[0] - 3.0 / 16.0).abs() < 1e-9, "{gradient:?}");
    assert!((gradient.rest_length[0] + 1.0).abs() < 1e-9);
    assert!((gradient.force[0] - 0.25).abs() < 1e-9);
    assert!((gradient.loads[1][2] - 0.25).abs() < 1e-9);
    assert!((gradient.supports[0][2] - 1.0).abs() < 1e-9 && gradient.supports[1] == [0.0; 3]);
}

#[test]
fn what_has_no_derivative_says_why() {
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
    let mut network = unit_network(positions, vec![[0, 1], [1, 2]], &[0, 2]);
    let mut sensitivity = Sensitivity::default();
    network.rest_length.to_mut().fill(2.0);
    network.sense.to_mut().fill(Sense::Tension);
    let slack = sensitivity.build(&network, &network.positions);
    assert_eq!(slack, Err(SensitivityError::Singular { node: 1 }));
    network.sense.to_mut().fill(Sense::Both);
    let pushed = sensitivity.build(&network, &network.positions);
    assert_eq!(pushed, Err(SensitivityError::Singular { node: 1 }));
    network.rest_length.to_mut().fill(1.0);
    let at_rest = sensitivity.build(&network, &network.positions);
    assert_eq!(at_rest, Err(SensitivityError::Singular { node: 1 }));
    network.rest_length.to_mut().fill(0.5);
    assert_eq!(sensitivity.build(&network, &network.positions), Ok(()));
    network.weight = vec![1.0; 2].into();
    let heavy = sensitivity.build(&network, &network.positions);
    assert_eq!(heavy, Err(SensitivityError::Followers));
    network.weight = Vec::new().into();
    network.springs.to_mut()[1] = [0, 2];
    network.springs.to_mut()[0] = [2, 0];
    let loose = sensitivity.build(&network, &network.positions);
    assert_eq!(loose, Err(SensitivityError::Unheld { node: 1 }));
}

#[test]
fn an_equilibrium_used_before_changes_no_derivative() {
    let positions = vec![[0.0; 3], [1.0, 0.5, 0.0], [2.0, 0.0, 0.0]];
    let linear = unit_network(positions, vec![[0, 1], [1, 2]], &[0, 2]);
    let mut stretched = linear.clone();
    stretched.rest_length.to_mut().fill(0.5);
    let gradient = |sensitivity: &mut Sensitivity, network: &Network<'static>| {
        let equilibrium = solve(network, &Settings::default());
        assert_eq!(equilibrium.status, Status::Converged);
        sensitivity.build(network, &equilibrium.positions).expect("it is taut");
        sensitivity.gradient(&[[0.0; 3]; 3], &[1.0, 0.0])
    };
    let mut used = Sensitivity::default();
    for network in [&linear, &stretched, &linear] {
        assert_eq!(gradient(&mut used, network), gradient(&mut Sensitivity::default(), network));
    }
}
