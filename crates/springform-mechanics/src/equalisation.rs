//! Equalisation: stiffness tuned within bounds so that spring forces even out, at a given topology.
//!
//! The force differential is the range of the log forces. A smooth measure above it, the log-sum-exp
//! log(Σ F^p)/p + log(Σ F^−p)/p, is lowered by [`crate::bounded`] steps in the logarithms of the stiffness factors, and p
//! rises stage by stage until the measure is as sharp as the differential. Gradients come from
//! [`crate::equilibrium::sensitivity`]. Where factors must be a few values, springs are set to them share by share, those
//! that are closest first, while the others are tuned on; in the end single springs are changed as long as that helps.

use crate::bounded::{Descent, Valley};
use crate::equilibrium::sensitivity::{Sensitivity, SensitivityError};
use crate::equilibrium::{Equilibrium, Settings, Solver, Status};
use crate::measures::force_differential;
use crate::network::Network;
use thiserror::Error;

/// Powers p of the stages.
const SHARPNESS: [f64; 6] = [4.0, 16.0, 64.0, 128.0, 256.0, 512.0];

/// Steps over which a stage must lower its measure by [`PROGRESS`], or the next stage begins.
const PATIENCE: usize = 20;
const PROGRESS: f64 = 3e-4;

/// Part of the springs without a value that are set to one at once.
const SET_AT_ONCE: f64 = 0.25;

/// Steps that tune the others after some springs were set.
const STEPS_BETWEEN: usize = 15;

/// Single springs that are tried before a change of one is given up.
const MOST_TRIED: usize = 40;

/// Which factors on the stiffness are allowed.
#[derive(Clone, PartialEq, Debug)]
pub enum Allowed {
    /// All between two bounds, 1 among them.
    Between([f64; 2]),
    /// A few values, 1 among them.
    Values(Vec<f64>),
}

/// Why forces can't be equalised.
#[derive(Clone, PartialEq, Debug, Error)]
pub enum EqualisationError {
    /// Factors that are not allowed.
    #[error("must be {0}")]
    Allowed(&'static str),
    /// A net that is not at rest.
    #[error("the net finds no equilibrium to start from")]
    Equilibrium,
    /// A net whose differential is undefined.
    #[error(
        "spring {spring} carries a force of {force:.3e} N, so that the force differential is undefined; let every spring pull"
    )]
    Slack {
        /// The spring of the smallest force.
        spring: usize,
        /// Its force [N].
        force: f64,
    },
    /// An equilibrium without derivatives.
    #[error(transparent)]
    Sensitivity(#[from] SensitivityError),
}

/// What is done next.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Phase {
    /// Steps within the bounds at a stage.
    Tune {
        stage: usize,
    },
    /// Steps of the springs without a value.
    Set {
        steps: usize,
    },
    /// Changes of single springs.
    Single,
    Done,
}

/// Stiffness on its way to even forces; m springs, of which some are tuned.
pub struct Equalisation {
    net: Net,
    /// Smallest and largest factor.
    range: [f64; 2],
    /// The few values, and their logarithms; empty if all between the bounds are allowed.
    values: Vec<f64>,
    allowed: Vec<f64>,
    /// Bounds of the logarithms.
    bounds: Vec<[f64; 2]>,
    descent: Descent,
    phase: Phase,
    /// Values at the last steps of this stage.
    lately: Vec<f64>,
    best: (f64, Vec<f64>),
    before: f64,
    now: f64,
    iterations: u32,
}

/// The net as a function of the logarithms of its factors.
struct Net {
    network: Network<'static>,
    stiffness: Vec<f64>,
    solver: Solver,
    /// The springs that are tuned and counted.
    tuned: Vec<usize>,
    settings: Settings,
    sensitivity: Sensitivity,
    equilibrium: Equilibrium,
    sharpness: f64,
}

