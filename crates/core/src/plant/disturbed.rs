//! Both bodies over one control period under disturbances, whatever their attitude does to them.
//!
//! - Rotation: momentum and attitude through RK4 together, the attitude then by the expansion of [`super::attitude`] with the
//!   torque at both ends of the step. Fourth order.
//! - Translation: what is held in H acts exactly ([`super::orbit::HeldStep`]); all other forces act by Simpson's rule over the
//!   exact response to a push, at the beginning, the middle and the end of the step. r is relative to the debris, which its own
//!   forces move as well: the acceleration is F_c/m_c - F_d/m_d before capture, ΣF/m of the stack after it.
//!
//! Assumptions:
//! 1. H stays the frame of the circular orbit, however the debris is pushed.
//! 2. At capture H begins anew at the debris: what its own forces have moved it since t = 0 is dropped.

use super::attitude::{Inertia, RigidBody, Spin, rotated};
use super::disturbances::constant::LoadAxes;
use super::disturbances::{Acting, Disturbances, Exposed, Which};
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
    /// Masses of chaser and debris \[kg\].
    pub masses: [R; 2],
    /// Disturbances.
    pub disturbances: &'a Disturbances<R>,
    /// Those that act.
    pub acting: Acting,
    /// What flies.
    pub vehicle: &'a Vehicle<R>,
    /// The bodies' connection.
    pub joint: &'a Joint<R>,
    /// The actuators' wrench.
    pub held: Held<R>,
}

impl<R: Real> Disturbed<'_, R> {
    /// Moves both bodies over the period.
    #[inline(always)]
    pub fn propagate(&self, motion: &mut Motion<R>, period: &Period<R>) {
        for i in 0..period.steps {
            let begin = period.time + R::splat(f64::from(i) * period.step);
            self.integrate(motion, begin, R::splat(period.step));
        }
    }

    #[inline(always)]
    fn integrate(&self, motion: &mut Motion<R>, begin: R, h: R) {
        let half = h * R::splat(0.5);
        let (chaser, debris) = (motion.chaser(), motion.debris());
        let [first, middle, last] = [begin, begin + half, begin + h].map(|time| self.to_lvlh_at(time));
        let over = Span { to_lvlh: [first, middle, last], h };
        let chaser_end = self.turn(Which::Chaser, &chaser, &over);
        let debris_end = self.turn(Which::Debris, &debris, &over);

        let held = match self.held.frame {
            WrenchFrame::Body => Vec3::zero(),
            WrenchFrame::Command | WrenchFrame::Lvlh => self.held.wrench.force * self.vehicle.inverse_mass,
        };
        if self.acting.constant == LoadAxes::None && self.held.frame != WrenchFrame::Body {
            // No other forces.
            let exact = &self.around.translation;
            (motion.position, motion.velocity) = exact.advance(motion.position, motion.velocity, held);
        } else {
            let over = Span { to_lvlh: [first, self.to_lvlh_at(begin + half * R::splat(0.5)), middle], h: half };
            let chaser_middle = self.turn(Which::Chaser, &chaser, &over);
            let debris_middle = self.turn(Which::Debris, &debris, &over);
            let sixth = h * R::splat(1.0 / 6.0);
            let push = self.push(&first, &chaser, &debris) * sixth;
            let second = self.push(&middle, &chaser_middle, &debris_middle) * (sixth * R::splat(4.0));
            let third = self.push(&last, &chaser_end, &debris_end) * sixth;
            let coast = &self.around.half_step;
            let (r, v) = coast.advance(motion.position, motion.velocity + push, held);
            let (r, v) = coast.advance(r, v + second, held);
            (motion.position, motion.velocity) = (r, v + third);
        }
        motion.set_chaser(chaser_end);
        motion.set_debris(debris_end);
    }

    /// N -> H.
    #[inline(always)]
    fn to_lvlh_at(&self, time: R) -> Quat<R> {
        Lvlh::at(&self.around.orbit, time).attitude.conjugate()
    }

    #[inline(always)]
    fn inertia(&self, which: Which) -> &Inertia<R> {
        match which {
            Which::Chaser => &self.vehicle.inertia,
            Which::Debris => &self.around.debris,
        }
    }

    /// Wrench on a body, its axes, but for a force that the actuators hold in H. `to_lvlh` is N -> H.
    #[inline(always)]
    fn on(&self, which: Which, to_lvlh: &Quat<R>, attitude: Quat<R>) -> Wrench<R> {
        let n = self.around.orbit.mean_motion;
        let body =
            Exposed { which, to_lvlh: *to_lvlh * attitude, inertia: &self.inertia(which).tensor, mean_motion: n };
        let free = self.disturbances.on_whole(self.acting, &body) + self.disturbances.loads(self.acting, &body);
        match which {
            Which::Debris => free,
            Which::Chaser => free + self.carried(to_lvlh, attitude, &body) + self.actuated(&body),
        }
    }

    /// What the debris adds to the stack: its own loads, and the levers of both bodies' forces about the common centre of mass.
    /// Zero before capture.
    #[inline(always)]
    fn carried(&self, to_lvlh: &Quat<R>, attitude: Quat<R>, chaser: &Exposed<'_, R>) -> Wrench<R> {
        let Joint { joined, mount, offset } = *self.joint;
        let debris = Exposed { which: Which::Debris, to_lvlh: *to_lvlh * (attitude * mount), ..*chaser };
        let Wrench { force, torque } = self.disturbances.loads(self.acting, &debris);
        let (force, torque) = (mount.rotate(force) * joined, mount.rotate(torque) * joined);
        let own = self.disturbances.loads(self.acting, chaser).force;
        let share = self.masses[0] / (self.masses[0] + self.masses[1]);
        let levers = (offset * (R::one() - share)).cross(own) - (offset * share).cross(force);
        Wrench { force, torque: torque + levers }
    }

    /// What the actuators give, but for a force held in H.
    #[inline(always)]
    fn actuated(&self, chaser: &Exposed<'_, R>) -> Wrench<R> {
        let Wrench { force, torque } = self.held.wrench;
        match self.held.frame {
            WrenchFrame::Command => Wrench { force: Vec3::zero(), torque },
            WrenchFrame::Body => Wrench { force, torque },
            WrenchFrame::Lvlh => Wrench { force: Vec3::zero(), torque: chaser.to_lvlh.rotate_inverse(torque) },
        }
    }

    /// Relative acceleration in H that the forces in body axes give \[m/s²\].
    #[inline(always)]
    fn push(&self, to_lvlh: &Quat<R>, chaser: &Spin<R>, debris: &Spin<R>) -> Vec3<R> {
        let own = self.on(Which::Chaser, to_lvlh, chaser.attitude).force * self.vehicle.inverse_mass;
        let free = (R::one() - self.joint.joined) / self.masses[1];
        let others = self.on(Which::Debris, to_lvlh, debris.attitude).force * free;
        (*to_lvlh * chaser.attitude).rotate(own) - (*to_lvlh * debris.attitude).rotate(others)
    }

    /// A body after a step.
    #[inline(always)]
    fn turn(&self, which: Which, spin: &Spin<R>, over: &Span<R>) -> Spin<R> {
        let body = self.inertia(which);
        let turning = Turning { plant: self, which, over };
        let start = Turned { attitude: spin.attitude, momentum: body.momentum(spin.rate) };
        let pull = turning.rate(0.0, &start);
        let sum = rk4_sum(&turning, &start, &pull, over.h);
        let sixth = over.h * R::splat(1.0 / 6.0);
        let end = start.advanced(sixth, &sum);
        let rate = spin.rate + body.rate(sum.momentum * sixth);
        let bend = pull.momentum - turning.rate(1.0, &end).momentum;
        Spin { attitude: rotated(body, spin, rate, bend, over.h), rate }
    }
}

