use super::*;
use crate::number::Mat3;
use crate::tests::{Random, assert_near};

const N: f64 = 1.0618120e-3;

/// Φ, column by column: what a step without acceleration makes of each unit vector of (r, v).
fn transition(step: &HeldStep<f64>) -> [[f64; 6]; 6] {
    let mut matrix = [[0.0; 6]; 6];
    for column in 0..6 {
        let mut unit = [0.0; 6];
        unit[column] = 1.0;
        let [x, y, z, u, v, w] = unit;
        let (r, v) = step.advance(Vec3([x, y, z]), Vec3([u, v, w]), Vec3::zero());
        for row in 0..3 {
            (matrix[row][column], matrix[row + 3][column]) = (r[row], v[row]);
        }
    }
    matrix
}

fn multiply(a: &[[f64; 6]; 6], b: &[[f64; 6]; 6]) -> [[f64; 6]; 6] {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..6).map(|k| a[i][k] * b[k][j]).sum()))
}

#[test]
fn validation_transition_matrix_is_that_of_orekits_clohessy_wiltshire_test() {
    // Orekit: mu = 3.986004415e14 m³/s², r = 6677.9933719419 km, t = 8 h; lengths and speeds share their unit.
    let n = (3.986004415e14_f64 / 6_677_993.371_941_9_f64.powi(3)).sqrt();
    let matrix = transition(&HeldStep::new(n, 8.0 * 3600.0));
    let from_position = [[4.97868541238670, 0.0, 0.0], [-194.242457498099, 1.0, 0.0], [0.0, 0.0, -0.326228470795567]];
    let from_velocity = [
        [817.081897951423, 2292.70633171889, 0.0],
        [-2292.70633171889, -83131.6724081943, 0.0],
        [0.0, 0.0, 817.081897951423],
    ];
    let mut worst = 0.0_f64;
    for i in 0..3 {
        for j in 0..3 {
            for (got, want) in [(matrix[i][j], from_position[i][j]), (matrix[i][j + 3], from_velocity[i][j])] {
                worst = worst.max((got - want).abs() / want.abs().max(1.0));
            }
        }
    }
    println!("Orekit's matrix: {worst:.1e} relative");
    assert!(worst < 1e-10);
}

#[test]
fn validation_two_impulse_rendezvous_is_that_of_curtis() {
    // Curtis, Orbital Mechanics for Engineering Students, ch. 7, as Orekit tests it.
    let step = HeldStep::new(0.00115697, 8.0 * 3600.0);
    let (r0, v0) = (Vec3([20e3; 3]), Vec3([-20.0, 20.0, -5.0]));
    let matrix = transition(&step);
    let block =
        |row: usize, column: usize| Mat3(std::array::from_fn(|i| std::array::from_fn(|j| matrix[row + i][column + j])));
    let departure = -(block(0, 3).inverse() * (block(0, 0) * r0));
    let first = departure - v0;
    let (arrival, arrival_velocity) = step.advance(r0, departure, Vec3::zero());
    assert!(arrival.norm() < 1e-9, "{arrival:?}");
    assert_near(&first.0, &[29.35751148832, -66.75115105877, 13.02971971421], 1e-10);
    assert_near(&[first.norm() + arrival_velocity.norm()], &[109.6694], 5e-5);
}

#[test]
fn steps_compose() {
    for (a, b) in [(0.05, 0.1), (10.0, 590.0), (1000.0, 4000.0)] {
        let product = multiply(&transition(&HeldStep::new(N, a)), &transition(&HeldStep::new(N, b)));
        let whole = transition(&HeldStep::new(N, a + b));
        for i in 0..6 {
            for j in 0..6 {
                let scale = whole[i][j].abs().max(if i < 3 && j < 3 || i > 2 && j > 2 { 1.0 } else { 1e-12 });
                assert!((product[i][j] - whole[i][j]).abs() < 4e-15 * scale, "{a} + {b}, entry {i} {j}");
            }
        }
        // Under a held acceleration likewise.
        let (r, v, held) = (Vec3([3.0, -5.0, 2.0]), Vec3([0.01, 0.02, -0.03]), Vec3([1e-3, -2e-3, 5e-4]));
        let (r1, v1) = HeldStep::new(N, a).advance(r, v, held);
        let (r2, v2) = HeldStep::new(N, b).advance(r1, v1, held);
        let (r3, v3) = HeldStep::new(N, a + b).advance(r, v, held);
        assert!((r2 - r3).norm() < 1e-14 * r3.norm() && (v2 - v3).norm() < 1e-14 * v3.norm());
    }
}