impl Equalisation {
    /// Starts with a network that passes [`Network::check`], all factors 1; `tuned` are the springs, one or more, that are
    /// tuned and whose forces count, ascending.
    ///
    /// # Errors
    /// Factors that are not allowed, or a net without equilibrium, differential or derivatives.
    pub fn new(
        network: Network<'static>,
        tuned: Vec<usize>,
        allowed: &Allowed,
        settings: Settings,
    ) -> Result<Self, EqualisationError> {
        let ([low, high], values) = check(allowed)?;
        let start = vec![0.0; tuned.len()];
        let mut net = Net {
            stiffness: network.stiffness.to_vec(),
            network,
            tuned,
            solver: Solver::default(),
            settings,
            sensitivity: Sensitivity::default(),
            equilibrium: Equilibrium::default(),
            sharpness: SHARPNESS[0],
        };
        net.solve(&start)?;
        let before = net.differential().ok_or_else(|| net.weakest())?;
        net.sensitivity.build(&net.network, &net.equilibrium.positions)?;
        Ok(Equalisation {
            range: [low, high],
            values: values.to_vec(),
            allowed: values.iter().map(|value| value.ln()).collect(),
            bounds: vec![[low.ln(), high.ln()]; start.len()],
            descent: Descent::start(&mut net, start.clone()).ok_or(EqualisationError::Equilibrium)?,
            phase: Phase::Tune { stage: 0 },
            lately: Vec::new(),
            best: (before, start),
            before,
            now: before,
            iterations: 0,
            net,
        })
    }

    /// Makes one step; false once there is none left to make.
    pub fn advance(&mut self) -> bool {
        match self.phase {
            Phase::Tune { stage } => self.tune(stage),
            Phase::Set { steps } => self.set(steps),
            Phase::Single => self.change_few(),
            Phase::Done => return false,
        }
        self.iterations += 1;
        true
    }

    /// Factor on the stiffness of every spring, m: the best so far of those that are allowed, 1 for those not tuned.
    pub fn factors(&self) -> Vec<f64> {
        let [low, high] = self.range;
        let value = |log: f64| self.allowed.iter().position(|value| *value == log).map(|at| self.values[at]);
        // The exponential of a logarithm is off by rounding.
        let mut factors = vec![1.0; self.net.stiffness.len()];
        for (&spring, &log) in self.net.tuned.iter().zip(&self.best.1) {
            factors[spring] = value(log).unwrap_or_else(|| log.exp().clamp(low, high));
        }
        factors
    }

    /// Force differential before.
    pub fn before(&self) -> f64 {
        self.before
    }

    /// Force differential with [`Equalisation::factors`], at most that before.
    pub fn differential(&self) -> f64 {
        self.best.0
    }

    /// Force differential where the steps are now: on the way to a few values, that of factors in between.
    pub fn differential_now(&self) -> f64 {
        self.now
    }

    /// Steps made.
    pub fn iterations(&self) -> u32 {
        self.iterations
    }

    fn tune(&mut self, stage: usize) {
        let fell = self.step();
        let value = self.descent.value();
        self.lately.push(value);
        let slow = self.lately.len() > PATIENCE
            && self.lately[self.lately.len() - 1 - PATIENCE] - value < PROGRESS * value;
        if fell && !slow {
            return;
        }
        self.lately.clear();
        self.phase = if let Some(&sharpness) = SHARPNESS.get(stage + 1) {
            self.go_on(self.descent.point().to_vec(), sharpness, Phase::Tune { stage: stage + 1 })
        } else if self.allowed.is_empty() {
            Phase::Done
        } else {
            Phase::Set { steps: STEPS_BETWEEN }
        };
    }

