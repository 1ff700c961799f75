//! The order of things in a control period, watched from outside.

use super::*;
use crate::case::*;
use crate::gnc::capture::DistanceFrom;
use crate::gnc::capture::{CaptureThresholds, SettledThresholds};
use crate::gnc::guidance::GoalPositions;
use crate::gnc::guidance::{Goal, StackGoal};
use crate::gnc::laws::LawRecipe;
use crate::gnc::laws::belief::Belief;
use crate::gnc::laws::{AttitudeError, StackBelief, SurfaceRate};
use crate::gnc::laws::{ChannelMemory, Form, Gains, LawMemory, PhaseGains, pd, stsmc};
use crate::hardware::actuators::Limits;
use crate::hardware::actuators::Saturation;
use crate::hardware::sensors::NoiseSigmas;
use crate::number::Mat3;
use crate::plan::{End, Plan};
use crate::plant::body::Body;
use crate::plant::disturbances::constant::LoadAxes;
use crate::plant::disturbances::{Acting, Disturbances};
use crate::plant::motion::Motion;
use crate::plant::orbit::Orbit;
use crate::plant::stack::Transition;
use crate::scene::{Common, PreparedFlight};
use crate::tests::assert_near;

struct Row {
    tick: Tick<f64>,
    truth: Motion<f64>,
    mass: f64,
    memory: Option<LawMemory<f64>>,
}

#[derive(Default)]
struct Log {
    rows: Vec<Row>,
    captured_before_row: Vec<usize>,
    merged: usize,
    handed_over: Option<LawMemory<f64>>,
}

impl Observer<f64> for Log {
    fn captured(&mut self, _scene: &Scene<f64>, _lanes: bool, _before: &Motion<f64>, _error: TrackingError<f64>) {
        self.captured_before_row.push(self.rows.len());
    }

    fn merged(&mut self, _lanes: bool, flight: &Flight<f64>) {
        self.merged += 1;
        self.handed_over = flight.memory.law;
    }

    fn observe(&mut self, _scene: &Scene<f64>, flight: &Flight<f64>, tick: &Tick<f64>) {
        self.rows.push(Row { tick: *tick, truth: flight.truth, mass: flight.vehicle.mass, memory: flight.memory.law });
    }
}

/// Drifting at 0.1 m/s per tick of 0.5 s toward the goal from 1.25 m, turning slowly; PD whose torque tells the phases
/// apart: 0.001·ω before, 0.1·ω after.
fn recipe() -> FlightRecipe {
    let body = |mass, inertia| Body { mass, inertia: Mat3::from_scale(inertia), grasp_point: Vec3([0.0; 3]) };
    let gains = |kd| PhaseGains {
        translation: pd::Gains { kp: Vec3([0.0; 3]), kd: Vec3([0.0; 3]) },
        rotation: pd::Gains { kp: Vec3([0.0; 3]), kd: Vec3([kd; 3]) },
    };
    FlightRecipe {
        case: Case {
            orbit: Orbit { mean_motion: 1e-3, lvlh_attitude: Quat([1.0, 0.0, 0.0, 0.0]) },
            chaser: body(9.0, 0.1),
            debris: body(5.0, 0.08),
            start: Motion {
                position: Vec3([0.0, 0.0, 1.25]),
                velocity: Vec3([0.0, 0.0, -0.2]),
                chaser_attitude: Quat([1.0, 0.0, 0.0, 0.0]),
                chaser_rate: Vec3([0.01, 0.0, 0.02]),
                debris_attitude: Quat([1.0, 0.0, 0.0, 0.0]),
                debris_rate: Vec3([0.0, 0.01, 0.0]),
            },
            goal: GoalPositions { position: Vec3([0.0; 3]), after_capture: Vec3([0.0, 0.7, 0.0]) },
            capture: CaptureThresholds { distance: 0.5, angle: 0.35, rate: 0.05, speed: f64::INFINITY },
            settled: SettledThresholds { angle: 0.1, rate: 0.005 },
            actuators: Limits::exact(Vec3([0.1; 3]), Vec3([0.01; 3])),
            disturbances: Disturbances::none(),
            sensors: NoiseSigmas { position: 0.0, velocity: 0.0, attitude: 0.0, rate: 0.0 },
            belief: Belief {
                chaser_mass: 9.0,
                chaser_inertia: Mat3::from_scale(0.1),
                stack_mass: 14.0,
                stack_inertia: Mat3::from_scale(0.18),
            },
        },
        law: LawRecipe::Pd(Gains { form: Some(Form::Printed), before: gains(0.001), after: gains(0.1) }),
        plan: Plan {
            control_period: 0.5,
            steps_per_period: 5,
            periods: 20,
            dwell_ticks: 0,
            goal: Goal::Fixed,
            stack_goal: StackGoal::Reached,
            distance_from: DistanceFrom::Goal,
            transition: Transition::MomentumConserving,
            stack_belief: StackBelief::Design,
            saturation: Saturation::PerAxis,
            attitude_error: AttitudeError::Epsilon,
            surface_rate: SurfaceRate::Printed,
            disturbances: Acting::default(),
            end: End::Duration,
            hold_ticks: 0,
        },
    }
}

