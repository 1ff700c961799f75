use super::*;
use crate::number::Vec3;
use crate::tests::Random;

const NUMBERS: std::ops::Range<usize> = 0..STATES;

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| NUMBERS.map(|k| a[i][k] * b[k][j]).sum()))
}

/// A, and B R⁻¹ Bᵀ r.
fn matrices(system: &System) -> (Matrix, Matrix) {
    let (mut a, mut effort) = ([[0.0; STATES]; STATES], [[0.0; STATES]; STATES]);
    let square = system.input * system.input.transpose();
    for i in 0..3 {
        a[i][i + 3] = system.coupling;
        for j in 0..3 {
            a[i + 3][j] = system.stiffness.0[i][j];
            a[i + 3][j + 3] = system.damping.0[i][j];
            effort[i + 3][j + 3] = square.0[i][j];
        }
    }
    (a, effort)
}

/// A - B K.
fn closed_loop(system: &System, k: &[Mat3<f64>; 2]) -> Matrix {
    let (mut a, _) = matrices(system);
    for (column, block) in k.iter().enumerate() {
        let fed_back = system.input * *block;
        for i in 0..3 {
            for j in 0..3 {
                a[i + 3][3 * column + j] -= fed_back.0[i][j];
            }
        }
    }
    a
}

/// P in full from its lower rows, which K gives: [P21 P22] = r B⁻ᵀ K; and P11 from the upper right block of the equation,
/// c P11 = P21ᵀ(…): here from the (1,2) block  Sᵀ P22 + c P11 + P12 D - P12 (B Bᵀ/r) P22 = 0.
fn solution(system: &System, weights: &Weights, k: &[Mat3<f64>; 2]) -> Matrix {
    let back = system.input.inverse().transpose().scale(weights.r);
    let (p21, p22) = (back * k[0], back * k[1]);
    let p12 = p21.transpose();
    let effort = (system.input * system.input.transpose()).scale(1.0 / weights.r);
    let rest = p12 * effort * p22 - system.stiffness.transpose() * p22 - p12 * system.damping;
    let p11 = rest.scale(1.0 / system.coupling);
    std::array::from_fn(|i| {
        std::array::from_fn(|j| match (i < 3, j < 3) {
            (true, true) => p11.0[i][j],
            (true, false) => p12.0[i][j - 3],
            (false, true) => p21.0[i - 3][j],
            (false, false) => p22.0[i - 3][j - 3],
        })
    })
}

/// Largest entry of AᵀP + P A - P B R⁻¹ Bᵀ P + Q and of P - Pᵀ, relative to what is summed in its block.
fn residual(system: &System, weights: &Weights, k: &[Mat3<f64>; 2]) -> f64 {
    let (a, effort) = matrices(system);
    let p = solution(system, weights, k);
    let (pa, pep) = (product(&p, &a), product(&product(&p, &effort), &p));
    let absolute = |m: &Matrix| m.map(|row| row.map(f64::abs));
    let sizes = product(&absolute(&p), &absolute(&a));
    let pep_sizes = product(&product(&absolute(&p), &absolute(&effort)), &absolute(&p));
    let mut worst = 0.0_f64;
    for i in NUMBERS {
        for j in NUMBERS {
            let q = if i != j {
                0.0
            } else if i < 3 {
                weights.q_error[i]
            } else {
                weights.q_rate[i - 3]
            };
            let sum = pa[i][j] + pa[j][i] - pep[i][j] / weights.r + q;
            // The scale of the block: elimination keeps no more of an axis weighted far below its neighbour.
            let size = |i: usize, j: usize| sizes[i][j] + sizes[j][i] + pep_sizes[i][j] / weights.r;
            let scale = (0..9).map(|k| size(i / 3 * 3 + k / 3, j / 3 * 3 + k % 3)).fold(0.0, f64::max);
            worst = worst.max(sum.abs() / scale);
            let largest = (0..9).map(|k| p[i / 3 * 3 + k / 3][j / 3 * 3 + k % 3].abs()).fold(0.0, f64::max);
            worst = worst.max((p[i][j] - p[j][i]).abs() / largest);
        }
    }
    worst
}

/// Whether x' = A x dies out: powers of the Cayley transform (1 - hA)⁻¹ (1 + hA), of spectral radius below 1 if and only if A is stable.
fn is_stable(a: &Matrix) -> bool {
    let h = 1.0 / a.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs())).max(1e-6);
    let signed = |sign: f64| -> Matrix {
        std::array::from_fn(|i| std::array::from_fn(|j| f64::from(i == j) + sign * h * a[i][j]))
    };
    let mut power = product(&inverse(&signed(-1.0)), &signed(1.0));
    for _ in 0..60 {
        power = product(&power, &power);
    }
    power.iter().flatten().all(|x| x.abs() < 1e-6)
}

