//! Both bodies over one control period.
//!
//! - Held wrench (every closed loop): force held in H, torque held in body axes. Translation is then exact
//!   ([`HeldStep`]); rotation is [`spin_step`].
//! - Open-loop wrench in one frame: given and held in H or in the chaser's body axes. Translation and rotation are
//!   coupled through the frame, so all thirteen states go through RK4 together.

use super::attitude::{Inertia, Principal, RigidBody, Spin, renormalized, spin_step};
use super::lvlh::Lvlh;
use super::orbit::{HeldStep, natural_acceleration};
use super::rk4::{Dynamics, rk4_step};
use crate::batch_struct;
use crate::case::{Motion, Orbit};
use crate::number::{Quat, Real, Vec3};

batch_struct! {
    /// A force \[N\] and a torque \[N m\].
    pub struct Wrench<R> {
        /// In the axes that its [`WrenchFrame`] names.
        pub force: Vec3<R>,
        /// Likewise.
        pub torque: Vec3<R>,
    }
}

impl<R: Real> Wrench<R> {
    /// No force, no torque.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { force: Vec3::zero(), torque: Vec3::zero() }
    }
}

/// The axes in which a wrench is given, and in which it is held over the period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WrenchFrame {
    /// Force in H, torque in body axes: what the laws command.
    Command,
    /// Both in H.
    Lvlh,
    /// Both in the chaser's body axes.
    Body,
}

batch_struct! {
    /// Constants of the propagation that do not change at capture.
    pub struct Surroundings<R> {
        /// Mean motion, LVLH at t = 0.
        pub orbit: Orbit<R>,
        /// Translation over one integration step.
        pub translation: HeldStep<R>,
        /// The debris' inertia.
        pub debris: Inertia<R>,
    }
}

batch_struct! {
    /// The body that flies: the chaser, after capture the stack.
    pub struct Vehicle<R> {
        /// \[kg\]
        pub mass: R,
        /// \[1/kg\]
        pub inverse_mass: R,
        /// About its centre of mass, C axes.
        pub inertia: Inertia<R>,
    }
}

impl<R: Real> Vehicle<R> {
    /// From mass \[kg\] and inertia.
    #[inline(always)]
    pub fn new(mass: R, inertia: Inertia<R>) -> Self {
        Self { mass, inverse_mass: R::one() / mass, inertia }
    }
}

/// One control period, as the propagation sees it.
#[derive(Clone, Copy, Debug)]
pub struct Period {
    /// Begin \[s\].
    pub time: f64,
    /// Integration step \[s\].
    pub step: f64,
    /// Steps in the period.
    pub steps: u32,
    /// Both bodies' inertias are diagonal in every lane.
    pub principal_axes: bool,
}

/// Moves both bodies over one control period.
#[inline(always)]
pub fn propagate<R: Real>(
    around: &Surroundings<R>,
    vehicle: &Vehicle<R>,
    motion: &mut Motion<R>,
    wrench: &Wrench<R>,
    frame: WrenchFrame,
    period: &Period,
) {
    let Period { time, step, steps, principal_axes } = *period;
    if frame != WrenchFrame::Command {
        for i in 0..steps {
            coupled_step(around, vehicle, motion, wrench, frame, (time + f64::from(i) * step, step));
        }
        return;
    }
    let acceleration = wrench.force * vehicle.inverse_mass;
    for _ in 0..steps {
        (motion.position, motion.velocity) = around.translation.advance(motion.position, motion.velocity, acceleration);
        if principal_axes {
            spin_both(&Principal(&vehicle.inertia), &Principal(&around.debris), motion, wrench.torque, step);
        } else {
            spin_both(&vehicle.inertia, &around.debris, motion, wrench.torque, step);
        }
    }
}

#[inline(always)]
fn spin_both<R: Real, B: RigidBody<R>>(vehicle: &B, debris: &B, motion: &mut Motion<R>, torque: Vec3<R>, step: f64) {
    let h = R::splat(step);
    motion.set_chaser(spin_step(vehicle, &motion.chaser(), torque, h));
    motion.set_debris(spin_step(debris, &motion.debris(), Vec3::zero(), h));
}

