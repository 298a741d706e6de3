//! Factors with three by three numbers an entry: one block a pair of nodes.
//!
//! Left-looking L Lᵀ (George & Liu, "Computer solution of large sparse positive definite systems", 1981), column by
//! column. Pivots are factored and never inverted: those of a stiff rod are ill-conditioned, and products with their
//! inverses would lose its bending stiffness.

use super::columns::Columns as Layout;
use super::graph::Graph;
use super::symbolic::Symbolic;
use super::{Lanes, NotPositiveDefinite};
use crate::vector::Vector;
use pulp::{Arch, NullaryFnOnce};

/// Three by three numbers, row by row.
pub type Block = [Vector; 3];

/// A block column by column, each a vector register that lies within one line of the cache.
#[derive(Clone, Copy, PartialEq, Debug)]
#[repr(align(32))]
struct Columns([Lanes; 3]);

const ZERO: Columns = Columns([[0.0; 4]; 3]);

/// A factor L Lᵀ of blocks and its workspace.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct BlockFactor {
    layout: Layout,
    order: Vec<u32>,
    values: Vec<Columns>,
    /// Factors of the pivots, see [`Root`].
    roots: Vec<Root>,
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
        self.roots.resize(size, Root::default());
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
        let BlockFactor { layout, values, roots, dense, .. } = self.factor;
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
                    for (column, lanes) in sum.0.iter_mut().enumerate() {
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
                // −Lᵀ, by which entries of the column are multiplied.
                let factor = negative_transposed(&first);
                add_product(&mut pivot, &first, &factor);
                let tail = entry as usize + 1..end;
                for (&below, value) in rows[tail.clone()].iter().zip(&values[tail]) {
                    // In registers: memory would be written after every product.
                    let mut sum = dense[below as usize];
                    add_product(&mut sum, value, &factor);
                    dense[below as usize] = sum;
                }
            }
            let Some(root) = Root::new(&pivot) else { return Err(NotPositiveDefinite { row }) };
            roots[at] = root;
            let column = starts[at] as usize..starts[at + 1] as usize;
            for (&below, value) in rows[column.clone()].iter().zip(&mut values[column]) {
                let sum = &mut dense[below as usize];
                *value = root.divide(sum);
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
        let BlockFactor { layout, values, roots, sides, .. } = self.factor;
        let Layout { starts, rows, .. } = layout;
        let (values, sides) = (values.as_slice(), sides.as_mut_slice());
        let column = |at: usize| starts[at] as usize..starts[at + 1] as usize;
        for at in 0..sides.len() {
            sides[at] = roots[at].forwards(&sides[at]);
            let side = sides[at].map(|value| -value);
            for (&row, value) in rows[column(at)].iter().zip(&values[column(at)]) {
                add_times(&mut sides[row as usize], value, &side);
            }
        }
        for at in (0..sides.len()).rev() {
            let mut side = sides[at];
            for (&row, value) in rows[column(at)].iter().zip(&values[column(at)]) {
                let below = sides[row as usize];
                for (sum, [x, y, z, _]) in side.iter_mut().zip(value.0) {
                    *sum = (-x).mul_add(below[0], (-y).mul_add(below[1], (-z).mul_add(below[2], *sum)));
                }
            }
            sides[at] = roots[at].backwards(&side);
        }
    }
}

/// The factor C Cᵀ of a pivot: what stands below its diagonal, and the diagonal inverted.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
struct Root {
    yx: f64,
    zx: f64,
    zy: f64,
    inverse: Vector,
}

impl Root {
    /// The factor of a positive definite block; `None` of any other.
    #[inline(always)]
    fn new(a: &Columns) -> Option<Root> {
        let Columns([[xx, xy, xz, _], [_, yy, yz, _], [_, _, zz, _]]) = *a;
        let x = 1.0 / xx.sqrt();
        let (yx, zx) = (xy * x, xz * x);
        let middle = yy - yx * yx;
        let y = 1.0 / middle.sqrt();
        let zy = (yz - zx * yx) * y;
        let last = zz - zx * zx - zy * zy;
        let z = 1.0 / last.sqrt();
        // What is not a number passes no comparison.
        let definite = xx > 0.0 && middle > 0.0 && last > 0.0;
        let finite = xx.is_finite() && middle.is_finite() && last.is_finite();
        (definite && finite).then_some(Root { yx, zx, zy, inverse: [x, y, z] })
    }

    /// S C⁻ᵀ.
    #[inline(always)]
    fn divide(&self, s: &Columns) -> Columns {
        let [x, y, z] = self.inverse;
        let first = s.0[0].map(|value| value * x);
        let second: Lanes = std::array::from_fn(|lane| (-self.yx).mul_add(first[lane], s.0[1][lane]) * y);
        let third = std::array::from_fn(|lane| {
            (-self.zy).mul_add(second[lane], (-self.zx).mul_add(first[lane], s.0[2][lane])) * z
        });
        Columns([first, second, third])
    }

    /// C⁻¹ v.
    #[inline(always)]
    fn forwards(&self, v: &Lanes) -> Lanes {
        let x = v[0] * self.inverse[0];
        let y = (-self.yx).mul_add(x, v[1]) * self.inverse[1];
        [x, y, (-self.zy).mul_add(y, (-self.zx).mul_add(x, v[2])) * self.inverse[2], 0.0]
    }

    /// C⁻ᵀ v.
    #[inline(always)]
    fn backwards(&self, v: &Lanes) -> Lanes {
        let z = v[2] * self.inverse[2];
        let y = (-self.zy).mul_add(z, v[1]) * self.inverse[1];
        [(-self.yx).mul_add(y, (-self.zx).mul_add(z, v[0])) * self.inverse[0], y, z, 0.0]
    }
}

#[inline(always)]
fn columns_of(block: &Block) -> Columns {
    Columns(std::array::from_fn(|column| [block[0][column], block[1][column], block[2][column], 0.0]))
}

/// a += b c.
#[inline(always)]
fn add_product(a: &mut Columns, b: &Columns, c: &Columns) {
    for (sum, by) in a.0.iter_mut().zip(&c.0) {
        add_times(sum, b, &[by[0], by[1], by[2], 0.0]);
    }
}

/// a += b v.
#[inline(always)]
fn add_times(a: &mut Lanes, b: &Columns, v: &Lanes) {
    for (column, &by) in b.0.iter().zip(v) {
        *a = std::array::from_fn(|lane| column[lane].mul_add(by, a[lane]));
    }
}

/// −aᵀ.
#[inline(always)]
fn negative_transposed(a: &Columns) -> Columns {
    Columns(std::array::from_fn(|column| [-a.0[0][column], -a.0[1][column], -a.0[2][column], 0.0]))
}
