//! Descent in the metric of a scalar stiffness: one sparse factor, many cheap steps.
//!
//! Limited-memory BFGS (Nocedal, "Updating quasi-Newton matrices with limited storage", 1980) starting from the net's
//! own Laplacian, as in Liu, Bouaziz & Kavan, "Quasi-Newton methods for real-time simulation of hyperelastic materials",
//! 2017. Each spring's weight lies between its stiffness along and across its direction and is brought up to date a few
//! times. Steps end by the approximate conditions of Hager & Zhang, "A new conjugate gradient method with guaranteed
//! descent and an efficient line search", 2005, which slopes decide where rounding hides the energy.

use super::elements::{Elements, State};
use super::state::Settings;
use super::supports::Supports;
use super::tangent::{Layout, moduli, own_stiffness};
use crate::network::Network;
use crate::sparse::{Graph, Lanes, ScalarFactor};
use crate::vector::length;
use std::collections::VecDeque;

/// Pairs of step and change of pull that are remembered.
const MEMORY: usize = 8;

/// Share of the stiffness across a spring in its weight; the rest is that along it.
const ACROSS: f64 = 0.8;

/// Least weight of a spring as a share of its own stiffness.
const LEAST_WEIGHT: f64 = 0.02;

/// Steps after which weights are brought up to date.
const UPDATES: [u32; 2] = [8, 16];

