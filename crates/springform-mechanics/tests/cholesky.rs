//! Sparse factorisation against dense elimination, and what is not positive definite.

mod nets;

use nets::common::cases;
use nets::eliminate;
use proptest::collection::vec;
use proptest::prelude::*;
use springform_mechanics::equilibrium::cholesky::{Factor, NotPositiveDefinite, Symbolic, SymmetricMatrix};

/// A symmetric matrix given twice: dense, and as diagonal and entries of one triangle.
#[derive(Clone, Debug)]
struct Given {
    dense: Vec<Vec<f64>>,
    diagonal: Vec<f64>,
    entries: Vec<(u32, u32, f64)>,
}

impl Given {
    fn new(size: usize) -> Given {
        Given { dense: vec![vec![0.0; size]; size], diagonal: vec![0.0; size], entries: Vec::new() }
    }

    fn add(&mut self, row: usize, column: usize, value: f64) {
        self.dense[row][column] += value;
        if row == column {
            self.diagonal[row] += value;
        } else {
            self.dense[column][row] += value;
            self.entries.push((row as u32, column as u32, value));
        }
    }

    /// Adds weight · v vᵀ for a sparse vector v of different rows.
    fn add_outer(&mut self, vector: &[(usize, f64)], weight: f64) {
        for (at, &(row, value)) in vector.iter().enumerate() {
            self.add(row, row, weight * value * value);
            for &(column, other) in &vector[..at] {
                self.add(row, column, weight * value * other);
            }
        }
    }

    fn sparse(&self) -> SymmetricMatrix {
        SymmetricMatrix::new(self.diagonal.clone(), &self.entries)
    }
}

/// Sums of sparse outer products on top of a positive diagonal: positive definite.
fn positive_definite() -> impl Strategy<Value = Given> {
    let outer = vec((0usize..40, -2.0..2.0f64), 1..4);
    (1usize..40, vec(outer, 0..80), vec(0.1..3.0f64, 40)).prop_map(|(size, outers, diagonal)| {
        let mut given = Given::new(size);
        (0..size).for_each(|row| given.add(row, row, diagonal[row]));
        for mut outer in outers {
            outer.iter_mut().for_each(|(row, _)| *row %= size);
            outer.sort_by_key(|&(row, _)| row);
            outer.dedup_by_key(|&mut (row, _)| row);
            given.add_outer(&outer, 1.0);
        }
        given
    })
}

proptest! {
    #![proptest_config(cases(2000))]

    /// Solutions are those of dense elimination, for several sides at once.
    #[test]
    fn agrees_with_dense_elimination(
        given in positive_definite(), sides in vec([-5.0..5.0f64, -5.0..5.0], 40),
    ) {
        let sides = sides[..given.diagonal.len()].to_vec();
        let factor = Factor::new(&given.sparse()).expect("a positive definite matrix");
        let mut found = sides.clone();
        factor.solve(&mut found);
        let expected = eliminate(given.dense, sides);
        for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
            prop_assert!((found - expected).abs() <= 1e-9 * (1.0 + expected.abs()), "{found} {expected}");
        }
    }

    /// A pattern that is known already gives the same bits.
    #[test]
    fn a_known_pattern_changes_nothing(given in positive_definite()) {
        let matrix = given.sparse();
        let symbolic = Symbolic::new(&matrix);
        prop_assert_eq!(Factor::with_symbolic(&matrix, symbolic), Factor::new(&matrix));
    }

    /// A direction in which the matrix is clearly negative is found out.
    #[test]
    fn indefinite_matrices_are_refused(mut given in positive_definite(), at in any::<prop::sample::Index>()) {
        let row = at.index(given.diagonal.len());
        let pull = given.diagonal[row] + 0.5;
        given.add(row, row, -pull);
        prop_assert!(Factor::new(&given.sparse()).is_err());
    }

    /// A row without entries is found out and named.
    #[test]
    fn empty_rows_are_named(mut given in positive_definite(), at in any::<prop::sample::Index>()) {
        let row = at.index(given.diagonal.len());
        given.diagonal[row] = 0.0;
        given.entries.retain(|&(a, b, _)| a as usize != row && b as usize != row);
        prop_assert_eq!(Factor::new(&given.sparse()), Err(NotPositiveDefinite { row }));
    }

    /// The matrix of a free tree of unit springs is singular, to the bit.
    #[test]
    fn free_trees_are_singular(parents in vec(any::<prop::sample::Index>(), 1..40)) {
        let mut given = Given::new(parents.len() + 1);
        for (at, parent) in parents.iter().enumerate() {
            given.add_outer(&[(at + 1, 1.0), (parent.index(at + 1), -1.0)], 1.0);
        }
        prop_assert!(Factor::new(&given.sparse()).is_err());
    }

    /// Numbers that are not finite are refused.
    #[test]
    fn numbers_that_are_not_finite_are_refused(
        mut given in positive_definite(), at in any::<prop::sample::Index>(), nan: bool
    ) {
        let row = at.index(given.diagonal.len());
        given.diagonal[row] = if nan { f64::NAN } else { f64::INFINITY };
        prop_assert!(Factor::new(&given.sparse()).is_err());
    }
}

#[test]
fn no_rows_need_no_work() {
    let factor = Factor::new(&SymmetricMatrix::new(Vec::new(), &[])).expect("nothing is positive definite");
    factor.solve::<3>(&mut []);
}
