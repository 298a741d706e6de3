//! Expression: from the genotype to nodes and springs, made whole (the paper §3.2: "a process of growing").
//!
//! Nodes first, springs second: expressed cells put nodes at their corners and named points; then perimeters and
//! fans are stitched through all nodes that lie on them, whoever put them there. Overrides come next, the
//! continuity filter last. Nodes and springs are numbered in the order of node keys, whatever the order of cells.

use crate::address::Place;
use crate::base_mesh::{BaseMesh, Groups};
use crate::cell_type::{Catalogue, Point};
use crate::filters::Method;
use crate::filters::continuity::carrying;
use crate::filters::recursive::{Support, support_springs};
use crate::forest::{CellIndex, Content, Forest, Override};
use crate::node_key::{NodeKey, RESOLUTION};
use rustc_hash::{FxHashMap, FxHashSet};
use thiserror::Error;

/// A cell that stands as a leaf after the switches.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ExpressedCell {
    /// Handle in the forest.
    pub index: CellIndex,
    /// Face, level and square.
    pub place: Place,
    /// Type and turn as expressed: type 1 where a loose anchor needed it.
    pub content: Content,
}

/// A spring of the net.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Spring {
    /// The two nodes, the lower first.
    pub nodes: [u32; 2],
    /// It lies along a free ring or rim.
    pub ring: bool,
}

/// Nodes, springs and who owns them.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Expression {
    /// Key of every node that has a spring, ascending.
    pub nodes: Vec<NodeKey>,
    /// Every spring once, ascending by nodes.
    pub springs: Vec<Spring>,
    /// Expressed cells, ascending by face and child.
    pub cells: Vec<ExpressedCell>,
    /// Node of every anchor, in the order of anchors.
    pub anchors: Vec<u32>,
    /// Springs of every cell; a shared spring belongs to all its cells.
    pub cell_springs: Groups<u32>,
    /// Cells of every spring; none for a spring added by hand.
    pub spring_cells: Groups<u32>,
    /// Nodes on the boundary of every cell, corner c0 first and around; nodes without springs are left out.
    pub cell_boundaries: Groups<u32>,
}

/// Why a genotype gives no net.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum ExpressionError {
    /// The method does not allow the type of an expressed cell.
    #[error("cell {place} has type {word}, but method {method} allows {allowed}")]
    Type {
        /// The cell.
        place: Place,
        /// Its type.
        word: String,
        /// The method.
        method: &'static str,
        /// What it allows.
        allowed: &'static str,
    },
    /// No spring is left.
    #[error("no spring lies on a path between two anchors: the net is empty after filtering")]
    Empty,
    /// An anchor has no springs, even with its cells as plain quads.
    #[error("anchor {0}, counted from 0, is left without springs after filtering")]
    LooseAnchor(usize),
}

/// Grows nodes and springs from a forest.
///
/// `anchors` are different base vertices. Under [`Method::Recursive`] the forest must be closed
/// ([`crate::filters::recursive::close`]).
///
/// # Errors
/// A type that the method does not allow, a net without springs, an anchor that can't be attached.
pub fn express(
    mesh: &BaseMesh,
    forest: &Forest,
    catalogue: &Catalogue,
    method: Method,
    anchors: &[u32],
) -> Result<Expression, ExpressionError> {
    let mut cells = expressed_cells(forest);
    let refused = |cell: &&ExpressedCell| !method.allows(cell.content.kind, catalogue);
    if let Some(cell) = cells.iter().find(refused) {
        return Err(ExpressionError::Type {
            place: cell.place,
            word: catalogue.word(cell.content.kind),
            method: method.name(),
            allowed: method.allowed_words(),
        });
    }
    loop {
        let growth = Growth::grow(mesh, &cells, catalogue, method, forest);
        let (kept, loose) = growth.filter(anchors);
        if loose.is_empty() {
            return Ok(growth.finish(cells, &kept, anchors));
        }
        if !restore_quads(mesh, &mut cells, anchors, &loose) {
            let empty = kept.iter().all(|kept| !kept);
            return Err(if empty { ExpressionError::Empty } else { ExpressionError::LooseAnchor(loose[0]) });
        }
    }
}

/// The cells that stand as leaves after the switches, in order of face and child.
pub fn expressed_cells(forest: &Forest) -> Vec<ExpressedCell> {
    let mut cells = Vec::new();
    forest.visit_expressed(|index, place| {
        cells.push(ExpressedCell { index, place, content: forest.content(index) });
    });
    cells
}

