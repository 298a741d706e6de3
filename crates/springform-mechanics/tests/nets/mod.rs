//! Random nets for the tests of mechanics: designs of the topology tests with positions, and bare networks.

// Every test file uses another part of this.
#![allow(dead_code)]

#[path = "../../../springform-topology/tests/common/mod.rs"]
pub mod common;

use common::Design;
use proptest::array::uniform3;
use proptest::collection::vec;
use proptest::prelude::*;
use springform_mechanics::assembly::{SpringLaw, assemble};
use springform_mechanics::embedding::Embedding;
use springform_mechanics::network::{Network, Sense};
use springform_mechanics::vector::{Vector, length, subtract};
use springform_topology::expression::{Expression, express};

/// A net grown from a random design.
#[derive(Clone, Debug)]
pub struct Net {
    pub design: Design,
    pub expression: Expression,
    pub embedding: Embedding,
    pub network: Network<'static>,
}

/// A point within 10 m of the origin along every axis.
pub fn point() -> impl Strategy<Value = Vector> {
    uniform3(-10.0..10.0f64)
}

/// Nets under random laws without rest lengths; drawn positions are random too.
pub fn nets(edits: usize) -> impl Strategy<Value = Net> {
    let law = (0.01..100.0f64, 0.1..10.0f64)
        .prop_map(|(stiffness, ring_factor)| SpringLaw { stiffness, ring_factor });
    let parts = (common::grown_designs(edits), vec(point(), 5), vec(point(), 41), law);
    parts.prop_filter_map("the filters leave no net", |(design, mut anchors, drawn, law)| {
        let Design { mesh, forest, catalogue, method, .. } = &design;
        let expression = express(mesh, forest, catalogue, *method, &design.anchors).ok()?;
        anchors.truncate(design.anchors.len());
        let base = (0..mesh.vertex_count()).map(|vertex| drawn[vertex as usize % drawn.len()]);
        let embedding = Embedding::drawn(mesh, anchors, base.collect());
        let network = assemble(&expression, &embedding, law);
        Some(Net { design, expression, embedding, network })
    })
}

impl Net {
    /// Largest distance between two anchors [m].
    pub fn extent(&self) -> f64 {
        let anchors = &self.embedding.anchor_positions;
        let distances = anchors.iter().flat_map(|&a| anchors.iter().map(move |&b| length(subtract(a, b))));
        distances.fold(0.0, f64::max)
    }
}

/// A network of unit springs without loads.
pub fn unit_network(positions: Vec<Vector>, springs: Vec<[u32; 2]>, fixed: &[usize]) -> Network<'static> {
    let is_fixed = (0..positions.len()).map(|node| [fixed.contains(&node); 3]).collect::<Vec<_>>();
    Network {
        stiffness: vec![1.0; springs.len()].into(),
        rest_length: vec![0.0; springs.len()].into(),
        force: vec![0.0; springs.len()].into(),
        sense: vec![Sense::Both; springs.len()].into(),
        loads: vec![[0.0; 3]; positions.len()].into(),
        fixed: is_fixed.into(),
        positions: positions.into(),
        springs: springs.into(),
        ..Network::default()
    }
}

/// Largest distance between points of two lists [m].
pub fn largest_distance(a: &[Vector], b: &[Vector]) -> f64 {
    a.iter().zip(b).map(|(&a, &b)| length(subtract(a, b))).fold(0.0, f64::max)
}

/// Solves a dense system by elimination with partial pivoting; one row of `sides` a row of the matrix.
pub fn eliminate<const WIDTH: usize>(
    mut matrix: Vec<Vec<f64>>,
    mut sides: Vec<[f64; WIDTH]>,
) -> Vec<[f64; WIDTH]> {
    let size = matrix.len();
    for column in 0..size {
        let pivot = (column..size)
            .max_by(|&a, &b| matrix[a][column].abs().total_cmp(&matrix[b][column].abs()))
            .expect("a row is left");
        matrix.swap(column, pivot);
        sides.swap(column, pivot);
        for row in column + 1..size {
            let factor = matrix[row][column] / matrix[column][column];
            let (above, below) = matrix.split_at_mut(row);
            below[0].iter_mut().zip(&above[column]).for_each(|(entry, pivot)| *entry -= factor * pivot);
            let pivot = sides[column];
            sides[row].iter_mut().zip(pivot).for_each(|(entry, pivot)| *entry -= factor * pivot);
        }
    }
    for row in (0..size).rev() {
        let (above, below) = sides.split_at_mut(row + 1);
        let known = |side: usize| -> f64 {
            matrix[row][row + 1..].iter().zip(below.iter()).map(|(entry, solved)| entry * solved[side]).sum()
        };
        above[row] = std::array::from_fn(|side| (above[row][side] - known(side)) / matrix[row][row]);
    }
    sides
}
