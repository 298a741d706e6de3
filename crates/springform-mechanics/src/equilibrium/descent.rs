//! Descent in the metric of a scalar stiffness: one sparse factor, many cheap steps.
//!
//! Limited-memory BFGS (Nocedal, "Updating quasi-Newton matrices with limited storage", 1980) starting from the net's
//! own Laplacian, as in Liu, Bouaziz & Kavan, "Quasi-Newton methods for real-time simulation of hyperelastic materials",
//! 2017. Each spring's weight lies between its stiffness along and across its direction at the start; bringing weights up to
//! date on the way was tried and saves no time. Steps end by the approximate conditions of Hager & Zhang, "A new conjugate gradient method with guaranteed
//! descent and an efficient line search", 2005, which slopes decide where rounding hides the energy.

use super::elements::{Elements, State};
use super::state::Settings;
use super::supports::Supports;
use super::tangent::{Layout, along, moduli, own_stiffness};
use crate::network::Network;
use crate::sparse::{Graph, Lanes, ScalarFactor, Symbolic};
use crate::vector::length;
use pulp::{Arch, NullaryFnOnce};
use std::collections::VecDeque;

/// Pairs of step and change of pull that are remembered at most.
const MEMORY: usize = 5;

/// Pairs that are remembered at first: more save one step in twenty and double the memory that a step reads.
const FEW: usize = 2;

/// Steps after which a descent is slow enough for more pairs to pay.
const QUICK_STEPS: u32 = 24;

/// Share of the stiffness across a spring in its weight; the rest is that along it.
const ACROSS: f64 = 0.7;

/// Stiffness of springs across their directions, as a share of that along them, that a descent to the end needs.
const STRONG_PRESTRESS: f64 = 0.2;

/// Time of a Newton step over that of a step of descent, per multiplication and entry of the scalar factor (measured).
const NEWTON_PER_STEP: f64 = 3.0;

/// Least weight of a spring as a share of its own stiffness.
const LEAST_WEIGHT: f64 = 0.02;

/// Workspace of a descent.
#[derive(Clone, PartialEq, Debug, Default)]
pub(super) struct Descent {
    diagonal: Vec<f64>,
    weights: Vec<f64>,
    factor: ScalarFactor,
    /// Pattern that the factor is laid out for.
    pattern: u64,
    pulls: Vec<Lanes>,
    next_pulls: Vec<Lanes>,
    next: Vec<Lanes>,
    direction: Vec<Lanes>,
    pairs: VecDeque<Pair>,
    spare: Vec<Pair>,
}

#[derive(Clone, PartialEq, Debug, Default)]
struct Pair {
    step: Vec<Lanes>,
    change: Vec<Lanes>,
    inverse: f64,
}

/// How a descent ended.
pub(super) struct Descended {
    pub(super) converged: bool,
    pub(super) iterations: u32,
}

/// What a descent goes down on.
#[derive(Clone, Copy)]
pub(super) struct Hill<'a> {
    pub(super) network: &'a Network<'a>,
    pub(super) elements: &'a Elements,
    pub(super) supports: &'a Supports,
    pub(super) layout: &'a Layout,
    /// Least force that residuals are measured by [N].
    pub(super) least_force: f64,
}

impl Hill<'_> {
    /// Free part of the pull on every node, the state, and the largest pull over the mean force.
    pub(super) fn look(&self, positions: &[Lanes], pulls: &mut Vec<Lanes>) -> (State, f64) {
        let state = self.elements.evaluate(self.network, positions, pulls);
        self.supports.keep_free(pulls);
        let largest = Arch::new().dispatch(Largest { vectors: pulls });
        let scale = state.mean_force.max(self.least_force);
        let residual = if largest == 0.0 { 0.0 } else { largest.sqrt() / scale };
        (state, residual)
    }
}

impl Descent {
    /// Moves positions down to equilibrium, for `limit` steps at most.
    pub(super) fn descend(
        &mut self,
        hill: Hill<'_>,
        positions: &mut Vec<Lanes>,
        settings: &Settings,
        limit: u32,
    ) -> Descended {
        let mut pulls = std::mem::take(&mut self.pulls);
        let (mut state, mut residual) = hill.look(positions, &mut pulls);
        let mut iterations = 0;
        self.spare.extend(self.pairs.drain(..));
        let first = residual;
        let (mut limit, mut weak) = (limit, false);
        while residual > settings.tolerance && iterations < limit {
            if iterations == 0 {
                let Some(prestress) = self.weigh(hill, positions) else { break };
                weak = prestress <= STRONG_PRESTRESS;
                if weak {
                    limit = limit.min(steps_for_shape(&hill.layout.symbolic));
                }
            } else if !weak && is_hopeless(iterations, residual / first) {
                break;
            }
            let slope = self.aim(hill, &pulls);
            let Some((next_state, next_residual)) = self.step(hill, positions, slope, state) else { break };
            self.remember(positions, &pulls, if iterations < QUICK_STEPS { FEW } else { MEMORY });
            std::mem::swap(positions, &mut self.next);
            std::mem::swap(&mut pulls, &mut self.next_pulls);
            (state, residual) = (next_state, next_residual);
            iterations += 1;
        }
        self.pulls = pulls;
        Descended { converged: residual <= settings.tolerance, iterations }
    }

