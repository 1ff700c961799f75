//! The whole system, one control period at a time.
//!
//! At control tick t_k, in this order: judge capture on the true state, merge what was captured, measure, guide,
//! command, saturate, and hold the wrench while the plant moves on to t_{k+1}.

use crate::batch::Batch;
use crate::case::{Motion, Plan};
use crate::gnc::capture::CaptureState;
use crate::gnc::error::TrackingError;
use crate::gnc::guidance::{self, Target};
use crate::gnc::laws::{Law, Told};
use crate::hardware::actuators::saturate;
use crate::hardware::sensors::sense;
use crate::number::{Mask, Quat, Real, Stream, Vec3};
use crate::plant::lvlh::Lvlh;
use crate::plant::propagate::{Period, Vehicle, Wrench, WrenchFrame, propagate};
use crate::plant::stack::{merge_approximate, merge_conserving};
use crate::scene::Scene;

/// One control period of every lane.
#[inline(always)]
pub fn control_period<R: Real, O: Observer<R>>(
    scene: &Scene<'_, R>,
    flight: &mut Flight<R>,
    dice: &Stream<R>,
    number: u32,
    observer: &mut O,
) {
    let plan = scene.plan;
    let time = f64::from(number) * plan.control_period;

    let mut target = guide(scene, flight, &flight.truth, time);
    let mut error = TrackingError::between(&flight.truth, &target);
    let captured_now = judge(scene, flight, &error, time);
    if captured_now.any() {
        observer.captured(scene, captured_now, &flight.truth, &error);
        if plan.merge {
            merge(scene, flight, captured_now, time);
            observer.merged(captured_now, flight);
            target = guide(scene, flight, &flight.truth, time);
            error = TrackingError::between(&flight.truth, &target);
        }
    }

    let seen = sense(&scene.numbers.case.sensors, scene.noisy, &flight.truth, dice, number);
    let goal = guide(scene, flight, &seen, time);
    let seen_error = TrackingError::between(&seen, &goal);
    let (demand, frame) = command(scene, flight, &seen, &seen_error, &goal, number);
    let limits = &scene.numbers.case.actuators;
    let applied = Wrench {
        force: saturate(demand.force, limits.force, plan.scaled_saturation),
        torque: saturate(demand.torque, limits.torque, plan.scaled_saturation),
    };

    let flown = number < plan.periods;
    observer.observe(scene, flight, &Tick { number, time, flown, target, error, demand, applied });
    if flown {
        let (step, steps) = (plan.step(), plan.steps_per_period);
        let period = Period { time, step, steps, principal_axes: scene.principal_axes };
        propagate(&scene.numbers.around, &flight.vehicle, &mut flight.truth, &applied, frame, &period);
        ride_along(plan, flight);
    }
}

/// A whole flight, from tick 0 to the last, which is judged and commanded but not flown; ends early when the observer
/// has seen enough.
#[inline(always)]
pub fn fly<R: Real, O: Observer<R>>(scene: &Scene<'_, R>, flight: &mut Flight<R>, dice: &Stream<R>, observer: &mut O) {
    for number in 0..=scene.plan.periods {
        control_period(scene, flight, dice, number, observer);
        if observer.has_seen_enough() {
            break;
        }
    }
}

/// Judges capture by the true error; returns the lanes captured at this tick.
#[inline(always)]
fn judge<R: Real>(scene: &Scene<'_, R>, flight: &mut Flight<R>, error: &TrackingError<R>, time: f64) -> R::Mask {
    let plan = scene.plan;
    let holds = scene.numbers.capture.holds(error, &flight.truth, plan.distance_from_debris);
    flight.capture.judge(holds, time, plan.dwell_ticks)
}

/// Makes one body of two in the lanes just captured, and hands the stack to the law.
#[inline(never)]
fn merge<R: Real>(scene: &Scene<'_, R>, flight: &mut Flight<R>, lanes: R::Mask, time: f64) {
    let case = &scene.numbers.case;
    let reached = scene.approach(&flight.truth, time).position;
    let stack = if scene.plan.momentum_conserving {
        let lvlh = Lvlh::at(&case.orbit, time);
        merge_conserving(&case.chaser, &case.debris, &flight.truth, &lvlh)
    } else {
        merge_approximate(&case.chaser, &case.debris, &flight.truth)
    };
    let mount = flight.truth.chaser_attitude.conjugate() * flight.truth.debris_attitude;
    let goal = if scene.plan.goal_after_given { case.goal.after_capture } else { reached };

    flight.mount = Quat::select(lanes, mount, flight.mount);
    flight.stack_goal = Vec3::select(lanes, goal, flight.stack_goal);
    flight.truth = Motion::choose(lanes, &stack.motion, &flight.truth);
    flight.vehicle = Vehicle::choose(lanes, &stack.vehicle, &flight.vehicle);
    if let (Some(law), Some(after)) = (&flight.law, &scene.law_after) {
        let after = if scene.plan.true_stack { scene.law_for(&flight.vehicle) } else { *after };
        flight.law = Some(Law::choose(lanes, &after, law));
    }
    ride_along(scene.plan, flight);
}

