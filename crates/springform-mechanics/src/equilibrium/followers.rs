//! Loads that follow the shape: weight by length, pressure square to cells.

use crate::network::Network;
use crate::vector::{Vector, add, cross, dot, length, mean, scale, subtract};

/// Loads on every node at positions [N]: dead ones, weight and pressure.
pub(super) fn loads_at(network: &Network<'_>, positions: &[Vector]) -> Vec<Vector> {
    let mut loads = network.loads.to_vec();
    follow(network, positions, &mut loads);
    loads
}

/// Adds the loads that follow the shape [N].
pub(super) fn follow(network: &Network<'_>, positions: &[Vector], loads: &mut [Vector]) {
    for (&[a, b], &weight) in network.springs.iter().zip(network.weight.iter()) {
        let size = length(subtract(positions[b as usize], positions[a as usize]));
        for node in [a, b] {
            loads[node as usize][2] -= 0.5 * weight * size;
        }
    }
    for (cell, &pressure) in network.pressure.values.iter().enumerate() {
        press(network.pressure.cells.of(cell as u32), pressure, positions, loads);
    }
}

/// Adds pressure on a polygon as a fan of triangles about its mean, a third of each triangle to each corner; the mean
/// hands its part on to all nodes.
pub fn press(nodes: &[u32], pressure: f64, positions: &[Vector], loads: &mut [Vector]) {
    let at = |node: u32| positions[node as usize];
    let middle = mean(nodes.iter().map(|&node| at(node)));
    let mut whole = [0.0; 3];
    for (&here, &next) in nodes.iter().zip(nodes.iter().cycle().skip(1)) {
        let area = scale(cross(subtract(at(here), middle), subtract(at(next), middle)), 0.5);
        let third = scale(area, pressure / 3.0);
        loads[here as usize] = add(loads[here as usize], third);
        loads[next as usize] = add(loads[next as usize], third);
        whole = add(whole, third);
    }
    let share = scale(whole, 1.0 / nodes.len().max(1) as f64);
    for &node in nodes {
        loads[node as usize] = add(loads[node as usize], share);
    }
}

/// Fixed-point steps that learn from the last ones.
///
/// Anderson, "Iterative procedures for nonlinear integral equations", 1965, with the least squares of Walker & Ni,
/// "Anderson acceleration for fixed-point iterations", 2011.
#[derive(Default)]
pub(super) struct Accelerated {
    /// Starts and moves of the last steps, the newest last.
    steps: Vec<(Vec<Vector>, Vec<Vector>)>,
}

/// Steps that are remembered.
const MEMORY: usize = 4;

impl Accelerated {
    /// The next start, after a step took positions from one place to another.
    pub(super) fn next(&mut self, from: Vec<Vector>, to: Vec<Vector>) -> Vec<Vector> {
        let moved = difference(&to, &from);
        self.steps.push((from, moved));
        if self.steps.len() > MEMORY {
            self.steps.remove(0);
        }
        let (newest, earlier) = self.steps.split_last().expect("a step was pushed");
        let changes: Vec<[Vec<Vector>; 2]> = earlier
            .iter()
            .map(|(from, moved)| [difference(&newest.0, from), difference(&newest.1, moved)])
            .collect();
        let shares = least_squares(&changes, &newest.1);
        let mut next = to;
        for ([from, moved], share) in changes.iter().zip(shares) {
            for (next, (from, moved)) in next.iter_mut().zip(from.iter().zip(moved)) {
                *next = subtract(*next, scale(add(*from, *moved), share));
            }
        }
        next
    }
}

/// Shares of changes that together come closest to a goal, by normal equations; those without a pivot are 0.
fn least_squares(changes: &[[Vec<Vector>; 2]], goal: &[Vector]) -> Vec<f64> {
    let inner = |a: &[Vector], b: &[Vector]| -> f64 { a.iter().zip(b).map(|(&a, &b)| dot(a, b)).sum() };
    let count = changes.len();
    let mut rows: Vec<Vec<f64>> = (0..count)
        .map(|i| {
            let with = changes.iter().map(|other| inner(&changes[i][1], &other[1]));
            with.chain([inner(&changes[i][1], goal)]).collect()
        })
        .collect();
    let largest = (0..count).map(|at| rows[at][at]).fold(0.0, f64::max);
    rows.iter_mut().enumerate().for_each(|(at, row)| row[at] += 1e-12 * largest);
    for at in 0..count {
        let (done, rest) = rows.split_at_mut(at + 1);
        let row = &mut done[at];
        if row[at] <= 1e-14 * largest {
            row.fill(0.0);
            continue;
        }
        for below in rest {
            let factor = below[at] / row[at];
            below.iter_mut().zip(row.iter()).for_each(|(entry, above)| *entry -= factor * above);
        }
    }
    let mut shares = vec![0.0; count];
    for at in (0..count).rev() {
        let known: f64 = (at + 1..count).map(|column| rows[at][column] * shares[column]).sum();
        shares[at] = if rows[at][at] == 0.0 { 0.0 } else { (rows[at][count] - known) / rows[at][at] };
    }
    shares
}

fn difference(a: &[Vector], b: &[Vector]) -> Vec<Vector> {
    a.iter().zip(b).map(|(&a, &b)| subtract(a, b)).collect()
}
