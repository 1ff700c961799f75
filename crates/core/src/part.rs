//! The one shape of whatever is on board or acts on a body: parameters, memory, a step.
//!
//! Parameters are the part itself, a lane each. Memory is passed in and out; the flight holds it, and a lane that begins
//! another flight gets the memory of a beginning. Which part flies is the same for all lanes of a batch.

use crate::batch::Batch;
use crate::number::Real;

/// A sensor, navigator, law, allocator, actuator or disturbance.
pub trait Part<R: Real> {
    /// What it remembers from one control period to the next; `()` where it remembers nothing, which costs nothing.
    type Memory: Batch<R>;
    /// What it is given at a step.
    type Input<'a>;
    /// What comes of a step.
    type Output;

    /// Its memory when a flight begins.
    fn begin(&self) -> Self::Memory;

    /// One control period.
    fn step(&self, memory: &mut Self::Memory, input: Self::Input<'_>) -> Self::Output;

    /// Lanes in which the bodies have just become one.
    #[inline(always)]
    fn hand_over(&self, _memory: &mut Self::Memory, _lanes: R::Mask) {}
}
