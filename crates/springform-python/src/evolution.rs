//! Runs and stress-seeking for Python.

use crate::convert::{or_nan, refusal};
use crate::grafting::{PatchTuple, Selection as Region, Symmetries, patch_of};
use crate::measures::{columns, measures_dict};
use crate::setting::Setting;
use crate::topology::Forest;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springform_evolution::cell_weights::CellWeights;
use springform_evolution::ending::Ending;
use springform_evolution::evolve::{self, Generation, Parameters, Selection};
use springform_evolution::fitness::{Criterion, Fitness, Standing, SufReference};
use springform_evolution::mutation::{Amount, Strategy};
use springform_evolution::selection::{Weighting, WeightingParameters};
use springform_evolution::stress_seeking;
use springform_evolution::variation::Variation;
use springform_evolution::workspace::Workspace;
use springform_mechanics::measures::Measures;
use springform_mechanics::stage::STAGES;
use springform_topology::address::Place;
use springform_topology::cell_type::CellTypeId;
use springform_topology::patch::Patch;
use springform_topology::symmetry::Orbits;
use std::time::Instant;

/// (insertions, switches, toggles) as (is a share, number) each, and the weighting.
type StrategyTuple = ((bool, f64), (bool, f64), (bool, f64), String);

/// (generation, (springs, differential) of the start, SUF of the parent) of a run that is picked up.
type Resumed = (u32, (u32, Option<f64>), Option<f64>);

fn amount((share, number): (bool, f64)) -> Amount {
    if share { Amount::Share(number) } else { Amount::Count(number) }
}

fn amount_tuple(amount: Amount) -> (bool, f64) {
    match amount {
        Amount::Count(count) => (false, count),
        Amount::Share(share) => (true, share),
    }
}

fn strategy((insertions, switches, toggles, weighting): StrategyTuple) -> PyResult<Strategy> {
    Ok(Strategy {
        insertions: amount(insertions),
        switches: amount(switches),
        toggles: amount(toggles),
        weighting: self::weighting(&weighting)?,
    })
}

fn strategy_tuple(strategy: &Strategy) -> StrategyTuple {
    (
        amount_tuple(strategy.insertions),
        amount_tuple(strategy.switches),
        amount_tuple(strategy.toggles),
        strategy.weighting.name().to_owned(),
    )
}

fn weighting(name: &str) -> PyResult<Weighting> {
    Weighting::parse(name).ok_or_else(|| refusal("weighting", format!("unknown weighting '{name}'")))
}

fn cell_weights(setting: &Setting, factors: Vec<(String, f64)>) -> PyResult<CellWeights> {
    let faces = setting.setting.mesh.faces().len();
    let parse = |(address, factor): (String, f64)| {
        let key = || format!("cell_weights.{address}");
        let place = Place::parse(&address).map_err(|error| refusal(key(), error))?;
        if place.face as usize >= faces {
            return Err(refusal(key(), format!("there is no such cell; there are {faces}, from 0")));
        }
        Ok((place, factor))
    };
    Ok(CellWeights::new(factors.into_iter().map(parse).collect::<PyResult<Vec<_>>>()?))
}

#[pyclass(module = "springform._core")]
pub struct Evolution {
    evolution: evolve::Evolution,
}

