//! The whole system, one control period at a time.
//!
//! At control tick t_k, in this order: judge capture on the true state, merge what was captured, measure, guide,
//! command, saturate, and hold the wrench while the plant moves on to t_{k+1}.

use crate::batch::Batch;
use crate::flight::Flight;
use crate::gnc::allocation;
use crate::gnc::capture::Judged;
use crate::gnc::error::TrackingError;
use crate::gnc::guidance::{self, StackGoal, Target};
use crate::gnc::laws::{Law, LawInput, Seen, StackBelief};
use crate::gnc::navigation::{self, Estimate};
use crate::hardware::sensors::Sensed;
use crate::number::{Mask, Quat, Real, Stream, Vec3, Work};
use crate::observer::{Observer, Tick};
use crate::part::Part;
use crate::plan::Plan;
use crate::plant::body::Vehicle;
use crate::plant::disturbed::{Disturbed, Joint};
use crate::plant::lvlh::Lvlh;
use crate::plant::motion::Motion;
use crate::plant::propagate::{Period, propagate};
use crate::plant::stack::{Transition, merge_approximate, merge_conserving};
use crate::plant::wrench::{Held, Wrench, WrenchFrame};
use crate::scene::{Numbers, Scene, no_gains};

/// What happens at one control tick of every lane, up to the wrench that is then held; and whose flight is over here.
#[inline(always)]
fn control_tick<R: Real, O: Observer<R>>(
    scene: &Scene<R>,
    flight: &mut Flight<R>,
    noise: &Stream<R>,
    number: R,
    observer: &mut O,
) -> (Held<R>, R::Mask) {
    let plan = &scene.plan;
    let time = number * R::splat(plan.control_period);

    let mut target = guide(scene, flight, &flight.truth, time);
    let mut error = TrackingError::between(&flight.truth, &target);
    let judged = Judged::of(&error, &flight.truth, plan.distance_from);
    let captured_now = flight.capture.judge(scene.numbers.capture.holds(&judged), time, plan.dwell_ticks);
    if captured_now.any() {
        observer.captured(scene, captured_now, &flight.truth, error);
        if plan.transition.merges() {
            merge(scene, flight, captured_now, time);
            observer.merged(captured_now, flight);
            target = guide(scene, flight, &flight.truth, time);
            error = TrackingError::between(&flight.truth, &target);
        }
    }

    let sensed = Sensed { truth: &flight.truth, noise, tick: number };
    let measured = scene.sensors().step(&mut flight.memory.sensors, sensed);
    let estimate = navigation::Direct.step(&mut flight.memory.navigator, &measured);
    let goal = guide(scene, flight, &estimate.motion, time);
    let (demand, frame) = command(scene, flight, &estimate, &goal, number);
    let commanded = allocation::Direct.step(&mut flight.memory.allocator, &demand);
    let applied = scene.actuators().step(&mut flight.memory.actuators, &commanded);
    if let Some(memory) = &mut flight.memory.law {
        memory.grow(&applied);
    }

    let flown = number.lt(R::splat(f64::from(plan.periods))) & flight.commanded();
    let tick = Tick { number, time, flown, target, judged, error, demand, applied };
    observer.observe(scene, flight, &tick);
    (Held { wrench: applied.wrench, frame }, !flown | observer.over(scene, flight, &tick))
}

/// Moves the plant on to the next tick.
#[inline(always)]
fn fly_on<R: Real>(scene: &Scene<R>, flight: &mut Flight<R>, held: &Held<R>, time: R) {
    let plan = &scene.plan;
    let period = Period { time, step: scene.step, steps: plan.steps_per_period, shapes: scene.common.shapes };
    if plan.disturbances.any() {
        R::apart(DisturbedPeriod { scene, flight, held: *held, period });
    } else {
        propagate(&scene.numbers.around, &flight.vehicle, &mut flight.truth, held, &period);
    }
    follow_chaser(plan, flight);
}

/// A control period under disturbances, apart from the loop: it costs nothing where none acts.
struct DisturbedPeriod<'a, R: Real> {
    scene: &'a Scene<R>,
    flight: &'a mut Flight<R>,
    held: Held<R>,
    period: Period<R>,
}

impl<R: Real> Work for DisturbedPeriod<'_, R> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Numbers { around, case, .. } = &self.scene.numbers;
        let disturbed = Disturbed {
            around,
            masses: [case.chaser.mass, case.debris.mass],
            disturbances: &case.disturbances,
            acting: self.scene.plan.disturbances,
            vehicle: &self.flight.vehicle,
            joint: &self.flight.joint,
            held: self.held,
        };
        disturbed.propagate(&mut self.flight.truth, &self.period);
    }
}

/// Flies all lanes, each from its tick 0 to the tick at which its flight is over: that one is judged and commanded, but not
/// flown. Then `refill` collects its results and begins the lane's next flight.
#[inline(always)]
pub fn fly<R: Real, O: Observer<R>>(
    scene: &mut Scene<R>,
    flight: &mut Flight<R>,
    noise: &mut Stream<R>,
    observer: &mut O,
    refill: &mut impl Refill<R, O>,
) {
    let mut number = R::zero();
    loop {
        let (held, over) = control_tick(scene, flight, noise, number, observer);
        if over.any() && !refill.collect(over, scene, flight, number, observer) {
            return;
        }
        fly_on(scene, flight, &held, number * R::splat(scene.plan.control_period));
        number += R::one();
        if over.any() {
            refill.begin(over, Lanes { scene, flight, noise, number: &mut number, observer });
        }
    }
}

