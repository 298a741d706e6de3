//! Continuity against brute force: every simple path between two anchors of small random graphs.

mod common;

use common::oracle::Flow;
use common::{Dice, cases};
use proptest::prelude::*;
use springform_topology::filters::continuity::carrying;
use std::collections::BTreeSet;

#[derive(Clone, Debug)]
struct Graph {
    nodes: usize,
    springs: Vec<[u32; 2]>,
    anchors: Vec<u32>,
}

/// Up to 12 nodes and 18 springs, none to four anchors.
fn graphs() -> impl Strategy<Value = Graph> {
    common::dice(60).prop_map(|mut dice| {
        let nodes = dice.between(1, 12);
        let mut springs = BTreeSet::new();
        for _ in 0..dice.below(19) {
            let (a, b) = (dice.below(nodes), dice.below(nodes));
            springs.extend((a != b).then_some([a.min(b), a.max(b)]));
        }
        let anchors = some_of(&mut dice, nodes);
        Graph { nodes: nodes as usize, springs: springs.into_iter().collect(), anchors }
    })
}

fn some_of(dice: &mut Dice, nodes: u32) -> Vec<u32> {
    let mut all: Vec<u32> = (0..nodes).collect();
    dice.shuffle(&mut all);
    all.truncate(dice.below(5) as usize);
    all
}

/// Springs on simple paths between two different anchors, found by walking all of them.
fn on_paths(graph: &Graph) -> Vec<bool> {
    let mut found = vec![false; graph.springs.len()];
    for &anchor in &graph.anchors {
        let mut visited = vec![false; graph.nodes];
        visited[anchor as usize] = true;
        walk(graph, anchor, &mut visited, &mut Vec::new(), &mut found);
    }
    found
}

fn walk(graph: &Graph, node: u32, visited: &mut [bool], path: &mut Vec<usize>, found: &mut [bool]) {
    if !path.is_empty() && graph.anchors.contains(&node) {
        for &spring in path.iter() {
            found[spring] = true;
        }
    }
    for (spring, &[a, b]) in graph.springs.iter().enumerate() {
        let far = if a == node {
            b
        } else if b == node {
            a
        } else {
            continue;
        };
        if !visited[far as usize] {
            visited[far as usize] = true;
            path.push(spring);
            walk(graph, far, visited, path, found);
            path.pop();
            visited[far as usize] = false;
        }
    }
}

proptest! {
    #![proptest_config(cases(5000))]

    /// The filter keeps the springs of simple paths between anchors, no more and no less.
    #[test]
    fn keeps_what_lies_on_a_path_between_two_anchors(graph in graphs()) {
        let kept = carrying(graph.nodes, &graph.springs, &graph.anchors);
        prop_assert_eq!(kept, on_paths(&graph));
    }

    /// The flow oracle of the other tests says the same as all simple paths.
    #[test]
    fn flow_says_the_same(graph in graphs()) {
        let flow = Flow::new(graph.nodes, &graph.springs, &graph.anchors);
        let carries: Vec<bool> = graph.springs.iter().map(|&ends| flow.carries(ends)).collect();
        prop_assert_eq!(carries, on_paths(&graph));
    }

    /// Neither the order of springs nor that of anchors matters.
    #[test]
    fn order_does_not_matter(graph in graphs(), mut dice in common::dice(40)) {
        let mut order: Vec<usize> = (0..graph.springs.len()).collect();
        dice.shuffle(&mut order);
        let springs: Vec<[u32; 2]> = order.iter().map(|&at| graph.springs[at]).collect();
        let mut anchors = graph.anchors.clone();
        dice.shuffle(&mut anchors);
        let kept = carrying(graph.nodes, &graph.springs, &graph.anchors);
        let expected: Vec<bool> = order.iter().map(|&at| kept[at]).collect();
        prop_assert_eq!(carrying(graph.nodes, &springs, &anchors), expected);
    }
}

fn kept(nodes: usize, springs: &[[u32; 2]], anchors: &[u32]) -> Vec<usize> {
    let kept = carrying(nodes, springs, anchors);
    (0..springs.len()).filter(|&spring| kept[spring]).collect()
}

#[test]
fn loose_ends_hung_loops_and_islands_go() {
    // 0 and 3 are anchors: a path 0-1-2-3, a loose end 1-4, a loop 2-5-6 hung on one node, an island 7-8-9,
    // a loop 3-10-11 hung on one anchor.
    let springs = [
        [0, 1],
        [1, 2],
        [2, 3],
        [1, 4],
        [2, 5],
        [5, 6],
        [2, 6],
        [7, 8],
        [8, 9],
        [7, 9],
        [3, 10],
        [10, 11],
        [3, 11],
    ];
    assert_eq!(kept(12, &springs, &[0, 3]), [0, 1, 2]);
}

#[test]
fn one_anchor_or_none_carries_nothing() {
    let ring = [[0, 1], [1, 2], [0, 2]];
    assert_eq!(kept(3, &ring, &[0]), Vec::<usize>::new());
    assert_eq!(kept(3, &ring, &[]), Vec::<usize>::new());
}

#[test]
fn a_spring_between_two_anchors_carries() {
    assert_eq!(kept(2, &[[0, 1]], &[0, 1]), [0]);
}

#[test]
fn a_long_chain_does_not_overflow_the_stack() {
    let springs: Vec<[u32; 2]> = (0..200_000).map(|node| [node, node + 1]).collect();
    assert!(carrying(200_001, &springs, &[0, 200_000]).into_iter().all(|kept| kept));
}
