//! Springs of any law: Newton's method on the potential energy, damped after Levenberg and Marquardt.
//!
//! The undamped exact tangent is tried first. Where it is indefinite, or its step does not lower the energy, the
//! transverse part of pushing springs is left out (Choi & Ko, "Stable but responsive cloth", 2002) and a share of each
//! node's own stiffness is added to the diagonal (Marquardt, "An algorithm for least-squares estimation of nonlinear
//! parameters", 1963), more and more until the energy falls.
//!
//! Stiff cords that have to swing far make the energy a narrow, curved valley, along which such steps are short. A net
//! that has not converged soon is therefore moved by an interior-point method first, which takes tensions as unknowns
//! of their own: a cord may be too long for its tension on the way, so no valley is followed. So a net needs no good
//! start: springs may be slack, straight under transverse load, or far off.

use super::cholesky::{Factor, Symbolic, SymmetricMatrix};
use super::state::{Equilibrium, Settings, Status, force_density, residuals};
use crate::network::{Network, Sense};
use crate::vector::{Vector, add, dot, length, scale, subtract};

/// Damping after a refused undamped step, and the least that is kept, as a share of a node's own stiffness.
const LEAST_DAMPING: f64 = 1e-9;

/// Damping beyond which a step is too short to matter.
const MOST_DAMPING: f64 = 1e12;

/// Part of a spring's length by which nodes that coincide are parted, so that it has a direction.
const PARTING: f64 = 1e-6;

/// Newton steps after which tensions become unknowns of their own.
const PATIENCE: u32 = 60;

pub(super) fn solve(network: &Network<'_>, settings: &Settings) -> Equilibrium {
    let free = FreeAxes::new(network);
    let first = Settings { iterations: settings.iterations.min(PATIENCE), ..*settings };
    let result = newton(network, &free, &first, parted(network), 0);
    let overflowed = !result.residual.is_finite();
    if result.status == Status::Converged || overflowed || result.iterations >= settings.iterations {
        return result;
    }
    let limit = MOST_INTERIOR.min(settings.iterations - result.iterations);
    let Some((moved, steps)) = interior(network, &free, &result.positions, limit) else {
        return newton(network, &free, settings, result.positions, result.iterations);
    };
    let iterations = result.iterations + steps;
    let lower = Change::new(network, &result.positions, &moved).energy < 0.0;
    newton(network, &free, settings, if lower { moved } else { result.positions }, iterations)
}

/// Newton steps from positions that took some iterations.
fn newton(
    network: &Network<'_>,
    free: &FreeAxes,
    settings: &Settings,
    mut positions: Vec<Vector>,
    mut iterations: u32,
) -> Equilibrium {
    let mut damping = 0.0;
    loop {
        let result = Equilibrium::at(network, positions, Status::Converged, iterations);
        if result.residual <= settings.tolerance || result.status != Status::Converged {
            return result;
        }
        if iterations >= settings.iterations {
            return Equilibrium { status: Status::IterationLimit, ..result };
        }
        let Some((moved, used)) = descend(network, free, &result, damping) else {
            // A tangent that is positive definite leaves nothing but rounding in the way.
            let forces = residuals(network, &result.positions);
            let solid = newton_step(network, free, &result.positions, &forces, 0.0).is_some();
            let status = if solid { Status::IterationLimit } else { Status::Singular };
            return Equilibrium { status, ..result };
        };
        positions = moved;
        damping = if used > LEAST_DAMPING { 0.1 * used } else { 0.0 };
        iterations += 1;
    }
}

/// The start, with the ends of springs of no length a little apart where their force needs a direction.
fn parted(network: &Network<'_>) -> Vec<Vector> {
    let mut positions = network.positions.to_vec();
    for (spring, &[a, b]) in network.springs.iter().enumerate() {
        let along = subtract(positions[b as usize], positions[a as usize]);
        if length(along) > 0.0 || network.force_at(spring, 0.0) == 0.0 {
            continue;
        }
        let node = if network.fixed[b as usize] == [true; 3] { a } else { b } as usize;
        let size = PARTING * network.rest_length[spring].max(PARTING);
        for axis in (0..3).filter(|&axis| !network.fixed[node][axis]) {
            // Different along each axis and for each spring, so that no symmetry holds them together.
            positions[node][axis] += size * (1.0 + 0.1 * ((spring + axis) % 7) as f64);
        }
    }
    positions
}

