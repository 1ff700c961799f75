//! The torque of a gravity that is weaker on the far side of a body.
//!
//! ```text
//! τ = 3 n² u × (I u)          n² = μ/r³, u from the planet to the orbit, body axes
//! ```
//!
//! Assumptions: central field; the body small against the orbit's radius r; a circular orbit, and the direction to the planet
//! that of the target's orbit for both bodies (a chaser at distance d sees it turned by d/r).
//! Source: Schaub & Junkins, *Analytical Mechanics of Space Systems*, §4.4; Hughes, *Spacecraft Attitude Dynamics*, §8.1.

use super::Exposed;
use crate::number::{Real, Vec3};
use crate::part::Part;
use crate::plant::wrench::Wrench;

/// It needs no numbers of its own.
pub struct GravityGradient;

impl<R: Real> Part<R> for GravityGradient {
    type Memory = ();
    type Input<'a> = &'a Exposed<'a, R>;
    type Output = Wrench<R>;

    fn begin(&self) {}

    #[inline(always)]
    fn step(&self, _: &mut (), body: &Exposed<'_, R>) -> Wrench<R> {
        let up = body.to_lvlh.rotate_inverse(Vec3([R::one(), R::zero(), R::zero()]));
        let n2 = body.mean_motion * body.mean_motion;
        Wrench { force: Vec3::zero(), torque: up.cross(*body.inertia * up) * (n2 * R::splat(3.0)) }
    }
}

#[cfg(test)]
mod tests;
