//! Symmetries of a base mesh: rotations and mirrors that carry cells to cells and anchors to anchors.
//!
//! Found by carrying one frame to another and following the edges; where an edge branches, each way is tried.

use crate::address::Place;
use crate::base_mesh::{BaseMesh, FaceSide};
use crate::cell_type::{Catalogue, CellTypeId};
use crate::edit::{Edit, EditError};
use crate::forest::{CellIndex, Content, Forest, NodePair};
use crate::gene::Reference;
use crate::node_key::{NodeKey, NodePlace, UNITS};
use crate::orientation::{Frame, Mirrors, Orientation};
use crate::patch::frames_at;
use crate::tree::Tree;
use std::collections::{BTreeSet, VecDeque};
use thiserror::Error;

/// Most symmetries that are looked for.
pub const MOST: usize = 10_000;

/// Where every top-level cell goes, and how it comes to lie there.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Symmetry(Vec<Frame>);

/// Why symmetries can't be used.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum SymmetryError {
    /// Parts that are not joined can be moved one by one.
    #[error("the framework has more than {MOST} symmetries; join its parts, or name its anchors differently")]
    TooMany,
    /// A mirror needs an image of every type.
    #[error("cell type {0} has no mirror image, but the framework has mirror symmetries; define its image")]
    NoMirror(String),
    /// The forest is not symmetric.
    #[error("cell {0} and cell {1} differ, though a symmetry of the framework carries one to the other")]
    Forest(u32, u32),
    /// An added or cut spring has no images.
    #[error("the spring {0} {1} is added or cut, but not its images under the symmetries of the framework")]
    Override(NodeKey, NodeKey),
    /// Images of an edit do different things to one cell or spring.
    #[error("'{0}' can't be done to its whole orbit: an image of it does something else to the same cell")]
    Contradiction(String),
}

impl Symmetry {
    /// Where a top-level cell goes.
    pub fn of(&self, face: u32) -> Frame {
        self.0[face as usize]
    }

    /// Where a cell goes.
    pub fn place(&self, place: Place) -> Place {
        let to = self.of(place.face);
        to.orientation.place(place, to.face)
    }

    /// The symmetry moves no cell.
    pub fn is_identity(&self) -> bool {
        (0..).zip(&self.0).all(|(face, to)| to.face == face && to.orientation == Orientation::UPRIGHT)
    }

    /// Some cell is mirrored.
    pub fn mirrors(&self) -> bool {
        self.0.iter().any(|to| to.orientation.mirrored)
    }

    /// Where a node goes.
    pub fn node(&self, mesh: &BaseMesh, node: NodeKey) -> NodeKey {
        let (face, i, j) = match node.place() {
            NodePlace::Vertex(vertex) => {
                let face = mesh.faces_at_vertex(vertex)[0];
                let corner = mesh.faces()[face as usize].iter().position(|&corner| corner == vertex);
                let (i, j) = [(0, 0), (UNITS, 0), (UNITS, UNITS), (0, UNITS)][corner.unwrap_or(0)];
                (face, i, j)
            }
            NodePlace::Edge { edge, parameter } => {
                let at = mesh.faces_at_edge(edge)[0];
                let along = if at.reversed { UNITS - parameter } else { parameter };
                match at.side {
                    0 => (at.face, along, 0),
                    1 => (at.face, UNITS, along),
                    2 => (at.face, UNITS - along, UNITS),
                    _ => (at.face, 0, UNITS - along),
                }
            }
            NodePlace::Face { face, i, j } => (face, i, j),
        };
        let to = self.of(face);
        // A mirror about the diagonal swaps i and j and moves corner k to 4 − k; turns come after it.
        let (mut i, mut j) = if to.orientation.mirrored { (j, i) } else { (i, j) };
        for _ in 0..to.orientation.turn {
            (i, j) = (UNITS - j, i);
        }
        NodeKey::at(mesh, to.face, i, j)
    }

