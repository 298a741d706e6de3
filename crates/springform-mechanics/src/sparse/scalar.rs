//! Factors with one number an entry, for three right-hand sides at once.
//!
//! Left-looking L D Lᵀ (George & Liu, "Computer solution of large sparse positive definite systems", 1981).

use super::graph::Graph;
use super::symbolic::Symbolic;
use super::{Lanes, NotPositiveDefinite};
use pulp::{Arch, NullaryFnOnce};

/// A factor L D Lᵀ and its workspace.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct ScalarFactor {
    values: Vec<f64>,
    pivots: Vec<f64>,
    inverses: Vec<f64>,
    dense: Vec<f64>,
    sides: Vec<Lanes>,
}

impl ScalarFactor {
    /// Factors the matrix of a diagonal, one number a row, and of `links`, one number off the diagonal a link.
    ///
    /// # Errors
    /// A pivot that is not above zero; the factor is of no use then.
    pub fn factor(
        &mut self,
        graph: &Graph,
        symbolic: &Symbolic,
        diagonal: &[f64],
        links: &[f64],
    ) -> Result<(), NotPositiveDefinite> {
        let size = graph.rows();
        self.values.resize(symbolic.fill(), 0.0);
        for list in [&mut self.pivots, &mut self.inverses] {
            list.resize(size, 0.0);
        }
        // A factorisation that was refused left numbers behind.
        self.dense.clear();
        self.dense.resize(size, 0.0);
        Arch::new().dispatch(Factorise { factor: self, graph, symbolic, diagonal, links })
    }

    /// Replaces right-hand sides, one row a row of the matrix, by their solutions.
    pub fn solve(&mut self, symbolic: &Symbolic, sides: &mut [Lanes]) {
        self.sides.clear();
        self.sides.extend(symbolic.order.iter().map(|&row| sides[row as usize]));
        Arch::new().dispatch(Substitute { factor: self, symbolic });
        for (&value, &row) in self.sides.iter().zip(&symbolic.order) {
            sides[row as usize] = value;
        }
    }
}

struct Factorise<'a> {
    factor: &'a mut ScalarFactor,
    graph: &'a Graph,
    symbolic: &'a Symbolic,
    diagonal: &'a [f64],
    links: &'a [f64],
}

impl NullaryFnOnce for Factorise<'_> {
    type Output = Result<(), NotPositiveDefinite>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let ScalarFactor { values, pivots, inverses, dense, .. } = self.factor;
        let Symbolic { order, place, starts, rows, row_starts, entries, .. } = self.symbolic;
        for at in 0..order.len() {
            let row = order[at];
            for (other, link) in self.graph.of(row) {
                let below = place[other as usize] as usize;
                if below > at {
                    dense[below] += self.links[link as usize];
                }
            }
            let mut pivot = self.diagonal[row as usize];
            for &(column, entry) in &entries[row_starts[at] as usize..row_starts[at + 1] as usize] {
                let end = starts[column as usize + 1] as usize;
                let first = values[entry as usize];
                let factor = -(first * pivots[column as usize]);
                pivot = factor.mul_add(first, pivot);
                let tail = entry as usize + 1..end;
                for (&below, &value) in rows[tail.clone()].iter().zip(&values[tail]) {
                    let sum = &mut dense[below as usize];
                    *sum = factor.mul_add(value, *sum);
                }
            }
            if !(pivot > 0.0 && pivot.is_finite()) {
                return Err(NotPositiveDefinite { row });
            }
            let inverse = 1.0 / pivot;
            (pivots[at], inverses[at]) = (pivot, inverse);
            let column = starts[at] as usize..starts[at + 1] as usize;
            for (&below, value) in rows[column.clone()].iter().zip(&mut values[column]) {
                let sum = &mut dense[below as usize];
                *value = *sum * inverse;
                *sum = 0.0;
            }
        }
        Ok(())
    }
}

struct Substitute<'a> {
    factor: &'a mut ScalarFactor,
    symbolic: &'a Symbolic,
}

impl NullaryFnOnce for Substitute<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let ScalarFactor { values, inverses, sides, .. } = self.factor;
        let Symbolic { starts, rows, .. } = self.symbolic;
        let column = |at: usize| starts[at] as usize..starts[at + 1] as usize;
        for at in 0..sides.len() {
            let side = sides[at];
            for (&row, &value) in rows[column(at)].iter().zip(&values[column(at)]) {
                let below = &mut sides[row as usize];
                *below = std::array::from_fn(|lane| (-value).mul_add(side[lane], below[lane]));
            }
        }
        for at in (0..sides.len()).rev() {
            let mut side = sides[at].map(|value| value * inverses[at]);
            for (&row, &value) in rows[column(at)].iter().zip(&values[column(at)]) {
                let below = sides[row as usize];
                side = std::array::from_fn(|lane| (-value).mul_add(below[lane], side[lane]));
            }
            sides[at] = side;
        }
    }
}
