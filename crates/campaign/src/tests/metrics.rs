//! Every metric against its plain definition over the history of the flight.

use super::fixture::{Campaign, LAWS, Way, alone};
use crate::FlightRecord;
use detumble_core::case::FlightRecipe;
use detumble_core::gnc::guidance::Goal;
use detumble_core::number::Backend;

/// Rows of a series as slices.
fn rows<'a>(record: &'a FlightRecord, name: &str) -> Vec<&'a [f64]> {
    let series = record.series.iter().find(|s| s.name == name).unwrap();
    series.values.chunks(series.width).collect()
}

fn largest(rows: &[&[f64]]) -> f64 {
    rows.iter().flat_map(|row| row.iter()).fold(0.0, |m, x| m.max(x.abs()))
}

#[track_caller]
fn same(what: &str, got: f64, want: f64) {
    assert!(
        (got - want).abs() <= 1e-12 * want.abs().max(1e-3) || got.is_nan() && want.is_nan(),
        "{what}: {got} {want}"
    );
}

fn check(recipe: &FlightRecipe, record: &FlightRecord) {
    let (s, plan, case) = (&record.summary, &recipe.plan, &recipe.case);
    let period = plan.control_period;
    let flown = plan.periods as usize;
    let time: Vec<f64> = rows(record, "time").iter().map(|row| row[0]).collect();
    assert_eq!(time.len(), flown + 1);
    let captured_row = rows(record, "captured").iter().position(|row| row[0] == 1.0);
    let capture = captured_row.map_or(f64::NAN, |k| time[k]);
    same("capture time", s.capture_time, capture);
    let stack_mass = record.merge.map_or(f64::NAN, |merge| merge.stack_mass);
    let mass = |k: usize| if captured_row.is_some_and(|c| k >= c) { stack_mass } else { case.chaser.mass };

    let (force, force_command) = (rows(record, "force"), rows(record, "force_command"));
    let (torque, torque_command) = (rows(record, "torque"), rows(record, "torque_command"));
    for axis in 0..3 {
        let sum = |f: &dyn Fn(usize) -> f64, to: usize| (0..to).map(|k| f(k) * period).sum::<f64>();
        same("impulse", s.impulse[axis], sum(&|k| force[k][axis].abs(), flown));
        same("torque impulse", s.torque_impulse[axis], sum(&|k| torque[k][axis].abs(), flown));
        same("Δv", s.delta_v[axis], sum(&|k| force[k][axis].abs() / mass(k), flown));
        let to_capture = captured_row.map_or(f64::NAN, |c| sum(&|k| force[k][axis].abs() / mass(k), c));
        same("Δv to capture", s.delta_v_to_capture[axis], to_capture);
    }
    same("peak force", s.peak_force, largest(&force[..flown]));
    same("peak force command", s.peak_force_command, largest(&force_command[..flown]));
    same("peak torque", s.peak_torque, largest(&torque[..flown]));
    same("peak torque command", s.peak_torque_command, largest(&torque_command[..flown]));
    let share = |command: &[&[f64]], limit: [f64; 3]| {
        let over = command[..flown].iter().filter(|row| (0..3).any(|i| row[i].abs() > limit[i]));
        over.count() as f64 / flown as f64
    };
    same("force saturated", s.force_saturated_share, share(&force_command, case.actuators.force.0));
    same("torque saturated", s.torque_saturated_share, share(&torque_command, case.actuators.torque.0));
    let variation = |command: &[&[f64]]| {
        let steps = command[..flown].windows(2).flat_map(|w| (0..3).map(|i| (w[1][i] - w[0][i]).abs()));
        steps.sum::<f64>() / (flown as f64 * period)
    };
    same("force chattering", s.force_chattering, variation(&force_command));
    same("torque chattering", s.torque_chattering, variation(&torque_command));

    let (angle, rate) = (rows(record, "angle_error"), rows(record, "rate_error"));
    let Some(merge) = &record.merge else {
        for none in [s.settling_time, s.final_rate, s.final_pointing, s.momentum_at_capture, s.capture_distance] {
            assert!(none.is_nan());
        }
        return;
    };
    let c = captured_row.unwrap();
    let unsettled = (c..=flown).rev().find(|&k| angle[k][0] >= case.settled.angle || rate[k][0] >= case.settled.rate);
    let settling = match unsettled {
        Some(k) if k == flown => f64::NAN,
        Some(k) => time[k + 1] - capture,
        None => 0.0,
    };
    same("settling time", s.settling_time, settling);
    same("final rate", s.final_rate, rate[flown][0]);
    same("final pointing", s.final_pointing, angle[flown][0]);
    let momentum = |k: usize| {
        let w = rows(record, "chaser_rate")[k];
        let row = |i: usize| (0..3).map(|j| merge.stack_inertia.0[i][j] * w[j]).sum::<f64>();
        (0..3).map(|i| row(i).powi(2)).sum::<f64>().sqrt()
    };
    same("momentum at capture", s.momentum_at_capture, momentum(c));
    same("final momentum", s.final_momentum, momentum(flown));

    // At capture, from the state before the merge; the goal is what it was a moment before the stack's own took over.
    let before = &merge.before;
    if plan.goal == Goal::Fixed {
        let goal = case.goal.position;
        same("capture distance", s.capture_distance, (before.position - goal).norm());
        same("capture speed", s.capture_speed, before.velocity.norm());
    }
    let error = before.debris_attitude.conjugate() * before.chaser_attitude;
    same("capture angle", s.capture_angle, 2.0 * error.vector().norm().atan2(error.scalar().abs()));
    let in_n = before.chaser_attitude.rotate(before.chaser_rate) - before.debris_attitude.rotate(before.debris_rate);
    same("capture rate", s.capture_rate, in_n.norm());
    assert!(
        s.capture_distance < case.capture.distance && s.capture_angle < 20f64.to_radians() && s.capture_rate < 0.05
    );
}

