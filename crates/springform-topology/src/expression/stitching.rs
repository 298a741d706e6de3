//! Stitching: every node and every stretch of a side made once, however many cells share it.
//!
//! The sides of cells are stretches that are halved where a cell puts a node into their middle. Base edges are the
//! first stretches; a divided cell makes four more, from the middles of its sides to its centre. So cells find
//! each other's nodes on a side without looking for keys. Nodes get their numbers, in the order of their keys, last.
//!
//! ```text
//! c3 ── m2 ── c2     a cell's way k runs along its side k from corner k to corner k + 1,
//! │     │t2   │      with the stretch under it or against it;
//! m3 ──t3 x t1 m1    the inner stretch t_k runs from m_k to x
//! │     │t0   │
//! c0 ── m0 ── c1
//! ```

use super::ExpressedCell;
use crate::address::Place;
use crate::base_mesh::BaseMesh;
use crate::cell_type::{Catalogue, Point};
use crate::filters::Method;
use crate::forest::{CellIndex, Content, Forest};
use crate::node_key::{NodeKey, RESOLUTION, UNITS};

/// No node, no spring.
pub(super) const NONE: u32 = u32::MAX;

/// Part of a line between two nodes, whole or halved.
#[derive(Clone, Copy)]
struct Stretch {
    /// Nodes in the order of making.
    ends: [u32; 2],
    /// Node in the middle, or `NONE`.
    middle: u32,
    /// First of two halves, the one at the first end; only if there is a middle.
    halves: u32,
    /// Its spring in the order of gathering; only if it is whole and carries one.
    spring: u32,
    /// A cell asks for a spring along it.
    perimeter: bool,
    /// It lies on a free base edge.
    ring: bool,
    /// It lies inside a face.
    inside: bool,
}

/// A stretch in one of its two directions.
#[derive(Clone, Copy)]
struct Way(u32);

impl Way {
    fn new(stretch: u32, reversed: bool) -> Way {
        Way(stretch << 1 | u32::from(reversed))
    }

    fn stretch(self) -> usize {
        (self.0 >> 1) as usize
    }

    fn reversed(self) -> bool {
        self.0 & 1 == 1
    }

    fn turned(self) -> Way {
        Way(self.0 ^ 1)
    }
}

/// An expressed cell among the nodes and stretches that it shares with others.
#[derive(Clone, Copy)]
struct Seat {
    corners: [u32; 4],
    ways: [Way; 4],
    /// Node in the centre, or `NONE`.
    centre: u32,
    perimeter: bool,
}

/// A reachable cell, divided or not, while the expressed cells under it are seated.
#[derive(Clone, Copy)]
struct Frame {
    cell: CellIndex,
    corners: [u32; 4],
    ways: [Way; 4],
    level: u8,
    /// Corner c0 in units of its face.
    at: (u32, u32),
}

#[derive(Clone, Copy)]
struct FaceNode {
    key: NodeKey,
    /// In the order of making.
    node: u32,
}

/// Nodes and stretches of a net before it is filtered, and the memory to stitch the next one.
#[derive(Clone, Default)]
pub(super) struct Stitching {
    /// Keys of nodes, ascending.
    pub nodes: Vec<NodeKey>,
    stretches: Vec<Stretch>,
    seats: Vec<Seat>,
    /// Number of every node, in the order of making; base vertices are made first.
    numbers: Vec<u32>,
    made: u32,
    /// Nodes inside faces, face by face.
    inside: Vec<FaceNode>,
    /// Centres that are known only when all sides are: of cells with hanging nodes on four sides.
    late: Vec<FaceNode>,
    open: Vec<Frame>,
}

impl Stitching {
    /// Stitches the expressed cells of a forest in order of face and child. Those that `cells` holds already have the
    /// contents that they have there; the others are added to it.
    pub fn stitch(
        &mut self,
        mesh: &BaseMesh,
        forest: &Forest,
        catalogue: &Catalogue,
        method: Method,
        cells: &mut Vec<ExpressedCell>,
    ) {
        self.begin(mesh);
        for face in 0..mesh.faces().len() as u32 {
            self.seat_face(mesh, face, forest, catalogue, cells);
        }
        if method == Method::Recursive {
            self.put_late_centres(cells);
        }
        self.number_nodes(mesh);
    }