    /// A forest as it comes to lie; without added and cut springs and without genes.
    ///
    /// # Errors
    /// A type that would be mirrored and has no mirror image.
    pub fn forest(&self, forest: &Forest, mirrors: &Mirrors) -> Result<Forest, CellTypeId> {
        let mut carried = Forest::new(forest.top_level(), Content::QUAD);
        for face in 0..forest.top_level() {
            let Frame { face: onto, orientation } = self.of(face);
            let tree = Tree::of(forest, forest.top(face)).oriented(orientation, mirrors)?;
            tree.grow(&mut carried, CellIndex(onto));
        }
        Ok(carried)
    }

    /// What an edit is where it goes.
    ///
    /// # Errors
    /// A type that would be mirrored and has no mirror image.
    pub fn edit(&self, mesh: &BaseMesh, edit: Edit, mirrors: &Mirrors) -> Result<Edit, CellTypeId> {
        let moved = |cell: Place, contents: [Content; 4]| {
            let orientation = self.of(cell.face).orientation;
            let mut turned = contents;
            for (k, content) in (0..).zip(contents) {
                turned[usize::from(orientation.corner(k))] = orientation.content(content, mirrors)?;
            }
            Ok(turned)
        };
        Ok(match edit {
            Edit::Subdivide { cell, children } => {
                Edit::Subdivide { cell: self.place(cell), children: moved(cell, children)? }
            }
            Edit::Merge { cell, children } => {
                Edit::Merge { cell: self.place(cell), children: moved(cell, children)? }
            }
            Edit::Retype { cell, from, to } => {
                let orientation = self.of(cell.face).orientation;
                let (from, to) = (orientation.content(from, mirrors)?, orientation.content(to, mirrors)?);
                Edit::Retype { cell: self.place(cell), from, to }
            }
            Edit::Toggle { cell, on } => Edit::Toggle { cell: self.place(cell), on },
            Edit::Override { pair, what, set } => {
                let [a, b] = pair.keys().map(|key| self.node(mesh, key));
                // Different nodes stay different.
                Edit::Override { pair: NodePair::new(a, b).unwrap_or(pair), what, set }
            }
            Edit::Refer { seed, reference, set } => {
                let to = self.of(seed);
                let orientation = to.orientation.after(reference.orientation);
                Edit::Refer { seed: to.face, reference: Reference { orientation, ..reference }, set }
            }
        })
    }
}

/// All symmetries of a base mesh that carry anchors to anchors, ascending; the first moves nothing.
///
/// # Errors
/// More than [`MOST`], as where parts are not joined.
pub fn symmetries(mesh: &BaseMesh, anchors: &[u32]) -> Result<Vec<Symmetry>, SymmetryError> {
    let mut anchored = vec![false; mesh.vertex_count() as usize];
    anchors.iter().for_each(|&vertex| anchored[vertex as usize] = true);
    let mut search = Search { mesh, anchored, found: Vec::new() };
    // A frame at an anchor can only go to one at an anchor, which leaves few to try.
    let at_anchor = |&anchor: &u32| frames_at(mesh, anchor);
    let from = anchors.iter().flat_map(at_anchor).next().unwrap_or(Frame::at_corner(0, 0, false));
    let onto: Vec<Frame> = if anchors.is_empty() {
        let faces = 0..mesh.faces().len() as u32;
        faces
            .flat_map(|face| Orientation::all().map(move |orientation| Frame { face, orientation }))
            .collect()
    } else {
        anchors.iter().flat_map(at_anchor).collect()
    };
    for frame in onto {
        search.start(from.face, frame.reached_from(from));
    }
    let mut found = search.found;
    if found.len() > MOST {
        return Err(SymmetryError::TooMany);
    }
    found.sort_unstable();
    found.dedup();
    Ok(found)
}

struct Search<'a> {
    mesh: &'a BaseMesh,
    anchored: Vec<bool>,
    found: Vec<Symmetry>,
}

