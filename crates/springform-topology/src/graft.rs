//! Grafting: a patch written into a forest, as edits (the paper §4.3, Figs. 22 and 23).
//!
//! A top-level cell is written whole or skipped and reported: where a walk falls off a border, meets a branching
//! edge or comes to a cell twice, where a type has no mirror image, or where the cell is not to be written.

use crate::address::Place;
use crate::base_mesh::BaseMesh;
use crate::edit::{Edit, EditError};
use crate::forest::{Content, Forest};
use crate::orientation::{Frame, Mirrors};
use crate::patch::{Miss, Patch, PatchCell, Walk, frames_at};
use crate::tree::{Tree, perform};
use std::collections::BTreeSet;

/// A cell of a patch that was not written.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Skip {
    /// Its way from the seed.
    pub walk: Walk,
    /// The top-level cell that it would have been, if there is one.
    pub face: Option<u32>,
    /// Why.
    pub why: Why,
}

/// Why a cell of a patch is not written.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Why {
    /// The way leads off a border.
    Border,
    /// The way meets an edge with more than two cells.
    Branching,
    /// Another cell of the patch has come here: a vertex on the way is irregular.
    Twice,
    /// A mirrored type has no mirror image.
    NoMirror,
    /// What was grafted at another place of the same grafting lies here.
    Taken,
    /// The cell is not among those that may be written.
    Outside,
}

impl Why {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Why::Border => "the way leads off the border",
            Why::Branching => "the way meets an edge with more than two cells",
            Why::Twice => "the patch comes to this cell twice, round an irregular vertex",
            Why::NoMirror => "its cell type has no mirror image",
            Why::Taken => "the patch reaches here from another place as well",
            Why::Outside => "the cell is not among those that may change",
        }
    }
}

/// What grafting in one frame did.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Placed {
    /// Top-level cells that were written, in the order of the patch.
    pub faces: Vec<u32>,
    /// Cells of the patch that were not.
    pub skipped: Vec<Skip>,
}

/// Grafts a patch in a frame; edits are applied and appended to `edits`.
///
/// Cells in `taken` and places for which `may_write` is false are skipped; written cells are added to `taken`.
///
/// # Errors
/// A tree that reaches beyond the deepest level.
pub fn graft(
    mesh: &BaseMesh,
    forest: &mut Forest,
    (patch, frame): (&Patch, Frame),
    mirrors: &Mirrors,
    taken: &mut BTreeSet<u32>,
    may_write: impl Fn(Place) -> bool,
    edits: &mut Vec<Edit>,
) -> Result<Placed, EditError> {
    let mut placed = Placed::default();
    for (cell, reached) in patch.cells.iter().zip(patch.locate(mesh, frame)) {
        let mut skip = |face, why| placed.skipped.push(Skip { walk: cell.walk.clone(), face, why });
        let at = match reached {
            Ok(at) => at,
            Err(Miss::Border) => {
                skip(None, Why::Border);
                continue;
            }
            Err(Miss::Branching) => {
                skip(None, Why::Branching);
                continue;
            }
            Err(Miss::Twice(face)) => {
                skip(Some(face), Why::Twice);
                continue;
            }
        };
        match seen_from(cell, at, mirrors) {
            None => skip(Some(at.face), Why::NoMirror),
            Some(trees) if !trees.iter().all(|&(place, _)| may_write(place)) => {
                skip(Some(at.face), Why::Outside)
            }
            Some(_) if taken.contains(&at.face) => skip(Some(at.face), Why::Taken),
            Some(trees) => {
                for (place, tree) in &trees {
                    divide_to(forest, *place, edits)?;
                    tree.write_over(forest, *place, edits)?;
                }
                taken.insert(at.face);
                placed.faces.push(at.face);
            }
        }
    }
    Ok(placed)
}

/// The subtrees of a patch's cell as they come to lie; `None` if a type has no mirror image.
fn seen_from(cell: &PatchCell, at: Frame, mirrors: &Mirrors) -> Option<Vec<(Place, Tree)>> {
    let tree = |(path, tree): (&Vec<u8>, &Tree)| {
        let top = Place::top(at.face);
        let place = path.iter().fold(top, |above, &child| above.child(at.orientation.corner(child)));
        Some((place, tree.oriented(at.orientation, mirrors).ok()?))
    };
    cell.trees.iter().map(tree).collect()
}

/// Makes the cell at a place one that stands for itself: what is coarser above is divided, each child like its
/// parent; what is off is switched on, with its children's own subdivisions off.
fn divide_to(forest: &mut Forest, place: Place, edits: &mut Vec<Edit>) -> Result<(), EditError> {
    for level in 0..place.level {
        let above = place.ancestor(level);
        let cell = forest.find(above).ok_or(EditError::NoCell(above))?;
        let Some(children) = forest.children(cell) else {
            let children: [Content; 4] = [forest.content(cell); 4];
            perform(Edit::Subdivide { cell: above, children }, forest, edits)?;
            continue;
        };
        if forest.is_on(cell) {
            continue;
        }
        perform(Edit::Toggle { cell: above, on: true }, forest, edits)?;
        for (k, child) in (0..).zip(children) {
            if forest.expressed_children(child).is_some() {
                perform(Edit::Toggle { cell: above.child(k), on: false }, forest, edits)?;
            }
        }
    }
    Ok(())
}

/// The frame at an anchor in which a patch fits best; `None` where no cell has the anchor as corner.
///
/// Of those that fit equally well: unmirrored, the lowest cell, the fewest turns.
pub fn best_frame(mesh: &BaseMesh, patch: &Patch, vertex: u32, mirrors: &Mirrors) -> Option<Frame> {
    let frames = fitting_frames(mesh, patch, vertex, mirrors);
    frames.into_iter().min_by_key(|frame| (frame.orientation.mirrored, *frame))
}

/// The frames at an anchor in which a patch fits best, ascending: those of the least [`misfit`].
pub fn fitting_frames(mesh: &BaseMesh, patch: &Patch, vertex: u32, mirrors: &Mirrors) -> Vec<Frame> {
    let frames = frames_at(mesh, vertex).into_iter();
    let frames: Vec<_> = frames.map(|frame| (misfit(mesh, patch, frame, mirrors), frame)).collect();
    let least = frames.iter().map(|&(misfit, _)| misfit).min();
    frames.into_iter().filter(|&(misfit, _)| Some(misfit) == least).map(|(_, frame)| frame).collect()
}

/// How badly a patch lies in a frame: cells that would be skipped, then sides that are free where they were not or
/// the other way round, so that inward is inward.
pub fn misfit(mesh: &BaseMesh, patch: &Patch, frame: Frame, mirrors: &Mirrors) -> (usize, usize) {
    let (mut skipped, mut unlike) = (0, 0);
    for (cell, reached) in patch.cells.iter().zip(patch.locate(mesh, frame)) {
        match reached {
            Ok(at) if can_lie(cell, at, mirrors) => {
                unlike += (0..4u8).filter(|&k| at.is_free(mesh, k) != cell.free[usize::from(k)]).count();
            }
            _ => skipped += 1,
        }
    }
    (skipped, unlike)
}

/// Every type of a patch's cell has a mirror image where the cell comes to lie mirrored.
fn can_lie(cell: &PatchCell, at: Frame, mirrors: &Mirrors) -> bool {
    let mut possible = true;
    if at.orientation.mirrored {
        for tree in cell.trees.values() {
            tree.visit(&mut |content| possible &= mirrors.image(content.kind).is_some());
        }
    }
    possible
}
