//! Selections: regions of cells as values, across levels and across parts.
//!
//! A selection is a set of squares of the base mesh, whether or not a forest divides them so. It is kept in one way:
//! no square lies within another, and four that fill a square are that square. So two selections are equal if
//! they cover the same, and can be united, subtracted, grown and shrunk without a forest.

use crate::address::Place;
use crate::base_mesh::{BaseMesh, MapPlace};
use crate::forest::Forest;
use crate::node_key::{NodeKey, NodePlace, UNITS};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// A region of cells.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default)]
pub struct Selection(BTreeSet<Place>);

/// Where a top-level cell lies among those of its part: its column around or across and its row along.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct LatticePlace {
    /// Index of the part.
    pub part: u32,
    /// Counted around a cylinder or across a sheet, from 0.
    pub column: u32,
    /// Counted along, from 0; on a dia-grid row 0 are the half diamonds at the start.
    pub row: u32,
}

impl Selection {
    /// The cells at some places and all that lies in them.
    pub fn new(places: impl IntoIterator<Item = Place>) -> Selection {
        let mut cover = BTreeSet::new();
        let mut places: Vec<Place> = places.into_iter().collect();
        places.sort_unstable_by_key(|place| (place.level, *place));
        for place in places {
            if !covers(&cover, place) {
                cover.insert(place);
            }
        }
        merge_siblings(&mut cover);
        Selection(cover)
    }

    /// All cells of a base mesh.
    pub fn all(mesh: &BaseMesh) -> Selection {
        Selection((0..mesh.faces().len() as u32).map(Place::top).collect())
    }

    /// The top-level cells from the first to the last of some columns and rows of a part; columns from the higher to the lower one run on
    /// round a cylinder.
    pub fn lattice(mesh: &BaseMesh, part: u32, columns: [u32; 2], rows: [u32; 2]) -> Selection {
        let ([first, last], [lowest, highest]) = (columns, rows);
        let within = |column: u32| {
            if first <= last { (first..=last).contains(&column) } else { column >= first || column <= last }
        };
        let cells = (0u32..).zip(lattice_places(mesh));
        let chosen = cells
            .filter(|(_, at)| at.part == part && within(at.column) && (lowest..=highest).contains(&at.row));
        Selection(chosen.map(|(face, _)| Place::top(face)).collect())
    }

    /// The expressed cells whose centre lies in a rectangle of the unrolled map of a part.
    ///
    /// Bounds are [left, right, bottom, top] in units of 2^−[`Selection::MAP_BITS`] columns and rows of the map, bounds
    /// included.
    pub fn on_map(mesh: &BaseMesh, forest: &Forest, part: u32, bounds: [i64; 4]) -> Selection {
        let mut chosen = Vec::new();
        forest.visit_expressed(|_, place| {
            let Some(map) = mesh.map().get(place.face as usize).filter(|map| map.part == part) else {
                return;
            };
            let [u, v] = map_centre(&map.corners, place);
            let [left, right, bottom, top] = bounds.map(i128::from);
            if (left..=right).contains(&u) && (bottom..=top).contains(&v) {
                chosen.push(place);
            }
        });
        Selection::new(chosen)
    }

    /// log2 of the units of a column or row in [`Selection::on_map`].
    pub const MAP_BITS: u32 = 24;

    /// Cells of a level in rings round some nodes: the first ring touches a node, each further one the ring before.
    pub fn rings(mesh: &BaseMesh, nodes: &[NodeKey], count: u32, level: u8) -> Selection {
        if count == 0 {
            return Selection::default();
        }
        let first = nodes.iter().flat_map(|&node| squares_at(mesh, node, level));
        Selection::new(first).grown(mesh, count - 1, level)
    }

    /// The selection with all cells of a level that touch it, so many times over.
    pub fn grown(&self, mesh: &BaseMesh, times: u32, level: u8) -> Selection {
        let mut covered = self.squares(level, true);
        for _ in 0..times {
            let corners: BTreeSet<NodeKey> =
                covered.iter().flat_map(|&square| (0..4).map(move |k| corner_key(mesh, square, k))).collect();
            let before = covered.len();
            covered.extend(corners.into_iter().flat_map(|node| squares_at(mesh, node, level)));
            if covered.len() == before {
                break;
            }
        }
        if times == 0 { self.clone() } else { Selection::new(covered).union(self) }
    }

