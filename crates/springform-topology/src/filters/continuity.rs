//! The continuity filter: keeps the springs that can carry force.
//!
//! A spring carries force only if it lies on a path between two different anchors. With one virtual node, tied
//! to each anchor, those are the springs of the biconnected components that hold the virtual node.
//! Hopcroft & Tarjan, "Algorithm 447: efficient algorithms for graph manipulation", 1973; iterative here.

/// Marks the springs that lie on a path between two different anchors.
///
/// `springs` are pairs of nodes below `node_count`, each pair once; `anchors` are different nodes.
pub fn carrying(node_count: usize, springs: &[[u32; 2]], anchors: &[u32]) -> Vec<bool> {
    let graph = Graph::new(node_count, springs, anchors);
    Search::new(&graph, springs.len()).run()
}

/// Adjacency of nodes and the virtual node (the last one); arcs hold the far node and the edge.
struct Graph {
    starts: Vec<u32>,
    arcs: Vec<(u32, u32)>,
}

impl Graph {
    fn new(node_count: usize, springs: &[[u32; 2]], anchors: &[u32]) -> Self {
        let root = node_count as u32;
        let edges = || springs.iter().copied().chain(anchors.iter().map(|&anchor| [root, anchor]));
        let mut starts = vec![0u32; node_count + 2];
        for [a, b] in edges() {
            starts[a as usize + 1] += 1;
            starts[b as usize + 1] += 1;
        }
        for node in 0..=node_count {
            starts[node + 1] += starts[node];
        }
        let mut next = starts.clone();
        let mut arcs = vec![(0, 0); starts[node_count + 1] as usize];
        for (edge, [a, b]) in edges().enumerate() {
            for (from, to) in [(a, b), (b, a)] {
                arcs[next[from as usize] as usize] = (to, edge as u32);
                next[from as usize] += 1;
            }
        }
        Graph { starts, arcs }
    }
}

struct Search<'a> {
    graph: &'a Graph,
    spring_count: usize,
    /// Order of discovery, 0 for undiscovered nodes.
    found: Vec<u32>,
    lowest: Vec<u32>,
    next_arc: Vec<u32>,
    edge_stack: Vec<u32>,
    path: Vec<(u32, u32)>,
}

impl<'a> Search<'a> {
    fn new(graph: &'a Graph, spring_count: usize) -> Self {
        let nodes = graph.starts.len() - 1;
        Search {
            graph,
            spring_count,
            found: vec![0; nodes],
            lowest: vec![0; nodes],
            next_arc: graph.starts[..nodes].to_vec(),
            edge_stack: Vec::new(),
            path: Vec::new(),
        }
    }

    fn run(mut self) -> Vec<bool> {
        const NO_EDGE: u32 = u32::MAX;
        let root = (self.graph.starts.len() - 2) as u32;
        let mut carrying = vec![false; self.spring_count];
        let mut time = 1;
        self.found[root as usize] = time;
        self.lowest[root as usize] = time;
        self.path.push((root, NO_EDGE));
        while let Some(&(node, by)) = self.path.last() {
            let at = node as usize;
            if self.next_arc[at] < self.graph.starts[at + 1] {
                let (far, edge) = self.graph.arcs[self.next_arc[at] as usize];
                self.next_arc[at] += 1;
                if edge == by {
                    continue;
                }
                if self.found[far as usize] == 0 {
                    time += 1;
                    self.found[far as usize] = time;
                    self.lowest[far as usize] = time;
                    self.edge_stack.push(edge);
                    self.path.push((far, edge));
                } else if self.found[far as usize] < self.found[at] {
                    self.edge_stack.push(edge);
                    self.lowest[at] = self.lowest[at].min(self.found[far as usize]);
                }
                continue;
            }
            self.path.pop();
            let Some(&(parent, _)) = self.path.last() else { break };
            if self.lowest[at] >= self.found[parent as usize] {
                while let Some(edge) = self.edge_stack.pop() {
                    if parent == root && (edge as usize) < self.spring_count {
                        carrying[edge as usize] = true;
                    }
                    if edge == by {
                        break;
                    }
                }
            } else {
                let lowest = self.lowest[at];
                let above = &mut self.lowest[parent as usize];
                *above = (*above).min(lowest);
            }
        }
        carrying
    }
}
