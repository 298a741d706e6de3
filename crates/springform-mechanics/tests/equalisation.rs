//! Equalising random nets: bounds are kept, the force differential never rises, and the descent finds known minima.

mod nets;

use nets::common::cases;
use nets::{nets, unit_network};
use proptest::prelude::*;
use proptest::sample::subsequence;
use springform_mechanics::bounded::{Descent, Valley};
use springform_mechanics::equalisation::{Allowed, Equalisation, EqualisationError};
use springform_mechanics::equilibrium::{Settings, Status, solve};
use springform_mechanics::network::{Network, Sense};

/// Steps after which a test has seen enough.
const STEPS: u32 = 300;

/// The differential of a network at rest.
fn differential(network: &Network<'_>) -> f64 {
    let result = solve(network, &Settings::default());
    assert_eq!(result.status, Status::Converged);
    let largest = result.forces.iter().copied().fold(0.0, f64::max);
    largest / result.forces.iter().copied().fold(f64::INFINITY, f64::min)
}

fn run(network: &Network<'static>, allowed: &Allowed) -> Result<Equalisation, EqualisationError> {
    let all = (0..network.springs.len()).collect();
    let mut equalisation = Equalisation::new(network.clone(), all, allowed, Settings::default())?;
    let mut last = equalisation.differential();
    while equalisation.iterations() < STEPS && equalisation.advance() {
        assert!(equalisation.differential() <= last);
        last = equalisation.differential();
    }
    Ok(equalisation)
}

/// Checks what holds for every outcome: factors that are allowed, and the differential that they are said to give.
fn check(network: &Network<'static>, done: &Equalisation, allowed: &Allowed) -> Result<(), TestCaseError> {
    let factors = done.factors();
    match allowed {
        Allowed::Between([low, high]) => {
            prop_assert!(factors.iter().all(|factor| low <= factor && factor <= high));
        }
        Allowed::Values(values) => prop_assert!(factors.iter().all(|factor| values.contains(factor))),
    }
    let mut tuned = network.clone();
    tuned.stiffness.to_mut().iter_mut().zip(&factors).for_each(|(k, factor)| *k *= factor);
    let now = differential(&tuned);
    prop_assert!(
        (now - done.differential()).abs() <= 1e-6 * now,
        "{now} is said to be {}",
        done.differential()
    );
    prop_assert!(done.differential() <= done.before());
    Ok(())
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn forces_even_out_within_bounds(net in nets(8), low in 0.1..0.9f64, high in 1.0..8.0f64) {
        let allowed = Allowed::Between([low, high]);
        match run(&net.network, &allowed) {
            Ok(done) => check(&net.network, &done, &allowed)?,
            Err(error) => prop_assert!(matches!(error, EqualisationError::Slack { .. }), "{error}"),
        }
    }

    #[test]
    fn forces_even_out_with_a_few_values(
        net in nets(8), others in subsequence(vec![0.25, 0.5, 2.0, 3.0, 4.0], 1..5)
    ) {
        let allowed = Allowed::Values([&[1.0], &others[..]].concat());
        match run(&net.network, &allowed) {
            Ok(done) => check(&net.network, &done, &allowed)?,
            Err(error) => prop_assert!(matches!(error, EqualisationError::Slack { .. }), "{error}"),
        }
    }

    /// Stretched cords, too: Newton's method starts each solve where the last one ended.
    #[test]
    fn forces_of_stretched_cords_even_out(net in nets(6), share in 0.1..0.7f64) {
        let mut network = net.network;
        let drawn = solve(&network, &Settings::default());
        let rest: Vec<f64> = network.lengths(&drawn.positions).iter().map(|length| share * length).collect();
        network.rest_length = rest.into();
        network.positions = drawn.positions.into();
        let allowed = Allowed::Between([0.5, 2.0]);
        if let Ok(done) = run(&network, &allowed) {
            check(&network, &done, &allowed)?;
        }
    }

    /// The lowest point of a bowl within bounds is its middle, pushed to the bounds.
    #[test]
    fn the_descent_finds_the_foot_of_a_bowl(middle in prop::collection::vec(-3.0..3.0f64, 1..20)) {
        let bounds = vec![[-1.0, 2.0]; middle.len()];
        let mut bowl = Bowl { middle: middle.clone(), at: Vec::new() };
        let mut descent = Descent::start(&mut bowl, vec![0.0; middle.len()]).expect("it has a value everywhere");
        for _ in 0..500 {
            if !descent.step(&mut bowl, &bounds) {
                break;
            }
        }
        for (x, middle) in descent.point().iter().zip(&middle) {
            prop_assert!((x - middle.clamp(-1.0, 2.0)).abs() < 1e-5, "{x} for {middle}");
        }
    }
}

/// Σ wᵢ (xᵢ − mᵢ)², with weights from 1 to 20.
struct Bowl {
    middle: Vec<f64>,
    at: Vec<f64>,
}

impl Valley for Bowl {
    fn value(&mut self, point: &[f64]) -> Option<f64> {
        self.at = point.to_vec();
        let terms = point.iter().zip(&self.middle).enumerate();
        Some(terms.map(|(weight, (x, m))| (1.0 + weight as f64) * (x - m).powi(2)).sum())
    }

    fn gradient(&mut self) -> Option<Vec<f64>> {
        let terms = self.at.iter().zip(&self.middle).enumerate();
        Some(terms.map(|(weight, (x, m))| 2.0 * (1.0 + weight as f64) * (x - m)).collect())
    }
}

/// Two springs in a line always pull alike; of three springs at a node off the middle, factors even the forces out.
#[test]
fn three_springs_at_a_node_come_to_pull_alike() {
    let height = 0.75f64.sqrt();
    let positions = vec![[1.0, 0.0, 0.0], [-0.5, height, 0.0], [-0.5, -height, 0.0], [0.0; 3]];
    let mut network = unit_network(positions, vec![[0, 3], [1, 3], [2, 3]], &[0, 1, 2]);
    network.stiffness = vec![1.0, 2.0, 3.0].into();
    let done = run(&network, &Allowed::Between([0.25, 4.0])).expect("every spring pulls");
    assert!(done.before() > 1.05 && done.differential() < 1.01, "{} {}", done.before(), done.differential());
}

#[test]
fn what_cannot_be_equalised_says_why() {
    let positions = vec![[0.0; 3], [1.0, 0.2, 0.0], [2.0, 0.0, 0.0]];
    let network = unit_network(positions, vec![[0, 1], [1, 2]], &[0, 2]);
    for allowed in [
        Allowed::Between([4.0, 0.25]),
        Allowed::Between([2.0, 4.0]),
        Allowed::Between([0.0, 4.0]),
        Allowed::Between([0.5, f64::NAN]),
        Allowed::Values(vec![]),
        Allowed::Values(vec![1.0]),
        Allowed::Values(vec![2.0, 4.0]),
    ] {
        let refused = run(&network, &allowed).err();
        assert!(matches!(refused, Some(EqualisationError::Allowed(_))), "{allowed:?}: {refused:?}");
    }
    let allowed = Allowed::Between([0.5, 2.0]);
    let mut slack = network.clone();
    slack.rest_length = vec![3.0; 2].into();
    slack.sense = vec![Sense::Tension; 2].into();
    let refused = run(&slack, &allowed).err();
    assert!(matches!(refused, Some(EqualisationError::Slack { .. })), "{refused:?}");
    let mut heavy = network;
    heavy.weight = vec![0.01; 2].into();
    let refused = run(&heavy, &allowed).err();
    assert!(matches!(refused, Some(EqualisationError::Sensitivity(_))), "{refused:?}");
}
