//! Columns of a factor side by side, as wide as a vector register.
//!
//! Supernodes as in Ng & Peyton, "Block sparse Cholesky algorithms on advanced uniprocessor computers", 1993, but of at
//! most four columns, and relaxed: a column joins the next if few zeros are stored for it.

use super::graph::Graph;
use super::symbolic::{ROOT, Symbolic};

/// Most columns of a panel.
pub(super) const WIDTH: usize = 4;

/// Groups of consecutive columns that share their rows.
///
/// ```text
///            columns firsts[p] .. firsts[p + 1]
///            ┌ x . . . ┐
///            │ x x . . │   first its own triangle, one row of numbers a column,
///            │ x x x . │
///            └ x x x x ┘
///   a row    [ x x x x ]   then a row of numbers for each of
///   below    [ x x x x ]   rows[starts[p]..starts[p + 1]], ascending
/// ```
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub(super) struct Panels {
    /// First column of every panel, and the end.
    pub(super) firsts: Vec<u32>,
    /// Panel of every column.
    pub(super) panel: Vec<u32>,
    pub(super) starts: Vec<u32>,
    pub(super) rows: Vec<u32>,
    next: Vec<u32>,
    seen: Vec<u32>,
}

impl Panels {
    pub(super) fn build(&mut self, graph: &Graph, symbolic: &Symbolic) {
        self.part(symbolic);
        let panels = self.firsts.len() - 1;
        self.starts.clear();
        self.starts.push(0);
        let mut end = 0;
        for panel in 0..panels {
            // Every row of a column is one of the next, or the next itself: the last has them all.
            end += symbolic.counts[self.firsts[panel + 1] as usize - 1];
            self.starts.push(end);
        }
        self.rows.clear();
        self.rows.resize(end as usize, 0);
        self.next.clear();
        self.next.extend_from_slice(&self.starts[..panels]);
        self.seen.clear();
        self.seen.resize(panels, ROOT);
        for at in 0..graph.rows() as u32 {
            let own = self.panel[at as usize];
            for (other, _) in graph.of(symbolic.order[at as usize]) {
                let column = symbolic.place[other as usize];
                if column > at {
                    continue;
                }
                let mut panel = self.panel[column as usize];
                while panel != own && self.seen[panel as usize] != at {
                    self.seen[panel as usize] = at;
                    let next = &mut self.next[panel as usize];
                    self.rows[*next as usize] = at;
                    *next += 1;
                    let last = self.firsts[panel as usize + 1] - 1;
                    panel = self.panel[symbolic.parent[last as usize] as usize];
                }
            }
        }
    }

    /// Numbers that the panels hold, four a row.
    pub(super) fn size(&self) -> usize {
        self.panel.len() + self.rows.len()
    }

    /// Parts columns into panels.
    fn part(&mut self, symbolic: &Symbolic) {
        self.firsts.clear();
        self.panel.clear();
        let mut first = 0;
        for column in 0..symbolic.counts.len() {
            let follows = column > 0 && symbolic.parent[column - 1] == column as u32;
            if !follows || column - first == WIDTH {
                self.firsts.push(column as u32);
                first = column;
            }
            self.panel.push(self.firsts.len() as u32 - 1);
        }
        self.firsts.push(symbolic.counts.len() as u32);
    }
}
