//! Designs without their forest, and the nets that grow in them, for Python.

use crate::convert::{GroupArrays, groups, or_nan, refusal, rows};
use crate::grafting::{FrameTuple, PatchTuple, frame_tuple, patch_of, patch_tuple};
use crate::measures::measures_dict;
use crate::network::{ForceStrainCurve, NetworkArrays, values, vectors};
use crate::rigging::{Sections, pairs};
use crate::topology::{BaseMesh, Forest};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springform_evolution::phenotype::{self, PhenotypeError};
use springform_mechanics::assembly::{SpringLaw, embed};
use springform_mechanics::embedding::Embedding;
use springform_mechanics::equilibrium::Settings;
use springform_mechanics::measures::{Measures, apertures, inner_forces};
use springform_mechanics::network::{Network, Path, Sense};
use springform_mechanics::rigging::{Law, RiggingError};
use springform_mechanics::vector::Vector;
use springform_topology::address::Place;
use springform_topology::cell_type::Catalogue;
use springform_topology::edit::{Edit, EditError};
use springform_topology::expression::{Expression, ExpressionError};
use springform_topology::filters::Method;
use springform_topology::forest::{self, Content, Override};
use springform_topology::gene::{self, Gene, GeneId, Instance, Instances, Reference};
use springform_topology::notation::{parse_content, read_top_cell, write_cell, write_content};
use springform_topology::sides;
use std::collections::{BTreeMap, BTreeSet};

#[pyclass(frozen, module = "springform._core")]
pub struct Setting {
    pub setting: phenotype::Setting,
}

impl Setting {
    pub fn edits(&self, lines: &[String]) -> PyResult<Vec<Edit>> {
        lines
            .iter()
            .map(|line| Edit::parse(line, &self.setting.mesh, &self.setting.catalogue))
            .collect::<Result<_, _>>()
            .map_err(|error| refusal("edit", error))
    }

    pub fn lines(&self, edits: &[Edit]) -> Vec<String> {
        edits.iter().map(|edit| edit.write(&self.setting.catalogue)).collect()
    }

    /// Brings all instances of genes up to what edits did to one.
    fn follow(&self, forest: &mut forest::Forest, mut edits: Vec<Edit>) -> PyResult<Vec<Edit>> {
        let (mesh, catalogue) = (&self.setting.mesh, &self.setting.catalogue);
        gene::follow(mesh, catalogue, forest, &mut edits).map_err(|error| refusal("forest.cells", error))?;
        Ok(edits)
    }

    fn instances_of(&self, forest: &forest::Forest) -> PyResult<Instances> {
        let (mesh, catalogue) = (&self.setting.mesh, &self.setting.catalogue);
        Instances::new(mesh, catalogue, forest).map_err(|error| refusal("forest.cells", error))
    }
}

