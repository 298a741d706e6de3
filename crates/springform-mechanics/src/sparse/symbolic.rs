//! What is known of a factor before its numbers: ordering, elimination tree, entries by column.
//!
//! Approximate minimum degree ordering of Amestoy, Davis & Duff, "An approximate minimum degree ordering algorithm",
//! 1996 (crate `amd`); rows of a factor as paths in the elimination tree (Liu, "A compact row storage scheme for
//! Cholesky factors using elimination trees", 1986).

use super::graph::Graph;

/// An order of elimination and the tree that it makes.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Symbolic {
    /// Row of the matrix at every place of the ordering.
    pub(super) order: Vec<u32>,
    /// Place of every row in the ordering.
    pub(super) place: Vec<u32>,
    /// First place below the diagonal in every column of the factor, or [`ROOT`].
    pub(super) parent: Vec<u32>,
    /// Entries of every column of the factor below its diagonal.
    pub(super) counts: Vec<u32>,
    seen: Vec<u32>,
}

/// In place of a parent: the column has no entries below its diagonal.
pub(super) const ROOT: u32 = u32::MAX;

impl Symbolic {
    /// Orders a graph by approximate minimum degree.
    pub fn build(&mut self, graph: &Graph) {
        let order = minimum_degree(graph);
        self.build_ordered(graph, &order);
    }

    /// Takes an order of elimination, a permutation of a graph's rows.
    pub fn build_ordered(&mut self, graph: &Graph, order: &[u32]) {
        let size = graph.rows();
        self.order.clear();
        self.order.extend_from_slice(order);
        self.place.clear();
        self.place.resize(size, 0);
        for (at, &row) in order.iter().enumerate() {
            self.place[row as usize] = at as u32;
        }
        for list in [&mut self.parent, &mut self.seen] {
            list.clear();
            list.resize(size, ROOT);
        }
        self.counts.clear();
        self.counts.resize(size, 0);
        for at in 0..size as u32 {
            self.seen[at as usize] = at;
            for (other, _) in graph.of(self.order[at as usize]) {
                let mut above = self.place[other as usize];
                if above > at {
                    continue;
                }
                while self.seen[above as usize] != at {
                    let parent = &mut self.parent[above as usize];
                    if *parent == ROOT {
                        *parent = at;
                    }
                    self.counts[above as usize] += 1;
                    self.seen[above as usize] = at;
                    above = *parent;
                }
            }
        }
    }

    /// Order of elimination: the row at every place.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Entries of the factor below its diagonal.
    pub fn fill(&self) -> usize {
        self.counts.iter().map(|&count| count as usize).sum()
    }

    /// Multiplications that a factorisation takes.
    pub fn work(&self) -> f64 {
        self.counts.iter().map(|&count| f64::from(count)).map(|count| 0.5 * count * count).sum()
    }
}

fn minimum_degree(graph: &Graph) -> Vec<u32> {
    let (starts, columns) = graph.pattern();
    match amd::order(graph.rows() as i32, &starts, &columns, &amd::Control::default()) {
        Ok((order, _, _)) => order.into_iter().map(|row| row as u32).collect(),
        // A refused pattern can't occur (columns ascend and are in range); the given order is valid anyway.
        Err(_) => (0..graph.rows() as u32).collect(),
    }
}