    /// The selection without the cells of a level that touch what is not selected, so many times over; the border of
    /// the mesh takes nothing away.
    pub fn shrunk(&self, mesh: &BaseMesh, times: u32, level: u8) -> Selection {
        if times == 0 {
            return self.clone();
        }
        let mut kept = self.squares(level, false);
        for _ in 0..times {
            let inside = |&square: &Place| {
                let corners = (0..4).map(|k| corner_key(mesh, square, k));
                corners.flat_map(|node| squares_at(mesh, node, level)).all(|near| kept.contains(&near))
            };
            kept = kept.iter().copied().filter(inside).collect();
        }
        Selection::new(kept)
    }

    /// What lies in either.
    pub fn union(&self, other: &Selection) -> Selection {
        Selection::new(self.0.iter().chain(&other.0).copied())
    }

    /// What lies in this but not in the other.
    pub fn difference(&self, other: &Selection) -> Selection {
        let mut within: BTreeMap<u32, Vec<Place>> = BTreeMap::new();
        for &place in &other.0 {
            within.entry(place.face).or_default().push(place);
        }
        let mut left = BTreeSet::new();
        for &place in &self.0 {
            subtract(place, within.get(&place.face).map_or(&[], Vec::as_slice), &mut left);
        }
        merge_siblings(&mut left);
        Selection(left)
    }

    /// What lies in both.
    pub fn intersection(&self, other: &Selection) -> Selection {
        self.difference(&self.difference(other))
    }

    /// The squares, the fewest that cover the selection, ascending.
    pub fn places(&self) -> impl Iterator<Item = Place> + '_ {
        self.0.iter().copied()
    }

    /// Nothing is selected.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The cell lies wholly in the selection.
    pub fn contains(&self, place: Place) -> bool {
        covers(&self.0, place)
    }

    /// Top-level cells of which some part is selected, ascending.
    pub fn faces(&self) -> BTreeSet<u32> {
        self.0.iter().map(|place| place.face).collect()
    }

    /// The expressed cells of a forest that lie wholly in the selection.
    pub fn expressed(&self, forest: &Forest) -> Vec<Place> {
        let mut found = Vec::new();
        forest.visit_expressed(|_, place| {
            if self.contains(place) {
                found.push(place);
            }
        });
        found
    }

    /// The squares of a level that the selection touches inside (`some`), or covers whole.
    fn squares(&self, level: u8, some: bool) -> BTreeSet<Place> {
        let mut squares = BTreeSet::new();
        for &place in &self.0 {
            if place.level > level {
                if some {
                    squares.insert(place.ancestor(level));
                }
                continue;
            }
            let (shift, across) = (level - place.level, 1u32 << (level - place.level));
            for (di, dj) in (0..across).flat_map(|di| (0..across).map(move |dj| (di, dj))) {
                let (i, j) = ((place.i << shift) + di, (place.j << shift) + dj);
                squares.insert(Place { level, i, j, ..place });
            }
        }
        squares
    }
}

/// Addresses with ` + ` between them; `none` if nothing is selected.
impl fmt::Display for Selection {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return write!(formatter, "none");
        }
        for (at, place) in self.0.iter().enumerate() {
            let between = if at == 0 { "" } else { " + " };
            write!(formatter, "{between}{place}")?;
        }
        Ok(())
    }
}

/// Column and row of every top-level cell among those of its part; empty for a mesh from a file.
pub fn lattice_places(mesh: &BaseMesh) -> Vec<LatticePlace> {
    let place = |map: &MapPlace| {
        let [first, second, _, fourth] = map.corners;
        let quad = first.1 == second.1 && first.0 == fourth.0;
        let row = if quad { second.1 / 2 } else { second.1 };
        LatticePlace { part: map.part, column: first.0.div_euclid(2) as u32, row: row as u32 }
    };
    mesh.map().iter().map(place).collect()
}