#[pymethods]
impl Setting {
    #[new]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        mesh: &BaseMesh,
        cell_types: Vec<(String, Vec<String>, bool, bool)>,
        genes: Vec<(String, PatchTuple)>,
        method: &str,
        anchors: Vec<u32>,
        anchor_positions: Vec<Vector>,
        drawn: Option<Vec<Vector>>,
        stiffness: f64,
        ring_factor: f64,
        sections: Sections,
        tolerance: f64,
    ) -> PyResult<Self> {
        let mut catalogue = Catalogue::default();
        for (name, springs, perimeter, fan) in &cell_types {
            let key = format!("cell_types.{name}");
            catalogue.define(name, springs, *perimeter, *fan).map_err(|error| refusal(key, error))?;
        }
        for (name, patch) in genes {
            let key = format!("genes.{name}");
            let patch = patch_of(patch, &catalogue)?;
            let gene = Gene { name, patch };
            catalogue.define_gene(gene).ok_or_else(|| refusal(key, "there are too many genes"))?;
        }
        let method = Method::parse(method).ok_or_else(|| refusal("method", "unknown method"))?;
        let mesh = mesh.mesh.clone();
        let rigging = sections.rigging(&mesh, &catalogue)?;
        let embedding = py.detach(|| match drawn {
            Some(drawn) => Embedding::drawn(&mesh, anchor_positions, drawn),
            None => embed(&mesh, &anchors, anchor_positions),
        });
        let setting = phenotype::Setting {
            mesh,
            catalogue,
            method,
            anchors,
            embedding,
            law: SpringLaw { stiffness, ring_factor },
            rigging,
            solver: Settings { tolerance, ..Settings::default() },
        };
        Ok(Setting { setting })
    }

    /// Base vertex of every anchor.
    #[getter]
    fn anchors(&self) -> Vec<u32> {
        self.setting.anchors.clone()
    }

    /// A forest: cells of `kind` subdivided to `level`, but for the cells given in notation.
    fn forest(
        &self,
        kind: &str,
        level: u8,
        cells: BTreeMap<u32, String>,
        added: Vec<String>,
        cut: Vec<String>,
    ) -> PyResult<Forest> {
        let catalogue = &self.setting.catalogue;
        let content = parse_content(kind, catalogue).map_err(|error| refusal("forest.type", error))?;
        let faces = self.setting.mesh.faces().len() as u32;
        let mut grown = forest::Forest::new(faces, content);
        let mut referred = Vec::new();
        for (&face, text) in &cells {
            let key = format!("forest.cells.{face}");
            if face >= faces {
                let problem = format!("there is no such top-level cell; the framework has {faces}, from 0");
                return Err(refusal(key, problem));
            }
            if let Some(name) = text.strip_prefix('&') {
                let reference = Reference::parse(name, catalogue).ok_or_else(|| {
                    refusal(&key, format!("'{text}' is no gene: write its name and turn, such as &crown@1m"))
                })?;
                referred.push(Edit::Refer { seed: face, reference, set: true });
                continue;
            }
            read_top_cell(&mut grown, face, text, catalogue).map_err(|error| refusal(key, error))?;
        }
        for face in (0..faces).filter(|face| !cells.contains_key(face)) {
            subdivide_to(&mut grown, Place::top(face), level, content)
                .map_err(|error| refusal("framework.level", error))?;
        }
        Edit::apply_all(&referred, &mut grown).map_err(|error| refusal("forest.cells", error))?;
        let _ = self.follow(&mut grown, referred)?;
        for (key, lines, what) in [("added", added, Override::Added), ("cut", cut, Override::Cut)] {
            for (at, pair) in
                pairs(&self.setting.mesh, &format!("overrides.{key}"), &lines)?.into_iter().enumerate()
            {
                let edit = Edit::Override { pair, what, set: true };
                edit.apply(&mut grown).map_err(|error| refusal(format!("overrides.{key}[{at}]"), error))?;
            }
        }
        Ok(Forest { forest: grown })
    }

    /// Notation of the top-level cells that differ from the default, and overrides (added, cut).
    fn notation(&self, forest: &Forest, default: &str) -> (BTreeMap<u32, String>, Vec<String>, Vec<String>) {
        let forest = &forest.forest;
        let (mesh, catalogue) = (&self.setting.mesh, &self.setting.catalogue);
        let held: BTreeSet<u32> = Instances::new(mesh, catalogue, forest)
            .map_or_else(|_| BTreeSet::new(), |all| all.faces().collect());
        let written = |face: u32| match forest.references().get(&face) {
            Some(reference) => Some(format!("&{}", reference.write(catalogue))),
            None if held.contains(&face) => None,
            None => Some(write_cell(forest, forest.top(face), catalogue)).filter(|text| text != default),
        };
        let cells = (0..forest.top_level()).filter_map(|face| Some((face, written(face)?))).collect();
        let (mut added, mut cut) = (Vec::new(), Vec::new());
        for (pair, what) in forest.overrides() {
            let [a, b] = pair.keys();
            let list = if *what == Override::Added { &mut added } else { &mut cut };
            list.push(format!("{a} {b}"));
        }
        (cells, added, cut)
    }

    /// A forest changed by edits, each a line of text.
    fn edited(&self, forest: &Forest, edits: Vec<String>) -> PyResult<Forest> {
        self.followed(forest, edits).map(|(forest, _)| forest)
    }

    /// The same, and all that was done: what the edits do to an instance of a gene is done to the others.
    fn followed(&self, forest: &Forest, edits: Vec<String>) -> PyResult<(Forest, Vec<String>)> {
        let mut forest = forest.forest.clone();
        let edits = self.edits(&edits)?;
        Edit::apply_all(&edits, &mut forest).map_err(|error| refusal("edit", error))?;
        let all = self.follow(&mut forest, edits)?;
        Ok((Forest { forest }, self.lines(&all)))
    }

    /// Notation of a top-level cell as it stands, whether or not a gene holds it.
    fn tree(&self, forest: &Forest, face: u32) -> PyResult<String> {
        if face >= forest.forest.top_level() {
            return Err(refusal("cell", format!("cell {face} does not exist")));
        }
        Ok(write_cell(&forest.forest, forest.forest.top(face), &self.setting.catalogue))
    }

    /// Genes with their cells as a forest holds them, in the order of their numbers.
    fn genes(&self, forest: &Forest) -> PyResult<Vec<(String, PatchTuple)>> {
        let (setting, forest) = (&self.setting, &forest.forest);
        let instances = self.instances_of(forest)?;
        let gene = |(number, gene): (u16, &Gene)| {
            let now = instances.content(forest, &setting.catalogue, GeneId(number));
            (gene.name.clone(), patch_tuple(now.as_ref().unwrap_or(&gene.patch), &setting.catalogue))
        };
        Ok((0..).zip(setting.catalogue.genes()).map(gene).collect())
    }

    /// (gene, frame, top-level cells) of everything that a forest holds by reference.
    fn instances(&self, forest: &Forest) -> PyResult<Vec<(String, FrameTuple, Vec<u32>)>> {
        let row = |one: &Instance| {
            let name = self.setting.catalogue.gene(one.gene).name.clone();
            (name, frame_tuple(one.frame), one.cells.iter().map(|cell| cell.face).collect())
        };
        Ok(self.instances_of(&forest.forest)?.list.iter().map(row).collect())
    }

    /// Type and turn, switch, and whether children are stored, of the cell at an address.
    fn cell(&self, forest: &Forest, address: &str) -> PyResult<(String, bool, bool)> {
        let place = Place::parse(address).map_err(|error| refusal("cell", error))?;
        let cell = forest
            .forest
            .find(place)
            .ok_or_else(|| refusal("cell", format!("cell {address} does not exist")))?;
        let content = write_content(forest.forest.content(cell), &self.setting.catalogue);
        Ok((content, forest.forest.is_on(cell), forest.forest.children(cell).is_some()))
    }

    /// A closed copy of a forest and the edits that closing took.
    fn closed(&self, forest: &Forest) -> PyResult<(Forest, Vec<String>)> {
        let mut forest = forest.forest.clone();
        let edits = self.setting.close(&mut forest).map_err(|error| refusal("forest", error))?;
        Ok((Forest { forest }, self.lines(&edits)))
    }

    /// The same edit the other way, for each line, last first.
    fn inverse(&self, edits: Vec<String>) -> PyResult<Vec<String>> {
        Ok(self.lines(&Edit::invert_all(&self.edits(&edits)?)))
    }

    /// Base vertices' drawn positions, (v, 3) m.
    fn drawn<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, self.setting.embedding.base_positions().to_vec())
    }

    /// The net of a closed forest: what it consists of, and its network's arrays by name.
    fn grow<'py>(slf: Bound<'py, Self>, forest: &Forest) -> PyResult<(Net, Bound<'py, PyDict>)> {
        let (py, setting) = (slf.py(), &slf.get().setting);
        let (expression, network) =
            py.detach(|| setting.grow(&forest.forest)).map_err(|error| growth_refusal(&error))?;
        let arrays = network_dict(py, network)?;
        let (laws, areas) = spring_kinds(setting, &expression);
        arrays.set_item("law", PyArray1::from_vec(py, laws))?;
        arrays.set_item("area", PyArray1::from_vec(py, areas))?;
        Ok((Net { expression, setting: slf.unbind() }, arrays))
    }

    /// Expressed cells that share an edge with the expressed cell at an address.
    fn neighbours(&self, forest: &Forest, address: &str) -> PyResult<Vec<String>> {
        let place = Place::parse(address).map_err(|error| refusal("cell", error))?;
        let cells = sides::expressed_neighbours(&self.setting.mesh, &forest.forest, place);
        Ok(cells.into_iter().map(|cell| cell.to_string()).collect())
    }

    /// Checks that the method allows a cell type, and returns its canonical word.
    fn cell_type(&self, word: &str) -> PyResult<String> {
        let (catalogue, method) = (&self.setting.catalogue, self.setting.method);
        let kind = catalogue.find(word).ok_or_else(|| {
            refusal("types", format!("there is no cell type '{word}'; use 0-6 or a defined name"))
        })?;
        if !method.allows(kind, catalogue) {
            let problem =
                format!("method {} allows {}, not type {word}", method.name(), method.allowed_words());
            return Err(refusal("types", problem));
        }
        Ok(catalogue.word(kind))
    }
}

