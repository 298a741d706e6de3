//! From a framework to base quads: lattices of the parts, joined and numbered.
//!
//! ```text
//! dia-grid, start ring (rows upwards):      quad-grid:
//!        ◇     row 2                          3 ── 2
//!      ◇   ◇   row 1: apexes                  │    │
//!   ─┴─ m ─┴─  row 0: ring, middles m         0 ── 1
//! ```
//! A half diamond (left, right, apex) is a quad whose fourth corner is the middle m of its ring edge.
//! A seam without a cord merges two facing half diamonds into one diamond and drops m.

use super::{BaseMesh, Border, MapPlace, MeshError, repeated_corner};
use crate::framework::{Arc, Framework, Grid, Part, Shape, Side};

/// A face of a part before joining; `half` is the corner that is the middle of a ring edge.
struct DraftFace {
    corners: [u32; 4],
    map: MapPlace,
    half: Option<Half>,
}

#[derive(Clone, Copy)]
struct Half {
    middle_corner: usize,
}

/// One edge of a border: its middle node and half diamond on a dia-grid.
#[derive(Clone, Copy)]
struct BorderEdge {
    middle: Option<u32>,
    face: usize,
}

struct DraftBorder {
    part: usize,
    side: Side,
    vertices: Vec<u32>,
    edges: Vec<BorderEdge>,
    closed: bool,
}

#[derive(Default)]
struct Draft {
    vertex_count: u32,
    faces: Vec<DraftFace>,
    borders: Vec<DraftBorder>,
}

impl BaseMesh {
    /// The base mesh of a framework.
    ///
    /// # Errors
    /// A part that is too small, arcs that don't exist or differ in length, a seam without a cord where
    /// three or more cells meet, a join that folds a cell onto itself.
    pub fn from_framework(framework: &Framework) -> Result<Self, MeshError> {
        let mut draft = Draft::default();
        let mut cells = 0u64;
        for (index, part) in framework.parts.iter().enumerate() {
            check_part(part, framework.grid)?;
            cells += u64::from(part.around) * u64::from(part.along);
            if cells > crate::MAX_FACES as u64 {
                let problem = format!("more than {} top-level cells", crate::MAX_FACES);
                return Err(MeshError::new(format!("framework.{}", part.name), problem));
            }
            match framework.grid {
                Grid::Quad => draft.add_quads(index, part),
                Grid::Dia => draft.add_diamonds(index, part),
            }
        }
        draft.join(framework)
    }
}

fn check_part(part: &Part, grid: Grid) -> Result<(), MeshError> {
    let key = || format!("framework.{}", part.name);
    if part.shape == Shape::Cylinder && part.around < 3 {
        return Err(MeshError::new(key(), "a cylinder needs at least 3 cells around"));
    }
    if part.around < 1 || part.along < 1 {
        return Err(MeshError::new(key(), "a part needs at least one cell each way"));
    }
    if part.shape == Shape::Sheet && grid == Grid::Dia && part.along % 2 == 1 {
        return Err(MeshError::new(key(), "a dia-grid sheet needs an even number of rows along"));
    }
    Ok(())
}

/// Vertex numbers of one part's lattice; row `j` begins at `rows[j]` and has `widths[j]` vertices.
struct Lattice {
    rows: Vec<u32>,
    widths: Vec<u32>,
    closed: bool,
}

impl Lattice {
    fn new(part: &Part, staggered: bool, first: u32) -> Self {
        let closed = part.shape == Shape::Cylinder;
        let (mut rows, mut widths, mut next) = (Vec::new(), Vec::new(), first);
        for row in 0..=part.along {
            let narrow = closed || (staggered && row % 2 == 1);
            let width = if narrow { part.around } else { part.around + 1 };
            rows.push(next);
            widths.push(width);
            next += width;
        }
        Lattice { rows, widths, closed }
    }

    fn at(&self, row: u32, column: i64) -> u32 {
        let width = i64::from(self.widths[row as usize]);
        let column = if self.closed { column.rem_euclid(width) } else { column };
        self.rows[row as usize] + column as u32
    }

    fn end(&self) -> u32 {
        self.rows.last().copied().unwrap_or(0) + self.widths.last().copied().unwrap_or(0)
    }
}

