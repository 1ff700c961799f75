//! The whole system, one control period at a time.
//!
//! At control tick t_k, in this order: judge capture on the true state, merge what was captured, measure, guide,
//! command, saturate, and hold the wrench while the plant moves on to t_{k+1}.

use crate::batch::Batch;
use crate::batch_struct;
use crate::case::{Case, Motion, Plan};
use crate::gnc::capture::{CaptureState, CaptureTest, SettledTest};
use crate::gnc::error::TrackingError;
use crate::gnc::guidance::{self, GraspPoints, Target};
use crate::gnc::laws::{Law, LawRecipe, MassProperties, Phase, Setting, Told};
use crate::hardware::actuators::saturate;
use crate::hardware::sensors::{Noisy, sense};
use crate::number::{Mask, Quat, Real, Stream, Vec3};
use crate::plant::attitude::Inertia;
use crate::plant::lvlh::Lvlh;
use crate::plant::orbit::HeldStep;
use crate::plant::propagate::{Period, Surroundings, Vehicle, Wrench, WrenchFrame, propagate};
use crate::plant::stack::{merge_approximate, merge_conserving};

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

batch_struct! {
    /// Every number of a flight that no event changes.
    pub struct Numbers<R> {
        /// As the scenario gives them.
        pub case: Case<R>,
        /// Orbit and debris as the propagation wants them.
        pub around: Surroundings<R>,
        /// Thresholds as they are compared.
        pub capture: CaptureTest<R>,
        /// Thresholds of a settled stack as they are compared.
        pub settled: SettledTest<R>,
        /// The chaser before capture.
        pub chaser: Vehicle<R>,
    }
}

impl Numbers<f64> {
    /// Of one flight.
    pub fn new(case: &Case<f64>, plan: &Plan) -> Self {
        Self {
            case: *case,
            around: Surroundings {
                orbit: case.orbit,
                translation: HeldStep::new(case.orbit.mean_motion, plan.step()),
                half_step: HeldStep::new(case.orbit.mean_motion, 0.5 * plan.step()),
                debris: Inertia::new(case.debris.inertia),
            },
            capture: CaptureTest::new(&case.capture),
            settled: SettledTest::new(&case.settled),
            chaser: Vehicle::new(case.chaser.mass, Inertia::new(case.chaser.inertia)),
        }
    }
}

/// A flight's law, built for both phases.
#[derive(Clone, Debug)]
pub struct Laws {
    recipe: LawRecipe,
    setting: Setting,
    before: Option<Law<f64>>,
    after: Option<Law<f64>>,
}

impl Laws {
    /// For what the law believes of chaser and stack.
    pub fn new(recipe: &LawRecipe, case: &Case<f64>, plan: &Plan) -> Self {
        let setting = Setting {
            mean_motion: case.orbit.mean_motion,
            two_epsilon: plan.two_epsilon,
            exact_surface_rate: plan.exact_surface_rate,
        };
        let belief = &case.belief;
        let chaser = MassProperties { mass: belief.chaser_mass, inertia: belief.chaser_inertia };
        let stack = MassProperties { mass: belief.stack_mass, inertia: belief.stack_inertia };
        Self {
            before: recipe.build(Phase::BeforeCapture, &chaser, &setting),
            after: recipe.build(Phase::AfterCapture, &stack, &setting),
            recipe: recipe.clone(),
            setting,
        }
    }
}

/// What the flights of one batch have in common, and their numbers lane by lane.
pub struct Scene<'a, R: Real> {
    /// Clocks and switches.
    pub plan: &'a Plan,
    /// Numbers, a lane each.
    pub numbers: Numbers<R>,
    /// Which sensors are noisy anywhere in the campaign.
    pub noisy: Noisy,
    /// No lane ever has a product of inertia.
    principal_axes: bool,
    law_after: Option<Law<R>>,
    laws: &'a dyn Fn(usize) -> &'a Laws,
}

