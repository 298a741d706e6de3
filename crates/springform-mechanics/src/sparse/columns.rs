//! The columns of a factor below its diagonal, and the same entries row by row.

use super::graph::Graph;
use super::symbolic::Symbolic;

/// Where the entries of a factor stand.
///
/// ```text
/// column j   rows[starts[j]..starts[j + 1]]            places below j, ascending
/// row i      entries[row_starts[i]..row_starts[i + 1]] (column, where in `rows`)
/// ```
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub(super) struct Columns {
    pub(super) starts: Vec<u32>,
    pub(super) rows: Vec<u32>,
    pub(super) row_starts: Vec<u32>,
    pub(super) entries: Vec<(u32, u32)>,
    next: Vec<u32>,
    seen: Vec<u32>,
}

impl Columns {
    pub(super) fn build(&mut self, graph: &Graph, symbolic: &Symbolic) {
        let size = graph.rows();
        self.starts.clear();
        self.starts.push(0);
        let mut end = 0;
        self.starts.extend(symbolic.counts.iter().map(|&count| {
            end += count;
            end
        }));
        self.next.clear();
        self.next.extend_from_slice(&self.starts[..size]);
        self.rows.clear();
        self.rows.resize(end as usize, 0);
        self.entries.clear();
        self.entries.reserve(end as usize);
        self.row_starts.clear();
        self.seen.clear();
        self.seen.resize(size, u32::MAX);
        for at in 0..size as u32 {
            self.row_starts.push(self.entries.len() as u32);
            self.seen[at as usize] = at;
            for (other, _) in graph.of(symbolic.order[at as usize]) {
                let mut above = symbolic.place[other as usize];
                if above > at {
                    continue;
                }
                while self.seen[above as usize] != at {
                    let next = &mut self.next[above as usize];
                    self.rows[*next as usize] = at;
                    self.entries.push((above, *next));
                    *next += 1;
                    self.seen[above as usize] = at;
                    above = symbolic.parent[above as usize];
                }
            }
        }
        self.row_starts.push(self.entries.len() as u32);
    }
}
