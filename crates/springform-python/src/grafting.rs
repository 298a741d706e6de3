//! Selections, patches, grafts and symmetries for Python.

use crate::convert::refusal;
use crate::setting::Setting;
use crate::topology::{BaseMesh, Forest};
use pyo3::prelude::*;
use springform_topology::address::Place;
use springform_topology::base_mesh;
use springform_topology::cell_type::{Catalogue, CellTypeId};
use springform_topology::edit::Edit;
use springform_topology::gene::{GeneError, Instances};
use springform_topology::graft;
use springform_topology::node_key::NodeKey;
use springform_topology::orientation::{Frame, Mirrors, Orientation};
use springform_topology::patch::{self, LeftOut, Patch, PatchCell, Viewpoint, Walk};
use springform_topology::selection;
use springform_topology::symmetry;
use springform_topology::tree::Tree;
use std::collections::{BTreeMap, BTreeSet};

/// (walk, free sides, (path of children, cell notation)) of every top-level cell, and whether corner 0 is an anchor.
pub type PatchTuple = (bool, Vec<(String, Vec<u8>, Vec<(String, String)>)>);

/// (top-level cell, turn, mirrored).
pub type FrameTuple = (u32, u8, bool);

/// Top-level cells that were written, and (walk, top-level cell, why) of what was skipped.
type PlacedTuple = (Vec<u32>, Vec<(String, Option<u32>, &'static str)>);

/// The patch, its frame, and (address, why) of what it does not hold.
type LiftedTuple = (PatchTuple, FrameTuple, Vec<(String, &'static str)>);

/// The forest, the edits, and what happened in every frame.
type GraftedTuple = (Forest, Vec<String>, Vec<PlacedTuple>);

pub fn frame_tuple(frame: Frame) -> FrameTuple {
    (frame.face, frame.orientation.turn, frame.orientation.mirrored)
}

fn frame(mesh: &base_mesh::BaseMesh, (face, turn, mirrored): FrameTuple) -> PyResult<Frame> {
    if face as usize >= mesh.faces().len() {
        let last = mesh.faces().len() - 1;
        return Err(refusal("seed", format!("there is no top-level cell {face}; there are 0 to {last}")));
    }
    Ok(Frame { face, orientation: Orientation::new(turn, mirrored) })
}

fn no_mirror(kind: CellTypeId, catalogue: &Catalogue) -> PyErr {
    refusal("patch", format!("cell type {} has no mirror image", catalogue.word(kind)))
}

pub fn patch_of((anchored, rows): PatchTuple, catalogue: &Catalogue) -> PyResult<Patch> {
    let mut cells = Vec::with_capacity(rows.len());
    for (at, (walk, free, texts)) in rows.into_iter().enumerate() {
        let refused = |problem: String| refusal(format!("cells[{at}]"), problem);
        let walk = Walk::parse(&walk)
            .ok_or_else(|| refused(format!("'{walk}' is no walk: write steps f, l, r, and b only first")))?;
        let mut trees = BTreeMap::new();
        for (path, text) in texts {
            // A path is an address below the cell.
            let address = if path.is_empty() { "0".to_owned() } else { format!("0.{path}") };
            let place = Place::parse(&address).map_err(|_| {
                refused(format!("'{path}' is no path: write children 0-3 with dots, such as 0.3"))
            })?;
            let tree = Tree::read(&text, catalogue).map_err(|error| refused(error.to_string()))?;
            trees.insert(place.path().collect(), tree);
        }
        let free = std::array::from_fn(|side| free.contains(&(side as u8)));
        cells.push(PatchCell { walk, free, trees });
    }
    cells.sort_unstable();
    if let Some(pair) = cells.windows(2).find(|pair| pair[0].walk == pair[1].walk) {
        return Err(refusal("cells", format!("the walk '{}' is there twice", pair[0].walk)));
    }
    Ok(Patch { anchored, cells })
}

pub fn patch_tuple(patch: &Patch, catalogue: &Catalogue) -> PatchTuple {
    let row = |cell: &PatchCell| {
        let free = (0..4).filter(|&side| cell.free[usize::from(side)]).collect();
        let dotted = |path: &[u8]| path.iter().map(u8::to_string).collect::<Vec<_>>().join(".");
        let trees = cell.trees.iter().map(|(path, tree)| (dotted(path), tree.write(catalogue)));
        (cell.walk.to_string(), free, trees.collect())
    };
    (patch.anchored, patch.cells.iter().map(row).collect())
}

/// A region of cells: a value, equal to others that cover the same.
#[pyclass(frozen, module = "springform._core")]
pub struct Selection {
    pub selection: selection::Selection,
}

fn wrapped(selection: selection::Selection) -> Selection {
    Selection { selection }
}

fn nodes(mesh: &base_mesh::BaseMesh, keys: &[String]) -> PyResult<Vec<NodeKey>> {
    let parse = |key: &String| NodeKey::parse(key, mesh).map_err(|error| refusal(key, error));
    keys.iter().map(parse).collect()
}

#[pymethods]
impl Selection {
    /// The cells at some addresses.
    #[new]
    fn new(mesh: &BaseMesh, addresses: Vec<String>) -> PyResult<Self> {
        let faces = mesh.mesh.faces().len();
        let parse = |address: &String| {
            let place = Place::parse(address).map_err(|error| refusal("cells", error))?;
            if place.face as usize >= faces {
                let problem = format!("there is no cell {address}; top-level cells are 0 to {}", faces - 1);
                return Err(refusal("cells", problem));
            }
            Ok(place)
        };
        Ok(wrapped(selection::Selection::new(addresses.iter().map(parse).collect::<PyResult<Vec<_>>>()?)))
    }

    #[staticmethod]
    fn all(mesh: &BaseMesh) -> Self {
        wrapped(selection::Selection::all(&mesh.mesh))
    }

    /// Top-level cells in ranges of columns and rows of a part.
    #[staticmethod]
    fn lattice(mesh: &BaseMesh, part: u32, columns: [u32; 2], rows: [u32; 2]) -> Self {
        wrapped(selection::Selection::lattice(&mesh.mesh, part, columns, rows))
    }

    /// Expressed cells whose centre lies in [left, right, bottom, top] of a part's unrolled map, in units of
    /// 2^-24 columns and rows.
    #[staticmethod]
    fn on_map(mesh: &BaseMesh, forest: &Forest, part: u32, bounds: [i64; 4]) -> Self {
        wrapped(selection::Selection::on_map(&mesh.mesh, &forest.forest, part, bounds))
    }

    /// Cells of a level in rings round nodes.
    #[staticmethod]
    fn rings(mesh: &BaseMesh, nodes: Vec<String>, count: u32, level: u8) -> PyResult<Self> {
        let nodes = self::nodes(&mesh.mesh, &nodes)?;
        Ok(wrapped(selection::Selection::rings(&mesh.mesh, &nodes, count, level)))
    }

    fn grown(&self, mesh: &BaseMesh, times: u32, level: u8) -> Self {
        wrapped(self.selection.grown(&mesh.mesh, times, level))
    }

    fn shrunk(&self, mesh: &BaseMesh, times: u32, level: u8) -> Self {
        wrapped(self.selection.shrunk(&mesh.mesh, times, level))
    }

    fn union(&self, other: &Selection) -> Self {
        wrapped(self.selection.union(&other.selection))
    }

    fn difference(&self, other: &Selection) -> Self {
        wrapped(self.selection.difference(&other.selection))
    }

    fn intersection(&self, other: &Selection) -> Self {
        wrapped(self.selection.intersection(&other.selection))
    }

    fn __eq__(&self, other: &Selection) -> bool {
        self.selection == other.selection
    }

    fn __bool__(&self) -> bool {
        !self.selection.is_empty()
    }

    fn __str__(&self) -> String {
        self.selection.to_string()
    }

    /// Addresses of the fewest squares that cover it.
    #[getter]
    fn addresses(&self) -> Vec<String> {
        self.selection.places().map(|place| place.to_string()).collect()
    }

    /// Top-level cells of which some part is selected.
    #[getter]
    fn faces(&self) -> Vec<u32> {
        self.selection.faces().into_iter().collect()
    }

    /// Addresses of the expressed cells of a forest that lie in it.
    fn expressed(&self, forest: &Forest) -> Vec<String> {
        self.selection.expressed(&forest.forest).into_iter().map(|place| place.to_string()).collect()
    }
}

/// Lifts a patch: the patch, its frame, and (address, why) of what it does not hold.
///
/// It is seen from `frame`, or else from `vertex`, which is an anchor if `anchored`, or else from anywhere.
#[pyfunction]
#[pyo3(signature = (setting, forest, selection, *, vertex=None, anchored=false, frame=None))]
pub fn lift(
    py: Python<'_>,
    setting: &Setting,
    forest: &Forest,
    selection: &Selection,
    vertex: Option<u32>,
    anchored: bool,
    frame: Option<FrameTuple>,
) -> PyResult<LiftedTuple> {
    let setting = &setting.setting;
    let viewpoint = match (frame, vertex) {
        (Some(tuple), _) => Viewpoint::Frame(self::frame(&setting.mesh, tuple)?),
        (None, Some(vertex)) if anchored => Viewpoint::Anchor(vertex),
        (None, Some(vertex)) => Viewpoint::Vertex(vertex),
        (None, None) => Viewpoint::Anywhere,
    };
    let mirrors = Mirrors::new(&setting.catalogue);
    let (forest, selection) = (&forest.forest, &selection.selection);
    let lifted = py
        .detach(|| patch::lift(&setting.mesh, forest, selection, viewpoint, &mirrors))
        .map_err(|error| refusal("selection", error))?;
    let words = |why: LeftOut| match why {
        LeftOut::NotThere => "the design does not divide its cells so far",
        LeftOut::OutOfReach => "no way leads there within the selection, across edges with two cells",
        LeftOut::NoMirror => "it lies mirrored, and its cell type has no mirror image",
    };
    let left_out = lifted.left_out.iter().map(|&(place, why)| (place.to_string(), words(why))).collect();
    Ok((patch_tuple(&lifted.patch, &setting.catalogue), frame_tuple(lifted.frame), left_out))
}

/// Grafts a patch in some frames, in order: the forest, the edits, and what happened in every frame.
///
/// No cell outside of `within` is written. Then the method's filters close the forest.
#[pyfunction]
#[pyo3(signature = (setting, forest, patch, frames, *, within=None))]
pub fn graft_patch(
    py: Python<'_>,
    setting: &Setting,
    forest: &Forest,
    patch: PatchTuple,
    frames: Vec<FrameTuple>,
    within: Option<&Selection>,
) -> PyResult<GraftedTuple> {
    let inner = &setting.setting;
    let patch = patch_of(patch, &inner.catalogue)?;
    let frames = frames.into_iter().map(|tuple| frame(&inner.mesh, tuple)).collect::<PyResult<Vec<_>>>()?;
    let mirrors = Mirrors::new(&inner.catalogue);
    let mut forest = forest.forest.clone();
    let within = within.map(|within| &within.selection);
    let may_write = |place: Place| within.is_none_or(|within| within.contains(place));
    let grafted = py.detach(|| {
        // Cells that are held by reference belong to their gene.
        let held = Instances::new(&inner.mesh, &inner.catalogue, &forest)?;
        let (mut edits, mut taken) = (Vec::new(), BTreeSet::from_iter(held.faces()));
        let mut placed = Vec::new();
        for frame in frames {
            let what = (&patch, frame);
            placed.push(graft::graft(
                &inner.mesh,
                &mut forest,
                what,
                &mirrors,
                &mut taken,
                may_write,
                &mut edits,
            )?);
        }
        edits.extend(inner.close(&mut forest)?);
        Ok((edits, placed))
    });
    let (edits, placed) = grafted.map_err(|error: GeneError| refusal("patch", error))?;
    let words = |placed: graft::Placed| {
        let skipped = placed.skipped.iter();
        let skipped = skipped.map(|skip| (skip.walk.to_string(), skip.face, skip.why.words())).collect();
        (placed.faces, skipped)
    };
    Ok((Forest { forest }, setting.lines(&edits), placed.into_iter().map(words).collect()))
}

/// Checks that a patch can be read and that the method allows its types.
#[pyfunction]
pub fn check_patch(setting: &Setting, patch: PatchTuple) -> PyResult<()> {
    let setting = &setting.setting;
    let patch = patch_of(patch, &setting.catalogue)?;
    let refused = |kind: &CellTypeId| !setting.method.allows(*kind, &setting.catalogue);
    match patch.types().into_iter().find(refused) {
        Some(kind) => {
            let (method, word) = (setting.method, setting.catalogue.word(kind));
            let problem =
                format!("it has type {word}, but method {} allows {}", method.name(), method.allowed_words());
            Err(refusal("cells", problem))
        }
        None => Ok(()),
    }
}

/// The frame at a base vertex in which a patch fits best.
#[pyfunction]
pub fn best_frame(setting: &Setting, patch: PatchTuple, vertex: u32) -> PyResult<Option<FrameTuple>> {
    let setting = &setting.setting;
    let patch = patch_of(patch, &setting.catalogue)?;
    let mirrors = Mirrors::new(&setting.catalogue);
    Ok(graft::best_frame(&setting.mesh, &patch, vertex, &mirrors).map(frame_tuple))
}

/// How badly a patch lies in some frames: cells that would be skipped, sides that are free and were not or the
/// other way round.
#[pyfunction]
pub fn misfits(
    setting: &Setting,
    patch: PatchTuple,
    frames: Vec<FrameTuple>,
) -> PyResult<Vec<(usize, usize)>> {
    let setting = &setting.setting;
    let patch = patch_of(patch, &setting.catalogue)?;
    let mirrors = Mirrors::new(&setting.catalogue);
    let misfit = |tuple| Ok(graft::misfit(&setting.mesh, &patch, frame(&setting.mesh, tuple)?, &mirrors));
    frames.into_iter().map(misfit).collect()
}

/// A patch as it is seen after quarter turns, mirrored or not.
#[pyfunction]
pub fn turned_patch(setting: &Setting, patch: PatchTuple, turn: u8, mirrored: bool) -> PyResult<PatchTuple> {
    let catalogue = &setting.setting.catalogue;
    let patch = patch_of(patch, catalogue)?;
    let turned = patch.oriented(Orientation::new(turn, mirrored), &Mirrors::new(catalogue));
    Ok(patch_tuple(&turned.map_err(|kind| no_mirror(kind, catalogue))?, catalogue))
}

/// Symmetries of a framework: rotations and mirrors that carry anchors to anchors.
#[pyclass(frozen, module = "springform._core")]
pub struct Symmetries {
    pub group: Vec<symmetry::Symmetry>,
}

#[pymethods]
impl Symmetries {
    #[new]
    fn new(py: Python<'_>, setting: &Setting) -> PyResult<Self> {
        let setting = &setting.setting;
        let group = py
            .detach(|| symmetry::symmetries(&setting.mesh, &setting.anchors))
            .map_err(|error| refusal("framework", error))?;
        Ok(Symmetries { group })
    }

    fn __len__(&self) -> usize {
        self.group.len()
    }

    /// Which of them mirror cells.
    #[getter]
    fn mirrored(&self) -> Vec<bool> {
        self.group.iter().map(symmetry::Symmetry::mirrors).collect()
    }

    /// Where every one of them carries a frame.
    fn images(&self, frame: FrameTuple) -> Vec<FrameTuple> {
        let (face, turn, mirrored) = frame;
        let orientation = Orientation::new(turn, mirrored);
        let image = |one: &symmetry::Symmetry| {
            let to = one.of(face);
            frame_tuple(Frame { orientation: to.orientation.after(orientation), ..to })
        };
        self.group.iter().map(image).collect()
    }

    /// Where every one of them carries a node.
    fn node_images(&self, mesh: &BaseMesh, node: &str) -> PyResult<Vec<String>> {
        let key = NodeKey::parse(node, &mesh.mesh).map_err(|error| refusal(node, error))?;
        Ok(self.group.iter().map(|one| one.node(&mesh.mesh, key).to_string()).collect())
    }

    /// A forest as the symmetry of a number carries it, without added and cut springs.
    fn carried(&self, setting: &Setting, forest: &Forest, number: usize) -> PyResult<Forest> {
        let catalogue = &setting.setting.catalogue;
        let one = self.group.get(number).ok_or_else(|| refusal("symmetry", "there is no such symmetry"))?;
        let carried = one.forest(&forest.forest, &Mirrors::new(catalogue));
        let forest = carried.map_err(|kind| no_mirror(kind, catalogue))?;
        Ok(Forest { forest })
    }

    /// Edits and their images, each once.
    fn edits(&self, setting: &Setting, edits: Vec<String>) -> PyResult<Vec<String>> {
        let edits: Vec<Edit> = setting.edits(&edits)?;
        let inner = &setting.setting;
        let all = symmetry::edits_of_orbits(&inner.mesh, &self.group, &edits, &inner.catalogue);
        Ok(setting.lines(&all.map_err(|error| refusal("edit", error))?))
    }

    /// Checks that a forest is symmetric.
    fn check(&self, setting: &Setting, forest: &Forest) -> PyResult<()> {
        self.orbits(setting, &[], forest).map(|_| ())
    }
}

impl Symmetries {
    /// Orbits for evolving a symmetric forest with some types.
    pub fn orbits(
        &self,
        setting: &Setting,
        types: &[CellTypeId],
        forest: &Forest,
    ) -> PyResult<symmetry::Orbits> {
        let (inner, forest) = (&setting.setting, &forest.forest);
        let types: BTreeSet<CellTypeId> = types.iter().copied().collect();
        let orbits = symmetry::Orbits::new(&self.group, forest.top_level(), &inner.catalogue, &types);
        let orbits = orbits.map_err(|error| refusal("symmetry", error))?;
        orbits.check(&inner.mesh, forest, &self.group).map_err(|error| refusal("symmetry", error))?;
        Ok(orbits)
    }
}
