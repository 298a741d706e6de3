//! Settings, bare networks and solvers for Python.

use crate::convert::{GroupArrays, groups, refusal, rows};
use crate::topology::{BaseMesh, Forest};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springform_evolution::phenotype;
use springform_mechanics::embedding::Embedding;
use springform_mechanics::equilibrium::{self, Equilibrium, Settings, Status, implicit_euler};
use springform_mechanics::measures::{Measures, apertures, inner_forces};
use springform_mechanics::network::{Network, SpringLaw};
use springform_mechanics::vector::Vector;
use springform_topology::cell_type::Catalogue;
use springform_topology::edit::{Edit, EditError};
use springform_topology::expression::Expression;
use springform_topology::filters::Method;
use springform_topology::forest::{self, Content, NodePair, Override};
use springform_topology::node_key::NodeKey;
use springform_topology::notation::{parse_content, read_top_cell};
use springform_topology::sides;
use springform_topology::address::Place;
use std::borrow::Cow;
use std::collections::BTreeMap;

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

    fn pairs(&self, key: &str, lines: &[String]) -> PyResult<Vec<NodePair>> {
        let pair = |line: &String| {
            let words: Vec<&str> = line.split_whitespace().collect();
            let [a, b] = words[..] else {
                return Err("write two nodes, such as 'v1 e7:1/2'".to_owned());
            };
            let node = |word| NodeKey::parse(word, &self.setting.mesh).map_err(|error| error.to_string());
            NodePair::new(node(a)?, node(b)?).ok_or_else(|| "the two nodes are the same".to_owned())
        };
        let numbered = lines.iter().enumerate();
        numbered
            .map(|(at, line)| pair(line).map_err(|problem| refusal(format!("overrides.{key}[{at}]"), problem)))
            .collect()
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
        method: &str,
        anchors: Vec<u32>,
        anchor_positions: Vec<Vector>,
        drawn: Option<Vec<Vector>>,
        stiffness: f64,
        ring_factor: f64,
        tolerance: f64,
    ) -> PyResult<Self> {
        let mut catalogue = Catalogue::default();
        for (name, springs, perimeter, fan) in &cell_types {
            let key = format!("cell_types.{name}");
            catalogue.define(name, springs, *perimeter, *fan).map_err(|error| refusal(key, error))?;
        }
        let method = Method::parse(method).ok_or_else(|| refusal("method", "unknown method"))?;
        let mesh = mesh.mesh.clone();
        let embedding = py.detach(|| match drawn {
            Some(drawn) => Embedding::drawn(&mesh, anchor_positions, drawn),
            None => Embedding::from_anchors(&mesh, &anchors, anchor_positions),
        });
        let setting = phenotype::Setting {
            mesh,
            catalogue,
            method,
            anchors,
            embedding,
            law: SpringLaw { stiffness, ring_factor },
            solver: Settings { tolerance, ..Settings::default() },
        };
        Ok(Setting { setting })
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
        for (&face, text) in &cells {
            let key = format!("forest.cells.{face}");
            if face >= faces {
                let problem = format!("there is no such top-level cell; the framework has {faces}, from 0");
                return Err(refusal(key, problem));
            }
            read_top_cell(&mut grown, face, text, catalogue).map_err(|error| refusal(key, error))?;
        }
        for face in (0..faces).filter(|face| !cells.contains_key(face)) {
            subdivide_to(&mut grown, Place::top(face), level, content)
                .map_err(|error| refusal("framework.level", error))?;
        }
        for (key, lines, what) in [("added", added, Override::Added), ("cut", cut, Override::Cut)] {
            for (at, pair) in self.pairs(key, &lines)?.into_iter().enumerate() {
                let edit = Edit::Override { pair, what, set: true };
                edit.apply(&mut grown).map_err(|error| refusal(format!("overrides.{key}[{at}]"), error))?;
            }
        }
        Ok(Forest { forest: grown })
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
            py.detach(|| setting.grow(&forest.forest)).map_err(|error| refusal("forest", error))?;
        let arrays = PyDict::new(py);
        arrays.set_item("positions", rows(py, network.positions.into_owned())?)?;
        arrays.set_item("springs", rows(py, network.springs.into_owned())?)?;
        arrays.set_item("fixed", PyArray1::from_vec(py, network.fixed.into_owned()))?;
        arrays.set_item("stiffness", PyArray1::from_vec(py, network.stiffness.into_owned()))?;
        arrays.set_item("rest_length", PyArray1::from_vec(py, network.rest_length.into_owned()))?;
        arrays.set_item("loads", rows(py, network.loads.into_owned())?)?;
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
        let kind = catalogue
            .find(word)
            .ok_or_else(|| refusal("types", format!("there is no cell type '{word}'; use 0-6 or a defined name")))?;
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
        if forces.len() != self.expression.springs.len() {
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
        if positions.len() != expression.nodes.len() || forces.len() != expression.springs.len() {
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

pub fn measures_dict<'py>(py: Python<'py>, measures: &Measures) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    result.set_item("springs", measures.springs)?;
    result.set_item("nodes", measures.nodes)?;
    result.set_item("cells", measures.cells)?;
    result.set_item("force_differential", measures.force_differential)?;
    for (name, value) in columns(measures) {
        result.set_item(name, value)?;
    }
    Ok(result)
}

/// The measures that are plain numbers, by name.
pub fn columns(measures: &Measures) -> [(&'static str, f64); 11] {
    [
        ("force_min", measures.force_min),
        ("force_max", measures.force_max),
        ("force_mean", measures.force_mean),
        ("force_deviation", measures.force_deviation),
        ("force_variation", measures.force_variation),
        ("force_range", measures.force_range),
        ("total_length", measures.total_length),
        ("load_path", measures.load_path),
        ("area", measures.area),
        ("shortest_spring", measures.shortest_spring),
        ("length_per_area", measures.length_per_area),
    ]
}

fn vectors<'a>(key: &str, array: &'a PyReadonlyArray2<'_, f64>) -> PyResult<&'a [Vector]> {
    if array.shape()[1] != 3 || !array.is_c_contiguous() {
        return Err(refusal(key, "must be a C-contiguous array of shape (n, 3)"));
    }
    Ok(array.as_slice()?.as_chunks().0)
}

fn values<'a, T: numpy::Element>(key: &str, array: &'a PyReadonlyArray1<'_, T>) -> PyResult<&'a [T]> {
    array.as_slice().map_err(|_| refusal(key, "must be a contiguous array"))
}

/// Arrays of a bare network, held while Rust reads them.
#[derive(FromPyObject)]
pub struct NetworkArrays<'py> {
    positions: PyReadonlyArray2<'py, f64>,
    springs: PyReadonlyArray2<'py, u32>,
    fixed: PyReadonlyArray1<'py, bool>,
    stiffness: PyReadonlyArray1<'py, f64>,
    rest_length: PyReadonlyArray1<'py, f64>,
    loads: PyReadonlyArray2<'py, f64>,
}

impl NetworkArrays<'_> {
    fn network(&self) -> PyResult<Network<'_>> {
        if self.springs.shape()[1] != 2 || !self.springs.is_c_contiguous() {
            return Err(refusal("springs", "must be a C-contiguous array of shape (m, 2)"));
        }
        let network = Network {
            positions: Cow::Borrowed(vectors("positions", &self.positions)?),
            springs: Cow::Borrowed(self.springs.as_slice()?.as_chunks().0),
            stiffness: Cow::Borrowed(values("stiffness", &self.stiffness)?),
            rest_length: Cow::Borrowed(values("rest_length", &self.rest_length)?),
            loads: Cow::Borrowed(vectors("loads", &self.loads)?),
            fixed: Cow::Borrowed(values("fixed", &self.fixed)?),
        };
        network.check().map_err(|error| refusal("network", error))?;
        Ok(network)
    }
}

