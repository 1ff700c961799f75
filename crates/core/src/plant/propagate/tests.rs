use super::*;
use crate::number::{Mat3, Quat};
use crate::tests::{Random, angle_between, assert_near, brief, fitted_order};

const N: f64 = 1.0618120e-3;

fn surroundings(step: f64, noise: &mut Random) -> Surroundings<f64> {
    let lvlh_attitude = noise.attitude();
    let debris = Inertia::new(noise.inertia(0.05));
    let at_rest = Spin { attitude: Quat::identity(), rate: Vec3::zero() };
    Surroundings {
        orbit: Orbit { mean_motion: N, lvlh_attitude },
        translation: HeldStep::new(N, step),
        half_step: HeldStep::new(N, 0.5 * step),
        debris,
        tumble: FreeTop::new(&debris, &at_rest, step), // not used: this debris is no symmetric top
    }
}

fn motion(noise: &mut Random) -> Motion<f64> {
    Motion {
        position: noise.vector(20.0),
        velocity: noise.vector(0.05),
        chaser_attitude: noise.attitude(),
        chaser_rate: noise.vector(0.1),
        debris_attitude: noise.attitude(),
        debris_rate: noise.vector(0.1),
    }
}

fn fly(
    around: &Surroundings<f64>,
    vehicle: &Vehicle<f64>,
    start: &Motion<f64>,
    wrench: &Wrench<f64>,
    frame: WrenchFrame,
    (period, steps, periods): (f64, u32, u32),
) -> Motion<f64> {
    let mut motion = *start;
    for k in 0..periods {
        let (time, step) = (f64::from(k) * period, period / f64::from(steps));
        let period = Period { time, step, steps, shapes: Shapes::default() };
        propagate(around, vehicle, &mut motion, &Held { wrench: *wrench, frame }, &period);
    }
    motion
}

/// The chaser under a wrench held in one frame, another way than the product's: relative motion in axes that do not turn,
/// attitude as a direction cosine matrix, everything through RK4 at a step fine enough for round-off.
///
/// ρ = R_NH r;  in N:  ρ'' = n² (3 (ρ·e_x) e_x - ρ) + F/m, the gradient of a central field about a circular orbit.
struct Independent<'a> {
    around: &'a Surroundings<f64>,
    vehicle: &'a Vehicle<f64>,
    wrench: &'a Wrench<f64>,
    body_frame: bool,
}

type Rows = [Vec3<f64>; 6];