    /// Visits whole stretches with a spring: its two nodes and whether it lies along a ring. What the visit
    /// returns is kept as the stretch's spring.
    pub fn visit_springs(&mut self, mut visit: impl FnMut([u32; 2], bool) -> u32) {
        for at in 0..self.stretches.len() {
            let Stretch { ends, middle, halves, perimeter, ring, .. } = self.stretches[at];
            if !perimeter {
                continue;
            }
            if middle == NONE {
                self.stretches[at].spring = visit(ends.map(|node| self.numbers[node as usize]), ring);
            } else {
                // Halves come after the whole.
                self.stretches[halves as usize].perimeter = true;
                self.stretches[halves as usize + 1].perimeter = true;
            }
        }
    }

    /// Number of a point of a cell on which it put a node.
    pub fn number(&self, cell: usize, point: Point) -> u32 {
        let seat = &self.seats[cell];
        let node = match point {
            Point::Corner(k) => seat.corners[usize::from(k)],
            Point::Middle(k) => self.stretches[seat.ways[usize::from(k)].stretch()].middle,
            Point::Centre => seat.centre,
        };
        self.numbers[node as usize]
    }

    /// Appends the nodes on the boundary of a cell, corner c0 first and around; says which sides have nodes
    /// between their ends.
    pub fn append_boundary(&self, cell: usize, nodes: &mut Vec<u32>) -> [bool; 4] {
        let seat = &self.seats[cell];
        let corners = seat.corners.map(|node| self.numbers[node as usize]);
        let divided = seat.ways.map(|way| self.is_divided(way));
        if divided == [false; 4] {
            nodes.extend_from_slice(&corners);
            return divided;
        }
        for side in 0..4 {
            nodes.push(corners[side]);
            if divided[side] {
                self.append_between(seat.ways[side], nodes);
            }
        }
        divided
    }

    /// Visits the springs along the sides of a cell, as [`Stitching::visit_springs`] numbered them, if it asked for
    /// them.
    pub fn visit_own_sides(&self, cell: usize, visit: &mut impl FnMut(u32)) {
        let seat = &self.seats[cell];
        if seat.perimeter {
            for way in seat.ways {
                self.visit_along(way.stretch(), visit);
            }
        }
    }

    /// One of the corners of a cell is this base vertex.
    pub fn has_corner(&self, cell: usize, vertex: u32) -> bool {
        self.seats[cell].corners.contains(&vertex)
    }

    /// Number of a base vertex, which always is a node.
    pub fn vertex(&self, vertex: u32) -> u32 {
        self.numbers[vertex as usize]
    }

    fn begin(&mut self, mesh: &BaseMesh) {
        self.made = mesh.vertex_count();
        self.seats.clear();
        self.inside.clear();
        self.late.clear();
        self.stretches.clear();
        let edges = mesh.edges().iter().zip(mesh.free_edges());
        self.stretches.extend(edges.map(|(&ends, ring)| Stretch { ring, ..Stretch::between(ends, false) }));
    }

    fn seat_face(
        &mut self,
        mesh: &BaseMesh,
        face: u32,
        forest: &Forest,
        catalogue: &Catalogue,
        cells: &mut Vec<ExpressedCell>,
    ) {
        let ways = mesh.side_edges(face).map(|under| Way::new(under.edge, under.reversed));
        let corners = mesh.faces()[face as usize];
        let mut frame = Frame { cell: forest.top(face), corners, ways, level: 0, at: (0, 0) };
        loop {
            match forest.expressed_children(frame.cell) {
                Some(children) => self.divide(face, &frame, children),
                None => {
                    let number = self.seats.len();
                    if number == cells.len() {
                        let content = forest.content(frame.cell);
                        cells.push(ExpressedCell { index: frame.cell, place: frame.place(face), content });
                    }
                    self.seat(face, &frame, cells[number].content, catalogue);
                }
            }
            match self.open.pop() {
                Some(next) => frame = next,
                None => return,
            }
        }
    }