    /// A step of the springs without a value; after some steps, sets more springs to values.
    fn set(&mut self, steps: usize) {
        if steps < STEPS_BETWEEN && self.step() {
            self.phase = Phase::Set { steps: steps + 1 };
            return;
        }
        let mut point = self.descent.point().to_vec();
        let mut open: Vec<(usize, f64)> = (0..point.len())
            .filter(|&spring| self.bounds[spring][0] < self.bounds[spring][1])
            .map(|spring| (spring, nearest(&self.allowed, point[spring])))
            .collect();
        if open.is_empty() {
            self.phase = self.go_on(point, SHARPNESS[SHARPNESS.len() - 2], Phase::Single);
            return;
        }
        open.sort_by(|a, b| (a.1 - point[a.0]).abs().total_cmp(&(b.1 - point[b.0]).abs()));
        let count = (SET_AT_ONCE * open.len() as f64).ceil() as usize;
        let few = open.len() <= point.len() / 20;
        for &(spring, value) in &open[..if few { open.len() } else { count }] {
            point[spring] = value;
            self.bounds[spring] = [value; 2];
        }
        self.phase = self.go_on(point, SHARPNESS[2], Phase::Set { steps: 0 });
    }

    /// Changes the springs to a neighbouring value that promise most: several at once, or fewer, or another one.
    fn change_few(&mut self) {
        let changes = self.promising();
        let groups = [32, 16, 8, 4, 2].into_iter().filter(|size| *size <= changes.len());
        let singles = (0..changes.len()).map(|at| at..at + 1);
        for range in groups.map(|size| 0..size).chain(singles) {
            let mut point = self.descent.point().to_vec();
            changes[range].iter().for_each(|&(spring, value)| point[spring] = value);
            if self.net.value(&point).is_some_and(|value| value < self.descent.value()) {
                self.phase = self.go_on(point, self.net.sharpness, Phase::Single);
                return;
            }
        }
        self.phase = Phase::Done;
    }

    /// Springs and neighbouring values that lower the measure most by its gradient.
    fn promising(&self) -> Vec<(usize, f64)> {
        let (point, gradient) = (self.descent.point(), self.descent.gradient());
        let mut changes: Vec<(f64, usize, f64)> = Vec::new();
        for (spring, (&log, &slope)) in point.iter().zip(gradient).enumerate() {
            let beyond = self.allowed.iter().filter(|value| (**value - log) * slope < 0.0);
            let next = beyond.min_by(|a, b| (**a - log).abs().total_cmp(&(**b - log).abs()));
            changes.extend(next.map(|&value| ((value - log) * slope, spring, value)));
        }
        changes.sort_by(|a, b| a.0.total_cmp(&b.0));
        changes.truncate(MOST_TRIED);
        changes.into_iter().map(|(_, spring, value)| (spring, value)).collect()
    }

    /// One step within the bounds; false if there is none.
    fn step(&mut self) -> bool {
        let fell = self.descent.step(&mut self.net, &self.bounds);
        if fell {
            self.look();
        }
        fell
    }

    /// Starts anew at a point; the phase that follows.
    fn go_on(&mut self, point: Vec<f64>, sharpness: f64, next: Phase) -> Phase {
        self.net.sharpness = sharpness;
        match Descent::start(&mut self.net, point) {
            Some(descent) => {
                self.descent = descent;
                self.look();
                next
            }
            None => Phase::Done,
        }
    }

    /// Looks at the net where the descent is, and keeps the point if it is allowed and the best.
    fn look(&mut self) {
        let Some(differential) = self.net.differential() else { return };
        self.now = differential;
        let point = self.descent.point();
        let allowed = self.allowed.is_empty() || point.iter().all(|log| self.allowed.contains(log));
        if allowed && differential < self.best.0 {
            self.best = (differential, point.to_vec());
        }
    }
}

impl Net {
    /// Solves at a point, from the last equilibrium.
    fn solve(&mut self, point: &[f64]) -> Result<(), EqualisationError> {
        let stiffness = self.network.stiffness.to_mut();
        for (&spring, log) in self.tuned.iter().zip(point) {
            stiffness[spring] = self.stiffness[spring] * log.exp();
        }
        self.solver.solve_into(&self.network, &self.settings, &mut self.equilibrium);
        if self.equilibrium.status == Status::Converged {
            Ok(())
        } else {
            Err(EqualisationError::Equilibrium)
        }
    }