impl Expression {
    /// The number of a node.
    pub fn node(&self, key: NodeKey) -> Option<u32> {
        self.nodes.binary_search(&key).ok().map(|node| node as u32)
    }

    /// Nodes inside a base edge, from its lower vertex.
    pub fn nodes_inside_edge(&self, edge: u32) -> std::ops::Range<u32> {
        let [first, last] = NodeKey::inside_edge(edge);
        let start = self.nodes.partition_point(|&node| node < first);
        let end = self.nodes.partition_point(|&node| node <= last);
        start as u32..end as u32
    }

    /// Cells that have a node on their boundary, ascending.
    pub fn cells_at(&self, node: u32) -> Vec<u32> {
        (0..self.cells.len() as u32).filter(|&cell| self.cell_boundaries.of(cell).contains(&node)).collect()
    }

    /// Every index is in range, everything is ascending, no spring occurs twice.
    pub fn is_valid(&self) -> bool {
        let nodes = self.nodes.len() as u32;
        self.nodes.is_sorted_by(|a, b| a < b)
            && self.springs.is_sorted_by(|a, b| a.nodes < b.nodes)
            && self.springs.iter().all(|spring| spring.nodes[0] < spring.nodes[1] && spring.nodes[1] < nodes)
            && self.anchors.iter().all(|&anchor| anchor < nodes)
            && self.cell_springs.len() == self.cells.len()
            && self.spring_cells.len() == self.springs.len()
    }
}

/// Cells at loose anchors become plain quads; false if all of them were.
fn restore_quads(mesh: &BaseMesh, cells: &mut [ExpressedCell], anchors: &[u32], loose: &[usize]) -> bool {
    let keys: Vec<NodeKey> = loose.iter().map(|&anchor| NodeKey::vertex(anchors[anchor])).collect();
    let mut changed = false;
    for cell in cells.iter_mut().filter(|cell| cell.content != Content::QUAD) {
        let square = Square::of(cell.place);
        if (0..4).any(|corner| keys.contains(&square.key(mesh, Point::Corner(corner)))) {
            cell.content = Content::QUAD;
            changed = true;
        }
    }
    changed
}

/// A cell's square in the units of node keys.
#[derive(Clone, Copy)]
struct Square {
    face: u32,
    i: u32,
    j: u32,
    size: u32,
}

impl Square {
    fn of(place: Place) -> Square {
        let size = 1 << (RESOLUTION - place.level);
        Square { face: place.face, i: place.i * size, j: place.j * size, size }
    }

    fn point(self, point: Point) -> (u32, u32) {
        let (whole, half) = (self.size, self.size / 2);
        let (di, dj) = match point {
            Point::Corner(0) => (0, 0),
            Point::Corner(1) => (whole, 0),
            Point::Corner(2) => (whole, whole),
            Point::Corner(_) => (0, whole),
            Point::Middle(0) => (half, 0),
            Point::Middle(1) => (whole, half),
            Point::Middle(2) => (half, whole),
            Point::Middle(_) => (0, half),
            Point::Centre => (half, half),
        };
        (self.i + di, self.j + dj)
    }

    fn key(self, mesh: &BaseMesh, point: Point) -> NodeKey {
        let (i, j) = self.point(point);
        NodeKey::at(mesh, self.face, i, j)
    }
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct OwnedSpring {
    nodes: [u32; 2],
    cell: u32,
    ring: bool,
}

const BY_HAND: u32 = u32::MAX;

/// Nodes and springs before the continuity filter.
struct Growth<'a> {
    mesh: &'a BaseMesh,
    nodes: Vec<NodeKey>,
    numbers: FxHashMap<NodeKey, u32>,
    owned: Vec<OwnedSpring>,
    /// Different pairs of nodes in `owned`, ascending.
    pairs: Vec<[u32; 2]>,
    boundaries: Vec<(u32, u32)>,
}

