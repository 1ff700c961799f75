use super::*;
use crate::tests::{Random, assert_near};

fn terminal(slope: f64, exponent: f64) -> Surface<f64> {
    Surface::Terminal(Terminal { slope: Vec3([slope; 3]), exponent })
}

fn errors(error: Vec3<f64>, rate: Vec3<f64>) -> ChannelError<f64> {
    ChannelError { error, rate, error_rate: rate }
}

#[test]
fn values_have_their_known_numbers() {
    let e = errors(Vec3([0.04, -0.09, 0.0]), Vec3([0.1, 0.2, -0.3]));
    let linear = Surface::Linear(Linear { slope: Vec3([0.5, 1.0, 2.0]) });
    assert_near(&linear.value(&e).0, &[0.12, 0.11, -0.3], 1e-16);
    // |e|^½ = (0.2, 0.3, 0), |e|^(3/2) = (0.008, 0.027, 0).
    assert_near(&terminal(2.0, 0.5).value(&e).0, &[0.5, -0.4, -0.3], 1e-15);
    assert_near(&terminal(2.0, 1.5).value(&e).0, &[0.116, 0.146, -0.3], 1e-15);
}

#[test]
fn time_on_the_surface_is_the_exact_one() {
    // SPEC, 2: on s = 0, α = 1, the error goes from 1 to 1e-4 in 695 s at p/q = 5/3, in 2.44 s at 3/5.
    for (exponent, seconds, tolerance) in [(5.0 / 3.0, 695.0, 0.5), (0.6, 2.44, 5e-3)] {
        let surface = terminal(1.0, exponent);
        // s = rate + …, so where s = 0 the rate is minus the surface of a resting error.
        let slide = |e: f64| -surface.value(&errors(Vec3([e; 3]), Vec3::zero()))[0];
        let (mut e, mut time) = (1.0_f64, 0.0);
        while e > 1e-4 {
            let h = (1e-3 * e / -slide(e)).min((e - 1e-4) / -slide(e) * 1.001);
            let middle = e + 0.5 * h * slide(e);
            e += h * slide(middle);
            time += h;
        }
        println!("terminal surface {exponent:.3}: {time:.3} s");
        assert_near(&[time], &[seconds], tolerance);
    }
}

#[test]
fn own_rate_is_the_derivative_of_the_surface_at_constant_rate() {
    let mut noise = Random::new(30);
    for surface in
        [Surface::Linear(Linear { slope: Vec3([0.1, 0.2, 0.3]) }), terminal(0.7, 0.6), terminal(0.7, 5.0 / 3.0)]
    {
        for _ in 0..50 {
            let (error, error_rate, rate) = (noise.vector(0.5), noise.vector(0.1), noise.vector(0.1));
            // Away from the corner at e = 0, where the terminal surface has no derivative for p < 1.
            let error = Vec3(error.0.map(|e| e + 0.02 * e.signum()));
            let h = 1e-4;
            let at = |t: f64| surface.value(&ChannelError { error: error + error_rate * t, rate, error_rate });
            let difference = (at(h) - at(-h)) * (0.5 / h);
            let exact = surface.own_rate(&ChannelError { error, rate, error_rate });
            assert_near(&exact.0, &difference.0, 1e-5);
        }
    }
}

#[test]
fn own_rate_is_zero_where_it_is_not_finite() {
    let at_rest = errors(Vec3([0.0, -0.0, 0.25]), Vec3([0.1, -0.1, 0.1]));
    // Third axis: Λ p e^(p-1) e' = 2·0.5·2·0.1.
    assert_near(&terminal(2.0, 0.5).own_rate(&at_rest).0, &[0.0, 0.0, 0.2], 1e-15);
    // p > 1 has the derivative zero there anyway: 2·1.5·0.5·0.1.
    assert_near(&terminal(2.0, 1.5).own_rate(&at_rest).0, &[0.0, 0.0, 0.15], 1e-15);
    // So small that the power is not: subnormal errors count as zero.
    let tiny = errors(Vec3([1e-310; 3]), Vec3([0.1; 3]));
    assert!(terminal(2.0, 0.5).own_rate(&tiny).0.iter().all(|x| x.is_finite()));
}
