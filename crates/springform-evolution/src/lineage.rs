//! Lineage: the order in which a parent's nodes are eliminated, and where they rest, handed on to its mutants.
//!
//! Finding an order takes longer than factoring by it, and a mutant's net differs from its parent's in a few cells. Its
//! order is therefore its parent's, with new nodes in front. Nets of weak prestress are slow to solve from where they are
//! drawn: their mutants start where their parent rests, if all starts lead to the same forces. With strong prestress that
//! was measured to save nothing. What a parent hands on is found from the parent's genotype alone, so that a mutant
//! depends on nothing but that and its edits.

use springform_mechanics::network::Network;
use springform_mechanics::vector::{Vector, add, scale, subtract};
use springform_topology::expression::Kinship;
use springform_topology::node_key::NodeKey;

/// Passes over the springs of new nodes, after which those have moved as their neighbours have.
const PASSES: u32 = 6;

/// A parent's nodes, their order of elimination and where they rest.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Lineage {
    /// Keys of the nodes, ascending.
    pub nodes: Vec<NodeKey>,
    /// Free nodes in the order in which they are eliminated.
    pub order: Vec<u32>,
    /// Positions at rest [m]; empty if mutants start as drawn.
    pub positions: Vec<Vector>,
}

/// A mutant's order of elimination, and the memory to find it.
#[derive(Clone, Default)]
pub struct Heir {
    kinship: Kinship,
    /// The mutant's node of every node of the parent.
    homes: Vec<u32>,
    order: Vec<u32>,
    start: Vec<Vector>,
    /// Sum and number of the neighbours of every new node that have a place.
    around: Vec<(Vector, f64)>,
}

impl Heir {
    /// All nodes of the mutant in an order of elimination after the parent's.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Finds the order of a mutant's nodes, keys ascending.
    pub fn find_order(&mut self, nodes: &[NodeKey], parent: &Lineage) {
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
    }

    /// Exchanges the start of a mutant's network, whose order was found last, for one near its parent's rest, and back.
    pub fn exchange_start(&mut self, network: &mut Network<'static>) {
        std::mem::swap(network.positions.to_mut(), &mut self.start);
    }

    /// Finds a start for the mutant whose order was found last: nodes of the parent where they rest, new ones moved from
    /// where they are drawn as their neighbours are, and each where its supports hold it.
    pub fn find_start(&mut self, network: &Network<'_>, parent: &Lineage) {
        let known = &self.kinship.nodes;
        // Moves first; new nodes begin with none.
        self.start.clear();
        self.start.extend(known.iter().zip(network.positions.iter()).map(|(&known, &drawn)| {
            parent.positions.get(known as usize).map_or([0.0; 3], |&rest| subtract(rest, drawn))
        }));
        for pass in 0..PASSES {
            self.around.clear();
            self.around.resize(known.len(), ([0.0; 3], 0.0));
            for &[a, b] in network.springs.iter() {
                for [node, neighbour] in [[a, b], [b, a]].map(|pair| pair.map(|node| node as usize)) {
                    let new = [node, neighbour].map(|node| known[node] == Kinship::NONE);
                    if new[0] && (pass > 0 || !new[1]) {
                        let (sum, count) = &mut self.around[node];
                        *sum = add(*sum, self.start[neighbour]);
                        *count += 1.0;
                    }
                }
            }
            let moves = self.start.iter_mut().zip(&self.around);
            moves
                .filter(|(_, (_, count))| *count > 0.0)
                .for_each(|(moved, &(sum, count))| *moved = scale(sum, 1.0 / count));
        }
        for (node, (start, &drawn)) in self.start.iter_mut().zip(network.positions.iter()).enumerate() {
            for axis in 0..3 {
                start[axis] = drawn[axis] + if network.fixed[node][axis] { 0.0 } else { start[axis] };
            }
        }
    }
}
