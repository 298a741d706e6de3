//! The Python module `springform._core`: conversion between Python and the Rust crates, no algorithm.
//!
//! Arrays are handed to NumPy without a copy, and read from NumPy without a copy. The interpreter lock is free
//! during native work. Every refusal raises `CoreError(key, problem)`.

mod census;
mod convert;
mod evolution;
mod grafting;
mod measures;
mod network;
mod rigging;
mod sensitivity;
mod setting;
mod topology;

use pyo3::prelude::*;

#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("CoreError", module.py().get_type::<convert::CoreError>())?;
    module.add_class::<topology::BaseMesh>()?;
    module.add_class::<topology::Forest>()?;
    module.add_class::<setting::Setting>()?;
    module.add_class::<setting::Net>()?;
    module.add_class::<network::ForceStrainCurve>()?;
    module.add_class::<network::ImplicitEuler>()?;
    module.add_class::<sensitivity::Sensitivity>()?;
    module.add_class::<sensitivity::Equalisation>()?;
    module.add_class::<grafting::Selection>()?;
    module.add_class::<grafting::Symmetries>()?;
    module.add_class::<evolution::Evolution>()?;
    module.add_class::<census::Census>()?;
    module.add_class::<evolution::StressSeeking>()?;
    module.add_function(wrap_pyfunction!(grafting::lift, module)?)?;
    module.add_function(wrap_pyfunction!(grafting::graft_patch, module)?)?;
    module.add_function(wrap_pyfunction!(grafting::check_patch, module)?)?;
    module.add_function(wrap_pyfunction!(grafting::best_frame, module)?)?;
    module.add_function(wrap_pyfunction!(grafting::misfits, module)?)?;
    module.add_function(wrap_pyfunction!(grafting::turned_patch, module)?)?;
    module.add_function(wrap_pyfunction!(network::solve, module)?)?;
    module.add_function(wrap_pyfunction!(network::residuals, module)?)?;
    Ok(())
}
