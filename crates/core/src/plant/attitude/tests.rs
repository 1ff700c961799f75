use super::*;
use crate::tests::{Random, angle_between, assert_near, brief, fitted_order};

const FULL: Mat3<f64> = Mat3([[0.10, 0.012, -0.02], [0.012, 0.13, 0.008], [-0.02, 0.008, 0.07]]);
const DEBRIS: [f64; 3] = [0.05, 0.05, 0.08];

fn fly<B: RigidBody<f64>>(body: &B, start: Spin<f64>, torque: Vec3<f64>, step: f64, time: f64) -> Spin<f64> {
    (0..(time / step).round() as u32).fold(start, |spin, _| spin_step(body, &spin, torque, step))
}

fn spin(rate: [f64; 3]) -> Spin<f64> {
    Spin { attitude: Quat::identity(), rate: Vec3(rate) }
}

#[test]
fn validation_rates_are_those_of_nesc_check_case_2() {
    // NASA/TM-2015-218675: torque-free triaxial tumble; only ratios of the moments of inertia matter. deg, s.
    let body = Inertia::new(Mat3::diagonal(Vec3([0.001894220, 0.006211019, 0.007194665])));
    let start = spin([10.0_f64, 20.0, 30.0].map(f64::to_radians));
    let published = [
        (1.0, [4.2588418987, 23.1199428975, 28.3798177751]),
        (10.0, [-2.4189022217, -23.5525695196, 28.1285926300]),
        (30.0, [12.6183907759, -17.3974747616, 31.1195888869]),
    ];
    for (step, tolerance) in [(0.05, 1e-6), (0.005, 1e-8)] {
        for (time, rates) in published {
            let end = fly(&body, start, Vec3::zero(), step, time).rate.0.map(f64::to_degrees);
            let error = (0..3).map(|i| (end[i] - rates[i]).abs()).fold(0.0, f64::max);
            println!("NESC 2, step {step} s, {time} s: {error:.1e} deg/s");
            assert_near(&end, &rates, tolerance);
        }
    }
}

#[test]
fn validation_tumble_is_that_of_basilisks_spacecraft_unit_test() {
    // Basilisk: I = diag(500, 200, 300) kg m², MRP 0 at t = 0; nine decimals at 10 s.
    let body = Inertia::new(Mat3::diagonal(Vec3([500.0, 200.0, 300.0])));
    let end = fly(&body, spin([0.5, -0.4, 0.7]), Vec3::zero(), 0.002, 10.0);
    assert_near(&end.rate.0, &[0.487647275, 0.314641583, 0.742294197], 1e-9);
    let parameters = |q: Quat<f64>| q.vector() * (1.0 / (1.0 + q.scalar()));
    let (mrp, shadow) = (parameters(end.attitude), parameters(end.attitude.scale(-1.0)));
    let mrp = if mrp.norm() <= 1.0 { mrp } else { shadow };
    assert_near(&mrp.0, &[0.373034285, -0.002395644, 0.208570797], 1e-9);
}

#[test]
fn axisymmetric_body_follows_its_closed_form() {
    // Textbook: ω_z constant, ω_x + i ω_y turns at (I_z - I_x)/I_x ω_z; the body turns about L at L/I_x and against
    // that about its own axis at (1 - I_z/I_x) ω_z.
    let (transverse, axial) = (DEBRIS[0], DEBRIS[2]);
    let body = Inertia::new(Mat3::diagonal(Vec3(DEBRIS)));
    let start = spin([0.05, -0.03, 0.04]);
    let (time, wz) = (600.0, 0.04);
    let end = fly(&body, start, Vec3::zero(), 0.05, time);

    let (sin, cos) = ((axial - transverse) / transverse * wz * time).sin_cos();
    assert_near(&end.rate.0, &[0.05 * cos + 0.03 * sin, 0.05 * sin - 0.03 * cos, wz], 1e-11);

    let momentum = start.attitude.rotate(body.momentum(start.rate));
    let precession = Quat::from_rotation_vector(momentum * (time / transverse));
    let exact = precession * start.attitude * Quat::about_z((1.0 - axial / transverse) * wz * time);
    let error = angle_between(end.attitude, exact);
    println!("axisymmetric, 600 s at 0.05 s: {error:.1e} rad");
    assert!(error < 1e-11);
}

