//! The plan of a flight: clocks and models, the same for every flight of a batch.

use crate::gnc::capture::DistanceFrom;
use crate::gnc::guidance::{Goal, StackGoal};
use crate::gnc::laws::{AttitudeError, StackBelief, SurfaceRate};
use crate::hardware::actuators::Saturation;
use crate::plant::disturbances::Acting;
use crate::plant::stack::Transition;

/// What is the same for every flight of a batch: clocks, models, switches.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Plan {
    /// Time between two commands \[s\].
    pub control_period: f64,
    /// Integration steps in a control period.
    pub steps_per_period: u32,
    /// Control periods in the flight.
    pub periods: u32,
    /// Ticks for which the capture thresholds must have held before.
    pub dwell_ticks: u32,
    /// Where the chaser is to go.
    pub goal: Goal,
    /// Where the stack is to go.
    pub stack_goal: StackGoal,
    /// What capture counts the distance from.
    pub distance_from: DistanceFrom,
    /// How the bodies join at capture.
    pub transition: Transition,
    /// What the laws believe of the stack.
    pub stack_belief: StackBelief,
    /// What the actuators give of a demand over their limits.
    pub saturation: Saturation,
    /// What the laws take as attitude error.
    pub attitude_error: AttitudeError,
    /// What the sliding laws take off as the rate of their surface.
    pub surface_rate: SurfaceRate,
    /// What disturbs the bodies.
    pub disturbances: Acting,
    /// When a flight is over.
    pub end: End,
    /// Ticks for which a stack must have stayed settled before [`End::Settled`] ends the flight.
    pub hold_ticks: u32,
}

/// When a flight is over; never later than after its last period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum End {
    /// After its last period.
    Duration,
    /// At capture, or when it has become non-finite.
    Captured,
    /// When the stack has been settled for a while (at capture, where nothing merges), or when it has become non-finite.
    Settled,
}

impl Plan {
    /// Integration step \[s\].
    pub fn step(&self) -> f64 {
        self.control_period / f64::from(self.steps_per_period)
    }
}
