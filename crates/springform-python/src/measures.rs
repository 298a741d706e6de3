//! Measures for Python.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use springform_mechanics::measures::Measures;

/// All measures by name.
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
