//! The forest: one quadtree of cells per base quad, the genotype (the paper's cell identifier notation, §3.2, Fig. 10).
//!
//! A cell has a type, a turn and, where it was ever subdivided, four stored children and a switch. While the
//! switch is on, the children stand for the cell; while it is off, the cell stands for itself and the subtree is
//! kept for later (§3.4). A forest holds no geometry.
//!
//! ```text
//! cells: [ top 0 | top 1 | … | 4 children | 4 children | … ]   blocks of four, a free list of blocks
//! ```

use crate::address::Place;
use crate::cell_type::{CellTypeId, QUAD};
use crate::gene::Reference;
use crate::node_key::NodeKey;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Handle of a cell, valid until the cell is removed.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct CellIndex(pub u32);

/// Type and turn: what a cell holds when it stands for itself.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Content {
    /// Cell type.
    pub kind: CellTypeId,
    /// Quarter turns of the contents, 0–3.
    pub turn: u8,
}

impl Content {
    /// The plain quad.
    pub const QUAD: Content = Content { kind: QUAD, turn: 0 };
}

/// What a designer's hand does to the spring between two nodes.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Override {
    /// A spring that no cell gives.
    Added,
    /// A spring taken away.
    Cut,
}

/// Two different nodes, the lower key first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct NodePair {
    lower: NodeKey,
    higher: NodeKey,
}

impl NodePair {
    /// The pair of two keys; `None` if they are the same.
    pub fn new(a: NodeKey, b: NodeKey) -> Option<NodePair> {
        (a != b).then(|| NodePair { lower: a.min(b), higher: a.max(b) })
    }

    /// Both keys, the lower first.
    pub fn keys(self) -> [NodeKey; 2] {
        [self.lower, self.higher]
    }
}

const NONE: u32 = u32::MAX;

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Cell {
    content: Content,
    on: bool,
    /// First of four children, or `NONE`.
    children: u32,
}

/// A forest of quadtrees with the designer's overrides.
#[derive(Debug)]
pub struct Forest {
    top: u32,
    cells: Vec<Cell>,
    free_blocks: Vec<u32>,
    /// Shared by copies until one of them changes it.
    overrides: Arc<BTreeMap<NodePair, Override>>,
    references: BTreeMap<u32, Reference>,
}

impl Clone for Forest {
    fn clone(&self) -> Forest {
        Forest {
            top: self.top,
            cells: self.cells.clone(),
            free_blocks: self.free_blocks.clone(),
            overrides: Arc::clone(&self.overrides),
            references: self.references.clone(),
        }
    }

    /// Copies into the memory of a forest that is no longer needed.
    fn clone_from(&mut self, source: &Forest) {
        self.top = source.top;
        self.cells.clone_from(&source.cells);
        self.free_blocks.clone_from(&source.free_blocks);
        self.references.clone_from(&source.references);
        // Copies of one forest stay out of each other's way in the count of its owners.
        if !Arc::ptr_eq(&self.overrides, &source.overrides) {
            self.overrides = Arc::clone(&source.overrides);
        }
    }
}

impl Forest {
    /// A forest of undivided cells.
    pub fn new(faces: u32, content: Content) -> Forest {
        let cell = Cell { content, on: true, children: NONE };
        Forest {
            top: faces,
            cells: vec![cell; faces as usize],
            free_blocks: Vec::new(),
            overrides: Arc::default(),
            references: BTreeMap::new(),
        }
    }

    /// Number of top-level cells.
    pub fn top_level(&self) -> u32 {
        self.top
    }

    /// Number of cells stored, expressed or not.
    pub fn stored(&self) -> usize {
        self.cells.len() - 4 * self.free_blocks.len()
    }

    /// Type and turn of a cell.
    pub fn content(&self, cell: CellIndex) -> Content {
        self.cells[cell.0 as usize].content
    }

    /// The stored children of a cell, whether or not they are switched on.
    pub fn children(&self, cell: CellIndex) -> Option<[CellIndex; 4]> {
        let first = self.cells[cell.0 as usize].children;
        (first != NONE).then(|| std::array::from_fn(|k| CellIndex(first + k as u32)))
    }

    /// The switch of a cell that owns children; on for others.
    pub fn is_on(&self, cell: CellIndex) -> bool {
        self.cells[cell.0 as usize].on
    }

    /// The children that stand for a cell: stored and switched on.
    pub fn expressed_children(&self, cell: CellIndex) -> Option<[CellIndex; 4]> {
        if self.is_on(cell) { self.children(cell) } else { None }
    }

    /// The top-level cell of a face.
    pub fn top(&self, face: u32) -> CellIndex {
        CellIndex(face)
    }

    /// The cell at a place, expressed or not.
    pub fn find(&self, place: Place) -> Option<CellIndex> {
        if place.face >= self.top {
            return None;
        }
        place.path().try_fold(CellIndex(place.face), |cell, child| {
            self.children(cell).map(|children| children[usize::from(child)])
        })
    }

    /// The expressed cell that covers a place, if it is not finer than the place.
    pub fn expressed_over(&self, place: Place) -> Option<(CellIndex, u8)> {
        let mut cell = CellIndex(place.face);
        for level in 0..=place.level {
            let Some(children) = self.expressed_children(cell) else { return Some((cell, level)) };
            if level < place.level {
                cell = children[usize::from(place.child_at(level + 1))];
            }
        }
        None
    }

