//! Both bodies over one control period.
//!
//! - Force held in H, torque held in body axes, as every closed loop commands: translation is exact ([`HeldStep`]),
//!   rotation is [`spin_step`]. Debris that is a symmetric top tumbles exactly ([`FreeTop`]).
//! - Open loop, both held in body axes: rotation is [`spin_step`]; translation follows by Simpson's rule over the exact
//!   response to a push, with the force turned into H at the beginning, the middle and the end of the step.
//! - Open loop, both held in H: translation is exact; attitude and rate go through RK4 together, since the torque turns
//!   in the body.

use super::attitude::{Inertia, Principal, Spin, renormalized, spin_step};
use super::body::Vehicle;
use super::lvlh::Lvlh;
use super::motion::Motion;
use super::orbit::{HeldStep, Orbit};
use super::rk4::{Dynamics, rk4_step};
use super::top::FreeTop;
use super::wrench::{Held, Wrench, WrenchFrame};
use crate::batch_struct;
use crate::number::{Real, Vec3};

batch_struct! {
    /// Constants of the propagation that do not change at capture.
    pub struct Surroundings<R> {
        /// Mean motion, LVLH at t = 0.
        pub orbit: Orbit<R>,
        /// Translation over one integration step.
        pub translation: HeldStep<R>,
        /// Translation over half of it.
        pub half_step: HeldStep<R>,
        /// The debris' inertia.
        pub debris: Inertia<R>,
        /// Its tumble over one integration step, if it is a symmetric top.
        pub tumble: FreeTop<R>,
    }
}

/// One control period, as the propagation sees it.
#[derive(Clone, Copy, Debug)]
pub struct Period<R> {
    /// Begin \[s\].
    pub time: R,
    /// Integration step \[s\].
    pub step: f64,
    /// Steps in the period.
    pub steps: u32,
    /// Of the bodies, in every lane.
    pub shapes: Shapes,
}

/// What is known of the bodies' inertias, the same for all lanes; what is not known costs only time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Shapes {
    /// Both are diagonal.
    pub principal_axes: bool,
    /// The debris is a symmetric top about its z axis, so that its tumble has a closed form.
    pub symmetric_debris: bool,
}

/// Moves both bodies over one control period.
#[inline(always)]
pub fn propagate<R: Real>(
    around: &Surroundings<R>,
    vehicle: &Vehicle<R>,
    motion: &mut Motion<R>,
    held: &Held<R>,
    period: &Period<R>,
) {
    if period.steps == 1 {
        // No loop here: it would copy every constant it reads to its own place on the stack.
        return integrate(around, vehicle, motion, held, period, period.time);
    }
    for i in 0..period.steps {
        let begin = period.time + R::splat(f64::from(i) * period.step);
        integrate(around, vehicle, motion, held, period, begin);
    }
}

/// One integration step.
#[inline(always)]
fn integrate<R: Real>(
    around: &Surroundings<R>,
    vehicle: &Vehicle<R>,
    motion: &mut Motion<R>,
    held: &Held<R>,
    period: &Period<R>,
    begin: R,
) {
    let (Period { step, shapes, .. }, wrench) = (*period, &held.wrench);
    match held.frame {
        WrenchFrame::Command => {
            let h = R::splat(step);
            let force = wrench.force * vehicle.inverse_mass;
            (motion.position, motion.velocity) = around.translation.advance(motion.position, motion.velocity, force);
            let chaser = motion.chaser();
            motion.set_chaser(if shapes.principal_axes {
                spin_step(&Principal(&vehicle.inertia), &chaser, wrench.torque, h)
            } else {
                spin_step(&vehicle.inertia, &chaser, wrench.torque, h)
            });
            tumble(around, motion, step, shapes);
        }
        WrenchFrame::Body => body_step(around, vehicle, motion, *wrench, period, begin),
        WrenchFrame::Lvlh => lvlh_step(around, vehicle, motion, *wrench, period, begin),
    }
}

