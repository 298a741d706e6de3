//! Stages of an evaluation: what an observer is told, so that it can tell where the time goes.

/// A step on the way from a parent's genotype to a mutant's measures.
///
/// An observer is called when a stage ends; what has passed since its last call belongs to that stage. A stage may end
/// more than once. No clock is read here: whoever wants to know the time reads it in the observer.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Stage {
    /// The genotype is copied and edited.
    Mutate,
    /// Levels are balanced; springs that carry no force are left out.
    Filter,
    /// Nodes and springs are grown, and become a network.
    Nodes,
    /// The elimination of nodes is put in order.
    Order,
    /// The stiffness matrix is factorised.
    Factor,
    /// Positions and forces are solved for.
    Solve,
    /// The net is measured.
    Measure,
}

/// Every stage, in order, and its name in reports.
pub const STAGES: [(Stage, &str); 7] = [
    (Stage::Mutate, "mutate"),
    (Stage::Filter, "filter"),
    (Stage::Nodes, "nodes"),
    (Stage::Order, "order"),
    (Stage::Factor, "factor"),
    (Stage::Solve, "solve"),
    (Stage::Measure, "measure"),
];
