//! Work whose instructions are counted: run under callgrind, each `counted_` function is one case.
//!
//! `make guard` runs this at two commits and compares. Nets are made by a fixed rule, so that both do the same work.

#[path = "../benches/nets/mod.rs"]
mod nets;

use nets::Net;
use springform_evolution::evolve::Evolution;
use springform_evolution::phenotype::Setting;
use springform_mechanics::equilibrium::{Equilibrium, Settings, Status, solve};
use springform_mechanics::network::Network;
use springform_topology::filters::Method;
use springform_topology::forest::Forest;
use std::hint::black_box;

/// Individuals that are counted together.
const INDIVIDUALS: u32 = 20;

fn main() {
    let settings = Settings { tolerance: 1e-6, ..Settings::default() };
    let (dynamic, recursive) = (Net::new(Method::Dynamic), Net::new(Method::Recursive));
    let (_, network) = dynamic.setting.grow(&dynamic.forest).expect("the scene gives a net");
    let cords = dynamic.cords();
    counted_growth(&dynamic.setting, &dynamic.forest);
    assert_eq!(counted_linear(&network, &settings).status, Status::Converged);
    assert_eq!(counted_cords(&cords, &settings).status, Status::Converged);
    let evolutions = [dynamic.evolution(), recursive.evolution()];
    counted_dynamic_individuals(&evolutions[0]);
    counted_recursive_individuals(&evolutions[1]);
}

#[inline(never)]
fn counted_growth(setting: &Setting, forest: &Forest) {
    black_box(setting.grow(forest)).expect("the scene gives a net");
}

#[inline(never)]
fn counted_linear(network: &Network<'_>, settings: &Settings) -> Equilibrium {
    black_box(solve(network, settings))
}

#[inline(never)]
fn counted_cords(network: &Network<'_>, settings: &Settings) -> Equilibrium {
    // Written differently, so that this and the linear solve are never made one function.
    let result = solve(black_box(network), settings);
    black_box(result)
}

#[inline(never)]
fn counted_dynamic_individuals(evolution: &Evolution) {
    (0..INDIVIDUALS).for_each(|index| drop(black_box(evolution.individual(1, index))));
}

#[inline(never)]
fn counted_recursive_individuals(evolution: &Evolution) {
    (INDIVIDUALS..2 * INDIVIDUALS).for_each(|index| drop(black_box(evolution.individual(1, index))));
}
