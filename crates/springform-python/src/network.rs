//! Bare networks and solvers for Python.

use crate::convert::{refusal, rows};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springform_mechanics::curve::Curve;
use springform_mechanics::equilibrium::{
    self, Equilibrium, Settings, Status, dynamic_relaxation, implicit_euler,
};
use springform_mechanics::network::{Network, Path, Pressure, Sense, Slide};
use springform_mechanics::rod::Rod;
use springform_mechanics::vector::Vector;
use springform_topology::base_mesh::Groups;
use std::borrow::Cow;

/// An (n, 3) array as vectors, without a copy.
pub fn vectors<'a>(key: &str, array: &'a PyReadonlyArray2<'_, f64>) -> PyResult<&'a [Vector]> {
    if array.shape()[1] != 3 || !array.is_c_contiguous() {
        return Err(refusal(key, "must be a C-contiguous array of shape (n, 3)"));
    }
    Ok(array.as_slice()?.as_chunks().0)
}

/// An array as a slice, without a copy.
pub fn values<'a, T: numpy::Element>(key: &str, array: &'a PyReadonlyArray1<'_, T>) -> PyResult<&'a [T]> {
    array.as_slice().map_err(|_| refusal(key, "must be a contiguous array"))
}

/// Arrays of a bare network, held while Rust reads them.
#[derive(FromPyObject)]
pub struct NetworkArrays<'py> {
    positions: PyReadonlyArray2<'py, f64>,
    springs: PyReadonlyArray2<'py, u32>,
    fixed_axes: PyReadonlyArray2<'py, bool>,
    stiffness: PyReadonlyArray1<'py, f64>,
    rest_length: PyReadonlyArray1<'py, f64>,
    force: PyReadonlyArray1<'py, f64>,
    sense: PyReadonlyArray1<'py, i8>,
    loads: PyReadonlyArray2<'py, f64>,
    /// Number of a spring's curve; NO_CURVE where it has none; empty if no spring has one.
    curve: PyReadonlyArray1<'py, u32>,
    curves: Vec<ForceStrainCurve>,
    /// [N/m]; empty if no spring has any.
    self_weight: PyReadonlyArray1<'py, f64>,
    rods: Vec<RodArrays>,
    /// Polygons of nodes, and the pressure on each [Pa].
    pressure: Vec<(Vec<u32>, f64)>,
    /// Node, whether it slides in a plane, and the line's direction or the plane's normal.
    slides: Vec<(u32, bool, Vector)>,
}

/// A rod as Python holds it.
#[derive(FromPyObject)]
struct RodArrays {
    nodes: Vec<u32>,
    closed: bool,
    lengths: Vec<f64>,
    bending_stiffness: f64,
}

/// A measured force–strain curve.
#[pyclass(frozen, from_py_object, module = "springform._core")]
#[derive(Clone)]
pub struct ForceStrainCurve {
    pub curve: Curve,
}

#[pymethods]
impl ForceStrainCurve {
    #[new]
    fn new(points: Vec<[f64; 2]>) -> PyResult<Self> {
        let curve = Curve::new(&points).map_err(|error| refusal("points", error))?;
        Ok(ForceStrainCurve { curve })
    }

    /// Force over strain at the last point, N.
    #[getter]
    fn axial_stiffness(&self) -> f64 {
        self.curve.axial_stiffness()
    }

    /// Least strains at which the curve has forces in N.
    fn strain<'py>(&self, py: Python<'py>, forces: PyReadonlyArray1<'py, f64>) -> PyResult<Floats<'py>> {
        let strain = |&force: &f64| self.curve.strain(force / self.curve.axial_stiffness());
        Ok(PyArray1::from_iter(py, values("forces", &forces)?.iter().map(strain)))
    }

    /// Force at strains, N.
    fn force<'py>(&self, py: Python<'py>, strains: PyReadonlyArray1<'py, f64>) -> PyResult<Floats<'py>> {
        let force = |&strain: &f64| self.curve.axial_stiffness() * self.curve.value(strain);
        Ok(PyArray1::from_iter(py, values("strains", &strains)?.iter().map(force)))
    }
}

type Floats<'py> = Bound<'py, PyArray1<f64>>;