    /// Factors the Laplacian of the springs' weights, if it can be; the stiffness with which springs hold their nodes
    /// across over that along. Where it is small no scalar tells the net's stiffness.
    fn weigh(&mut self, hill: Hill<'_>, positions: &[Lanes]) -> Option<f64> {
        let Hill { network, supports, layout, .. } = hill;
        self.diagonal.clear();
        self.diagonal.resize(supports.nodes.len(), 0.0);
        self.weights.clear();
        let (mut stiff, mut held) = (0.0, 0.0);
        for (spring, &ends) in layout.ends[..network.springs.len()].iter().enumerate() {
            let size = length(along(network, spring, positions));
            let [axial, across] = moduli(network, spring, size);
            stiff += axial.max(across);
            held += across.max(0.0);
            let least = LEAST_WEIGHT * own_stiffness(network, spring, size);
            let weight = ((1.0 - ACROSS) * axial + ACROSS * across).max(least);
            self.weights.push(-weight);
            for row in ends.into_iter().filter(|&row| row != Graph::OUTSIDE) {
                self.diagonal[row as usize] += weight;
            }
        }
        let prestress = if stiff > 0.0 { held / stiff } else { 0.0 };
        self.weights.resize(layout.ends.len(), 0.0);
        for (node, _) in &supports.partial {
            // Held in part: the metric holds it as a whole, about as well.
            self.diagonal[supports.rows[*node as usize] as usize] *= 1.5;
        }
        if self.pattern != layout.pattern {
            self.factor.lay_out(&layout.graph, &layout.symbolic);
            self.pattern = layout.pattern;
        }
        let factored = self.factor.factor(&layout.graph, &layout.symbolic, &self.diagonal, &self.weights);
        factored.is_ok().then_some(prestress)
    }

    /// The direction of the next step, by two loops over the pairs around the metric, and its slope.
    fn aim(&mut self, hill: Hill<'_>, pulls: &[Lanes]) -> f64 {
        let supports = hill.supports;
        let mut shares = [0.0; MEMORY];
        self.direction.resize(pulls.len(), [0.0; 4]);
        let (pairs, direction) = (&self.pairs, &mut self.direction);
        Arch::new().dispatch(FirstLoop { pairs, shares: &mut shares, pulls, direction });
        self.factor.solve_at(&supports.nodes, &mut self.direction);
        supports.keep_partial(&mut self.direction);
        let (pairs, direction) = (&self.pairs, &mut self.direction);
        -Arch::new().dispatch(SecondLoop { pairs, shares: &shares, pulls, direction })
    }

    /// A step along the direction that is down enough, in `next` and `next_pulls`; `None` if there is none.
    fn step(&mut self, hill: Hill<'_>, positions: &[Lanes], slope: f64, from: State) -> Option<(State, f64)> {
        if slope >= 0.0 || slope.is_nan() {
            return None;
        }
        let mut share = 1.0;
        for _ in 0..MOST_SHARES {
            sum(&mut self.next, positions, share, &self.direction);
            hill.supports.put_back(hill.network, &mut self.next);
            let (state, residual) = hill.look(&self.next, &mut self.next_pulls);
            let next_slope = -inner(&self.next_pulls, &self.direction);
            let change = state.energy - from.energy;
            let hidden = change.abs() <= 10.0 * (state.noise + from.noise);
            let falls = change <= 1e-4 * share * slope || (hidden && next_slope <= -0.8 * slope);
            if falls && residual.is_finite() {
                return Some((state, residual));
            }
            // Where a parabola through both slopes has its lowest point.
            let lowest = share * slope / (slope - next_slope);
            share = if lowest.is_finite() { lowest.clamp(0.1 * share, 0.5 * share) } else { 0.1 * share };
        }
        None
    }

    /// Keeps the step to `next` and the change of pulls that it made, if they tell a stiffness above zero.
    fn remember(&mut self, positions: &[Lanes], pulls: &[Lanes], most: usize) {
        let oldest = if self.pairs.len() == most { self.pairs.pop_front() } else { self.spare.pop() };
        let mut pair = oldest.unwrap_or_default();
        sum(&mut pair.step, &self.next, -1.0, positions);
        sum(&mut pair.change, pulls, -1.0, &self.next_pulls);
        let curvature = inner(&pair.step, &pair.change);
        if curvature > 1e-12 * (inner(&pair.step, &pair.step) * inner(&pair.change, &pair.change)).sqrt() {
            pair.inverse = 1.0 / curvature;
            self.pairs.push_back(pair);
        } else {
            self.spare.push(pair);
        }
    }
}

