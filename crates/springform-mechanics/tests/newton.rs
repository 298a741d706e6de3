//! Springs with rest lengths: closed forms, energies, and random nets that converge or say why.

mod nets;

use nets::common::cases;
use nets::{Net, largest_distance, nets, point, unit_network};
use proptest::collection::vec;
use proptest::prelude::*;
use springform_mechanics::equilibrium::implicit_euler::{self, Motion};
use springform_mechanics::equilibrium::{Equilibrium, Settings, Status, residuals, solve};
use springform_mechanics::network::Network;
use springform_mechanics::vector::{Vector, add, dot, length, scale};

/// Potential energy of springs and dead loads [J].
fn energy(network: &Network<'_>, positions: &[Vector]) -> f64 {
    let springs = network.lengths(positions).into_iter().enumerate().map(|(spring, length)| {
        0.5 * network.stiffness[spring] * (length - network.rest_length[spring]).powi(2)
    });
    let loads = network.loads.iter().zip(positions).map(|(&load, &position)| dot(load, position));
    springs.sum::<f64>() - loads.sum::<f64>()
}

/// The net at equilibrium without rest lengths, then with rest lengths that are shares of its lengths there.
fn with_rest_lengths(net: &Net, shares: &[f64]) -> Network<'static> {
    let slack = solve(&net.network, &Settings::default());
    let lengths = net.network.lengths(&slack.positions);
    let rest = lengths.iter().enumerate().map(|(spring, length)| length * shares[spring % shares.len()]);
    let mut network = net.network.clone();
    network.rest_length = rest.collect::<Vec<_>>().into();
    network
}