/// A step that lowers the energy, and the damping that it took; `None` if there is none.
fn descend(
    network: &Network<'_>,
    free: &FreeAxes,
    now: &Equilibrium,
    damping: f64,
) -> Option<(Vec<Vector>, f64)> {
    let out_of_balance = residuals(network, &now.positions);
    let mut damping = damping;
    while damping <= MOST_DAMPING {
        if let Some(step) = newton_step(network, free, &now.positions, &out_of_balance, damping) {
            let mut moved = now.positions.clone();
            let mut slope = 0.0;
            for (row, &(node, axis)) in free.axes.iter().enumerate() {
                moved[node as usize][axis] += step[row][0];
                slope += step[row][0] * out_of_balance[node as usize][axis];
            }
            let change = Change::new(network, &now.positions, &moved);
            let falls = change.energy <= -1e-4 * slope;
            // Near equilibrium rounding hides the fall of energy, not that of the residual.
            let level = change.energy <= change.noise;
            let calmer = || largest(&residuals(network, &moved)) < largest(&out_of_balance);
            if falls || (level && calmer()) {
                return Some((moved, damping));
            }
        }
        damping = if damping == 0.0 { LEAST_DAMPING } else { 10.0 * damping };
    }
    None
}

fn largest(vectors: &[Vector]) -> f64 {
    vectors.iter().map(|&vector| length(vector)).fold(0.0, f64::max)
}

/// Change of the potential energy [J] of springs and dead loads between positions.
struct Change {
    energy: f64,
    /// Rounding of `energy`.
    noise: f64,
}

impl Change {
    /// Sums the changes of all parts, which are far smaller than the parts themselves.
    fn new(network: &Network<'_>, from: &[Vector], to: &[Vector]) -> Change {
        let mut change = Change { energy: 0.0, noise: 0.0 };
        let mut add_part = |part: f64, noise: f64| {
            change.energy += part;
            change.noise += 1e-14 * (part.abs() + noise);
        };
        let moves: Vec<Vector> = from.iter().zip(to).map(|(&from, &to)| subtract(to, from)).collect();
        for spring in 0..network.springs.len() {
            let (before, moved) = (along(network, spring, from), along(network, spring, &moves));
            let lengths = [length(before), length(along(network, spring, to))];
            let total = lengths[0] + lengths[1];
            let longer = if total > 0.0 { dot(moved, add(scale(before, 2.0), moved)) / total } else { 0.0 };
            let [first, last] = lengths.map(|length| network.force_at(spring, length));
            // While it pulls all the way, the force is linear.
            let part = if first != 0.0 && last != 0.0 {
                0.5 * (first + last) * longer
            } else {
                network.energy_at(spring, lengths[1]) - network.energy_at(spring, lengths[0])
            };
            add_part(part, network.stiffness[spring] * total * longer.abs());
        }
        for (&moved, &load) in moves.iter().zip(network.loads.iter()) {
            add_part(-dot(load, moved), 0.0);
        }
        change
    }
}

fn newton_step(
    network: &Network<'_>,
    free: &FreeAxes,
    positions: &[Vector],
    out_of_balance: &[Vector],
    damping: f64,
) -> Option<Vec<[f64; 1]>> {
    // The exact tangent without damping; with damping, one that is positive definite.
    let clamped = damping > 0.0;
    free.solve(network, out_of_balance, |spring, ends| {
        let along = subtract(positions[ends[1]], positions[ends[0]]);
        let own = damping * own_stiffness(network, spring, length(along));
        (spring_tangent(network, spring, along, clamped), own)
    })
}

/// Stiffness that a spring has of its own, slack or not [N/m].
pub(super) fn own_stiffness(network: &Network<'_>, spring: usize, length: f64) -> f64 {
    let constant = network.force[spring].abs();
    network.stiffness[spring].max(if length > 0.0 { constant / length } else { constant })
}

/// k n nᵀ + (F/L)(I − n nᵀ), the second term not below zero when `clamped`.
pub(super) fn spring_tangent(
    network: &Network<'_>,
    spring: usize,
    along: Vector,
    clamped: bool,
) -> [Vector; 3] {
    let length = length(along);
    let exact = force_density(network, spring, length);
    // A spring that starts at its rest length counts as taut: rounding would decide otherwise.
    let (k, rest) = (network.stiffness[spring], network.rest_length[spring]);
    let at_rest = (network.force[spring] + k * (length - rest)).abs() <= 1e-14 * k * rest;
    let axial = if at_rest { k } else { network.stiffness_at(spring, length) };
    block(along, length, axial, if clamped { exact.max(0.0) } else { exact })
}