/// Most shares of a direction that are tried.
const MOST_SHARES: u32 = 12;

/// Steps that are worth their time where prestress is weak: they find the shape, and Newton's steps, of which two or three
/// cost as much as all of these, the digits.
fn steps_for_shape(symbolic: &Symbolic) -> u32 {
    (NEWTON_PER_STEP * symbolic.work() / symbolic.fill().max(1) as f64) as u32
}

/// After so many steps the residual should have fallen to a smaller share of the first.
fn is_hopeless(iterations: u32, share: f64) -> bool {
    iterations >= 24 && share > 0.85_f64.powi(iterations as i32)
}

/// From the newest pair to the oldest.
struct FirstLoop<'a> {
    pairs: &'a VecDeque<Pair>,
    shares: &'a mut [f64; MEMORY],
    pulls: &'a [Lanes],
    direction: &'a mut [Lanes],
}

impl NullaryFnOnce for FirstLoop<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let FirstLoop { pairs, shares, pulls, direction } = self;
        direction.copy_from_slice(pulls);
        for (pair, share) in pairs.iter().zip(shares).rev() {
            *share = pair.inverse * flat_inner(pair.step.as_flattened(), direction.as_flattened());
            add_scaled(direction.as_flattened_mut(), -*share, pair.change.as_flattened());
        }
    }
}

/// From the oldest pair to the newest; gives the product of pulls and direction.
struct SecondLoop<'a> {
    pairs: &'a VecDeque<Pair>,
    shares: &'a [f64; MEMORY],
    pulls: &'a [Lanes],
    direction: &'a mut [Lanes],
}

impl NullaryFnOnce for SecondLoop<'_> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        let SecondLoop { pairs, shares, pulls, direction } = self;
        for (pair, share) in pairs.iter().zip(shares) {
            let other = pair.inverse * flat_inner(pair.change.as_flattened(), direction.as_flattened());
            add_scaled(direction.as_flattened_mut(), share - other, pair.step.as_flattened());
        }
        flat_inner(pulls.as_flattened(), direction.as_flattened())
    }
}

/// Largest square of a vector.
struct Largest<'a> {
    vectors: &'a [Lanes],
}

impl NullaryFnOnce for Largest<'_> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        // `f64::max` would pass over what is not a number.
        let larger = |a: f64, b: f64| if b <= a { a } else { b };
        let mut largest = [0.0; 4];
        let (fours, rest) = self.vectors.as_chunks::<4>();
        for four in fours {
            for lane in 0..4 {
                let [x, y, z, _] = four[lane];
                largest[lane] = larger(largest[lane], x.mul_add(x, y.mul_add(y, z * z)));
            }
        }
        let squares = rest.iter().map(|[x, y, z, _]| x.mul_add(*x, y.mul_add(*y, z * z)));
        squares.chain(largest).fold(0.0, larger)
    }
}

fn inner(a: &[Lanes], b: &[Lanes]) -> f64 {
    Arch::new().dispatch(Inner { a: a.as_flattened(), b: b.as_flattened() })
}

struct Inner<'a> {
    a: &'a [f64],
    b: &'a [f64],
}

impl NullaryFnOnce for Inner<'_> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        flat_inner(self.a, self.b)
    }
}

#[inline(always)]
fn flat_inner(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 16];
    let (a, a_rest) = a.as_chunks::<16>();
    let (b, b_rest) = b.as_chunks::<16>();
    for (a, b) in a.iter().zip(b) {
        for lane in 0..16 {
            sums[lane] = a[lane].mul_add(b[lane], sums[lane]);
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

/// a += s b.
#[inline(always)]
fn add_scaled(a: &mut [f64], s: f64, b: &[f64]) {
    for (a, b) in a.iter_mut().zip(b) {
        *a = s.mul_add(*b, *a);
    }
}

/// out = a + s b.
fn sum(out: &mut Vec<Lanes>, a: &[Lanes], s: f64, b: &[Lanes]) {
    out.resize(a.len(), [0.0; 4]);
    Arch::new().dispatch(Sum { out: out.as_flattened_mut(), a: a.as_flattened(), s, b: b.as_flattened() });
}

struct Sum<'a> {
    out: &'a mut [f64],
    a: &'a [f64],
    s: f64,
    b: &'a [f64],
}

impl NullaryFnOnce for Sum<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (out, (a, b)) in self.out.iter_mut().zip(self.a.iter().zip(self.b)) {
            *out = self.s.mul_add(*b, *a);
        }
    }
}