/// Makes one body of two in the lanes just captured, and hands the stack to the law.
#[inline(never)]
fn merge<R: Real>(scene: &Scene<R>, flight: &mut Flight<R>, lanes: R::Mask, time: R) {
    let case = &scene.numbers.case;
    let reached = scene.approach(&flight.truth, time).position;
    let stack = match scene.plan.transition {
        Transition::MomentumConserving => {
            let lvlh = Lvlh::at(&case.orbit, time);
            merge_conserving(&case.chaser, &case.debris, &flight.truth, &lvlh)
        }
        Transition::Approximate => merge_approximate(&case.chaser, &case.debris, &flight.truth),
        Transition::None => return,
    };
    let mount = flight.truth.chaser_attitude.conjugate() * flight.truth.debris_attitude;
    let goal = match scene.plan.stack_goal {
        StackGoal::Given => case.goal.after_capture,
        StackGoal::Reached => reached,
    };

    let joint = Joint { joined: R::one(), mount, offset: stack.offset };
    flight.joint = Joint::choose(lanes, &joint, &flight.joint);
    flight.stack_goal = Vec3::select(lanes, goal, flight.stack_goal);
    flight.truth = Motion::choose(lanes, &stack.motion, &flight.truth);
    flight.vehicle = Vehicle::choose(lanes, &stack.vehicle, &flight.vehicle);
    if let (Some(law), Some(after)) = (&flight.law, &scene.law_after) {
        let after = match scene.plan.stack_belief {
            StackBelief::True => scene.laws_for(lanes, &flight.vehicle, after),
            StackBelief::Design => *after,
        };
        flight.law = Some(Law::choose(lanes, &after, law));
        if let Some(memory) = &mut flight.memory.law {
            after.hand_over(memory, lanes);
        }
        for i in (0..R::LANES).filter(|&i| lanes.lane(i)) {
            flight.no_gains.set_lane(i, no_gains(&Batch::<R>::scatter(&after, i)));
        }
    }
    let memory = &mut flight.memory;
    scene.sensors().hand_over(&mut memory.sensors, lanes);
    Part::<R>::hand_over(&navigation::Direct, &mut memory.navigator, lanes);
    Part::<R>::hand_over(&allocation::Direct, &mut memory.allocator, lanes);
    scene.actuators().hand_over(&mut memory.actuators, lanes);
    follow_chaser(&scene.plan, flight);
}

/// After capture the debris is fixed to the chaser.
#[inline(always)]
fn follow_chaser<R: Real>(plan: &Plan, flight: &mut Flight<R>) {
    let merged = flight.capture.captured();
    if plan.transition.merges() && merged.any() {
        let attitude = flight.truth.chaser_attitude * flight.joint.mount;
        let rate = flight.joint.mount.rotate_inverse(flight.truth.chaser_rate);
        flight.truth.debris_attitude = Quat::select(merged, attitude, flight.truth.debris_attitude);
        flight.truth.debris_rate = Vec3::select(merged, rate, flight.truth.debris_rate);
    }
}

/// The goal of each lane's phase, from what is known of the motion.
#[inline(always)]
pub(crate) fn guide<R: Real>(scene: &Scene<R>, flight: &Flight<R>, motion: &Motion<R>, time: R) -> Target<R> {
    let approach = scene.approach(motion, time);
    let merged = flight.capture.captured();
    if scene.plan.transition.merges() && merged.any() {
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
    scene: &Scene<R>,
    flight: &mut Flight<R>,
    estimate: &Estimate<R>,
    goal: &Target<R>,
    number: R,
) -> (Wrench<R>, WrenchFrame) {
    match (&flight.law, &mut flight.memory.law) {
        (Some(law), Some(memory)) => {
            let input = LawInput {
                seen: Seen::new(estimate, goal),
                mean_motion: scene.numbers.case.orbit.mean_motion,
                feedforward: scene.plan.goal.feeds_acceleration().then_some(goal.acceleration),
                attitude_error: scene.plan.attitude_error,
                period: R::splat(scene.plan.control_period),
            };
            (law.step(memory, input), WrenchFrame::Command)
        }
        _ => scene.open_loop(number),
    }
}

/// What flies in the lanes of a batch.
pub struct Lanes<'a, R: Real, O> {
    /// Numbers that no event changes.
    pub scene: &'a mut Scene<R>,
    /// States.
    pub flight: &'a mut Flight<R>,
    /// Random numbers.
    pub noise: &'a mut Stream<R>,
    /// Each lane's tick.
    pub number: &'a mut R,
    /// What is kept of the flights.
    pub observer: &'a mut O,
}

/// Collects the results of lanes whose flight is over, and begins their next flights.
pub trait Refill<R: Real, O> {
    /// Flights are over, at these ticks; returns whether any lane still flies something.
    fn collect(&mut self, over: R::Mask, scene: &Scene<R>, flight: &Flight<R>, number: R, observer: &O) -> bool;

    /// The lanes' next flights begin.
    fn begin(&mut self, over: R::Mask, lanes: Lanes<'_, R, O>);
}

/// Flies one flight, the same in all lanes, to its end; returns the number of its last tick.
#[inline(always)]
pub fn fly_alone<R: Real, O: Observer<R>>(
    scene: &mut Scene<R>,
    flight: &mut Flight<R>,
    noise: &mut Stream<R>,
    observer: &mut O,
) -> R {
    let mut last = Alone(R::zero());
    fly(scene, flight, noise, observer, &mut last);
    last.0
}

struct Alone<R: Real>(R);

impl<R: Real, O> Refill<R, O> for Alone<R> {
    fn collect(&mut self, _: R::Mask, _: &Scene<R>, _: &Flight<R>, number: R, _: &O) -> bool {
        self.0 = number;
        false
    }

    fn begin(&mut self, _: R::Mask, _: Lanes<'_, R, O>) {}
}

#[cfg(test)]
mod tests;
