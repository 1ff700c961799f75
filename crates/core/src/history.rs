//! The full history of one flight: a row at every control tick, and what happened at capture.

use crate::flight::Flight;
use crate::gnc::error::TrackingError;
use crate::number::{Mask, Mat3, Real};
use crate::observer::{Observer, Tick};
use crate::plant::motion::Motion;
use crate::plant::wrench::Wrench;
use crate::scene::Scene;

/// A named series with a fixed number of components, row by row.
#[derive(Clone, Debug)]
pub struct Series {
    /// As the user sees it.
    pub name: &'static str,
    /// Components in a row.
    pub width: usize,
    /// Rows, one after another.
    pub values: Vec<f64>,
}

/// What was before and after the merge.
#[derive(Clone, Copy, Debug)]
pub struct Merge {
    /// Both bodies just before.
    pub before: Motion<f64>,
    /// The stack just after.
    pub after: Motion<f64>,
    /// \[kg\]
    pub stack_mass: f64,
    /// C axes \[kg m²\].
    pub stack_inertia: Mat3<f64>,
}

/// Keeps lane 0 of everything. Rows end with the last whole number: a flight that becomes non-finite stops there.
pub struct History {
    series: Vec<Series>,
    before: Option<Motion<f64>>,
    /// The merge, if there was one.
    pub merge: Option<Merge>,
    non_finite: bool,
}

/// What a series is.
#[derive(Clone, Copy, Debug)]
pub struct Description {
    /// As the user sees it.
    pub name: &'static str,
    /// Components in a row: a number, three axes, or a quaternion.
    pub width: usize,
    /// SI; `1` for pure numbers.
    pub unit: &'static str,
    /// With its frame.
    pub meaning: &'static str,
}

const fn series(name: &'static str, width: usize, unit: &'static str, meaning: &'static str) -> Description {
    Description { name, width, unit, meaning }
}

/// Every series, in the order in which rows are written.
pub const SERIES: [Description; 18] = [
    series("time", 1, "s", "control tick"),
    series("position", 3, "m", "chaser relative to the debris' orbit in H; the stack's centre of mass after capture"),
    series("velocity", 3, "m/s", "rate of change of position as seen in the turning H"),
    series("chaser_attitude", 4, "1", "quaternion C -> N, scalar first; the stack's after capture"),
    series("chaser_rate", 3, "rad/s", "omega_CN_C; the stack's after capture"),
    series("debris_attitude", 4, "1", "quaternion D -> N, scalar first; fixed in the stack after capture"),
    series("debris_rate", 3, "rad/s", "omega_DN_D; that of the stack after capture"),
    series("goal_position", 3, "m", "r_des in H"),
    series("goal_velocity", 3, "m/s", "v_des in H"),
    series("force_command", 3, "N", "force asked for, in H (open loop in body axes: in C)"),
    series("force", 3, "N", "force applied, after saturation, same axes"),
    series("torque_command", 3, "N m", "torque asked for, in C (open loop in LVLH: in H)"),
    series("torque", 3, "N m", "torque applied, after saturation, same axes"),
    series("distance", 1, "m", "distance from the goal as capture judges it"),
    series("angle_error", 1, "rad", "attitude error against the debris, after capture against H"),
    series("rate_error", 1, "rad/s", "norm of the relative rate, after capture against H"),
    series("speed_error", 1, "m/s", "norm of v - v_des"),
    series("captured", 1, "1", "1 from the tick of capture on"),
];

impl History {
    /// With room for a flight of `periods` control periods.
    pub fn new(periods: u32) -> Self {
        let rows = periods as usize + 1;
        let series = SERIES
            .iter()
            .map(|&Description { name, width, .. }| Series { name, width, values: Vec::with_capacity(rows * width) })
            .collect();
        Self { series, before: None, merge: None, non_finite: false }
    }

    /// The series.
    pub fn into_series(self) -> Vec<Series> {
        self.series
    }

    fn write(&mut self, row: &[&[f64]; SERIES.len()]) {
        for (series, values) in self.series.iter_mut().zip(row) {
            series.values.extend_from_slice(values);
        }
    }
}

impl<R: Real> Observer<R> for History {
    fn captured(&mut self, _: &Scene<R>, _: R::Mask, before: &Motion<R>, _: TrackingError<R>) {
        self.before = Some(crate::batch::Batch::scatter(before, 0));
    }

    fn merged(&mut self, lanes: R::Mask, flight: &Flight<R>) {
        if let (true, Some(before)) = (lanes.lane(0), self.before) {
            self.merge = Some(Merge {
                before,
                after: crate::batch::Batch::scatter(&flight.truth, 0),
                stack_mass: flight.vehicle.mass.lane(0),
                stack_inertia: flight.vehicle.inertia.tensor.lane(0),
            });
        }
    }

    #[inline(always)]
    fn observe(&mut self, scene: &Scene<R>, flight: &Flight<R>, tick: &Tick<R>) {
        let truth = &flight.truth;
        let (position, velocity) = (truth.position.lane(0).0, truth.velocity.lane(0).0);
        let (chaser_attitude, chaser_rate) = (truth.chaser_attitude.lane(0).0, truth.chaser_rate.lane(0).0);
        let (debris_attitude, debris_rate) = (truth.debris_attitude.lane(0).0, truth.debris_rate.lane(0).0);
        if !tick.judged.is_finite().lane(0) {
            self.non_finite = true;
            return;
        }
        let error = &tick.error;
        let counted = scene.plan.distance_from.counted(truth, error);
        let half_sine = error.attitude.vector().lane(0).norm();
        let angle = 2.0 * half_sine.atan2(error.attitude.scalar().lane(0));
        let captured = flight.capture.captured().lane(0);
        // A law without gains commands nothing; its NaN would come out of the actuators as a limit.
        let given = |wrench: &Wrench<R>| {
            if flight.commanded().lane(0) {
                (wrench.force.lane(0).0, wrench.torque.lane(0).0)
            } else {
                ([0.0; 3], [0.0; 3])
            }
        };
        let ((force_command, torque_command), (force, torque)) = (given(&tick.demand), given(&tick.applied.wrench));
        self.write(&[
            &[scene.clock.time_of(tick.number.lane(0) as u64)],
            &position,
            &velocity,
            &chaser_attitude,
            &chaser_rate,
            &debris_attitude,
            &debris_rate,
            &tick.target.position.lane(0).0,
            &tick.target.velocity.lane(0).0,
            &force_command,
            &force,
            &torque_command,
            &torque,
            &[counted.lane(0).norm()],
            &[angle],
            &[error.rate.lane(0).norm()],
            &[error.velocity.lane(0).norm()],
            &[f64::from(u8::from(captured))],
        ]);
    }

    #[inline(always)]
    fn over(&self, _: &Scene<R>, _: &Flight<R>, _: &Tick<R>) -> R::Mask {
        R::Mask::splat(self.non_finite)
    }
}