impl<'a> Growth<'a> {
    fn grow(
        mesh: &'a BaseMesh,
        cells: &[ExpressedCell],
        catalogue: &Catalogue,
        method: Method,
        forest: &Forest,
    ) -> Self {
        let nodes = put_nodes(mesh, cells, catalogue, method);
        let numbers = nodes.iter().enumerate().map(|(number, &key)| (key, number as u32)).collect();
        let mut growth =
            Growth { mesh, nodes, numbers, owned: Vec::new(), pairs: Vec::new(), boundaries: Vec::new() };
        for (cell, expressed) in cells.iter().enumerate() {
            growth.add_cell(cell as u32, expressed, catalogue, method);
        }
        growth.apply_overrides(forest);
        growth.owned.sort_unstable();
        // A cell may give a spring twice, by its perimeter along a ring and by name: it stays a ring spring.
        growth.owned.dedup_by(|again, first| {
            let same = (again.nodes, again.cell) == (first.nodes, first.cell);
            first.ring |= same && again.ring;
            same
        });
        growth.pairs = growth.owned.iter().map(|spring| spring.nodes).collect();
        growth.pairs.dedup();
        growth
    }

    fn add_cell(&mut self, cell: u32, expressed: &ExpressedCell, catalogue: &Catalogue, method: Method) {
        let square = Square::of(expressed.place);
        let kind = catalogue.get(expressed.content.kind);
        let first = self.boundaries.len();
        let mut hanging = [false; 4];
        for side in 0..4u8 {
            let before = self.boundaries.len();
            let (from, to) = (Point::Corner(side), Point::Corner((side + 1) % 4));
            self.boundaries.push((cell, self.number(square, from)));
            self.walk(cell, square.face, square.point(from), square.point(to));
            hanging[usize::from(side)] = self.boundaries.len() > before + 1;
            if kind.perimeter {
                let ring = self.on_free_edge(expressed.place, side);
                let last = self.number(square, to);
                for at in before..self.boundaries.len() {
                    let next = self.boundaries.get(at + 1).map_or(last, |&(_, node)| node);
                    self.add_spring(self.boundaries[at].1, next, cell, ring);
                }
            }
        }
        if kind.fan {
            let centre = self.number(square, Point::Centre);
            for at in first..self.boundaries.len() {
                self.add_spring(centre, self.boundaries[at].1, cell, false);
            }
        }
        for points in &kind.springs {
            let [a, b] = points.map(|point| self.number(square, point.turned(expressed.content.turn)));
            self.add_spring(a, b, cell, false);
        }
        if method == Method::Recursive {
            for ends in support_springs(hanging) {
                let [a, b] = ends.map(|end| match end {
                    Support::Hanging(side) => self.number(square, Point::Middle(side)),
                    Support::Corner(corner) => self.number(square, Point::Corner(corner)),
                    Support::Centre => self.number(square, Point::Centre),
                });
                self.add_spring(a, b, cell, false);
            }
        }
    }

    fn number(&self, square: Square, point: Point) -> u32 {
        self.numbers[&square.key(self.mesh, point)]
    }

    /// Appends the nodes strictly between two points of a side. Cells tile every side by halving, so no node
    /// lies within a stretch whose middle is no node.
    fn walk(&mut self, cell: u32, face: u32, from: (u32, u32), to: (u32, u32)) {
        let middle = (from.0.midpoint(to.0), from.1.midpoint(to.1));
        if middle == from || middle == to {
            return;
        }
        if let Some(&node) = self.numbers.get(&NodeKey::at(self.mesh, face, middle.0, middle.1)) {
            self.walk(cell, face, from, middle);
            self.boundaries.push((cell, node));
            self.walk(cell, face, middle, to);
        }
    }

    fn on_free_edge(&self, place: Place, side: u8) -> bool {
        let last = (1u32 << place.level) - 1;
        let on_border = match side {
            0 => place.j == 0,
            1 => place.i == last,
            2 => place.j == last,
            _ => place.i == 0,
        };
        on_border && self.mesh.is_free_edge(self.mesh.side_edge(place.face, side).edge)
    }

    fn add_spring(&mut self, a: u32, b: u32, cell: u32, ring: bool) {
        self.owned.push(OwnedSpring { nodes: [a.min(b), a.max(b)], cell, ring });
    }

    fn apply_overrides(&mut self, forest: &Forest) {
        let mut cut = FxHashSet::default();
        for (pair, what) in forest.overrides() {
            let [a, b] = pair.keys().map(|key| self.numbers.get(&key).copied());
            let (Some(a), Some(b)) = (a, b) else { continue };
            match what {
                Override::Added => self.add_spring(a, b, BY_HAND, false),
                Override::Cut => {
                    cut.insert([a.min(b), a.max(b)]);
                }
            }
        }
        if !cut.is_empty() {
            self.owned.retain(|spring| !cut.contains(&spring.nodes));
        }
    }

