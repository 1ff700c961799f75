//! What a flight is judged by, gathered tick by tick in every lane. Each quantity is defined here and nowhere else.
//!
//! A command held from t_k to t_{k+1} = t_k + T counts for T. Sums run over the flown ticks.
//!
//! | quantity | definition |
//! |---|---|
//! | impulse, torque impulse | Σ \|F_i\| T, Σ \|τ_i\| T per axis: what was applied |
//! | delta_v | Σ \|F_i\| T / m per axis, m the true mass of what flies |
//! | peak | largest \|F_i\|, \|τ_i\| over axes and time, demanded and applied |
//! | saturated share | time with at least one axis over its limit, of the time flown |
//! | chattering | Σ_k Σ_i \|F_i(k) - F_i(k-1)\| of the demand, per second flown |
//! | settling time | from capture to the first tick from which angle and rate against H stay below their thresholds to the end |
//! | momentum | \|I ω\| of the stack about its centre of mass, ω against N |

use crate::case::Motion;
use crate::closed_loop::{Flight, Observer, Tick};
use crate::gnc::error::TrackingError;
use crate::number::{Real, Vec3};
use crate::plant::propagate::Wrench;
use crate::scene::Scene;

const NEVER: f64 = f64::INFINITY;

/// Running sums of a batch of flights.
#[derive(Clone, Copy, Debug)]
pub struct Metrics<R: Real> {
    impulse: Vec3<R>,
    delta_v: Vec3<R>,
    delta_v_to_capture: Vec3<R>,
    torque_impulse: Vec3<R>,
    peak_demand: Peak<R>,
    peak_applied: Peak<R>,
    saturated_force: R,
    saturated_torque: R,
    force_variation: R,
    torque_variation: R,
    previous: Wrench<R>,
    flown: R,
    last_unsettled: R,
    diverged: R,
    at_capture: AtCapture<R>,
    end: End<R>,
}

#[derive(Clone, Copy, Debug)]
struct Peak<R> {
    force: R,
    torque: R,
}

#[derive(Clone, Copy, Debug)]
struct AtCapture<R> {
    distance: R,
    half_sine: R,
    half_cosine: R,
    rate: R,
    speed: R,
    momentum: R,
}

#[derive(Clone, Copy, Debug)]
struct End<R> {
    half_sine: R,
    half_cosine: R,
    rate: R,
    momentum: R,
}

impl<R: Real> Default for Metrics<R> {
    fn default() -> Self {
        let (zero, nan) = (R::zero(), R::splat(f64::NAN));
        let peak = Peak { force: zero, torque: zero };
        Self {
            impulse: Vec3::zero(),
            delta_v: Vec3::zero(),
            delta_v_to_capture: Vec3::zero(),
            torque_impulse: Vec3::zero(),
            peak_demand: peak,
            peak_applied: peak,
            saturated_force: zero,
            saturated_torque: zero,
            force_variation: zero,
            torque_variation: zero,
            previous: Wrench::zero(),
            flown: zero,
            last_unsettled: R::splat(-NEVER),
            diverged: R::splat(NEVER),
            at_capture: AtCapture {
                distance: zero,
                half_sine: zero,
                half_cosine: zero,
                rate: zero,
                speed: zero,
                momentum: zero,
            },
            end: End { half_sine: nan, half_cosine: nan, rate: nan, momentum: nan },
        }
    }
}

impl<R: Real> Observer<R> for Metrics<R> {
    fn captured(&mut self, scene: &Scene<'_, R>, lanes: R::Mask, before: &Motion<R>, error: &TrackingError<R>) {
        let judged = if scene.plan.distance_from_debris { before.position } else { error.position };
        let keep = |new: R, old: R| R::select(lanes, new, old);
        let at = &mut self.at_capture;
        at.distance = keep(judged.norm(), at.distance);
        at.half_sine = keep(error.attitude.vector().norm(), at.half_sine);
        at.half_cosine = keep(error.attitude.scalar(), at.half_cosine);
        at.rate = keep(error.rate.norm(), at.rate);
        at.speed = keep(error.velocity.norm(), at.speed);
        self.delta_v_to_capture = Vec3::select(lanes, self.delta_v, self.delta_v_to_capture);
    }

