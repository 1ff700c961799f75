//! Sliding mode control put together from its parts.
//!
//! ```text
//! acceleration = (reaching law)(s) - (compensation of the surface's own rate),     s = surface(error, rate)
//! ```
//!
//! The channel then takes off the natural acceleration and adds the gyroscopic torque, as the [`Compensation`] says.

use super::reaching::Reaching;
use super::surface::Surface;
use super::{ChannelError, one_law_a_batch};
use crate::batch::Batch;
use crate::number::{Real, Vec3};

/// How the surface's own rate, ṡ without control, is taken off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceRate {
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
    pub surface_rate: SurfaceRate,
    /// Factor of ω × (I ω): +1 cancels it, -1 is the printed sign of SOSMC. Rotation only.
    pub gyroscopic: f64,
}

/// A sliding-mode channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlidingMode<R> {
    /// s of the errors.
    pub surface: Surface<R>,
    /// ṡ demanded of s.
    pub reaching: Reaching<R>,
    /// What is taken off.
    pub compensation: Compensation,
}

impl<R: Real> SlidingMode<R> {
    /// Demanded acceleration, before natural and gyroscopic compensation \[m/s² or rad/s²\].
    #[inline(always)]
    pub fn acceleration(&self, errors: &ChannelError<R>) -> Vec3<R> {
        let reaching = self.reaching.rate(self.surface.value(errors));
        match self.compensation.surface_rate {
            SurfaceRate::Off => reaching,
            SurfaceRate::Linear => reaching - self.surface.slope() * errors.rate,
            SurfaceRate::Exact => reaching - self.surface.own_rate(errors),
        }
    }
}

impl<R: Real> Batch<R> for SlidingMode<R> {
    type One = SlidingMode<f64>;

    fn same(one: &SlidingMode<f64>) -> Self {
        Self {
            surface: Batch::same(&one.surface),
            reaching: Batch::same(&one.reaching),
            compensation: one.compensation,
        }
    }

    fn put(&mut self, i: usize, one: &SlidingMode<f64>) {
        if one.compensation != self.compensation {
            one_law_a_batch();
        }
        self.surface.put(i, &one.surface);
        self.reaching.put(i, &one.reaching);
    }

    fn scatter(&self, i: usize) -> SlidingMode<f64> {
        SlidingMode {
            surface: self.surface.scatter(i),
            reaching: self.reaching.scatter(i),
            compensation: self.compensation,
        }
    }

    fn choose(mask: R::Mask, yes: &Self, no: &Self) -> Self {
        Self {
            surface: Batch::choose(mask, &yes.surface, &no.surface),
            reaching: Batch::choose(mask, &yes.reaching, &no.reaching),
            compensation: yes.compensation,
        }
    }
}
