//! Genes by reference: a patch with a name that a forest holds in many places (the paper §5, "allows the genetic code
//! to shrink with a subtree set of the CIN operating as a single gene").
//!
//! The forest names gene and frame; its cells there are the gene's, expanded. Whatever changes one instance
//! is copied to the others as further edits, so that all stay alike.

use crate::address::Place;
use crate::base_mesh::BaseMesh;
use crate::cell_type::Catalogue;
use crate::edit::{Edit, EditError};
use crate::filters::recursive::{close, refine};
use crate::forest::Forest;
use crate::orientation::{Frame, Mirrors, Orientation};
use crate::patch::Patch;
use crate::tree::Tree;
use rustc_hash::FxHashMap;
use std::collections::{BTreeMap, BTreeSet};
use thiserror::Error;

/// Number of a gene in a [`Catalogue`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct GeneId(pub u16);

/// A patch with a name.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Gene {
    /// Name in cell notation, as `&crown`.
    pub name: String,
    /// Its cells, whole top-level cells, as they are while no forest holds an instance.
    pub patch: Patch,
}

/// A gene as it is held at a top-level cell.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Reference {
    /// The gene.
    pub gene: GeneId,
    /// How the seed lies.
    pub orientation: Orientation,
}

/// A reference that can't be held.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum GeneError {
    /// A walk leads nowhere.
    #[error(
        "gene {0} does not fit at cell {1}: it reaches over a border or a branching edge, or a cell twice"
    )]
    Fit(String, u32),
    /// Two instances meet.
    #[error("gene {0} at cell {1} lies on cell {2}, which belongs to a gene already")]
    Overlap(String, u32, u32),
    /// A mirrored type has no image.
    #[error("gene {0} can't be mirrored at cell {1}: a cell type of it has no mirror image")]
    NoMirror(String, u32),
    /// A gene with parts of cells.
    #[error("gene {0} holds parts of top-level cells; a gene by reference holds whole ones")]
    Parts(String),
    /// An edit that does not fit.
    #[error(transparent)]
    Edit(#[from] EditError),
}

impl Reference {
    /// `crown@1m`: name, quarter turns, mirrored.
    pub fn write(self, catalogue: &Catalogue) -> String {
        let turn =
            if self.orientation.turn > 0 { format!("@{}", self.orientation.turn) } else { String::new() };
        let mirrored = match (self.orientation.mirrored, turn.is_empty()) {
            (false, _) => "",
            (true, true) => "@0m",
            (true, false) => "m",
        };
        format!("{}{turn}{mirrored}", catalogue.gene(self.gene).name)
    }

    /// Reads `crown@1m`; `None` if it is no reference to a gene of the catalogue.
    pub fn parse(text: &str, catalogue: &Catalogue) -> Option<Reference> {
        let (name, turn) = text.split_once('@').unwrap_or((text, "0"));
        let (turn, mirrored) = turn.strip_suffix('m').map_or((turn, false), |turn| (turn, true));
        let turn = ["0", "1", "2", "3"].iter().position(|&known| known == turn)?;
        let orientation = Orientation::new(turn as u8, mirrored);
        // One way of writing each.
        let reference = Reference { gene: catalogue.find_gene(name)?, orientation };
        (reference.write(catalogue) == text).then_some(reference)
    }
}

/// A gene where a forest holds it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Instance {
    /// The gene.
    pub gene: GeneId,
    /// Seed and orientation.
    pub frame: Frame,
    /// Frames of its cells, in the order of the gene's.
    pub cells: Vec<Frame>,
}

/// All instances of a forest, and which cell belongs to which.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Instances {
    /// Ascending by seed.
    pub list: Vec<Instance>,
    /// Instance and number of the cell in it, by top-level cell.
    owners: BTreeMap<u32, (usize, usize)>,
    mirrors: Mirrors,
}

