//! The solver: a workspace that solves network after network, and the choice of method.

use super::descent::{Descent, Hill};
use super::elements::Elements;
use super::followers::{Accelerated, follow};
use super::interior::{MOST_INTERIOR, interior};
use super::linear::Linear;
use super::mixed::{MOST_MIXED, mixed};
use super::newton::{Change, Ended, Newton};
use super::refinement::{is_coarse, refine};
use super::stability::{may_be_unstable, pushes, way_off};
use super::state::{Equilibrium, Method, Settings, Status, least_force_scale, loads, unheld_node};
use super::supports::Supports;
use super::tangent::{Layout, along};
use crate::network::Network;
use crate::rod::Bend;
use crate::sparse::Lanes;
use crate::stage::Stage;
use crate::vector::{Vector, length};

/// Most steps in a scalar metric.
const MOST_DESCENT: u32 = 150;

/// Newton steps after which tensions become unknowns of their own.
const PATIENCE: u32 = 60;

/// Times that tensions become unknowns of their own before Newton's steps have the rest.
const MOST_ROUNDS: u32 = 3;

/// Most times that loads follow the shape.
const MOST_FOLLOWED: u32 = 200;

/// Most rests that a net under loads that follow the shape leaves.
const MOST_LEFT: u32 = 10;

/// Part of a spring's length by which nodes that coincide are parted, so that it has a direction.
const PARTING: f64 = 1e-6;

/// Solves a network that passes [`Network::check`].
pub fn solve(network: &Network<'_>, settings: &Settings) -> Equilibrium {
    Solver::default().solve(network, settings)
}

/// Workspace of solves; networks solved one after the other share its memory, and the order of elimination if their
/// pattern is the same. What it solved before changes no result.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Solver {
    supports: Supports,
    elements: Elements,
    layout: Layout,
    linear: Linear,
    descent: Descent,
    newton: Newton,
    bends: Vec<Bend>,
    positions: Vec<Lanes>,
}

impl Solver {
    /// Solves a network that passes [`Network::check`].
    pub fn solve(&mut self, network: &Network<'_>, settings: &Settings) -> Equilibrium {
        let mut result = Equilibrium::default();
        self.solve_into(network, settings, &mut result);
        result
    }

    /// Solves a network that passes [`Network::check`] into a result whose memory is used again.
    pub fn solve_into(&mut self, network: &Network<'_>, settings: &Settings, result: &mut Equilibrium) {
        self.solve_ordered_into(network, settings, None, result, &mut |_| {});
    }

    /// Solves in a given order of elimination, that of a net of about the same pattern, which saves ordering; `order`
    /// has every node once, held nodes or not. Tells `observe` when a stage ends.
    ///
    /// Another order changes a result by rounding only.
    pub fn solve_ordered_into(
        &mut self,
        network: &Network<'_>,
        settings: &Settings,
        order: Option<&[u32]>,
        result: &mut Equilibrium,
        observe: &mut impl FnMut(Stage),
    ) {
        if let Some(node) = unheld_node(network) {
            *result = Equilibrium::at(network, network.positions.to_vec(), Status::Unheld { node }, 0);
            return;
        }
        self.supports.build(network);
        if network.is_linear() {
            self.layout.build(network, &[], &self.supports, order);
            observe(Stage::Order);
            self.linear.solve(network, &self.supports, &self.layout, settings, result, observe);
            return;
        }
        self.bends.clear();
        self.bends.extend(network.rods.iter().flat_map(|rod| rod.bends()));
        self.layout.build(network, &self.bends, &self.supports, order);
        observe(Stage::Order);
        *result = if network.has_followers() {
            self.follow(network, settings)
        } else {
            let (positions, status, iterations, method) =
                self.still(network, settings, &network.positions, None, settings.iterations);
            // Numbers overflowed: the start tells more than what is left of them.
            let lost = positions.iter().flatten().any(|coordinate| !coordinate.is_finite());
            let (positions, status) =
                if lost { (network.positions.to_vec(), Status::Singular) } else { (positions, status) };
            Equilibrium { method, ..Equilibrium::at(network, positions, status, iterations) }
        };
        let least_force = least_force_scale(network);
        if is_coarse(result, least_force, settings.tolerance, settings.iterations) {
            let Solver { supports, elements, layout, newton, .. } = self;
            let hill = Hill { network, elements, supports, layout, least_force };
            let loads = loads(network, &result.positions);
            refine(hill, &mut newton.tangent, &loads, settings.tolerance, result);
        }
        observe(Stage::Solve);
    }

