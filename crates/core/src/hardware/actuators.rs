//! Force and torque generators with saturation and a gain that may be off.
//!
//! Assumptions: no delay, no minimum impulse, no dead zone; limits per axis, symmetric.

use crate::case_struct;
use crate::number::{Real, Vec3};
use crate::part::Part;
use crate::plant::wrench::Wrench;

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

/// What becomes of a demand over the limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Saturation {
    /// Each axis is clipped, which turns the direction of a demand far over its limits.
    PerAxis,
    /// The vector is scaled until every axis fits, which keeps the direction.
    Scaled,
}

/// Force and torque generators, one for each axis.
#[derive(Clone, Copy, Debug)]
pub struct Actuators<'a, R> {
    /// What they can give.
    pub limits: &'a Limits<R>,
    /// What becomes of a demand over that.
    pub saturation: Saturation,
}

/// What the actuators give, and the axes on which they were asked for more than they can.
#[derive(Clone, Copy, Debug)]
pub struct Applied<R: Real> {
    /// In the axes of the command.
    pub wrench: Wrench<R>,
    /// Axes of the force over their limit.
    pub force_saturated: [R::Mask; 3],
    /// Axes of the torque over their limit.
    pub torque_saturated: [R::Mask; 3],
}

impl<R: Real> Part<R> for Actuators<'_, R> {
    type Memory = ();
    type Input<'a> = &'a Wrench<R>;
    type Output = Applied<R>;

    fn begin(&self) {}

    #[inline(always)]
    fn step(&self, (): &mut (), command: &Wrench<R>) -> Applied<R> {
        let limits = self.limits;
        Applied {
            wrench: Wrench {
                force: saturate(command.force, limits.force, self.saturation) * limits.force_gain,
                torque: saturate(command.torque, limits.torque, self.saturation) * limits.torque_gain,
            },
            force_saturated: over(command.force, limits.force),
            torque_saturated: over(command.torque, limits.torque),
        }
    }
}

/// Axes on which a demand is over its limit.
#[inline(always)]
fn over<R: Real>(demand: Vec3<R>, limit: Vec3<R>) -> [R::Mask; 3] {
    let size = demand.abs();
    [limit[0].lt(size[0]), limit[1].lt(size[1]), limit[2].lt(size[2])]
}

/// The part of a demand within the limits.
#[inline(always)]
pub fn saturate<R: Real>(demand: Vec3<R>, limit: Vec3<R>, saturation: Saturation) -> Vec3<R> {
    let fitted = match saturation {
        Saturation::PerAxis => demand,
        Saturation::Scaled => {
            let excess = (demand.abs() / limit).max_component().max(R::one());
            demand * (R::one() / excess)
        }
    };
    // A scaled demand may be over the limit by a rounding.
    fitted.clamp(-limit, limit)
}

#[cfg(test)]
mod tests;
