use super::*;
use crate::number::{Quat, Vec3};
use crate::tests::{Random, assert_near};

/// Both bodies in N axes, about the origin of H.
struct Pair {
    chaser: Body<f64>,
    debris: Body<f64>,
    motion: Motion<f64>,
    lvlh: Lvlh<f64>,
}

fn random_pair(noise: &mut Random) -> Pair {
    let body = |noise: &mut Random, size| Body {
        mass: noise.between(1.0, 20.0),
        inertia: noise.inertia(size),
        grasp_point: Vec3::zero(),
    };
    Pair {
        chaser: body(noise, 0.1),
        debris: body(noise, 0.08),
        motion: Motion {
            position: noise.vector(1.0),
            velocity: noise.vector(0.1),
            chaser_attitude: noise.attitude(),
            chaser_rate: noise.vector(0.2),
            debris_attitude: noise.attitude(),
            debris_rate: noise.vector(0.2),
        },
        lvlh: Lvlh { attitude: noise.attitude(), rate: Vec3([0.0, 0.0, 1.06e-3]) },
    }
}

impl Pair {
    /// Position and velocity of the chaser relative to the debris, which rests in H, in N axes.
    fn relative(&self) -> (Vec3<f64>, Vec3<f64>) {
        in_n(&self.lvlh, &self.motion)
    }

    /// Linear momentum relative to the debris' orbit, angular momentum about the common centre of mass, energy relative
    /// to it: from both bodies one by one, in N.
    fn totals(&self) -> (Vec3<f64>, Vec3<f64>, f64) {
        let Self { chaser, debris, motion, .. } = self;
        let (r, v) = self.relative();
        let mass = chaser.mass + debris.mass;
        let (centre, drift) = (r * (chaser.mass / mass), v * (chaser.mass / mass));
        let spin = |body: &Body<f64>, q: Quat<f64>, w: Vec3<f64>| q.rotate(body.inertia * w);
        let angular = spin(chaser, motion.chaser_attitude, motion.chaser_rate)
            + spin(debris, motion.debris_attitude, motion.debris_rate)
            + (r - centre).cross(v - drift) * chaser.mass
            + centre.cross(drift) * debris.mass;
        let turning = |body: &Body<f64>, w: Vec3<f64>| 0.5 * w.dot(body.inertia * w);
        let energy = turning(chaser, motion.chaser_rate)
            + turning(debris, motion.debris_rate)
            + 0.5 * chaser.mass * (v - drift).norm_squared()
            + 0.5 * debris.mass * drift.norm_squared();
        (v * chaser.mass, angular, energy)
    }
}

fn in_n(lvlh: &Lvlh<f64>, motion: &Motion<f64>) -> (Vec3<f64>, Vec3<f64>) {
    let velocity = motion.velocity + lvlh.rate.cross(motion.position);
    (lvlh.attitude.rotate(motion.position), lvlh.attitude.rotate(velocity))
}

/// Six points of equal mass with the mass, centre and inertia of a body: ± √(3/m) times the columns of the Cholesky factor of
/// the second moments ½ tr I 1 - I.
fn points_of(body: &Body<f64>) -> Vec<Vec3<f64>> {
    let moments = Mat3::from_scale(0.5 * body.inertia.trace()) - body.inertia;
    let mut factor = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..=i {
            let rest = moments.0[i][j] - (0..j).map(|k| factor[i][k] * factor[j][k]).sum::<f64>();
            factor[i][j] = if i == j { rest.sqrt() } else { rest / factor[j][j] };
        }
    }
    let columns = Mat3(factor).transpose();
    let scale = (3.0 / body.mass).sqrt();
    (0..6).map(|k| columns.row(k / 2) * if k % 2 == 0 { scale } else { -scale }).collect()
}

