//! Kinship: which nodes and springs of a net are those of another, such as a mutant's of its parent.

use super::Expression;
use crate::node_key::NodeKey;

/// Nodes and springs of one net found again in another, by the keys of nodes, and the memory to do it again.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Kinship {
    /// For every node of the one, the node of the other with the same key, or [`Kinship::NONE`]; ascending but for those.
    pub nodes: Vec<u32>,
    /// For every spring of the one, the spring of the other between the same nodes, along a ring or not as it is, or
    /// [`Kinship::NONE`]; ascending but for those.
    pub springs: Vec<u32>,
}

impl Kinship {
    /// In place of a number: the other net has none such.
    pub const NONE: u32 = u32::MAX;

    /// Finds the nodes and springs of a net in another one on the same base mesh. Both are in order, so it takes one
    /// pass over each.
    pub fn find(&mut self, net: &Expression, other: &Expression) {
        self.find_nodes(&net.nodes, &other.nodes);
        self.springs.clear();
        let mut rest = 0;
        let nodes = &self.nodes;
        self.springs.extend(net.springs.iter().map(|spring| {
            let ends = spring.nodes.map(|node| nodes[node as usize]);
            if ends.contains(&Kinship::NONE) {
                return Kinship::NONE;
            }
            rest += other.springs[rest..].iter().take_while(|other| other.nodes < ends).count();
            let found =
                other.springs.get(rest).is_some_and(|other| (other.nodes, other.ring) == (ends, spring.ring));
            if found { rest as u32 } else { Kinship::NONE }
        }));
    }
    /// Finds nodes alone, both ascending.
    pub fn find_nodes(&mut self, nodes: &[NodeKey], others: &[NodeKey]) {
        self.nodes.clear();
        let mut rest = 0;
        self.nodes.extend(nodes.iter().map(|&key| {
            rest += others[rest..].iter().take_while(|&&other| other < key).count();
            if others.get(rest) == Some(&key) { rest as u32 } else { Kinship::NONE }
        }));
    }
}