fn check_says_why(network: &Network<'_>, result: &Equilibrium) -> Result<(), TestCaseError> {
    prop_assert!(result.positions.iter().flatten().all(|value| value.is_finite()), "{:?}", result.status);
    prop_assert!(result.forces.iter().all(|force| force.is_finite()));
    if result.status == Status::Converged {
        let mean = result.forces.iter().map(|force| force.abs()).sum::<f64>() / result.forces.len() as f64;
        let largest = residuals(network, &result.positions).into_iter().map(length).fold(0.0, f64::max);
        // A net that carries next to nothing is measured by what its springs would carry over the span.
        let held = || network.positions.iter().zip(network.fixed.iter()).filter(|(_, axes)| axes[0]);
        let extent = |axis: usize| {
            let along = || held().map(|(position, _)| position[axis]);
            along().fold(f64::MIN, f64::max) - along().fold(f64::MAX, f64::min)
        };
        let span = (0..3).map(extent).fold(0.0, f64::max);
        let springs = network.stiffness.iter().zip(network.rest_length.iter());
        let most = springs.filter(|(_, r)| **r > 0.0).map(|(k, r)| k * r.max(span)).fold(0.0, f64::max);
        prop_assert!(largest <= 1e-9 * mean.max(1e-6 * most), "{largest:e} against {mean:e}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(2000))]

    /// A spring that hangs under a load is as long as r + W / k and points along the load.
    #[test]
    fn a_hanging_spring_has_a_closed_form(
        anchor in point(), start in point(), load in point(), k in 0.1..10.0f64, rest in 0.01..5.0f64
    ) {
        prop_assume!(length(load) > 0.1);
        let mut network = unit_network(vec![anchor, start], vec![[0, 1]], &[0]);
        network.stiffness.to_mut()[0] = k;
        network.rest_length.to_mut()[0] = rest;
        network.loads.to_mut()[1] = load;
        let result = solve(&network, &Settings::default());
        prop_assert_eq!(
            result.status, Status::Converged, "{:e} after {}", result.residual, result.iterations
        );
        let stretched = rest + length(load) / k;
        let expected = add(anchor, scale(load, stretched / length(load)));
        prop_assert!(largest_distance(&result.positions, &[anchor, expected]) <= 1e-7 * stretched);
        prop_assert!((result.forces[0] - length(load)).abs() <= 1e-8 * length(load));
    }

    /// Two springs with a load between them: 2 k (L − r) h / L = W, solved for h by bisection.
    #[test]
    fn two_springs_sag_as_far_as_statics_says(
        half in 0.5..5.0f64, k in 0.1..10.0f64, share in 0.1..1.5f64, load in 0.01..20.0f64,
    ) {
        let rest = share * half;
        let positions = vec![[-half, 0.0, 0.0], [0.0, 0.0, -0.3 * half], [half, 0.0, 0.0]];
        let mut network = unit_network(positions, vec![[0, 1], [1, 2]], &[0, 2]);
        network.stiffness.to_mut().fill(k);
        network.rest_length.to_mut().fill(rest);
        network.loads.to_mut()[1] = [0.0, 0.0, -load];
        let carried = |h: f64| 2.0 * k * (half.hypot(h) - rest) * h / half.hypot(h);
        let (mut low, mut high) = (if rest > half { (rest * rest - half * half).sqrt() } else { 0.0 }, 1e4);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if carried(middle) < load { low = middle } else { high = middle }
        }
        let result = solve(&network, &Settings::default());
        prop_assert_eq!(
            result.status, Status::Converged, "{:e} after {}", result.residual, result.iterations
        );
        let off = length(add(result.positions[1], [0.0, 0.0, low]));
        prop_assert!(off <= 1e-6 * (half + low), "{off} off {low}");
    }

    /// Rest lengths in proportion to the lengths at rest keep a chain's nodes evenly spaced.
    #[test]
    fn uniform_chains_stay_even(count in 1usize..40, end in point(), share in 0.0..0.95f64) {
        prop_assume!(length(end) > 0.1);
        let springs = (0..count as u32).map(|node| [node, node + 1]).collect();
        let mut positions = vec![[0.1, 0.2, 0.3]; count + 1];
        positions[0] = [0.0; 3];
        positions[count] = end;
        let mut chain = unit_network(positions, springs, &[0, count]);
        chain.rest_length.to_mut().fill(share * length(end) / count as f64);
        let result = solve(&chain, &Settings::default());
        prop_assert_eq!(result.status, Status::Converged);
        for (node, &position) in result.positions.iter().enumerate() {
            let expected = scale(end, node as f64 / count as f64);
            prop_assert!(largest_distance(&[position], &[expected]) <= 1e-8 * length(end));
        }
    }
}

proptest! {
    #![proptest_config(cases(1000))]

    /// Nets of one cord whose rest lengths fit their place converge, below the energy they started with.
    #[test]
    fn stretched_nets_converge(net in nets(12), share in 0.05..0.8f64) {
        let network = with_rest_lengths(&net, &[share]);
        let result = solve(&network, &Settings::default());
        check_says_why(&network, &result)?;
        prop_assert_eq!(
            result.status, Status::Converged, "{:e} after {}", result.residual, result.iterations
        );
        let before = energy(&network, &solve(&net.network, &Settings::default()).positions);
        prop_assert!(energy(&network, &result.positions) <= before * (1.0 + 1e-12));
    }

    /// Whatever rest lengths and loads: a result that converges balances, one that does not says so, no
    /// number is lost, and the energy is not above the start's.
    #[test]
    fn any_net_converges_or_says_why(
        net in nets(8), shares in vec(0.0..3.0f64, 7), loads in vec(point(), 5), loaded: bool, given: bool
    ) {
        let mut network = with_rest_lengths(&net, &shares);
        if loaded {
            let count = network.positions.len();
            network.loads = (0..count).map(|node| loads[node % loads.len()]).collect::<Vec<_>>().into();
        }
        if given {
            network.positions = solve(&net.network, &Settings::default()).positions.into();
        }
        let result = solve(&network, &Settings::default());
        check_says_why(&network, &result)?;
        let directed = network.lengths(&network.positions).iter().all(|&length| length > 0.0);
        if directed && !network.is_linear() {
            let before = energy(&network, &network.positions);
            prop_assert!(energy(&network, &result.positions) <= before + 1e-9 * before.abs());
        }
    }

    /// The animated solver reaches the same equilibrium where there is only one.
    #[test]
    fn implicit_euler_agrees(net in nets(6), share in 0.05..0.7f64) {
        let network = with_rest_lengths(&net, &[share]);
        let direct = solve(&network, &Settings::default());
        let settings = Settings { iterations: 2000, ..Settings::default() };
        let moved = implicit_euler::solve(&network, &settings, Motion::default());
        prop_assert_eq!(moved.status, Status::Converged, "{:e} after {}", moved.residual, moved.iterations);
        let energies = [&direct, &moved].map(|result| energy(&network, &result.positions));
        prop_assert!((energies[0] - energies[1]).abs() <= 1e-9 * energies[0], "{energies:?}");
    }
}

#[test]
fn a_spring_without_load_takes_its_rest_length() {
    let mut network = unit_network(vec![[0.0; 3], [0.2, 0.0, 0.0]], vec![[0, 1]], &[0]);
    network.rest_length.to_mut()[0] = 1.5;
    let result = solve(&network, &Settings::default());
    assert_eq!(result.status, Status::Converged);
    assert!((length(result.positions[1]) - 1.5).abs() <= 1e-6);
}

#[test]
fn a_node_on_its_anchor_has_no_direction_and_is_no_error() {
    let mut network = unit_network(vec![[0.0; 3]; 2], vec![[0, 1]], &[0]);
    network.rest_length.to_mut()[0] = 1.0;
    let result = solve(&network, &Settings::default());
    assert!(result.positions.iter().flatten().all(|value| value.is_finite()));
}
