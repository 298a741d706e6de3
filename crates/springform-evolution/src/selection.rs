//! Weighted selection of cells (the paper §3.3, Fig. 12; §3.5 for stress).

use crate::draws::Draws;

/// How cells are weighted when they are drawn.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Weighting {
    /// Type 0: all alike.
    Unweighted,
    /// Type 1: linear, less subdivided cells more.
    Linear,
    /// Type 2: exponential, less subdivided cells more; base 4 cancels the bias of subdivision exactly.
    Exponential,
    /// Type 3: linear, more subdivided cells more.
    Deep,
    /// By inner force in the parent's equilibrium.
    Stress,
}

/// Every weighting, in the order of the paper.
pub const WEIGHTINGS: [(Weighting, &str); 5] = [
    (Weighting::Unweighted, "unweighted"),
    (Weighting::Linear, "linear"),
    (Weighting::Exponential, "exponential"),
    (Weighting::Deep, "deep"),
    (Weighting::Stress, "stress"),
];

impl Weighting {
    /// The weighting called `name`.
    pub fn parse(name: &str) -> Option<Weighting> {
        WEIGHTINGS.iter().find(|(_, known)| *known == name).map(|&(weighting, _)| weighting)
    }

    /// Name on the command line and in run folders.
    pub fn name(self) -> &'static str {
        WEIGHTINGS.iter().find(|(weighting, _)| *weighting == self).map_or("", |&(_, name)| name)
    }
}

/// Numbers in the weights.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct WeightingParameters {
    /// Base of the exponential weighting.
    pub base: f64,
    /// Exponent on the linear, deep and stress weights.
    pub exponent: f64,
}

impl Default for WeightingParameters {
    fn default() -> Self {
        WeightingParameters { base: 4.0, exponent: 1.0 }
    }
}

/// Weight of a cell of `level`, in a forest whose deepest expressed level is `deepest`, with inner force [N].
pub fn weight(
    weighting: Weighting,
    parameters: &WeightingParameters,
    level: u8,
    deepest: u8,
    inner_force: f64,
) -> f64 {
    let linear = match weighting {
        Weighting::Unweighted => return 1.0,
        Weighting::Exponential => return parameters.base.powi(-i32::from(level)),
        Weighting::Linear => f64::from(deepest.saturating_sub(level)) + 1.0,
        Weighting::Deep => f64::from(level) + 1.0,
        Weighting::Stress => inner_force,
    };
    if parameters.exponent == 1.0 { linear } else { linear.powf(parameters.exponent) }
}

/// Draws up to `count` items without replacement, each draw in proportion to the weights left.
///
/// Items of weight zero are never drawn.
pub fn draw_without_replacement(weights: &[f64], count: usize, draws: &mut Draws) -> Vec<usize> {
    let mut drawn = Vec::with_capacity(count.min(weights.len()));
    SumTree::new(weights.iter().copied()).draw(count, draws, &mut drawn);
    drawn
}

/// Partial sums of weights in a binary tree, so that taking one out leaves no rounding behind.
#[derive(Debug, Default)]
pub(crate) struct SumTree {
    leaves: usize,
    sums: Vec<f64>,
}

impl Clone for SumTree {
    fn clone(&self) -> SumTree {
        SumTree { leaves: self.leaves, sums: self.sums.clone() }
    }

    fn clone_from(&mut self, source: &SumTree) {
        self.leaves = source.leaves;
        self.sums.clone_from(&source.sums);
    }
}

impl SumTree {
    pub fn new(weights: impl ExactSizeIterator<Item = f64>) -> SumTree {
        let leaves = weights.len().next_power_of_two();
        let mut sums = vec![0.0; 2 * leaves];
        sums[leaves..].iter_mut().zip(weights).for_each(|(sum, weight)| *sum = weight);
        for at in (1..leaves).rev() {
            sums[at] = sums[2 * at] + sums[2 * at + 1];
        }
        SumTree { leaves, sums }
    }

    /// Appends up to `count` items to those drawn, and takes them out.
    pub fn draw(&mut self, count: usize, draws: &mut Draws, drawn: &mut Vec<usize>) {
        for _ in 0..count {
            if self.total() <= 0.0 {
                return;
            }
            let item = self.find(draws.unit() * self.total());
            self.clear(item);
            drawn.push(item);
        }
    }

    fn total(&self) -> f64 {
        self.sums[1]
    }

    /// The item at which the running sum passes `target`; an item of weight zero is never found.
    fn find(&self, mut target: f64) -> usize {
        let mut at = 1;
        while at < self.leaves {
            let left = self.sums[2 * at];
            let go_right = (target >= left && self.sums[2 * at + 1] > 0.0) || left <= 0.0;
            if go_right {
                target -= left;
            }
            at = 2 * at + usize::from(go_right);
        }
        at - self.leaves
    }

    /// Takes an item out: the sums are then those of a tree without it.
    pub fn clear(&mut self, item: usize) {
        let mut at = self.leaves + item;
        self.sums[at] = 0.0;
        while at > 1 {
            at /= 2;
            self.sums[at] = self.sums[2 * at] + self.sums[2 * at + 1];
        }
    }
}
