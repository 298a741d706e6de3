//! Factors with three by three numbers an entry: one block a pair of nodes.
//!
//! Left-looking L D Lᵀ (George & Liu, "Computer solution of large sparse positive definite systems", 1981), column by
//! column.

use super::columns::Columns as Layout;
use super::graph::Graph;
use super::symbolic::Symbolic;
use super::{Lanes, NotPositiveDefinite};
use crate::vector::Vector;
use pulp::{Arch, NullaryFnOnce};

/// Three by three numbers, row by row.
pub type Block = [Vector; 3];

/// A block column by column, each a vector register.
type Columns = [Lanes; 3];

const ZERO: Columns = [[0.0; 4]; 3];

/// A factor L D Lᵀ of blocks and its workspace.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct BlockFactor {
    layout: Layout,
    order: Vec<u32>,
    values: Vec<Columns>,
    pivots: Vec<Columns>,
    inverses: Vec<Columns>,
    dense: Vec<Columns>,
    sides: Vec<Lanes>,
}

impl BlockFactor {
    /// Lays the factor out.
    pub fn lay_out(&mut self, graph: &Graph, symbolic: &Symbolic) {
        self.layout.build(graph, symbolic);
        self.order.clone_from(&symbolic.order);
    }

    /// Factors the matrix of a diagonal, one symmetric block a row, and of `links`, one block a link off the diagonal:
    /// rows of its first end, columns of its second; `ends` are the rows of the links. It was laid out for the same graph.
    ///
    /// # Errors
    /// A pivot that is not positive definite; the factor is of no use then.
    pub fn factor(
        &mut self,
        graph: &Graph,
        symbolic: &Symbolic,
        diagonal: &[Block],
        links: &[Block],
        ends: &[[u32; 2]],
    ) -> Result<(), NotPositiveDefinite> {
        let size = graph.rows();
        self.values.resize(self.layout.rows.len(), ZERO);
        for list in [&mut self.pivots, &mut self.inverses] {
            list.resize(size, ZERO);
        }
        // A factorisation that was refused left numbers behind.
        self.dense.clear();
        self.dense.resize(size, ZERO);
        Arch::new().dispatch(Factorise { factor: self, graph, symbolic, diagonal, links, ends })
    }

    /// Replaces a right-hand side, one vector a row of the matrix, by its solution.
    pub fn solve(&mut self, side: &mut [Lanes]) {
        self.sides.clear();
        self.sides.extend(self.order.iter().map(|&row| side[row as usize]));
        Arch::new().dispatch(Substitute { factor: self });
        for (&value, &row) in self.sides.iter().zip(&self.order) {
            side[row as usize] = value;
        }
    }
}

struct Factorise<'a> {
    factor: &'a mut BlockFactor,
    graph: &'a Graph,
    symbolic: &'a Symbolic,
    diagonal: &'a [Block],
    links: &'a [Block],
    ends: &'a [[u32; 2]],
}

impl NullaryFnOnce for Factorise<'_> {
    type Output = Result<(), NotPositiveDefinite>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let BlockFactor { layout, values, pivots, inverses, dense, .. } = self.factor;
        let Layout { starts, rows, row_starts, entries, .. } = layout;
        let (order, place) = (&self.symbolic.order, &self.symbolic.place);
        let (values, dense) = (values.as_mut_slice(), dense.as_mut_slice());
        for at in 0..order.len() {
            let row = order[at];
            for (other, link) in self.graph.of(row) {
                let below = place[other as usize] as usize;
                if below > at {
                    // Columns of this row's place: the block with the other row's rows.
                    let block = &self.links[link as usize];
                    let turned = self.ends[link as usize][0] == row;
                    let sum = &mut dense[below];
                    for (column, lanes) in sum.iter_mut().enumerate() {
                        for lane in 0..3 {
                            lanes[lane] += if turned { block[column][lane] } else { block[lane][column] };
                        }
                    }
                }
            }
            let mut pivot = columns_of(&self.diagonal[row as usize]);
            for &(column, entry) in &entries[row_starts[at] as usize..row_starts[at + 1] as usize] {
                let end = starts[column as usize + 1] as usize;
                let first = values[entry as usize];
                // −D Lᵀ, by which entries of the column are multiplied.
                let factor = negative_transposed(&pivots[column as usize], &first);
                add_product(&mut pivot, &first, &factor);
                let tail = entry as usize + 1..end;
                for (&below, value) in rows[tail.clone()].iter().zip(&values[tail]) {
                    add_product(&mut dense[below as usize], value, &factor);
                }
            }
            let Some(inverse) = inverse(&pivot) else { return Err(NotPositiveDefinite { row }) };
            (pivots[at], inverses[at]) = (pivot, inverse);
            let column = starts[at] as usize..starts[at + 1] as usize;
            for (&below, value) in rows[column.clone()].iter().zip(&mut values[column]) {
                let sum = &mut dense[below as usize];
                *value = ZERO;
                add_product(value, sum, &inverse);
                *sum = ZERO;
            }
        }
        Ok(())
    }
}

