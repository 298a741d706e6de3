//! Sparse factors against dense elimination, of one number and of blocks, and what is not positive definite.

mod nets;

use nets::common::cases;
use nets::eliminate;
use proptest::collection::vec;
use proptest::prelude::*;
use springform_mechanics::sparse::{
    Block, BlockFactor, Graph, Lanes, NotPositiveDefinite, ScalarFactor, Symbolic,
};

/// A symmetric matrix of blocks of `WIDTH`, as a diagonal and links off it.
#[derive(Clone, Debug)]
struct Given<const WIDTH: usize> {
    diagonal: Vec<[[f64; WIDTH]; WIDTH]>,
    links: Vec<[[f64; WIDTH]; WIDTH]>,
    ends: Vec<[u32; 2]>,
}

impl<const WIDTH: usize> Given<WIDTH> {
    /// Adds (A x − B y)ᵀ(A x − B y) of two rows: never negative.
    fn add(&mut self, [x, y]: [u32; 2], a: [[f64; WIDTH]; WIDTH], b: [[f64; WIDTH]; WIDTH]) {
        let product = |a: &[[f64; WIDTH]; WIDTH], b: &[[f64; WIDTH]; WIDTH], sign: f64| {
            std::array::from_fn(|i| {
                std::array::from_fn(|j| sign * (0..WIDTH).map(|at| a[at][i] * b[at][j]).sum::<f64>())
            })
        };
        for (row, block) in [(x, product(&a, &a, 1.0)), (y, product(&b, &b, 1.0))] {
            let block: [[f64; WIDTH]; WIDTH] = block;
            for (sum, add) in self.diagonal[row as usize].iter_mut().flatten().zip(block.iter().flatten()) {
                *sum += add;
            }
        }
        self.links.push(product(&a, &b, -1.0));
        self.ends.push([x, y]);
    }

    fn dense(&self) -> Vec<Vec<f64>> {
        let size = WIDTH * self.diagonal.len();
        let mut dense = vec![vec![0.0; size]; size];
        let mut add = |row: usize, column: usize, value: f64| dense[row][column] += value;
        for i in 0..WIDTH {
            for j in 0..WIDTH {
                for (row, block) in self.diagonal.iter().enumerate() {
                    add(WIDTH * row + i, WIDTH * row + j, block[i][j]);
                }
                for (&[x, y], block) in self.ends.iter().zip(&self.links) {
                    let (row, column) = (WIDTH * x as usize + i, WIDTH * y as usize + j);
                    add(row, column, block[i][j]);
                    add(column, row, block[i][j]);
                }
            }
        }
        dense
    }

    fn layout(&self) -> (Graph, Symbolic) {
        let (mut graph, mut symbolic) = (Graph::default(), Symbolic::default());
        graph.build(self.diagonal.len(), self.ends.iter().copied());
        symbolic.build(&graph);
        (graph, symbolic)
    }
}

fn block<const WIDTH: usize>() -> impl Strategy<Value = [[f64; WIDTH]; WIDTH]> {
    vec(-2.0..2.0f64, WIDTH * WIDTH)
        .prop_map(|values| std::array::from_fn(|i| std::array::from_fn(|j| values[WIDTH * i + j])))
}

/// Sums of squares over pairs of rows on top of a positive diagonal.
fn positive_definite<const WIDTH: usize>() -> impl Strategy<Value = Given<WIDTH>> {
    let pair = (0u32..40, 0u32..40, block::<WIDTH>(), block::<WIDTH>());
    (1u32..40, vec(pair, 0..80), vec(0.1..3.0f64, 40)).prop_map(|(size, pairs, diagonal)| {
        let alone = |row: usize| {
            std::array::from_fn(|i| std::array::from_fn(|j| if i == j { diagonal[row] } else { 0.0 }))
        };
        let mut given =
            Given { diagonal: (0..size as usize).map(alone).collect(), links: Vec::new(), ends: Vec::new() };
        for (x, y, a, b) in pairs {
            if x % size != y % size {
                given.add([x % size, y % size], a, b);
            }
        }
        given
    })
}