    /// The order of elimination of the network that was solved last: its free nodes.
    pub fn order(&self) -> impl Iterator<Item = u32> + '_ {
        self.layout.symbolic.order().iter().map(|&row| self.supports.nodes[row as usize])
    }

    /// Solves under loads that follow the shape, and goes on from a rest that would not last if its loads kept their
    /// directions, as long as that leads to another.
    fn follow(&mut self, network: &Network<'_>, settings: &Settings) -> Equilibrium {
        let mut rest = self.follow_from(network, settings, &network.positions, settings.iterations);
        for _ in 0..MOST_LEFT {
            let left = settings.iterations.saturating_sub(rest.iterations + 1);
            if rest.status != Status::Converged || left == 0 || !may_be_unstable(network) {
                break;
            }
            let mut loads = vec![[0.0; 3]; rest.positions.len()];
            follow(network, &rest.positions, &mut loads);
            self.elements.build(network, &loads);
            let Solver { supports, elements, layout, newton, .. } = self;
            let hill = Hill { network, elements, supports, layout, least_force: least_force_scale(network) };
            let positions: Vec<Lanes> = rest.positions.iter().map(|&[x, y, z]| [x, y, z, 0.0]).collect();
            let pushed = pushes(hill, &positions, settings.tolerance);
            let way = if pushed { way_off(hill, &mut newton.tangent, &positions) } else { None };
            let Some(moved) = way else { break };
            let moved: Vec<Vector> = moved.iter().map(|&[x, y, z, _]| [x, y, z]).collect();
            let next = self.follow_from(network, settings, &moved, left);
            // Loads that follow may hold what they would not hold otherwise.
            if next.status != Status::Converged {
                break;
            }
            rest = Equilibrium { iterations: rest.iterations + 1 + next.iterations, ..next };
        }
        rest
    }

    /// Solves under loads that follow the shape: again and again under the loads that the last shape gives.
    fn follow_from(
        &mut self,
        network: &Network<'_>,
        settings: &Settings,
        start: &[Vector],
        limit: u32,
    ) -> Equilibrium {
        let rest = Equilibrium::at(network, start.to_vec(), Status::Converged, 0);
        if rest.residual <= settings.tolerance {
            return Equilibrium { method: Method::Newton, ..rest };
        }
        let inner = Settings { tolerance: 0.1 * settings.tolerance, ..*settings };
        let mut accelerated = Accelerated::default();
        let mut start = start.to_vec();
        let mut best: Option<Equilibrium> = None;
        let mut iterations = 0;
        for _ in 0..MOST_FOLLOWED {
            let mut loads = vec![[0.0; 3]; start.len()];
            follow(network, &start, &mut loads);
            let left = limit.saturating_sub(iterations);
            let (moved, status, used, method) = self.still(network, &inner, &start, Some(&loads), left);
            iterations += used;
            let state =
                Equilibrium { method, ..Equilibrium::at(network, moved, Status::Converged, iterations) };
            if state.residual <= settings.tolerance {
                return state;
            }
            if state.status == Status::Singular {
                // Numbers overflowed: the last shape that has them all tells more.
                break;
            }
            let moved = state.positions.clone();
            if best.as_ref().is_none_or(|best| state.residual < best.residual) {
                best = Some(Equilibrium { status: Status::Unstable, ..state });
            }
            // A step that stopped short of equilibrium still tells the way; one that can't move does not.
            if left == 0 || status == Status::Singular {
                break;
            }
            start = accelerated.next(start, moved);
        }
        best.map_or_else(
            || Equilibrium::at(network, network.positions.to_vec(), Status::Unstable, iterations),
            |best| Equilibrium { iterations, ..best },
        )
    }

    /// Solves under dead loads, `more` on top of the network's: positions, status, iterations, method. `more` stands for
    /// loads that follow the shape; whether a rest under them is stable is not looked at here, for they are on their way.
    fn still(
        &mut self,
        network: &Network<'_>,
        settings: &Settings,
        start: &[Vector],
        more: Option<&[Vector]>,
        limit: u32,
    ) -> (Vec<Vector>, Status, u32, Method) {
        self.elements.build(network, more.unwrap_or_default());
        let mut positions = std::mem::take(&mut self.positions);
        parted(network, &self.supports, start, &mut positions);
        let (status, iterations, method) = if more.is_some() {
            self.move_to_rest(network, settings, &mut positions, limit, false)
        } else {
            self.move_to_stable_rest(network, settings, &mut positions, limit)
        };
        let moved = positions.iter().map(|&[x, y, z, _]| [x, y, z]).collect();
        self.positions = positions;
        (moved, status, iterations, method)
    }

    /// Moves to rest, and on from where rest is unstable, as a straight strut above its buckling load; on from saddles, too,
    /// as a shallow arch that goes over sideways.
    fn move_to_stable_rest(
        &mut self,
        network: &Network<'_>,
        settings: &Settings,
        positions: &mut Vec<Lanes>,
        limit: u32,
    ) -> (Status, u32, Method) {
        let doubtful = may_be_unstable(network);
        let (mut status, mut iterations, mut method) =
            self.move_to_rest(network, settings, positions, limit, doubtful);
        loop {
            let settled = matches!(status, Status::Converged | Status::Singular | Status::UnstableRest);
            if !settled || !doubtful {
                return (status, iterations, method);
            }
            let Solver { supports, elements, layout, newton, .. } = self;
            let hill = Hill { network, elements, supports, layout, least_force: least_force_scale(network) };
            let pushed = pushes(hill, positions, settings.tolerance);
            let way = if pushed { way_off(hill, &mut newton.tangent, positions) } else { None };
            let on_saddle = status == Status::UnstableRest;
            let Some(mut moved) = way else {
                if !on_saddle {
                    return (status, iterations, method);
                }
                let left = limit - iterations;
                let (next, steps, by) = self.move_to_rest(network, settings, positions, left, false);
                (status, method) = (next, by);
                iterations += steps;
                continue;
            };
            if iterations >= limit {
                let status = if on_saddle { Status::IterationLimit } else { Status::UnstableRest };
                return (status, iterations, method);
            }
            // The step off counts too, so that there is an end of it.
            iterations += 1;
            let left = limit - iterations;
            let (next, steps, by) = self.move_to_rest(network, settings, &mut moved, left, true);
            iterations += steps;
            if next == Status::Singular && status == Status::Converged {
                return (Status::UnstableRest, iterations, method);
            }
            *positions = moved;
            (status, method) = (next, by);
        }
    }

    /// The method that fits first, then the next where it does not get there; *unstable rest* if it is to `leave_saddles`
    /// and comes to one.
    fn move_to_rest(
        &mut self,
        network: &Network<'_>,
        settings: &Settings,
        positions: &mut Vec<Lanes>,
        limit: u32,
        leave_saddles: bool,
    ) -> (Status, u32, Method) {
        let Solver { supports, elements, layout, descent, newton, .. } = self;
        let hill = Hill { network, elements, supports, layout, least_force: least_force_scale(network) };
        let mut iterations = 0;
        if elements.bends.is_empty() {
            let descended = descent.descend(hill, positions, settings, limit.min(MOST_DESCENT));
            iterations = descended.iterations;
            if descended.converged {
                return (Status::Converged, iterations, Method::Preconditioned);
            }
        }
        if !elements.bends.is_empty() {
            let patience = MOST_MIXED.min(limit - iterations);
            iterations += mixed(hill, &mut newton.tangent, positions, settings.tolerance, patience);
        }
        let patience = PATIENCE.min(limit - iterations);
        let (ended, steps) = newton.solve(hill, positions, settings, patience, leave_saddles);
        iterations += steps;
        if matches!(ended, Ended::Converged | Ended::Saddle | Ended::Overflow) || iterations >= limit {
            return (status(ended), iterations, Method::Newton);
        }
        let mut method = Method::Newton;
        let mut round = 1;
        loop {
            let patience = MOST_INTERIOR.min(limit - iterations);
            if let Some((moved, steps)) = interior(hill, &mut newton.tangent, positions, patience) {
                iterations += steps;
                if Change::new(hill, positions, &moved).energy < 0.0 {
                    *positions = moved;
                    method = Method::Interior;
                }
            }
            let left = limit - iterations;
            let patience = if round == MOST_ROUNDS { left } else { PATIENCE.min(left) };
            let (ended, steps) = newton.solve(hill, positions, settings, patience, leave_saddles);
            iterations += steps;
            if ended != Ended::Limit || iterations >= limit || round == MOST_ROUNDS {
                return (status(ended), iterations, method);
            }
            round += 1;
        }
    }
}