/// Stiffness of a spring along and across its direction.
fn block(along: Vector, length: f64, axial: f64, transverse: f64) -> [Vector; 3] {
    let normal = if length > 0.0 { scale(along, 1.0 / length) } else { [0.0; 3] };
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let identity = f64::from(u8::from(i == j));
            transverse * identity + (axial - transverse) * normal[i] * normal[j]
        })
    })
}

/// Most interior-point steps.
const MOST_INTERIOR: u32 = 60;

/// Tension times slack at which the interior-point method ends, as a share of loads times span.
const LEAST_PRODUCT: f64 = 1e-9;

/// Most that a node moves in the last interior-point step, as a share of the span.
const SETTLED: f64 = 1e-2;

/// Stiffness against moves of nodes in an interior-point step, as a share of loads over span.
const HOLD: f64 = 1e-6;

/// Part of a length or force that is left when a step would take all of it.
const MARGIN: f64 = 0.05;

/// Positions near an equilibrium, and steps, by a primal-dual interior-point method; `None` if it has no use.
///
/// Cords minimise ∑ t²/2k under length ≤ rest length + t/k, which is convex: tension and slack stay above zero, and
/// their product falls from step to step (Wright, "Primal-dual interior-point methods", 1997). The direction of a
/// constant force is an unknown of its own too (Andersen, Christiansen, Conn & Overton, "An efficient primal-dual
/// interior-point method for minimizing a sum of Euclidean norms", 2000). Other springs are taken as they pull.
fn interior(
    network: &Network<'_>,
    free: &FreeAxes,
    positions: &[Vector],
    limit: u32,
) -> Option<(Vec<Vector>, u32)> {
    let mut positions = positions.to_vec();
    let (span, force) = scales(network, &positions);
    let mut parts: Vec<Part> = (0..network.springs.len())
        .map(|spring| Part::new(network, spring, along(network, spring, &positions), span, force))
        .collect();
    let count = parts.iter().filter_map(Part::product).count() as f64;
    if !(span > 0.0 && force > 0.0) || parts.iter().all(|part| matches!(part, Part::Law)) {
        return None;
    }
    let (least, hold) = (LEAST_PRODUCT * force * span, HOLD * force / span);
    let mut target = force * span;
    let (mut share, mut moved): (f64, f64) = (1.0, 0.0);
    for iteration in 0..limit {
        let products = parts.iter().filter_map(Part::product);
        let now = if count > 0.0 { products.sum::<f64>() / count } else { target };
        if now <= 1.5 * least && share > 0.9 && moved <= SETTLED * span {
            return Some((positions, iteration));
        }
        target = least.max(if share > 0.5 { 0.1 } else { 0.5 } * now);
        let goal =
            Goal { product: target, near: span * (target / (force * span)).sqrt(), tiny: 1e-12 * span };
        let mut pull = network.loads.to_vec();
        let mut blocks = Vec::with_capacity(parts.len());
        for (spring, &[a, b]) in network.springs.iter().enumerate() {
            let along = along(network, spring, &positions);
            let (force, block) = parts[spring].linear(network, spring, along, &goal);
            blocks.push(block);
            let force = scale(along, force / length(along).max(goal.tiny));
            pull[a as usize] = add(pull[a as usize], force);
            pull[b as usize] = subtract(pull[b as usize], force);
        }
        let step = free.solve(network, &pull, |spring, _| (blocks[spring], hold))?;
        let mut moves = vec![[0.0; 3]; positions.len()];
        for (&(node, axis), [value]) in free.axes.iter().zip(step) {
            moves[node as usize][axis] = value;
        }
        let steps: Vec<PartStep> = (0..parts.len())
            .map(|spring| {
                let (now, moved) = (along(network, spring, &positions), along(network, spring, &moves));
                parts[spring].step(now, moved, &goal)
            })
            .collect();
        share = parts.iter().zip(&steps).map(|(part, step)| part.share(step)).fold(1.0, f64::min);
        moved = largest(&moves);
        for (position, step) in positions.iter_mut().zip(&moves) {
            *position = add(*position, scale(*step, share));
        }
        for (part, step) in parts.iter_mut().zip(&steps) {
            part.advance(step, share);
        }
    }
    Some((positions, limit))
}

