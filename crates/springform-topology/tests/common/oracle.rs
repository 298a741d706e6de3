//! Slow, independent answers: levels along edges, the net of a forest, and which springs carry force.
//!
//! Nothing here uses the crate's own node keys, sides, stitching or search; places are named by geometry on
//! whole numbers, base edges by their two vertices.

use super::{Design, leaves};
use springform_topology::address::Place;
use springform_topology::base_mesh::BaseMesh;
use springform_topology::cell_type::Point;
use springform_topology::expression::Expression;
use springform_topology::filters::Method;
use springform_topology::forest::{Content, Forest, Override};
use springform_topology::node_key::{NodeKey, NodePlace, UNITS};
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// A point of the base mesh.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Spot {
    Vertex(u32),
    /// Lower vertex, higher vertex, units from the lower.
    Edge(u32, u32, u32),
    /// Face, column, row.
    Face(u32, u32, u32),
}

/// A straight line on the base mesh.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Line {
    /// A base edge by its vertices.
    Edge(u32, u32),
    /// Face and column: points differ in row.
    Column(u32, u32),
    /// Face and row: points differ in column.
    Row(u32, u32),
}

/// One side of a cell: part of a line, from lower to higher units.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Stretch {
    pub line: Line,
    pub from: u32,
    pub to: u32,
}

/// Corners c0–c3 of the unit square.
const CORNERS: [(u32, u32); 4] = [(0, 0), (1, 0), (1, 1), (0, 1)];

/// The spot of a point of a face.
pub fn spot(mesh: &BaseMesh, face: u32, i: u32, j: u32) -> Spot {
    let corners = mesh.faces()[face as usize];
    let at_corner = (0..4).find(|&k| (i, j) == (CORNERS[k].0 * UNITS, CORNERS[k].1 * UNITS));
    if let Some(k) = at_corner {
        return Spot::Vertex(corners[k]);
    }
    let on_edge = |from: usize, to: usize, along: u32| {
        let (from, to) = (corners[from], corners[to]);
        if from < to { Spot::Edge(from, to, along) } else { Spot::Edge(to, from, UNITS - along) }
    };
    match (i, j) {
        (_, 0) => on_edge(0, 1, i),
        (_, UNITS) => on_edge(3, 2, i),
        (0, _) => on_edge(0, 3, j),
        (UNITS, _) => on_edge(1, 2, j),
        _ => Spot::Face(face, i, j),
    }
}

/// The spot of a node key.
pub fn spot_of(mesh: &BaseMesh, key: NodeKey) -> Spot {
    match key.place() {
        NodePlace::Vertex(vertex) => Spot::Vertex(vertex),
        NodePlace::Edge { edge, parameter } => {
            let [lower, higher] = mesh.edges()[edge as usize];
            Spot::Edge(lower, higher, parameter)
        }
        NodePlace::Face { face, i, j } => Spot::Face(face, i, j),
    }
}

fn square(place: Place) -> (u32, u32, u32) {
    let size = UNITS >> place.level;
    (place.i * size, place.j * size, size)
}

/// The spot of a point of a cell, `right` and `up` in half cells from corner c0.
fn spot_in(mesh: &BaseMesh, place: Place, (right, up): (u32, u32)) -> Spot {
    let (i, j, size) = square(place);
    spot(mesh, place.face, i + right * size / 2, j + up * size / 2)
}

fn corner(mesh: &BaseMesh, place: Place, k: usize) -> Spot {
    spot_in(mesh, place, (2 * CORNERS[k % 4].0, 2 * CORNERS[k % 4].1))
}

fn named(mesh: &BaseMesh, place: Place, point: Point, turn: u8) -> Spot {
    match point {
        Point::Corner(k) => corner(mesh, place, usize::from(k + turn)),
        Point::Middle(k) => spot_in(mesh, place, [(1, 0), (2, 1), (1, 2), (0, 1)][usize::from(k + turn) % 4]),
        Point::Centre => spot_in(mesh, place, (1, 1)),
    }
}