#[derive(Clone)]
struct Partial {
    faces: Vec<Option<Frame>>,
    face_used: Vec<bool>,
    vertices: Vec<Option<u32>>,
    vertex_used: Vec<bool>,
    queue: VecDeque<u32>,
}

impl Search<'_> {
    fn start(&mut self, face: u32, to: Frame) {
        let (faces, vertices) = (self.mesh.faces().len(), self.mesh.vertex_count() as usize);
        let partial = Partial {
            faces: vec![None; faces],
            face_used: vec![false; faces],
            vertices: vec![None; vertices],
            vertex_used: vec![false; vertices],
            queue: VecDeque::new(),
        };
        self.carry(partial, face, to);
    }

    /// Carries a face to a frame and follows all edges with two cells, then branches.
    fn carry(&mut self, mut partial: Partial, face: u32, to: Frame) {
        if self.found.len() > MOST || !self.set(&mut partial, face, to) {
            return;
        }
        while let Some(face) = partial.queue.pop_front() {
            let Some(to) = partial.faces[face as usize] else { return };
            for side in 0..4 {
                if !self.follow(&mut partial, face, to, side) {
                    return;
                }
            }
        }
        let Some((face, choices)) = self.open(&partial) else {
            let faces = partial.faces.into_iter().flatten().collect();
            self.found.push(Symmetry(faces));
            return;
        };
        for to in choices {
            self.carry(partial.clone(), face, to);
        }
    }

    fn set(&self, partial: &mut Partial, face: u32, to: Frame) -> bool {
        if let Some(known) = partial.faces[face as usize] {
            return known == to;
        }
        if partial.face_used[to.face as usize] {
            return false;
        }
        let (from, onto) = (self.mesh.faces()[face as usize], self.mesh.faces()[to.face as usize]);
        for k in 0..4u8 {
            let (vertex, image) = (from[usize::from(k)], onto[usize::from(to.orientation.corner(k))]);
            match partial.vertices[vertex as usize] {
                Some(known) if known == image => {}
                Some(_) => return false,
                None => {
                    let used = partial.vertex_used[image as usize];
                    let (many, others) =
                        (self.mesh.faces_at_vertex(vertex).len(), self.mesh.faces_at_vertex(image).len());
                    let alike = self.anchored[vertex as usize] == self.anchored[image as usize];
                    if used || !alike || many != others {
                        return false;
                    }
                    partial.vertices[vertex as usize] = Some(image);
                    partial.vertex_used[image as usize] = true;
                }
            }
        }
        partial.faces[face as usize] = Some(to);
        partial.face_used[to.face as usize] = true;
        partial.queue.push_back(face);
        true
    }

    fn follow(&self, partial: &mut Partial, face: u32, to: Frame, side: u8) -> bool {
        let edge = self.mesh.side_edge(face, side).edge;
        let image = self.mesh.side_edge(to.face, to.orientation.side(side)).edge;
        let count = self.mesh.faces_at_edge(edge).len();
        if count != self.mesh.faces_at_edge(image).len() {
            return false;
        }
        if count != 2 {
            return true;
        }
        let beyond = Frame { face, orientation: Orientation::UPRIGHT }.across(self.mesh, side);
        match (beyond, to.across(self.mesh, side)) {
            (Ok(from), Ok(onto)) => self.set(partial, from.face, onto.reached_from(from)),
            _ => false,
        }
    }

    /// A face that is not carried yet, at a branching edge if there is one, and where it could go.
    fn open(&self, partial: &Partial) -> Option<(u32, Vec<Frame>)> {
        let open = |face: u32| partial.faces[face as usize].is_none();
        let faces = 0..self.mesh.faces().len() as u32;
        let touches = |face: u32, side: u8| {
            let [a, b] = self.mesh.edges()[self.mesh.side_edge(face, side).edge as usize];
            let images = [a, b].map(|vertex| partial.vertices[vertex as usize]);
            match images {
                [Some(a), Some(b)] => Some([a, b]),
                _ => None,
            }
        };
        for face in faces.clone().filter(|&face| open(face)) {
            for side in 0..4u8 {
                let Some([a, b]) = touches(face, side) else { continue };
                let Some(image) = self.mesh.edge_between(a, b) else { return Some((face, Vec::new())) };
                let corner = self.mesh.faces()[face as usize][usize::from(side)];
                let first = partial.vertices[corner as usize];
                let choices =
                    self.mesh.faces_at_edge(image).iter().filter(|at| !partial.face_used[at.face as usize]);
                let frame = |at: &FaceSide| {
                    let start = self.mesh.faces()[at.face as usize][usize::from(at.side)];
                    // Corner `side` goes to the edge's one end, corner `side + 1` to the other.
                    let orientation = if Some(start) == first {
                        Orientation::new(at.side + 4 - side, false)
                    } else {
                        Orientation::new(at.side + 1 + side, true)
                    };
                    Frame { face: at.face, orientation }
                };
                return Some((face, choices.map(frame).collect()));
            }
        }
        let face = faces.clone().find(|&face| open(face))?;
        let unused = faces.filter(|&face| !partial.face_used[face as usize]);
        let all =
            unused.flat_map(|face| Orientation::all().map(move |orientation| Frame { face, orientation }));
        Some((face, all.collect()))
    }
}