/// Span [m] and force [N] that measure an interior-point step.
fn scales(network: &Network<'_>, positions: &[Vector]) -> (f64, f64) {
    let extent = |axis: usize| {
        let along = || positions.iter().map(|position| position[axis]);
        along().fold(f64::MIN, f64::max) - along().fold(f64::MAX, f64::min)
    };
    let span = (0..3).map(extent).fold(0.0, f64::max);
    let loads: f64 = network.loads.iter().map(|&load| length(load)).sum();
    let force = loads + network.force.iter().map(|force| force.abs()).fold(0.0, f64::max);
    let stiffness = || network.stiffness.iter().sum::<f64>() / network.springs.len() as f64;
    (span, if force > 0.0 { force } else { stiffness() * span })
}

fn along(network: &Network<'_>, spring: usize, of: &[Vector]) -> Vector {
    let [a, b] = network.springs[spring];
    subtract(of[b as usize], of[a as usize])
}

/// What an interior-point step aims at.
struct Goal {
    /// Tension times slack of every cord [J].
    product: f64,
    /// Length below which a constant force fades [m].
    near: f64,
    /// Least length that has a direction [m].
    tiny: f64,
}

/// A spring on the way of the interior-point method.
enum Part {
    Cord(Cord),
    Pull(Pull),
    /// As it pulls.
    Law,
}

/// What a whole step adds to a part.
enum PartStep {
    Cord { tension: f64, slack: f64 },
    Pull(Vector),
    Law,
}

/// A spring that goes slack: length + slack = rest + tension / stiffness.
struct Cord {
    tension: f64,
    slack: f64,
    /// Length at which it starts to pull [m]; below zero under a constant force.
    rest: f64,
    stiffness: f64,
}

/// A constant force, and its direction times a force that is below it.
struct Pull {
    force: f64,
    towards: Vector,
}

impl Part {
    fn new(network: &Network<'_>, spring: usize, along: Vector, span: f64, force: f64) -> Part {
        let (stiffness, constant) = (network.stiffness[spring], network.force[spring]);
        let rest_length = network.rest_length[spring];
        if stiffness == 0.0 && constant > 0.0 && network.sense[spring] != Sense::Compression {
            return Part::Pull(Pull {
                force: constant,
                towards: scale(along, constant / length(along).hypot(span)),
            });
        }
        if network.sense[spring] != Sense::Tension
            || stiffness == 0.0
            || (rest_length, constant) == (0.0, 0.0)
        {
            return Part::Law;
        }
        let tension = force.min(stiffness * length(along).max(1e-9 * span));
        Part::Cord(Cord { tension, slack: span, rest: rest_length - constant / stiffness, stiffness })
    }

    fn product(&self) -> Option<f64> {
        if let Part::Cord(cord) = self { Some(cord.tension * cord.slack) } else { None }
    }

    /// Tension if the ends stay, and stiffness.
    fn linear(&self, network: &Network<'_>, spring: usize, along: Vector, goal: &Goal) -> (f64, [Vector; 3]) {
        let size = length(along);
        match self {
            Part::Cord(cord) => {
                let (tension, rate) = cord.linear(size, goal.product);
                let size = size.max(goal.tiny);
                (tension, block(along, size, rate, cord.tension / size))
            }
            Part::Pull(Pull { force, towards }) => {
                let smooth = size.hypot(goal.near);
                let turned = |i: usize, j: usize| towards[i] * along[j] + along[i] * towards[j];
                let entry = |i: usize, j: usize| {
                    force / smooth * f64::from(u8::from(i == j)) - 0.5 * turned(i, j) / (smooth * smooth)
                };
                (force * size / smooth, std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))))
            }
            Part::Law => {
                let force = network.force_at(spring, size);
                (force, spring_tangent(network, spring, along, true))
            }
        }
    }

    /// What a part gains where its ends move apart by `moved`.
    fn step(&self, along: Vector, moved: Vector, goal: &Goal) -> PartStep {
        let size = length(along);
        match self {
            Part::Cord(cord) => {
                let longer = dot(along, moved) / size.max(goal.tiny);
                let (tension, rate) = cord.linear(size, goal.product);
                let tension = tension + rate * longer - cord.tension;
                let slack = tension / cord.stiffness - cord.excess(size) - longer;
                PartStep::Cord { tension, slack }
            }
            Part::Pull(Pull { force, towards }) => {
                let smooth = size.hypot(goal.near);
                let turned = scale(*towards, dot(along, moved) / (smooth * smooth));
                let reached = subtract(scale(add(along, moved), force / smooth), turned);
                PartStep::Pull(subtract(reached, *towards))
            }
            Part::Law => PartStep::Law,
        }
    }

    /// Share of a step after which tension and slack are still above zero.
    fn share(&self, step: &PartStep) -> f64 {
        let room = |value: f64, change: f64| {
            if change < 0.0 { (MARGIN - 1.0) * value / change } else { 1.0 }
        };
        match (self, step) {
            (Part::Cord(cord), PartStep::Cord { tension, slack }) => {
                room(cord.tension, *tension).min(room(cord.slack, *slack))
            }
            _ => 1.0,
        }
    }

    fn advance(&mut self, step: &PartStep, share: f64) {
        match (self, step) {
            (Part::Cord(cord), PartStep::Cord { tension, slack }) => {
                cord.tension += share * tension;
                cord.slack += share * slack;
            }
            (Part::Pull(pull), PartStep::Pull(change)) => {
                let reached = add(pull.towards, scale(*change, share));
                let most = (1.0 - MARGIN) * pull.force;
                pull.towards = scale(reached, (most / length(reached)).min(1.0));
            }
            _ => {}
        }
    }
}

