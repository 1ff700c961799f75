//! Force and torque generators with saturation and a gain that may be off.
//!
//! Assumptions: no delay, no minimum impulse, no dead zone; limits per axis, symmetric.

use crate::case::Limits;
use crate::number::{Real, Vec3};
use crate::plant::propagate::Wrench;

/// What the actuators give of a demand: saturated, then off by their gain.
#[inline(always)]
pub fn actuate<R: Real>(limits: &Limits<R>, demand: &Wrench<R>, scaled: bool) -> Wrench<R> {
    Wrench {
        force: saturate(demand.force, limits.force, scaled) * limits.force_gain,
        torque: saturate(demand.torque, limits.torque, scaled) * limits.torque_gain,
    }
}

/// What the actuators give of a demand: clipped axis by axis, or `scaled` as a vector until every axis fits.
///
/// Clipping turns the direction of a demand far over the limit; scaling keeps it.
#[inline(always)]
pub fn saturate<R: Real>(demand: Vec3<R>, limit: Vec3<R>, scaled: bool) -> Vec3<R> {
    let fitted = if scaled {
        let excess = (demand.abs() / limit).max_component().max(R::one());
        demand * (R::one() / excess)
    } else {
        demand
    };
    // A scaled demand may be over the limit by a rounding.
    fitted.clamp(-limit, limit)
}

#[cfg(test)]
mod tests;