fn watch(recipe: &FlightRecipe) -> (Log, Flight<f64>) {
    let prepared = PreparedFlight::new(recipe);
    let mut scene = Scene::<f64>::new(&recipe.plan, Common::new(recipe, []).unwrap(), &prepared);
    let (mut flight, mut log) = (prepared.start(&recipe.plan), Log::default());
    fly_alone(&mut scene, &mut flight, &mut Stream::new(1, |_| 0), &mut log);
    (log, flight)
}

#[test]
fn capture_is_judged_first_and_the_law_flies_the_stack_in_that_very_period() {
    let (log, flight) = watch(&recipe());
    // 1.25 - 0.1 k < 0.5 from k = 8.
    assert_eq!((&log.captured_before_row[..], log.merged), (&[8][..], 1));
    assert_eq!(flight.capture.time, 4.0);
    for (k, row) in log.rows.iter().enumerate() {
        assert_eq!(row.mass, if k < 8 { 9.0 } else { 14.0 }, "tick {k}");
        // The recorded state is the one after the merge, and the torque is the stack's gain times its rate.
        let gain = if k < 8 { 0.001 } else { 0.1 };
        assert_near(&row.tick.demand.torque.0, &(row.truth.chaser_rate * -gain).0, 1e-18);
        let goal =
            if k < 8 { Quat([1.0, 0.0, 0.0, 0.0]) } else { Lvlh::at(&recipe().case.orbit, row.tick.time).attitude };
        let attitude = if k < 8 { row.truth.debris_attitude } else { goal };
        assert_eq!(row.tick.target.attitude, attitude);
    }
    // The centre of mass of both: 9/14 of where the chaser was.
    assert!((log.rows[8].truth.position[2] - 0.45 * 9.0 / 14.0).abs() < 1e-5);
}

#[test]
fn ticks_are_the_first_to_the_last_and_the_last_is_not_flown() {
    let (log, _) = watch(&recipe());
    assert_eq!(log.rows.len(), 21);
    for (k, row) in log.rows.iter().enumerate() {
        assert_eq!((row.tick.number, row.tick.time, row.tick.flown), (k as f64, 0.5 * k as f64, k < 20));
    }
}

#[test]
fn start_inside_the_thresholds_is_a_capture_at_zero() {
    let mut recipe = recipe();
    recipe.case.start.position = Vec3([0.0, 0.0, 0.3]);
    let (log, flight) = watch(&recipe);
    assert_eq!((log.captured_before_row[0], flight.capture.time), (0, 0.0));
    assert_eq!(log.rows[0].mass, 14.0);
}

#[test]
fn dwell_delays_capture_by_its_ticks() {
    let mut recipe = recipe();
    recipe.plan.dwell_ticks = 4;
    assert_eq!(watch(&recipe).1.capture.time, 6.0);
}

#[test]
fn capture_is_judged_on_the_truth_however_noisy_the_sensors() {
    let mut recipe = recipe();
    let quiet = watch(&recipe).1.capture.time;
    // The law is silent in translation and nearly so in rotation: noise moves nothing but what is seen.
    recipe.case.sensors = NoiseSigmas { position: 5.0, velocity: 1.0, attitude: 1.0, rate: 0.0 };
    assert_eq!(watch(&recipe).1.capture.time, quiet);
}

#[test]
fn debris_stays_fixed_to_the_stack_as_it_was_caught() {
    let (log, flight) = watch(&recipe());
    let caught = log.rows[8].truth;
    let mount = caught.chaser_attitude.conjugate() * caught.debris_attitude;
    for row in &log.rows[8..] {
        let now = row.truth.chaser_attitude.conjugate() * row.truth.debris_attitude;
        assert_near(&now.0, &mount.0, 1e-14);
        let rate = row.truth.debris_attitude.rotate(row.truth.debris_rate);
        assert_near(&rate.0, &row.truth.chaser_attitude.rotate(row.truth.chaser_rate).0, 1e-16);
    }
    assert_near(&flight.joint.mount.0, &mount.0, 1e-15);
}

#[test]
fn stack_keeps_the_goal_unless_it_is_given_one() {
    let mut recipe = recipe();
    assert_eq!(watch(&recipe).1.stack_goal, recipe.case.goal.position);
    recipe.plan.stack_goal = StackGoal::Given;
    assert_eq!(watch(&recipe).1.stack_goal, recipe.case.goal.after_capture);
}

