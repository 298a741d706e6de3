//! The last digits of stiff nets: positions and lengths to twice the digits.
//!
//! A position of size X is rounded by some 10⁻¹⁶ X, which a spring of stiffness k turns into 10⁻¹⁶ k X of force: more than
//! the net carries to nine digits, where springs are stiff. Iterative refinement finds the rest of the positions: what is out
//! of balance is found to twice the digits, the step from there by a factor of the usual ones (Wilkinson, "Rounding errors in
//! algebraic processes", 1963). Sums and products to twice the digits are those of Dekker, "A floating-point technique for
//! extending the available precision", 1971. Departure: only positions and lengths have them; a force is its spring's
//! stiffness times what it is longer than its rest length, which is taken from their squares.

use super::descent::Hill;
use super::stability::factor;
use super::state::{Equilibrium, Status, force_density, load_scale};
use super::tangent::Tangent;
use crate::network::Network;
use crate::sparse::Lanes;
use crate::vector::{Vector, length, scale};

/// Most steps.
const MOST_STEPS: u32 = 20;

/// Part of a residual that two steps have to leave it below. One may raise it: what turns also stretches, which the next one
/// gives back.
const WORTH: f64 = 0.5;

/// Residual above which a net that came to no rest is not near one.
const NEAR: f64 = 1e-6;

/// Mean force below which a net carries nothing but rounding, as a share of the force that residuals are measured by.
const CARRIES: f64 = 1e-8;

/// Shifts of the tangent that are tried, as shares of what may make it indefinite: a rest that barely lasts may come out on
/// the other side by rounding, and moves along what it gives way to take little force.
const SHIFTS: [f64; 4] = [0.0, 1e-10, 1e-8, 1e-6];

/// Whether rounding of positions is more than a result's forces allow, so that [`refine`] may tell more of it.
pub(super) fn is_coarse(result: &Equilibrium, least_force: f64, tolerance: f64, limit: u32) -> bool {
    let mean = mean_force(&result.forces);
    match result.status {
        Status::Converged => mean < least_force && mean > CARRIES * least_force,
        // Rounding, not the limit, ended it.
        Status::IterationLimit => result.iterations < limit && result.residual <= NEAR.max(tolerance),
        _ => false,
    }
}

/// Refines a result until its residual is within the tolerance by its own forces, under given loads [N]; leaves it as it is
/// if that is out of reach. A rest that was not found to be stable has to be here.
pub(super) fn refine(
    hill: Hill<'_>,
    tangent: &mut Tangent,
    loads: &[Vector],
    tolerance: f64,
    result: &mut Equilibrium,
) {
    let lanes: Vec<Lanes> = result.positions.iter().map(|&[x, y, z]| [x, y, z, 0.0]).collect();
    let shifts = if result.status == Status::Converged { &SHIFTS[..] } else { &SHIFTS[..1] };
    for &shift in shifts {
        if factor(hill, tangent, &lanes, shift) && refine_by(hill, tangent, loads, tolerance, result) {
            return;
        }
    }
}

/// Refines by a tangent that is factored; false if the residual stays above the tolerance.
fn refine_by(
    hill: Hill<'_>,
    tangent: &mut Tangent,
    loads: &[Vector],
    tolerance: f64,
    result: &mut Equilibrium,
) -> bool {
    let mut positions: Vec<[Twofold; 3]> =
        result.positions.iter().map(|position| position.map(Twofold::from)).collect();
    let least = load_scale(hill.network);
    let mut last = [f64::INFINITY; 2];
    for _ in 0..MOST_STEPS {
        let (forces, mut pulls) = look(hill, &positions, loads);
        let sizes = pulls.iter().map(|&[x, y, z, _]| length([x, y, z])).enumerate();
        let larger = |worst: (usize, f64), next: (usize, f64)| if next.1 > worst.1 { next } else { worst };
        let (worst, largest) = sizes.fold((0, 0.0), larger);
        let residual = largest / mean_force(&forces).max(least);
        if residual <= tolerance {
            result.positions = positions.iter().map(|position| position.map(|part| part.value)).collect();
            (result.forces, result.residual, result.status) = (forces, residual, Status::Converged);
            result.worst = (largest > 0.0).then_some(worst as u32);
            return true;
        }
        if residual.is_nan() || residual >= WORTH * last[0] {
            return false;
        }
        last = [last[1], residual];
        tangent.solve(hill.supports, &mut pulls);
        for (position, step) in positions.iter_mut().zip(&pulls) {
            (0..3).for_each(|axis| position[axis] = position[axis].plus(Twofold::from(step[axis])));
        }
    }
    false
}