/// A step, or half of one.
struct Span<R> {
    /// N -> H at its beginning, middle and end.
    to_lvlh: [Quat<R>; 3],
    /// Its length \[s\].
    h: R,
}

/// q' and L' of a body.
struct Turning<'a, R> {
    plant: &'a Disturbed<'a, R>,
    which: Which,
    over: &'a Span<R>,
}

#[derive(Clone, Copy)]
struct Turned<R> {
    attitude: Quat<R>,
    momentum: Vec3<R>,
}

impl<R: Real> Dynamics<R> for Turning<'_, R> {
    type State = Turned<R>;

    #[inline(always)]
    fn rate(&self, fraction: f64, state: &Turned<R>) -> Turned<R> {
        let rate = self.plant.inertia(self.which).rate(state.momentum);
        let to_lvlh = &self.over.to_lvlh[(2.0 * fraction) as usize];
        let torque = self.plant.on(self.which, to_lvlh, state.attitude).torque;
        Turned {
            attitude: state.attitude.times_pure(rate * R::splat(0.5)),
            momentum: torque - rate.cross(state.momentum),
        }
    }

    #[inline(always)]
    fn advance(state: &Turned<R>, time: R, rate: &Turned<R>) -> Turned<R> {
        state.advanced(time, rate)
    }
}

impl<R: Real> Turned<R> {
    #[inline(always)]
    fn advanced(&self, time: R, rate: &Self) -> Self {
        let mut attitude = self.attitude;
        for i in 0..4 {
            attitude.0[i] = time.mul_add(rate.attitude.0[i], attitude.0[i]);
        }
        Self { attitude, momentum: Vec3::splat(time).mul_add(rate.momentum, self.momentum) }
    }
}

#[cfg(test)]
mod tests;