#[test]
fn constant_torque_about_a_principal_axis_follows_its_closed_form() {
    let body = Inertia::new(Mat3::diagonal(Vec3([0.1, 0.1, 0.05])));
    let end = fly(&body, spin([0.0, 0.2, 0.0]), Vec3([0.0, 0.01, 0.0]), 0.05, 10.0);
    // ω = 0.2 + 0.1 t, angle = 0.2 t + 0.05 t².
    assert_near(&end.rate.0, &[0.0, 1.2, 0.0], 1e-14);
    assert!(angle_between(end.attitude, Quat::from_rotation_vector(Vec3([0.0, 7.0, 0.0]))) < 1e-13);
}

#[test]
fn order_is_four_in_rate_and_attitude() {
    let body = Inertia::new(FULL);
    let (start, time) = (spin([0.3, -0.5, 0.4]), 16.0);
    for torque in [Vec3([0.0; 3]), Vec3([0.01, -0.006, 0.008])] {
        let steps = [0.2, 0.1, 0.05, 0.025];
        let exact = fly(&body, start, torque, 1.0 / 1024.0, time);
        let ends = steps.map(|h| fly(&body, start, torque, h, time));
        let rate_errors = ends.map(|end| (end.rate - exact.rate).norm());
        let attitude_errors = ends.map(|end| angle_between(end.attitude, exact.attitude));
        for (what, errors) in [("rate", rate_errors), ("attitude", attitude_errors)] {
            let order = fitted_order(&steps, &errors);
            println!("torque {:?}: order of the {what} {order:.3}, errors {}", torque.0, brief(&errors));
            assert!((order - 4.0).abs() < 0.15);
        }
    }
}

/// The textbook's way, for comparison: q' = ½ q ⊗ [0, ω] and Euler's equation through RK4 together.
fn quaternion_rk4_step(body: &Inertia<f64>, spin: &Spin<f64>, torque: Vec3<f64>, h: f64) -> Spin<f64> {
    let add = |s: &Spin<f64>, k: &(Quat<f64>, Vec3<f64>), h: f64| Spin {
        attitude: Quat(std::array::from_fn(|i| s.attitude.0[i] + h * k.0.0[i])),
        rate: s.rate + k.1 * h,
    };
    let f = |s: &Spin<f64>| (s.attitude.times_pure(s.rate * 0.5), body.angular_acceleration(s.rate, torque));
    let k1 = f(spin);
    let k2 = f(&add(spin, &k1, h / 2.0));
    let k3 = f(&add(spin, &k2, h / 2.0));
    let k4 = f(&add(spin, &k3, h));
    let sum = add(&add(&add(&add(spin, &k1, h / 6.0), &k2, h / 3.0), &k3, h / 3.0), &k4, h / 6.0);
    Spin { attitude: sum.attitude.normalized(), rate: sum.rate }
}

#[test]
fn magnus_step_is_more_accurate_than_rk4_on_the_quaternion() {
    // Over random bodies and tumbles: the mean of the ratio of errors, in powers.
    let mut noise = Random::new(2);
    let (count, mut sum, mut worse) = (40, 0.0, 0);
    for _ in 0..count {
        let body = Inertia::new(noise.inertia(0.1));
        let start = Spin { attitude: noise.attitude(), rate: noise.vector(0.4) };
        let torque = noise.vector(0.005);
        let exact = fly(&body, start, torque, 1.0 / 256.0, 10.0);
        let magnus = fly(&body, start, torque, 0.1, 10.0);
        let textbook = (0..100).fold(start, |spin, _| quaternion_rk4_step(&body, &spin, torque, 0.1));
        let ratio = angle_between(textbook.attitude, exact.attitude) / angle_between(magnus.attitude, exact.attitude);
        sum += ratio.ln();
        worse += i32::from(ratio < 1.0);
    }
    let gain = (sum / f64::from(count)).exp();
    println!("Magnus: {gain:.1} times smaller error in the geometric mean, worse in {worse} of {count}");
    assert!(gain > 1.5 && 4 * worse < count);
}

