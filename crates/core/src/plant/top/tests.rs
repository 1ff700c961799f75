use super::*;
use crate::plant::attitude::spin_step;
use crate::tests::{Random, angle_between};

const TOPS: [[f64; 3]; 3] = [[0.05, 0.05, 0.08], [0.1, 0.1, 0.05], [0.03, 0.03, 0.03]];

fn start(noise: &mut Random) -> Spin<f64> {
    Spin { attitude: noise.attitude(), rate: noise.vector(0.2) }
}

#[test]
fn the_closed_form_is_what_runge_kutta_converges_to() {
    let mut noise = Random::new(5);
    for diagonal in TOPS {
        let body = Inertia::new(Mat3::diagonal(Vec3(diagonal)));
        let first = start(&mut noise);
        let top = FreeTop::new(&body, &first, 0.5);
        let (mut exact, mut fine) = (first, first);
        for _ in 0..240 {
            exact = top.step(&exact);
            for _ in 0..100 {
                fine = spin_step(&body, &fine, Vec3::zero(), 0.005);
            }
        }
        assert!(angle_between(exact.attitude, fine.attitude) < 1e-10, "{diagonal:?}");
        assert!((exact.rate - fine.rate).norm() < 1e-12, "{diagonal:?}");
    }
}

#[test]
fn momentum_and_energy_stay_over_a_million_steps() {
    let mut noise = Random::new(6);
    let body = Inertia::new(Mat3::diagonal(Vec3(TOPS[0])));
    let first = start(&mut noise);
    let top = FreeTop::new(&body, &first, 0.05);
    let momentum = |spin: &Spin<f64>| spin.attitude.rotate(body.tensor * spin.rate);
    let energy = |spin: &Spin<f64>| spin.rate.dot(body.tensor * spin.rate);
    let mut spin = first;
    for _ in 0..1_000_000 {
        spin = top.step(&spin);
    }
    let (before, after) = (momentum(&first), momentum(&spin));
    assert!((after - before).norm() < 1e-9 * before.norm());
    assert!((energy(&spin) / energy(&first) - 1.0).abs() < 1e-9);
    assert!((spin.attitude.norm_squared() - 1.0).abs() < 1e-14);
}

#[test]
fn only_equal_transverse_moments_make_a_symmetric_top() {
    let diagonal = |moments| Mat3::diagonal(Vec3(moments));
    assert!(is_symmetric_top(&diagonal([0.05, 0.05, 0.08])));
    assert!(!is_symmetric_top(&diagonal([0.05, 0.0500001, 0.08])));
    let mut tilted = diagonal([0.05, 0.05, 0.08]);
    (tilted.0[0][1], tilted.0[1][0]) = (1e-6, 1e-6);
    assert!(!is_symmetric_top(&tilted));
}
