//! Allocation: from the wrench that a law demands to what each actuator is asked for.
//!
//! Assumption: one generator of force and torque for each axis, so that the demand is the command.

use crate::number::Real;
use crate::part::Part;
use crate::plant::wrench::Wrench;

/// Asks the generator of each axis for its component.
#[derive(Clone, Copy, Debug)]
pub struct Direct;

impl<R: Real> Part<R> for Direct {
    type Memory = ();
    type Input<'a> = &'a Wrench<R>;
    type Output = Wrench<R>;

    fn begin(&self) {}

    #[inline(always)]
    fn step(&self, (): &mut (), demand: &Wrench<R>) -> Wrench<R> {
        *demand
    }
}
