//! Base mesh: conforming quads with oriented edges; every top-level cell is one of its faces.
//!
//! ```text
//!   c3 ──side 2── c2     side k runs from corner k to corner k+1;
//!   │             │      an edge runs from its lower vertex to its higher one,
//! side 3        side 1   so a side is `reversed` where it runs against its edge.
//!   │             │      Any number of faces may share an edge.
//!   c0 ──side 0── c1
//! ```

mod from_framework;

use crate::MAX_FACES;
use crate::framework::Side;
use rustc_hash::FxHashMap;
use thiserror::Error;

/// One side of one face, as seen from its edge.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct FaceSide {
    /// The face.
    pub face: u32,
    /// Side 0–3 of the face.
    pub side: u8,
    /// The side runs against the edge.
    pub reversed: bool,
}

/// The edge under one side of a face.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SideEdge {
    /// The edge.
    pub edge: u32,
    /// The side runs against the edge.
    pub reversed: bool,
}

/// A ring of a cylinder or a side of a sheet, as vertices of the base mesh.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Border {
    /// Name of the cylinder or sheet.
    pub part: String,
    /// Which border of it.
    pub side: Side,
    /// Vertices that the framework numbers: `index` of an anchor counts these.
    pub vertices: Vec<u32>,
    /// All base vertices along the border, middles of ring edges included.
    pub path: Vec<u32>,
    /// A ring closes on itself.
    pub closed: bool,
}

/// Where a face lies in the unrolled map of its part, in half columns and half rows.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct MapPlace {
    /// Index of the part.
    pub part: u32,
    /// Corners c0–c3 as (half columns, half rows).
    pub corners: [(i32, i32); 4],
}

/// Quads, their edges, and the borders of the parts they came from.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct BaseMesh {
    vertex_count: u32,
    faces: Vec<[u32; 4]>,
    face_sides: Vec<[SideEdge; 4]>,
    edges: Vec<[u32; 2]>,
    edge_faces: Groups<FaceSide>,
    vertex_faces: Groups<u32>,
    borders: Vec<Border>,
    map: Vec<MapPlace>,
}

/// Why a base mesh can't be made. `key` names the place in the framework.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
#[error("{key}: {problem}")]
pub struct MeshError {
    /// Such as `framework.joins[2]`.
    pub key: String,
    /// What is wrong and what to do.
    pub problem: String,
}

impl MeshError {
    fn new(key: impl Into<String>, problem: impl Into<String>) -> Self {
        MeshError { key: key.into(), problem: problem.into() }
    }
}

impl BaseMesh {
    /// A base mesh from quads given by vertex numbers.
    ///
    /// # Errors
    /// No face, too many faces, a vertex out of range or in no face, a repeated corner.
    pub fn from_faces(vertex_count: u32, faces: Vec<[u32; 4]>) -> Result<Self, MeshError> {
        let key = |face: usize| format!("framework.mesh.faces[{face}]");
        let mut used = vec![false; vertex_count as usize];
        for (index, face) in faces.iter().enumerate() {
            for &vertex in face {
                *used
                    .get_mut(vertex as usize)
                    .ok_or_else(|| MeshError::new(key(index), format!("vertex {vertex} does not exist")))? =
                    true;
            }
            if let Some(vertex) = repeated_corner(face) {
                let problem = format!("corner {vertex} occurs twice; a cell needs four corners");
                return Err(MeshError::new(key(index), problem));
            }
        }
        if let Some(vertex) = used.iter().position(|used| !used) {
            let problem = "the vertex is in no face; delete it or give it a face";
            return Err(MeshError::new(format!("framework.mesh.vertices[{vertex}]"), problem));
        }
        Self::assemble(vertex_count, faces, Vec::new(), Vec::new())
    }