#[test]
fn metrics_are_their_definitions_over_the_history() {
    let (mut captured, mut settled) = (0, 0);
    for law in LAWS {
        for way in [Way::Paper, Way::Corrected] {
            let campaign = Campaign::new(law, way, 150, true);
            for i in 0..6 {
                let recipe = campaign.recipe(i);
                let record = alone(&recipe, i, Backend::best_for_one());
                check(&recipe, &record);
                captured += u32::from(record.merge.is_some());
                settled += u32::from(record.summary.settling_time.is_finite());
            }
        }
    }
    println!("72 flights, {captured} captured, {settled} settled");
    assert!(captured > 36 && captured < 72 && settled > 10);
}

#[test]
fn merge_in_the_record_is_the_conserving_one_of_its_state_before() {
    let campaign = Campaign::new("prrl", Way::Corrected, 60, false);
    let mut seen = 0;
    for i in 0..8 {
        let recipe = campaign.recipe(i);
        let record = alone(&recipe, i, Backend::best_for_one());
        let Some(merge) = record.merge else { continue };
        seen += 1;
        // Angular momentum about the common centre of mass, in N: H turns from N's axes by n t about z.
        let (case, n) = (&recipe.case, recipe.case.orbit.mean_motion);
        let (b, a) = (&merge.before, &merge.after);
        let (s, c) = (n * record.summary.capture_time).sin_cos();
        let to_n = |v: [f64; 3]| [c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]];
        let [x, y, z] = b.position.0;
        let [u, v, w] = b.velocity.0;
        let (r, rr) = (to_n([x, y, z]), to_n([u - n * y, v + n * x, w]));
        let reduced = case.chaser.mass * case.debris.mass / merge.stack_mass;
        let orbital = [r[1] * rr[2] - r[2] * rr[1], r[2] * rr[0] - r[0] * rr[2], r[0] * rr[1] - r[1] * rr[0]];
        let spin = b.chaser_attitude.rotate(case.chaser.inertia * b.chaser_rate)
            + b.debris_attitude.rotate(case.debris.inertia * b.debris_rate);
        let after = a.chaser_attitude.rotate(merge.stack_inertia * a.chaser_rate);
        for k in 0..3 {
            assert!((spin[k] + reduced * orbital[k] - after[k]).abs() < 1e-16);
        }
    }
    assert!(seen > 3);
}