/// After capture the debris is fixed to the chaser.
#[inline(always)]
fn ride_along<R: Real>(plan: &Plan, flight: &mut Flight<R>) {
    let merged = flight.capture.captured();
    if plan.merge && merged.any() {
        let attitude = flight.truth.chaser_attitude * flight.mount;
        let rate = flight.mount.rotate_inverse(flight.truth.chaser_rate);
        flight.truth.debris_attitude = Quat::select(merged, attitude, flight.truth.debris_attitude);
        flight.truth.debris_rate = Vec3::select(merged, rate, flight.truth.debris_rate);
    }
}

/// The goal of each lane's phase, from what is known of the motion.
#[inline(always)]
fn guide<R: Real>(scene: &Scene<'_, R>, flight: &Flight<R>, motion: &Motion<R>, time: f64) -> Target<R> {
    let approach = scene.approach(motion, time);
    let merged = flight.capture.captured();
    if scene.plan.merge && merged.any() {
        let lvlh = Lvlh::at(&scene.numbers.case.orbit, time);
        let stack = guidance::stabilise(flight.stack_goal, &lvlh);
        Target::choose(merged, &stack, &approach)
    } else {
        approach
    }
}

/// The law's wrench, or the open-loop segment's.
#[inline(always)]
fn command<R: Real>(
    scene: &Scene<'_, R>,
    flight: &Flight<R>,
    seen: &Motion<R>,
    error: &TrackingError<R>,
    goal: &Target<R>,
    number: u32,
) -> (Wrench<R>, WrenchFrame) {
    match &flight.law {
        Some(law) => {
            let told = Told {
                motion: seen,
                mean_motion: scene.numbers.case.orbit.mean_motion,
                feedforward: scene.plan.feedforward.then_some(goal.acceleration),
                two_epsilon: scene.plan.two_epsilon,
            };
            (law.command(error, &told), WrenchFrame::Command)
        }
        None => scene.open_loop(number),
    }
}

/// The state of a batch of flights.
#[derive(Clone, Copy, Debug)]
pub struct Flight<R: Real> {
    /// The true motion; after capture the stack's.
    pub truth: Motion<R>,
    /// What flies: the chaser, after capture the stack.
    pub vehicle: Vehicle<R>,
    /// The law with the gains of each lane's phase; `None` in open loop.
    pub law: Option<Law<R>>,
    /// Capture so far.
    pub capture: CaptureState<R>,
    /// D -> C, fixed at capture.
    pub mount: Quat<R>,
    /// r_des of the stack \[m, H\].
    pub stack_goal: Vec3<R>,
}

/// One control tick, for those who watch. The motion is the flight's, after the merge.
#[derive(Clone, Copy, Debug)]
pub struct Tick<R> {
    /// k
    pub number: u32,
    /// t_k \[s\].
    pub time: f64,
    /// Whether the wrench is flown; not at the last tick.
    pub flown: bool,
    /// The true goal.
    pub target: Target<R>,
    /// The true error: against the debris before capture, against H after it.
    pub error: TrackingError<R>,
    /// Demanded by the law.
    pub demand: Wrench<R>,
    /// Given by the actuators.
    pub applied: Wrench<R>,
}

/// Watches a flight and keeps what it wants of it.
pub trait Observer<R: Real> {
    /// Lanes are captured: the motion before any merge, and the true error against the debris.
    fn captured(&mut self, scene: &Scene<'_, R>, lanes: R::Mask, before: &Motion<R>, error: &TrackingError<R>);

    /// Lanes have just become stacks.
    fn merged(&mut self, _lanes: R::Mask, _flight: &Flight<R>) {}

    /// At each tick, after the merge and before the plant moves on.
    fn observe(&mut self, scene: &Scene<'_, R>, flight: &Flight<R>, tick: &Tick<R>);

    /// Whether the flight may end here.
    fn has_seen_enough(&self) -> bool {
        false
    }
}

#[cfg(test)]
mod tests;
