//! What a flight is judged by, gathered tick by tick in every lane. Names and units are in [`METRICS`]; the equations:
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
//! | largest rate | largest \|ω\| at a tick of a body whose rotation is integrated step by step |
//! | momentum | \|I ω\| of the stack about its centre of mass, ω against N |

use crate::batch_struct;
use crate::closed_loop::guide;
use crate::flight::Flight;
use crate::gnc::error::TrackingError;
use crate::number::{Mask, Real, Vec3};
use crate::observer::{Observer, Tick};
use crate::plan::{End, Plan};
use crate::plant::motion::Motion;
use crate::plant::wrench::Wrench;
use crate::scene::Scene;

pub mod failure;
mod summary;

pub use summary::{METRICS, Metric, Summary, Value};

const NEVER: f64 = f64::INFINITY;

batch_struct! {
    /// Running sums of a batch of flights.
    pub struct Metrics<R> {
        impulse: Vec3<R>,
        impulse_to_capture: Vec3<R>,
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
        longest_held: R,
        fastest_squared: R,
        closest: Closest<R>,
        at_capture: AtCapture<R>,
    }
}

batch_struct! {
    struct Peak<R> {
        force: R,
        torque: R,
    }
}

batch_struct! {
    /// Least square of each quantity that capture is judged by.
    struct Closest<R> {
        distance: R,
        sine: R,
        rate: R,
        speed: R,
    }
}

batch_struct! {
    struct AtCapture<R> {
        distance: R,
        half_sine: R,
        half_cosine: R,
        rate: R,
        speed: R,
        momentum: R,
    }
}

impl<R: Real> Default for Metrics<R> {
    fn default() -> Self {
        let (zero, never) = (R::zero(), R::splat(NEVER));
        let peak = Peak { force: zero, torque: zero };
        Self {
            impulse: Vec3::zero(),
            impulse_to_capture: Vec3::zero(),
            torque_impulse: Vec3::zero(),
            peak_demand: peak,
            peak_applied: peak,
            saturated_force: zero,
            saturated_torque: zero,
            force_variation: zero,
            torque_variation: zero,
            previous: Wrench::zero(),
            flown: zero,
            last_unsettled: -never,
            diverged: never,
            longest_held: zero,
            fastest_squared: -never, // whose root is no number: of no tick
            closest: Closest { distance: never, sine: never, rate: never, speed: never },
            at_capture: AtCapture {
                distance: zero,
                half_sine: zero,
                half_cosine: zero,
                rate: zero,
                speed: zero,
                momentum: zero,
            },
        }
    }
}

impl<R: Real> Observer<R> for Metrics<R> {
    fn captured(&mut self, scene: &Scene<R>, lanes: R::Mask, before: &Motion<R>, error: TrackingError<R>) {
        let judged = scene.plan.distance_from.counted(before, &error);
        let keep = |new: R, old: R| R::select(lanes, new, old);
        let at = &mut self.at_capture;
        at.distance = keep(judged.norm(), at.distance);
        at.half_sine = keep(error.attitude.vector().norm(), at.half_sine);
        at.half_cosine = keep(error.attitude.scalar(), at.half_cosine);
        at.rate = keep(error.rate.norm(), at.rate);
        at.speed = keep(error.velocity.norm(), at.speed);
        self.impulse_to_capture = Vec3::select(lanes, self.impulse, self.impulse_to_capture);
    }

    fn merged(&mut self, lanes: R::Mask, flight: &Flight<R>) {
        let momentum = momentum(flight);
        self.at_capture.momentum = R::select(lanes, momentum, self.at_capture.momentum);
    }

    #[inline(always)]
    fn observe(&mut self, scene: &Scene<R>, flight: &Flight<R>, tick: &Tick<R>) {
        let (judged, closest) = (&tick.judged, &mut self.closest);
        let finite = judged.is_finite();
        self.diverged = self.diverged.min(R::select(finite, R::splat(NEVER), tick.time));

        if scene.plan.transition.merges() {
            let holds = scene.numbers.settled.holds(&tick.error);
            self.last_unsettled = R::select(holds, self.last_unsettled, tick.time);
        }

        closest.distance = closest.distance.min(judged.distance_squared);
        closest.sine = closest.sine.min(judged.sin_squared);
        closest.rate = closest.rate.min(judged.rate_squared);
        closest.speed = closest.speed.min(judged.speed_squared);
        self.longest_held = self.longest_held.max(flight.capture.held);

        let mut fastest = flight.truth.chaser_rate.norm_squared();
        if !scene.common.shapes.symmetric_debris {
            // After a merge the same rate, seen in the debris' axes.
            fastest = fastest.max(flight.truth.debris_rate.norm_squared());
        }
        self.fastest_squared = R::select(finite, self.fastest_squared.max(fastest), self.fastest_squared);

        let flown_on = tick.flown & !self.over(scene, flight, tick);
        self.count_effort(scene, tick, finite & flown_on);
    }