impl Instances {
    /// Finds the cells of all references of a forest.
    ///
    /// # Errors
    /// A gene that does not fit where it is referred to.
    pub fn new(mesh: &BaseMesh, catalogue: &Catalogue, forest: &Forest) -> Result<Instances, GeneError> {
        let mut found =
            Instances { list: Vec::new(), owners: BTreeMap::new(), mirrors: Mirrors::new(catalogue) };
        for (&face, &Reference { gene, orientation }) in forest.references() {
            let Gene { name, patch } = catalogue.gene(gene);
            let frame = Frame { face, orientation };
            let whole = |cell: &crate::patch::PatchCell| cell.trees.keys().all(Vec::is_empty);
            if !patch.cells.iter().all(whole) {
                return Err(GeneError::Parts(name.clone()));
            }
            let cells: Result<Vec<Frame>, _> = patch.locate(mesh, frame).into_iter().collect();
            let cells = cells.map_err(|_| GeneError::Fit(name.clone(), face))?;
            for (number, cell) in cells.iter().enumerate() {
                if found.owners.insert(cell.face, (found.list.len(), number)).is_some() {
                    return Err(GeneError::Overlap(name.clone(), face, cell.face));
                }
                let imageless = |kind| found.mirrors.image(kind).is_none();
                if cell.orientation.mirrored && patch.types().into_iter().any(imageless) {
                    return Err(GeneError::NoMirror(name.clone(), face));
                }
            }
            found.list.push(Instance { gene, frame, cells });
        }
        Ok(found)
    }

    /// The top-level cells of all instances.
    pub fn faces(&self) -> impl Iterator<Item = u32> + '_ {
        self.owners.keys().copied()
    }

    /// The cell belongs to no instance, or to the first one of its gene: it may be changed for all of them.
    pub fn represents(&self, face: u32) -> bool {
        let first = |at: usize| self.list[..at].iter().all(|other| other.gene != self.list[at].gene);
        self.owners.get(&face).is_none_or(|&(at, _)| first(at))
    }

    /// The same cell in all other instances, each with how it lies compared to the given one.
    fn twins(&self, face: u32) -> Vec<Frame> {
        let Some(&(at, number)) = self.owners.get(&face) else { return Vec::new() };
        let from = self.list[at].cells[number];
        let others = self
            .list
            .iter()
            .enumerate()
            .filter(|(other, one)| *other != at && one.gene == self.list[at].gene);
        others.map(|(_, one)| one.cells[number].reached_from(from)).collect()
    }

    /// The gene's cells as they stand in its first instance; `None` without one.
    pub fn content(&self, forest: &Forest, catalogue: &Catalogue, gene: GeneId) -> Option<Patch> {
        let instance = self.list.iter().find(|one| one.gene == gene)?;
        let mut patch = catalogue.gene(gene).patch.clone();
        for (cell, frame) in patch.cells.iter_mut().zip(&instance.cells) {
            let tree = Tree::of(forest, forest.top(frame.face));
            let tree = tree.oriented(frame.orientation.inverse(), &self.mirrors).ok()?;
            cell.trees = BTreeMap::from([(Vec::new(), tree)]);
        }
        Some(patch)
    }

    /// Copies what was done to cells of instances to the others; of several touched instances the last counts.
    fn copy(
        &self,
        catalogue: &Catalogue,
        forest: &mut Forest,
        touched: &[u32],
        edits: &mut Vec<Edit>,
    ) -> Result<(), GeneError> {
        let mut last: BTreeMap<(GeneId, usize), u32> = BTreeMap::new();
        for face in touched {
            if let Some(&(at, number)) = self.owners.get(face) {
                last.insert((self.list[at].gene, number), *face);
            }
        }
        for face in last.into_values() {
            let tree = Tree::of(forest, forest.top(face));
            let (at, number) = self.owners[&face];
            let gene = self.list[at].gene;
            let seen = |orientation: Orientation, face: u32| {
                let image = tree.oriented(orientation, &self.mirrors);
                image.map_err(|_| GeneError::NoMirror(catalogue.gene(gene).name.clone(), face))
            };
            // As the gene holds it: it must be possible to write it down.
            seen(self.list[at].cells[number].orientation.inverse(), face)?;
            for twin in self.twins(face) {
                seen(twin.orientation, twin.face)?.write_over(forest, Place::top(twin.face), edits)?;
            }
        }
        Ok(())
    }
}