struct Substitute<'a> {
    factor: &'a mut BlockFactor,
}

impl NullaryFnOnce for Substitute<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let BlockFactor { layout, values, inverses, sides, .. } = self.factor;
        let Layout { starts, rows, .. } = layout;
        let (values, sides) = (values.as_slice(), sides.as_mut_slice());
        let column = |at: usize| starts[at] as usize..starts[at + 1] as usize;
        for at in 0..sides.len() {
            let side = sides[at].map(|value| -value);
            for (&row, value) in rows[column(at)].iter().zip(&values[column(at)]) {
                add_times(&mut sides[row as usize], value, &side);
            }
        }
        for at in (0..sides.len()).rev() {
            let mut side = [0.0; 4];
            add_times(&mut side, &inverses[at], &sides[at]);
            for (&row, value) in rows[column(at)].iter().zip(&values[column(at)]) {
                let below = sides[row as usize];
                for lane in 0..3 {
                    let [x, y, z, _] = value[lane];
                    side[lane] =
                        (-x).mul_add(below[0], (-y).mul_add(below[1], (-z).mul_add(below[2], side[lane])));
                }
            }
            sides[at] = side;
        }
    }
}

#[inline(always)]
fn columns_of(block: &Block) -> Columns {
    std::array::from_fn(|column| [block[0][column], block[1][column], block[2][column], 0.0])
}

/// a += b c.
#[inline(always)]
fn add_product(a: &mut Columns, b: &Columns, c: &Columns) {
    for (sum, by) in a.iter_mut().zip(c) {
        add_times(sum, b, &[by[0], by[1], by[2], 0.0]);
    }
}

/// a += b v.
#[inline(always)]
fn add_times(a: &mut Lanes, b: &Columns, v: &Lanes) {
    for (column, &by) in b.iter().zip(v) {
        *a = std::array::from_fn(|lane| column[lane].mul_add(by, a[lane]));
    }
}

/// −a bᵀ of a symmetric a.
#[inline(always)]
fn negative_transposed(a: &Columns, b: &Columns) -> Columns {
    let mut product = ZERO;
    for (column, lanes) in product.iter_mut().enumerate() {
        add_times(lanes, a, &[-b[0][column], -b[1][column], -b[2][column], 0.0]);
    }
    product
}

/// The inverse of a positive definite block; `None` of any other.
#[inline(always)]
fn inverse(a: &Columns) -> Option<Columns> {
    let [[xx, xy, xz, _], [_, yy, yz, _], [_, _, zz, _]] = *a;
    // Pivots of elimination: rounding refuses what a determinant would let through.
    let (first, second) = (xy / xx, xz / xx);
    let (middle, side) = (yy - first * xy, yz - first * xz);
    let third = side / middle;
    let last = zz - second * xz - third * side;
    if !(xx > 0.0 && middle > 0.0 && last > 0.0 && xx.is_finite() && middle.is_finite() && last.is_finite()) {
        return None;
    }
    let lower = first * third - second;
    let (x, y, z) = (1.0 / xx, 1.0 / middle, 1.0 / last);
    let inverse_yy = y + third * third * z;
    let inverse_xy = -first * y - third * lower * z;
    let inverse_xx = x + first * first * y + lower * lower * z;
    let (inverse_xz, inverse_yz) = (lower * z, -third * z);
    Some([
        [inverse_xx, inverse_xy, inverse_xz, 0.0],
        [inverse_xy, inverse_yy, inverse_yz, 0.0],
        [inverse_xz, inverse_yz, z, 0.0],
    ])
}