/// Nodes, springs and cells of a grown net.
#[pyclass(frozen, module = "springform._core")]
pub struct Net {
    expression: Expression,
    setting: Py<Setting>,
}

#[pymethods]
impl Net {
    /// Key of every node.
    #[getter]
    fn nodes(&self) -> Vec<String> {
        self.expression.nodes.iter().map(ToString::to_string).collect()
    }

    /// Node of every anchor.
    #[getter]
    fn anchors<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        PyArray1::from_slice(py, &self.expression.anchors)
    }

    /// Which springs lie along a free ring or rim.
    #[getter]
    fn ring<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_iter(py, self.expression.springs.iter().map(|spring| spring.ring))
    }

    /// Addresses of the expressed cells.
    #[getter]
    fn cells(&self) -> Vec<String> {
        self.expression.cells.iter().map(|cell| cell.place.to_string()).collect()
    }

    /// Face, level, column and row of every expressed cell.
    #[getter]
    fn cell_squares<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let square = |place: Place| [place.face, u32::from(place.level), place.i, place.j];
        rows(py, self.expression.cells.iter().map(|cell| square(cell.place)).collect())
    }

    /// Types of the expressed cells, as expressed.
    #[getter]
    fn cell_types(&self) -> Vec<String> {
        let catalogue = &self.setting.get().setting.catalogue;
        self.expression.cells.iter().map(|cell| catalogue.word(cell.content.kind)).collect()
    }

    #[getter]
    fn cell_springs<'py>(&self, py: Python<'py>) -> GroupArrays<'py> {
        groups(py, &self.expression.cell_springs)
    }

    #[getter]
    fn spring_cells<'py>(&self, py: Python<'py>) -> GroupArrays<'py> {
        groups(py, &self.expression.spring_cells)
    }

    #[getter]
    fn cell_boundaries<'py>(&self, py: Python<'py>) -> GroupArrays<'py> {
        groups(py, &self.expression.cell_boundaries)
    }

    /// Sum of spring forces of every expressed cell, N.
    fn inner_forces<'py>(
        &self,
        py: Python<'py>,
        forces: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let forces = values("forces", &forces)?;
        if forces.len() < self.expression.springs.len() {
            return Err(refusal("forces", "these are results of another net"));
        }
        Ok(PyArray1::from_vec(py, inner_forces(&self.expression, forces)))
    }

    /// Measures and apertures of the net's network at given positions and forces.
    fn measure<'py>(
        &self,
        py: Python<'py>,
        network: NetworkArrays<'py>,
        positions: PyReadonlyArray2<'py, f64>,
        forces: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let network = network.network()?;
        let (positions, forces) = (vectors("positions", &positions)?, values("forces", &forces)?);
        let expression = &self.expression;
        if positions.len() != expression.nodes.len()
            || forces.len() != network.springs.len()
            || forces.len() < expression.springs.len()
        {
            return Err(refusal("positions", "these are results of another net"));
        }
        let mesh = &self.setting.get().setting.mesh;
        let (measures, openings) = py.detach(|| {
            let measures = Measures::new(expression, &network, positions, forces);
            (measures, apertures(mesh, expression, positions))
        });
        let result = measures_dict(py, &measures)?;
        let openings: Vec<_> = openings
            .into_iter()
            .map(|one| (one.part, one.side.name(), one.perimeter, one.area, one.normal))
            .collect();
        result.set_item("apertures", openings)?;
        Ok(result)
    }
}

