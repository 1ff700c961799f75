//! How far the vehicle is from its goal.
//!
//! ```text
//! e_r = r - r_des    e_v = v - v_des    q_e = q_ref* ⊗ q_C (short way round)    e_ω = ω_C - R ω_ref, in C
//! ```

use super::guidance::Target;
use crate::number::{Quat, Real, Vec3};
use crate::plant::motion::Motion;

/// Errors of one instant; attitude and rates in C, translation in H.
#[derive(Clone, Copy, Debug)]
pub struct TrackingError<R> {
    /// e_r \[m\].
    pub position: Vec3<R>,
    /// e_v \[m/s\].
    pub velocity: Vec3<R>,
    /// q_e: C -> reference, scalar part not negative.
    pub attitude: Quat<R>,
    /// e_ω \[rad/s\].
    pub rate: Vec3<R>,
}

impl<R: Real> TrackingError<R> {
    /// Of a motion against its target.
    #[inline(always)]
    pub fn between(motion: &Motion<R>, target: &Target<R>) -> Self {
        let attitude = target.attitude.conjugate() * motion.chaser_attitude;
        Self {
            position: motion.position - target.position,
            velocity: motion.velocity - target.velocity,
            attitude: attitude.short_way(),
            rate: motion.chaser_rate - attitude.rotate_inverse(target.rate),
        }
    }
}

#[cfg(test)]
mod tests;
