//! The draws of a campaign's runs as numpy arrays.

use detumble_campaign::dispersion::{Spec, sample};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::depythonize;

/// Draws runs `first` to `first + count - 1`: by path an array (count,), or (count, width) for fields of several numbers.
#[pyfunction]
pub fn draw<'py>(
    py: Python<'py>,
    spec: &Bound<'py, PyDict>,
    seed: u64,
    first: u64,
    count: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let spec: Spec = depythonize(spec)?;
    let result = PyDict::new(py);
    for field in py.detach(|| sample(&spec, seed, first, count)) {
        let array = PyArray1::from_vec(py, field.values);
        if field.width == 1 {
            result.set_item(field.path, array)?;
        } else {
            result.set_item(field.path, array.reshape([count, field.width])?)?;
        }
    }
    Ok(result)
}