fn status(ended: Ended) -> Status {
    match ended {
        Ended::Converged => Status::Converged,
        Ended::Saddle => Status::UnstableRest,
        Ended::Limit | Ended::Rounding => Status::IterationLimit,
        Ended::Singular | Ended::Overflow => Status::Singular,
    }
}

/// The start, with the ends of springs of no length a little apart where their force needs a direction.
fn parted(network: &Network<'_>, supports: &Supports, start: &[Vector], positions: &mut Vec<Lanes>) {
    positions.clear();
    positions.extend(start.iter().map(|&[x, y, z]| [x, y, z, 0.0]));
    for (spring, &[a, b]) in network.springs.iter().enumerate() {
        if length(along(network, spring, positions)) > 0.0 || network.force_at(spring, 0.0) == 0.0 {
            continue;
        }
        let node = if network.fixed[b as usize] == [true; 3] { a } else { b } as usize;
        let size = PARTING * network.rest_length[spring].max(PARTING);
        // Different along each axis and for each spring, so that no symmetry holds them together.
        let apart = std::array::from_fn(|axis| size * (1.0 + 0.1 * ((spring + axis) % 7) as f64));
        for (position, apart) in positions[node].iter_mut().zip(supports.free_part(node, apart)) {
            *position += apart;
        }
    }
}
