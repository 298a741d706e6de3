//! Factors with one number an entry, for three right-hand sides at once.
//!
//! Left-looking L D Lᵀ by panels (Ng & Peyton 1993): a panel gathers what earlier panels with rows in it give.

use super::graph::Graph;
use super::panels::{Panels, WIDTH};
use super::symbolic::{ROOT, Symbolic};
use super::{Lanes, NotPositiveDefinite};
use pulp::{Arch, NullaryFnOnce};

/// A factor L D Lᵀ and its workspace.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct ScalarFactor {
    panels: Panels,
    order: Vec<u32>,
    values: Vec<Lanes>,
    pivots: Vec<f64>,
    inverses: Vec<f64>,
    /// Where a row stands in the panel at work.
    map: Vec<u32>,
    /// First of the panels that wait for each panel, and the next of each.
    first: Vec<u32>,
    next: Vec<u32>,
    /// Rows of each panel that are done.
    done: Vec<u32>,
    sides: Vec<Lanes>,
}

impl ScalarFactor {
    /// Lays the factor out.
    pub fn lay_out(&mut self, graph: &Graph, symbolic: &Symbolic) {
        self.panels.build(graph, symbolic);
        self.order.clone_from(&symbolic.order);
    }

    /// Factors the matrix of a diagonal, one number a row, and of `links`, one number off the diagonal a link, after it
    /// was laid out for the same graph.
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
        let panels = self.panels.firsts.len() - 1;
        self.values.clear();
        self.values.resize(self.panels.size(), [0.0; WIDTH]);
        for list in [&mut self.pivots, &mut self.inverses] {
            list.resize(size, 0.0);
        }
        self.map.resize(size, 0);
        self.first.clear();
        self.first.resize(panels, ROOT);
        self.next.resize(panels, ROOT);
        self.done.resize(panels, 0);
        Arch::new().dispatch(Factorise { factor: self, graph, symbolic, diagonal, links })
    }

    /// Replaces right-hand sides, one row a row of the matrix, by their solutions.
    pub fn solve(&mut self, sides: &mut [Lanes]) {
        self.sides.clear();
        self.sides.extend(self.order.iter().map(|&row| sides[row as usize]));
        Arch::new().dispatch(Substitute { factor: self });
        for (&value, &row) in self.sides.iter().zip(&self.order) {
            sides[row as usize] = value;
        }
    }

    /// Replaces the right-hand sides that stand at `places`, one a row of the matrix, by their solutions.
    pub fn solve_at(&mut self, places: &[u32], sides: &mut [Lanes]) {
        self.sides.clear();
        self.sides.extend(self.order.iter().map(|&row| sides[places[row as usize] as usize]));
        Arch::new().dispatch(Substitute { factor: self });
        for (&value, &row) in self.sides.iter().zip(&self.order) {
            sides[places[row as usize] as usize] = value;
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
        let ScalarFactor { panels, values, pivots, inverses, map, first, next, done, .. } = self.factor;
        let (order, place) = (self.symbolic.order.as_slice(), self.symbolic.place.as_slice());
        let (values, map) = (values.as_mut_slice(), map.as_mut_slice());
        for panel in 0..panels.firsts.len() - 1 {
            let (left, right) = (panels.firsts[panel] as usize, panels.firsts[panel + 1] as usize);
            let rows = &panels.rows[panels.starts[panel] as usize..panels.starts[panel + 1] as usize];
            let (earlier, own) = values.split_at_mut(left + panels.starts[panel] as usize);
            let own = &mut own[..right - left + rows.len()];
            (left..right).for_each(|column| map[column] = (column - left) as u32);
            (right - left..).zip(rows).for_each(|(at, &row)| map[row as usize] = at as u32);
            for column in left..right {
                let row = order[column];
                own[column - left][column - left] += self.diagonal[row as usize];
                for (other, link) in self.graph.of(row) {
                    let below = place[other as usize] as usize;
                    if below > column {
                        own[map[below] as usize][column - left] += self.links[link as usize];
                    }
                }
            }
            let mut waiting = first[panel];
            while waiting != ROOT {
                let giver = waiting as usize;
                waiting = next[giver];
                let (from, to) = (panels.firsts[giver] as usize, panels.firsts[giver + 1] as usize);
                let start = panels.starts[giver] as usize;
                let rows = &panels.rows[start + done[giver] as usize..panels.starts[giver + 1] as usize];
                let numbers = &earlier[to + start + done[giver] as usize..][..rows.len()];
                let within = rows.iter().take_while(|&&row| (row as usize) < right).count();
                let gift = Gift { rows, numbers, pivots: &pivots[from..to], left, within };
                match to - from {
                    1 => gift.give::<1>(own, map),
                    2 => gift.give::<2>(own, map),
                    3 => gift.give::<3>(own, map),
                    _ => gift.give::<4>(own, map),
                }
                done[giver] += within as u32;
                wait(panels, rows.get(within), giver, first, next);
            }
            eliminate(own, &mut pivots[left..right], &mut inverses[left..right])
                .map_err(|column| NotPositiveDefinite { row: order[left + column] })?;
            done[panel] = 0;
            wait(panels, rows.first(), panel, first, next);
        }
        Ok(())
    }
}