    /// Visits every reachable cell, parents before children, in order of face and child.
    pub fn visit_reachable(&self, mut visit: impl FnMut(CellIndex, Place)) {
        for face in 0..self.top {
            self.visit_under(CellIndex(face), Place::top(face), &mut visit);
        }
    }

    fn visit_under(&self, cell: CellIndex, place: Place, visit: &mut impl FnMut(CellIndex, Place)) {
        visit(cell, place);
        if let Some(children) = self.expressed_children(cell) {
            for (k, child) in children.into_iter().enumerate() {
                self.visit_under(child, place.child(k as u8), visit);
            }
        }
    }

    /// Visits every expressed cell in order of face and child.
    pub fn visit_expressed(&self, mut visit: impl FnMut(CellIndex, Place)) {
        for face in 0..self.top {
            self.visit_expressed_under(CellIndex(face), Place::top(face), &mut visit);
        }
    }

    /// Visits the expressed cells under a reachable cell, or the cell itself, in the same order.
    pub(crate) fn visit_expressed_under(
        &self,
        cell: CellIndex,
        place: Place,
        visit: &mut impl FnMut(CellIndex, Place),
    ) {
        match self.expressed_children(cell) {
            None => visit(cell, place),
            Some(children) => {
                for (k, child) in children.into_iter().enumerate() {
                    self.visit_expressed_under(child, place.child(k as u8), visit);
                }
            }
        }
    }

    /// A number that equal forests share and different ones hardly do (FNV-1a over the cells in order).
    pub fn fingerprint(&self) -> u64 {
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        let mut absorb = |byte: u8| hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        for face in 0..self.top {
            self.absorb_under(CellIndex(face), &mut absorb);
        }
        for (pair, what) in self.overrides() {
            for byte in pair.keys().into_iter().flat_map(|key| key.to_bits().to_le_bytes()) {
                absorb(byte);
            }
            absorb(*what as u8);
        }
        for (face, Reference { gene, orientation }) in &self.references {
            face.to_le_bytes().into_iter().chain(gene.0.to_le_bytes()).for_each(&mut absorb);
            absorb(orientation.turn | u8::from(orientation.mirrored) << 2);
        }
        hash
    }

    fn absorb_under(&self, cell: CellIndex, absorb: &mut impl FnMut(u8)) {
        let Content { kind, turn } = self.content(cell);
        let children = self.children(cell);
        absorb(kind.0);
        absorb(turn | u8::from(self.is_on(cell)) << 2 | u8::from(children.is_some()) << 3);
        for child in children.into_iter().flatten() {
            self.absorb_under(child, absorb);
        }
    }

    /// The designer's overrides, in order of node keys.
    pub fn overrides(&self) -> &BTreeMap<NodePair, Override> {
        &self.overrides
    }

    /// Genes held by reference, by the top-level cell of their seed.
    pub fn references(&self) -> &BTreeMap<u32, Reference> {
        &self.references
    }

    pub(crate) fn set_reference(&mut self, seed: u32, value: Option<Reference>) {
        match value {
            Some(value) => self.references.insert(seed, value),
            None => self.references.remove(&seed),
        };
    }

    pub(crate) fn set_override(&mut self, pair: NodePair, value: Option<Override>) {
        let overrides = Arc::make_mut(&mut self.overrides);
        match value {
            Some(value) => overrides.insert(pair, value),
            None => overrides.remove(&pair),
        };
    }

    pub(crate) fn set_content(&mut self, cell: CellIndex, content: Content) {
        self.cells[cell.0 as usize].content = content;
    }

    pub(crate) fn set_on(&mut self, cell: CellIndex, on: bool) {
        self.cells[cell.0 as usize].on = on;
    }

    pub(crate) fn add_children(&mut self, cell: CellIndex, contents: [Content; 4]) -> [CellIndex; 4] {
        let first = self.free_blocks.pop().unwrap_or_else(|| {
            let first = self.cells.len() as u32;
            let blank = Cell { content: Content::QUAD, on: true, children: NONE };
            self.cells.extend([blank; 4]);
            first
        });
        for (k, content) in contents.into_iter().enumerate() {
            self.cells[first as usize + k] = Cell { content, on: true, children: NONE };
        }
        let parent = &mut self.cells[cell.0 as usize];
        parent.children = first;
        parent.on = true;
        std::array::from_fn(|k| CellIndex(first + k as u32))
    }

    pub(crate) fn remove_children(&mut self, cell: CellIndex) {
        let parent = &mut self.cells[cell.0 as usize];
        self.free_blocks.push(parent.children);
        parent.children = NONE;
        parent.on = true;
    }
}

/// Forests are equal when they hold the same cells at the same addresses, the same overrides and genes.
impl PartialEq for Forest {
    fn eq(&self, other: &Self) -> bool {
        fn same(a: &Forest, left: CellIndex, b: &Forest, right: CellIndex) -> bool {
            a.content(left) == b.content(right)
                && a.is_on(left) == b.is_on(right)
                && match (a.children(left), b.children(right)) {
                    (None, None) => true,
                    (Some(left), Some(right)) => {
                        left.into_iter().zip(right).all(|(left, right)| same(a, left, b, right))
                    }
                    _ => false,
                }
        }
        self.top == other.top
            && self.overrides == other.overrides
            && self.references == other.references
            && (0..self.top).all(|face| same(self, CellIndex(face), other, CellIndex(face)))
    }
}

impl Eq for Forest {}
