//! Many flights at once: columns of numbers in, columns of results out.

use crate::{named_backend, recipe, sound_laws, watched};
use detumble_campaign::{Column, Fleet, Operation, Outcome, fly_many as fly_fleet, fly_workload};
use detumble_core::metrics::Summary;
use detumble_core::number::Backend;
use detumble_core::plant::motion::Motion;
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::num::NonZeroU64;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Many flights of one case, which differ in the numbers of `columns`: by path, a row for each flight. `light` keeps end
/// state, first capture and impulse only. `progress` is called now and then with the number of flights landed.
#[pyfunction]
#[pyo3(signature = (case, columns, flights, seed=0, first_index=0, threads=1, backend=None, light=false, progress=None, cycle=None))]
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
    light: bool,
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
    let (landed, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
    let operation = Operation { seed, first_index, cycle, backend, threads, landed: &landed, stop: &stop };
    let glance = || match &progress {
        Some(progress) => progress.call1((landed.load(Ordering::Relaxed),)).map(drop),
        None => Ok(()),
    };

    let result = PyDict::new(py);
    let array = |values: Vec<f64>| PyArray1::from_vec(py, values);
    let ends = |motions: Vec<f64>| array(motions).reshape([flights, STATES]);
    if light {
        let results = watched(py, &stop, glance, || fly_workload(&fleet, &operation))?;
        result.set_item("ticks", results.ticks)?;
        result.set_item("lane_ticks", results.lane_ticks)?;
        let outcomes = results.flights;
        result.set_item("final_state", ends(outcomes.iter().flat_map(|o| state(&o.end)).collect())?)?;
        result.set_item("capture_time", array(outcomes.iter().map(|o| o.capture_time).collect()))?;
        result.set_item("impulse", array(outcomes.iter().map(|o| o.impulse).collect()))?;
    } else {
        let results = watched(py, &stop, glance, || fly_fleet(&fleet, &operation))?;
        result.set_item("ticks", results.ticks)?;
        result.set_item("lane_ticks", results.lane_ticks)?;
        let outcomes = results.flights;
        result.set_item("final_state", ends(outcomes.iter().flat_map(|o| state(&o.end)).collect())?)?;
        let failures = outcomes.iter().map(|o| o.summary.failure).collect();
        result.set_item("failure", PyArray1::<u8>::from_vec(py, failures))?;
        for (name, pick) in COLUMNS {
            result.set_item(name, array(outcomes.iter().map(|Outcome { summary, .. }| pick(summary)).collect()))?;
        }
    }
    Ok(result)
}

/// What is kept of each flight; sums over the axes where there are axes.
type Pick = fn(&Summary) -> f64;
const COLUMNS: [(&str, Pick); 27] = [
    ("end_time", |s| s.end_time),
    ("capture_time", |s| s.capture_time),
    ("capture_tick", |s| s.capture_tick),
    ("settling_time", |s| s.settling_time),
    ("settled_tick", |s| s.settled_tick),
    ("diverged_time", |s| s.diverged_time),
    ("largest_rate", |s| s.largest_rate),
    ("delta_v", |s| sum(&s.delta_v)),
    ("delta_v_to_capture", |s| sum(&s.delta_v_to_capture)),
    ("impulse", |s| sum(&s.impulse)),
    ("torque_impulse", |s| sum(&s.torque_impulse)),
    ("peak_force_command", |s| s.peak_force_command),
    ("peak_force", |s| s.peak_force),
    ("peak_torque_command", |s| s.peak_torque_command),
    ("peak_torque", |s| s.peak_torque),
    ("force_saturated_share", |s| s.force_saturated_share),
    ("torque_saturated_share", |s| s.torque_saturated_share),
    ("force_chattering", |s| s.force_chattering),
    ("torque_chattering", |s| s.torque_chattering),
    ("final_rate", |s| s.final_rate),
    ("final_pointing", |s| s.final_pointing),
    ("momentum_at_capture", |s| s.momentum_at_capture),
    ("final_momentum", |s| s.final_momentum),
    ("capture_distance", |s| s.capture_distance),
    ("capture_angle", |s| s.capture_angle),
    ("capture_rate", |s| s.capture_rate),
    ("capture_speed", |s| s.capture_speed),
];

fn sum(axes: &[f64; 3]) -> f64 {
    axes.iter().sum()
}

/// Position, velocity, chaser attitude and rate, debris attitude and rate.
const STATES: usize = 20;

fn state(motion: &Motion<f64>) -> impl Iterator<Item = f64> {
    let translation = motion.position.0.into_iter().chain(motion.velocity.0);
    let chaser = motion.chaser_attitude.0.into_iter().chain(motion.chaser_rate.0);
    let debris = motion.debris_attitude.0.into_iter().chain(motion.debris_rate.0);
    translation.chain(chaser).chain(debris)
}