impl<'a, R: Real> Scene<'a, R> {
    /// Lane `i` flies `numbers(i)` with `laws(i)`.
    pub fn new(
        plan: &'a Plan,
        noisy: Noisy,
        numbers: &dyn Fn(usize) -> &'a Numbers<f64>,
        laws: &'a dyn Fn(usize) -> &'a Laws,
    ) -> Self {
        let diagonal = |i: usize| {
            let Numbers { case: Case { chaser, debris, .. }, .. } = numbers(i);
            chaser.inertia.is_diagonal() && debris.inertia.is_diagonal()
        };
        let stays_diagonal = !(plan.merge && plan.momentum_conserving);
        Self {
            plan,
            numbers: Batch::gather(numbers),
            noisy,
            principal_axes: stays_diagonal && (0..R::LANES).all(diagonal),
            law_after: gather_law(laws, |laws| &laws.after),
            laws,
        }
    }

    /// The state in which the flights begin.
    pub fn start(&self) -> Flight<R> {
        let case = &self.numbers.case;
        Flight {
            truth: case.start,
            vehicle: self.numbers.chaser,
            law: gather_law(self.laws, |laws| &laws.before),
            capture: CaptureState::open(),
            mount: Quat::identity(),
            stack_goal: case.goal.position,
        }
    }

    /// The goal of two separate bodies.
    #[inline(always)]
    fn approach(&self, motion: &Motion<R>, time: f64) -> Target<R> {
        let case = &self.numbers.case;
        if !self.plan.grasp {
            return guidance::fixed_point(case.goal.position, motion);
        }
        let grasp = GraspPoints {
            chaser: case.chaser.grasp_point,
            debris: case.debris.grasp_point,
            debris_inertia: self.numbers.around.debris,
        };
        guidance::grasp_points(&grasp, motion, &Lvlh::at(&case.orbit, time), self.plan.feedforward)
    }

    /// The law of a stack whose true mass and inertia it is told.
    fn law_for(&self, vehicle: &Vehicle<R>) -> Law<R> {
        let build = |i: usize| {
            let laws = (self.laws)(i);
            let truth = MassProperties { mass: vehicle.mass.lane(i), inertia: vehicle.inertia.tensor.lane(i) };
            laws.recipe.build(Phase::AfterCapture, &truth, &laws.setting)
        };
        let built: [Option<Law<f64>>; MAX_LANES] = std::array::from_fn(|i| if i < R::LANES { build(i) } else { None });
        Batch::gather(&|i| built[i].as_ref().expect("only laws are rebuilt at capture"))
    }

    /// The wrench of the segment in force, if any.
    fn open_loop(&self, number: u32) -> (Wrench<R>, WrenchFrame) {
        let segments = (self.laws)(0).recipe.segments();
        match segments.iter().find(|s| (s.first_tick..s.end_tick).contains(&number)) {
            Some(segment) => {
                let wrench =
                    Wrench { force: Vec3::from_lanes(|_| segment.force), torque: Vec3::from_lanes(|_| segment.torque) };
                let frame = if segment.body_frame {
                    WrenchFrame::Body
                } else if segment.torque == Vec3([0.0; 3]) {
                    WrenchFrame::Command // a force held in H alone
                } else {
                    WrenchFrame::Lvlh
                };
                (wrench, frame)
            }
            None => (Wrench::zero(), WrenchFrame::Command),
        }
    }
}

/// Lanes of the widest number type.
const MAX_LANES: usize = 8;

fn gather_law<'a, R: Real>(
    laws: &dyn Fn(usize) -> &'a Laws,
    phase: impl Fn(&'a Laws) -> &'a Option<Law<f64>>,
) -> Option<Law<R>> {
    phase(laws(0)).as_ref()?;
    Some(Batch::gather(&|i| phase(laws(i)).as_ref().expect("either all lanes fly a law or none does")))
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