/// Solves a bare network by "direct" or "implicit-euler".
#[pyfunction]
pub fn solve<'py>(
    py: Python<'py>,
    network: NetworkArrays<'py>,
    tolerance: f64,
    iterations: u32,
    solver: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let settings = Settings { tolerance, iterations };
    let network = network.network()?;
    let result = match solver {
        "direct" => py.detach(|| equilibrium::solve(&network, &settings)),
        "implicit-euler" => {
            py.detach(|| implicit_euler::solve(&network, &settings, implicit_euler::Motion::default()))
        }
        _ => return Err(refusal("solver", format!("unknown solver '{solver}'; use direct or implicit-euler"))),
    };
    equilibrium_dict(py, result)
}

/// Force out of balance at every free node of a bare network, (n, 3) N.
#[pyfunction]
pub fn residuals<'py>(
    py: Python<'py>,
    network: NetworkArrays<'py>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let network = network.network()?;
    rows(py, equilibrium::residuals(&network, &network.positions))
}

fn equilibrium_dict(py: Python<'_>, equilibrium: Equilibrium) -> PyResult<Bound<'_, PyDict>> {
    let result = PyDict::new(py);
    let reason = match equilibrium.status {
        Status::Converged => String::new(),
        Status::IterationLimit => {
            format!("stopped after {} iterations at a residual of {:.2e}", equilibrium.iterations, equilibrium.residual)
        }
        Status::Unheld { node } => {
            format!("node {node} is held by no springs that lead to a fixed node")
        }
        Status::Singular => "the stiffness matrix is singular or numbers overflowed".to_owned(),
    };
    result.set_item("positions", rows(py, equilibrium.positions)?)?;
    result.set_item("forces", PyArray1::from_vec(py, equilibrium.forces))?;
    result.set_item("residual", equilibrium.residual)?;
    result.set_item("converged", equilibrium.status == Status::Converged)?;
    result.set_item("iterations", equilibrium.iterations)?;
    result.set_item("reason", reason)?;
    Ok(result)
}

/// A bare network on its way to equilibrium, step by step.
#[pyclass(module = "springform._core")]
pub struct ImplicitEuler {
    euler: implicit_euler::ImplicitEuler<'static>,
    steps: u32,
}

#[pymethods]
impl ImplicitEuler {
    #[new]
    fn new(network: NetworkArrays<'_>, step: f64, growth: f64, drag: f64) -> PyResult<Self> {
        let borrowed = network.network()?;
        let owned = Network {
            positions: Cow::Owned(borrowed.positions.into_owned()),
            springs: Cow::Owned(borrowed.springs.into_owned()),
            stiffness: Cow::Owned(borrowed.stiffness.into_owned()),
            rest_length: Cow::Owned(borrowed.rest_length.into_owned()),
            loads: Cow::Owned(borrowed.loads.into_owned()),
            fixed: Cow::Owned(borrowed.fixed.into_owned()),
        };
        let motion = implicit_euler::Motion { step, growth, drag, ..implicit_euler::Motion::default() };
        Ok(ImplicitEuler { euler: implicit_euler::ImplicitEuler::new(owned, motion), steps: 0 })
    }

    /// Makes one time step and returns the state after it.
    fn advance<'py>(&mut self, py: Python<'py>, tolerance: f64) -> PyResult<Bound<'py, PyDict>> {
        let settings = Settings { tolerance, iterations: 0 };
        self.steps += 1;
        let (euler, steps) = (&mut self.euler, self.steps);
        let state = py.detach(|| {
            euler.advance();
            euler.state(&settings, steps)
        });
        equilibrium_dict(py, state)
    }
}
