use super::*;
use crate::number::Mat3;
use crate::plant::attitude::{Spin, spin_step};
use crate::plant::orbit::Orbit;
use crate::tests::{Random, assert_near};

struct Scene {
    orbit: Orbit<f64>,
    grasp: GraspPoints<f64>,
    start: Motion<f64>,
}

fn scene(noise: &mut Random) -> Scene {
    Scene {
        // An orbit fast enough for its terms to be seen in the differences.
        orbit: Orbit { mean_motion: 0.02, lvlh_attitude: noise.attitude() },
        grasp: GraspPoints {
            chaser: noise.vector(0.2),
            debris: noise.vector(0.2),
            debris_inertia: Inertia::new(noise.inertia(0.05)),
        },
        start: Motion {
            position: noise.vector(1.0),
            velocity: noise.vector(0.1),
            chaser_attitude: noise.attitude(),
            chaser_rate: noise.vector(0.2),
            debris_attitude: noise.attitude(),
            debris_rate: noise.vector(0.2),
        },
    }
}

impl Scene {
    fn now(&self) -> Target<f64> {
        grasp_points(&self.grasp, &self.start, &Lvlh::at(&self.orbit, 0.0), true)
    }

    /// The goal at time t: the debris tumbles freely, the chaser turns at a constant rate.
    fn target(&self, t: f64) -> Target<f64> {
        let free = Spin { attitude: self.start.debris_attitude, rate: self.start.debris_rate };
        let debris = spin_step(&self.grasp.debris_inertia, &free, Vec3::zero(), t);
        let turn = Quat::from_rotation_vector(self.start.chaser_rate * t);
        let motion = Motion {
            chaser_attitude: self.start.chaser_attitude * turn,
            debris_attitude: debris.attitude,
            debris_rate: debris.rate,
            ..self.start
        };
        grasp_points(&self.grasp, &motion, &Lvlh::at(&self.orbit, t), true)
    }
}

#[test]
fn grasp_velocity_and_acceleration_are_the_derivatives_of_the_goal() {
    let mut noise = Random::new(22);
    for _ in 0..50 {
        let scene = scene(&mut noise);
        // Central differences of fourth order in h: h⁴ ω⁵ p and round-off 1e-16/h.
        let h = 0.01;
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| scene.target(k * h));
        let slope =
            |f: &dyn Fn(&Target<f64>) -> Vec3<f64>| (f(&a) - f(&d) + (f(&c) - f(&b)) * 8.0) * (1.0 / (12.0 * h));
        let now = scene.now();
        assert_near(&now.velocity.0, &slope(&|t| t.position).0, 1e-11);
        assert_near(&now.acceleration.0, &slope(&|t| t.velocity).0, 1e-11);
    }
}

#[test]
fn grasp_points_meet_at_the_goal() {
    let mut noise = Random::new(23);
    for _ in 0..50 {
        let scene = scene(&mut noise);
        let target = scene.now();
        // With the chaser at the goal both points are at one place in N.
        let in_n = |q: Quat<f64>, p: Vec3<f64>| q.rotate(p);
        let chaser =
            scene.orbit.lvlh_attitude.rotate(target.position) + in_n(scene.start.chaser_attitude, scene.grasp.chaser);
        assert_near(&chaser.0, &in_n(scene.start.debris_attitude, scene.grasp.debris).0, 1e-15);
        assert_eq!((target.attitude, target.rate), (scene.start.debris_attitude, scene.start.debris_rate));
    }
}

#[test]
fn grasp_point_of_a_spinning_body_has_its_known_motion() {
    // Debris on H's axes spins at 0.1 about z, a principal axis; H at 0.02: seen in H, 0.08 about z. Point 0.5 m along x:
    // velocity 0.04 along y, acceleration 0.08²·0.5 = 0.0032 toward the axis.
    let scene = Scene {
        orbit: Orbit { mean_motion: 0.02, lvlh_attitude: Quat::identity() },
        grasp: GraspPoints {
            chaser: Vec3::zero(),
            debris: Vec3([0.5, 0.0, 0.0]),
            debris_inertia: Inertia::new(Mat3::diagonal(Vec3([0.05, 0.05, 0.08]))),
        },
        start: Motion {
            position: Vec3::zero(),
            velocity: Vec3::zero(),
            chaser_attitude: Quat::identity(),
            chaser_rate: Vec3::zero(),
            debris_attitude: Quat::identity(),
            debris_rate: Vec3([0.0, 0.0, 0.1]),
        },
    };
    let target = scene.now();
    assert_near(&target.position.0, &[0.5, 0.0, 0.0], 1e-16);
    assert_near(&target.velocity.0, &[0.0, 0.04, 0.0], 1e-16);
    assert_near(&target.acceleration.0, &[-0.0032, 0.0, 0.0], 1e-16);
    let silent = grasp_points(&scene.grasp, &scene.start, &Lvlh::at(&scene.orbit, 0.0), false);
    assert_eq!(silent.acceleration, Vec3::zero());
    assert_eq!((silent.position, silent.velocity), (target.position, target.velocity));
}

#[test]
fn fixed_goal_rests_in_h_and_the_stack_turns_with_h() {
    let mut noise = Random::new(24);
    let scene = scene(&mut noise);
    let goal = Vec3([0.0, 0.3, 0.0]);
    let before = fixed_point(goal, &scene.start);
    assert_eq!((before.position, before.velocity), (goal, Vec3::zero()));
    assert_eq!((before.attitude, before.rate), (scene.start.debris_attitude, scene.start.debris_rate));
    let lvlh = Lvlh::at(&scene.orbit, 100.0);
    let after = stabilise(goal, &lvlh);
    assert_eq!((after.position, after.velocity, after.acceleration), (goal, Vec3::zero(), Vec3::zero()));
    assert_eq!((after.attitude, after.rate), (lvlh.attitude, Vec3([0.0, 0.0, 0.02])));
    assert_eq!(Target::choose(true, &after, &before).attitude, after.attitude);
    assert_eq!(Target::choose(false, &after, &before).attitude, before.attitude);
}
