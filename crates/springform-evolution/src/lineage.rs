//! Lineage: the order in which a parent's nodes are eliminated, handed on to its mutants.
//!
//! Finding an order takes longer than factoring by it, and a mutant's net differs from its parent's in a few cells. Its
//! order is therefore its parent's, with new nodes in front. The parent's is found from the parent's genotype
//! alone, so that a mutant depends on nothing but that and its edits.

use springform_topology::expression::Kinship;
use springform_topology::node_key::NodeKey;

/// A parent's nodes and their order of elimination.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Lineage {
    /// Keys of the nodes, ascending.
    pub nodes: Vec<NodeKey>,
    /// Free nodes in the order in which they are eliminated.
    pub order: Vec<u32>,
}

/// A mutant's order of elimination, and the memory to find it.
#[derive(Clone, Default)]
pub struct Heir {
    kinship: Kinship,
    /// The mutant's node of every node of the parent.
    homes: Vec<u32>,
    order: Vec<u32>,
}

impl Heir {
    /// All nodes of a net, keys ascending, in an order of elimination after the parent's.
    pub fn order(&mut self, nodes: &[NodeKey], parent: &Lineage) -> &[u32] {
        self.kinship.find_nodes(nodes, &parent.nodes);
        self.homes.clear();
        self.homes.resize(parent.nodes.len(), Kinship::NONE);
        self.order.clear();
        // Nodes inside faces have higher keys than those on edges, and fewer springs.
        for (node, &known) in self.kinship.nodes.iter().enumerate().rev() {
            if known == Kinship::NONE {
                self.order.push(node as u32);
            } else {
                self.homes[known as usize] = node as u32;
            }
        }
        let inherited = parent.order.iter().map(|&node| self.homes[node as usize]);
        self.order.extend(inherited.filter(|&node| node != Kinship::NONE));
        &self.order
    }
}