/// Makes all instances alike after edits were applied: a new reference takes on its gene, a changed instance gives
/// its cells to the others. Further edits are applied and appended.
///
/// # Errors
/// A reference that can't be held; the forest is then to be thrown away.
pub fn follow(
    mesh: &BaseMesh,
    catalogue: &Catalogue,
    forest: &mut Forest,
    edits: &mut Vec<Edit>,
) -> Result<(), GeneError> {
    if forest.references().is_empty() {
        return Ok(());
    }
    let instances = Instances::new(mesh, catalogue, forest)?;
    let referred = |edit: &Edit| match *edit {
        Edit::Refer { seed, set: true, .. } => Some(seed),
        _ => None,
    };
    let new: BTreeSet<u32> = edits.iter().filter_map(referred).collect();
    let is_new = |face: u32| {
        instances.owners.get(&face).is_some_and(|&(at, _)| new.contains(&instances.list[at].frame.face))
    };
    let faces = edits.iter().filter_map(Edit::cell).map(|cell| cell.face);
    let touched: Vec<u32> = faces.filter(|&face| !is_new(face)).collect();
    instances.copy(catalogue, forest, &touched, edits)?;
    let old: Vec<&Instance> = instances.list.iter().filter(|one| !new.contains(&one.frame.face)).collect();
    for instance in instances.list.iter().filter(|one| new.contains(&one.frame.face)) {
        let gene = catalogue.gene(instance.gene);
        let model = old.iter().find(|one| one.gene == instance.gene);
        for (number, (cell, at)) in gene.patch.cells.iter().zip(&instance.cells).enumerate() {
            let seen = model.map(|model| model.cells[number]);
            let stored = cell.trees.values().next();
            let tree = match seen {
                Some(from) => Tree::of(forest, forest.top(from.face))
                    .oriented(at.orientation.after(from.orientation.inverse()), &instances.mirrors)
                    .ok(),
                None => stored.and_then(|tree| tree.oriented(at.orientation, &instances.mirrors).ok()),
            };
            let tree = tree.ok_or_else(|| GeneError::NoMirror(gene.name.clone(), instance.frame.face))?;
            tree.write_over(forest, Place::top(at.face), edits)?;
        }
    }
    Ok(())
}

/// Makes levels balance as [`close`] does, and carries what that takes in one instance to the others, until no more
/// is needed.
///
/// # Errors
/// A reference that can't be held.
pub fn close_alike(
    mesh: &BaseMesh,
    catalogue: &Catalogue,
    forest: &mut Forest,
) -> Result<Vec<Edit>, GeneError> {
    let mut all = close(mesh, forest)?;
    if forest.references().is_empty() {
        return Ok(all);
    }
    let instances = Instances::new(mesh, catalogue, forest)?;
    let mut latest = all.clone();
    while !latest.is_empty() {
        let refined = latest.iter().filter_map(|edit| match *edit {
            Edit::Subdivide { cell, .. } | Edit::Toggle { cell, on: true } => Some(cell),
            _ => None,
        });
        let mut echoed = Vec::new();
        for cell in refined {
            for twin in instances.twins(cell.face) {
                let place = twin.orientation.place(cell, twin.face);
                if forest.expressed_over(place).is_some_and(|(_, level)| level == place.level) {
                    let before = echoed.len();
                    refine(forest, place, &mut echoed);
                    Edit::apply_all(&echoed[before..], forest)?;
                }
            }
        }
        all.extend_from_slice(&echoed);
        latest = close(mesh, forest)?;
        all.extend_from_slice(&latest);
    }
    Ok(all)
}

/// Genes by name.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub(crate) struct GeneTable {
    genes: Vec<Gene>,
    numbers: FxHashMap<String, u16>,
}

impl GeneTable {
    pub(crate) fn add(&mut self, gene: Gene) -> Option<GeneId> {
        let number = u16::try_from(self.genes.len()).ok()?;
        if self.numbers.contains_key(&gene.name) {
            return None;
        }
        self.numbers.insert(gene.name.clone(), number);
        self.genes.push(gene);
        Some(GeneId(number))
    }

    pub(crate) fn get(&self, id: GeneId) -> &Gene {
        &self.genes[usize::from(id.0)]
    }

    pub(crate) fn find(&self, name: &str) -> Option<GeneId> {
        self.numbers.get(name).copied().map(GeneId)
    }

    pub(crate) fn all(&self) -> &[Gene] {
        &self.genes
    }
}