/// The orbits of cells under a group of symmetries, and how to keep a forest symmetric.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Orbits {
    /// For every face: the lowest face of its orbit, and how that one comes to lie on it.
    origins: Vec<Frame>,
    /// For the lowest face of every orbit: the faces of the orbit, ascending; empty for others.
    members: Vec<Vec<u32>>,
    /// For the lowest face of every orbit: the orientations in which it is carried to itself.
    stabilisers: Vec<Vec<Orientation>>,
    mirrors: Mirrors,
    catalogue: Catalogue,
}

impl Orbits {
    /// The orbits of a group that holds all compositions of its symmetries, such as [`symmetries`] gives.
    ///
    /// # Errors
    /// A type among `types` has no mirror image, but a symmetry mirrors.
    pub fn new(
        group: &[Symmetry],
        faces: u32,
        catalogue: &Catalogue,
        types: &BTreeSet<CellTypeId>,
    ) -> Result<Orbits, SymmetryError> {
        let mirrors = Mirrors::new(catalogue);
        if group.iter().any(Symmetry::mirrors)
            && let Some(&kind) = types.iter().find(|&&kind| mirrors.image(kind).is_none())
        {
            return Err(SymmetryError::NoMirror(catalogue.word(kind)));
        }
        let upright = |face: u32| Frame { face, orientation: Orientation::UPRIGHT };
        let mut origins: Vec<Option<Frame>> = vec![None; faces as usize];
        let mut stabilisers = vec![Vec::new(); faces as usize];
        for face in 0..faces {
            if origins[face as usize].is_some() {
                continue;
            }
            origins[face as usize] = Some(upright(face));
            for symmetry in group {
                let to = symmetry.of(face);
                if to.face == face {
                    stabilisers[face as usize].push(to.orientation);
                } else if origins[to.face as usize].is_none() {
                    origins[to.face as usize] = Some(Frame { face, orientation: to.orientation });
                }
            }
            stabilisers[face as usize].sort_unstable();
            stabilisers[face as usize].dedup();
        }
        let origins: Vec<Frame> =
            (0..).zip(origins).map(|(face, origin)| origin.unwrap_or(upright(face))).collect();
        let mut members = vec![Vec::new(); faces as usize];
        for (face, origin) in (0..).zip(&origins) {
            members[origin.face as usize].push(face);
        }
        Ok(Orbits { origins, members, stabilisers, mirrors, catalogue: catalogue.clone() })
    }

    /// The cell stands for its orbit.
    pub fn represents(&self, place: Place) -> bool {
        self.representative(place) == place
    }