/// Side `k` of a cell.
pub fn side(mesh: &BaseMesh, place: Place, k: usize) -> Stretch {
    let (i, j, size) = square(place);
    let (line, from) = match k {
        0 => (Line::Row(place.face, j), i),
        1 => (Line::Column(place.face, i + size), j),
        2 => (Line::Row(place.face, j + size), i),
        _ => (Line::Column(place.face, i), j),
    };
    let on_border = matches!(line, Line::Row(_, 0 | UNITS) | Line::Column(_, 0 | UNITS));
    if !on_border {
        return Stretch { line, from, to: from + size };
    }
    // Sides 0 and 2 run from the left, 1 and 3 from below.
    let corners = mesh.faces()[place.face as usize];
    let (first, last) = [(0, 1), (1, 2), (3, 2), (0, 3)].map(|(a, b)| (corners[a], corners[b]))[k];
    let line = Line::Edge(first.min(last), first.max(last));
    let from = if first < last { from } else { UNITS - from - size };
    Stretch { line, from, to: from + size }
}

/// Pairs of expressed cells that share an edge, or part of one.
pub fn neighbours(mesh: &BaseMesh, forest: &Forest) -> BTreeSet<[Place; 2]> {
    let mut lines: BTreeMap<Line, Vec<(Stretch, Place)>> = BTreeMap::new();
    for (_, place) in leaves(forest) {
        for k in 0..4 {
            let stretch = side(mesh, place, k);
            lines.entry(stretch.line).or_default().push((stretch, place));
        }
    }
    let mut pairs = BTreeSet::new();
    for sides in lines.values() {
        for (at, (a, here)) in sides.iter().enumerate() {
            for (b, there) in &sides[..at] {
                if a.from.max(b.from) < a.to.min(b.to) && here != there {
                    pairs.insert([*here.min(there), *here.max(there)]);
                }
            }
        }
    }
    pairs
}

/// Levels of expressed cells that share an edge differ by one at most.
pub fn is_balanced(mesh: &BaseMesh, forest: &Forest) -> bool {
    neighbours(mesh, forest).iter().all(|[a, b]| a.level.abs_diff(b.level) <= 1)
}

/// A spring of the slow net.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct SlowSpring {
    /// Numbers of expressed cells.
    pub cells: BTreeSet<usize>,
    pub ring: bool,
}

/// A net by the words of the design, springs by their two spots.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct SlowNet {
    pub springs: BTreeMap<[Spot; 2], SlowSpring>,
    pub contents: Vec<Content>,
    /// Boundary nodes of every cell, from corner c0 around; only such as have springs.
    pub boundaries: Vec<Vec<Spot>>,
}

impl SlowNet {
    /// The net of an expression, in the same terms.
    pub fn from_expression(mesh: &BaseMesh, expression: &Expression) -> SlowNet {
        let spots: Vec<Spot> = expression.nodes.iter().map(|&key| spot_of(mesh, key)).collect();
        let springs = expression.springs.iter().enumerate().map(|(number, spring)| {
            let owners = expression.spring_cells.of(number as u32);
            let cells = owners.iter().map(|&cell| cell as usize).collect();
            (pair(spring.nodes.map(|node| spots[node as usize])), SlowSpring { cells, ring: spring.ring })
        });
        let boundary =
            |cell| expression.cell_boundaries.of(cell).iter().map(|&node| spots[node as usize]).collect();
        SlowNet {
            springs: springs.collect(),
            contents: expression.cells.iter().map(|cell| cell.content).collect(),
            boundaries: (0..expression.cells.len() as u32).map(boundary).collect(),
        }
    }

    /// Spots with springs.
    pub fn spots(&self) -> BTreeSet<Spot> {
        self.springs.keys().flatten().copied().collect()
    }
}

fn pair([a, b]: [Spot; 2]) -> [Spot; 2] {
    [a.min(b), a.max(b)]
}

