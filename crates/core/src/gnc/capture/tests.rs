use super::*;
use crate::number::{Quat, Vec3};

const ANGLE: f64 = 0.349;

fn test(speed: f64) -> CaptureTest<f64> {
    CaptureTest::new(&CaptureThresholds { distance: 0.5, angle: ANGLE, rate: 0.25, speed })
}

fn motion(distance: f64) -> Motion<f64> {
    Motion {
        position: Vec3([0.0, distance, 0.0]),
        velocity: Vec3::zero(),
        chaser_attitude: Quat::identity(),
        chaser_rate: Vec3::zero(),
        debris_attitude: Quat::identity(),
        debris_rate: Vec3::zero(),
    }
}

/// Distance, angle, rate, speed.
fn error([distance, angle, rate, speed]: [f64; 4]) -> TrackingError<f64> {
    let (sin, cos) = (0.5 * angle).sin_cos();
    TrackingError {
        position: Vec3([distance, 0.0, 0.0]),
        velocity: Vec3([0.0, 0.0, speed]),
        attitude: Quat([cos, 0.0, sin, 0.0]),
        rate: Vec3([0.0, rate, 0.0]),
    }
}

#[test]
fn every_threshold_is_strict_and_all_must_hold_at_once() {
    let thresholds = [0.5, ANGLE, 0.25, 0.125];
    let holds = |values| test(0.125).holds(&Judged::of(&error(values), &motion(9.0), DistanceFrom::Goal));
    let below = thresholds.map(|x| x * (1.0 - 1e-9));
    assert!(holds(below));
    for k in 0..4 {
        for value in [thresholds[k], thresholds[k] * (1.0 + 1e-9)] {
            let mut values = below;
            values[k] = value;
            assert!(!holds(values), "quantity {k} at {value}");
        }
    }
}

#[test]
fn without_a_speed_threshold_speed_does_not_matter() {
    assert!(test(f64::INFINITY).holds(&Judged::of(&error([0.1, 0.1, 0.1, 1e3]), &motion(9.0), DistanceFrom::Goal)));
}

#[test]
fn distance_counts_from_the_goal_or_from_the_debris() {
    let near_goal = error([0.1, 0.0, 0.0, 0.0]);
    assert!(test(f64::INFINITY).holds(&Judged::of(&near_goal, &motion(0.6), DistanceFrom::Goal)));
    assert!(!test(f64::INFINITY).holds(&Judged::of(&near_goal, &motion(0.6), DistanceFrom::Debris)));
    let far_from_goal = error([0.6, 0.0, 0.0, 0.0]);
    assert!(test(f64::INFINITY).holds(&Judged::of(&far_from_goal, &motion(0.4), DistanceFrom::Debris)));
}

#[test]
fn what_is_not_a_number_never_captures() {
    for speed in [0.125, f64::INFINITY] {
        for k in 0..4 {
            let mut values = [0.1, 0.1, 0.1, 0.1];
            values[k] = f64::NAN;
            assert!(!test(speed).holds(&Judged::of(&error(values), &motion(0.1), DistanceFrom::Goal)), "quantity {k}");
        }
        assert!(!test(speed).holds(&Judged::of(&error([0.1; 4]), &motion(f64::NAN), DistanceFrom::Debris)));
    }
}

#[test]
fn capture_needs_the_dwell_without_a_break() {
    // Dwell of 3 ticks of 0.1 s: held at the tick itself and at the three before it.
    let mut state = CaptureState::<f64>::open();
    let pattern = [true, true, true, false, true, true, true, true, false, true];
    let newly: Vec<bool> =
        pattern.iter().enumerate().map(|(k, &holds)| state.judge(holds, 0.1 * k as f64, 3)).collect();
    assert_eq!(newly.iter().position(|&x| x), Some(7));
    assert_eq!(newly.iter().filter(|&&x| x).count(), 1);
    assert_eq!(state.time, 0.1 * 7.0);
}

#[test]
fn capture_without_dwell_is_at_the_first_tick_that_holds_and_happens_once() {
    let mut state = CaptureState::<f64>::open();
    assert!(!state.captured() && !state.judge(false, 0.0, 0) && !state.captured());
    assert!(state.judge(true, 0.1, 0) && state.captured());
    assert!(!state.judge(false, 0.2, 0) && !state.judge(true, 0.3, 0));
    assert_eq!(state.time, 0.1);
    // A start inside the thresholds is a capture at t = 0.
    let mut at_once = CaptureState::<f64>::open();
    assert!(at_once.judge(true, 0.0, 0) && at_once.time == 0.0);
}

#[test]
fn settled_thresholds_are_half_angle_and_square() {
    let test = SettledTest::new(&SettledThresholds { angle: 0.2, rate: 0.005 });
    // sin² 0.1 and 25e-6.
    assert!((test.sin_squared - 0.009_966_711_079_379_185).abs() < 1e-17);
    assert!((test.rate_squared - 25e-6).abs() < 1e-20);
}
