//! Force and torque generators with saturation and a gain that may be off.
//!
//! Assumptions: no delay, no minimum impulse, no dead zone; limits per axis, symmetric.

use crate::case::Limits;
use crate::number::{Real, Vec3};
use crate::plant::propagate::Wrench;

/// What becomes of a demand over the limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Saturation {
    /// Each axis is clipped, which turns the direction of a demand far over its limits.
    PerAxis,
    /// The vector is scaled until every axis fits, which keeps the direction.
    Scaled,
}

/// What the actuators give of a demand: saturated, then off by their gain.
#[inline(always)]
pub fn actuate<R: Real>(limits: &Limits<R>, demand: &Wrench<R>, saturation: Saturation) -> Wrench<R> {
    Wrench {
        force: saturate(demand.force, limits.force, saturation) * limits.force_gain,
        torque: saturate(demand.torque, limits.torque, saturation) * limits.torque_gain,
    }
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
