//! A census of patches: which recur in a run, and how the individuals that carry them fared (the paper §5, "the
//! ability to identify successful gene sets").
//!
//! Patches round anchors and along seams are lifted from every individual, seen from their vertex and the way
//! round in which they are described in the least words, so that the same one counts as the same wherever it stands.

use crate::evolve::Evolution;
use crate::phenotype::Setting;
use springform_topology::edit::Edit;
use springform_topology::forest::Forest;
use springform_topology::orientation::{Frame, Mirrors, Orientation};
use springform_topology::patch::{Patch, Viewpoint, lift};
use springform_topology::selection::Selection;
use std::collections::{BTreeMap, BTreeSet};

/// A place at which patches are looked for.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Site {
    /// The base vertex from which they are seen.
    pub vertex: u32,
    /// It is an anchor.
    pub anchored: bool,
    /// The cells that count.
    pub selection: Selection,
}

/// What is known of a patch.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Tally {
    /// Individuals that carry it.
    pub individuals: u32,
    /// Sum of their scores; less is better.
    pub score: f64,
    /// Generation and index of the carrier with the lowest score, the first among equals.
    pub best: (u32, u32),
    /// Its score.
    pub lowest: f64,
}

/// Patches and their carriers.
#[derive(Clone, PartialEq, Debug)]
pub struct Census {
    sites: Vec<Site>,
    mirrors: Mirrors,
    tallies: BTreeMap<Patch, Tally>,
}

impl Census {
    /// A census that has counted nobody.
    pub fn new(setting: &Setting, sites: Vec<Site>) -> Census {
        Census { sites, mirrors: Mirrors::new(&setting.catalogue), tallies: BTreeMap::new() }
    }

    /// Counts the individuals of the next generation of a run; those without a score are left out.
    pub fn count(&mut self, evolution: &Evolution, scores: &[Option<f64>]) {
        let setting = evolution.setting();
        let parent = &evolution.parent().forest;
        let inherited: Vec<_> = self.sites.iter().map(|site| self.patch_at(setting, parent, site)).collect();
        let generation = evolution.generation() + 1;
        for (index, &score) in (0u32..).zip(scores) {
            let Some(score) = score else { continue };
            let Some((forest, edits)) = evolution.genotype(generation, index) else { continue };
            let touched: BTreeSet<u32> = edits.iter().filter_map(Edit::cell).map(|cell| cell.face).collect();
            let mut carried = BTreeSet::new();
            for (site, inherited) in self.sites.iter().zip(&inherited) {
                if site.selection.faces().is_disjoint(&touched) {
                    carried.extend(inherited.clone());
                } else {
                    carried.extend(self.patch_at(setting, &forest, site));
                }
            }
            for patch in carried {
                let first = Tally { individuals: 0, score: 0.0, best: (generation, index), lowest: score };
                let tally = self.tallies.entry(patch).or_insert(first);
                tally.individuals += 1;
                tally.score += score;
                if score < tally.lowest {
                    (tally.best, tally.lowest) = ((generation, index), score);
                }
            }
        }
    }

    /// The patches that at least `least` individuals carry, best first.
    ///
    /// They are ranked by the sum of their carriers' scores over the square root of their number, which grows with
    /// how well they fared and with how sure that is; `least` individuals of score zero are added to all.
    pub fn ranked(&self, least: u32) -> Vec<(&Patch, Tally)> {
        let rank = |tally: &Tally| tally.score / f64::from(tally.individuals + least).sqrt();
        let recurring = self.tallies.iter().filter(|(_, tally)| tally.individuals >= least);
        let mut ranked: Vec<_> = recurring.map(|(patch, tally)| (patch, *tally)).collect();
        ranked.sort_by(|a, b| rank(&a.1).total_cmp(&rank(&b.1)).then_with(|| a.0.cmp(b.0)));
        ranked
    }

    /// The patch at a site; `None` if nothing in it is divided.
    fn patch_at(&self, setting: &Setting, forest: &Forest, site: &Site) -> Option<Patch> {
        let lifted = |viewpoint| lift(&setting.mesh, forest, &site.selection, viewpoint, &self.mirrors).ok();
        let straight = lifted(Viewpoint::Vertex(site.vertex))?;
        let Frame { face, orientation } = straight.frame;
        let round = Frame { face, orientation: Orientation::new(orientation.turn, true) };
        let mirrored = lifted(Viewpoint::Frame(round)).filter(|other| other.left_out == straight.left_out);
        let patch = mirrored.map_or(straight.patch.clone(), |other| other.patch.min(straight.patch));
        let divided = patch.stored() > patch.cells.len();
        divided.then_some(Patch { anchored: site.anchored, ..patch })
    }
}