impl Draft {
    fn add_quads(&mut self, index: usize, part: &Part) {
        let lattice = Lattice::new(part, false, self.vertex_count);
        self.vertex_count = lattice.end();
        let first_face = self.faces.len();
        for row in 0..part.along {
            for column in 0..part.around {
                let (i, j) = (i64::from(column), row);
                let corners =
                    [lattice.at(j, i), lattice.at(j, i + 1), lattice.at(j + 1, i + 1), lattice.at(j + 1, i)];
                let (u, v) = (2 * column as i32, 2 * row as i32);
                let places = [(u, v), (u + 2, v), (u + 2, v + 2), (u, v + 2)];
                self.faces.push(DraftFace {
                    corners,
                    map: MapPlace { part: index as u32, corners: places },
                    half: None,
                });
            }
        }
        let face = |row: u32, column: u32| first_face + (row * part.around + column) as usize;
        let along = 0..part.along;
        let last = part.along - 1;
        let across = 0..part.around;
        let plain = |face: usize| BorderEdge { middle: None, face };
        let edges = |side: Side| -> Vec<BorderEdge> {
            match side {
                Side::Start => across.clone().map(|i| plain(face(0, i))).collect(),
                Side::End => across.clone().map(|i| plain(face(last, i))).collect(),
                Side::Left => along.clone().map(|j| plain(face(j, 0))).collect(),
                Side::Right => along.clone().map(|j| plain(face(j, part.around - 1))).collect(),
            }
        };
        for side in sides_of(part) {
            self.add_border(index, part, &lattice, side, 1, edges(side));
        }
    }

    fn add_diamonds(&mut self, index: usize, part: &Part) {
        let lattice = Lattice::new(part, true, self.vertex_count);
        self.vertex_count = lattice.end();
        let closed = part.shape == Shape::Cylinder;
        let stagger = |row: u32| i64::from(row % 2);
        // In half columns: vertex `column` of `row` stands at 2 column + stagger.
        let at = |row: u32, half: i64| lattice.at(row, (half - stagger(row)).div_euclid(2));
        let width = 2 * i64::from(part.around);
        let columns = i64::from(part.around);
        let halves = |row: u32| (0..columns).map(move |k| 2 * k + stagger(row) + 1);
        let map = |corners| MapPlace { part: index as u32, corners };
        let place = |half: i64, row: u32| (half as i32, row as i32);

        let mut start = Vec::new();
        for half in halves(0) {
            let middle = self.new_vertex();
            start.push(BorderEdge { middle: Some(middle), face: self.faces.len() });
            self.faces.push(DraftFace {
                corners: [middle, at(0, half + 1), at(1, half), at(0, half - 1)],
                map: map([place(half, 0), place(half + 1, 0), place(half, 1), place(half - 1, 0)]),
                half: Some(Half { middle_corner: 0 }),
            });
        }
        let (mut left, mut right) = (Vec::new(), Vec::new());
        for row in 0..part.along.saturating_sub(1) {
            let count = i64::from(lattice.widths[row as usize]);
            for half in (0..count).map(|k| 2 * k + stagger(row)) {
                let mut corners = [at(row, half), at(row + 1, half + 1), at(row + 2, half), 0];
                let mut places = [
                    place(half, row),
                    place(half + 1, row + 1),
                    place(half, row + 2),
                    place(half - 1, row + 1),
                ];
                let on_left = !closed && half == 0;
                let on_right = !closed && half == width;
                let mut middle_corner = None;
                if on_left || on_right {
                    let middle = self.new_vertex();
                    let corner = if on_left { 3 } else { 1 };
                    corners[3] = if on_left { middle } else { at(row + 1, half - 1) };
                    corners[1] = if on_right { middle } else { corners[1] };
                    places[corner] = place(half, row + 1);
                    middle_corner = Some(corner);
                    let edges = if on_left { &mut left } else { &mut right };
                    edges.push(BorderEdge { middle: Some(middle), face: self.faces.len() });
                } else {
                    corners[3] = at(row + 1, half - 1);
                }
                self.faces.push(DraftFace {
                    corners,
                    map: map(places),
                    half: middle_corner.map(|middle_corner| Half { middle_corner }),
                });
            }
        }
        let (last, mut end) = (part.along, Vec::new());
        for half in halves(last) {
            let middle = self.new_vertex();
            end.push(BorderEdge { middle: Some(middle), face: self.faces.len() });
            self.faces.push(DraftFace {
                corners: [at(last - 1, half), at(last, half + 1), middle, at(last, half - 1)],
                map: map([
                    place(half, last - 1),
                    place(half + 1, last),
                    place(half, last),
                    place(half - 1, last),
                ]),
                half: Some(Half { middle_corner: 2 }),
            });
        }
        for side in sides_of(part) {
            let edges = match side {
                Side::Start => std::mem::take(&mut start),
                Side::End => std::mem::take(&mut end),
                Side::Left => std::mem::take(&mut left),
                Side::Right => std::mem::take(&mut right),
            };
            self.add_border(index, part, &lattice, side, 2, edges);
        }
    }

    fn new_vertex(&mut self) -> u32 {
        self.vertex_count += 1;
        self.vertex_count - 1
    }

