//! Where the chaser should be, and how it should be turned.
//!
//! Before capture the goal is fixed in H, or it is where the grasp points meet:
//!
//! ```text
//! r_des = R_HD p_D - R_HC p_C
//! v_des = R_HD (ω_DH × p_D) - R_HC (ω_CH × p_C)                       ω_BH = ω_B - ω_H, seen in H
//! a_des = R_HD (ω_D' × p_D + …) - R_HC (…)                            see `point_acceleration`
//! ```
//!
//! and the attitude goal is the debris'. After capture the goal is fixed and the attitude goal is H.

use crate::case_struct;
use crate::number::{Quat, Real, Vec3};
use crate::plant::attitude::Inertia;
use crate::plant::lvlh::Lvlh;
use crate::plant::motion::Motion;

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

/// Where the chaser is to go before capture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Goal {
    /// To a position fixed in H.
    Fixed,
    /// To where the grasp points meet.
    Grasp,
    /// To where the grasp points meet, the goal's acceleration fed forward.
    GraspFeedforward,
}

impl Goal {
    /// Whether the laws add the goal's acceleration.
    #[inline(always)]
    pub fn feeds_acceleration(self) -> bool {
        self == Goal::GraspFeedforward
    }
}

/// Where the stack is to go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum StackGoal {
    /// To a position that the scenario gives.
    Given,
    /// To the goal as it was at capture.
    Reached,
}

/// Goal of one instant.
#[derive(Clone, Copy, Debug)]
pub struct Target<R> {
    /// r_des in H \[m\].
    pub position: Vec3<R>,
    /// v_des, seen in H \[m/s\].
    pub velocity: Vec3<R>,
    /// a_des, seen in H \[m/s²\]; zero unless acceleration feed-forward is on.
    pub acceleration: Vec3<R>,
    /// Attitude to take, reference axes -> N.
    pub attitude: Quat<R>,
    /// Rate to take, reference axes \[rad/s\].
    pub rate: Vec3<R>,
}

/// The goal of two separate bodies that is fixed in H.
#[inline(always)]
pub fn fixed_point<R: Real>(position: Vec3<R>, motion: &Motion<R>) -> Target<R> {
    Target {
        position,
        velocity: Vec3::zero(),
        acceleration: Vec3::zero(),
        attitude: motion.debris_attitude,
        rate: motion.debris_rate,
    }
}

/// The goal of two separate bodies whose grasp points are to meet, from what is known of their motion.
#[inline(always)]
pub fn grasp_points<R: Real>(
    grasp: &GraspPoints<R>,
    motion: &Motion<R>,
    lvlh: &Lvlh<R>,
    with_acceleration: bool,
) -> Target<R> {
    let chaser = BodyPoint::new(lvlh, motion.chaser_attitude, motion.chaser_rate, grasp.chaser);
    let debris = BodyPoint::new(lvlh, motion.debris_attitude, motion.debris_rate, grasp.debris);
    let acceleration = if with_acceleration {
        let tumbling = grasp.debris_inertia.angular_acceleration(motion.debris_rate, Vec3::zero());
        debris.acceleration(tumbling) - chaser.acceleration(Vec3::zero())
    } else {
        Vec3::zero()
    };
    Target {
        position: debris.position - chaser.position,
        velocity: debris.velocity() - chaser.velocity(),
        acceleration,
        attitude: motion.debris_attitude,
        rate: motion.debris_rate,
    }
}

/// The goal of the stack: a fixed position, axes on H.
#[inline(always)]
pub fn stabilise<R: Real>(fixed: Vec3<R>, lvlh: &Lvlh<R>) -> Target<R> {
    Target {
        position: fixed,
        velocity: Vec3::zero(),
        acceleration: Vec3::zero(),
        attitude: lvlh.attitude,
        rate: lvlh.rate,
    }
}

impl<R: Real> Target<R> {
    /// Lane by lane.
    #[inline(always)]
    pub fn choose(mask: R::Mask, yes: &Self, no: &Self) -> Self {
        Self {
            position: Vec3::select(mask, yes.position, no.position),
            velocity: Vec3::select(mask, yes.velocity, no.velocity),
            acceleration: Vec3::select(mask, yes.acceleration, no.acceleration),
            attitude: Quat::select(mask, yes.attitude, no.attitude),
            rate: Vec3::select(mask, yes.rate, no.rate),
        }
    }
}

/// Where each body is to be held, own axes \[m\], and the debris' inertia, which its tumble follows.
#[derive(Clone, Copy, Debug)]
pub struct GraspPoints<R> {
    /// p_C
    pub chaser: Vec3<R>,
    /// p_D
    pub debris: Vec3<R>,
    /// I_d
    pub debris_inertia: Inertia<R>,
}

/// A point fixed to a body, with the body's motion against H; everything in H axes.
struct BodyPoint<R> {
    body_to_lvlh: Quat<R>,
    position: Vec3<R>,
    rate: Vec3<R>,
    relative_rate: Vec3<R>,
}

impl<R: Real> BodyPoint<R> {
    #[inline(always)]
    fn new(lvlh: &Lvlh<R>, attitude: Quat<R>, rate: Vec3<R>, point: Vec3<R>) -> Self {
        let body_to_lvlh = lvlh.attitude.conjugate() * attitude;
        let rate = body_to_lvlh.rotate(rate);
        Self { body_to_lvlh, position: body_to_lvlh.rotate(point), rate, relative_rate: rate - lvlh.rate }
    }

    /// Seen in H: ω_BH × p.
    #[inline(always)]
    fn velocity(&self) -> Vec3<R> {
        self.relative_rate.cross(self.position)
    }

    /// Seen in H, for a body whose ω' (body axes, against N) is given:
    /// (ω_BH)' × p + ω_BH × (ω_BH × p), where in H  (ω_BH)' = ω' + ω_BH × ω_B.
    #[inline(always)]
    fn acceleration(&self, angular_acceleration: Vec3<R>) -> Vec3<R> {
        let turning = self.body_to_lvlh.rotate(angular_acceleration) + self.relative_rate.cross(self.rate);
        turning.cross(self.position) + self.relative_rate.cross(self.velocity())
    }
}

#[cfg(test)]
mod tests;