#[test]
fn law_believes_the_plain_sum_unless_told_the_truth() {
    let mut recipe = recipe();
    let believed = |recipe: &FlightRecipe| watch(recipe).1.law.unwrap().believed;
    assert_eq!(believed(&recipe).inertia, Mat3::from_scale(0.18));
    recipe.plan.stack_belief = StackBelief::True;
    let (_, flight) = watch(&recipe);
    assert_eq!(flight.law.unwrap().believed.inertia, flight.vehicle.inertia.tensor);
    assert_eq!(flight.law.unwrap().believed.mass, 14.0);
}

#[test]
fn without_merging_capture_is_only_noted() {
    let mut recipe = recipe();
    recipe.plan.transition = Transition::None;
    let (log, flight) = watch(&recipe);
    assert_eq!((flight.capture.time, log.merged), (4.0, 0));
    assert!(log.rows.iter().all(|row| row.mass == 9.0 && row.tick.target.attitude == row.truth.debris_attitude));
}

#[test]
fn demand_is_kept_beside_what_the_actuators_give() {
    let mut recipe = recipe();
    recipe.case.actuators.torque = Vec3([1e-6; 3]);
    let (log, _) = watch(&recipe);
    let tick = log.rows[0].tick;
    assert_near(&tick.demand.torque.0, &[-1e-5, 0.0, -2e-5], 1e-20);
    assert_near(&tick.applied.wrench.torque.0, &[-1e-6, 0.0, -1e-6], 0.0);
    recipe.plan.saturation = Saturation::Scaled;
    assert_near(&watch(&recipe).0.rows[0].tick.applied.wrench.torque.0, &[-5e-7, 0.0, -1e-6], 1e-20);
}

#[test]
fn a_force_on_the_debris_turns_the_stack_by_its_lever() {
    let mut recipe = recipe();
    recipe.law = LawRecipe::None { segments: Vec::new() };
    recipe.plan.disturbances.constant = LoadAxes::Lvlh;
    let force = Vec3([2e-3, -1e-3, 0.0]);
    recipe.case.disturbances.constant.debris_force = force;
    let (log, flight) = watch(&recipe);
    let rows = &log.rows[log.captured_before_row[0]..];
    assert!(rows.len() > 8 && rows[0].mass == 14.0);
    // The stack's centre of mass lies at r_S from the debris' when it is made; that place turns with it.
    let to_inertial = |row: &Row| Lvlh::at(&recipe.case.orbit, row.tick.time).attitude;
    let lever = rows[0].truth.chaser_attitude.rotate_inverse(to_inertial(&rows[0]).rotate(-rows[0].truth.position));
    let torque = |row: &Row| row.truth.chaser_attitude.rotate(lever).cross(to_inertial(row).rotate(force));
    let momentum = |row: &Row| row.truth.chaser_attitude.rotate(flight.vehicle.inertia.tensor * row.truth.chaser_rate);
    let impulse = rows.windows(2).fold(Vec3::zero(), |sum, two| sum + (torque(&two[0]) + torque(&two[1])) * 0.25);
    let gained = momentum(rows.last().unwrap()) - momentum(&rows[0]);
    assert!(impulse.norm() > 1e-3);
    assert_near(&gained.0, &impulse.0, 1e-4 * impulse.norm()); // trapezoidal rule
}

#[test]
fn integrals_wait_for_saturated_axes_and_begin_anew_at_capture() {
    let mut recipe = recipe();
    let gains = stsmc::Gains { slope: Vec3([0.1; 3]), k1: Vec3([1e-3; 3]), k2: Vec3([1e-4; 3]) };
    let phase = PhaseGains { translation: gains, rotation: gains };
    recipe.law = LawRecipe::Stsmc(Gains { form: None, before: phase, after: phase });
    recipe.case.start.position = Vec3([0.1, 0.2, 1.25]);
    recipe.case.actuators.force = Vec3([1e-9, 0.1, 0.1]);
    let (log, _) = watch(&recipe);
    let integral = |memory: &Option<LawMemory<f64>>| match memory.expect("a law remembers").translation {
        ChannelMemory::Integral(integral) => integral.value,
        ChannelMemory::None(()) => panic!("super-twisting has an integral"),
    };
    let capture = log.captured_before_row[0];
    let before = integral(&log.rows[capture - 1].memory);
    // s > 0 in y until capture: -k2 T at each tick.
    assert_near(&[before[0], before[1]], &[0.0, -1e-4 * 0.5 * capture as f64], 1e-15);
    assert_eq!(integral(&log.handed_over), Vec3::zero());
}
