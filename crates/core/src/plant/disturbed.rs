//! Both bodies over one control period under disturbances, whatever their attitude does to them.
//!
//! - Rotation: momentum and attitude through RK4 together, the attitude then by the expansion of [`super::attitude`] with the
//!   torque at both ends of the step. Fourth order.
//! - Translation: what is held in H acts exactly ([`super::orbit::HeldStep`]); all other forces act by Simpson's rule over the
//!   exact response to a push, at the beginning, the middle and the end of the step. r is relative to the debris, which its own
//!   forces move as well: the acceleration is F_c/m_c - F_d/m_d before capture, ΣF/m of the stack after it.
//!
//! Assumption: H stays the frame of the circular orbit, however the debris is pushed.

use super::attitude::{Inertia, RigidBody, Spin, rotated};
use super::disturbances::{Acting, Disturbances, Exposed, Of};
use super::lvlh::Lvlh;
use super::motion::Motion;
use super::propagate::{Period, Surroundings};
use super::rk4::{Dynamics, rk4_sum};
use super::wrench::{Held, Wrench, WrenchFrame};
use crate::batch_struct;
use crate::number::{Quat, Real, Vec3};
use crate::plant::body::Vehicle;

batch_struct! {
    /// How the debris sits on the chaser after capture.
    pub struct Joint<R> {
        /// 1 after capture, 0 before.
        pub joined: R,
        /// D -> C.
        pub mount: Quat<R>,
        /// From the debris' centre of mass to the chaser's, C axes \[m\]; zero in a merge that neglects it.
        pub offset: Vec3<R>,
    }
}

impl<R: Real> Joint<R> {
    /// Two separate bodies.
    #[inline(always)]
    pub fn open() -> Self {
        Self { joined: R::zero(), mount: Quat::identity(), offset: Vec3::zero() }
    }
}

/// The plant and all that acts on it over a control period.
pub struct Disturbed<'a, R> {
    /// Orbit and debris.
    pub around: &'a Surroundings<R>,
    /// What flies.
    pub vehicle: &'a Vehicle<R>,
    /// Masses of chaser and debris \[kg\].
    pub masses: [R; 2],
    /// The bodies' connection.
    pub joint: &'a Joint<R>,
    /// Disturbances.
    pub disturbances: &'a Disturbances<R>,
    /// Those that act.
    pub acting: Acting,
    /// The actuators' wrench.
    pub held: Held<R>,
}