#[pymethods]
impl Evolution {
    #[new]
    #[allow(clippy::too_many_arguments)]
    #[pyo3(signature = (setting, forest, *, population, seed, types, strategy, base, exponent, self_adapt,
        fitness, suf_reference, niche, min_length, min_springs, max_springs, selection, threads, genes=vec![],
        grafts=(false, 1.0), symmetries=None, within=None, cell_weights=vec![], resumed=None))]
    fn new(
        py: Python<'_>,
        setting: &Setting,
        forest: &Forest,
        population: u32,
        seed: u64,
        types: Vec<String>,
        strategy: StrategyTuple,
        base: f64,
        exponent: f64,
        self_adapt: bool,
        fitness: &str,
        suf_reference: &str,
        niche: Option<u32>,
        min_length: Option<f64>,
        min_springs: Option<u32>,
        max_springs: Option<u32>,
        selection: &str,
        threads: usize,
        genes: Vec<PatchTuple>,
        grafts: (bool, f64),
        symmetries: Option<&Symmetries>,
        within: Option<&Region>,
        cell_weights: Vec<(String, f64)>,
        resumed: Option<Resumed>,
    ) -> PyResult<Self> {
        let unknown = |key: &str, word: &str| refusal(key, format!("unknown {key} '{word}'"));
        let types = types
            .iter()
            .map(|word| setting.setting.catalogue.find(word).ok_or_else(|| unknown("types", word)))
            .collect::<PyResult<Vec<_>>>()?;
        let genes = genes
            .into_iter()
            .map(|gene| patch_of(gene, &setting.setting.catalogue))
            .collect::<PyResult<Vec<_>>>()?;
        let drawn: Vec<_> = types.iter().copied().chain(genes.iter().flat_map(Patch::types)).collect();
        let orbits = symmetries.map(|group| group.orbits(setting, &drawn, forest)).transpose()?;
        let within = within.map(|within| within.selection.clone());
        let cell_weights = self::cell_weights(setting, cell_weights)?;
        let fitness = match fitness {
            "suf" => Fitness::Suf,
            "differential" => Fitness::Differential,
            _ => return Err(unknown("fitness", fitness)),
        };
        let reference = match suf_reference {
            "start" => SufReference::Start,
            "parent" => SufReference::Parent,
            "zero" => SufReference::Zero,
            _ => return Err(unknown("suf_reference", suf_reference)),
        };
        let selection = match selection {
            "comma" => Selection::Comma,
            "plus" => Selection::Plus,
            _ => return Err(unknown("selection", selection)),
        };
        let parameters = Parameters {
            population,
            seed,
            types,
            weights: WeightingParameters { base, exponent },
            self_adapt,
            criterion: Criterion { fitness, reference, niche, min_length, min_springs, max_springs },
            selection,
            variation: Variation { genes, grafts: amount(grafts), orbits, within, cell_weights },
        };
        let strategy = self::strategy(strategy)?;
        let resumed = resumed.map(|(generation, (springs, differential), suf)| {
            (generation, Standing { springs, differential }, suf)
        });
        let (setting, forest) = (setting.setting.clone(), forest.forest.clone());
        let evolution = py
            .detach(|| evolve::Evolution::new(setting, parameters, forest, strategy, resumed, threads))
            .map_err(|error| refusal("forest", error))?;
        Ok(Evolution { evolution })
    }

    /// Makes one generation: columns of measures by name, the winner, its edits and strategy.
    fn advance<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let evolution = &mut self.evolution;
        let mut signal = Ok(());
        let generation = py.detach(|| {
            evolution.advance_while(|| {
                signal = Python::attach(|py| py.check_signals());
                signal.is_ok()
            })
        });
        signal?;
        let generation = generation.map_err(|error| refusal("forest", error))?;
        let Some(generation) = generation else {
            return Err(refusal("signal", "the generation was given up"));
        };
        let result = PyDict::new(py);
        result.set_item("columns", table(py, &generation)?)?;
        result.set_item("winner", generation.winner)?;
        let edits = generation.winner.map_or(&[][..], |index| &generation.individuals[index].edits);
        result.set_item("edits", self.lines(edits))?;
        result.set_item("strategy", strategy_tuple(&self.evolution.parent().strategy))?;
        result.set_item("suf", self.evolution.parent().suf)?;
        Ok(result)
    }

    /// Edits that make an individual of the next generation from the parent now, closure included.
    fn individual(&self, py: Python<'_>, index: u32) -> Vec<String> {
        let number = self.evolution.generation() + 1;
        let individual = py.detach(|| self.evolution.individual(number, index));
        self.lines(&individual.edits)
    }

    /// Makes the first individuals of the next generation one after the other, and again round after round; the seconds
    /// that each stage took, by name, an array with a row a round. The run stays where it is.
    fn stages<'py>(&self, py: Python<'py>, count: u32, rounds: usize) -> PyResult<Bound<'py, PyDict>> {
        let spent = py.detach(|| {
            let mut workspace = Workspace::default();
            let mut round = || stage_seconds(&self.evolution, count, &mut workspace);
            (0..rounds).map(|_| round()).collect::<Vec<_>>()
        });
        let result = PyDict::new(py);
        for (stage, name) in STAGES {
            let seconds = spent.iter().map(|round| round[stage as usize]);
            result.set_item(name, PyArray1::from_iter(py, seconds))?;
        }
        Ok(result)
    }

    /// The ending condition that holds now, by name.
    fn reached(
        &self,
        generations: Option<u32>,
        springs: Option<u32>,
        differential: Option<f64>,
        suf: Option<f64>,
    ) -> Option<&'static str> {
        let ending = Ending { generations, springs, differential, suf };
        self.evolution.reached(&ending).map(|reason| reason.name())
    }

    /// Closed genotype of the parent now.
    #[getter]
    fn forest(&self) -> Forest {
        Forest { forest: self.evolution.parent().forest.clone() }
    }

    /// Measures of the parent now.
    #[getter]
    fn measures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        measures_dict(py, &self.evolution.parent().measures)
    }

    #[getter]
    fn generation(&self) -> u32 {
        self.evolution.generation()
    }

    /// (springs, force differential) of the start of the run.
    #[getter]
    fn start(&self) -> (u32, Option<f64>) {
        let start = self.evolution.start();
        (start.springs, start.differential)
    }
}

impl Evolution {
    /// What it converts.
    pub fn inner(&self) -> &evolve::Evolution {
        &self.evolution
    }

    fn lines(&self, edits: &[springform_topology::edit::Edit]) -> Vec<String> {
        let catalogue = &self.evolution.setting().catalogue;
        edits.iter().map(|edit| edit.write(catalogue)).collect()
    }
}

/// Seconds that each stage of the first individuals of the next generation takes.
fn stage_seconds(
    evolution: &evolve::Evolution,
    count: u32,
    workspace: &mut Workspace,
) -> [f64; STAGES.len()] {
    let mut spent = [0.0; STAGES.len()];
    let mut last = Instant::now();
    for index in 0..count {
        evolution.individual_in(evolution.generation() + 1, index, workspace, &mut |stage| {
            let now = Instant::now();
            spent[stage as usize] += (now - last).as_secs_f64();
            last = now;
        });
    }
    spent
}

