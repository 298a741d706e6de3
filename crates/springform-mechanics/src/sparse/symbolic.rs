//! Where the entries of a factor stand: ordering, elimination tree, columns.
//!
//! Approximate minimum degree ordering of Amestoy, Davis & Duff, "An approximate minimum degree ordering algorithm",
//! 1996 (crate `amd`); row patterns as paths in the elimination tree (Liu, "A compact row storage scheme for Cholesky
//! factors using elimination trees", 1986).

use super::graph::Graph;

/// The columns of a factor below its diagonal, and the same entries row by row.
///
/// ```text
/// column j   rows[starts[j]..starts[j + 1]]            places below j, ascending
/// row i      entries[row_starts[i]..row_starts[i + 1]] (column, where in `rows`)
/// ```
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Symbolic {
    /// Row of the matrix at every place of the ordering.
    pub(super) order: Vec<u32>,
    /// Place of every row in the ordering.
    pub(super) place: Vec<u32>,
    pub(super) starts: Vec<u32>,
    pub(super) rows: Vec<u32>,
    pub(super) row_starts: Vec<u32>,
    pub(super) entries: Vec<(u32, u32)>,
    parent: Vec<u32>,
    seen: Vec<u32>,
}

const ROOT: u32 = u32::MAX;

impl Symbolic {
    /// Orders a graph by approximate minimum degree and lays out its factor.
    pub fn build(&mut self, graph: &Graph) {
        let order = minimum_degree(graph);
        self.build_ordered(graph, &order);
    }

    /// Lays out the factor of a graph in a given order of elimination, a permutation of its rows.
    pub fn build_ordered(&mut self, graph: &Graph, order: &[u32]) {
        let size = graph.rows();
        self.order.clear();
        self.order.extend_from_slice(order);
        self.place.clear();
        self.place.resize(size, 0);
        for (at, &row) in order.iter().enumerate() {
            self.place[row as usize] = at as u32;
        }
        self.count(graph);
        self.fill_in(graph);
    }

    /// Order of elimination: the row at every place.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Entries of the factor below its diagonal.
    pub fn fill(&self) -> usize {
        self.rows.len()
    }

    /// Multiplications that a factorisation takes.
    pub fn work(&self) -> f64 {
        self.starts.windows(2).map(|pair| f64::from(pair[1] - pair[0])).map(|count| 0.5 * count * count).sum()
    }

    /// Counts entries by column and by row, and finds the elimination tree.
    fn count(&mut self, graph: &Graph) {
        let size = self.order.len();
        for list in [&mut self.parent, &mut self.seen] {
            list.clear();
            list.resize(size, ROOT);
        }
        for list in [&mut self.starts, &mut self.row_starts] {
            list.clear();
            list.resize(size + 1, 0);
        }
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
                    self.starts[above as usize + 1] += 1;
                    self.row_starts[at as usize + 1] += 1;
                    self.seen[above as usize] = at;
                    above = *parent;
                }
            }
        }
        for list in [&mut self.starts, &mut self.row_starts] {
            for at in 0..size {
                list[at + 1] += list[at];
            }
        }
    }

    /// Writes the entries, with the starts of columns running ahead meanwhile.
    fn fill_in(&mut self, graph: &Graph) {
        let size = self.order.len();
        let fill = self.starts[size] as usize;
        self.rows.clear();
        self.rows.resize(fill, 0);
        self.entries.clear();
        self.entries.reserve(fill);
        self.seen.fill(ROOT);
        for at in 0..size as u32 {
            self.seen[at as usize] = at;
            for (other, _) in graph.of(self.order[at as usize]) {
                let mut above = self.place[other as usize];
                if above > at {
                    continue;
                }
                while self.seen[above as usize] != at {
                    let next = &mut self.starts[above as usize];
                    self.rows[*next as usize] = at;
                    self.entries.push((above, *next));
                    *next += 1;
                    self.seen[above as usize] = at;
                    above = self.parent[above as usize];
                }
            }
        }
        for at in (1..=size).rev() {
            self.starts[at] = self.starts[at - 1];
        }
        self.starts[0] = 0;
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