impl<R: Real> Disturbed<'_, R> {
    /// Moves both bodies over the period.
    #[inline(never)]
    pub fn propagate(&self, motion: &mut Motion<R>, period: &Period<R>) {
        for i in 0..period.steps {
            self.integrate(motion, period.time + R::splat(f64::from(i) * period.step), R::splat(period.step));
        }
    }

    fn integrate(&self, motion: &mut Motion<R>, begin: R, h: R) {
        let half = h * R::splat(0.5);
        let chaser = |time: R, attitude: &Quat<R>| self.on_chaser(time, attitude).torque;
        let debris = |time: R, attitude: &Quat<R>| self.on_debris(time, attitude).torque;
        let (start, tumbling) = (motion.chaser(), motion.debris());
        let middle = turn(&self.vehicle.inertia, &start, begin, half, &chaser);
        let end = turn(&self.vehicle.inertia, &start, begin, h, &chaser);
        let tumbled = turn(&self.around.debris, &tumbling, begin, half, &debris);
        let tumbled_on = turn(&self.around.debris, &tumbling, begin, h, &debris);

        let sixth = h * R::splat(1.0 / 6.0);
        let first = self.push(begin, &start, &tumbling) * sixth;
        let second = self.push(begin + half, &middle, &tumbled) * (sixth * R::splat(4.0));
        let third = self.push(begin + h, &end, &tumbled_on) * sixth;
        let held = match self.held.frame {
            WrenchFrame::Body => Vec3::zero(),
            WrenchFrame::Command | WrenchFrame::Lvlh => self.held.wrench.force * self.vehicle.inverse_mass,
        };
        let coast = &self.around.half_step;
        let (r, v) = coast.advance(motion.position, motion.velocity + first, held);
        let (r, v) = coast.advance(r, v + second, held);
        (motion.position, motion.velocity) = (r, v + third);
        motion.set_chaser(end);
        motion.set_debris(tumbled_on);
    }

    /// Wrench on what flies, body axes, but for a force that the actuators hold in H.
    fn on_chaser(&self, time: R, attitude: &Quat<R>) -> Wrench<R> {
        let lvlh = Lvlh::at(&self.around.orbit, time);
        let body = |of, attitude, inertia| Exposed::new(of, attitude, inertia, &lvlh);
        let own = body(Of::Chaser, *attitude, &self.vehicle.inertia.tensor);
        let carried = body(Of::Debris, *attitude * self.joint.mount, &self.around.debris.tensor);
        let natural = self.disturbances.on(self.acting, &own);
        let loads = self.disturbances.loads(self.acting, &own);
        let debris = self.disturbances.loads(self.acting, &carried);
        let debris_force = self.joint.mount.rotate(debris.force) * self.joint.joined;
        let debris_torque = self.joint.mount.rotate(debris.torque) * self.joint.joined;
        let [chaser_mass, debris_mass] = self.masses;
        let share = chaser_mass / (chaser_mass + debris_mass);
        // Both offsets from the stack's centre of mass are zero before capture.
        let levers = (self.joint.offset * (R::one() - share)).cross(loads.force)
            - (self.joint.offset * share).cross(debris_force);

        let (force, torque) = match self.held.frame {
            WrenchFrame::Command => (Vec3::zero(), self.held.wrench.torque),
            WrenchFrame::Body => (self.held.wrench.force, self.held.wrench.torque),
            WrenchFrame::Lvlh => (Vec3::zero(), own.to_lvlh.rotate_inverse(self.held.wrench.torque)),
        };
        Wrench { force: force + natural.force + debris_force, torque: torque + natural.torque + debris_torque + levers }
    }

    /// Wrench on free debris, its axes.
    fn on_debris(&self, time: R, attitude: &Quat<R>) -> Wrench<R> {
        let lvlh = Lvlh::at(&self.around.orbit, time);
        self.disturbances.on(self.acting, &Exposed::new(Of::Debris, *attitude, &self.around.debris.tensor, &lvlh))
    }

    /// Relative acceleration in H that the forces in body axes give \[m/s²\].
    fn push(&self, time: R, chaser: &Spin<R>, debris: &Spin<R>) -> Vec3<R> {
        let to_lvlh = Lvlh::at(&self.around.orbit, time).attitude.conjugate();
        let own = self.on_chaser(time, &chaser.attitude).force * self.vehicle.inverse_mass;
        let free = (R::one() - self.joint.joined) / self.masses[1];
        let others = self.on_debris(time, &debris.attitude).force * free;
        (to_lvlh * chaser.attitude).rotate(own) - (to_lvlh * debris.attitude).rotate(others)
    }
}

/// Attitude and momentum of a body under a torque that depends on time and attitude, body axes.
struct Turning<'a, R, F> {
    body: &'a Inertia<R>,
    begin: R,
    h: R,
    torque: &'a F,
}

#[derive(Clone, Copy)]
struct Turned<R> {
    attitude: Quat<R>,
    momentum: Vec3<R>,
}

impl<R: Real, F: Fn(R, &Quat<R>) -> Vec3<R>> Dynamics<R> for Turning<'_, R, F> {
    type State = Turned<R>;

    fn rate(&self, fraction: f64, state: &Turned<R>) -> Turned<R> {
        let rate = self.body.rate(state.momentum);
        let torque = (self.torque)(self.begin + self.h * R::splat(fraction), &state.attitude);
        Turned {
            attitude: state.attitude.times_pure(rate * R::splat(0.5)),
            momentum: torque - rate.cross(state.momentum),
        }
    }

    fn advance(state: &Turned<R>, time: R, rate: &Turned<R>) -> Turned<R> {
        state.advanced(time, rate)
    }
}

impl<R: Real> Turned<R> {
    fn advanced(&self, time: R, rate: &Self) -> Self {
        let mut attitude = self.attitude;
        for i in 0..4 {
            attitude.0[i] = time.mul_add(rate.attitude.0[i], attitude.0[i]);
        }
        Self { attitude, momentum: Vec3::splat(time).mul_add(rate.momentum, self.momentum) }
    }
}

/// One step of length `h` from `begin` under a torque in body axes.
fn turn<R: Real>(
    body: &Inertia<R>,
    spin: &Spin<R>,
    begin: R,
    h: R,
    torque: &impl Fn(R, &Quat<R>) -> Vec3<R>,
) -> Spin<R> {
    let turning = Turning { body, begin, h, torque };
    let start = Turned { attitude: spin.attitude, momentum: body.momentum(spin.rate) };
    let pull = turning.rate(0.0, &start);
    let sum = rk4_sum(&turning, &start, &pull, h);
    let sixth = h * R::splat(1.0 / 6.0);
    let end = start.advanced(sixth, &sum);
    let rate = spin.rate + body.rate(sum.momentum * sixth);
    let bend = pull.momentum - turning.rate(1.0, &end).momentum;
    Spin { attitude: rotated(body, spin, rate, bend, h), rate }
}

#[cfg(test)]
mod tests;