    #[inline(always)]
    fn over(&self, scene: &Scene<R>, flight: &Flight<R>, tick: &Tick<R>) -> R::Mask {
        let plan = &scene.plan;
        let captured = flight.capture.captured();
        let done = match plan.end {
            End::Duration => return R::Mask::splat(false),
            End::Settled if plan.transition.merges() => {
                let hold = (f64::from(plan.hold_ticks) - 0.5) * plan.control_period;
                captured & R::splat(hold).lt(tick.time - self.settled_from(flight, plan))
            }
            End::Settled | End::Captured => captured,
        };
        done | self.diverged.lt(R::splat(NEVER))
    }
}

impl<R: Real> Metrics<R> {
    /// The first tick of the settled stretch in which a stack is now, or the next tick \[s\].
    #[inline(always)]
    fn settled_from(&self, flight: &Flight<R>, plan: &Plan) -> R {
        (self.last_unsettled + R::splat(plan.control_period)).max(flight.capture.time)
    }

    /// A wrench that is not flown counts for nothing, nor does one of a lane whose state has become non-finite.
    #[inline(always)]
    fn count_effort(&mut self, scene: &Scene<R>, tick: &Tick<R>, counts: R::Mask) {
        let period = R::splat(scene.plan.control_period);
        let (demand, applied) = (&tick.demand, &tick.applied.wrench);
        let (force, torque) = (applied.force.abs(), applied.torque.abs());
        let (force_demand, torque_demand) = (demand.force.abs(), demand.torque.abs());
        add(&mut self.impulse, counts, period, force);
        add(&mut self.torque_impulse, counts, period, torque);

        raise(&mut self.peak_applied.force, counts, force);
        raise(&mut self.peak_applied.torque, counts, torque);
        raise(&mut self.peak_demand.force, counts, force_demand);
        raise(&mut self.peak_demand.torque, counts, torque_demand);

        grow(&mut self.saturated_force, counts & any_axis(tick.applied.force_saturated), period);
        grow(&mut self.saturated_torque, counts & any_axis(tick.applied.torque_saturated), period);

        let varies = counts & R::zero().lt(tick.number);
        grow(&mut self.force_variation, varies, (demand.force - self.previous.force).abs().sum());
        grow(&mut self.torque_variation, varies, (demand.torque - self.previous.torque).abs().sum());
        self.previous = *demand;
        grow(&mut self.flown, counts, period);
    }