/// One array a column, one row an individual; undefined numbers are NaN.
fn table<'py>(py: Python<'py>, generation: &Generation) -> PyResult<Bound<'py, PyDict>> {
    let individuals = &generation.individuals;
    let measured = |index: usize| individuals[index].measures.as_ref();
    let count = individuals.len();
    let result = PyDict::new(py);
    let whole = |read: fn(&Measures) -> u32| {
        PyArray1::from_iter(py, (0..count).map(|index| measured(index).map_or(0, read)))
    };
    result.set_item("springs", whole(|measures| measures.springs))?;
    result.set_item("nodes", whole(|measures| measures.nodes))?;
    result.set_item("cells", whole(|measures| measures.cells))?;
    let number = |read: &dyn Fn(usize) -> Option<f64>| {
        PyArray1::from_iter(py, (0..count).map(|index| or_nan(read(index))).collect::<Vec<_>>())
    };
    result.set_item("force_differential", number(&|i| measured(i).and_then(|m| m.force_differential)))?;
    result.set_item("suf", number(&|index| individuals[index].suf))?;
    for (at, name) in COLUMN_NAMES.iter().enumerate() {
        result.set_item(*name, number(&|index| measured(index).map(|measures| columns(measures)[at].1)))?;
    }
    result.set_item("residual", number(&|index| individuals[index].residual))?;
    result.set_item("valid", PyArray1::from_iter(py, (0..count).map(|index| measured(index).is_some())))?;
    let edits = individuals.iter().map(|individual| individual.edits.len() as u32);
    result.set_item("edits", PyArray1::from_iter(py, edits))?;
    let fingerprints = individuals.iter().map(|individual| individual.fingerprint);
    result.set_item("fingerprint", PyArray1::from_iter(py, fingerprints))?;
    Ok(result)
}

/// Names of [`columns`], in order.
const COLUMN_NAMES: [&str; 11] = [
    "force_min",
    "force_max",
    "force_mean",
    "force_deviation",
    "force_variation",
    "force_range",
    "total_length",
    "load_path",
    "area",
    "shortest_spring",
    "length_per_area",
];

#[pyclass(module = "springform._core")]
pub struct StressSeeking {
    seeking: stress_seeking::StressSeeking,
    setting: Py<Setting>,
    kind: CellTypeId,
    orbits: Option<Orbits>,
    start: Standing,
}

#[pymethods]
impl StressSeeking {
    /// Children get type `kind`; with symmetries, which the forest has to have, whole orbits are subdivided.
    #[new]
    #[pyo3(signature = (setting, forest, kind, *, symmetries=None))]
    fn new(
        py: Python<'_>,
        setting: Py<Setting>,
        forest: &Forest,
        kind: &str,
        symmetries: Option<&Symmetries>,
    ) -> PyResult<Self> {
        let inner = &setting.get().setting;
        let found = inner.catalogue.find(kind);
        let kind = found.ok_or_else(|| refusal("type", format!("there is no cell type '{kind}'")))?;
        let orbits = symmetries.map(|group| group.orbits(setting.get(), &[kind], forest)).transpose()?;
        let seeking = py
            .detach(|| stress_seeking::StressSeeking::new(inner, forest.forest.clone()))
            .map_err(|error| refusal("forest", error))?;
        let start = Standing::from(&seeking.phenotype().measures);
        Ok(StressSeeking { seeking, setting, kind, orbits, start })
    }

    /// Subdivides the cell of highest inner force; the edits, none if no cell is left to divide.
    fn advance(&mut self, py: Python<'_>) -> PyResult<Vec<String>> {
        let setting = self.setting.get();
        let (seeking, kind, orbits) = (&mut self.seeking, self.kind, self.orbits.as_ref());
        let edits = py
            .detach(|| seeking.advance(&setting.setting, kind, orbits))
            .map_err(|error| refusal("forest", error))?;
        Ok(setting.lines(&edits))
    }

    /// The ending condition that holds after `step` steps, by name.
    fn reached(
        &self,
        step: u32,
        steps: Option<u32>,
        differential: Option<f64>,
        suf: Option<f64>,
    ) -> Option<&'static str> {
        let ending = Ending { generations: steps, springs: None, differential, suf };
        let now = Standing::from(&self.seeking.phenotype().measures);
        ending.reached(step, self.start, now, self.suf()).map(|reason| reason.name())
    }

    /// Spring utilization factor against the start.
    #[getter]
    fn suf(&self) -> Option<f64> {
        let measures = &self.seeking.phenotype().measures;
        let reference = (self.start.differential, self.start.springs);
        springform_mechanics::measures::spring_utilization(measures, reference)
    }

    #[getter]
    fn forest(&self) -> Forest {
        Forest { forest: self.seeking.forest().clone() }
    }

    #[getter]
    fn measures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        measures_dict(py, &self.seeking.phenotype().measures)
    }
}
