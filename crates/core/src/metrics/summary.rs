//! One flight in numbers, and the register of its metrics: every other table of metrics is made from this one.

/// One flight in numbers; NaN for what did not happen. SI units, definitions in [`METRICS`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Summary {
    pub failure: u8,
    pub end_time: f64,
    pub capture_time: f64,
    pub capture_tick: f64,
    pub settling_time: f64,
    pub settled_tick: f64,
    pub diverged_time: f64,
    pub largest_rate: f64,
    pub delta_v: [f64; 3],
    pub delta_v_to_capture: [f64; 3],
    pub impulse: [f64; 3],
    pub torque_impulse: [f64; 3],
    pub peak_force_command: f64,
    pub peak_force: f64,
    pub peak_torque_command: f64,
    pub peak_torque: f64,
    pub force_saturated_share: f64,
    pub torque_saturated_share: f64,
    pub force_chattering: f64,
    pub torque_chattering: f64,
    pub final_rate: f64,
    pub final_pointing: f64,
    pub momentum_at_capture: f64,
    pub final_momentum: f64,
    pub capture_distance: f64,
    pub capture_angle: f64,
    pub capture_rate: f64,
    pub capture_speed: f64,
}

/// A metric: what users call it, and where it stands in the summary.
#[derive(Clone, Copy, Debug)]
pub struct Metric {
    /// In code and files.
    pub name: &'static str,
    /// In tables.
    pub label: &'static str,
    /// SI; empty for shares and counts.
    pub unit: &'static str,
    /// What exactly is counted.
    pub definition: &'static str,
    /// Its value.
    pub value: Value,
}

/// How a metric is read from a summary.
#[derive(Clone, Copy, Debug)]
pub enum Value {
    /// A number.
    Number(fn(&Summary) -> f64),
    /// A whole number, or NaN.
    Whole(fn(&Summary) -> f64),
    /// A number for each axis.
    Axes(fn(&Summary) -> [f64; 3]),
}