/// The debris over a step: nothing turns it.
#[inline(always)]
fn tumble<R: Real>(around: &Surroundings<R>, motion: &mut Motion<R>, step: f64, shapes: Shapes) {
    let (debris, h, none) = (motion.debris(), R::splat(step), Vec3::zero());
    motion.set_debris(if shapes.symmetric_debris {
        around.tumble.step(&debris)
    } else if shapes.principal_axes {
        spin_step(&Principal(&around.debris), &debris, none, h)
    } else {
        spin_step(&around.debris, &debris, none, h)
    });
}

/// A step under a wrench held in body axes. Not inlined, as the next: open loop checks the plant, it is not flown in bulk.
/// The wrench comes by value: a reference that leaves the loop would keep it in memory at every tick.
#[inline(never)]
fn body_step<R: Real>(
    around: &Surroundings<R>,
    vehicle: &Vehicle<R>,
    motion: &mut Motion<R>,
    wrench: Wrench<R>,
    period: &Period<R>,
    begin: R,
) {
    let Period { step, shapes, .. } = *period;
    let h = R::splat(step);
    let start = motion.chaser();
    let middle = spin_step(&vehicle.inertia, &start, wrench.torque, h * R::splat(0.5));
    let end = spin_step(&vehicle.inertia, &start, wrench.torque, h);
    let push = |spin: &Spin<R>, fraction: f64| {
        let lvlh = Lvlh::at(&around.orbit, begin + R::splat(fraction * step));
        let force = (lvlh.attitude.conjugate() * spin.attitude).rotate(wrench.force);
        force * vehicle.inverse_mass
    };
    let sixth = h * R::splat(1.0 / 6.0);
    let (first, second, third) = (push(&start, 0.0), push(&middle, 0.5) * R::splat(4.0), push(&end, 1.0));
    let none = Vec3::zero();
    // Pushes at the beginning, the middle and the end of the step coast on for the rest of it.
    let coast = &around.half_step;
    let (r, v) = coast.advance(motion.position, motion.velocity + first * sixth, none);
    let (r, v) = coast.advance(r, v + second * sixth, none);
    (motion.position, motion.velocity) = (r, v + third * sixth);
    motion.set_chaser(end);
    tumble(around, motion, step, shapes);
}

/// A step under a wrench held in H.
#[inline(never)]
fn lvlh_step<R: Real>(
    around: &Surroundings<R>,
    vehicle: &Vehicle<R>,
    motion: &mut Motion<R>,
    wrench: Wrench<R>,
    period: &Period<R>,
    begin: R,
) {
    let Period { step, shapes, .. } = *period;
    let h = R::splat(step);
    let acceleration = wrench.force * vehicle.inverse_mass;
    (motion.position, motion.velocity) = around.translation.advance(motion.position, motion.velocity, acceleration);
    let turning = TurningTorque { orbit: &around.orbit, inertia: &vehicle.inertia, torque: wrench.torque, begin, step };
    let end = rk4_step(&turning, &motion.chaser(), h);
    motion.set_chaser(Spin { attitude: renormalized(end.attitude), rate: end.rate });
    tumble(around, motion, step, shapes);
}

/// q' and ω' of a body under a torque held in H.
struct TurningTorque<'a, R> {
    orbit: &'a Orbit<R>,
    inertia: &'a Inertia<R>,
    torque: Vec3<R>,
    begin: R,
    step: f64,
}

impl<R: Real> Dynamics<R> for TurningTorque<'_, R> {
    type State = Spin<R>;

    #[inline(always)]
    fn rate(&self, fraction: f64, spin: &Spin<R>) -> Spin<R> {
        let lvlh = Lvlh::at(self.orbit, self.begin + R::splat(fraction * self.step));
        let torque = (lvlh.attitude.conjugate() * spin.attitude).rotate_inverse(self.torque);
        Spin {
            attitude: spin.attitude.times_pure(spin.rate * R::splat(0.5)),
            rate: self.inertia.angular_acceleration(spin.rate, torque),
        }
    }

    #[inline(always)]
    fn advance(spin: &Spin<R>, time: R, rate: &Spin<R>) -> Spin<R> {
        let mut attitude = spin.attitude;
        for i in 0..4 {
            attitude.0[i] = time.mul_add(rate.attitude.0[i], attitude.0[i]);
        }
        Spin { attitude, rate: Vec3::splat(time).mul_add(rate.rate, spin.rate) }
    }
}

#[cfg(test)]
mod tests;
