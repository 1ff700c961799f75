use super::*;
use crate::tests::assert_near;

const SIGMAS: NoiseSigmas<f64> = NoiseSigmas { position: 1e-3, velocity: 2e-4, attitude: 2e-3, rate: 1e-4 };

fn truth() -> Motion<f64> {
    Motion {
        position: Vec3([1.0, -2.0, 3.0]),
        velocity: Vec3([0.01, 0.02, -0.03]),
        chaser_attitude: Quat([0.1, 0.7, -0.5, 0.5]),
        chaser_rate: Vec3([0.1, -0.2, 0.3]),
        debris_attitude: Quat([0.7, 0.1, 0.1, 0.7]),
        debris_rate: Vec3([0.05, -0.03, 0.04]),
    }
}

fn see(sigmas: &NoiseSigmas<f64>, tick: u32) -> Motion<f64> {
    with_noise(sigmas, Noisy::new(sigmas), &truth(), &Stream::new(7, |_| 3), f64::from(tick))
}

/// The twelve errors of a tick over their σ: position, attitude (small angle, C axes), rate, velocity.
fn draws(tick: u32) -> [f64; 12] {
    let (seen, truth) = (see(&SIGMAS, tick), truth());
    let position = (seen.position - truth.position) * (1.0 / SIGMAS.position);
    let turn = truth.chaser_attitude.conjugate() * seen.chaser_attitude;
    // The noise is [1, δ/2] normalised, so δ = 2 tan(angle/2) along the axis.
    let attitude = turn.vector() * (2.0 / turn.scalar() / SIGMAS.attitude);
    let rate = (seen.chaser_rate - truth.chaser_rate) * (1.0 / SIGMAS.rate);
    let velocity = (seen.velocity - truth.velocity) * (1.0 / SIGMAS.velocity);
    let all = [position, attitude, rate, velocity];
    std::array::from_fn(|k| all[k / 3][k % 3])
}

#[test]
fn noise_is_white_standard_and_independent_between_quantities_and_ticks() {
    let count = 100_000;
    let table: Vec<[f64; 12]> = (0..count).map(draws).collect();
    let mean = |f: &dyn Fn(usize) -> f64| (0..table.len()).map(f).sum::<f64>() / f64::from(count);
    // Five standard errors; 12 + 12 + 66 + 144 statistics.
    let bound = 5.0 / f64::from(count).sqrt();
    for i in 0..12 {
        assert!(mean(&|t| table[t][i]).abs() < bound, "mean {i}");
        assert!((mean(&|t| table[t][i].powi(2)) - 1.0).abs() < bound * 2f64.sqrt(), "σ {i}");
        assert!((mean(&|t| table[t][i].powi(4)) - 3.0).abs() < bound * 96f64.sqrt(), "kurtosis {i}");
        for j in 0..12 {
            assert!(i == j || mean(&|t| table[t][i] * table[t][j]).abs() < bound, "{i} with {j}");
            assert!(mean(&|t| table[t][i] * table[(t + 1) % table.len()][j]).abs() < bound, "{i} with the next {j}");
        }
    }
}

#[test]
fn attitude_noise_has_the_angle_of_three_normals_and_keeps_the_norm() {
    let count = 50_000;
    let (mut sum, mut squares) = (0.0, 0.0);
    for tick in 0..count {
        let q = see(&SIGMAS, tick).chaser_attitude;
        assert!((q.norm_squared() - 1.0).abs() < 1e-15);
        let turn = truth().chaser_attitude.conjugate() * q;
        let angle = 2.0 * turn.vector().norm().atan2(turn.scalar());
        sum += angle;
        squares += angle * angle;
    }
    // Maxwell: mean σ √(8/π), mean square 3 σ²; variances (3 - 8/π) σ², 6 σ⁴. Five standard errors.
    let (n, s) = (f64::from(count), SIGMAS.attitude);
    let mean = (8.0 / std::f64::consts::PI).sqrt();
    assert!((sum / n / s - mean).abs() < 5.0 * ((3.0 - mean * mean) / n).sqrt());
    assert!((squares / n / s / s - 3.0).abs() < 5.0 * (6.0 / n).sqrt());
}

#[test]
fn switching_sensors_off_leaves_the_draws_of_the_others() {
    for tick in [0, 1, 77] {
        let all = see(&SIGMAS, tick);
        for choice in 0..16 {
            let [p, v, q, w] = [1, 2, 4, 8].map(|bit| choice & bit != 0);
            let on = |on: bool, sigma: f64| if on { sigma } else { 0.0 };
            let sigmas = NoiseSigmas {
                position: on(p, SIGMAS.position),
                velocity: on(v, SIGMAS.velocity),
                attitude: on(q, SIGMAS.attitude),
                rate: on(w, SIGMAS.rate),
            };
            let (seen, truth) = (see(&sigmas, tick), truth());
            assert_eq!(seen.position, if p { all.position } else { truth.position });
            assert_eq!(seen.velocity, if v { all.velocity } else { truth.velocity });
            assert_eq!(seen.chaser_attitude, if q { all.chaser_attitude } else { truth.chaser_attitude });
            assert_eq!(seen.chaser_rate, if w { all.chaser_rate } else { truth.chaser_rate });
            assert_eq!((seen.debris_attitude, seen.debris_rate), (truth.debris_attitude, truth.debris_rate));
            // A lane without noise beside noisy ones: the draws are taken, and weigh nothing.
            let beside = with_noise(&sigmas, Noisy::new(&SIGMAS), &truth, &Stream::new(7, |_| 3), f64::from(tick));
            assert_eq!(
                (beside.position, beside.velocity, beside.chaser_rate),
                (seen.position, seen.velocity, seen.chaser_rate)
            );
            assert_near(&beside.chaser_attitude.0, &seen.chaser_attitude.0, 2e-16);
        }
    }
}

#[test]
fn noise_is_named_by_seed_trajectory_and_tick() {
    let at = |seed, trajectory, tick| {
        with_noise(&SIGMAS, Noisy::new(&SIGMAS), &truth(), &Stream::new(seed, |_| trajectory), f64::from(tick))
    };
    assert_eq!(at(1, 2, 3), at(1, 2, 3));
    for other in [at(2, 2, 3), at(1, 3, 3), at(1, 2, 4)] {
        assert_ne!(other, at(1, 2, 3));
    }
}

#[test]
fn sensors_are_noisy_whose_sigma_is_not_zero() {
    let [quiet, loud] = [0.0, 1.0].map(|position| NoiseSigmas { position, velocity: 0.0, attitude: 0.0, rate: 0.0 });
    assert_eq!(Noisy::new(&quiet), Noisy::default());
    assert_eq!(Noisy::new(&NoiseSigmas { rate: 1e-9, ..quiet }), Noisy { rate: true, ..Noisy::default() });
    assert_eq!(Noisy::new(&loud), Noisy { position: true, ..Noisy::default() });
}
