//! Variation beyond single cells: genes that are grafted, symmetries that are kept, a region that is not left.
//!
//! The fourth mutation inserts a patch ("a subtree set of the CIN operating as a single gene", the paper §5) at a
//! random seed and orientation. Under symmetries mutation draws one cell of every orbit and the others follow.

use crate::cell_weights::CellWeights;
use crate::draws::Draws;
use crate::mutation::Amount;
use crate::phenotype::Setting;
use springform_topology::address::Place;
use springform_topology::edit::{Edit, EditError};
use springform_topology::forest::Forest;
use springform_topology::gene::{self, GeneError, Instances};
use springform_topology::graft::{fitting_frames, graft};
use springform_topology::orientation::{Frame, Mirrors, Orientation};
use springform_topology::patch::Patch;
use springform_topology::selection::Selection;
use springform_topology::symmetry::Orbits;
use std::collections::BTreeSet;

/// What mutation may use and touch beside cells and types.
#[derive(Clone, PartialEq, Debug)]
pub struct Variation {
    /// Patches that the fourth step inserts.
    pub genes: Vec<Patch>,
    /// Step 4: most patches that are inserted, a number or a share of the top-level cells; how many is drawn.
    pub grafts: Amount,
    /// Orbits that every individual keeps alike.
    pub orbits: Option<Orbits>,
    /// The region outside of which mutation changes nothing; closing may.
    pub within: Option<Selection>,
    /// Factors on the chance that a cell is drawn. Under symmetries an orbit has the mean of its cells' factors, or 0
    /// if one of them has 0: who keeps evolution out of a cell keeps it out of all that would change with it.
    pub cell_weights: CellWeights,
}

impl Default for Variation {
    fn default() -> Self {
        Variation {
            genes: Vec::new(),
            grafts: Amount::Count(1.0),
            orbits: None,
            within: None,
            cell_weights: CellWeights::default(),
        }
    }
}

impl Variation {
    /// Factor on the weight of a cell; 0 if it does not stand for its orbit, or the orbit leaves the region.
    pub fn factor(&self, place: Place) -> f64 {
        let stands = self.orbits.as_ref().is_none_or(|orbits| orbits.represents(place));
        if stands { self.factor_of_orbit(place) } else { 0.0 }
    }

    /// Factor that all cells of an orbit share; without symmetries that of the cell.
    pub fn factor_of_orbit(&self, place: Place) -> f64 {
        let Some(orbits) = &self.orbits else { return self.factor_of_cell(place) };
        if self.within.is_none() && self.cell_weights.is_empty() {
            return 1.0;
        }
        let mut factors: Vec<f64> =
            orbits.images(place).into_iter().map(|image| self.factor_of_cell(image)).collect();
        if factors.contains(&0.0) {
            return 0.0;
        }
        // In one order, so that the sum is the same to the bit whichever cell carries which factor.
        factors.sort_unstable_by(f64::total_cmp);
        factors.iter().sum::<f64>() / factors.len() as f64
    }

    fn factor_of_cell(&self, place: Place) -> f64 {
        let inside = self.within.as_ref().is_none_or(|within| within.contains(place));
        if inside { self.cell_weights.of(place) } else { 0.0 }
    }

    /// Completes a mutant to which `edits` were applied: carries them through their orbits, inserts genes and
    /// carries these as well. Further edits are applied and appended.
    ///
    /// # Errors
    /// A gene that reaches beyond the deepest level, or that can't be held where it is referred to.
    pub fn complete(
        &self,
        setting: &Setting,
        forest: &mut Forest,
        edits: &mut Vec<Edit>,
        draws: &mut Draws,
    ) -> Result<(), GeneError> {
        if self.orbits.is_some() {
            self.follow(forest, faces_of(edits), edits)?;
        }
        gene::follow(&setting.mesh, &setting.catalogue, forest, edits)?;
        if self.genes.is_empty() {
            return Ok(());
        }
        // Newborn cells express themselves: no graft lies down on them.
        let newborn = edits.iter().filter(|edit| matches!(edit, Edit::Subdivide { .. })).copied();
        let mut taken: BTreeSet<u32> = faces_of(&Vec::from_iter(newborn)).into_iter().collect();
        let mirrors = Mirrors::new(&setting.catalogue);
        // Nor on what is held by reference: that changes for all instances or not at all.
        taken.extend(Instances::new(&setting.mesh, &setting.catalogue, forest)?.faces());
        let mut grafted = Vec::new();
        // Some mutants stay without, for a gene is a large step.
        let most = self.grafts.of(setting.mesh.faces().len()) as u32;
        for _ in 0..draws.below(most + 1) {
            let gene = &self.genes[draws.below(self.genes.len() as u32) as usize];
            let Some(frame) = draw_frame(setting, gene, &mirrors, draws) else { continue };
            let may_write = |place| self.factor_of_orbit(place) > 0.0;
            let placed = graft(&setting.mesh, forest, (gene, frame), &mirrors, &mut taken, may_write, edits)?;
            grafted.extend(placed.faces);
        }
        Ok(self.follow(forest, grafted, edits)?)
    }

    /// Carries what was done to some top-level cells through their orbits.
    fn follow(&self, forest: &mut Forest, faces: Vec<u32>, edits: &mut Vec<Edit>) -> Result<(), EditError> {
        self.orbits.as_ref().map_or(Ok(()), |orbits| orbits.symmetrise(forest, faces, edits))
    }
}

/// A gene that was lifted at an anchor goes to an anchor, one way round or the other; any other goes anywhere.
fn draw_frame(setting: &Setting, gene: &Patch, mirrors: &Mirrors, draws: &mut Draws) -> Option<Frame> {
    if gene.anchored {
        let anchor = setting.anchors[draws.below(setting.anchors.len() as u32) as usize];
        let frames = fitting_frames(&setting.mesh, gene, anchor, mirrors);
        return frames.get(draws.below(frames.len() as u32) as usize).copied();
    }
    let face = draws.below(setting.mesh.faces().len() as u32);
    let (turn, mirrored) = (draws.below(4) as u8, draws.below(2) == 1);
    let possible = !mirrored || gene.types().into_iter().all(|kind| mirrors.image(kind).is_some());
    Some(Frame { face, orientation: Orientation::new(turn, mirrored && possible) })
}

/// Top-level cells in which edits lie, in order, each once.
fn faces_of(edits: &[Edit]) -> Vec<u32> {
    let mut faces = Vec::new();
    for cell in edits.iter().filter_map(Edit::cell) {
        if !faces.contains(&cell.face) {
            faces.push(cell.face);
        }
    }
    faces
}
