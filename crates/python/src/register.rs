//! What the core calls its results: metrics, failures, states and series, for the tables of every face.

use detumble_core::history::SERIES;
use detumble_core::metrics::{METRICS, Summary, Value, failure};
use detumble_core::plant::motion::Motion;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The register of results: `metrics` (name, label, unit, definition; number, whole or axes), in the order of tables and files;
/// `causes` of failure by code; `codes` and `thresholds` by name; `state` (name, width); `series` (name, width, unit, meaning).
#[pyfunction]
pub fn register(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let kind = |value| match value {
        Value::Number(_) => "number",
        Value::Whole(_) => "whole",
        Value::Axes(_) => "axes",
    };
    let codes = [
        ("success", failure::NONE),
        ("diverged", failure::DIVERGED),
        ("not_settled", failure::NOT_SETTLED),
        ("no_gains", failure::NO_GAINS),
        ("never_captured", failure::NEVER_CAPTURED),
        ("dwell_missed", failure::DWELL_MISSED),
    ];
    let dict = PyDict::new(py);
    dict.set_item("metrics", METRICS.map(|m| (m.name, m.label, m.unit, m.definition, kind(m.value))))?;
    dict.set_item("causes", failure::causes())?;
    dict.set_item("codes", codes)?;
    dict.set_item("thresholds", failure::THRESHOLDS)?;
    dict.set_item("state", Motion::<f64>::PARTS)?;
    dict.set_item("series", SERIES.map(|s| (s.name, s.width, s.unit, s.meaning)))?;
    Ok(dict)
}

/// A summary by the names of the register.
pub fn summary_dict<'py>(py: Python<'py>, summary: &Summary) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("failure", summary.failure)?;
    dict.set_item("end_time", summary.end_time)?;
    for metric in METRICS {
        match metric.value {
            Value::Number(of) | Value::Whole(of) => dict.set_item(metric.name, of(summary))?,
            Value::Axes(of) => dict.set_item(metric.name, of(summary))?,
        }
    }
    Ok(dict)
}
