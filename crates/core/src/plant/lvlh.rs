//! The target orbit's frame H: x radial out, y along-track, z along the orbit normal, turning at n about z.
//!
//! ```text
//! q_HN(t) = q_HN(0) ⊗ [cos(nt/2), 0, 0, sin(nt/2)]
//! ```

use super::orbit::Orbit;
use crate::number::{Quat, Real, Vec3};

/// H at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Lvlh<R> {
    /// H -> N.
    pub attitude: Quat<R>,
    /// omega_HN_H \[rad/s\].
    pub rate: Vec3<R>,
}

impl<R: Real> Lvlh<R> {
    /// H at time t \[s\].
    #[inline(always)]
    pub fn at(orbit: &Orbit<R>, time: R) -> Self {
        Self {
            attitude: orbit.lvlh_attitude * Quat::about_z(orbit.mean_motion * time),
            rate: Vec3([R::zero(), R::zero(), orbit.mean_motion]),
        }
    }
}

#[cfg(test)]
mod tests;