#[test]
fn merge_conserves_linear_and_angular_momentum_and_never_gains_energy() {
    let mut noise = Random::new(9);
    let (mut linear_worst, mut angular_worst, mut least_loss) = (0.0_f64, 0.0_f64, f64::INFINITY);
    for _ in 0..1000 {
        let pair = random_pair(&mut noise);
        let (linear, angular, energy) = pair.totals();
        let stack = merge_conserving(&pair.chaser, &pair.debris, &pair.motion, &pair.lvlh);
        let (vehicle, motion) = (&stack.vehicle, &stack.motion);

        let (centre, drift) = in_n(&pair.lvlh, motion);
        let share = pair.chaser.mass / (pair.chaser.mass + pair.debris.mass);
        assert_near(&centre.0, &(pair.relative().0 * share).0, 1e-15);
        assert_eq!(vehicle.mass, pair.chaser.mass + pair.debris.mass);
        linear_worst = linear_worst.max((drift * vehicle.mass - linear).norm() / linear.norm());

        let spin = vehicle.inertia.tensor * motion.chaser_rate;
        let error = (motion.chaser_attitude.rotate(spin) - angular).norm();
        // Round-off of the parts, which may cancel in the sum; or of I ω, in which the elements of a long stack cancel.
        let trace = vehicle.inertia.tensor.trace();
        let scale = (energy * trace).sqrt().max(trace * motion.chaser_rate.norm());
        angular_worst = angular_worst.max(error / scale);

        least_loss = least_loss.min(1.0 - 0.5 * motion.chaser_rate.dot(spin) / energy);
        assert_eq!(motion.chaser_attitude, pair.motion.chaser_attitude);
        assert_eq!(
            (motion.debris_attitude, motion.debris_rate),
            (pair.motion.debris_attitude, pair.motion.debris_rate)
        );
    }
    println!("momentum {linear_worst:.1e}, angular {angular_worst:.1e}, least share of energy lost {least_loss:.1e}");
    assert!(linear_worst < 1e-15 && angular_worst < 1e-14 && least_loss > 0.0);
}

#[test]
fn bodies_that_already_move_as_one_lose_no_energy() {
    let mut noise = Random::new(10);
    for _ in 0..100 {
        let mut pair = random_pair(&mut noise);
        // One rigid motion ω about the common centre: v_rel = ω × r in N.
        let rate = noise.vector(0.2);
        let position = pair.lvlh.attitude.rotate(pair.motion.position);
        pair.motion.velocity =
            pair.lvlh.attitude.rotate_inverse(rate.cross(position)) - pair.lvlh.rate.cross(pair.motion.position);
        pair.motion.chaser_rate = pair.motion.chaser_attitude.rotate_inverse(rate);
        pair.motion.debris_rate = pair.motion.debris_attitude.rotate_inverse(rate);
        let stack = merge_conserving(&pair.chaser, &pair.debris, &pair.motion, &pair.lvlh);
        assert_near(&stack.motion.chaser_rate.0, &pair.motion.chaser_rate.0, 1e-14);
        let after = 0.5 * stack.motion.chaser_rate.dot(stack.vehicle.inertia.tensor * stack.motion.chaser_rate);
        assert!((after / pair.totals().2 - 1.0).abs() < 1e-13);
    }
}

#[test]
fn inertia_of_the_stack_is_that_of_its_mass_points_and_physical() {
    let mut noise = Random::new(11);
    let mut worst = 0.0_f64;
    for _ in 0..1000 {
        let pair = random_pair(&mut noise);
        let stack = merge_conserving(&pair.chaser, &pair.debris, &pair.motion, &pair.lvlh);
        let tensor = stack.vehicle.inertia.tensor;
        assert_eq!(tensor, tensor.transpose());

        // Every mass point of both bodies in N, about their common centre, then in the stack's axes.
        let (position, _) = pair.relative();
        let mut points = Vec::new();
        for (body, attitude, at) in [
            (&pair.chaser, pair.motion.chaser_attitude, position),
            (&pair.debris, pair.motion.debris_attitude, Vec3::zero()),
        ] {
            points.extend(points_of(body).into_iter().map(|p| (body.mass / 6.0, at + attitude.rotate(p))));
        }
        let mut centre = Vec3::zero();
        for (mass, at) in &points {
            centre += *at * (mass / stack.vehicle.mass);
        }
        let mut sum = Mat3::zero();
        for (mass, at) in &points {
            let arm = stack.motion.chaser_attitude.rotate_inverse(*at - centre);
            sum = sum + (Mat3::from_scale(arm.norm_squared()) - arm.outer(arm)).scale(*mass);
        }
        let difference = sum - tensor;
        worst = difference.0.iter().flatten().fold(worst, |w, x| w.max(x.abs() / tensor.trace()));

        // Triangle inequality of the principal moments: ½ tr I 1 - I is positive definite (Sylvester).
        let moments = Mat3::from_scale(0.5 * tensor.trace()) - tensor;
        let minor = moments.0[0][0] * moments.0[1][1] - moments.0[0][1] * moments.0[1][0];
        assert!(moments.0[0][0] > 0.0 && minor > 0.0 && moments.determinant() > 0.0);
    }
    println!("inertia against its mass points: {worst:.1e}");
    assert!(worst < 2e-15);
}