    fn seat(&mut self, face: u32, frame: &Frame, content: Content, catalogue: &Catalogue) {
        let kind = catalogue.get(content.kind);
        let Frame { corners, ways, .. } = *frame;
        if kind.perimeter {
            for way in ways {
                self.stretches[way.stretch()].perimeter = true;
            }
        }
        let mut centre = NONE;
        if kind.fan || !kind.springs.is_empty() {
            for point in kind.points() {
                match point.turned(content.turn) {
                    Point::Middle(side) => {
                        self.halve(face, frame, usize::from(side));
                    }
                    _ if centre == NONE => centre = self.put_centre(face, frame),
                    _ => {}
                }
            }
        }
        self.seats.push(Seat { corners, ways, centre, perimeter: kind.perimeter });
    }

    fn divide(&mut self, face: u32, frame: &Frame, children: [CellIndex; 4]) {
        let [c0, c1, c2, c3] = frame.corners;
        let [m0, m1, m2, m3] = [0, 1, 2, 3].map(|side| self.halve(face, frame, side));
        let x = self.put_centre(face, frame);
        let [t0, t1, t2, t3] = [m0, m1, m2, m3].map(|middle| {
            self.stretches.push(Stretch::between([middle, x], true));
            Way::new(self.stretches.len() as u32 - 1, false)
        });
        let [[a0, b0], [a1, b1], [a2, b2], [a3, b3]] = frame.ways.map(|way| self.halves(way));
        let (level, half) = (frame.level + 1, frame.half());
        let (i, j) = frame.at;
        let frame =
            |child: usize, corners, ways, at| Frame { cell: children[child], corners, ways, level, at };
        self.open.extend([
            frame(3, [m3, x, m2, c3], [t3, t2.turned(), b2, a3], (i, j + half)),
            frame(2, [x, m1, c2, m2], [t1.turned(), b1, a2, t2], (i + half, j + half)),
            frame(1, [m0, c1, m1, x], [b0, a1, t1, t0.turned()], (i + half, j)),
            frame(0, [c0, m0, x, m3], [a0, t0, t3.turned(), b3], (i, j)),
        ]);
    }

    /// The node in the middle of a side, put there if need be.
    fn halve(&mut self, face: u32, frame: &Frame, side: usize) -> u32 {
        let at = frame.ways[side].stretch();
        let Stretch { ends: [first, last], middle, inside, .. } = self.stretches[at];
        if middle != NONE {
            return middle;
        }
        let node = self.make();
        if inside {
            let (half, (i, j)) = (frame.half(), frame.at);
            let (i, j) = match side {
                0 => (i + half, j),
                1 => (i + 2 * half, j + half),
                2 => (i + half, j + 2 * half),
                _ => (i, j + half),
            };
            self.inside.push(FaceNode { key: NodeKey::face(face, i, j), node });
        }
        let ring = self.stretches[at].ring;
        self.stretches[at].middle = node;
        self.stretches[at].halves = self.stretches.len() as u32;
        self.stretches.extend(
            [[first, node], [node, last]].map(|ends| Stretch { ring, ..Stretch::between(ends, inside) }),
        );
        node
    }

    fn put_centre(&mut self, face: u32, frame: &Frame) -> u32 {
        let (half, (i, j)) = (frame.half(), frame.at);
        let node = self.make();
        self.inside.push(FaceNode { key: NodeKey::face(face, i + half, j + half), node });
        node
    }