impl Cord {
    /// Length that is too much for tension and slack.
    fn excess(&self, length: f64) -> f64 {
        length - self.rest - self.tension / self.stiffness + self.slack
    }

    /// Tension if the ends stay, and its change with the length, for tension times slack to become `product`.
    fn linear(&self, length: f64, product: f64) -> (f64, f64) {
        let size = self.slack + self.tension / self.stiffness;
        let change = product - self.slack * self.tension + self.tension * self.excess(length);
        (self.tension + change / size, self.tension / size)
    }
}

/// Numbers of the axes along which nodes are free, and the way back.
struct FreeAxes {
    /// Rows of the three axes of every node, or `FIXED`.
    rows: Vec<[u32; 3]>,
    /// Node and axis of every row.
    axes: Vec<(u32, usize)>,
    /// Pattern of all tangents.
    symbolic: Symbolic,
}

const FIXED: u32 = u32::MAX;

impl FreeAxes {
    fn new(network: &Network<'_>) -> Self {
        let mut axes = Vec::new();
        let mut number = |node: usize, axis: usize| {
            if network.fixed[node][axis] {
                return FIXED;
            }
            axes.push((node as u32, axis));
            (axes.len() - 1) as u32
        };
        let rows = (0..network.positions.len()).map(|node| [0, 1, 2].map(|axis| number(node, axis)));
        let rows: Vec<[u32; 3]> = rows.collect();
        let symbolic = Symbolic::new(&tangent(network, &rows, axes.len(), |_, _| ([[0.0; 3]; 3], 0.0)));
        FreeAxes { rows, axes, symbolic }
    }

    /// Moves of the free axes under forces, where each spring has a stiffness and a share of both nodes' diagonal;
    /// `None` if they hold no step.
    fn solve(
        &self,
        network: &Network<'_>,
        forces: &[Vector],
        stiffness: impl Fn(usize, [usize; 2]) -> ([Vector; 3], f64),
    ) -> Option<Vec<[f64; 1]>> {
        let matrix = tangent(network, &self.rows, self.axes.len(), stiffness);
        let factor = Factor::with_symbolic(&matrix, self.symbolic.clone()).ok()?;
        let mut step: Vec<[f64; 1]> =
            self.axes.iter().map(|&(node, axis)| [forces[node as usize][axis]]).collect();
        factor.solve(&mut step);
        Some(step)
    }
}

/// Sum of the stiffness of springs.
fn tangent(
    network: &Network<'_>,
    rows: &[[u32; 3]],
    size: usize,
    stiffness: impl Fn(usize, [usize; 2]) -> ([Vector; 3], f64),
) -> SymmetricMatrix {
    let mut diagonal = vec![0.0; size];
    let mut entries = Vec::with_capacity(15 * network.springs.len());
    for (spring, &ends) in network.springs.iter().enumerate() {
        let (block, own) = stiffness(spring, ends.map(|node| node as usize));
        let rows = ends.map(|node| rows[node as usize]);
        for rows in rows {
            for i in (0..3).filter(|&i| rows[i] != FIXED) {
                diagonal[rows[i] as usize] += block[i][i] + own;
                let below = (0..i).filter(|&j| rows[j] != FIXED);
                entries.extend(below.map(|j| (rows[i], rows[j], block[i][j])));
            }
        }
        for (i, j) in (0..9).map(|at| (at / 3, at % 3)) {
            if rows[0][i] != FIXED && rows[1][j] != FIXED {
                entries.push((rows[0][i], rows[1][j], -block[i][j]));
            }
        }
    }
    SymmetricMatrix::new(diagonal, &entries)
}