/// Arrays of a network by name, as [`NetworkArrays`] takes them.
fn network_dict<'py>(py: Python<'py>, network: Network<'static>) -> PyResult<Bound<'py, PyDict>> {
    let curves: Vec<ForceStrainCurve> =
        network.curves.iter().map(|curve| ForceStrainCurve { curve: curve.clone() }).collect();
    let rods: Vec<_> = network
        .rods
        .iter()
        .map(|rod| (rod.nodes.clone(), rod.bending_stiffness, rod.closed, rod.lengths.clone()))
        .collect();
    let pressure: Vec<_> = network
        .pressure
        .values
        .iter()
        .zip(0..)
        .map(|(&value, cell)| (network.pressure.cells.of(cell).to_vec(), value))
        .collect();
    let slides: Vec<_> = network
        .slides
        .iter()
        .map(|slide| match slide.path {
            Path::Line(along) => (slide.node, false, along),
            Path::Plane(normal) => (slide.node, true, normal),
        })
        .collect();
    let senses = network.sense.iter().map(|sense| match sense {
        Sense::Tension => 1i8,
        Sense::Both => 0,
        Sense::Compression => -1,
    });
    let arrays = PyDict::new(py);
    arrays.set_item("sense", PyArray1::from_iter(py, senses))?;
    arrays.set_item("curves", curves)?;
    arrays.set_item("rods", rods)?;
    arrays.set_item("pressure", pressure)?;
    arrays.set_item("slides", slides)?;
    arrays.set_item("positions", rows(py, network.positions.into_owned())?)?;
    arrays.set_item("springs", rows(py, network.springs.into_owned())?)?;
    arrays.set_item("fixed_axes", rows(py, network.fixed.into_owned())?)?;
    arrays.set_item("stiffness", PyArray1::from_vec(py, network.stiffness.into_owned()))?;
    arrays.set_item("rest_length", PyArray1::from_vec(py, network.rest_length.into_owned()))?;
    arrays.set_item("force", PyArray1::from_vec(py, network.force.into_owned()))?;
    arrays.set_item("curve", PyArray1::from_vec(py, network.curve.into_owned()))?;
    arrays.set_item("self_weight", PyArray1::from_vec(py, network.weight.into_owned()))?;
    arrays.set_item("loads", rows(py, network.loads.into_owned())?)?;
    Ok(arrays)
}