    fn put_late_centres(&mut self, cells: &[ExpressedCell]) {
        for (cell, expressed) in cells.iter().enumerate() {
            let seat = &self.seats[cell];
            if seat.centre == NONE && seat.ways.iter().all(|&way| self.is_divided(way)) {
                let place = expressed.place;
                let half = UNITS >> (place.level + 1);
                let key = NodeKey::face(place.face, (2 * place.i + 1) * half, (2 * place.j + 1) * half);
                let node = self.make();
                self.seats[cell].centre = node;
                self.late.push(FaceNode { key, node });
            }
        }
    }

    fn make(&mut self) -> u32 {
        self.made += 1;
        self.made - 1
    }

    /// Both halves of a way in its direction.
    fn halves(&self, way: Way) -> [Way; 2] {
        let first = self.stretches[way.stretch()].halves;
        let reversed = way.reversed();
        let near = Way::new(first + u32::from(reversed), reversed);
        let far = Way::new(first + u32::from(!reversed), reversed);
        [near, far]
    }

    /// Appends the nodes between the ends of a way that is divided.
    fn append_between(&self, way: Way, nodes: &mut Vec<u32>) {
        let [near, far] = self.halves(way);
        if self.is_divided(near) {
            self.append_between(near, nodes);
        }
        nodes.push(self.numbers[self.stretches[way.stretch()].middle as usize]);
        if self.is_divided(far) {
            self.append_between(far, nodes);
        }
    }

    fn is_divided(&self, way: Way) -> bool {
        self.stretches[way.stretch()].middle != NONE
    }

    fn visit_along(&self, stretch: usize, visit: &mut impl FnMut(u32)) {
        let Stretch { middle, halves, spring, .. } = self.stretches[stretch];
        if middle == NONE {
            visit(spring);
        } else {
            self.visit_along(halves as usize, visit);
            self.visit_along(halves as usize + 1, visit);
        }
    }

    fn number_nodes(&mut self, mesh: &BaseMesh) {
        self.numbers.clear();
        self.numbers.extend(0..mesh.vertex_count());
        self.numbers.resize(self.made as usize, NONE);
        self.nodes.clear();
        self.nodes.extend((0..mesh.vertex_count()).map(NodeKey::vertex));
        for edge in 0..mesh.edges().len() {
            if self.stretches[edge].middle != NONE {
                self.number_along(edge as u32, edge, 0, UNITS);
            }
        }
        let same_face = |a: &FaceNode, b: &FaceNode| a.key.face_bits() == b.key.face_bits();
        for nodes in self.inside.chunk_by_mut(same_face).chain([self.late.as_mut_slice()]) {
            nodes.sort_unstable_by_key(|node| node.key);
        }
        let mut number = |node: &FaceNode| {
            self.numbers[node.node as usize] = self.nodes.len() as u32;
            self.nodes.push(node.key);
        };
        let mut late = self.late.iter().peekable();
        for node in &self.inside {
            while let Some(earlier) = late.next_if(|late| late.key < node.key) {
                number(earlier);
            }
            number(node);
        }
        late.for_each(number);
    }

    fn number_along(&mut self, edge: u32, stretch: usize, from: u32, to: u32) {
        let Stretch { middle, halves, .. } = self.stretches[stretch];
        if middle != NONE {
            let parameter = from.midpoint(to);
            self.number_along(edge, halves as usize, from, parameter);
            self.numbers[middle as usize] = self.nodes.len() as u32;
            self.nodes.push(NodeKey::edge(edge, parameter));
            self.number_along(edge, halves as usize + 1, parameter, to);
        }
    }
}

impl Stretch {
    fn between(ends: [u32; 2], inside: bool) -> Stretch {
        Stretch { ends, middle: NONE, halves: NONE, spring: NONE, perimeter: false, ring: false, inside }
    }
}

impl Frame {
    fn place(&self, face: u32) -> Place {
        let shift = RESOLUTION - self.level;
        Place { face, level: self.level, i: self.at.0 >> shift, j: self.at.1 >> shift }
    }

    /// Half of its side in units of node keys.
    fn half(&self) -> u32 {
        1 << (RESOLUTION - self.level - 1)
    }
}
