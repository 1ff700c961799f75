use super::*;
use crate::tests::{Random, assert_near};

fn target(attitude: Quat<f64>, rate: Vec3<f64>) -> Target<f64> {
    Target {
        position: Vec3([0.0, 0.3, 0.0]),
        velocity: Vec3([0.01, 0.0, -0.01]),
        acceleration: Vec3::zero(),
        attitude,
        rate,
    }
}

fn motion(attitude: Quat<f64>, rate: Vec3<f64>) -> Motion<f64> {
    Motion {
        position: Vec3([1.0, 2.0, 3.0]),
        velocity: Vec3([0.1, 0.2, 0.3]),
        chaser_attitude: attitude,
        chaser_rate: rate,
        debris_attitude: Quat::identity(),
        debris_rate: Vec3::zero(),
    }
}

#[test]
fn errors_have_their_known_values() {
    // Chaser a quarter turn about z ahead of the reference: ε = (0, 0, sin 45°). The reference turns at 0.1 about its x,
    // which is the chaser's -y.
    let quarter = Quat::about_z(std::f64::consts::FRAC_PI_2);
    let error = TrackingError::between(
        &motion(quarter, Vec3([0.02, 0.03, 0.04])),
        &target(Quat::identity(), Vec3([0.1, 0.0, 0.0])),
    );
    assert_near(&error.position.0, &[1.0, 1.7, 3.0], 1e-15);
    assert_near(&error.velocity.0, &[0.09, 0.2, 0.31], 1e-15);
    let half = std::f64::consts::FRAC_1_SQRT_2;
    assert_near(&error.attitude.0, &[half, 0.0, 0.0, half], 1e-15);
    assert_near(&error.rate.0, &[0.02, 0.13, 0.04], 1e-15);
}

#[test]
fn attitude_error_goes_the_short_way_whatever_the_signs() {
    let mut noise = Random::new(20);
    for _ in 0..200 {
        let (q, reference, rate) = (noise.attitude(), noise.attitude(), noise.vector(0.1));
        let error = |p: Quat<f64>, r: Quat<f64>| TrackingError::between(&motion(p, rate), &target(r, rate));
        let first = error(q, reference);
        assert!(first.attitude.scalar() >= 0.0);
        for other in [error(q.scale(-1.0), reference), error(q, reference.scale(-1.0))] {
            assert_eq!((other.attitude, other.rate), (first.attitude, first.rate));
        }
        // It takes chaser components to reference components.
        let v = noise.vector(1.0);
        assert_near(&reference.rotate(first.attitude.rotate(v)).0, &q.rotate(v).0, 1e-14);
    }
}

#[test]
fn bodies_that_turn_alike_have_no_rate_error() {
    let mut noise = Random::new(21);
    for _ in 0..50 {
        let (q, reference, in_n) = (noise.attitude(), noise.attitude(), noise.vector(0.1));
        let motion = motion(q, q.rotate_inverse(in_n));
        let error = TrackingError::between(&motion, &target(reference, reference.rotate_inverse(in_n)));
        assert!(error.rate.norm() < 4e-16);
    }
}
