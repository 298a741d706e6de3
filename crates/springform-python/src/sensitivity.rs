//! Derivatives of equilibria, and stiffness tuned on them, for Python.

use crate::convert::{refusal, rows};
use crate::network::{NetworkArrays, values, vectors};
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springform_mechanics::equalisation::{self, Allowed, EqualisationError};
use springform_mechanics::equilibrium::Settings;
use springform_mechanics::equilibrium::sensitivity::{self, Parameters};

/// The factored tangent of a bare network at its equilibrium.
#[pyclass(module = "springform._core")]
pub struct Sensitivity {
    sensitivity: sensitivity::Sensitivity,
    nodes: usize,
    springs: usize,
}

#[pymethods]
impl Sensitivity {
    #[new]
    fn new(
        py: Python<'_>,
        network: NetworkArrays<'_>,
        positions: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Self> {
        let (network, positions) = (network.network()?, vectors("positions", &positions)?);
        let (nodes, springs) = (network.positions.len(), network.springs.len());
        fits("positions", positions.len(), nodes)?;
        let mut sensitivity = sensitivity::Sensitivity::default();
        py.detach(|| sensitivity.build(&network, positions))
            .map_err(|error| refusal("equilibrium", error))?;
        Ok(Sensitivity { sensitivity, nodes, springs })
    }

    /// Gradient of a scalar by every parameter, from its changes with positions and forces.
    fn gradient<'py>(
        &mut self,
        py: Python<'py>,
        by_positions: PyReadonlyArray2<'py, f64>,
        by_forces: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (positions, forces) = (vectors("positions", &by_positions)?, values("forces", &by_forces)?);
        fits("positions", positions.len(), self.nodes)?;
        fits("forces", forces.len(), self.springs)?;
        let gradient = py.detach(|| self.sensitivity.gradient(positions, forces));
        let result = PyDict::new(py);
        result.set_item("stiffness", PyArray1::from_vec(py, gradient.stiffness))?;
        result.set_item("rest_length", PyArray1::from_vec(py, gradient.rest_length))?;
        result.set_item("force", PyArray1::from_vec(py, gradient.force))?;
        result.set_item("loads", rows(py, gradient.loads)?)?;
        result.set_item("supports", rows(py, gradient.supports)?)?;
        Ok(result)
    }

    /// Moves of nodes and changes of forces with a small change of every parameter.
    fn response<'py>(
        &mut self,
        py: Python<'py>,
        stiffness: PyReadonlyArray1<'py, f64>,
        rest_length: PyReadonlyArray1<'py, f64>,
        force: PyReadonlyArray1<'py, f64>,
        loads: PyReadonlyArray2<'py, f64>,
        supports: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let change = Parameters {
            stiffness: values("stiffness", &stiffness)?.to_vec(),
            rest_length: values("rest_length", &rest_length)?.to_vec(),
            force: values("force", &force)?.to_vec(),
            loads: vectors("loads", &loads)?.to_vec(),
            supports: vectors("supports", &supports)?.to_vec(),
        };
        fits("stiffness", change.stiffness.len(), self.springs)?;
        fits("rest_length", change.rest_length.len(), self.springs)?;
        fits("force", change.force.len(), self.springs)?;
        fits("loads", change.loads.len(), self.nodes)?;
        fits("supports", change.supports.len(), self.nodes)?;
        let response = py.detach(|| self.sensitivity.response(&change));
        let result = PyDict::new(py);
        result.set_item("positions", rows(py, response.positions)?)?;
        result.set_item("forces", PyArray1::from_vec(py, response.forces))?;
        Ok(result)
    }
}

/// Stiffness factors of a bare network on their way to even forces.
#[pyclass(module = "springform._core")]
pub struct Equalisation {
    equalisation: equalisation::Equalisation,
}

#[pymethods]
impl Equalisation {
    /// Factors between bounds, or, where there are any, of a few values, on the springs that are `tuned` and counted.
    #[new]
    fn new(
        py: Python<'_>,
        network: NetworkArrays<'_>,
        tuned: Vec<usize>,
        bounds: [f64; 2],
        values: Vec<f64>,
        tolerance: f64,
    ) -> PyResult<Self> {
        let key = if values.is_empty() { "bounds" } else { "values" };
        let allowed = if values.is_empty() { Allowed::Between(bounds) } else { Allowed::Values(values) };
        let network = network.network()?.into_owned();
        let settings = Settings { tolerance, ..Settings::default() };
        let started = py.detach(|| equalisation::Equalisation::new(network, tuned, &allowed, settings));
        let equalisation = started.map_err(|error| match error {
            EqualisationError::Allowed(_) => refusal(key, error),
            _ => refusal("network", error),
        })?;
        Ok(Equalisation { equalisation })
    }

    /// Makes one step; false once there is none left to make.
    fn advance(&mut self, py: Python<'_>) -> bool {
        py.detach(|| self.equalisation.advance())
    }

    /// Best factors so far, (m,).
    #[getter]
    fn factors<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.equalisation.factors())
    }

    /// Force differential with factors of 1.
    #[getter]
    fn before(&self) -> f64 {
        self.equalisation.before()
    }

    /// Force differential with the best factors.
    #[getter]
    fn differential(&self) -> f64 {
        self.equalisation.differential()
    }

    /// Force differential where the steps are now.
    #[getter]
    fn differential_now(&self) -> f64 {
        self.equalisation.differential_now()
    }

    /// Steps made.
    #[getter]
    fn iterations(&self) -> u32 {
        self.equalisation.iterations()
    }
}

fn fits(key: &str, found: usize, expected: usize) -> PyResult<()> {
    if found == expected {
        Ok(())
    } else {
        Err(refusal(key, format!("has {found} rows instead of {expected}")))
    }
}
