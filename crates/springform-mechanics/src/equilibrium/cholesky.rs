//! Sparse LDLᵀ factorisation of symmetric positive definite matrices.
//!
//! Up-looking, after Davis, "Algorithm 849: a concise sparse Cholesky factorization package", 2005, with the
//! approximate minimum degree ordering of Amestoy, Davis & Duff, 1996 (crate `amd`).
//! Entries are summed in a fixed order, so that the same matrix gives the same bits.

use thiserror::Error;

/// A symmetric matrix: its diagonal, and every entry off the diagonal in both triangles, row by row.
#[derive(Clone, PartialEq, Debug)]
pub struct SymmetricMatrix {
    diagonal: Vec<f64>,
    starts: Vec<i64>,
    columns: Vec<i64>,
    values: Vec<f64>,
}

impl SymmetricMatrix {
    /// Collects entries (row, column, value) of one triangle; each place may occur several times.
    pub fn new(diagonal: Vec<f64>, entries: &[(u32, u32, f64)]) -> Self {
        let size = diagonal.len();
        let mut starts = vec![0i64; size + 1];
        for &(row, column, _) in entries {
            starts[row as usize + 1] += 1;
            starts[column as usize + 1] += 1;
        }
        for row in 0..size {
            starts[row + 1] += starts[row];
        }
        let mut next = starts.clone();
        let mut columns = vec![0; 2 * entries.len()];
        let mut values = vec![0.0; 2 * entries.len()];
        for &(row, column, value) in entries {
            for (row, column) in [(row, column), (column, row)] {
                let at = next[row as usize] as usize;
                columns[at] = i64::from(column);
                values[at] = value;
                next[row as usize] += 1;
            }
        }
        SymmetricMatrix { diagonal, starts, columns, values }
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        self.diagonal.len()
    }

    /// Starts of rows and columns in them, ascending, each once and the diagonal among them: `amd` counts on that.
    fn pattern(&self) -> (Vec<i64>, Vec<i64>) {
        let mut starts = vec![0];
        let mut columns = Vec::with_capacity(self.columns.len() + self.size());
        for row in 0..self.size() {
            let mut places: Vec<i64> = self.row(row).map(|(column, _)| column as i64).collect();
            places.push(row as i64);
            places.sort_unstable();
            places.dedup();
            columns.extend(places);
            starts.push(columns.len() as i64);
        }
        (starts, columns)
    }

    fn row(&self, row: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.starts[row] as usize..self.starts[row + 1] as usize;
        range.map(|at| (self.columns[at] as usize, self.values[at]))
    }
}

/// The matrix is not positive definite.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Error)]
#[error("the matrix is not positive definite at row {row}")]
pub struct NotPositiveDefinite {
    /// Row of the matrix whose pivot is not above zero.
    pub row: usize,
}

/// Where the entries of a factor stand: depends on the pattern of the matrix only.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Symbolic {
    /// Row of the matrix at every place of the ordering.
    order: Vec<u32>,
    /// Place of every row in the ordering.
    place: Vec<u32>,
    parent: Vec<u32>,
    starts: Vec<usize>,
}

const ROOT: u32 = u32::MAX;

impl Symbolic {
    /// Orders a matrix and counts the entries of its factor.
    pub fn new(matrix: &SymmetricMatrix) -> Symbolic {
        let (starts, columns) = matrix.pattern();
        let order = amd::order(matrix.size() as i64, &starts, &columns, &amd::Control::default());
        // A refused pattern can't occur (starts ascend, columns are in range); the given order is valid anyway.
        let order = match order {
            Ok((order, _, _)) => order.into_iter().map(|row| row as u32).collect(),
            Err(_) => (0..matrix.size() as u32).collect(),
        };
        Symbolic::ordered(matrix, order)
    }

    fn ordered(matrix: &SymmetricMatrix, order: Vec<u32>) -> Symbolic {
        let size = matrix.size();
        let mut place = vec![0; size];
        for (at, &row) in order.iter().enumerate() {
            place[row as usize] = at as u32;
        }
        let mut parent = vec![ROOT; size];
        let mut seen = vec![ROOT; size];
        let mut starts = vec![0; size + 1];
        for at in 0..size {
            seen[at] = at as u32;
            for (column, _) in matrix.row(order[at] as usize) {
                let mut above = place[column] as usize;
                if above > at {
                    continue;
                }
                while seen[above] != at as u32 {
                    if parent[above] == ROOT {
                        parent[above] = at as u32;
                    }
                    starts[above + 1] += 1;
                    seen[above] = at as u32;
                    above = parent[above] as usize;
                }
            }
        }
        for at in 0..size {
            starts[at + 1] += starts[at];
        }
        Symbolic { order, place, parent, starts }
    }