    /// The cell that stands for another one's orbit: in the lowest face, the one with the first path of children, as
    /// [`Orbits::symmetrise`] takes it for the others.
    pub fn representative(&self, place: Place) -> Place {
        let back = self.on_origin(place);
        self.images_on_origin(back).min_by(|a, b| a.path().cmp(b.path())).unwrap_or(back)
    }

    /// The cells of a cell's orbit, each once, ascending.
    pub fn images(&self, place: Place) -> Vec<Place> {
        let back = self.on_origin(place);
        let mut images: Vec<Place> = self
            .images_on_origin(back)
            .flat_map(|image| {
                let onto = move |&face: &u32| self.origins[face as usize].orientation.place(image, face);
                self.members[back.face as usize].iter().map(onto)
            })
            .collect();
        images.sort_unstable();
        images.dedup();
        images
    }

    /// An image of a cell in the lowest face of the orbit.
    fn on_origin(&self, place: Place) -> Place {
        let origin = self.origins[place.face as usize];
        origin.orientation.inverse().place(place, origin.face)
    }

    /// All images in the lowest face of the orbit of a cell there.
    fn images_on_origin(&self, place: Place) -> impl Iterator<Item = Place> + '_ {
        self.stabilisers[place.face as usize].iter().map(move |turned| turned.place(place, place.face))
    }

    /// Number of orbits of top-level cells.
    pub fn count(&self) -> usize {
        self.members.iter().filter(|members| !members.is_empty()).count()
    }

    /// Makes a forest symmetric in the orbits of some top-level cells: the first of these in every orbit gives the
    /// others its subtree, and, where a cell is carried to itself, its lowest children give the others theirs.
    /// Edits are applied and appended.
    ///
    /// # Errors
    /// None on a valid forest whose types have mirror images.
    pub fn symmetrise(
        &self,
        forest: &mut Forest,
        faces: impl IntoIterator<Item = u32>,
        edits: &mut Vec<Edit>,
    ) -> Result<(), EditError> {
        let mut done = BTreeSet::new();
        for first in faces {
            let origin = self.origins[first as usize];
            if !done.insert(origin.face) {
                continue;
            }
            let tree = Tree::of(forest, forest.top(first));
            let back = tree.oriented(origin.orientation.inverse(), &self.mirrors);
            let Ok(mut tree) = back else { continue };
            self.even_out(&mut tree, &self.stabilisers[origin.face as usize]);
            for &face in &self.members[origin.face as usize] {
                let from = self.origins[face as usize].orientation;
                if let Ok(image) = tree.oriented(from, &self.mirrors) {
                    image.write_over(forest, Place::top(face), edits)?;
                }
            }
        }
        Ok(())
    }

    /// Makes a tree the same in all orientations of a group.
    fn even_out(&self, tree: &mut Tree, group: &[Orientation]) {
        if group.len() < 2 {
            return;
        }
        tree.content = self.evened(tree.content, group);
        let Some(children) = &mut tree.children else { return };
        let mut done = [false; 4];
        for k in 0..4u8 {
            if done[usize::from(k)] {
                continue;
            }
            let fixing: Vec<Orientation> =
                group.iter().copied().filter(|turned| turned.corner(k) == k).collect();
            self.even_out(&mut children[usize::from(k)], &fixing);
            done[usize::from(k)] = true;
            for turned in group {
                let at = usize::from(turned.corner(k));
                if !done[at] {
                    if let Ok(image) = children[usize::from(k)].oriented(*turned, &self.mirrors) {
                        children[at] = image;
                    }
                    done[at] = true;
                }
            }
        }
    }

    /// The content, or the first of its turns that is the same in all orientations of a group, or the plain quad.
    fn evened(&self, content: Content, group: &[Orientation]) -> Content {
        let turns = (0..4).map(|more| Content { turn: (content.turn + more) % 4, ..content });
        let same = |one: Content| {
            let image = |turned: &Orientation| turned.content(one, &self.mirrors);
            group.iter().all(|turned| image(turned).is_ok_and(|image| self.alike(image, one)))
        };
        turns.into_iter().find(|&one| same(one)).unwrap_or(Content::QUAD)
    }

    fn alike(&self, a: Content, b: Content) -> bool {
        contents_alike(a, b, &self.catalogue)
    }

    /// Checks that a forest is symmetric: images hold the same, up to turns that make no difference.
    ///
    /// # Errors
    /// Two cells that differ, or an added or cut spring without its images.
    pub fn check(&self, mesh: &BaseMesh, forest: &Forest, group: &[Symmetry]) -> Result<(), SymmetryError> {
        for symmetry in group {
            for face in 0..forest.top_level() {
                let to = symmetry.of(face);
                let image = Tree::of(forest, forest.top(face)).oriented(to.orientation, &self.mirrors);
                let found = Tree::of(forest, forest.top(to.face));
                if !image.is_ok_and(|image| self.same_tree(&image, &found)) {
                    return Err(SymmetryError::Forest(face, to.face));
                }
            }
            for (pair, what) in forest.overrides() {
                let [a, b] = pair.keys();
                let image = NodePair::new(symmetry.node(mesh, a), symmetry.node(mesh, b));
                if image.and_then(|image| forest.overrides().get(&image)) != Some(what) {
                    return Err(SymmetryError::Override(a, b));
                }
            }
        }
        Ok(())
    }

    fn same_tree(&self, a: &Tree, b: &Tree) -> bool {
        let same_children = match (&a.children, &b.children) {
            (None, None) => true,
            (Some(a), Some(b)) => a.iter().zip(b.iter()).all(|(a, b)| self.same_tree(a, b)),
            _ => false,
        };
        a.on == b.on && self.alike(a.content, b.content) && same_children
    }
}

