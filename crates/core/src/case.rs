//! What a flight starts from: the numbers of its case, any of which may differ from lane to lane, and the plan, which
//! is the same for the whole batch.

use crate::batch::Fields;
use crate::case_struct;
use crate::gnc::capture::{CaptureThresholds, SettledThresholds};
use crate::gnc::guidance::GoalPositions;
use crate::gnc::laws::LawRecipe;
use crate::gnc::laws::belief::Belief;
use crate::hardware::actuators::Limits;
use crate::hardware::sensors::NoiseSigmas;
use crate::plan::Plan;
use crate::plant::body::Body;
use crate::plant::disturbances::Disturbances;
use crate::plant::motion::Motion;
use crate::plant::orbit::Orbit;

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
        /// What disturbs the bodies.
        pub disturbances: Disturbances<R>,
        /// Standard deviations of the sensor noise.
        pub sensors: NoiseSigmas<R>,
        /// What the laws believe of the spacecraft they fly.
        pub belief: Belief<R>,
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