impl<R: Real> Motion<R> {
    /// Attitude and rate of the chaser (after capture of the stack).
    #[inline(always)]
    pub fn chaser(&self) -> Spin<R> {
        Spin { attitude: self.chaser_attitude, rate: self.chaser_rate }
    }

    /// Attitude and rate of the debris.
    #[inline(always)]
    pub fn debris(&self) -> Spin<R> {
        Spin { attitude: self.debris_attitude, rate: self.debris_rate }
    }

    #[inline(always)]
    fn set_chaser(&mut self, spin: Spin<R>) {
        (self.chaser_attitude, self.chaser_rate) = (spin.attitude, spin.rate);
    }

    #[inline(always)]
    fn set_debris(&mut self, spin: Spin<R>) {
        (self.debris_attitude, self.debris_rate) = (spin.attitude, spin.rate);
    }
}

/// The vehicle under a wrench whose force or torque turns with it or with H.
struct OpenLoop<'a, R> {
    orbit: &'a Orbit<R>,
    vehicle: &'a Vehicle<R>,
    wrench: &'a Wrench<R>,
    body_frame: bool,
    time: f64,
    step: f64,
}

#[derive(Clone, Copy)]
struct Coupled<R> {
    position: Vec3<R>,
    velocity: Vec3<R>,
    attitude: Quat<R>,
    rate: Vec3<R>,
}

impl<R: Real> Dynamics<R> for OpenLoop<'_, R> {
    type State = Coupled<R>;

    #[inline(always)]
    fn rate(&self, fraction: f64, state: &Coupled<R>) -> Coupled<R> {
        let lvlh = Lvlh::at(self.orbit, self.time + fraction * self.step);
        let chaser_to_lvlh = lvlh.attitude.conjugate() * state.attitude;
        let (force, torque) = if self.body_frame {
            (chaser_to_lvlh.rotate(self.wrench.force), self.wrench.torque)
        } else {
            (self.wrench.force, chaser_to_lvlh.rotate_inverse(self.wrench.torque))
        };
        Coupled {
            position: state.velocity,
            velocity: natural_acceleration(self.orbit.mean_motion, state.position, state.velocity)
                + force * self.vehicle.inverse_mass,
            attitude: state.attitude.times_pure(state.rate * R::splat(0.5)),
            rate: self.vehicle.inertia.angular_acceleration(state.rate, torque),
        }
    }

    #[inline(always)]
    fn advance(state: &Coupled<R>, time: R, rate: &Coupled<R>) -> Coupled<R> {
        let along = Vec3::splat(time);
        let mut attitude = state.attitude;
        for i in 0..4 {
            attitude.0[i] = time.mul_add(rate.attitude.0[i], attitude.0[i]);
        }
        Coupled {
            position: along.mul_add(rate.position, state.position),
            velocity: along.mul_add(rate.velocity, state.velocity),
            attitude,
            rate: along.mul_add(rate.rate, state.rate),
        }
    }
}

/// Not inlined: open loop is flown to check the plant, never in bulk.
#[inline(never)]
fn coupled_step<R: Real>(
    around: &Surroundings<R>,
    vehicle: &Vehicle<R>,
    motion: &mut Motion<R>,
    wrench: &Wrench<R>,
    frame: WrenchFrame,
    (time, step): (f64, f64),
) {
    let body_frame = frame == WrenchFrame::Body;
    let dynamics = OpenLoop { orbit: &around.orbit, vehicle, wrench, body_frame, time, step };
    let state = Coupled {
        position: motion.position,
        velocity: motion.velocity,
        attitude: motion.chaser_attitude,
        rate: motion.chaser_rate,
    };
    let after = rk4_step(&dynamics, &state, R::splat(step));
    (motion.position, motion.velocity) = (after.position, after.velocity);
    (motion.chaser_attitude, motion.chaser_rate) = (renormalized(after.attitude), after.rate);
    motion.set_debris(spin_step(&around.debris, &motion.debris(), Vec3::zero(), R::splat(step)));
}