/// What becomes of edits under a whole group: every image of every edit, each once, in order.
///
/// # Errors
/// An edit with an image that does something else to the same cell or spring; a type without mirror image.
pub fn edits_of_orbits(
    mesh: &BaseMesh,
    group: &[Symmetry],
    edits: &[Edit],
    catalogue: &Catalogue,
) -> Result<Vec<Edit>, SymmetryError> {
    let mirrors = Mirrors::new(catalogue);
    let mut all = Vec::new();
    for &edit in edits {
        let first = all.len();
        for symmetry in group {
            let image = symmetry.edit(mesh, edit, &mirrors);
            let image = image.map_err(|kind| SymmetryError::NoMirror(catalogue.word(kind)))?;
            let mut known = all[first..].iter();
            match known.find(|&&other| subject(other) == subject(image)) {
                Some(&other) if same_effect(other, image, catalogue) => {}
                Some(_) => return Err(SymmetryError::Contradiction(edit.write(catalogue))),
                None => all.push(image),
            }
        }
    }
    Ok(all)
}

/// The cell, pair of nodes or seed of a gene that an edit is about.
fn subject(edit: Edit) -> (Option<Place>, Option<NodePair>, Option<u32>) {
    match edit {
        Edit::Override { pair, .. } => (None, Some(pair), None),
        Edit::Refer { seed, .. } => (None, None, Some(seed)),
        _ => (edit.cell(), None, None),
    }
}

fn same_effect(a: Edit, b: Edit, catalogue: &Catalogue) -> bool {
    let alike = |a: &Content, b: &Content| contents_alike(*a, *b, catalogue);
    match (a, b) {
        (Edit::Subdivide { children: a, .. }, Edit::Subdivide { children: b, .. })
        | (Edit::Merge { children: a, .. }, Edit::Merge { children: b, .. }) => {
            a.iter().zip(&b).all(|(a, b)| alike(a, b))
        }
        (Edit::Retype { to: a, .. }, Edit::Retype { to: b, .. }) => alike(&a, &b),
        _ => a == b,
    }
}

/// Two contents give the same springs.
fn contents_alike(a: Content, b: Content, catalogue: &Catalogue) -> bool {
    let distinct = catalogue.get(a.kind).distinct_turns();
    a.kind == b.kind && a.turn % distinct == b.turn % distinct
}
