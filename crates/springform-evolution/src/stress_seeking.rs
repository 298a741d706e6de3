//! Direct stress-seeking: subdivide the cell of highest inner force, solve, repeat (the paper §3.5, §4.1).

use crate::phenotype::{Phenotype, PhenotypeError, Setting};
use springform_topology::MAX_LEVEL;
use springform_topology::cell_type::CellTypeId;
use springform_topology::edit::{Edit, EditError};
use springform_topology::forest::{Content, Forest};
use springform_topology::gene;
use springform_topology::symmetry::Orbits;

/// A net that is refined where its force is.
#[derive(Clone, Debug)]
pub struct StressSeeking {
    forest: Forest,
    phenotype: Phenotype,
}

impl StressSeeking {
    /// The net before the first step.
    ///
    /// # Errors
    /// The forest gives no net.
    pub fn new(setting: &Setting, mut forest: Forest) -> Result<Self, PhenotypeError> {
        setting.close(&mut forest)?;
        let phenotype = setting.evaluate(&forest)?;
        Ok(StressSeeking { forest, phenotype })
    }

    /// The forest now.
    pub fn forest(&self) -> &Forest {
        &self.forest
    }

    /// The net now.
    pub fn phenotype(&self) -> &Phenotype {
        &self.phenotype
    }

    /// Subdivides the cell of highest inner force, the first among equals, into children of one type; a cell
    /// whose subdivision is stored but off is switched on. With orbits, which the forest has to have, the whole orbit
    /// of that cell is subdivided. Returns the edits; none if no cell can be subdivided.
    ///
    /// # Errors
    /// The refined forest gives no net; the state is then as before.
    pub fn advance(
        &mut self,
        setting: &Setting,
        kind: CellTypeId,
        orbits: Option<&Orbits>,
    ) -> Result<Vec<Edit>, PhenotypeError> {
        let inner = self.phenotype.inner_forces();
        let cells = &self.phenotype.expression.cells;
        let mut hottest: Option<usize> = None;
        for (at, cell) in cells.iter().enumerate() {
            if cell.place.level < MAX_LEVEL && hottest.is_none_or(|best| inner[at] > inner[best]) {
                hottest = Some(at);
            }
        }
        let Some(at) = hottest else { return Ok(Vec::new()) };
        let hottest = cells[at].place;
        let cell = orbits.map_or(hottest, |orbits| orbits.representative(hottest));
        let index = self.forest.find(cell).ok_or(EditError::NoCell(cell))?;
        let mut edits = vec![match self.forest.children(index) {
            Some(_) => Edit::Toggle { cell, on: true },
            None => Edit::Subdivide { cell, children: [Content { kind, turn: 0 }; 4] },
        }];
        let mut forest = self.forest.clone();
        Edit::apply_all(&edits, &mut forest)?;
        if let Some(orbits) = orbits {
            orbits.symmetrise(&mut forest, [cell.face], &mut edits)?;
        }
        gene::follow(&setting.mesh, &setting.catalogue, &mut forest, &mut edits)?;
        edits.extend(setting.close(&mut forest)?);
        self.phenotype = setting.evaluate(&forest)?;
        self.forest = forest;
        Ok(edits)
    }
}