impl Given<1> {
    fn factor(&self) -> Result<(ScalarFactor, Symbolic), NotPositiveDefinite> {
        let (graph, symbolic) = self.layout();
        let flat = |blocks: &[[[f64; 1]; 1]]| blocks.iter().map(|block| block[0][0]).collect::<Vec<f64>>();
        let mut factor = ScalarFactor::default();
        factor.lay_out(&graph, &symbolic);
        factor.factor(&graph, &symbolic, &flat(&self.diagonal), &flat(&self.links))?;
        Ok((factor, symbolic))
    }
}

impl Given<3> {
    fn factor(&self) -> Result<(BlockFactor, Symbolic), NotPositiveDefinite> {
        let (graph, symbolic) = self.layout();
        let mut factor = BlockFactor::default();
        factor.lay_out(&graph, &symbolic);
        let links: Vec<Block> = self.links.clone();
        factor.factor(&graph, &symbolic, &self.diagonal, &links, &self.ends)?;
        Ok((factor, symbolic))
    }
}

proptest! {
    #![proptest_config(cases(2000))]

    /// Solutions are those of dense elimination, for three sides at once.
    #[test]
    fn numbers_agree_with_dense_elimination(given in positive_definite::<1>(), sides in vec(block::<3>(), 40)) {
        let sides: Vec<[f64; 3]> = sides[..given.diagonal.len()].iter().map(|rows| rows[0]).collect();
        let (mut factor, _) = given.factor().expect("a positive definite matrix");
        let mut found: Vec<Lanes> = sides.iter().map(|&[x, y, z]| [x, y, z, 0.0]).collect();
        factor.solve(&mut found);
        for (found, expected) in found.iter().zip(eliminate(given.dense(), sides)) {
            for (found, expected) in found.iter().zip(expected) {
                prop_assert!((found - expected).abs() <= 1e-9 * (1.0 + expected.abs()), "{found} {expected}");
            }
        }
    }

    /// Solutions of blocks are those of dense elimination.
    #[test]
    fn blocks_agree_with_dense_elimination(given in positive_definite::<3>(), side in vec(block::<3>(), 40)) {
        let side: Vec<[f64; 3]> = side[..given.diagonal.len()].iter().map(|rows| rows[0]).collect();
        let (mut factor, _) = given.factor().expect("a positive definite matrix");
        let mut found: Vec<Lanes> = side.iter().map(|&[x, y, z]| [x, y, z, 0.0]).collect();
        factor.solve(&mut found);
        let flat: Vec<[f64; 1]> = side.into_iter().flatten().map(|value| [value]).collect();
        let found = found.iter().flat_map(|lanes| &lanes[..3]);
        for (found, [expected]) in found.zip(eliminate(given.dense(), flat)) {
            prop_assert!((found - expected).abs() <= 1e-8 * (1.0 + expected.abs()), "{found} {expected}");
        }
    }

    /// A workspace that was used before, even for a refused matrix, gives the same bits.
    #[test]
    fn a_used_workspace_changes_nothing(first in positive_definite::<1>(), given in positive_definite::<1>()) {
        let (mut used, _) = first.factor().expect("a positive definite matrix");
        let (graph, symbolic) = given.layout();
        let flat = |blocks: &[[[f64; 1]; 1]]| blocks.iter().map(|block| block[0][0]).collect::<Vec<f64>>();
        let mut negative = flat(&given.diagonal);
        negative.iter_mut().for_each(|value| *value = -*value);
        used.lay_out(&graph, &symbolic);
        prop_assert!(used.factor(&graph, &symbolic, &negative, &flat(&given.links)).is_err());
        used.factor(&graph, &symbolic, &flat(&given.diagonal), &flat(&given.links)).expect("positive definite");
        let (mut fresh, _) = given.factor().expect("a positive definite matrix");
        let mut sides = [vec![[1.0, 2.0, 3.0, 0.0]; graph.rows()], vec![[1.0, 2.0, 3.0, 0.0]; graph.rows()]];
        used.solve(&mut sides[0]);
        fresh.solve(&mut sides[1]);
        prop_assert_eq!(&sides[0], &sides[1]);
    }

    /// A direction in which the matrix is clearly negative is found out.
    #[test]
    fn indefinite_matrices_are_refused(given in positive_definite::<1>(), at in any::<prop::sample::Index>()) {
        let row = at.index(given.diagonal.len());
        let mut wrong = given.clone();
        wrong.diagonal[row][0][0] = -0.5;
        prop_assert!(wrong.factor().is_err());
    }

    /// So is one of blocks.
    #[test]
    fn indefinite_blocks_are_refused(
        given in positive_definite::<3>(), at in any::<prop::sample::Index>(), axis in 0usize..3
    ) {
        let row = at.index(given.diagonal.len());
        let mut wrong = given.clone();
        wrong.diagonal[row][axis][axis] = -0.5;
        prop_assert!(wrong.factor().is_err());
    }

    /// A row without entries is found out and named.
    #[test]
    fn empty_rows_are_named(mut given in positive_definite::<1>(), at in any::<prop::sample::Index>()) {
        let row = at.index(given.diagonal.len()) as u32;
        given.diagonal[row as usize] = [[0.0]];
        let kept: Vec<bool> = given.ends.iter().map(|ends| !ends.contains(&row)).collect();
        let mut kept_links = kept.iter();
        given.links.retain(|_| *kept_links.next().expect("one a link"));
        let mut kept_ends = kept.iter();
        given.ends.retain(|_| *kept_ends.next().expect("one a link"));
        prop_assert_eq!(given.factor().map(|_| ()), Err(NotPositiveDefinite { row }));
    }

    /// The matrix of a free tree of unit springs is singular, to the bit.
    #[test]
    fn free_trees_are_singular(parents in vec(any::<prop::sample::Index>(), 1..40)) {
        let mut given =
            Given { diagonal: vec![[[0.0]]; parents.len() + 1], links: Vec::new(), ends: Vec::new() };
        for (at, parent) in parents.iter().enumerate() {
            given.add([at as u32 + 1, parent.index(at + 1) as u32], [[1.0]], [[1.0]]);
        }
        prop_assert!(given.factor().is_err());
    }

    /// Numbers that are not finite are refused.
    #[test]
    fn numbers_that_are_not_finite_are_refused(
        mut given in positive_definite::<1>(), at in any::<prop::sample::Index>(), nan: bool
    ) {
        let row = at.index(given.diagonal.len());
        given.diagonal[row][0][0] = if nan { f64::NAN } else { f64::INFINITY };
        prop_assert!(given.factor().is_err());
    }

    /// Any order of elimination gives the same solution.
    #[test]
    fn orders_agree(given in positive_definite::<1>(), keys in vec(any::<u32>(), 40)) {
        let (graph, symbolic) = given.layout();
        let mut order: Vec<u32> = (0..graph.rows() as u32).collect();
        order.sort_by_key(|&row| keys[row as usize]);
        let mut other = Symbolic::default();
        other.build_ordered(&graph, &order);
        let flat = |blocks: &[[[f64; 1]; 1]]| blocks.iter().map(|block| block[0][0]).collect::<Vec<f64>>();
        let mut found = [(); 2].map(|()| vec![[1.0, -2.0, 0.5, 0.0]; graph.rows()]);
        for (symbolic, sides) in [symbolic, other].iter().zip(&mut found) {
            let mut factor = ScalarFactor::default();
            factor.lay_out(&graph, symbolic);
            factor
                .factor(&graph, symbolic, &flat(&given.diagonal), &flat(&given.links))
                .expect("a positive definite matrix");
            factor.solve(sides);
        }
        for (a, b) in found[0].iter().flatten().zip(found[1].iter().flatten()) {
            prop_assert!((a - b).abs() <= 1e-9 * (1.0 + a.abs()));
        }
    }
}

#[test]
fn no_rows_need_no_work() {
    let (mut factor, _) = Given::<1> { diagonal: Vec::new(), links: Vec::new(), ends: Vec::new() }
        .factor()
        .expect("nothing is positive definite");
    factor.solve(&mut []);
}
