//! Fitness and the choice of the next parent (the paper §3.6, §4.2).

use springform_mechanics::measures::{Measures, spring_utilization};

/// What the best individual has least of.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Fitness {
    /// Spring utilization factor.
    Suf,
    /// Force differential.
    Differential,
}

/// What the spring utilization factor is measured against.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SufReference {
    /// The start of the run.
    Start,
    /// The parent.
    Parent,
    /// Zero: force differential per spring.
    Zero,
}

/// Springs and force differential of a net, as far as fitness needs them.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Standing {
    /// Number of springs.
    pub springs: u32,
    /// Largest over smallest force, if defined.
    pub differential: Option<f64>,
}

impl From<&Measures> for Standing {
    fn from(measures: &Measures) -> Self {
        Standing { springs: measures.springs, differential: measures.force_differential }
    }
}

/// Fitness of one individual; lower ranks are fitter, then lower values.
#[derive(Clone, Copy, PartialEq, PartialOrd, Debug)]
pub struct Score {
    rank: u8,
    value: f64,
}

impl Score {
    /// The individual can't win while another is defined.
    pub const UNDEFINED: Score = Score { rank: 2, value: f64::INFINITY };

    /// The individual can win.
    pub fn is_defined(self) -> bool {
        self.rank < 2
    }
}

/// How individuals are compared.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Criterion {
    /// What counts.
    pub fitness: Fitness,
    /// Reference of the spring utilization factor.
    pub reference: SufReference,
    /// Compare only individuals whose number of springs is within this of the generation's median.
    pub niche: Option<u32>,
    /// Shortest spring allowed [m]; individuals with a shorter one are undefined.
    pub min_length: Option<f64>,
    /// Fewest springs allowed; individuals with fewer are undefined.
    pub min_springs: Option<u32>,
    /// Most springs allowed; individuals with more are undefined.
    pub max_springs: Option<u32>,
}

impl Criterion {
    /// Compares all individuals by a fitness, against the start.
    #[must_use]
    pub const fn by(fitness: Fitness) -> Criterion {
        Criterion {
            fitness,
            reference: SufReference::Start,
            niche: None,
            min_length: None,
            min_springs: None,
            max_springs: None,
        }
    }

    /// Spring utilization factor of a net against the chosen reference.
    pub fn suf(&self, measures: &Measures, start: Standing, parent: Standing) -> Option<f64> {
        let reference = self.reference(start, parent);
        spring_utilization(measures, (reference.differential, reference.springs))
    }

    /// Score of a net in a run from `start`, as a mutant of `parent`.
    ///
    /// Where the reference has no force differential there is no factor to compare, and the differential counts.
    pub fn score(&self, measures: &Measures, start: Standing, parent: Standing) -> Score {
        let (Some(differential), true) = (measures.force_differential, self.allows(measures)) else {
            return Score::UNDEFINED;
        };
        let comparable = self.reference(start, parent).differential.is_some();
        match (self.fitness, self.suf(measures, start, parent)) {
            (Fitness::Differential, _) => Score { rank: 0, value: differential },
            (Fitness::Suf, None) if !comparable => Score { rank: 0, value: differential },
            (Fitness::Suf, None) => Score::UNDEFINED,
            // No gain in differential beats any gain; among these the lower differential is fitter.
            (Fitness::Suf, Some(suf)) if suf <= 0.0 => Score { rank: 0, value: differential },
            (Fitness::Suf, Some(suf)) => Score { rank: 1, value: suf },
        }
    }

    fn allows(&self, measures: &Measures) -> bool {
        let springs = measures.springs;
        self.min_length.is_none_or(|length| measures.shortest_spring >= length)
            && self.min_springs.is_none_or(|least| springs >= least)
            && self.max_springs.is_none_or(|most| springs <= most)
    }

    /// Score of a parent that contends with its mutants: against itself nothing rose, so its differential counts.
    pub fn incumbent(&self, measures: &Measures, start: Standing) -> Score {
        let own = match self.reference {
            SufReference::Parent => Criterion { fitness: Fitness::Differential, ..*self },
            SufReference::Start | SufReference::Zero => *self,
        };
        own.score(measures, start, Standing::from(measures))
    }

    fn reference(&self, start: Standing, parent: Standing) -> Standing {
        match self.reference {
            SufReference::Start => start,
            SufReference::Parent => parent,
            SufReference::Zero => Standing { springs: 0, differential: Some(0.0) },
        }
    }

    /// The fittest of a generation, the lowest index among equals; `None` if all are undefined.
    pub fn choose(&self, generation: &[(Score, u32)]) -> Option<usize> {
        let band = self.niche.and_then(|width| {
            let mut springs: Vec<u32> = generation
                .iter()
                .filter(|(score, _)| score.is_defined())
                .map(|&(_, springs)| springs)
                .collect();
            springs.sort_unstable();
            let median = *springs.get(springs.len() / 2)?;
            Some(median.saturating_sub(width)..=median.saturating_add(width))
        });
        let mut best: Option<usize> = None;
        for (index, (score, springs)) in generation.iter().enumerate() {
            let contends = score.is_defined() && band.as_ref().is_none_or(|band| band.contains(springs));
            if contends && best.is_none_or(|best| *score < generation[best].0) {
                best = Some(index);
            }
        }
        best
    }
}