#[test]
fn held_acceleration_agrees_with_fine_integration() {
    let mut noise = Random::new(1);
    for time in [0.05, 1.0, 60.0, 600.0, 5000.0] {
        let (r, v, held) = (noise.vector(20.0), noise.vector(0.05), noise.vector(0.01));
        let (exact_r, exact_v) = HeldStep::new(N, time).advance(r, v, held);
        // The equations of motion as they stand in the module's head, RK4, n h ≤ 2e-3.
        let f = |r: Vec3<f64>, v: Vec3<f64>| {
            let [x, _, z] = r.0;
            let [vx, vy, _] = v.0;
            Vec3([2.0 * N * vy + 3.0 * N * N * x, -2.0 * N * vx, -N * N * z]) + held
        };
        let steps = 4000;
        let h = time / f64::from(steps);
        let (mut r, mut v) = (r, v);
        for _ in 0..steps {
            let (r1, v1) = (v, f(r, v));
            let (r2, v2) = (v + v1 * (h / 2.0), f(r + r1 * (h / 2.0), v + v1 * (h / 2.0)));
            let (r3, v3) = (v + v2 * (h / 2.0), f(r + r2 * (h / 2.0), v + v2 * (h / 2.0)));
            let (r4, v4) = (v + v3 * h, f(r + r3 * h, v + v3 * h));
            r += (r1 + (r2 + r3) * 2.0 + r4) * (h / 6.0);
            v += (v1 + (v2 + v3) * 2.0 + v4) * (h / 6.0);
        }
        let (position_error, velocity_error) =
            ((r - exact_r).norm() / exact_r.norm(), (v - exact_v).norm() / exact_v.norm());
        println!("{time} s: position {position_error:.1e}, velocity {velocity_error:.1e} relative");
        assert!(position_error < 1e-12 && velocity_error < 1e-12);
    }
}

#[test]
fn without_an_orbit_it_is_the_double_integrator() {
    let (r, v, held) = (Vec3([3.0, -5.0, 2.0]), Vec3([0.01, 0.02, -0.03]), Vec3([1e-3, -2e-3, 5e-4]));
    for (n, tolerance) in [(0.0, 1e-16), (1e-12, 1e-9)] {
        for time in [0.05, 100.0] {
            let (new_r, new_v) = HeldStep::new(n, time).advance(r, v, held);
            let (want_r, want_v) = (r + v * time + held * (0.5 * time * time), v + held * time);
            assert!((new_r - want_r).norm() <= tolerance * want_r.norm() * 4.0, "{n} {time}");
            assert!((new_v - want_v).norm() <= tolerance * want_v.norm() * 4.0, "{n} {time}");
        }
    }
}

#[test]
fn natural_acceleration_has_its_known_values() {
    // n = 0.01: 3 n² x + 2 n y' = 3e-4·10 + 0.02·(-0.25), -2 n x' = -0.02·0.5, -n² z = 1e-4·30.
    let a = natural_acceleration(0.01, Vec3([10.0, 20.0, -30.0]), Vec3([0.5, -0.25, 7.0]));
    assert_near(&a.0, &[-0.002, -0.01, 0.003], 1e-17);
}