/// Workspace of a descent.
#[derive(Clone, PartialEq, Debug, Default)]
pub(super) struct Descent {
    diagonal: Vec<f64>,
    weights: Vec<f64>,
    factor: ScalarFactor,
    pulls: Vec<Lanes>,
    next_pulls: Vec<Lanes>,
    next: Vec<Lanes>,
    direction: Vec<Lanes>,
    rows: Vec<Lanes>,
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
        let square = |[x, y, z, _]: &Lanes| x * x + y * y + z * z;
        let mut largest = 0.0;
        for pull in pulls.iter() {
            let square = square(pull);
            // `f64::max` would pass over what is not a number.
            largest = if square <= largest { largest } else { square };
        }
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
        let mut pace = Pace { start: residual };
        while residual > settings.tolerance {
            let fresh = iterations == 0 || UPDATES.contains(&iterations);
            if iterations >= limit
                || (fresh && !self.weigh(hill, positions))
                || pace.hopeless(iterations, residual)
            {
                break;
            }
            self.aim(hill, &pulls);
            let Some((next_state, next_residual)) = self.step(hill, positions, &pulls, state) else { break };
            self.remember(positions, &pulls);
            std::mem::swap(positions, &mut self.next);
            std::mem::swap(&mut pulls, &mut self.next_pulls);
            (state, residual) = (next_state, next_residual);
            iterations += 1;
        }
        self.pulls = pulls;
        Descended { converged: residual <= settings.tolerance, iterations }
    }

    /// Factors the Laplacian of the springs' weights; false if it can't be.
    fn weigh(&mut self, hill: Hill<'_>, positions: &[Lanes]) -> bool {
        let Hill { network, supports, layout, .. } = hill;
        self.diagonal.clear();
        self.diagonal.resize(supports.nodes.len(), 0.0);
        self.weights.clear();
        for (spring, &ends) in layout.ends[..network.springs.len()].iter().enumerate() {
            let size = length(super::tangent::along(network, spring, positions));
            let [axial, across] = moduli(network, spring, size);
            let least = LEAST_WEIGHT * own_stiffness(network, spring, size);
            let weight = ((1.0 - ACROSS) * axial + ACROSS * across).max(least);
            self.weights.push(-weight);
            for row in ends.into_iter().filter(|&row| row != Graph::OUTSIDE) {
                self.diagonal[row as usize] += weight;
            }
        }
        self.weights.resize(layout.ends.len(), 0.0);
        for (node, _) in &supports.partial {
            // Held in part: the metric holds it as a whole, about as well.
            self.diagonal[supports.rows[*node as usize] as usize] *= 1.5;
        }
        self.factor.factor(&layout.graph, &layout.symbolic, &self.diagonal, &self.weights).is_ok()
    }

    /// The direction of the next step: two loops over the pairs around the metric.
    fn aim(&mut self, hill: Hill<'_>, pulls: &[Lanes]) {
        self.direction.clear();
        self.direction.extend_from_slice(pulls);
        let mut shares = [0.0; MEMORY];
        for (pair, share) in self.pairs.iter().zip(&mut shares).rev() {
            *share = pair.inverse * inner(&pair.step, &self.direction);
            add_scaled(&mut self.direction, -*share, &pair.change);
        }
        let Hill { supports, layout, .. } = hill;
        self.rows.clear();
        self.rows.extend(supports.nodes.iter().map(|&node| self.direction[node as usize]));
        self.factor.solve(&layout.symbolic, &mut self.rows);
        self.direction.fill([0.0; 4]);
        for (&node, &row) in supports.nodes.iter().zip(&self.rows) {
            self.direction[node as usize] = row;
        }
        supports.keep_free(&mut self.direction);
        for (pair, share) in self.pairs.iter().zip(shares) {
            let other = pair.inverse * inner(&pair.change, &self.direction);
            add_scaled(&mut self.direction, share - other, &pair.step);
        }
    }

    /// A step along the direction that is down enough, in `next` and `next_pulls`; `None` if there is none.
    fn step(
        &mut self,
        hill: Hill<'_>,
        positions: &[Lanes],
        pulls: &[Lanes],
        from: State,
    ) -> Option<(State, f64)> {
        let slope = -inner(pulls, &self.direction);
        if slope >= 0.0 || slope.is_nan() {
            return None;
        }
        let mut share = 1.0;
        for _ in 0..MOST_SHARES {
            self.next.clear();
            self.next.extend_from_slice(positions);
            add_scaled(&mut self.next, share, &self.direction);
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
    fn remember(&mut self, positions: &[Lanes], pulls: &[Lanes]) {
        let oldest = if self.pairs.len() == MEMORY { self.pairs.pop_front() } else { self.spare.pop() };
        let mut pair = oldest.unwrap_or_default();
        difference(&mut pair.step, &self.next, positions);
        difference(&mut pair.change, pulls, &self.next_pulls);
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

/// How fast the residual falls.
struct Pace {
    start: f64,
}

impl Pace {
    /// After this many steps the residual should have fallen by more.
    fn hopeless(&mut self, iterations: u32, residual: f64) -> bool {
        iterations >= 24 && residual > self.start * 0.85_f64.powi(iterations as i32)
    }
}

#[inline(always)]
fn inner(a: &[Lanes], b: &[Lanes]) -> f64 {
    pulp::Arch::new().dispatch(Inner { a, b })
}

struct Inner<'a> {
    a: &'a [Lanes],
    b: &'a [Lanes],
}

impl pulp::NullaryFnOnce for Inner<'_> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        let mut sums = [[0.0; 4]; 4];
        let (a, a_rest) = self.a.as_chunks::<4>();
        let (b, b_rest) = self.b.as_chunks::<4>();
        for (a, b) in a.iter().zip(b) {
            for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
                *sum = std::array::from_fn(|lane| a[lane].mul_add(b[lane], sum[lane]));
            }
        }
        for (a, b) in a_rest.iter().zip(b_rest) {
            sums[0] = std::array::from_fn(|lane| a[lane].mul_add(b[lane], sums[0][lane]));
        }
        sums.iter().map(|sum| (sum[0] + sum[1]) + (sum[2] + sum[3])).sum()
    }
}

/// a += s b.
#[inline(always)]
fn add_scaled(a: &mut [Lanes], s: f64, b: &[Lanes]) {
    pulp::Arch::new().dispatch(AddScaled { a, s, b });
}

struct AddScaled<'a> {
    a: &'a mut [Lanes],
    s: f64,
    b: &'a [Lanes],
}

impl pulp::NullaryFnOnce for AddScaled<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (a, b) in self.a.iter_mut().zip(self.b) {
            *a = std::array::from_fn(|lane| self.s.mul_add(b[lane], a[lane]));
        }
    }
}

/// a − b.
fn difference(out: &mut Vec<Lanes>, a: &[Lanes], b: &[Lanes]) {
    out.clear();
    out.extend(a.iter().zip(b).map(|(a, b)| -> Lanes { std::array::from_fn(|lane| a[lane] - b[lane]) }));
}
