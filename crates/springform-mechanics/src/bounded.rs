//! Descent within bounds: quasi-Newton steps for many variables, each between a lower and an upper bound.
//!
//! Two-metric projection (Bertsekas, "Projected Newton methods for optimization problems with simple constraints", 1982):
//! variables at a bound that the gradient pushes against stay there, the others move along a direction of limited-memory
//! BFGS (Nocedal, "Updating quasi-Newton matrices with limited storage", 1980), bent at the bounds, until the value
//! falls by enough (Armijo).

use std::collections::VecDeque;

/// Steps that are remembered.
const MEMORY: usize = 30;

/// Part of the fall that the gradient promises which a step must bring.
const ENOUGH: f64 = 1e-4;

/// Most times that a step is shortened; by then it moves nothing.
const MOST_SHORTENED: u32 = 30;

/// A function of many variables.
pub trait Valley {
    /// The value at a point; `None` where there is none.
    fn value(&mut self, point: &[f64]) -> Option<f64>;

    /// The gradient at the point whose value was asked for last; `None` where there is none.
    fn gradient(&mut self) -> Option<Vec<f64>>;
}

/// A point on its way down.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Descent {
    point: Vec<f64>,
    value: f64,
    gradient: Vec<f64>,
    /// Moves, changes of the gradient, and one over their inner product; the newest last.
    memory: VecDeque<(Vec<f64>, Vec<f64>, f64)>,
}

impl Descent {
    /// Starts at a point within the bounds; `None` where there is no value or gradient.
    pub fn start(valley: &mut impl Valley, point: Vec<f64>) -> Option<Descent> {
        let value = valley.value(&point)?;
        let gradient = valley.gradient()?;
        Some(Descent { point, value, gradient, memory: VecDeque::new() })
    }

    /// Where it is.
    pub fn point(&self) -> &[f64] {
        &self.point
    }

    /// The value there.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// The gradient there.
    pub fn gradient(&self) -> &[f64] {
        &self.gradient
    }

    /// Makes a step, and says whether the value fell; if not, the point is where it was and as low as steps get it.
    pub fn step(&mut self, valley: &mut impl Valley, bounds: &[[f64; 2]]) -> bool {
        let free: Vec<bool> = self.point.iter().zip(&self.gradient).zip(bounds).map(is_free).collect();
        if self.follow(valley, bounds, &self.direction(&free)) {
            return true;
        }
        // What is remembered may mislead; steepest descent can't.
        self.memory.clear();
        self.follow(valley, bounds, &self.direction(&free))
    }

    /// Moves along a direction, bent at the bounds; false if the value falls nowhere along it.
    fn follow(&mut self, valley: &mut impl Valley, bounds: &[[f64; 2]], direction: &[f64]) -> bool {
        let mut share = 1.0;
        for _ in 0..MOST_SHORTENED {
            let ways = self.point.iter().zip(direction).zip(bounds);
            let next: Vec<f64> =
                ways.map(|((x, way), [low, high])| (x + share * way).clamp(*low, *high)).collect();
            let moved = difference(&next, &self.point);
            let slope = product(&self.gradient, &moved);
            if slope >= 0.0 {
                return false;
            }
            if let Some(value) = valley.value(&next).filter(|value| *value <= self.value + ENOUGH * slope)
                && let Some(gradient) = valley.gradient()
            {
                self.remember(moved, difference(&gradient, &self.gradient));
                (self.point, self.value, self.gradient) = (next, value, gradient);
                return true;
            }
            share *= 0.5;
        }
        false
    }

    /// −H g over the free variables, H by the two-loop recursion; before anything is remembered, −g of length one.
    fn direction(&self, free: &[bool]) -> Vec<f64> {
        let masked = |of: &[f64]| -> Vec<f64> {
            of.iter().zip(free).map(|(value, free)| if *free { *value } else { 0.0 }).collect()
        };
        let mut way = masked(&self.gradient);
        let mut shares = Vec::with_capacity(self.memory.len());
        for (moved, changed, inverse) in self.memory.iter().rev() {
            let share = inverse * product(moved, &way);
            add_times(&mut way, changed, -share);
            shares.push(share);
        }
        let size = match self.memory.back() {
            Some((_, changed, inverse)) => 1.0 / (inverse * product(changed, changed)),
            None => 1.0 / product(&way, &way).sqrt().max(f64::MIN_POSITIVE),
        };
        way.iter_mut().for_each(|value| *value *= size);
        for ((moved, changed, inverse), share) in self.memory.iter().zip(shares.iter().rev()) {
            let back = inverse * product(changed, &way);
            add_times(&mut way, moved, share - back);
        }
        way.iter_mut().for_each(|value| *value = -*value);
        masked(&way)
    }

    fn remember(&mut self, moved: Vec<f64>, changed: Vec<f64>) {
        let curvature = product(&moved, &changed);
        if curvature <= 1e-10 * product(&changed, &changed).sqrt() * product(&moved, &moved).sqrt() {
            return;
        }
        if self.memory.len() == MEMORY {
            self.memory.pop_front();
        }
        self.memory.push_back((moved, changed, 1.0 / curvature));
    }
}

/// A variable that no bound holds against the gradient.
fn is_free(((x, slope), [low, high]): ((&f64, &f64), &[f64; 2])) -> bool {
    !(x <= low && *slope > 0.0 || x >= high && *slope < 0.0)
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add_times(sum: &mut [f64], of: &[f64], share: f64) {
    sum.iter_mut().zip(of).for_each(|(sum, value)| *sum += share * value);
}