fn inverse(m: &Matrix) -> Matrix {
    let mut left = *m;
    let mut right: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(i == j)));
    for c in NUMBERS {
        let pivot = (c..STATES).max_by(|&i, &j| left[i][c].abs().total_cmp(&left[j][c].abs())).unwrap();
        left.swap(c, pivot);
        right.swap(c, pivot);
        let d = left[c][c];
        for j in NUMBERS {
            left[c][j] /= d;
            right[c][j] /= d;
        }
        for i in NUMBERS.filter(|&i| i != c) {
            let factor = left[i][c];
            for j in NUMBERS {
                left[i][j] -= factor * left[c][j];
                right[i][j] -= factor * right[c][j];
            }
        }
    }
    right
}

fn hill(n: f64) -> System {
    System {
        coupling: 1.0,
        stiffness: Mat3([[3.0 * n * n, 0.0, 0.0], [0.0; 3], [0.0, 0.0, -n * n]]),
        damping: Mat3([[0.0, 2.0 * n, 0.0], [-2.0 * n, 0.0, 0.0], [0.0; 3]]),
        input: Mat3::identity(),
    }
}

fn attitude(inertia: Mat3<f64>, coupling: f64) -> System {
    System { coupling, stiffness: Mat3::zero(), damping: Mat3::zero(), input: inertia.inverse() }
}

#[test]
fn gain_of_an_isotropic_body_is_the_closed_form() {
    // e' = c v, I v' = u: K_e = √(q_e/r), K_v = √(q_v/r + 2 c I K_e).
    for inertia in [1e-3, 0.1, 5.0] {
        for coupling in [0.5, 1.0] {
            for (q_error, q_rate, r) in [(1.0, 1.0, 1.0), (4.0, 0.25, 100.0), (1e-12, 1e-9, 1.0), (1e6, 1.0, 1.0)] {
                let weights = Weights { q_error: Vec3([q_error; 3]), q_rate: Vec3([q_rate; 3]), r };
                let k = gain(&attitude(Mat3::from_scale(inertia), coupling), &weights);
                let for_error = f64::sqrt(q_error / r);
                let for_rate = (q_rate / r + 2.0 * coupling * inertia * for_error).sqrt();
                for (block, known) in k.iter().zip([for_error, for_rate]) {
                    for i in 0..3 {
                        for j in 0..3 {
                            let want = if i == j { known } else { 0.0 };
                            assert!((block.0[i][j] - want).abs() < 1e-12 * known, "{inertia} {q_error} {q_rate} {r}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn equation_is_solved_and_the_loop_stable_for_awkward_weights() {
    let mut noise = Random::new(32);
    let mut worst = 0.0_f64;
    for trial in 0..600 {
        // q/r from 1e-12 to 1e6 on every axis by itself: the same, near one another, or as far apart as it goes.
        let spread = [0.0, 3.0, 9.0][trial % 3];
        let r = 10f64.powf(noise.between(-3.0, 3.0));
        let mut around = || {
            let centre = noise.between(-12.0 + spread, 6.0 - spread + 1e-9);
            Vec3([0; 3].map(|_| r * 10f64.powf(centre + noise.between(-spread, spread + 1e-9))))
        };
        let weights = Weights { q_error: around(), q_rate: around(), r };
        let system = match trial % 4 {
            0 => hill(1.0618120e-3),
            1 => attitude(noise.inertia(0.1), 0.5),
            2 => attitude(noise.inertia(0.1), 1.0),
            _ => attitude(noise.inertia(10.0), 0.5),
        };
        let k = gain(&system, &weights);
        assert!(is_stable(&closed_loop(&system, &k)), "trial {trial}: {weights:?}");
        let error = residual(&system, &weights, &k);
        assert!(error < 1e-12, "trial {trial}: {weights:?}: {error:e}");
        worst = worst.max(error);
    }
    println!("largest residual {worst:.1e}");
}

#[test]
fn lyapunov_equation_is_solved() {
    let mut noise = Random::new(33);
    for _ in 0..20 {
        let weights = Weights { q_error: Vec3([1.0; 3]), q_rate: Vec3([1.0; 3]), r: 1.0 };
        let system = attitude(noise.inertia(0.5), 0.5);
        let a = closed_loop(&system, &stabilising_gain(&system, &weights));
        let mut cost = [[0.0; STATES]; STATES];
        for (i, j) in NUMBERS.flat_map(|i| (0..=i).map(move |j| (i, j))) {
            let entry = noise.between(-1.0, 1.0);
            (cost[i][j], cost[j][i]) = (entry, entry);
        }
        let p = lyapunov(&a, &cost);
        let pa = product(&p, &a);
        for i in NUMBERS {
            for j in NUMBERS {
                assert!((pa[i][j] + pa[j][i] + cost[i][j]).abs() < 1e-10);
            }
        }
    }
}

#[test]
fn first_gain_is_stabilising_for_every_system() {
    let mut noise = Random::new(34);
    for trial in 0..200 {
        let mut weight = || Vec3([0; 3].map(|_| 10f64.powf(noise.between(-12.0, 6.0))));
        let weights = Weights { q_error: weight(), q_rate: weight(), r: 1.0 };
        let system = if trial % 2 == 0 { hill(1.06e-3) } else { attitude(noise.inertia(0.1), 0.5) };
        assert!(is_stable(&closed_loop(&system, &stabilising_gain(&system, &weights))), "{weights:?}");
    }
}