    fn merged(&mut self, lanes: R::Mask, flight: &Flight<R>) {
        let momentum = momentum(flight);
        self.at_capture.momentum = R::select(lanes, momentum, self.at_capture.momentum);
    }

    #[inline(always)]
    fn observe(&mut self, scene: &Scene<'_, R>, flight: &Flight<R>, tick: &Tick<R>) {
        let time = R::splat(tick.time);
        let finite = is_finite(flight);
        self.diverged = self.diverged.min(R::select(finite, R::splat(NEVER), time));

        let holds = scene.numbers.settled.holds(&tick.error);
        self.last_unsettled = R::select(holds, self.last_unsettled, time);

        if tick.flown {
            self.count_effort(scene, flight, tick, finite);
        } else {
            self.end = End {
                half_sine: tick.error.attitude.vector().norm(),
                half_cosine: tick.error.attitude.scalar(),
                rate: tick.error.rate.norm(),
                momentum: momentum(flight),
            };
        }
    }
}

impl<R: Real> Metrics<R> {
    /// A lane whose state has left the numbers asks for nothing any more.
    #[inline(always)]
    fn count_effort(&mut self, scene: &Scene<'_, R>, flight: &Flight<R>, tick: &Tick<R>, finite: R::Mask) {
        let if_finite = |v: Vec3<R>| Vec3::select(finite, v, Vec3::zero());
        let demand = Wrench { force: if_finite(tick.demand.force), torque: if_finite(tick.demand.torque) };
        let applied = Wrench { force: if_finite(tick.applied.force), torque: if_finite(tick.applied.torque) };
        let period = R::select(finite, R::splat(scene.plan.control_period), R::zero());

        let (force, torque) = (applied.force.abs(), applied.torque.abs());
        let held = Vec3::splat(period);
        self.impulse = held.mul_add(force, self.impulse);
        self.torque_impulse = held.mul_add(torque, self.torque_impulse);
        self.delta_v = Vec3::splat(period * flight.vehicle.inverse_mass).mul_add(force, self.delta_v);

        let (force_demand, torque_demand) = (demand.force.abs(), demand.torque.abs());
        self.peak_applied.force = self.peak_applied.force.max(force.max_component());
        self.peak_applied.torque = self.peak_applied.torque.max(torque.max_component());
        self.peak_demand.force = self.peak_demand.force.max(force_demand.max_component());
        self.peak_demand.torque = self.peak_demand.torque.max(torque_demand.max_component());

        let limits = &scene.numbers.case.actuators;
        let over = |demand: Vec3<R>, limit: Vec3<R>| {
            let over = R::zero().lt((demand - limit).max_component());
            R::select(over, period, R::zero())
        };
        self.saturated_force += over(force_demand, limits.force);
        self.saturated_torque += over(torque_demand, limits.torque);

        if tick.number > 0 {
            self.force_variation += if_finite(demand.force - self.previous.force).abs().sum();
            self.torque_variation += if_finite(demand.torque - self.previous.torque).abs().sum();
        }
        self.previous = demand;
        self.flown += period;
    }