/// Law of every spring of the network, by name, and area of its cross-section [m²], NaN where unknown.
fn spring_kinds(setting: &phenotype::Setting, expression: &Expression) -> (Vec<u8>, Vec<f64>) {
    let rigging = &setting.rigging;
    let properties = rigging.properties(&setting.mesh, expression);
    let law = |law: Option<Law>| match law {
        None | Some(Law::Stiffness(_)) => 0u8,
        Some(Law::AxialStiffness(_)) => 1,
        Some(Law::ForceDensity(_)) => 2,
        Some(Law::Force(_)) => 3,
        Some(Law::Curve(_)) => 4,
    };
    let mut laws: Vec<u8> = properties.iter().map(|one| law(one.law)).collect();
    let mut areas: Vec<f64> = properties.iter().map(|one| or_nan(one.area)).collect();
    for rod in &rigging.rods {
        let links = rod.links(&setting.mesh, expression);
        laws.extend(std::iter::repeat_n(1, links));
        areas.extend(std::iter::repeat_n(or_nan(rod.area), links));
    }
    (laws, areas)
}

/// The key of what kept a net from growing, and what to do.
fn growth_refusal(error: &PhenotypeError) -> PyErr {
    match error {
        PhenotypeError::Rigging(RiggingError { key, problem }) => refusal(key, problem),
        PhenotypeError::Expression(ExpressionError::LooseAnchor(anchor)) => {
            let problem = "the anchor is left without springs after filtering; keep a path to another one";
            refusal(format!("framework.anchors[{anchor}]"), problem)
        }
        PhenotypeError::Expression(error @ ExpressionError::Type { place, .. }) => {
            refusal(format!("forest.cells.{}", place.face), error)
        }
        error => refusal("forest", error),
    }
}

fn subdivide_to(
    forest: &mut forest::Forest,
    place: Place,
    level: u8,
    content: Content,
) -> Result<(), EditError> {
    if place.level == level {
        return Ok(());
    }
    Edit::Subdivide { cell: place, children: [content; 4] }.apply(forest)?;
    (0..4).try_for_each(|k| subdivide_to(forest, place.child(k), level, content))
}