impl Independent<'_> {
    /// H -> N at t, as a matrix.
    fn lvlh(&self, t: f64) -> Mat3<f64> {
        let (s, c) = (N * t).sin_cos();
        self.around.orbit.lvlh_attitude.to_matrix() * Mat3([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    }

    /// Of ρ, ρ', the three rows of the body's axes matrix (C -> N), ω.
    fn rate(&self, t: f64, [rho, speed, a, b, c, rate]: Rows) -> Rows {
        let lvlh = self.lvlh(t);
        let radial = lvlh * Vec3([1.0, 0.0, 0.0]);
        let axes = Mat3([a.0, b.0, c.0]);
        let (force, torque) = if self.body_frame {
            (axes * self.wrench.force, self.wrench.torque)
        } else {
            (lvlh * self.wrench.force, axes.transpose() * (lvlh * self.wrench.torque))
        };
        let gravity = (radial * (3.0 * radial.dot(rho)) - rho) * (N * N);
        let tensor = self.vehicle.inertia.tensor;
        // Each row of C -> N turns as a' = a × ω (from R' = R [ω×]).
        let acceleration = tensor.inverse() * (torque - rate.cross(tensor * rate));
        [speed, gravity + force * (1.0 / self.vehicle.mass), a.cross(rate), b.cross(rate), c.cross(rate), acceleration]
    }

    fn fly(&self, start: &Motion<f64>, time: f64, steps: u32) -> (Vec3<f64>, Vec3<f64>, Mat3<f64>, Vec3<f64>) {
        let spin = Vec3([0.0, 0.0, N]);
        let axes = start.chaser_attitude.to_matrix();
        let mut y = [
            self.lvlh(0.0) * start.position,
            self.lvlh(0.0) * (start.velocity + spin.cross(start.position)),
            axes.row(0),
            axes.row(1),
            axes.row(2),
            start.chaser_rate,
        ];
        let h = time / f64::from(steps);
        let add = |y: &Rows, k: &Rows, h: f64| -> Rows { std::array::from_fn(|i| y[i] + k[i] * h) };
        for i in 0..steps {
            let t = f64::from(i) * h;
            let k1 = self.rate(t, y);
            let k2 = self.rate(t + h / 2.0, add(&y, &k1, h / 2.0));
            let k3 = self.rate(t + h / 2.0, add(&y, &k2, h / 2.0));
            let k4 = self.rate(t + h, add(&y, &k3, h));
            y = std::array::from_fn(|i| y[i] + (k1[i] + (k2[i] + k3[i]) * 2.0 + k4[i]) * (h / 6.0));
        }
        let to_h = self.lvlh(time).transpose();
        let position = to_h * y[0];
        (position, to_h * y[1] - spin.cross(position), Mat3([y[2].0, y[3].0, y[4].0]), y[5])
    }
}

#[test]
fn open_loop_agrees_with_an_independent_integration_in_n() {
    let mut noise = Random::new(4);
    for body_frame in [true, false] {
        for time in [20.0, 300.0] {
            let around = surroundings(0.05, &mut noise);
            let vehicle = Vehicle::new(9.0, Inertia::new(noise.inertia(0.1)));
            let wrench = Wrench { force: noise.vector(0.05), torque: noise.vector(2e-4) };
            let start = motion(&mut noise);
            let frame = if body_frame { WrenchFrame::Body } else { WrenchFrame::Lvlh };
            let end = fly(&around, &vehicle, &start, &wrench, frame, (0.1, 2, (time * 10.0) as u32));
            let other = Independent { around: &around, vehicle: &vehicle, wrench: &wrench, body_frame };
            let (position, velocity, axes, rate) = other.fly(&start, time, (time * 100.0) as u32);
            let turned = end.chaser_attitude.to_matrix();
            let angle = (0..3).map(|i| (turned.row(i) - axes.row(i)).norm()).fold(0.0, f64::max);
            let errors = [
                (end.position - position).norm(),
                (end.velocity - velocity).norm(),
                angle,
                (end.chaser_rate - rate).norm(),
            ];
            println!("{frame:?}, {time} s: position, velocity, attitude, rate {}", brief(&errors));
            // Fourth order at 0.05 s; over 300 s the errors of the attitude grow, and with them those of a body force.
            let scale = if time > 100.0 { 100.0 } else { 1.0 };
            for (error, bound) in errors.into_iter().zip([1e-9, 1e-10, 1e-8, 1e-9]) {
                assert!(error < bound * scale);
            }
        }
    }
}

#[test]
fn open_loop_shows_its_order() {
    let mut noise = Random::new(5);
    let vehicle = Vehicle::new(9.0, Inertia::new(noise.inertia(0.1)));
    let wrench = Wrench { force: noise.vector(0.05), torque: noise.vector(2e-3) };
    let (around, start) = (surroundings(1.0, &mut noise), motion(&mut noise));
    let body_frame = true;
    let exact = Independent { around: &around, vehicle: &vehicle, wrench: &wrench, body_frame }.fly(&start, 32.0, 6400);
    let steps = [2, 4, 8, 16];
    let errors = steps.map(|s| {
        let step = 1.0 / f64::from(s);
        let (translation, half_step) = (HeldStep::new(N, step), HeldStep::new(N, 0.5 * step));
        let around = Surroundings { translation, half_step, ..around };
        let end = fly(&around, &vehicle, &start, &wrench, WrenchFrame::Body, (1.0, s, 32));
        (end.position - exact.0).norm()
    });
    let order = fitted_order(&steps.map(|s| 1.0 / f64::from(s)), &errors);
    println!("open loop, body axes: order of the position {order:.3}, errors {}", brief(&errors));
    assert!((order - 4.0).abs() < 0.15);
}

#[test]
fn body_force_that_does_not_turn_is_the_held_force() {
    // Axes on H and turning with it about a principal axis: body force, H force and held force are one.
    let mut noise = Random::new(6);
    let around = surroundings(0.05, &mut noise);
    let vehicle = Vehicle::new(9.0, Inertia::new(Mat3::diagonal(Vec3([0.1, 0.1, 0.05]))));
    let start =
        Motion { chaser_attitude: around.orbit.lvlh_attitude, chaser_rate: Vec3([0.0, 0.0, N]), ..motion(&mut noise) };
    let wrench = Wrench { force: Vec3([0.03, -0.05, 0.02]), torque: Vec3::zero() };
    let clocks = (0.1, 2, 3000);
    let [held, lvlh, body] = [WrenchFrame::Command, WrenchFrame::Lvlh, WrenchFrame::Body]
        .map(|frame| fly(&around, &vehicle, &start, &wrench, frame, clocks));
    for other in [lvlh, body] {
        // 270 m away after 300 s: round-off of 6000 steps, at worst ε/2 each.
        assert_near(&other.position.0, &held.position.0, 270.0 * 6000.0 * 1.1e-16);
        assert_near(&other.velocity.0, &held.velocity.0, 2.0 * 6000.0 * 1.1e-16);
        assert!(angle_between(other.chaser_attitude, held.chaser_attitude) < 1e-13);
        assert_eq!((other.debris_attitude, other.debris_rate), (held.debris_attitude, held.debris_rate));
    }
    // And the held one is the one exact step of 300 s.
    let once = HeldStep::new(N, 300.0).advance(start.position, start.velocity, wrench.force * (1.0 / 9.0));
    assert_near(&held.position.0, &once.0.0, 270.0 * 6000.0 * 1.1e-16);
    assert_near(&held.velocity.0, &once.1.0, 2.0 * 6000.0 * 1.1e-16);
}

#[test]
fn more_steps_in_a_period_refine_rotation_and_leave_translation() {
    let mut noise = Random::new(7);
    let vehicle = Vehicle::new(9.0, Inertia::new(noise.inertia(0.1)));
    let wrench = Wrench { force: noise.vector(0.05), torque: noise.vector(2e-3) };
    let start =
        Motion { chaser_rate: Vec3([0.3, -0.5, 0.4]), debris_rate: Vec3([0.4, 0.3, -0.5]), ..motion(&mut noise) };
    let at = |steps: u32, noise: &mut Random| {
        let around = surroundings(0.2 / f64::from(steps), noise);
        fly(&around, &vehicle, &start, &wrench, WrenchFrame::Command, (0.2, steps, 100))
    };
    // The same surroundings for each: the random numbers drawn anew.
    let [fine, ends @ ..] = [128, 1, 2, 4, 8].map(|steps| at(steps, &mut Random::new(8)));
    let steps = [0.2, 0.1, 0.05, 0.025];
    for end in ends {
        // Round-off of 12 800 steps in `fine`: 1 + 3 (1 - cos nt) is rounded the same way in each, 25 m · 12 800 · ε/2.
        assert_near(&end.position.0, &fine.position.0, 4e-11);
        assert_near(&end.velocity.0, &fine.velocity.0, 4e-13);
    }
    for (who, errors) in [
        ("chaser", ends.map(|end| angle_between(end.chaser_attitude, fine.chaser_attitude))),
        ("debris", ends.map(|end| angle_between(end.debris_attitude, fine.debris_attitude))),
    ] {
        let order = fitted_order(&steps, &errors);
        println!("{who}: order {order:.3}, errors {}", brief(&errors));
        assert!((order - 4.0).abs() < 0.15);
    }
}
