//! The continuity filter: keeps the springs that can carry force.
//!
//! A spring carries force only if it lies on a path between two different anchors. With one virtual node, tied
//! to each anchor, those are the springs of the biconnected components that hold the virtual node.
//! Hopcroft & Tarjan, "Algorithm 447: efficient algorithms for graph manipulation", 1973. Here no stack of edges is
//! kept: whether the component of an edge holds the root is inherited along the tree, which takes three sweeps
//! over the order in which nodes were found.

/// Marks the springs that lie on a path between two different anchors.
///
/// `springs` are pairs of nodes below `node_count`, each pair once; `anchors` are different nodes.
pub fn carrying(node_count: usize, springs: &[[u32; 2]], anchors: &[u32]) -> Vec<bool> {
    let mut search = Search::default();
    search.run(node_count, springs.iter().copied(), anchors.iter().copied());
    springs.iter().map(|&ends| search.carries(ends)).collect()
}

/// The root's number in the order of finding: it is the virtual node.
const ROOT: u32 = 0;

/// No number: the search has not found the node.
const UNFOUND: u32 = u32::MAX;

/// A search in depth, and the memory for the next one.
#[derive(Clone, Default)]
pub(crate) struct Search {
    /// Neighbours of every node; while the search goes on, `next` is the first that it has not looked at.
    arcs: Vec<u32>,
    next: Vec<u32>,
    ends: Vec<u32>,
    /// Number of every node in the order of finding.
    found: Vec<u32>,
    /// By that number: the node above in the tree, the lowest number reached by one arc from the subtree, and
    /// whether the component of the edge from above holds the root.
    above: Vec<u32>,
    lowest: Vec<u32>,
    carries: Vec<bool>,
    path: Vec<u32>,
}

impl Search {
    /// Searches from the anchors; the arguments are those of [`carrying`].
    pub fn run(
        &mut self,
        node_count: usize,
        springs: impl Iterator<Item = [u32; 2]> + Clone,
        anchors: impl Iterator<Item = u32> + Clone,
    ) {
        self.list_neighbours(node_count, springs.clone());
        self.found.clear();
        self.found.resize(node_count, UNFOUND);
        self.above.clear();
        self.above.push(ROOT);
        for anchor in anchors.clone() {
            self.find_from(anchor);
        }
        self.sweep(springs, anchors);
    }

    /// A spring, given by its ends, lies on a path between two different anchors.
    pub fn carries(&self, [a, b]: [u32; 2]) -> bool {
        let (a, b) = (self.found[a as usize], self.found[b as usize]);
        // Where one end is not found, neither is.
        a != UNFOUND && self.carries[a.max(b) as usize]
    }

    fn list_neighbours(&mut self, node_count: usize, springs: impl Iterator<Item = [u32; 2]> + Clone) {
        self.next.clear();
        self.next.resize(node_count, 0);
        for [a, b] in springs.clone() {
            self.next[a as usize] += 1;
            self.next[b as usize] += 1;
        }
        self.ends.clear();
        let mut end = 0;
        for next in &mut self.next {
            let count = *next;
            *next = end;
            self.ends.push(end);
            end += count;
        }
        self.arcs.resize(end as usize, 0);
        for [a, b] in springs {
            for (from, to) in [(a, b), (b, a)] {
                let end = &mut self.ends[from as usize];
                self.arcs[*end as usize] = to;
                *end += 1;
            }
        }
    }

    /// Finds what can be reached from an anchor and has not been found.
    fn find_from(&mut self, anchor: u32) {
        let Search { arcs, next, ends, found, above, path, .. } = self;
        if found[anchor as usize] != UNFOUND {
            return;
        }
        found[anchor as usize] = above.len() as u32;
        above.push(ROOT);
        let mut node = anchor as usize;
        loop {
            let arc = next[node];
            if arc == ends[node] {
                let Some(back) = path.pop() else { return };
                node = back as usize;
                continue;
            }
            next[node] = arc + 1;
            let far = arcs[arc as usize] as usize;
            if found[far] == UNFOUND {
                let number = above.len() as u32;
                above.push(found[node]);
                found[far] = number;
                path.push(node as u32);
                node = far;
            }
        }
    }

    fn sweep(&mut self, springs: impl Iterator<Item = [u32; 2]>, anchors: impl Iterator<Item = u32>) {
        let Search { found, above, lowest, carries, .. } = self;
        lowest.clear();
        lowest.extend(0..above.len() as u32);
        for anchor in anchors {
            lowest[found[anchor as usize] as usize] = ROOT;
        }
        for [a, b] in springs {
            let (a, b) = (found[a as usize], found[b as usize]);
            if a != UNFOUND {
                let lowest = &mut lowest[a.max(b) as usize];
                *lowest = (*lowest).min(a.min(b));
            }
        }
        for number in (1..above.len()).rev() {
            let up = above[number] as usize;
            lowest[up] = lowest[up].min(lowest[number]);
        }
        carries.clear();
        carries.push(true);
        for number in 1..above.len() {
            let up = above[number];
            // The edge from the root to an anchor is its component's first; others share the edge above if the
            // subtree reaches past it.
            carries.push(up == ROOT || (carries[up as usize] && lowest[number] < up));
        }
    }
}