    /// The summary of lane `i`, whose flight is over at tick `number`.
    pub fn summary(&self, scene: &Scene<R>, flight: &Flight<R>, number: R, i: usize) -> Summary {
        let plan = &scene.plan;
        let time = number * R::splat(plan.control_period);
        let error = TrackingError::between(&flight.truth, &guide(scene, flight, &flight.truth, time));
        let captured = flight.capture.time.lane(i).is_finite();
        let merged = captured && plan.transition.merges();
        let diverged = self.diverged.lane(i);
        let no_gains = !flight.commanded().lane(i);
        let if_so = |so: bool, value: f64| if so { value } else { f64::NAN };
        let angle = |half_sine: f64, half_cosine: f64| 2.0 * half_sine.atan2(half_cosine);

        let (end_time, settled_from) = (time.lane(i), self.settled_from(flight, plan).lane(i));
        let settled = merged && !no_gains && diverged == NEVER && settled_from < end_time + 0.5 * plan.control_period;
        let tick = |so: bool, time: f64| if so { scene.clock.tick_at(time) } else { 0 };
        let (capture_tick, settled_tick) = (tick(captured, flight.capture.time.lane(i)), tick(settled, settled_from));
        let label = |so: bool, tick: u64| if_so(so, scene.clock.time_of(tick));
        // A stack must settle only where there is one, and where the flight does not end at capture.
        let awaited = merged && plan.end != End::Captured;
        let final_stack = merged && diverged == NEVER && !no_gains;
        let end_angle = angle(error.attitude.vector().lane(i).norm(), error.attitude.scalar().lane(i));

        let flown = self.flown.lane(i);
        let at = &self.at_capture;
        let (impulse, to_capture) = (self.impulse.lane(i), self.impulse_to_capture.lane(i));
        // The mass changes at capture alone.
        let own = to_capture * scene.numbers.chaser.inverse_mass.lane(i);
        let delta_v = own + (impulse - to_capture) * flight.vehicle.inverse_mass.lane(i);
        Summary {
            failure: match () {
                () if no_gains && (awaited || !captured) => failure::NO_GAINS, // after a capture that is all, none are needed
                () => self.failure(scene, i, diverged < NEVER, captured, settled || !awaited),
            },
            end_time: label(true, number.lane(i) as u64),
            capture_time: label(captured, capture_tick),
            capture_tick: if_so(captured, capture_tick as f64),
            settling_time: label(settled, settled_tick.saturating_sub(capture_tick)),
            settled_tick: if_so(settled, settled_tick as f64),
            diverged_time: label(diverged < NEVER, tick(diverged < NEVER, diverged)),
            largest_rate: self.fastest_squared.lane(i).sqrt(),
            delta_v: delta_v.0,
            delta_v_to_capture: own.0.map(|x| if_so(captured, x)),
            impulse: impulse.0,
            torque_impulse: self.torque_impulse.lane(i).0,
            peak_force_command: self.peak_demand.force.lane(i),
            peak_force: self.peak_applied.force.lane(i),
            peak_torque_command: self.peak_demand.torque.lane(i),
            peak_torque: self.peak_applied.torque.lane(i),
            force_saturated_share: self.saturated_force.lane(i) / flown,
            torque_saturated_share: self.saturated_torque.lane(i) / flown,
            force_chattering: self.force_variation.lane(i) / flown,
            torque_chattering: self.torque_variation.lane(i) / flown,
            final_rate: if_so(final_stack, error.rate.lane(i).norm()),
            final_pointing: if_so(final_stack, end_angle),
            momentum_at_capture: if_so(merged, at.momentum.lane(i)),
            final_momentum: if_so(final_stack, momentum(flight).lane(i)),
            capture_distance: if_so(captured, at.distance.lane(i)),
            capture_angle: if_so(captured, angle(at.half_sine.lane(i), at.half_cosine.lane(i))),
            capture_rate: if_so(captured, at.rate.lane(i)),
            capture_speed: if_so(captured, at.speed.lane(i)),
        }
    }
}

impl<R: Real> Metrics<R> {
    fn failure(&self, scene: &Scene<R>, i: usize, diverged: bool, captured: bool, settled: bool) -> u8 {
        let (closest, test) = (&self.closest, &scene.numbers.capture);
        let missed = [
            (closest.distance, test.distance_squared),
            (closest.sine, test.sin_squared),
            (closest.rate, test.rate_squared),
            (closest.speed, test.speed_squared),
        ];
        match () {
            () if diverged => failure::DIVERGED,
            () if captured && settled => failure::NONE,
            () if captured => failure::NOT_SETTLED,
            () if self.longest_held.lane(i) > 0.0 => failure::DWELL_MISSED,
            () => missed.iter().enumerate().fold(failure::NEVER_CAPTURED, |code, (bit, (closest, threshold))| {
                code | u8::from(closest.lane(i) >= threshold.lane(i)) << bit
            }),
        }
    }
}

// Lanes are chosen last, where most processors do it on the way. Functions, not closures: these are always inlined.

#[inline(always)]
fn grow<R: Real>(sum: &mut R, lanes: R::Mask, by: R) {
    *sum = R::select(lanes, *sum + by, *sum);
}

#[inline(always)]
fn add<R: Real>(sum: &mut Vec3<R>, lanes: R::Mask, time: R, rate: Vec3<R>) {
    *sum = Vec3::select(lanes, Vec3::splat(time).mul_add(rate, *sum), *sum);
}

#[inline(always)]
fn raise<R: Real>(peak: &mut R, lanes: R::Mask, sizes: Vec3<R>) {
    *peak = R::select(lanes, peak.max(sizes.max_component()), *peak);
}

#[inline(always)]
fn any_axis<M: Mask>([x, y, z]: [M; 3]) -> M {
    x | y | z
}

/// |I ω| of what flies \[N m s\].
fn momentum<R: Real>(flight: &Flight<R>) -> R {
    (flight.vehicle.inertia.tensor * flight.truth.chaser_rate).norm()
}

#[cfg(test)]
mod tests;