    /// The summary of lane `i` once the flight is over.
    pub fn summary(&self, scene: &Scene<'_, R>, flight: &Flight<R>, i: usize) -> Summary {
        let capture = flight.capture.time.lane(i);
        let captured = capture.is_finite();
        let merged = captured && scene.plan.merge;
        let diverged = self.diverged.lane(i);
        let if_so = |so: bool, value: f64| if so { value } else { f64::NAN };
        let angle = |half_sine: R, half_cosine: R| 2.0 * half_sine.lane(i).atan2(half_cosine.lane(i));

        // The first tick of the settled stretch, if the flight ends inside one.
        let settled_from = (self.last_unsettled.lane(i) + scene.plan.control_period).max(capture);
        let duration = f64::from(scene.plan.periods) * scene.plan.control_period;
        let half_period = 0.5 * scene.plan.control_period;
        let settled = merged && diverged == NEVER && settled_from < duration + half_period;

        let flown = self.flown.lane(i);
        let (at, end) = (&self.at_capture, &self.end);
        Summary {
            capture_time: if_so(captured, capture),
            settling_time: if_so(settled, settled_from - capture),
            diverged_time: if_so(diverged < NEVER, diverged),
            delta_v: self.delta_v.lane(i).0,
            delta_v_to_capture: self.delta_v_to_capture.lane(i).0.map(|x| if_so(captured, x)),
            impulse: self.impulse.lane(i).0,
            torque_impulse: self.torque_impulse.lane(i).0,
            peak_force_command: self.peak_demand.force.lane(i),
            peak_force: self.peak_applied.force.lane(i),
            peak_torque_command: self.peak_demand.torque.lane(i),
            peak_torque: self.peak_applied.torque.lane(i),
            force_saturated_share: self.saturated_force.lane(i) / flown,
            torque_saturated_share: self.saturated_torque.lane(i) / flown,
            force_chattering: self.force_variation.lane(i) / flown,
            torque_chattering: self.torque_variation.lane(i) / flown,
            final_rate: if_so(merged, end.rate.lane(i)),
            final_pointing: if_so(merged, angle(end.half_sine, end.half_cosine)),
            momentum_at_capture: if_so(merged, at.momentum.lane(i)),
            final_momentum: if_so(merged, end.momentum.lane(i)),
            capture_distance: if_so(captured, at.distance.lane(i)),
            capture_angle: if_so(captured, angle(at.half_sine, at.half_cosine)),
            capture_rate: if_so(captured, at.rate.lane(i)),
            capture_speed: if_so(captured, at.speed.lane(i)),
        }
    }
}

/// |I ω| of what flies \[N m s\].
fn momentum<R: Real>(flight: &Flight<R>) -> R {
    (flight.vehicle.inertia.tensor * flight.truth.chaser_rate).norm()
}

/// Lanes whose whole state is still made of numbers.
#[inline(always)]
fn is_finite<R: Real>(flight: &Flight<R>) -> R::Mask {
    let motion = &flight.truth;
    let translation = motion.position.sum() + motion.velocity.sum();
    let rates = motion.chaser_rate.sum() + motion.debris_rate.sum();
    let (c, d) = (motion.chaser_attitude, motion.debris_attitude);
    let attitudes = c.scalar() + c.vector().sum() + d.scalar() + d.vector().sum();
    (translation + rates + attitudes).is_finite()
}

/// One flight in numbers; NaN for what did not happen. SI units, definitions above.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[allow(missing_docs)]
pub struct Summary {
    pub capture_time: f64,
    pub settling_time: f64,
    pub diverged_time: f64,
    pub delta_v: [f64; 3],
    pub delta_v_to_capture: [f64; 3],
    pub impulse: [f64; 3],
    pub torque_impulse: [f64; 3],
    pub peak_force_command: f64,
    pub peak_force: f64,
    pub peak_torque_command: f64,
    pub peak_torque: f64,
    pub force_saturated_share: f64,
    pub torque_saturated_share: f64,
    pub force_chattering: f64,
    pub torque_chattering: f64,
    pub final_rate: f64,
    pub final_pointing: f64,
    pub momentum_at_capture: f64,
    pub final_momentum: f64,
    pub capture_distance: f64,
    pub capture_angle: f64,
    pub capture_rate: f64,
    pub capture_speed: f64,
}

/// All that the reference workload keeps: time of first capture (in the flight itself) and applied impulse.
#[derive(Clone, Copy, Debug)]
pub struct Impulse<R> {
    /// Σ |F_i| T over axes and ticks \[N s\].
    pub total: R,
}

impl<R: Real> Observer<R> for Impulse<R> {
    fn captured(&mut self, _: &Scene<'_, R>, _: R::Mask, _: &Motion<R>, _: &TrackingError<R>) {}

    #[inline(always)]
    fn observe(&mut self, scene: &Scene<'_, R>, _flight: &Flight<R>, tick: &Tick<R>) {
        if tick.flown {
            let period = R::splat(scene.plan.control_period);
            self.total = period.mul_add(tick.applied.force.abs().sum(), self.total);
        }
    }
}

#[cfg(test)]
mod tests;