/// Forces of springs, and free parts of the pull on every node.
fn look(hill: Hill<'_>, positions: &[[Twofold; 3]], loads: &[Vector]) -> (Vec<f64>, Vec<Lanes>) {
    let Hill { network, elements, supports, .. } = hill;
    let mut pulls: Vec<Lanes> = loads.iter().map(|&[x, y, z]| [x, y, z, 0.0]).collect();
    let mut add = |node: u32, pull: Vector, sign: f64| {
        (0..3).for_each(|axis| pulls[node as usize][axis] += sign * pull[axis]);
    };
    let along = |a: u32, b: u32| -> [Twofold; 3] {
        let [from, to] = [a, b].map(|node| positions[node as usize]);
        std::array::from_fn(|axis| to[axis].plus(from[axis].negative()))
    };
    let rounded = |along: [Twofold; 3]| along.map(|part| part.value);
    let mut forces = Vec::with_capacity(network.springs.len());
    for (spring, &[a, b]) in network.springs.iter().enumerate() {
        let along = along(a, b);
        let (size, longer) = stretch(network, spring, along);
        let force = network.force_beyond(spring, longer);
        let pull = scale(rounded(along), force_density(network, spring, size, force));
        add(a, pull, 1.0);
        add(b, pull, -1.0);
        forces.push(force);
    }
    for bend in &elements.bends {
        let [a, b, c] = bend.nodes;
        let [first, second] = bend.bending([rounded(along(a, b)), rounded(along(b, c))], false).forces;
        add(a, first, 1.0);
        add(b, second, 1.0);
        add(b, first, -1.0);
        add(c, second, -1.0);
    }
    supports.keep_free(&mut pulls);
    (forces, pulls)
}

/// Length of a spring, and what it is longer than its rest length: (l² − r²)/(l + r).
fn stretch(network: &Network<'_>, spring: usize, along: [Twofold; 3]) -> (f64, f64) {
    let rest = network.rest_length[spring];
    let square = along.iter().fold(Twofold::from(0.0), |sum, part| sum.plus(part.square()));
    let size = square.value.sqrt();
    let more = square.plus(Twofold::from(rest).square().negative());
    let both = size + rest;
    (size, if both > 0.0 { more.value / both } else { 0.0 })
}

fn mean_force(forces: &[f64]) -> f64 {
    forces.iter().map(|force| force.abs()).sum::<f64>() / forces.len().max(1) as f64
}

/// A number to twice the digits: its value, and what that lacks.
#[derive(Clone, Copy)]
struct Twofold {
    value: f64,
    lacks: f64,
}

impl From<f64> for Twofold {
    fn from(value: f64) -> Self {
        Twofold { value, lacks: 0.0 }
    }
}

impl Twofold {
    fn plus(self, other: Twofold) -> Twofold {
        let value = self.value + other.value;
        let of_other = value - self.value;
        let lost = (self.value - (value - of_other)) + (other.value - of_other);
        Twofold::normal(value, lost + self.lacks + other.lacks)
    }

    fn negative(self) -> Twofold {
        Twofold { value: -self.value, lacks: -self.lacks }
    }

    fn square(self) -> Twofold {
        let value = self.value * self.value;
        let lost = self.value.mul_add(self.value, -value);
        Twofold::normal(value, lost + 2.0 * self.value * self.lacks)
    }

    /// A sum whose second part is small beside the first.
    fn normal(value: f64, lacks: f64) -> Twofold {
        let sum = value + lacks;
        Twofold { value: sum, lacks: lacks - (sum - value) }
    }
}