/// Squares of a level that have a node in them or on their border.
pub fn squares_at(mesh: &BaseMesh, node: NodeKey, level: u8) -> Vec<Place> {
    let mut squares = Vec::new();
    let mut add = |face: u32, i: u32, j: u32| {
        let size = UNITS >> level;
        let near = |at: u32| {
            let (square, on_line) = (at / size, at.is_multiple_of(size));
            let before = (on_line && square > 0).then(|| square - 1);
            before.into_iter().chain((at < UNITS).then_some(square))
        };
        for i in near(i) {
            squares.extend(near(j).map(|j| Place { face, level, i, j }));
        }
    };
    match node.place() {
        NodePlace::Vertex(vertex) => {
            for &face in mesh.faces_at_vertex(vertex) {
                let corner = mesh.faces()[face as usize].iter().position(|&corner| corner == vertex);
                let (i, j) = [(0, 0), (UNITS, 0), (UNITS, UNITS), (0, UNITS)][corner.unwrap_or(0)];
                add(face, i, j);
            }
        }
        NodePlace::Edge { edge, parameter } => {
            for at in mesh.faces_at_edge(edge) {
                let along = if at.reversed { UNITS - parameter } else { parameter };
                let (i, j) = match at.side {
                    0 => (along, 0),
                    1 => (UNITS, along),
                    2 => (UNITS - along, UNITS),
                    _ => (0, UNITS - along),
                };
                add(at.face, i, j);
            }
        }
        NodePlace::Face { face, i, j } => add(face, i, j),
    }
    squares
}

fn corner_key(mesh: &BaseMesh, square: Place, corner: u8) -> NodeKey {
    let size = UNITS >> square.level;
    let (right, up) = [(0, 0), (1, 0), (1, 1), (0, 1)][usize::from(corner)];
    NodeKey::at(mesh, square.face, (square.i + right) * size, (square.j + up) * size)
}

fn covers(cover: &BTreeSet<Place>, place: Place) -> bool {
    (0..=place.level).any(|level| cover.contains(&place.ancestor(level)))
}

fn merge_siblings(cover: &mut BTreeSet<Place>) {
    let mut open: Vec<Place> = cover.iter().copied().collect();
    while let Some(place) = open.pop() {
        if place.level == 0 || !cover.contains(&place) {
            continue;
        }
        let above = place.ancestor(place.level - 1);
        let children: [Place; 4] = std::array::from_fn(|k| above.child(k as u8));
        if children.iter().all(|child| cover.contains(child)) {
            children.iter().for_each(|child| {
                cover.remove(child);
            });
            cover.insert(above);
            open.push(above);
        }
    }
}

fn subtract(place: Place, taken: &[Place], left: &mut BTreeSet<Place>) {
    if taken.iter().any(|other| other.contains(place)) {
        return;
    }
    let inside: Vec<Place> = taken.iter().copied().filter(|&other| place.contains(other)).collect();
    if inside.is_empty() {
        left.insert(place);
    } else {
        (0..4).for_each(|k| subtract(place.child(k), &inside, left));
    }
}

/// Centre of a cell on the unrolled map, in units of 2^−MAP_BITS columns and rows.
fn map_centre(corners: &[(i32, i32); 4], place: Place) -> [i128; 2] {
    // Twice the column and row of the middle, of 2^(level + 1) in all, weigh the corners.
    let whole = 2i128 << place.level;
    let (x, y) = (i128::from(2 * place.i + 1), i128::from(2 * place.j + 1));
    let weights = [(whole - x) * (whole - y), x * (whole - y), x * y, (whole - x) * y];
    let mix = |read: fn(&(i32, i32)) -> i32| {
        let sum: i128 =
            corners.iter().zip(weights).map(|(corner, weight)| i128::from(read(corner)) * weight).sum();
        // Map corners count half columns and half rows.
        (sum << (Selection::MAP_BITS - 1)) / (whole * whole)
    };
    [mix(|corner| corner.0), mix(|corner| corner.1)]
}