/// The net of a design; `None` if an anchor stays loose.
pub fn slow_net(design: &Design) -> Option<SlowNet> {
    let cells = leaves(&design.forest);
    let mut contents: Vec<Content> = cells.iter().map(|&(cell, _)| design.forest.content(cell)).collect();
    let places: Vec<Place> = cells.into_iter().map(|(_, place)| place).collect();
    let anchors: Vec<Spot> = design.anchors.iter().map(|&vertex| Spot::Vertex(vertex)).collect();
    loop {
        let mut net = Drawing::new(design, &places, &contents).net;
        keep_carrying(&mut net.springs, &anchors);
        let spots = net.spots();
        for boundary in &mut net.boundaries {
            boundary.retain(|spot| spots.contains(spot));
        }
        let loose: Vec<Spot> = anchors.iter().copied().filter(|anchor| !spots.contains(anchor)).collect();
        if loose.is_empty() {
            net.contents = contents;
            return Some(net);
        }
        let mut changed = false;
        for (content, &place) in contents.iter_mut().zip(&places) {
            let at_loose = (0..4).any(|k| loose.contains(&corner(&design.mesh, place, k)));
            if at_loose && *content != Content::QUAD {
                *content = Content::QUAD;
                changed = true;
            }
        }
        if !changed {
            return None;
        }
    }
}

/// A net while it is drawn cell by cell.
struct Drawing<'a> {
    design: &'a Design,
    nodes: BTreeSet<Spot>,
    net: SlowNet,
}

impl Drawing<'_> {
    fn new<'a>(design: &'a Design, places: &[Place], contents: &[Content]) -> Drawing<'a> {
        let mut drawing = Drawing { design, nodes: BTreeSet::new(), net: SlowNet::default() };
        for (&place, &content) in places.iter().zip(contents) {
            drawing.put_nodes(place, content);
        }
        if design.method == Method::Recursive {
            drawing.put_support_centres(places);
        }
        for (number, (&place, &content)) in places.iter().zip(contents).enumerate() {
            drawing.draw_cell(number, place, content);
        }
        drawing.apply_overrides();
        drawing
    }

    fn put_nodes(&mut self, place: Place, content: Content) {
        let mesh = &self.design.mesh;
        let kind = self.design.catalogue.get(content.kind);
        self.nodes.extend((0..4).map(|k| corner(mesh, place, k)));
        self.nodes
            .extend(kind.springs.iter().flatten().map(|&point| named(mesh, place, point, content.turn)));
        if kind.fan {
            self.nodes.insert(named(mesh, place, Point::Centre, 0));
        }
    }

    fn put_support_centres(&mut self, places: &[Place]) {
        for &place in places {
            if (0..4).all(|k| !self.within(side(&self.design.mesh, place, k)).is_empty()) {
                self.nodes.insert(named(&self.design.mesh, place, Point::Centre, 0));
            }
        }
    }

    /// Nodes strictly within a stretch, in order of units.
    fn within(&self, stretch: Stretch) -> Vec<Spot> {
        let on_line = |spot: &Spot| {
            let at = match (stretch.line, *spot) {
                (Line::Edge(a, b), Spot::Edge(lower, higher, at)) if (a, b) == (lower, higher) => at,
                (Line::Column(face, i), Spot::Face(f, column, at)) if (face, i) == (f, column) => at,
                (Line::Row(face, j), Spot::Face(f, at, row)) if (face, j) == (f, row) => at,
                _ => return None,
            };
            (stretch.from < at && at < stretch.to).then_some((at, *spot))
        };
        let found: BTreeMap<u32, Spot> = self.candidates(stretch.line).filter_map(on_line).collect();
        found.into_values().collect()
    }

    /// The nodes among which all nodes of a line are.
    fn candidates(&self, line: Line) -> impl Iterator<Item = &Spot> {
        match line {
            Line::Edge(a, b) => self.nodes.range(Spot::Edge(a, b, 0)..=Spot::Edge(a, b, UNITS)),
            Line::Column(face, i) => self.nodes.range(Spot::Face(face, i, 0)..=Spot::Face(face, i, UNITS)),
            Line::Row(face, _) => self.nodes.range(Spot::Face(face, 0, 0)..=Spot::Face(face, UNITS, UNITS)),
        }
    }

    /// Nodes on side `k` of a cell, from corner k to corner k + 1.
    fn along(&self, place: Place, k: usize) -> Vec<Spot> {
        let mesh = &self.design.mesh;
        let stretch = side(mesh, place, k);
        let mut inner = self.within(stretch);
        let backward = match stretch.line {
            Line::Edge(lower, _) => mesh.faces()[place.face as usize][k] != lower,
            Line::Column(..) | Line::Row(..) => k >= 2,
        };
        if backward {
            inner.reverse();
        }
        [vec![corner(mesh, place, k)], inner, vec![corner(mesh, place, k + 1)]].concat()
    }

    fn draw_cell(&mut self, number: usize, place: Place, content: Content) {
        let mesh = &self.design.mesh;
        let kind = self.design.catalogue.get(content.kind);
        let sides: [Vec<Spot>; 4] = std::array::from_fn(|k| self.along(place, k));
        let around: Vec<Spot> = sides.iter().flat_map(|side| side[..side.len() - 1].to_vec()).collect();
        let mut springs = Vec::new();
        for (k, side_nodes) in sides.iter().enumerate().filter(|_| kind.perimeter) {
            let ring = self.is_free(side(mesh, place, k).line);
            springs.extend(side_nodes.windows(2).map(|ends| ([ends[0], ends[1]], ring)));
        }
        let centre = named(mesh, place, Point::Centre, 0);
        if kind.fan {
            springs.extend(around.iter().map(|&node| ([centre, node], false)));
        }
        for ends in &kind.springs {
            springs.push((ends.map(|point| named(mesh, place, point, content.turn)), false));
        }
        if self.design.method == Method::Recursive {
            let hanging = std::array::from_fn(|k| sides[k].len() > 2);
            let supports = supports(hanging).into_iter();
            springs.extend(supports.map(|ends| (ends.map(|point| named(mesh, place, point, 0)), false)));
        }
        for (ends, ring) in springs {
            let spring = self.net.springs.entry(pair(ends)).or_default();
            spring.cells.insert(number);
            spring.ring |= ring;
        }
        self.net.boundaries.push(around);
    }

    /// Only one side of one face lies on the line.
    fn is_free(&self, line: Line) -> bool {
        let Line::Edge(lower, higher) = line else { return false };
        let lies_on = |face: &[u32; 4], k: usize| {
            let (a, b) = (face[k], face[(k + 1) % 4]);
            (a.min(b), a.max(b)) == (lower, higher)
        };
        let faces = self.design.mesh.faces().iter();
        faces.map(|face| (0..4).filter(|&k| lies_on(face, k)).count()).sum::<usize>() == 1
    }

    fn apply_overrides(&mut self) {
        for (keys, what) in self.design.forest.overrides() {
            let ends = pair(keys.keys().map(|key| spot_of(&self.design.mesh, key)));
            match what {
                Override::Cut => drop(self.net.springs.remove(&ends)),
                Override::Added if ends.iter().all(|end| self.nodes.contains(end)) => {
                    self.net.springs.entry(ends).or_default();
                }
                Override::Added => {}
            }
        }
    }
}

