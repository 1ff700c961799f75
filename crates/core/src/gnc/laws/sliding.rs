//! Sliding mode control put together from its parts.
//!
//! ```text
//! acceleration = (reaching law)(s) - (compensation of the surface's own rate),     s = surface(error, rate)
//! ```
//!
//! The channel then takes off the natural acceleration and adds the gyroscopic torque, as the [`Compensation`] says.

use super::reaching::Reaching;
use super::surface::Surface;
use super::{ChannelError, ChannelMemory};
use crate::number::{Real, Vec3};
use crate::{batch_struct, batch_uniform};

/// How the surface's own rate, ṡ without control, is taken off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OwnRate {
    /// Not at all.
    Off,
    /// slope · rate: exact in translation, in rotation about twice too much, since ε' ≈ e_ω/2. Linear surfaces.
    Linear,
    /// d(surface)/dt at constant rate error.
    Exact,
}

/// Known dynamics that a sliding law takes off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compensation {
    /// -A(r, v): orbit and turning frame. Translation only.
    pub natural: bool,
    /// The surface's own rate.
    pub surface_rate: OwnRate,
    /// Factor of ω × (I ω): +1 cancels it, -1 is the printed sign of SOSMC. Rotation only.
    pub gyroscopic: f64,
}

batch_uniform!(Compensation);

batch_struct! {
    /// A sliding-mode channel.
    pub struct SlidingMode<R> {
        /// s of the errors.
        pub surface: Surface<R>,
        /// ṡ demanded of s.
        pub reaching: Reaching<R>,
        /// What is taken off.
        pub compensation: Compensation,
    }
}

impl<R: Real> SlidingMode<R> {
    /// Demanded acceleration, before natural and gyroscopic compensation \[m/s² or rad/s²\].
    #[inline(always)]
    pub fn acceleration(&self, memory: &mut ChannelMemory<R>, errors: &ChannelError<R>, period: R) -> Vec3<R> {
        let reaching = self.reaching.step(memory, self.surface.value(errors), period);
        match self.compensation.surface_rate {
            OwnRate::Off => reaching,
            OwnRate::Linear => reaching - self.surface.slope() * errors.rate,
            OwnRate::Exact => reaching - self.surface.own_rate(errors),
        }
    }
}