    fn add_border(
        &mut self,
        part: usize,
        shape: &Part,
        lattice: &Lattice,
        side: Side,
        row_step: usize,
        edges: Vec<BorderEdge>,
    ) {
        let row = |row: u32| {
            let first = lattice.rows[row as usize];
            (first..first + lattice.widths[row as usize]).collect()
        };
        let rows = (0..=shape.along).step_by(row_step);
        let vertices: Vec<u32> = match side {
            Side::Start => row(0),
            Side::End => row(shape.along),
            Side::Left => rows.map(|j| lattice.at(j, 0)).collect(),
            Side::Right => rows.map(|j| lattice.at(j, i64::from(shape.around))).collect(),
        };
        self.borders.push(DraftBorder { part, side, vertices, edges, closed: lattice.closed });
    }

    fn border(&self, arc: &Arc) -> Option<usize> {
        self.borders.iter().position(|border| border.part == arc.part && border.side == arc.side)
    }

    fn join(mut self, framework: &Framework) -> Result<BaseMesh, MeshError> {
        let border_starts = self.border_starts();
        let edge_count = border_starts.last().copied().unwrap_or(0);
        let mut vertices = UnionFind::new(self.vertex_count as usize);
        let mut seams = UnionFind::new(edge_count);
        let mut cords = vec![None; edge_count];
        for (number, join) in framework.joins.iter().enumerate() {
            let key = format!("framework.joins[{number}]");
            let (first, second) = (
                self.arc(&join.first, &format!("{key}.first"))?,
                self.arc(&join.second, &format!("{key}.second"))?,
            );
            if join.first.length != join.second.length {
                let problem = format!(
                    "the arcs have {} and {} edges; joined arcs need the same length",
                    join.first.length, join.second.length
                );
                return Err(MeshError::new(key, problem));
            }
            let length = join.first.length as usize;
            for step in 0..=length {
                let opposite = if join.reversed { length - step } else { step };
                vertices.union(first.vertex(&self, step), second.vertex(&self, opposite));
            }
            for step in 0..length {
                let opposite = if join.reversed { length - 1 - step } else { step };
                let (a, b) = (first.edge(step), second.edge(opposite));
                let (a_number, b_number) =
                    (border_starts[first.border] + a, border_starts[second.border] + b);
                if a_number == b_number {
                    let problem = "the arc is joined to itself; give two different arcs";
                    return Err(MeshError::new(key, problem));
                }
                seams.union(a_number as u32, b_number as u32);
                for edge in [a_number, b_number] {
                    if cords[edge].is_some_and(|(cord, _)| cord != join.cord) {
                        let problem =
                            "the same edge is joined with and without a cord; say the same for both joins";
                        return Err(MeshError::new(key, problem));
                    }
                    cords[edge] = Some((join.cord, number));
                }
                let middle = |border: usize, edge: usize| self.borders[border].edges[edge].middle;
                if let (Some(a), Some(b)) = (middle(first.border, a), middle(second.border, b)) {
                    vertices.union(a, b);
                }
            }
        }
        if framework.grid == Grid::Dia {
            self.merge_halves(&mut seams, &cords, &border_starts)?;
        }
        self.finish(framework, vertices)
    }

    fn border_starts(&self) -> Vec<usize> {
        let mut starts = vec![0];
        for border in &self.borders {
            starts.push(starts[starts.len() - 1] + border.edges.len());
        }
        starts
    }

    fn arc(&self, arc: &Arc, key: &str) -> Result<ResolvedArc, MeshError> {
        let border = self
            .border(arc)
            .ok_or_else(|| MeshError::new(key, format!("there is no {} border here", arc.side.name())))?;
        let edges = self.borders[border].edges.len();
        let closed = self.borders[border].closed;
        let (start, length) = (arc.start as usize, arc.length as usize);
        let fits = if closed { start < edges && length <= edges } else { start + length <= edges };
        if length == 0 || !fits {
            let problem =
                format!("the arc of {length} edges from {start} does not fit: the border has {edges} edges");
            return Err(MeshError::new(key, problem));
        }
        Ok(ResolvedArc { border, start, edges })
    }