/// Lets a panel wait for the one that its next row is in.
#[inline(always)]
fn wait(panels: &Panels, row: Option<&u32>, panel: usize, first: &mut [u32], next: &mut [u32]) {
    if let Some(&row) = row {
        let other = panels.panel[row as usize] as usize;
        next[panel] = first[other];
        first[other] = panel as u32;
    }
}

/// What a panel subtracts from a later one.
struct Gift<'a> {
    /// Rows of the giver from the first in the later panel on, and its numbers there.
    rows: &'a [u32],
    numbers: &'a [Lanes],
    pivots: &'a [f64],
    /// First column of the later panel.
    left: usize,
    /// How many of the rows are columns of the later panel.
    within: usize,
}

impl Gift<'_> {
    #[inline(always)]
    fn give<const COLUMNS: usize>(self, own: &mut [Lanes], map: &[u32]) {
        let mut factors = [[0.0; WIDTH]; COLUMNS];
        for (&row, numbers) in self.rows[..self.within].iter().zip(self.numbers) {
            let lane = (row as usize - self.left) % WIDTH;
            for column in 0..COLUMNS {
                factors[column][lane] = -(numbers[column] * self.pivots[column]);
            }
        }
        for (&row, numbers) in self.rows.iter().zip(self.numbers) {
            let sum = &mut own[map[row as usize] as usize];
            let mut next = *sum;
            for column in 0..COLUMNS {
                for lane in 0..WIDTH {
                    next[lane] = numbers[column].mul_add(factors[column][lane], next[lane]);
                }
            }
            *sum = next;
        }
    }
}

/// Eliminates the columns of a panel; the column whose pivot is not above zero is the error.
#[inline(always)]
fn eliminate(own: &mut [Lanes], pivots: &mut [f64], inverses: &mut [f64]) -> Result<(), usize> {
    let width = pivots.len();
    // Columns of the triangle, zero above and on its diagonal.
    let mut lower = [[0.0; WIDTH]; WIDTH];
    let mut inverse = [0.0; WIDTH];
    for column in 0..width {
        let pivot = own[column][column];
        if !(pivot > 0.0 && pivot.is_finite()) {
            return Err(column);
        }
        (pivots[column], inverse[column]) = (pivot, 1.0 / pivot);
        for row in column + 1..width {
            lower[column][row] = own[row][column] * inverse[column];
        }
        for (row, numbers) in own[..width].iter_mut().enumerate().skip(column + 1) {
            let unscaled = numbers[column];
            for lane in column + 1..=row {
                numbers[lane] = (-lower[column][lane]).mul_add(unscaled, numbers[lane]);
            }
        }
    }
    inverses.copy_from_slice(&inverse[..width]);
    let (triangle, below) = own.split_at_mut(width);
    for (row, numbers) in triangle.iter_mut().enumerate() {
        for column in 0..row {
            numbers[column] = lower[column][row];
        }
    }
    for numbers in below {
        let mut rest = *numbers;
        for column in 0..WIDTH {
            let unscaled = rest[column];
            for lane in 0..WIDTH {
                rest[lane] = (-lower[column][lane]).mul_add(unscaled, rest[lane]);
            }
        }
        for lane in 0..WIDTH {
            numbers[lane] = rest[lane] * inverse[lane];
        }
    }
    Ok(())
}

