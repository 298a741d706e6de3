//! The census of a run's patches for Python.

use crate::evolution::Evolution;
use crate::grafting::{PatchTuple, Selection, patch_tuple};
use crate::setting::Setting;
use pyo3::prelude::*;
use springform_evolution::census::{self, Site};
use springform_topology::cell_type::Catalogue;

/// (patch, carriers, sum of their scores, (generation, individual) of the best).
type Row = (PatchTuple, u32, f64, (u32, u32));

#[pyclass(module = "springform._core")]
pub struct Census {
    census: census::Census,
    catalogue: Catalogue,
}

#[pymethods]
impl Census {
    /// Takes sites (base vertex, whether it is an anchor, cells).
    #[new]
    fn new(setting: &Setting, sites: Vec<(u32, bool, PyRef<'_, Selection>)>) -> Self {
        let site = |(vertex, anchored, cells): (u32, bool, PyRef<'_, Selection>)| Site {
            vertex,
            anchored,
            selection: cells.selection.clone(),
        };
        let sites = sites.into_iter().map(site).collect();
        let census = census::Census::new(&setting.setting, sites);
        Census { census, catalogue: setting.setting.catalogue.clone() }
    }

    /// Counts the individuals of the next generation; `None` stands for one without a score.
    fn count(&mut self, py: Python<'_>, evolution: &Evolution, scores: Vec<Option<f64>>) {
        py.detach(|| self.census.count(evolution.inner(), &scores));
    }

    /// Patches that at least `least` individuals carry, best first.
    fn ranked(&self, least: u32) -> Vec<Row> {
        let row = |(patch, tally): (&springform_topology::patch::Patch, census::Tally)| {
            (patch_tuple(patch, &self.catalogue), tally.individuals, tally.score, tally.best)
        };
        self.census.ranked(least).into_iter().map(row).collect()
    }
}
