//! Bare networks and solvers for Python.

use crate::convert::{refusal, rows};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springform_mechanics::equilibrium::{
    self, Equilibrium, Settings, Status, dynamic_relaxation, implicit_euler,
};
use springform_mechanics::network::{Network, Sense};
use springform_mechanics::vector::Vector;
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
}

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
        };
        network.check().map_err(|error| refusal("network", error))?;
        Ok(network)
    }
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
    let reason = match equilibrium.status {
        Status::Converged => String::new(),
        Status::IterationLimit => {
            format!(
                "stopped after {} iterations at a residual of {:.2e}",
                equilibrium.iterations, equilibrium.residual
            )
        }
        Status::Unheld { node } => {
            format!("node {node} is held by no springs that lead to a fixed node")
        }
        Status::Singular => "the stiffness matrix is singular or numbers overflowed".to_owned(),
    };
    result.set_item("reactions", rows(py, equilibrium::reactions(network, &equilibrium.positions))?)?;
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
            force: Cow::Owned(borrowed.force.into_owned()),
            sense: Cow::Owned(borrowed.sense.into_owned()),
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
        equilibrium_dict(py, self.euler.network(), state)
    }
}