impl NetworkArrays<'_> {
    /// The network that Rust reads in place.
    ///
    /// # Errors
    /// A shape or value that does not fit.
    pub fn network(&self) -> PyResult<Network<'_>> {
        if self.springs.shape()[1] != 2 || !self.springs.is_c_contiguous() {
            return Err(refusal("springs", "must be a C-contiguous array of shape (m, 2)"));
        }
        if self.fixed_axes.shape()[1] != 3 || !self.fixed_axes.is_c_contiguous() {
            return Err(refusal("fixed_axes", "must be a C-contiguous array of shape (n, 3)"));
        }
        let network = Network {
            positions: Cow::Borrowed(vectors("positions", &self.positions)?),
            springs: Cow::Borrowed(self.springs.as_slice()?.as_chunks().0),
            stiffness: Cow::Borrowed(values("stiffness", &self.stiffness)?),
            rest_length: Cow::Borrowed(values("rest_length", &self.rest_length)?),
            loads: Cow::Borrowed(vectors("loads", &self.loads)?),
            force: Cow::Borrowed(values("force", &self.force)?),
            sense: values("sense", &self.sense)?.iter().map(|&sense| self::sense(sense)).collect(),
            fixed: Cow::Borrowed(self.fixed_axes.as_slice()?.as_chunks().0),
            curve: Cow::Borrowed(values("curve", &self.curve)?),
            curves: self.curves.iter().map(|one| one.curve.clone()).collect(),
            weight: Cow::Borrowed(values("self_weight", &self.self_weight)?),
            rods: self.rods.iter().map(RodArrays::rod).collect(),
            pressure: self.pressure(),
            slides: self.slides.iter().map(slide).collect(),
        };
        network.check().map_err(|error| refusal("network", error))?;
        Ok(network)
    }

    fn pressure(&self) -> Pressure {
        let cells = self.pressure.iter().enumerate();
        let nodes = cells.flat_map(|(cell, (nodes, _))| nodes.iter().map(move |&node| (cell as u32, node)));
        Pressure {
            cells: Groups::collect(self.pressure.len(), nodes),
            values: self.pressure.iter().map(|(_, value)| *value).collect(),
        }
    }
}

impl RodArrays {
    fn rod(&self) -> Rod {
        Rod {
            nodes: self.nodes.clone(),
            closed: self.closed,
            lengths: self.lengths.clone(),
            bending_stiffness: self.bending_stiffness,
        }
    }
}

fn slide(&(node, in_plane, along): &(u32, bool, Vector)) -> Slide {
    Slide { node, path: if in_plane { Path::Plane(along) } else { Path::Line(along) } }
}

/// 1 pulls only, −1 pushes only, 0 does both.
fn sense(number: i8) -> Sense {
    match number {
        1.. => Sense::Tension,
        0 => Sense::Both,
        _ => Sense::Compression,
    }
}

/// Solves a bare network by "direct", "implicit-euler" or "dynamic-relaxation".
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
        "dynamic-relaxation" if !dynamic_relaxation::suits(&network) => {
            let problem =
                "dynamic-relaxation knows no rods, curves, slides and loads that follow; use another";
            return Err(refusal("solver", problem));
        }
        "dynamic-relaxation" => py.detach(|| dynamic_relaxation::solve(&network, &settings)),
        _ => return Err(refusal("solver", format!("unknown solver '{solver}'"))),
    };
    equilibrium_dict(py, &network, result)
}

/// Force out of balance at every free node of a bare network, (n, 3) N.
#[pyfunction]
pub fn residuals<'py>(py: Python<'py>, network: NetworkArrays<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let network = network.network()?;
    rows(py, equilibrium::residuals(&network, &network.positions))
}

fn equilibrium_dict<'py>(
    py: Python<'py>,
    network: &Network<'_>,
    equilibrium: Equilibrium,
) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    let at_worst = equilibrium.worst.map_or_else(String::new, |node| format!("; node {node} is worst"));
    let reason = match equilibrium.status {
        Status::Converged => String::new(),
        Status::IterationLimit => {
            format!(
                "stopped after {} iterations at a residual of {:.2e}{at_worst}",
                equilibrium.iterations, equilibrium.residual
            )
        }
        Status::Unheld { node } => {
            format!("node {node} is held by no springs that lead to a fixed node")
        }
        Status::Singular => format!("the stiffness matrix is singular or numbers overflowed{at_worst}"),
        Status::UnstableRest => {
            "the net balances where it would not stay, as a straight strut above its buckling load".to_owned()
        }
        Status::Unstable => {
            format!(
                "the loads that follow the shape drive the net away, residual {:.2e}{at_worst}",
                equilibrium.residual
            )
        }
    };
    let energies: Vec<f64> = network.spring_energies(&equilibrium.positions);
    let reactions = equilibrium::reactions(network, &equilibrium.positions, &equilibrium.forces);
    result.set_item("reactions", rows(py, reactions)?)?;
    result.set_item("loads", rows(py, equilibrium::loads(network, &equilibrium.positions))?)?;
    result.set_item("spring_energies", PyArray1::from_vec(py, energies))?;
    result.set_item("bending_moments", moments(py, network, &equilibrium.positions))?;
    result.set_item("method", equilibrium.method.name())?;
    result.set_item("worst_node", equilibrium.worst)?;
    result.set_item("positions", rows(py, equilibrium.positions)?)?;
    result.set_item("forces", PyArray1::from_vec(py, equilibrium.forces))?;
    result.set_item("residual", equilibrium.residual)?;
    result.set_item("converged", equilibrium.status == Status::Converged)?;
    result.set_item("iterations", equilibrium.iterations)?;
    result.set_item("reason", reason)?;
    Ok(result)
}

/// Bending moment at every node of every rod, N m; zero at the ends of open rods.
fn moments<'py>(py: Python<'py>, network: &Network<'_>, positions: &[Vector]) -> Vec<Floats<'py>> {
    let rods = network.rods.iter();
    rods.map(|rod| PyArray1::from_vec(py, rod.moments(positions))).collect()
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
        let owned = borrowed.into_owned();
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
        equilibrium_dict(py, self.euler.network(), state)
    }
}
