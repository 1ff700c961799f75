//! Python bindings: dictionaries in, numpy arrays and dictionaries out. Thin: no physics here.

mod draw;
mod many;
mod register;

use detumble_campaign::{FlightRecord, fly_one};
use detumble_core::case::{Case, FlightRecipe};
use detumble_core::clock::Clock;
use detumble_core::gnc::laws::{AttitudeError, LawRecipe, lqr};
use detumble_core::history::Merge;
use detumble_core::metrics::Summary;
use detumble_core::number::{Backend, Mat3, Vec3, fma_peak};
use detumble_core::plan::Plan;
use detumble_core::scene::{Common, Laws};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::{depythonize, pythonize};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::RecvTimeoutError;
use std::time::Duration;

/// The compiled core of detumble.
#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(fly, module)?)?;
    module.add_function(wrap_pyfunction!(many::fly_many, module)?)?;
    module.add_function(wrap_pyfunction!(draw::draw, module)?)?;
    module.add_function(wrap_pyfunction!(tick_times, module)?)?;
    module.add_function(wrap_pyfunction!(backends, module)?)?;
    module.add_function(wrap_pyfunction!(fma_flops, module)?)?;
    module.add_function(wrap_pyfunction!(lqr_translation, module)?)?;
    module.add_function(wrap_pyfunction!(lqr_rotation, module)?)?;
    module.add_function(wrap_pyfunction!(echo, module)?)?;
    module.add_function(wrap_pyfunction!(register::register, module)?)?;
    Ok(())
}

/// One flight with its full history. `differing` are the paths of the numbers in which flights of its campaign differ: such a
/// flight may have drawn weights without gains, and then ends where they would command.
#[pyfunction]
#[pyo3(signature = (case, *, seed=0, index=0, backend=None, differing=None))]
fn fly<'py>(
    py: Python<'py>,
    case: &Bound<'py, PyDict>,
    seed: u64,
    index: u64,
    backend: Option<&str>,
    differing: Option<Vec<String>>,
) -> PyResult<Bound<'py, PyDict>> {
    let recipe = recipe(case)?;
    let common = Common::new(&recipe, differing.iter().flatten().map(String::as_str))
        .map_err(|path| PyValueError::new_err(format!("{path}: no number of a flight")))?;
    if differing.is_none() {
        sound_laws(&recipe.law, &recipe.case, &recipe.plan)?;
    }
    let backend = named_backend(backend, Backend::best_for_one())?;
    let stop = AtomicBool::new(false);
    let FlightRecord { series, merge, summary } =
        interruptible(py, &stop, || fly_one(&recipe, common, seed, index, backend, &stop))?;

    let history = PyDict::new(py);
    for series in series {
        let rows = series.values.len() / series.width;
        let array = PyArray1::from_vec(py, series.values);
        if series.width == 1 {
            history.set_item(series.name, array)?;
        } else {
            history.set_item(series.name, array.reshape([rows, series.width])?)?;
        }
    }
    let result = PyDict::new(py);
    result.set_item("backend", backend.name())?;
    result.set_item("history", history)?;
    result.set_item("summary", register::summary_dict(py, &summary)?)?;
    match merge {
        Some(merge) => result.set_item("merge", merge_dict(py, &merge, &summary)?)?,
        None => result.set_item("merge", py.None())?,
    }
    Ok(result)
}

fn merge_dict<'py>(py: Python<'py>, merge: &Merge, summary: &Summary) -> PyResult<Bound<'py, PyDict>> {
    let after = PyDict::new(py);
    after.set_item("position", merge.after.position.0)?;
    after.set_item("velocity", merge.after.velocity.0)?;
    after.set_item("attitude", merge.after.chaser_attitude.0)?;
    after.set_item("rate", merge.after.chaser_rate.0)?;
    let dict = PyDict::new(py);
    dict.set_item("tick", summary.capture_tick as u64)?;
    dict.set_item("time", summary.capture_time)?;
    dict.set_item("before", pythonize(py, &merge.before)?)?;
    dict.set_item("after", after)?;
    dict.set_item("stack_mass", merge.stack_mass)?;
    dict.set_item("stack_inertia", merge.stack_inertia.0)?;
    Ok(dict)
}

/// The times of control ticks \[s\], (n,), as histories and summaries have them.
#[pyfunction]
fn tick_times<'py>(py: Python<'py>, period: f64, ticks: PyReadonlyArray1<'py, u64>) -> Bound<'py, PyArray1<f64>> {
    let clock = Clock::new(period);
    PyArray1::from_iter(py, ticks.as_array().iter().map(|&tick| clock.time_of(tick)))
}

/// Back ends that this CPU has, narrowest first.
#[pyfunction]
fn backends() -> Vec<&'static str> {
    Backend::available().map(Backend::name).collect()
}