/// Every metric, in the order of tables and files.
pub const METRICS: [Metric; 29] = [
    Metric {
        name: "capture_time",
        label: "capture",
        unit: "s",
        definition: "first control tick at which every threshold has held for the dwell time",
        value: Value::Number(|s| s.capture_time),
    },
    Metric {
        name: "capture_tick",
        label: "capture tick",
        unit: "",
        definition: "number of that tick, counted from 0",
        value: Value::Whole(|s| s.capture_tick),
    },
    Metric {
        name: "capture_distance",
        label: "distance at capture",
        unit: "m",
        definition: "distance judged, before the merge",
        value: Value::Number(|s| s.capture_distance),
    },
    Metric {
        name: "capture_angle",
        label: "attitude error at capture",
        unit: "rad",
        definition: "angle between chaser and debris axes",
        value: Value::Number(|s| s.capture_angle),
    },
    Metric {
        name: "capture_rate",
        label: "relative rate at capture",
        unit: "rad/s",
        definition: "norm of w_C - R w_D",
        value: Value::Number(|s| s.capture_rate),
    },
    Metric {
        name: "capture_speed",
        label: "relative speed at capture",
        unit: "m/s",
        definition: "norm of v - v_des in H",
        value: Value::Number(|s| s.capture_speed),
    },
    Metric {
        name: "settling_time",
        label: "settling",
        unit: "s",
        definition: "from capture to the tick from which angle and rate against H hold to the end of the flight",
        value: Value::Number(|s| s.settling_time),
    },
    Metric {
        name: "settled_tick",
        label: "settled tick",
        unit: "",
        definition: "number of the tick from which they hold, counted from the start of the flight",
        value: Value::Whole(|s| s.settled_tick),
    },
    Metric {
        name: "final_rate",
        label: "final rate",
        unit: "rad/s",
        definition: "norm of the stack's rate relative to H at the end",
        value: Value::Number(|s| s.final_rate),
    },
    Metric {
        name: "final_pointing",
        label: "final pointing error",
        unit: "rad",
        definition: "angle of the stack's axes against H at the end",
        value: Value::Number(|s| s.final_pointing),
    },
    Metric {
        name: "momentum_at_capture",
        label: "momentum at capture",
        unit: "N m s",
        definition: "norm of the stack's angular momentum about its centre of mass after the merge",
        value: Value::Number(|s| s.momentum_at_capture),
    },
    Metric {
        name: "final_momentum",
        label: "final momentum",
        unit: "N m s",
        definition: "the same at the end of the flight",
        value: Value::Number(|s| s.final_momentum),
    },
    Metric {
        name: "delta_v",
        label: "Δv",
        unit: "m/s",
        definition: "sum over axes of the integral of |F_i| / m, m the true mass of what flies",
        value: Value::Number(|s| sum(s.delta_v)),
    },
    Metric {
        name: "delta_v_axes",
        label: "Δv by axis",
        unit: "m/s",
        definition: "integral of |F_i| / m",
        value: Value::Axes(|s| s.delta_v),
    },
    Metric {
        name: "delta_v_to_capture",
        label: "Δv to capture",
        unit: "m/s",
        definition: "the part of Δv spent until capture",
        value: Value::Number(|s| sum(s.delta_v_to_capture)),
    },
    Metric {
        name: "impulse",
        label: "impulse",
        unit: "N s",
        definition: "sum over axes of the integral of |F_i|",
        value: Value::Number(|s| sum(s.impulse)),
    },
    Metric {
        name: "impulse_axes",
        label: "impulse by axis",
        unit: "N s",
        definition: "integral of |F_i|",
        value: Value::Axes(|s| s.impulse),
    },
    Metric {
        name: "torque_impulse",
        label: "torque impulse",
        unit: "N m s",
        definition: "sum over axes of the integral of |tau_i|",
        value: Value::Number(|s| sum(s.torque_impulse)),
    },
    Metric {
        name: "torque_impulse_axes",
        label: "torque impulse by axis",
        unit: "N m s",
        definition: "integral of |tau_i|",
        value: Value::Axes(|s| s.torque_impulse),
    },
    Metric {
        name: "peak_force_command",
        label: "peak force asked",
        unit: "N",
        definition: "largest |F_i| before saturation",
        value: Value::Number(|s| s.peak_force_command),
    },
    Metric {
        name: "peak_force",
        label: "peak force",
        unit: "N",
        definition: "largest |F_i| flown",
        value: Value::Number(|s| s.peak_force),
    },
    Metric {
        name: "peak_torque_command",
        label: "peak torque asked",
        unit: "N m",
        definition: "largest |tau_i| before saturation",
        value: Value::Number(|s| s.peak_torque_command),
    },
    Metric {
        name: "peak_torque",
        label: "peak torque",
        unit: "N m",
        definition: "largest |tau_i| flown",
        value: Value::Number(|s| s.peak_torque),
    },
    Metric {
        name: "force_saturated_share",
        label: "force saturated",
        unit: "",
        definition: "share of the time with a force command over its limit on any axis",
        value: Value::Number(|s| s.force_saturated_share),
    },
    Metric {
        name: "torque_saturated_share",
        label: "torque saturated",
        unit: "",
        definition: "share of the time with a torque command over its limit on any axis",
        value: Value::Number(|s| s.torque_saturated_share),
    },
    Metric {
        name: "force_chattering",
        label: "force chattering",
        unit: "N/s",
        definition: "total variation of the force asked for, summed over axes, per second",
        value: Value::Number(|s| s.force_chattering),
    },
    Metric {
        name: "torque_chattering",
        label: "torque chattering",
        unit: "N m/s",
        definition: "total variation of the torque asked for, summed over axes, per second",
        value: Value::Number(|s| s.torque_chattering),
    },
    Metric {
        name: "largest_rate",
        label: "largest rate",
        unit: "rad/s",
        definition: "largest norm of omega at a control tick: of chaser and stack, and of debris whose tumble is integrated step by step",
        value: Value::Number(|s| s.largest_rate),
    },
    Metric {
        name: "diverged_time",
        label: "diverged",
        unit: "s",
        definition: "first tick whose state became non-finite",
        value: Value::Number(|s| s.diverged_time),
    },
];

fn sum(axes: [f64; 3]) -> f64 {
    axes.iter().sum()
}