    fn differential(&self) -> Option<f64> {
        let least = self.forces().fold(f64::INFINITY, f64::min);
        force_differential(least, self.forces().fold(f64::NEG_INFINITY, f64::max))
    }

    /// Forces of the springs that are tuned [N].
    fn forces(&self) -> impl Iterator<Item = f64> + '_ {
        self.tuned.iter().map(|&spring| self.equilibrium.forces[spring])
    }

    /// Says which spring leaves the differential undefined.
    fn weakest(&self) -> EqualisationError {
        let forces = self.tuned.iter().copied().zip(self.forces());
        let (spring, force) = forces.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0));
        EqualisationError::Slack { spring, force }
    }

    /// log(Σ F^p)/p of the forces, for p of either sign, and the share of each force in the sum.
    fn log_sum(&self, power: f64) -> (f64, Vec<f64>) {
        let logs: Vec<f64> = self.forces().map(|force| power * force.ln()).collect();
        let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut shares: Vec<f64> = logs.iter().map(|log| (log - most).exp()).collect();
        let sum: f64 = shares.iter().sum();
        shares.iter_mut().for_each(|share| *share /= sum);
        ((most + sum.ln()) / power.abs(), shares)
    }
}

impl Valley for Net {
    fn value(&mut self, point: &[f64]) -> Option<f64> {
        self.solve(point).ok()?;
        self.differential()?;
        let power = self.sharpness;
        Some(self.log_sum(power).0 + self.log_sum(-power).0)
    }

    fn gradient(&mut self) -> Option<Vec<f64>> {
        self.sensitivity.build(&self.network, &self.equilibrium.positions).ok()?;
        let (largest, smallest) = (self.log_sum(self.sharpness).1, self.log_sum(-self.sharpness).1);
        let mut by_forces = vec![0.0; self.network.springs.len()];
        for (&spring, (most, least)) in self.tuned.iter().zip(largest.iter().zip(&smallest)) {
            by_forces[spring] = (most - least) / self.equilibrium.forces[spring];
        }
        let still = vec![[0.0; 3]; self.network.positions.len()];
        let by_stiffness = self.sensitivity.gradient(&still, &by_forces).stiffness;
        let slope = |&spring: &usize| by_stiffness[spring] * self.network.stiffness[spring];
        let gradient = self.tuned.iter().map(slope).collect();
        // The next solve starts where this one ended.
        if !self.network.is_linear() {
            self.network.positions.to_mut().clone_from(&self.equilibrium.positions);
        }
        Some(gradient)
    }
}

fn check(allowed: &Allowed) -> Result<([f64; 2], &[f64]), EqualisationError> {
    let wrong = |rule| Err(EqualisationError::Allowed(rule));
    let given = match allowed {
        Allowed::Between(bounds) => &bounds[..],
        Allowed::Values(values) => values,
    };
    if !given.iter().all(|factor| *factor > 0.0 && factor.is_finite()) {
        return wrong("finite and above 0");
    }
    let low = given.iter().copied().fold(f64::INFINITY, f64::min);
    let high = given.iter().copied().fold(0.0, f64::max);
    match allowed {
        Allowed::Between([first, second]) if first >= second => wrong("a lower bound, then a higher one"),
        Allowed::Between(_) if low > 1.0 || high < 1.0 => {
            wrong("such that 1, the stiffness as it is, lies between")
        }
        Allowed::Between(_) => Ok(([low, high], &[])),
        Allowed::Values(_) if low >= high => wrong("two different factors or more"),
        Allowed::Values(values) if !values.contains(&1.0) => {
            wrong("such that 1, the stiffness as it is, is among them")
        }
        Allowed::Values(values) => Ok(([low, high], values)),
    }
}

/// The value that is nearest.
fn nearest(values: &[f64], to: f64) -> f64 {
    let distance = |value: &f64| (value - to).abs();
    values.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(to)
}