    fn assemble(
        vertex_count: u32,
        faces: Vec<[u32; 4]>,
        borders: Vec<Border>,
        map: Vec<MapPlace>,
    ) -> Result<Self, MeshError> {
        if faces.is_empty() || faces.len() > MAX_FACES {
            let problem = format!("{} top-level cells; 1 to {MAX_FACES} are possible", faces.len());
            return Err(MeshError::new("framework", problem));
        }
        let mut edges = Vec::new();
        let mut number_of: FxHashMap<[u32; 2], u32> = FxHashMap::default();
        let face_sides: Vec<[SideEdge; 4]> = faces
            .iter()
            .map(|face| {
                std::array::from_fn(|side| {
                    let (from, to) = (face[side], face[(side + 1) % 4]);
                    let ends = [from.min(to), from.max(to)];
                    let edge = *number_of.entry(ends).or_insert_with(|| {
                        edges.push(ends);
                        (edges.len() - 1) as u32
                    });
                    SideEdge { edge, reversed: from > to }
                })
            })
            .collect();
        let edge_faces = Groups::collect(
            edges.len(),
            face_sides.iter().enumerate().flat_map(|(face, sides)| {
                sides.iter().enumerate().map(move |(side, at)| {
                    let reversed = at.reversed;
                    (at.edge, FaceSide { face: face as u32, side: side as u8, reversed })
                })
            }),
        );
        let corners = faces.iter().enumerate();
        let vertex_faces = Groups::collect(
            vertex_count as usize,
            corners.flat_map(|(face, corners)| corners.map(|vertex| (vertex, face as u32))),
        );
        Ok(BaseMesh { vertex_count, faces, face_sides, edges, edge_faces, vertex_faces, borders, map })
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> u32 {
        self.vertex_count
    }

    /// Corners of every face.
    pub fn faces(&self) -> &[[u32; 4]] {
        &self.faces
    }

    /// Lower and higher vertex of every edge.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// The edge under a side of a face.
    pub fn side_edge(&self, face: u32, side: u8) -> SideEdge {
        self.face_sides[face as usize][usize::from(side)]
    }

    /// The edges under the sides of a face.
    pub(crate) fn side_edges(&self, face: u32) -> [SideEdge; 4] {
        self.face_sides[face as usize]
    }

    /// Which edges are free, in order of edges.
    pub(crate) fn free_edges(&self) -> impl Iterator<Item = bool> {
        self.edge_faces.starts().windows(2).map(|ends| ends[1] - ends[0] == 1)
    }

    /// All sides of faces that lie on an edge.
    pub fn faces_at_edge(&self, edge: u32) -> &[FaceSide] {
        self.edge_faces.of(edge)
    }

    /// Faces that have a vertex as corner.
    pub fn faces_at_vertex(&self, vertex: u32) -> &[u32] {
        self.vertex_faces.of(vertex)
    }

    /// The edge between two vertices.
    pub fn edge_between(&self, a: u32, b: u32) -> Option<u32> {
        let ends = [a.min(b), a.max(b)];
        let sides = self.faces_at_vertex(a).iter().flat_map(|&face| self.face_sides[face as usize]);
        sides.map(|side| side.edge).find(|&edge| self.edges[edge as usize] == ends)
    }

    /// Only one face lies on the edge: a free ring, or the rim of a sheet or mesh.
    pub fn is_free_edge(&self, edge: u32) -> bool {
        self.edge_faces.of(edge).len() == 1
    }

    /// Rings and sides, part by part; none for a mesh from a file.
    pub fn borders(&self) -> &[Border] {
        &self.borders
    }

    /// The unrolled map, one place a face; empty for a mesh from a file.
    pub fn map(&self) -> &[MapPlace] {
        &self.map
    }

    /// The base vertex at `index` of a border.
    pub fn border_vertex(&self, part: &str, side: Side, index: usize) -> Option<u32> {
        let border = self.borders.iter().find(|border| border.part == part && border.side == side)?;
        border.vertices.get(index).copied()
    }
}

/// Items grouped by a number, in one allocation.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Groups<T> {
    starts: Vec<u32>,
    items: Vec<T>,
}

impl<T> Default for Groups<T> {
    fn default() -> Self {
        Groups { starts: vec![0], items: Vec::new() }
    }
}

impl<T: Copy> Groups<T> {
    /// Groups pairs of (group, item); items keep their order within a group.
    pub fn collect(groups: usize, pairs: impl Iterator<Item = (u32, T)> + Clone) -> Self {
        let mut collected = Groups::default();
        collected.regroup(groups, pairs);
        collected
    }

    /// Takes all groups away and keeps their memory.
    pub(crate) fn clear(&mut self) {
        self.starts.truncate(1);
        self.items.clear();
    }

    /// Adds a group of what `append` appends to all items; returns what it says and the group.
    pub(crate) fn add<R>(&mut self, append: impl FnOnce(&mut Vec<T>) -> R) -> (R, &[T]) {
        let first = self.items.len();
        let said = append(&mut self.items);
        self.starts.push(self.items.len() as u32);
        (said, &self.items[first..])
    }

    /// Regroups pairs of (group, item) like [`Groups::collect`], in the same memory.
    pub(crate) fn regroup(&mut self, groups: usize, pairs: impl Iterator<Item = (u32, T)> + Clone) {
        self.starts.clear();
        self.starts.resize(groups + 1, 0);
        // Counted one group further on, a start becomes the end of its group while the group is filled.
        self.items.clear();
        for (group, item) in pairs.clone() {
            // Every place gets some item before it gets its own.
            self.items.push(item);
            if let Some(count) = self.starts.get_mut(group as usize + 2) {
                *count += 1;
            }
        }
        for group in 2..=groups {
            self.starts[group] += self.starts[group - 1];
        }
        for (group, item) in pairs {
            let end = &mut self.starts[group as usize + 1];
            self.items[*end as usize] = item;
            *end += 1;
        }
    }

    /// Keeps the items that `map` keeps, in their order and groups.
    pub(crate) fn filter_map(&mut self, map: impl Fn(T) -> Option<T>) {
        let (mut read, mut written) = (0, 0);
        for end in &mut self.starts[1..] {
            for at in read..*end as usize {
                if let Some(item) = map(self.items[at]) {
                    self.items[written] = item;
                    written += 1;
                }
            }
            read = *end as usize;
            *end = written as u32;
        }
        self.items.truncate(written);
    }

    /// The items of a group.
    pub fn of(&self, group: u32) -> &[T] {
        let group = group as usize;
        &self.items[self.starts[group] as usize..self.starts[group + 1] as usize]
    }

    /// First item of every group, and the number of items.
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// All items, group by group.
    pub fn items(&self) -> &[T] {
        &self.items
    }

    /// Number of groups.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// There is no group.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

fn repeated_corner(face: &[u32; 4]) -> Option<u32> {
    (1..4).find(|&k| face[..k].contains(&face[k])).map(|k| face[k])
}