/// Runs independent fused multiply-adds on a back end; returns the floating-point operations done, for the caller to time.
#[pyfunction]
#[pyo3(name = "fma_peak")]
fn fma_flops(py: Python<'_>, backend: &str, iterations: u64) -> PyResult<f64> {
    let backend = named_backend(Some(backend), Backend::best())?;
    Ok(py.detach(|| fma_peak(backend, iterations)))
}

/// LQR gain of the HCW model, input acceleration: 3x3 of position error, 3x3 of velocity error.
#[pyfunction]
fn lqr_translation(q_error: [f64; 3], q_rate: [f64; 3], r: f64, mean_motion: f64) -> ([[f64; 3]; 3], [[f64; 3]; 3]) {
    let weights = lqr::Weights { q_error: Vec3(q_error), q_rate: Vec3(q_rate), r };
    let [error, rate] = lqr::translation_gain(&weights, mean_motion);
    (error.0, rate.0)
}

/// LQR gain of the linearised attitude, input torque: 3x3 of attitude error, 3x3 of rate error.
#[pyfunction]
#[pyo3(signature = (q_error, q_rate, r, inertia, two_epsilon=false))]
fn lqr_rotation(
    q_error: [f64; 3],
    q_rate: [f64; 3],
    r: f64,
    inertia: [[f64; 3]; 3],
    two_epsilon: bool,
) -> ([[f64; 3]; 3], [[f64; 3]; 3]) {
    let weights = lqr::Weights { q_error: Vec3(q_error), q_rate: Vec3(q_rate), r };
    let attitude_error = if two_epsilon { AttitudeError::TwoEpsilon } else { AttitudeError::Epsilon };
    let [error, rate] = lqr::rotation_gain(&weights, &Mat3(inertia), attitude_error);
    (error.0, rate.0)
}

/// The flight recipe as the core understood it, to hold the scenario model against.
#[pyfunction]
fn echo<'py>(py: Python<'py>, case: &Bound<'py, PyDict>) -> PyResult<Bound<'py, PyDict>> {
    let FlightRecipe { case, law, plan } = recipe(case)?;
    let dict = pythonize(py, &case)?.cast_into::<PyDict>()?;
    dict.set_item("law", pythonize(py, &law)?)?;
    dict.set_item("plan", pythonize(py, &plan)?)?;
    Ok(dict)
}

/// Case, law and plan from one dictionary; the names are checked by serde, unknown ones are errors.
fn recipe(dict: &Bound<'_, PyDict>) -> PyResult<FlightRecipe> {
    let take = |name: &str| {
        dict.get_item(name)?.ok_or_else(|| PyValueError::new_err(format!("{name}: missing from the flight recipe")))
    };
    let numbers = dict.copy()?;
    numbers.del_item("law")?;
    numbers.del_item("plan")?;
    let case: Case<f64> = depythonize(&numbers)?;
    let law: LawRecipe = depythonize(&take("law")?)?;
    let plan: Plan = depythonize(&take("plan")?)?;
    Ok(FlightRecipe { case, law, plan })
}

/// The laws, if their gains are numbers.
fn sound_laws(law: &LawRecipe, case: &Case<f64>, plan: &Plan) -> PyResult<Laws> {
    let laws = Laws::new(law, case, plan);
    if laws.have_finite_gains() {
        return Ok(laws);
    }
    let text =
        "laws.lqr: the Riccati equation has no solution in double precision for these weights, lying too far apart";
    Err(PyValueError::new_err(text))
}

/// Computes on a thread of its own. At Ctrl-C `stop` is set, and the work breaks off.
fn interruptible<T: Send>(py: Python<'_>, stop: &AtomicBool, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    watched(py, stop, || Ok(()), work)
}

/// The same, calling `report` now and then; its error stops the work too.
fn watched<T: Send>(
    py: Python<'_>,
    stop: &AtomicBool,
    mut report: impl FnMut() -> PyResult<()>,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    const POLL_INTERVAL: Duration = Duration::from_millis(50);
    std::thread::scope(|scope| {
        let (sender, mut receiver) = std::sync::mpsc::channel();
        scope.spawn(move || sender.send(work()));
        loop {
            let received;
            (receiver, received) = py.detach(move || {
                let received = receiver.recv_timeout(POLL_INTERVAL);
                (receiver, received)
            });
            match received {
                Ok(result) => return py.check_signals().map(|()| result),
                Err(RecvTimeoutError::Timeout) => {
                    if let Err(interrupt) = py.check_signals().and_then(|()| report()) {
                        stop.store(true, Ordering::Relaxed);
                        return Err(interrupt);
                    }
                }
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(PyRuntimeError::new_err("the core stopped unexpectedly; this is a fault of detumble"));
                }
            }
        }
    })
}

fn named_backend(name: Option<&str>, default: Backend) -> PyResult<Backend> {
    let Some(name) = name else { return Ok(default) };
    Backend::available().find(|backend| backend.name() == name).ok_or_else(|| {
        let allowed: Vec<_> = Backend::available().map(Backend::name).collect();
        PyValueError::new_err(format!("backend \"{name}\": not on this machine; allowed: {}", allowed.join(", ")))
    })
}
