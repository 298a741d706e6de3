//! Errors, arrays and groups on their way to Python.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use springform_topology::base_mesh::Groups;

pyo3::create_exception!(_core, CoreError, pyo3::exceptions::PyValueError, "A refusal: (key, problem).");

/// `CoreError(key, problem)`.
pub fn refusal(key: impl ToString, problem: impl ToString) -> PyErr {
    CoreError::new_err((key.to_string(), problem.to_string()))
}

/// Rows of a fixed width as an (n, WIDTH) array, without a copy.
pub fn rows<'py, T: numpy::Element, const WIDTH: usize>(
    py: Python<'py>,
    rows: Vec<[T; WIDTH]>,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let count = rows.len();
    PyArray1::from_vec(py, rows.into_flattened()).reshape([count, WIDTH])
}

/// (starts, items): the items of group g are `items[starts[g]:starts[g + 1]]`.
pub type GroupArrays<'py> = (Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<u32>>);

/// Groups as two arrays.
pub fn groups<'py>(py: Python<'py>, groups: &Groups<u32>) -> GroupArrays<'py> {
    (PyArray1::from_slice(py, groups.starts()), PyArray1::from_slice(py, groups.items()))
}

/// An undefined number as NaN.
pub fn or_nan(value: Option<f64>) -> f64 {
    value.unwrap_or(f64::NAN)
}