    /// Entries of the factor below its diagonal.
    pub fn fill(&self) -> usize {
        self.starts[self.order.len()]
    }
}

/// A factor L D Lᵀ.
#[derive(Clone, PartialEq, Debug)]
pub struct Factor {
    symbolic: Symbolic,
    rows: Vec<u32>,
    values: Vec<f64>,
    pivots: Vec<f64>,
}

impl Factor {
    /// Factors a matrix.
    ///
    /// # Errors
    /// A pivot that is not above zero.
    pub fn new(matrix: &SymmetricMatrix) -> Result<Factor, NotPositiveDefinite> {
        Self::with_symbolic(matrix, Symbolic::new(matrix))
    }

    /// Factors a matrix of known pattern.
    ///
    /// # Errors
    /// A pivot that is not above zero.
    pub fn with_symbolic(
        matrix: &SymmetricMatrix,
        symbolic: Symbolic,
    ) -> Result<Factor, NotPositiveDefinite> {
        let size = matrix.size();
        let mut rows = vec![0u32; symbolic.fill()];
        let mut values = vec![0.0; symbolic.fill()];
        let mut pivots = vec![0.0; size];
        let mut next: Vec<usize> = symbolic.starts[..size].to_vec();
        let mut dense = vec![0.0; size];
        let mut seen = vec![ROOT; size];
        let mut pattern = vec![0u32; size];
        for at in 0..size {
            let row = symbolic.order[at] as usize;
            let mut top = size;
            seen[at] = at as u32;
            for (column, value) in matrix.row(row) {
                let mut above = symbolic.place[column];
                if above as usize > at {
                    continue;
                }
                dense[above as usize] += value;
                let mut length = 0;
                while seen[above as usize] != at as u32 {
                    pattern[length] = above;
                    length += 1;
                    seen[above as usize] = at as u32;
                    above = symbolic.parent[above as usize];
                }
                while length > 0 {
                    length -= 1;
                    top -= 1;
                    pattern[top] = pattern[length];
                }
            }
            let mut pivot = matrix.diagonal[row];
            for &column in &pattern[top..] {
                let column = column as usize;
                let value = std::mem::take(&mut dense[column]);
                let range = symbolic.starts[column]..next[column];
                for (&below, &entry) in rows[range.clone()].iter().zip(&values[range]) {
                    dense[below as usize] -= entry * value;
                }
                let entry = value / pivots[column];
                pivot -= entry * value;
                rows[next[column]] = at as u32;
                values[next[column]] = entry;
                next[column] += 1;
            }
            if !(pivot > 0.0 && pivot.is_finite()) {
                return Err(NotPositiveDefinite { row });
            }
            pivots[at] = pivot;
        }
        Ok(Factor { symbolic, rows, values, pivots })
    }

    /// Solves for `WIDTH` right-hand sides at once; `sides` has one row a row of the matrix.
    pub fn solve<const WIDTH: usize>(&self, sides: &mut [[f64; WIDTH]]) {
        let order = &self.symbolic.order;
        let mut x: Vec<[f64; WIDTH]> = order.iter().map(|&row| sides[row as usize]).collect();
        let entries = |at: usize| {
            let range = self.symbolic.starts[at]..self.symbolic.starts[at + 1];
            self.rows[range.clone()].iter().zip(&self.values[range])
        };
        for at in 0..x.len() {
            let value = x[at];
            for (&row, &entry) in entries(at) {
                let below = &mut x[row as usize];
                (0..WIDTH).for_each(|side| below[side] -= entry * value[side]);
            }
        }
        for at in (0..x.len()).rev() {
            let mut value = x[at].map(|value| value / self.pivots[at]);
            for (&row, &entry) in entries(at) {
                let below = x[row as usize];
                (0..WIDTH).for_each(|side| value[side] -= entry * below[side]);
            }
            x[at] = value;
        }
        for (value, &row) in x.into_iter().zip(order) {
            sides[row as usize] = value;
        }
    }
}
