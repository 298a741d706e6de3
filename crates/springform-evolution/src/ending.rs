//! When a run ends (the paper §3.5, §4.2: "a termination condition is met").

use crate::fitness::Standing;

/// Ending conditions; a run ends at the first that holds.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Ending {
    /// Number of generations or steps.
    pub generations: Option<u32>,
    /// Number of springs reached.
    pub springs: Option<u32>,
    /// Force differential reached, from whichever side of it the start lies.
    pub differential: Option<f64>,
    /// Spring utilization factor reached from above.
    pub suf: Option<f64>,
}

/// Which condition ended a run.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Reason {
    /// The number of generations or steps.
    Generations,
    /// The number of springs.
    Springs,
    /// The force differential.
    Differential,
    /// The spring utilization factor.
    Suf,
}

impl Reason {
    /// In words, for logs and messages.
    pub fn name(self) -> &'static str {
        match self {
            Reason::Generations => "generations",
            Reason::Springs => "springs",
            Reason::Differential => "differential",
            Reason::Suf => "suf",
        }
    }
}

impl Ending {
    /// The condition that holds after `generation`, for the parent now and its spring utilization factor.
    pub fn reached(
        &self,
        generation: u32,
        start: Standing,
        now: Standing,
        suf: Option<f64>,
    ) -> Option<Reason> {
        let crossed = |limit: f64| match (start.differential, now.differential) {
            (Some(start), Some(now)) if start > limit => now <= limit,
            (_, Some(now)) => now >= limit,
            _ => false,
        };
        if self.springs.is_some_and(|limit| now.springs >= limit) {
            Some(Reason::Springs)
        } else if self.differential.is_some_and(crossed) {
            Some(Reason::Differential)
        } else if self.suf.is_some_and(|limit| suf.is_some_and(|suf| suf <= limit)) {
            Some(Reason::Suf)
        } else if self.generations.is_some_and(|limit| generation >= limit) {
            Some(Reason::Generations)
        } else {
            None
        }
    }
}