#[test]
fn free_tumble_keeps_momentum_energy_and_norm() {
    for (tensor, rate) in
        [(Mat3::diagonal(Vec3(DEBRIS)), [0.05, -0.03, 0.04]), (FULL, [0.05, -0.03, 0.04]), (FULL, [0.2, -0.1, 0.15])]
    {
        let body = Inertia::new(tensor);
        let start = spin(rate);
        let in_n = |s: &Spin<f64>| s.attitude.rotate(body.momentum(s.rate));
        let energy = |s: &Spin<f64>| 0.5 * s.rate.dot(body.momentum(s.rate));
        let (mut now, mut momentum, mut work, mut norm) = (start, 0.0_f64, 0.0_f64, 0.0_f64);
        for _ in 0..12_000 {
            now = spin_step(&body, &now, Vec3::zero(), 0.05);
            momentum = momentum.max((in_n(&now) - in_n(&start)).norm() / in_n(&start).norm());
            work = work.max((energy(&now) / energy(&start) - 1.0).abs());
            norm = norm.max((now.attitude.norm_squared().sqrt() - 1.0).abs());
        }
        println!("600 s at 0.05 s, {rate:?}: momentum {momentum:.1e}, energy {work:.1e}, norm {norm:.1e}");
        // Slow, only round-off is left, of 12 000 steps; it must not all go one way, 12 000 · 2e-16.
        let fast = rate[0] > 0.1;
        assert!(momentum < if fast { 1e-9 } else { 2e-12 });
        assert!(work < if fast { 1e-11 } else { 2e-13 });
        assert!(norm < 4e-16);
    }
}

#[test]
fn principal_axes_path_gives_the_bits_of_the_general_path() {
    let mut noise = Random::new(3);
    for _ in 0..200 {
        let moments = Vec3([0; 3].map(|_| noise.between(0.01, 0.2)));
        let body = Inertia::new(Mat3::diagonal(moments));
        let start = Spin { attitude: noise.attitude(), rate: noise.vector(0.5) };
        let torque = noise.vector(0.01);
        let bits = |s: Spin<f64>| (s.attitude.0.map(f64::to_bits), s.rate.0.map(f64::to_bits));
        assert_eq!(bits(fly(&Principal(&body), start, torque, 0.05, 5.0)), bits(fly(&body, start, torque, 0.05, 5.0)));
    }
}

#[test]
fn series_of_a_small_rotation_is_exact_to_rounding_up_to_0_3_rad() {
    // First power left out: (|φ|/2)¹¹/11!, in the angle twice that: 4e-17 at 0.3, 1.2e-14 at 0.5 rad.
    let mut noise = Random::new(36);
    for (size, bound) in [(1e-6, 4e-22), (0.01, 5e-18), (0.3, 3e-16), (0.5, 1.3e-14)] {
        for _ in 0..50 {
            let turn = noise.vector(1.0);
            let turn = turn * (size / turn.norm());
            let error = angle_between(renormalized(small_rotation(turn)), Quat::from_rotation_vector(turn));
            assert!(error < bound, "{size}: {error:e}");
        }
    }
}

#[test]
fn momentum_and_rate_undo_each_other_and_match_euler() {
    let body = Inertia::new(FULL);
    let (rate, torque) = (Vec3([0.3, -0.5, 0.4]), Vec3([0.01, -0.006, 0.008]));
    assert_near(&body.rate(body.momentum(rate)).0, &rate.0, 1e-15);
    let acceleration = body.angular_acceleration(rate, torque);
    assert_near(&(FULL * acceleration + rate.cross(FULL * rate)).0, &torque.0, 1e-16);
    // One small step's change of rate is that acceleration.
    let after = spin_step(&body, &Spin { attitude: Quat::identity(), rate }, torque, 1e-6);
    assert_near(&((after.rate - rate) * 1e6).0, &acceleration.0, 1e-6);
}
