//! What a flight starts from: the numbers of its case, any of which may differ from lane to lane, and the plan, which
//! is the same for the whole batch.

use crate::batch::Fields;
use crate::case_struct;
use crate::gnc::laws::LawRecipe;
use crate::number::{Mat3, Quat, Vec3};
use crate::plan::Plan;

case_struct! {
    /// Every number of a flight, before a law's gains.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
    pub struct Case<R> {
        /// The target's circular orbit.
        pub orbit: Orbit<R>,
        /// The controlled spacecraft.
        pub chaser: Body<R>,
        /// The dead satellite.
        pub debris: Body<R>,
        /// State of both bodies at t = 0.
        pub start: Motion<R>,
        /// Where the chaser is to go.
        pub goal: GoalPositions<R>,
        /// Thresholds of capture.
        pub capture: CaptureThresholds<R>,
        /// Thresholds of a settled stack.
        pub settled: SettledThresholds<R>,
        /// What the actuators can give.
        pub actuators: Limits<R>,
        /// Standard deviations of the sensor noise.
        pub sensors: NoiseSigmas<R>,
        /// What the laws believe of the spacecraft they fly.
        pub belief: Belief<R>,
    }
}

case_struct! {
    /// The target's circular orbit.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
    pub struct Orbit<R> {
        /// Mean motion n \[rad/s\].
        pub mean_motion: R,
        /// Attitude of H at t = 0, H -> N.
        pub lvlh_attitude: Quat<R>,
    }
}

case_struct! {
    /// A rigid body.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
    pub struct Body<R> {
        /// Mass \[kg\].
        pub mass: R,
        /// Inertia about the centre of mass, body axes \[kg m²\].
        pub inertia: Mat3<R>,
        /// Grasp point, body axes \[m\]; zero when the plan has none.
        pub grasp_point: Vec3<R>,
    }
}

case_struct! {
    /// State of both bodies. After capture `position`, `velocity` and `chaser_*` are the stack's, and the debris rides along.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
    pub struct Motion<R> {
        /// r_CD_H: chaser relative to the debris' orbit, in H \[m\].
        pub position: Vec3<R>,
        /// Its rate of change as seen in the turning H \[m/s\].
        pub velocity: Vec3<R>,
        /// C -> N.
        pub chaser_attitude: Quat<R>,
        /// omega_CN_C \[rad/s\].
        pub chaser_rate: Vec3<R>,
        /// D -> N.
        pub debris_attitude: Quat<R>,
        /// omega_DN_D \[rad/s\].
        pub debris_rate: Vec3<R>,
    }
}

case_struct! {
    /// Fixed goals in H \[m\]; without meaning where grasp points move the goal.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
    pub struct GoalPositions<R> {
        /// r_des before capture.
        pub position: Vec3<R>,
        /// r_des of the stack, if the plan gives one.
        pub after_capture: Vec3<R>,
    }
}

case_struct! {
    /// Capture holds while every quantity is strictly below its threshold.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
    pub struct CaptureThresholds<R> {
        /// \[m\]
        pub distance: R,
        /// Of the attitude error \[rad\].
        pub angle: R,
        /// Relative angular rate \[rad/s\].
        pub rate: R,
        /// Relative speed \[m/s\]; infinite when the scenario sets none.
        pub speed: R,
    }
}

case_struct! {
    /// The stack is settled once it stays below both until the end of the flight.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
    pub struct SettledThresholds<R> {
        /// Stack axes against H \[rad\].
        pub angle: R,
        /// Rate relative to H \[rad/s\].
        pub rate: R,
    }
}

case_struct! {
    /// Limits per axis, may be infinite; and what is really given of what is asked for.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
    pub struct Limits<R> {
        /// \[N\]
        pub force: Vec3<R>,
        /// \[N m\]
        pub torque: Vec3<R>,
        /// Force given per force commanded.
        pub force_gain: Vec3<R>,
        /// Torque given per torque commanded.
        pub torque_gain: Vec3<R>,
    }
}

impl Limits<f64> {
    /// Limits of actuators that give what is asked for.
    pub fn exact(force: Vec3<f64>, torque: Vec3<f64>) -> Self {
        let one = Vec3([1.0; 3]);
        Self { force, torque, force_gain: one, torque_gain: one }
    }
}

case_struct! {
    /// Standard deviations per axis of white Gaussian noise, drawn anew at every control tick.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
    pub struct NoiseSigmas<R> {
        /// Relative position \[m\].
        pub position: R,
        /// Relative velocity \[m/s\].
        pub velocity: R,
        /// Chaser attitude, small angle \[rad\].
        pub attitude: R,
        /// Chaser rate \[rad/s\].
        pub rate: R,
    }
}

case_struct! {
    /// What the laws believe of the mass \[kg\] and inertia \[kg m²\] they fly.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
    pub struct Belief<R> {
        /// Before capture.
        pub chaser_mass: R,
        /// Before capture, C axes.
        pub chaser_inertia: Mat3<R>,
        /// After capture, unless the plan tells the laws the truth.
        pub stack_mass: R,
        /// After capture, C axes.
        pub stack_inertia: Mat3<R>,
    }
}

/// A whole flight as it comes from a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightRecipe {
    /// Numbers.
    pub case: Case<f64>,
    /// Law and gains.
    pub law: LawRecipe,
    /// Clocks and switches.
    pub plan: Plan,
}

impl FlightRecipe {
    /// The numbers at a path: of the case, `chaser.mass`, or of the law, `law.before.rotation.gain`.
    pub fn field(&mut self, path: &str) -> Option<&mut [f64]> {
        match path.strip_prefix("law.") {
            Some(gain) => self.law.field(gain),
            None => self.case.field(path),
        }
    }
}