#[test]
fn coefficients_keep_their_relative_precision_at_every_step_size() {
    // The closed forms in the field comments, in 60 decimal digits (Python's decimal, Taylor series of sin and cos)
    // from these very doubles; nt = 1e-6, 1e-5, 1e-4, 1e-3, 0.1, both sides of the switch at 0.7, 3.
    #[rustfmt::skip]
    let table: [(f64, [f64; 14]); 8] = [
        (0.0009417863049202683, [0.9999999999995, 0.0009417863049201113, 1.9999999999996666e-06, 1.0000000000015, 9.417863049201898e-10, 4.434807220676493e-07, 2.956538147117761e-13, -9.9999999999995e-19, 0.0009417863049196404, 4.4348072206753846e-07, 3.1854359999994694e-09, -3.185435999999735e-15, 0.999999999998, -1.061811999999823e-09]),
        (0.009417863049202684, [0.99999999995, 0.00941786304904572, 1.9999999999666667e-05, 1.00000000015, 9.417863049124203e-08, 4.434807220639907e-05, 2.9565381471031266e-10, -9.999999999950003e-16, 0.009417863048574827, 4.434807220529037e-05, 3.18543599994691e-08, -3.1854359999734557e-13, 0.9999999998, -1.0618119999823033e-08]),
        (0.09417863049202684, [0.999999995, 0.09417863033506245, 0.0001999999996666667, 1.000000015, 9.417863041354465e-06, 0.004434807216981191, 2.95653814563964e-07, -9.999999995000002e-13, 0.0941786298641693, 0.004434807205894173, 3.1854359946909407e-07, -3.185435997345471e-11, 0.99999998, -1.0618119982303135e-07]),
        (0.9417863049202683, [0.9999995000000417, 0.941786147955892, 0.0019999996666666834, 1.000001499999875, 0.0009417862264380788, 0.44348068511096067, 0.00029565379992910044, -9.99999950000001e-10, 0.9417856770627631, 0.44348057424078385, 3.185435469094027e-06, -3.185435734547009e-09, 0.9999980000001667, -1.0618118230313423e-06]),
        (94.17863049202684, [0.9950041652780257, 94.0217445713819, 0.19966683329365634, 1.0149875041659226, 9.410017445600982, 4431.112779663905, 295.50602299642975, -0.0009995001190310866, 93.55108680944707, 4420.029456625029, 0.0003180129593898057, -3.182782354685344e-05, 0.9800166611121031, -0.00010600431979660192]),
        (649.8325503949851, [0.7712460149971067, 599.4820007891867, 1.273074364443936, 1.6862619550086801, 430.87474054332284, 202895.96488988766, 94838.91612789917, -0.3207769066681923, 448.43035197179137, 178160.3442302744, 0.0020276484555884168, -0.0014573623579433536, 0.08498405998842645, -0.0006758828185294722]),
        (668.6682764933904, [0.7583618759905082, 613.8881186326172, 1.3036675420430732, 1.7249143720284754, 455.14295187752964, 214323.69942962108, 103182.40490929312, -0.3489973738707798, 449.54764505029766, 186618.90173552246, 0.00207637476022776, -0.001539445558384599, 0.033447503962032894, -0.0006921249200759199]),
        (2825.358914760805, [-0.9899924966004454, 132.90489094102077, 0.28224001611973426, 6.9699774898013365, 3748.2953603847864, 1765046.6186032866, 5071432.652521885, -17.153279951640798, -7944.457180518332, -4913793.021414384, 0.00044952875399419096, -0.012677987476801874, -6.959969986401782, -0.00014984291799806365]),
    ];
    for (time, exact) in table {
        let s = HeldStep::new(N, time);
        let got = [
            s.cos,
            s.sin_by_n,
            s.two_sin,
            s.x_from_x,
            s.cross,
            s.versine,
            s.lag,
            s.y_from_x,
            s.y_from_vy,
            s.y_from_ay,
            s.vx_from_x,
            s.vy_from_x,
            s.vy_from_vy,
            s.vz_from_z,
        ];
        let error = |i: usize| (got[i] / exact[i] - 1.0_f64).abs();
        let worst = (0..14).map(error).fold(0.0, f64::max);
        println!("nt = {:.1e}: {worst:.1e}", N * time);
        // 4c - 3 and 4(1-c)/n² - 3t²/2 pass through zero: near it only the absolute error counts.
        let loss = if N * time > 0.5 && N * time < 1.0 { 40.0 } else { 4.0 };
        for i in 0..14 {
            assert!(error(i) < loss * f64::EPSILON, "nt = {}, coefficient {i}: {:e}", N * time, error(i));
        }
    }
}
