//! The interior-point phase for stiff and far-off nets: tensions as unknowns of their own.

use super::descent::Hill;
use super::mixed::extent;
use super::tangent::{Tangent, along, block, links, own_bend_stiffness, spring_tangent};
use crate::network::{Network, Sense};
use crate::sparse::Lanes;
use crate::vector::{Vector, add, dot, length, scale, subtract};

/// Most interior-point steps.
pub(super) const MOST_INTERIOR: u32 = 60;

/// Tension times slack at which the interior-point method ends, as a share of loads times span.
const LEAST_PRODUCT: f64 = 1e-9;

/// Most that a node moves in the last interior-point step, as a share of the span.
const SETTLED: f64 = 1e-2;

/// Stiffness against moves of nodes in an interior-point step, as a share of loads over span.
const HOLD: f64 = 1e-6;

/// Least slope of a line that touches a measured curve, as a share of its secant's.
const LEAST_SLOPE: f64 = 1e-3;

/// Part of a length or force that is left when a step would take all of it.
const MARGIN: f64 = 0.05;

/// Positions near an equilibrium, and steps, by a primal-dual interior-point method; `None` if it has no use.
///
/// Cords minimise ∑ t²/2k under length ≤ rest length + t/k, which is convex: tension and slack stay above zero, and
/// their product falls from step to step (Wright, "Primal-dual interior-point methods", 1997). The direction of a
/// constant force is an unknown of its own too (Andersen, Christiansen, Conn & Overton, "An efficient primal-dual
/// interior-point method for minimizing a sum of Euclidean norms", 2000). Other springs are taken as they pull.
pub(super) fn interior(
    hill: Hill<'_>,
    tangent: &mut Tangent,
    positions: &[Lanes],
    limit: u32,
) -> Option<(Vec<Lanes>, u32)> {
    let Hill { network, elements, supports, layout, .. } = hill;
    let mut positions = positions.to_vec();
    let (span, force) = scales(hill, &positions);
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
        for (spring, part) in parts.iter_mut().enumerate() {
            part.follow_curve(network, spring, length(along(network, spring, &positions)));
        }
        let products = parts.iter().filter_map(Part::product);
        let now = if count > 0.0 { products.sum::<f64>() / count } else { target };
        if now <= 1.5 * least && share > 0.9 && moved <= SETTLED * span {
            return Some((positions, iteration));
        }
        target = least.max(if share > 0.5 { 0.1 } else { 0.5 } * now);
        let goal =
            Goal { product: target, near: span * (target / (force * span)).sqrt(), tiny: 1e-12 * span };
        let mut moves = elements.loads().to_vec();
        let mut blocks = Vec::with_capacity(parts.len());
        for (spring, &[a, b]) in network.springs.iter().enumerate() {
            let along = along(network, spring, &positions);
            let (force, block) = parts[spring].linear(network, spring, along, &goal);
            blocks.push((block, hold));
            let density = force / length(along).max(goal.tiny);
            for axis in 0..3 {
                moves[a as usize][axis] += density * along[axis];
                moves[b as usize][axis] -= density * along[axis];
            }
        }
        let bends = elements.bends.iter().map(|bend| {
            let bending = bend.bending(links(bend, &positions), true);
            (bending.stiffness, hold + 1e-9 * own_bend_stiffness(bend))
        });
        for bend in &elements.bends {
            let [first, second] = bend.bending(links(bend, &positions), true).forces;
            let [a, b, c] = bend.nodes.map(|node| node as usize);
            for axis in 0..3 {
                moves[a][axis] += first[axis];
                moves[b][axis] += second[axis] - first[axis];
                moves[c][axis] -= second[axis];
            }
        }
        supports.keep_free(&mut moves);
        tangent.factor(layout, supports, blocks.iter().copied(), bends).ok()?;
        tangent.solve(supports, &mut moves);
        let steps: Vec<PartStep> = (0..parts.len())
            .map(|spring| {
                let (now, moved) = (along(network, spring, &positions), along(network, spring, &moves));
                parts[spring].step(now, moved, &goal)
            })
            .collect();
        share = parts.iter().zip(&steps).map(|(part, step)| part.share(step)).fold(1.0, f64::min);
        moved = moves.iter().map(|&[x, y, z, _]| length([x, y, z])).fold(0.0, f64::max);
        for (position, step) in positions.iter_mut().zip(&moves) {
            (0..3).for_each(|axis| position[axis] += share * step[axis]);
        }
        supports.put_back(network, &mut positions);
        for (part, step) in parts.iter_mut().zip(&steps) {
            part.advance(step, share);
        }
    }
    Some((positions, limit))
}

/// Span [m] and force [N] that measure an interior-point step.
fn scales(hill: Hill<'_>, positions: &[Lanes]) -> (f64, f64) {
    let network = hill.network;
    let span = extent(positions);
    let loads: f64 = hill.elements.loads().iter().map(|&[x, y, z, _]| length([x, y, z])).sum();
    let force = loads + network.force.iter().map(|force| force.abs()).fold(0.0, f64::max);
    let stiffness = || network.stiffness.iter().sum::<f64>() / network.springs.len() as f64;
    (span, if force > 0.0 { force } else { stiffness() * span })
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

    /// Takes the line that touches a measured curve at a length, or at its rest length where it is slack.
    fn follow_curve(&mut self, network: &Network<'_>, spring: usize, length: f64) {
        let (Part::Cord(cord), Some(curve)) = (self, network.curve_of(spring)) else { return };
        let (k, rest) = (network.stiffness[spring], network.rest_length[spring]);
        let length = length.max(rest);
        cord.stiffness = k * curve.slope((length - rest) / rest).max(LEAST_SLOPE);
        cord.rest = length - network.force_at(spring, length) / cord.stiffness;
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
