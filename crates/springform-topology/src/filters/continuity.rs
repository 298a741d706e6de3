//! The continuity filter: keeps the springs that can carry force.
//!
//! A spring carries force only if it lies on a path between two different anchors. With one virtual node, tied
//! to each anchor, those are the springs of the biconnected components that hold the virtual node.
//! Hopcroft & Tarjan, "Algorithm 447: efficient algorithms for graph manipulation", 1973. Here no stack of edges is
//! kept: whether the component of an edge holds the root is inherited down the tree, from node to node.

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

/// No number: the search has not found the node, which is an anchor. Numbers of found nodes are below.
const UNFOUND_ANCHOR: u32 = u32::MAX - 1;

/// A search in depth, and the memory for the next one.
#[derive(Clone, Default)]
pub(crate) struct Search {
    /// Neighbours of all nodes.
    arcs: Vec<u32>,
    /// Arcs of every node that the search has not looked at: from here to there.
    open: Vec<[u32; 2]>,
    /// Number of every node in the order of finding.
    found: Vec<u32>,
    /// By that number, the root first: who was found.
    order: Vec<Found>,
    /// Nodes from an anchor to the node under search.
    path: Vec<u32>,
    complete: bool,
}

/// A node that the search has found.
#[derive(Clone, Copy)]
struct Found {
    /// Number of the node above in the tree.
    above: u32,
    /// Lowest number that is one arc away from the node or from what lies below it.
    lowest: u32,
    /// The component of the edge from above holds the root.
    carries: bool,
}

impl Search {
    /// Searches from the anchors; the arguments are those of [`carrying`].
    pub fn run(
        &mut self,
        node_count: usize,
        springs: impl Iterator<Item = [u32; 2]> + Clone,
        anchors: impl Iterator<Item = u32> + Clone,
    ) {
        self.list_neighbours(node_count, springs);
        self.found.clear();
        self.found.resize(node_count, UNFOUND);
        self.order.clear();
        self.order.push(Found { above: ROOT, lowest: ROOT, carries: true });
        self.complete = true;
        for anchor in anchors.clone() {
            self.found[anchor as usize] = UNFOUND_ANCHOR;
        }
        for anchor in anchors {
            self.find_from(anchor);
        }
        self.complete &= self.order.len() == node_count + 1;
        if !self.complete {
            self.inherit();
        }
    }

    /// Every spring lies on a path between two different anchors, and every node has a spring.
    pub fn all_carry(&self) -> bool {
        self.complete
    }

    /// A spring, given by its ends, lies on a path between two different anchors.
    pub fn carries(&self, [a, b]: [u32; 2]) -> bool {
        let (a, b) = (self.found[a as usize], self.found[b as usize]);
        // Where one end is not found, neither is.
        self.complete || (a != UNFOUND && self.order[a.max(b) as usize].carries)
    }

    fn list_neighbours(&mut self, node_count: usize, springs: impl Iterator<Item = [u32; 2]> + Clone) {
        let Search { open, arcs, .. } = self;
        open.clear();
        open.resize(node_count, [0, 0]);
        for [a, b] in springs.clone() {
            open[a as usize][1] += 1;
            open[b as usize][1] += 1;
        }
        let mut end = 0;
        for arcs in open.iter_mut() {
            let first = end;
            end += arcs[1];
            *arcs = [first, first];
        }
        arcs.resize(end as usize, 0);
        for [a, b] in springs {
            for (from, to) in [(a, b), (b, a)] {
                let end = &mut open[from as usize][1];
                arcs[*end as usize] = to;
                *end += 1;
            }
        }
    }

    /// Finds what can be reached from an anchor and has not been found.
    fn find_from(&mut self, anchor: u32) {
        let Search { arcs, open, found, order, path, complete, .. } = self;
        if found[anchor as usize] != UNFOUND_ANCHOR {
            return;
        }
        let (mut node, mut number, mut above) = (anchor as usize, order.len() as u32, ROOT);
        // An anchor without springs carries nothing.
        *complete &= open[node][0] < open[node][1];
        loop {
            let lowest = if found[node] == UNFOUND_ANCHOR { ROOT } else { number };
            found[node] = number;
            order.push(Found { above, lowest, carries: above == ROOT });
            path.push(node as u32);
            // Up the tree as long as a node has nothing left to look at.
            loop {
                let Some(&top) = path.last() else { return };
                node = top as usize;
                number = found[node];
                let [first, end] = open[node];
                let mut lowest = order[number as usize].lowest;
                let unfound = arcs[first as usize..end as usize].iter().position(|&far| {
                    let far = found[far as usize];
                    lowest = lowest.min(far);
                    far >= UNFOUND_ANCHOR
                });
                order[number as usize].lowest = lowest;
                if let Some(at) = unfound {
                    open[node][0] = first + at as u32 + 1;
                    above = number;
                    node = arcs[first as usize + at] as usize;
                    number = order.len() as u32;
                    break;
                }
                path.pop();
                let up = order[number as usize].above;
                let reached = &mut order[up as usize].lowest;
                *reached = (*reached).min(lowest);
                *complete &= up == ROOT || lowest < up;
            }
        }
    }

    /// Hands down whether an edge's component holds the root: that of an edge from the root does, and others share the
    /// edge above if what lies below reaches past it.
    fn inherit(&mut self) {
        for number in 1..self.order.len() {
            let Found { above, lowest, .. } = self.order[number];
            self.order[number].carries =
                above == ROOT || (self.order[above as usize].carries && lowest < above);
        }
    }
}