    /// Seams without a cord: two facing half diamonds become one diamond.
    fn merge_halves(
        &mut self,
        seams: &mut UnionFind,
        cords: &[Option<(bool, usize)>],
        border_starts: &[usize],
    ) -> Result<(), MeshError> {
        let mut groups: Vec<Vec<usize>> = vec![Vec::new(); cords.len()];
        for edge in (0..cords.len()).filter(|&edge| cords[edge].is_some()) {
            groups[seams.find(edge as u32) as usize].push(edge);
        }
        let mut dropped = vec![false; self.faces.len()];
        for group in groups.iter().filter(|group| !group.is_empty()) {
            let Some((false, join)) = cords[group[0]] else { continue };
            let &[first, second] = group.as_slice() else {
                let problem = format!(
                    "{} cells meet on an edge of this seam; a seam without a cord can join only two: set cord = true",
                    group.len()
                );
                return Err(MeshError::new(format!("framework.joins[{join}]"), problem));
            };
            let face_of = |edge: usize| {
                let border = border_starts.partition_point(|&start| start <= edge) - 1;
                self.borders[border].edges[edge - border_starts[border]].face
            };
            let (kept, merged) = (face_of(first).min(face_of(second)), face_of(first).max(face_of(second)));
            let (Some(kept_half), Some(merged_half)) = (self.faces[kept].half, self.faces[merged].half)
            else {
                continue;
            };
            let apex = self.faces[merged].corners[(merged_half.middle_corner + 2) % 4];
            let face = &mut self.faces[kept];
            face.corners[kept_half.middle_corner] = apex;
            let opposite = face.map.corners[(kept_half.middle_corner + 2) % 4];
            let middle = face.map.corners[kept_half.middle_corner];
            face.map.corners[kept_half.middle_corner] =
                (2 * middle.0 - opposite.0, 2 * middle.1 - opposite.1);
            face.half = None;
            dropped[merged] = true;
        }
        let mut keep = dropped.iter().map(|dropped| !dropped);
        self.faces.retain(|_| keep.next().unwrap_or(true));
        Ok(())
    }

    fn finish(self, framework: &Framework, mut vertices: UnionFind) -> Result<BaseMesh, MeshError> {
        const UNUSED: u32 = u32::MAX;
        let mut used = vec![false; self.vertex_count as usize];
        for vertex in self.faces.iter().flat_map(|face| face.corners) {
            used[vertices.find(vertex) as usize] = true;
        }
        let mut numbers = vec![UNUSED; self.vertex_count as usize];
        let mut count = 0;
        for vertex in 0..self.vertex_count {
            let root = vertices.find(vertex) as usize;
            if used[root] && numbers[root] == UNUSED {
                numbers[root] = count;
                count += 1;
            }
        }
        let mut number = |vertex: u32| numbers[vertices.find(vertex) as usize];
        let mut faces = Vec::with_capacity(self.faces.len());
        for face in &self.faces {
            let corners = face.corners.map(&mut number);
            if repeated_corner(&corners).is_some() {
                let part = &framework.parts[face.map.part as usize].name;
                let problem =
                    format!("the joins fold a cell of {part} onto itself: two of its corners become one");
                return Err(MeshError::new("framework.joins", problem));
            }
            faces.push(corners);
        }
        let mut borders = Vec::with_capacity(self.borders.len());
        for border in &self.borders {
            let mut path = Vec::new();
            for (k, &vertex) in border.vertices.iter().enumerate() {
                path.push(number(vertex));
                let middle = border.edges.get(k).and_then(|edge| edge.middle).map(&mut number);
                path.extend(middle.filter(|&middle| middle != UNUSED));
            }
            borders.push(Border {
                part: framework.parts[border.part].name.clone(),
                side: border.side,
                vertices: border.vertices.iter().map(|&vertex| number(vertex)).collect(),
                path,
                closed: border.closed,
            });
        }
        let map = self.faces.iter().map(|face| face.map).collect();
        BaseMesh::assemble(count, faces, borders, map)
    }
}

/// An arc on a border whose edges are numbered from `start`, modulo `edges` on a ring.
struct ResolvedArc {
    border: usize,
    start: usize,
    edges: usize,
}

impl ResolvedArc {
    fn vertex(&self, draft: &Draft, step: usize) -> u32 {
        let vertices = &draft.borders[self.border].vertices;
        vertices[(self.start + step) % vertices.len()]
    }

    fn edge(&self, step: usize) -> usize {
        (self.start + step) % self.edges
    }
}

fn sides_of(part: &Part) -> impl Iterator<Item = Side> + use<> {
    let count = if part.shape == Shape::Cylinder { 2 } else { 4 };
    [Side::Start, Side::End, Side::Left, Side::Right].into_iter().take(count)
}

struct UnionFind {
    parents: Vec<u32>,
}

impl UnionFind {
    fn new(count: usize) -> Self {
        UnionFind { parents: (0..count as u32).collect() }
    }

    fn find(&mut self, mut item: u32) -> u32 {
        while self.parents[item as usize] != item {
            let parent = self.parents[item as usize];
            self.parents[item as usize] = self.parents[parent as usize];
            item = parent;
        }
        item
    }

    /// The lower root stays, so that the outcome does not depend on the order of joins.
    fn union(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }
}