    /// Which pairs carry force, and which anchors have none that does.
    fn filter(&self, anchors: &[u32]) -> (Vec<bool>, Vec<usize>) {
        let numbers: Vec<Option<u32>> =
            anchors.iter().map(|&vertex| self.numbers.get(&NodeKey::vertex(vertex)).copied()).collect();
        let present: Vec<u32> = numbers.iter().copied().flatten().collect();
        let kept = carrying(self.nodes.len(), &self.pairs, &present);
        let mut attached = vec![false; self.nodes.len()];
        for (pair, _) in self.pairs.iter().zip(&kept).filter(|&(_, &kept)| kept) {
            attached[pair[0] as usize] = true;
            attached[pair[1] as usize] = true;
        }
        let loose = |number: &Option<u32>| number.is_none_or(|number| !attached[number as usize]);
        let loose = (0..anchors.len()).filter(|&anchor| loose(&numbers[anchor])).collect();
        (kept, loose)
    }

    fn finish(self, cells: Vec<ExpressedCell>, kept: &[bool], anchors: &[u32]) -> Expression {
        const DROPPED: u32 = u32::MAX;
        let mut numbers = vec![DROPPED; self.nodes.len()];
        for (pair, _) in self.pairs.iter().zip(kept).filter(|&(_, &kept)| kept) {
            numbers[pair[0] as usize] = 0;
            numbers[pair[1] as usize] = 0;
        }
        let mut nodes = Vec::new();
        for (old, number) in numbers.iter_mut().enumerate().filter(|(_, number)| **number != DROPPED) {
            *number = nodes.len() as u32;
            nodes.push(self.nodes[old]);
        }
        let (mut springs, mut owners) = (Vec::new(), Vec::new());
        let mut pair = 0;
        for owned in &self.owned {
            while self.pairs[pair] != owned.nodes {
                pair += 1;
            }
            if !kept[pair] {
                continue;
            }
            let [a, b] = owned.nodes.map(|node| numbers[node as usize]);
            match springs.last_mut() {
                Some(Spring { nodes, ring }) if *nodes == [a, b] => *ring |= owned.ring,
                _ => springs.push(Spring { nodes: [a, b], ring: owned.ring }),
            }
            if owned.cell != BY_HAND {
                owners.push(((springs.len() - 1) as u32, owned.cell));
            }
        }
        let boundaries = self.boundaries.iter().map(|&(cell, node)| (cell, numbers[node as usize]));
        Expression {
            anchors: anchors
                .iter()
                .map(|&vertex| numbers[self.numbers[&NodeKey::vertex(vertex)] as usize])
                .collect(),
            cell_springs: Groups::collect(cells.len(), owners.iter().map(|&(spring, cell)| (cell, spring))),
            spring_cells: Groups::collect(springs.len(), owners.iter().copied()),
            cell_boundaries: Groups::collect(cells.len(), boundaries.filter(|&(_, node)| node != DROPPED)),
            nodes,
            springs,
            cells,
        }
    }
}

/// Keys of all nodes that cells put, ascending.
fn put_nodes(
    mesh: &BaseMesh,
    cells: &[ExpressedCell],
    catalogue: &Catalogue,
    method: Method,
) -> Vec<NodeKey> {
    let mut keys = FxHashSet::with_capacity_and_hasher(2 * cells.len(), Default::default());
    for cell in cells {
        let square = Square::of(cell.place);
        keys.extend((0..4).map(|corner| square.key(mesh, Point::Corner(corner))));
        let points = catalogue.get(cell.content.kind).points();
        keys.extend(points.map(|point| square.key(mesh, point.turned(cell.content.turn))));
    }
    if method == Method::Recursive {
        let four_hanging =
            |square: &Square| (0..4).all(|side| keys.contains(&square.key(mesh, Point::Middle(side))));
        let centres: Vec<NodeKey> = cells
            .iter()
            .map(|cell| Square::of(cell.place))
            .filter(four_hanging)
            .map(|square| square.key(mesh, Point::Centre))
            .collect();
        keys.extend(centres);
    }
    let mut nodes: Vec<NodeKey> = keys.into_iter().collect();
    nodes.sort_unstable();
    nodes
}
