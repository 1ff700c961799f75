//! Known answers of each metric, from flights scripted so that every sum is short.

use super::*;
use crate::case::*;
use crate::closed_loop::fly_alone;
use crate::gnc::capture::DistanceFrom;
use crate::gnc::capture::{CaptureThresholds, SettledThresholds};
use crate::gnc::guidance::GoalPositions;
use crate::gnc::guidance::{Goal, StackGoal};
use crate::gnc::laws::belief::Belief;
use crate::gnc::laws::{AttitudeError, StackBelief, SurfaceRate};
use crate::gnc::laws::{Form, Gains, LawRecipe, PhaseGains, Segment, pd};
use crate::hardware::actuators::Limits;
use crate::hardware::actuators::Saturation;
use crate::hardware::sensors::NoiseSigmas;
use crate::number::{Mat3, Quat, Stream};
use crate::plan::{End, Plan};
use crate::plant::body::Body;
use crate::plant::disturbances::{Acting, Disturbances};
use crate::plant::motion::Motion;
use crate::plant::orbit::Orbit;
use crate::plant::stack::Transition;
use crate::plant::wrench::WrenchFrame;
use crate::scene::{Common, PreparedFlight};
use crate::tests::assert_near;

/// Tick length 0.5 s, 10 periods; far apart, so nothing is captured unless told; no orbit.
fn recipe(law: LawRecipe) -> FlightRecipe {
    let body = |mass, inertia| Body { mass, inertia: Mat3::from_scale(inertia), grasp_point: Vec3([0.0; 3]) };
    let rest = Motion {
        position: Vec3([0.0, 5.0, 0.0]),
        velocity: Vec3([0.0; 3]),
        chaser_attitude: Quat([1.0, 0.0, 0.0, 0.0]),
        chaser_rate: Vec3([0.0; 3]),
        debris_attitude: Quat([1.0, 0.0, 0.0, 0.0]),
        debris_rate: Vec3([0.0; 3]),
    };
    FlightRecipe {
        case: Case {
            orbit: Orbit { mean_motion: 0.0, lvlh_attitude: Quat([1.0, 0.0, 0.0, 0.0]) },
            chaser: body(8.0, 0.1),
            debris: body(2.0, 0.1),
            start: rest,
            goal: GoalPositions { position: Vec3([0.0; 3]), after_capture: Vec3([0.0; 3]) },
            capture: CaptureThresholds { distance: 0.5, angle: 0.3, rate: 0.05, speed: f64::INFINITY },
            settled: SettledThresholds { angle: 0.2, rate: 0.01 },
            actuators: Limits::exact(Vec3([0.4; 3]), Vec3([0.02; 3])),
            disturbances: Disturbances::none(),
            sensors: NoiseSigmas { position: 0.0, velocity: 0.0, attitude: 0.0, rate: 0.0 },
            belief: Belief {
                chaser_mass: 8.0,
                chaser_inertia: Mat3::from_scale(0.1),
                stack_mass: 10.0,
                stack_inertia: Mat3::from_scale(0.2),
            },
        },
        law,
        plan: Plan {
            control_period: 0.5,
            steps_per_period: 5,
            periods: 10,
            dwell_ticks: 0,
            goal: Goal::Fixed,
            stack_goal: StackGoal::Reached,
            distance_from: DistanceFrom::Goal,
            transition: Transition::Approximate,
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

fn summary(recipe: &FlightRecipe) -> Summary {
    let prepared = PreparedFlight::new(recipe);
    let mut scene = Scene::<f64>::new(&recipe.plan, Common::new(recipe, []).unwrap(), &prepared);
    let (mut flight, mut metrics) = (prepared.start(&recipe.plan), Metrics::default());
    let last = fly_alone(&mut scene, &mut flight, &mut Stream::new(0, |_| 0), &mut metrics);
    metrics.summary(&scene, &flight, last, 0)
}

/// Ticks 2 and 3: over the force limit on x and the torque limit on z; tick 6: within both.
fn scripted() -> LawRecipe {
    let segment = |first_tick, end_tick, force, torque| Segment {
        first_tick,
        end_tick,
        frame: WrenchFrame::Lvlh,
        force: Vec3(force),
        torque: Vec3(torque),
    };
    LawRecipe::None {
        segments: vec![
            segment(2, 4, [1.0, -0.2, 0.0], [0.0, 0.0, 0.05]),
            segment(6, 7, [-0.1, 0.0, 0.3], [0.01, 0.0, 0.0]),
        ],
    }
}

#[test]
fn effort_of_a_scripted_flight_has_its_known_numbers() {
    let s = summary(&recipe(scripted()));
    // Applied: (0.4, -0.2, 0) N for 1 s, (-0.1, 0, 0.3) N for 0.5 s; (0, 0, 0.02) N m for 1 s, (0.01, 0, 0) for 0.5 s.
    assert_near(&s.impulse, &[0.45, 0.2, 0.15], 1e-15);
    assert_near(&s.torque_impulse, &[0.005, 0.0, 0.02], 1e-16);
    // 8 kg.
    assert_near(&s.delta_v, &[0.05625, 0.025, 0.01875], 1e-16);
    assert_near(&[s.peak_force_command, s.peak_force], &[1.0, 0.4], 0.0);
    assert_near(&[s.peak_torque_command, s.peak_torque], &[0.05, 0.02], 0.0);
    // Two of ten ticks.
    assert_near(&[s.force_saturated_share, s.torque_saturated_share], &[0.2, 0.2], 1e-16);
    // Asked for: 1.2 up, 1.2 down, 0.4 up, 0.4 down; 0.05 twice, 0.01 twice; over 5 s.
    assert_near(&[s.force_chattering, s.torque_chattering], &[0.64, 0.024], 1e-15);
    // Nothing happened.
    for never in [s.capture_time, s.settling_time, s.diverged_time, s.final_rate, s.capture_distance] {
        assert!(never.is_nan());
    }
    assert!(s.delta_v_to_capture.iter().all(|x| x.is_nan()));
}

#[test]
fn demand_at_the_limit_is_not_saturated() {
    let mut recipe = recipe(scripted());
    recipe.case.actuators.force = Vec3([1.0, 0.2, 0.3]);
    let s = summary(&recipe);
    assert_eq!((s.force_saturated_share, s.torque_saturated_share), (0.0, 0.2));
    recipe.case.actuators = Limits::exact(Vec3([f64::INFINITY; 3]), Vec3([f64::INFINITY; 3]));
    let s = summary(&recipe);
    assert_eq!((s.force_saturated_share, s.torque_saturated_share), (0.0, 0.0));
    assert_near(&[s.peak_force, s.peak_torque], &[1.0, 0.05], 0.0);
}

#[test]
fn last_tick_is_commanded_but_not_flown_and_so_not_counted() {
    let law = LawRecipe::None {
        segments: vec![Segment {
            first_tick: 9,
            end_tick: 11,
            frame: WrenchFrame::Lvlh,
            force: Vec3([0.1, 0.0, 0.0]),
            torque: Vec3([0.0; 3]),
        }],
    };
    // Tick 9 alone: 0.05 N s, one change of 0.1.
    let s = summary(&recipe(law));
    assert_near(&s.impulse, &[0.05, 0.0, 0.0], 1e-17);
    assert_near(&[s.force_chattering], &[0.02], 1e-17);
}

/// PD that only damps the stack's rate: kd on I = 0.2.
fn damper() -> LawRecipe {
    let zero = pd::Gains { kp: Vec3([0.0; 3]), kd: Vec3([0.0; 3]) };
    let rotation = pd::Gains { kd: Vec3([0.1; 3]), ..zero };
    let gains = |rotation| PhaseGains { translation: zero, rotation };
    LawRecipe::Pd(Gains { form: Some(Form::Printed), before: gains(zero), after: gains(rotation) })
}

#[test]
fn capture_and_settling_of_a_drifting_chaser_have_their_known_numbers() {
    // From 1.25 m at 0.2 m/s: distance at tick k is 1.25 - 0.1 k, first below 0.5 at k = 8 (0.45 m). Spin of 0.04 rad/s about z, kept
    // until then: 0.16 rad at 4 s. The stack (plain sum, 0.2 kg m²) is damped by 0.1 N m s with the torque held for
    // 0.5 s: each tick leaves 1 - 0.25 = 3/4 of the rate.
    let mut recipe = recipe(damper());
    recipe.plan.periods = 20;
    recipe.case.settled.angle = 3.0;
    recipe.case.start.position = Vec3([0.0, 1.25, 0.0]);
    recipe.case.start.velocity = Vec3([0.0, -0.2, 0.0]);
    recipe.case.start.chaser_rate = Vec3([0.0, 0.0, 0.04]);
    let s = summary(&recipe);
    assert_near(&[s.capture_time, s.capture_distance, s.capture_angle], &[4.0, 0.45, 0.16], 1e-13);
    assert_near(&[s.capture_rate, s.capture_speed], &[0.04, 0.2], 1e-14);
    // 0.04·0.75^k < 0.01 from k = 5 (0.0095): 2.5 s after capture.
    assert_near(&[s.settling_time], &[2.5], 1e-14);
    // 12 ticks of damping to the end at 10 s: 0.04·0.75¹².
    assert_near(&[s.final_rate], &[0.04 * 0.75_f64.powi(12)], 1e-15);
    assert_near(&[s.momentum_at_capture, s.final_momentum], &[0.008, 0.008 * 0.75_f64.powi(12)], 1e-16);
    // Angle: 0.16 before, then at each tick the mean of two rates times 0.5 s: 0.5·(1 + 0.75)/2·0.04·(1 - 0.75¹²)/0.25.
    let turned = 0.16 + 0.0175 * (1.0 - 0.75_f64.powi(12)) / 0.25;
    assert_near(&[s.final_pointing], &[turned], 1e-13);
    // Torque impulse is the momentum taken away.
    assert_near(&s.torque_impulse, &[0.0, 0.0, 0.008 * (1.0 - 0.75_f64.powi(12))], 1e-15);
    assert_eq!(s.delta_v_to_capture, [0.0; 3]);
}

#[test]
fn settling_needs_both_thresholds_to_the_end() {
    let mut recipe = recipe(damper());
    recipe.plan.periods = 20;
    recipe.case.start.position = Vec3([0.0, 0.3, 0.0]);
    recipe.case.start.chaser_rate = Vec3([0.0, 0.0, 0.04]);
    // Captured at once; the angle ends near 0.07 rad.
    recipe.case.settled = SettledThresholds { angle: 0.05, rate: 0.01 };
    let never = summary(&recipe);
    assert_eq!(never.capture_time, 0.0);
    assert!(never.settling_time.is_nan() && never.final_rate < 0.01);
    recipe.case.settled.angle = 0.1;
    assert_near(&[summary(&recipe).settling_time], &[2.5], 1e-14);
    // Settled from the first tick: zero, not one period.
    recipe.case.settled = SettledThresholds { angle: 0.1, rate: 0.05 };
    assert_eq!(summary(&recipe).settling_time, 0.0);
}

#[test]
fn capture_without_a_merge_is_noted_and_nothing_else_changes() {
    let mut recipe = recipe(damper());
    recipe.plan.transition = Transition::None;
    recipe.case.start.position = Vec3([0.0, 0.3, 0.0]);
    let s = summary(&recipe);
    assert_eq!((s.capture_time, s.capture_distance), (0.0, 0.3));
    for none in [s.settling_time, s.final_rate, s.final_pointing, s.momentum_at_capture, s.final_momentum] {
        assert!(none.is_nan());
    }
}

#[test]
fn capture_distance_is_the_one_that_was_judged() {
    // 0.3 m from the debris, 0.7 m from a goal on its other side.
    let mut recipe = recipe(damper());
    recipe.case.start.position = Vec3([0.0, 0.3, 0.0]);
    recipe.case.goal.position = Vec3([0.0, -0.4, 0.0]);
    assert!(summary(&recipe).capture_time.is_nan());
    recipe.plan.distance_from = DistanceFrom::Debris;
    let s = summary(&recipe);
    assert_eq!(s.capture_time, 0.0);
    assert_near(&[s.capture_distance], &[0.3], 1e-16);
}

#[test]
fn flight_that_leaves_the_numbers_is_dated_by_its_first_such_tick() {
    // Unstable feedback without limits: the state overflows.
    let mut recipe = recipe(damper());
    let explosive = pd::Gains { kp: Vec3([-1e30; 3]), kd: Vec3([0.0; 3]) };
    let still = pd::Gains { kp: Vec3([0.0; 3]), kd: Vec3([0.0; 3]) };
    let gains = PhaseGains { translation: explosive, rotation: still };
    recipe.law = LawRecipe::Pd(Gains { form: Some(Form::Printed), before: gains, after: gains });
    recipe.case.actuators.force = Vec3([f64::INFINITY; 3]);
    recipe.plan.periods = 30;
    // Each tick multiplies the distance by 1 + 1e30·0.5²/2/8 = 1.56e28 and more: its square passes 1e308 within 6 ticks,
    // and not before the fourth.
    let s = summary(&recipe);
    assert!(s.diverged_time >= 2.0 && s.diverged_time <= 3.0, "{}", s.diverged_time);
    assert!(s.settling_time.is_nan());
}