/// Chaser and debris of the paper, axes on H, debris at rest, `distance` along-track apart, chaser passing at `velocity`; no orbit.
fn papers_pair(distance: f64, velocity: Vec3<f64>) -> Pair {
    let body = |mass, inertia| Body { mass, inertia: Mat3::diagonal(Vec3(inertia)), grasp_point: Vec3::zero() };
    let (attitude, still) = (Quat::identity(), Vec3::zero());
    Pair {
        chaser: body(9.0, [0.1, 0.1, 0.05]),
        debris: body(5.0, [0.05, 0.05, 0.08]),
        motion: Motion {
            position: Vec3([0.0, distance, 0.0]),
            velocity,
            chaser_attitude: attitude,
            chaser_rate: still,
            debris_attitude: attitude,
            debris_rate: still,
        },
        lvlh: Lvlh { attitude, rate: still },
    }
}

#[test]
fn numbers_of_the_papers_capture_are_those_of_the_specification() {
    // SPEC, "What does not hold up", 7. Reduced mass 9·5/14 = 3.214 kg; times 0.3²: 0.289 kg m² beside 0.1 + 0.05.
    let merge = |pair: &Pair| merge_conserving(&pair.chaser, &pair.debris, &pair.motion, &pair.lvlh);
    // Transverse miss of 5 cm/s out of plane: momentum about x.
    let pair = papers_pair(0.3, Vec3([0.0, 0.0, 0.05]));
    let stack = merge(&pair);
    let inertia = stack.vehicle.inertia.tensor;
    assert_near(&[inertia.0[0][0] - 0.15], &[0.289], 5e-4);
    assert_near(&[inertia.0[0][0] / 0.15], &[2.9], 0.05);
    assert_near(&[inertia.0[1][1], inertia.0[2][2]], &[0.15, 0.13 + 0.289_285_714_285_714_3], 1e-15);
    let momentum = inertia * stack.motion.chaser_rate;
    assert_near(&momentum.0, &[0.048, 0.0, 0.0], 5e-4);
    assert_near(&stack.motion.chaser_rate.0, &[0.11, 0.0, 0.0], 5e-3);
    // Exactly: 45/14·0.3·0.05 and that over 0.15 + 45/14·0.09.
    assert_near(&momentum.0, &[0.048_214_285_714_285_71, 0.0, 0.0], 1e-16);
    assert_near(&stack.motion.position.0, &[0.0, 0.3 * 9.0 / 14.0, 0.0], 1e-16);

    // At 0.75 m the parallel-axis term alone, 45/14·0.5625 = 1.808, is twelve times the plain sum.
    let far = merge(&papers_pair(0.75, Vec3::zero())).vehicle.inertia.tensor;
    assert_near(&[(far.0[0][0] - 0.15) / 0.15], &[12.0], 0.1);
}

#[test]
fn approximate_transition_keeps_the_chasers_motion_and_adds_plain_matrices() {
    let mut noise = Random::new(12);
    for _ in 0..20 {
        let pair = random_pair(&mut noise);
        let stack = merge_approximate(&pair.chaser, &pair.debris, &pair.motion);
        assert_eq!(stack.motion, pair.motion);
        assert_eq!(stack.vehicle.mass, pair.chaser.mass + pair.debris.mass);
        // As matrices: not turned, not moved.
        assert_eq!(stack.vehicle.inertia.tensor, pair.chaser.inertia + pair.debris.inertia);
        assert_near(&[stack.vehicle.inverse_mass * stack.vehicle.mass], &[1.0], 1e-15);
    }
}

#[test]
fn offset_is_the_chasers_place_off_the_debris_in_its_own_axes() {
    let mut random = Random::new(31);
    for _ in 0..20 {
        let pair = random_pair(&mut random);
        let stack = merge_conserving(&pair.chaser, &pair.debris, &pair.motion, &pair.lvlh);
        assert_near(&pair.motion.chaser_attitude.rotate(stack.offset).0, &pair.relative().0.0, 1e-15);
        assert_eq!(merge_approximate(&pair.chaser, &pair.debris, &pair.motion).offset, Vec3::zero());
    }
}
