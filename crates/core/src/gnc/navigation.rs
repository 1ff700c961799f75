//! Navigation: from what the sensors measure to what guidance and laws believe.
//!
//! Assumption: what is measured is believed; no filter.

use crate::hardware::sensors::Measurement;
use crate::number::Real;
use crate::part::Part;
use crate::plant::motion::Motion;

/// What the spacecraft believes of both bodies' motion. Guidance and laws see nothing else.
#[derive(Clone, Copy, Debug)]
pub struct Estimate<R> {
    /// Believed motion, as [`Motion`] has it.
    pub motion: Motion<R>,
}

/// Believes the measurement.
#[derive(Clone, Copy, Debug)]
pub struct Direct;

impl<R: Real> Part<R> for Direct {
    type Memory = ();
    type Input<'a> = &'a Measurement<R>;
    type Output = Estimate<R>;

    fn begin(&self) {}

    #[inline(always)]
    fn step(&self, (): &mut (), measured: &Measurement<R>) -> Estimate<R> {
        Estimate { motion: measured.motion }
    }
}