/// Support springs at hanging nodes, by the words of the design, one pattern after the other.
pub fn supports(hanging: [bool; 4]) -> Vec<[Point; 2]> {
    use Point::{Centre, Corner, Middle};
    let pattern: String = hanging.iter().map(|&hangs| if hangs { '1' } else { '0' }).collect();
    let fan = |middle: u8, corners: [u8; 2]| corners.map(|corner| [Middle(middle), Corner(corner)]).to_vec();
    let tied = |a: u8, b: u8, corner: u8| {
        vec![[Middle(a), Middle(b)], [Middle(a), Corner(corner)], [Middle(b), Corner(corner)]]
    };
    let triangle = |a: u8, b: u8, third: u8| {
        vec![[Middle(a), Middle(b)], [Middle(third), Middle(a)], [Middle(third), Middle(b)]]
    };
    match pattern.as_str() {
        // One: to the two corners of the opposite edge.
        "1000" => fan(0, [2, 3]),
        "0100" => fan(1, [3, 0]),
        "0010" => fan(2, [0, 1]),
        "0001" => fan(3, [1, 2]),
        // Two opposite: joined.
        "1010" => vec![[Middle(0), Middle(2)]],
        "0101" => vec![[Middle(1), Middle(3)]],
        // Two adjacent: joined, and each to the corner that neither touches.
        "1100" => tied(0, 1, 3),
        "0110" => tied(1, 2, 0),
        "0011" => tied(2, 3, 1),
        "1001" => tied(3, 0, 2),
        // Three: the opposite pair joined, the third to both.
        "1110" => triangle(0, 2, 1),
        "0111" => triangle(1, 3, 2),
        "1011" => triangle(2, 0, 3),
        "1101" => triangle(3, 1, 0),
        // Four: all to the centre.
        "1111" => (0..4).map(|side| [Middle(side), Centre]).collect(),
        _ => Vec::new(),
    }
}

