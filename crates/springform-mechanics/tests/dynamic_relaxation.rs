//! Dynamic relaxation: the equilibrium of the solvers that factor a matrix, by another way.

mod nets;

use nets::common::cases;
use nets::{largest_distance, nets, unit_network};
use proptest::prelude::*;
use springform_mechanics::equilibrium::{Method, Settings, Status, dynamic_relaxation, solve};
use springform_mechanics::network::{Network, Sense};
use springform_mechanics::rod::Rod;

const STEPS: Settings = Settings { tolerance: 1e-9, iterations: 200_000 };

fn agree(network: &Network<'_>) -> Result<(), TestCaseError> {
    let (direct, relaxed) =
        (solve(network, &Settings::default()), dynamic_relaxation::solve(network, &STEPS));
    prop_assert_eq!((direct.status, relaxed.status), (Status::Converged, Status::Converged));
    prop_assert_eq!(relaxed.method, Method::DynamicRelaxation);
    prop_assert!(relaxed.residual <= STEPS.tolerance);
    let scale = direct.forces.iter().fold(1e-3, |most: f64, force| most.max(force.abs()));
    for (one, other) in direct.forces.iter().zip(&relaxed.forces) {
        prop_assert!((one - other).abs() <= 1e-5 * scale, "{one} {other}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(200))]

    /// Force as stiffness times length.
    #[test]
    fn linear_nets_agree(net in nets(6)) {
        agree(&net.network)?;
    }

    /// Cords with rest lengths below what they take, under loads: all stay taut, so that there is one equilibrium.
    #[test]
    fn cords_agree(net in nets(6), share in 0.1..0.7f64, pull in -0.05..0.05f64) {
        let network = net.network;
        let drawn = solve(&network, &Settings::default());
        let lengths = network.lengths(&drawn.positions);
        let shortest = lengths.iter().copied().fold(f64::INFINITY, f64::min);
        agree(&Network {
            rest_length: lengths.iter().map(|_| share * shortest).collect(),
            sense: vec![Sense::Tension; lengths.len()].into(),
            loads: vec![[0.0, 0.0, pull * shortest * network.stiffness[0]]; network.positions.len()].into(),
            ..network
        })?;
    }
}

#[test]
fn a_weight_hangs_at_its_closed_form() {
    let mut network = unit_network(vec![[0.0; 3], [0.1, 0.0, -1.0]], vec![[0, 1]], &[0]);
    network.stiffness.to_mut()[0] = 50.0;
    network.rest_length.to_mut()[0] = 1.0;
    network.loads.to_mut()[1] = [0.0, 0.0, -10.0];
    let relaxed = dynamic_relaxation::solve(&network, &STEPS);
    assert_eq!(relaxed.status, Status::Converged);
    assert!(largest_distance(&relaxed.positions[1..], &[[0.0, 0.0, -1.2]]) <= 1e-8);
}

#[test]
fn too_few_steps_and_loose_nodes_are_told() {
    let network = unit_network(vec![[0.0; 3], [1.0; 3], [2.0, 0.0, 0.0]], vec![[0, 1], [1, 2]], &[0, 2]);
    let few = Settings { iterations: 2, ..STEPS };
    let stopped = dynamic_relaxation::solve(&network, &few);
    assert_eq!((stopped.status, stopped.iterations), (Status::IterationLimit, 2));
    let loose = unit_network(vec![[0.0; 3]; 4], vec![[0, 1], [2, 3]], &[0]);
    assert_eq!(dynamic_relaxation::solve(&loose, &STEPS).status, Status::Unheld { node: 2 });
}

#[test]
fn it_suits_springs_and_dead_loads_only() {
    let network = unit_network(vec![[0.0; 3]; 3], vec![[0, 1], [1, 2]], &[0]);
    assert!(dynamic_relaxation::suits(&network));
    let rod = Rod { nodes: vec![0, 1, 2], closed: false, lengths: vec![1.0; 2], bending_stiffness: 1.0 };
    assert!(!dynamic_relaxation::suits(&Network { rods: vec![rod].into(), ..network.clone() }));
    assert!(!dynamic_relaxation::suits(&Network { weight: vec![1.0; 2].into(), ..network }));
}
