//! Many flights at once: columns of numbers in, columns of results out.

use crate::{named_backend, recipe, sound_laws, watched};
use detumble_campaign::{Column, Fleet, Operation, fly_many as fly_fleet};
use detumble_core::metrics::{METRICS, Value};
use detumble_core::number::Backend;
use detumble_core::plant::motion::Motion;
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::num::NonZeroU64;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Many flights of one case, which differ in the numbers of `columns`: by path, a row for each flight. `progress` is called
/// now and then with the number of flights completed.
#[pyfunction]
#[pyo3(signature = (case, columns, flights, *, seed=0, first_index=0, threads=1, backend=None, progress=None, cycle=None))]
#[allow(clippy::too_many_arguments)] // one Python call: keywords there
pub fn fly_many<'py>(
    py: Python<'py>,
    case: &Bound<'py, PyDict>,
    columns: &Bound<'py, PyDict>,
    flights: usize,
    seed: u64,
    first_index: u64,
    threads: usize,
    backend: Option<&str>,
    progress: Option<Bound<'py, PyAny>>,
    cycle: Option<NonZeroU64>,
) -> PyResult<Bound<'py, PyDict>> {
    let recipe = recipe(case)?;
    sound_laws(&recipe.law, &recipe.case, &recipe.plan)?;
    let mut arrays: Vec<(String, PyReadonlyArrayDyn<'py, f64>)> = Vec::new();
    for (path, values) in columns {
        arrays.push((path.extract()?, values.extract()?));
    }
    let mut borrowed = Vec::new();
    for (path, values) in &arrays {
        let values = values.as_slice();
        let values = values.map_err(|_| PyValueError::new_err(format!("{path}: must be C-contiguous")))?;
        borrowed.push(Column { path: path.clone(), values });
    }
    let fleet = Fleet::new(recipe, borrowed, flights).map_err(PyValueError::new_err)?;
    let backend = named_backend(backend, Backend::best())?;
    let cycle = cycle.map_or(u64::MAX, NonZeroU64::get);
    let (completed, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
    let operation = Operation { seed, first_index, cycle, backend, threads, completed: &completed, stop: &stop };
    let report = || match &progress {
        Some(progress) => progress.call1((completed.load(Ordering::Relaxed),)).map(drop),
        None => Ok(()),
    };
    let results = watched(py, &stop, report, || fly_fleet(&fleet, &operation))?;

    let outcomes = &results.flights;
    let array = |values: Vec<f64>| PyArray1::from_vec(py, values);
    let result = PyDict::new(py);
    result.set_item("ticks", results.ticks)?;
    result.set_item("lane_ticks", results.lane_ticks)?;
    let states = outcomes.iter().flat_map(|outcome| outcome.end.numbers()).collect();
    result.set_item("final_state", array(states).reshape([flights, Motion::<f64>::NUMBERS])?)?;
    let failures = outcomes.iter().map(|outcome| outcome.summary.failure).collect();
    result.set_item("failure", PyArray1::<u8>::from_vec(py, failures))?;
    result.set_item("end_time", array(outcomes.iter().map(|outcome| outcome.summary.end_time).collect()))?;
    for metric in METRICS {
        if let Value::Number(of) | Value::Whole(of) = metric.value {
            result.set_item(metric.name, array(outcomes.iter().map(|outcome| of(&outcome.summary)).collect()))?;
        }
    }
    Ok(result)
}