struct Substitute<'a> {
    factor: &'a mut ScalarFactor,
}

impl NullaryFnOnce for Substitute<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let ScalarFactor { panels, values, inverses, sides, .. } = self.factor;
        let (values, sides) = (values.as_slice(), sides.as_mut_slice());
        let count = panels.firsts.len() - 1;
        for panel in 0..count {
            let part = Part::new(panels, values, panel);
            match part.triangle.len() {
                1 => part.forwards::<1>(sides),
                2 => part.forwards::<2>(sides),
                3 => part.forwards::<3>(sides),
                _ => part.forwards::<4>(sides),
            }
        }
        for panel in (0..count).rev() {
            let part = Part::new(panels, values, panel);
            match part.triangle.len() {
                1 => part.backwards::<1>(sides, inverses),
                2 => part.backwards::<2>(sides, inverses),
                3 => part.backwards::<3>(sides, inverses),
                _ => part.backwards::<4>(sides, inverses),
            }
        }
    }
}

/// A panel and its numbers.
struct Part<'a> {
    left: usize,
    triangle: &'a [Lanes],
    below: &'a [Lanes],
    rows: &'a [u32],
}

impl<'a> Part<'a> {
    #[inline(always)]
    fn new(panels: &'a Panels, values: &'a [Lanes], panel: usize) -> Self {
        let (left, right) = (panels.firsts[panel] as usize, panels.firsts[panel + 1] as usize);
        let (start, end) = (panels.starts[panel] as usize, panels.starts[panel + 1] as usize);
        let (triangle, below) = values[left + start..right + end].split_at(right - left);
        Part { left, triangle, below, rows: &panels.rows[start..end] }
    }

    #[inline(always)]
    fn forwards<const COLUMNS: usize>(self, sides: &mut [Lanes]) {
        let Some(&(mut own)) = sides[self.left..].first_chunk::<COLUMNS>() else { return };
        for row in 1..COLUMNS {
            for column in 0..row {
                own[row] = minus(own[row], self.triangle[row][column], own[column]);
            }
        }
        (self.left..).zip(own).for_each(|(column, side)| sides[column] = side);
        for (&row, numbers) in self.rows.iter().zip(self.below) {
            let side = &mut sides[row as usize];
            let mut next = *side;
            for column in 0..COLUMNS {
                next = minus(next, numbers[column], own[column]);
            }
            *side = next;
        }
    }

    #[inline(always)]
    fn backwards<const COLUMNS: usize>(self, sides: &mut [Lanes], inverses: &[f64]) {
        let Some(&(mut own)) = sides[self.left..].first_chunk::<COLUMNS>() else { return };
        for (own, inverse) in own.iter_mut().zip(&inverses[self.left..]) {
            for value in own {
                *value *= inverse;
            }
        }
        for (&row, numbers) in self.rows.iter().zip(self.below) {
            let side = sides[row as usize];
            for column in 0..COLUMNS {
                own[column] = minus(own[column], numbers[column], side);
            }
        }
        for column in (0..COLUMNS).rev() {
            for row in column + 1..COLUMNS {
                own[column] = minus(own[column], self.triangle[row][column], own[row]);
            }
        }
        (self.left..).zip(own).for_each(|(column, side)| sides[column] = side);
    }
}

/// a − s b.
#[inline(always)]
fn minus(mut a: Lanes, s: f64, b: Lanes) -> Lanes {
    for lane in 0..WIDTH {
        a[lane] = (-s).mul_add(b[lane], a[lane]);
    }
    a
}