fn keep_carrying(springs: &mut BTreeMap<[Spot; 2], SlowSpring>, anchors: &[Spot]) {
    let spots: Vec<Spot> = springs.keys().flatten().copied().collect::<BTreeSet<_>>().into_iter().collect();
    let number = |spot: &Spot| spots.binary_search(spot).ok().map(|at| at as u32);
    let ends: Vec<[u32; 2]> =
        springs.keys().map(|ends| ends.map(|end| number(&end).expect("ends are spots"))).collect();
    let anchors: Vec<u32> = anchors.iter().filter_map(number).collect();
    let flow = Flow::new(spots.len(), &ends, &anchors);
    let mut carrying = ends.iter().map(|&ends| flow.carries(ends));
    springs.retain(|_, _| carrying.next().expect("one answer a spring"));
}

/// Two node-disjoint paths from the ends of a spring to two different anchors: a flow of two with nodes of
/// capacity one.
pub struct Flow {
    neighbours: Vec<Vec<u32>>,
    is_anchor: Vec<bool>,
}

/// Which half of a node a unit of flow has reached.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Half {
    In,
    Out,
}

impl Flow {
    pub fn new(nodes: usize, springs: &[[u32; 2]], anchors: &[u32]) -> Flow {
        let mut neighbours = vec![Vec::new(); nodes];
        for &[a, b] in springs {
            neighbours[a as usize].push(b);
            neighbours[b as usize].push(a);
        }
        let is_anchor = (0..nodes as u32).map(|node| anchors.contains(&node)).collect();
        Flow { neighbours, is_anchor }
    }

    pub fn carries(&self, [a, b]: [u32; 2]) -> bool {
        // The second unit starts at the other end and may push the first one aside.
        self.path(a).is_some_and(|first| self.has_second_path(b, &first))
    }

    /// Any path from a node to an anchor.
    fn path(&self, start: u32) -> Option<Vec<u32>> {
        let mut came = vec![u32::MAX; self.neighbours.len()];
        came[start as usize] = start;
        let mut open = VecDeque::from([start]);
        while let Some(node) = open.pop_front() {
            if self.is_anchor[node as usize] {
                let mut path = vec![node];
                while path[path.len() - 1] != start {
                    path.push(came[path[path.len() - 1] as usize]);
                }
                path.reverse();
                return Some(path);
            }
            for &far in &self.neighbours[node as usize] {
                if came[far as usize] == u32::MAX {
                    came[far as usize] = node;
                    open.push_back(far);
                }
            }
        }
        None
    }

    /// A unit of flow from `start` to an anchor that is free, against the flow along `taken`.
    fn has_second_path(&self, start: u32, taken: &[u32]) -> bool {
        let nodes = self.neighbours.len();
        let mut next = vec![u32::MAX; nodes];
        let mut previous = vec![u32::MAX; nodes];
        for ends in taken.windows(2) {
            next[ends[0] as usize] = ends[1];
            previous[ends[1] as usize] = ends[0];
        }
        let used = |node: u32| taken.contains(&node);
        let mut seen = vec![[false; 2]; nodes];
        let mut open = VecDeque::from([(start, Half::In)]);
        seen[start as usize][Half::In as usize] = true;
        let last = taken[taken.len() - 1];
        while let Some((node, half)) = open.pop_front() {
            let at = node as usize;
            let mut reach = |node: u32, half: Half| {
                if !seen[node as usize][half as usize] {
                    seen[node as usize][half as usize] = true;
                    open.push_back((node, half));
                }
            };
            match half {
                // Into a free node, and through it; a used one only lets flow turn back where it came from.
                Half::In if !used(node) => reach(node, Half::Out),
                Half::In if previous[at] != u32::MAX => reach(previous[at], Half::Out),
                Half::In => {}
                Half::Out => {
                    if self.is_anchor[at] && node != last {
                        return true;
                    }
                    for &far in self.neighbours[at].iter().filter(|&&far| far != next[at]) {
                        reach(far, Half::In);
                    }
                    // Against the flow through a used node.
                    if used(node) {
                        reach(node, Half::In);
                    }
                }
            }
        }
        false
    }
}
