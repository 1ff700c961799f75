use super::*;
use crate::number::Mat3;
use crate::plant::disturbances::constant::{Constant, LoadAxes};
use crate::plant::orbit::{HeldStep, Orbit};
use crate::plant::propagate::{Shapes, propagate};
use crate::plant::top::FreeTop;
use crate::tests::{Random, angle_between, assert_near, brief, fitted_order};
use core::f64::consts::PI;

const N: f64 = 1.0618120e-3;
const MASSES: [f64; 2] = [9.0, 4.0];

struct Setting {
    orbit: Orbit<f64>,
    vehicle: Vehicle<f64>,
    debris: Inertia<f64>,
    joint: Joint<f64>,
    disturbances: Disturbances<f64>,
    acting: Acting,
    held: Held<f64>,
}

impl Setting {
    fn new(random: &mut Random) -> Self {
        Self {
            orbit: Orbit { mean_motion: N, lvlh_attitude: random.attitude() },
            vehicle: Vehicle::new(MASSES[0], Inertia::new(random.inertia(0.1))),
            debris: Inertia::new(random.inertia(0.05)),
            joint: Joint::open(),
            disturbances: Disturbances::none(),
            acting: Acting { constant: LoadAxes::Lvlh, gravity_gradient: false },
            held: Held { wrench: Wrench::zero(), frame: WrenchFrame::Command },
        }
    }

    fn around(&self, step: f64) -> Surroundings<f64> {
        Surroundings {
            orbit: self.orbit,
            translation: HeldStep::new(N, step),
            half_step: HeldStep::new(N, 0.5 * step),
            debris: self.debris,
            tumble: FreeTop::new(&self.debris, &Spin { attitude: Quat::identity(), rate: Vec3::zero() }, step),
        }
    }

    fn disturbed<'a>(&'a self, around: &'a Surroundings<f64>) -> Disturbed<'a, f64> {
        Disturbed {
            around,
            masses: MASSES,
            disturbances: &self.disturbances,
            acting: self.acting,
            vehicle: &self.vehicle,
            joint: &self.joint,
            held: self.held,
        }
    }

    fn fly(&self, start: &Motion<f64>, step: f64, steps: u32) -> Motion<f64> {
        let mut motion = *start;
        self.disturbed(&self.around(step)).propagate(&mut motion, &period(step, steps));
        motion
    }
}

fn period(step: f64, steps: u32) -> Period<f64> {
    Period { time: 0.0, step, steps, shapes: Shapes::default() }
}

fn motion(random: &mut Random) -> Motion<f64> {
    Motion {
        position: random.vector(20.0),
        velocity: random.vector(0.05),
        chaser_attitude: random.attitude(),
        chaser_rate: random.vector(0.1),
        debris_attitude: random.attitude(),
        debris_rate: random.vector(0.1),
    }
}

#[test]
fn loads_of_size_zero_leave_the_plant_as_it_is() {
    for frame in [WrenchFrame::Command, WrenchFrame::Body, WrenchFrame::Lvlh] {
        let mut random = Random::new(21);
        let mut setting = Setting::new(&mut random);
        setting.held = Held { wrench: Wrench { force: random.vector(0.05), torque: random.vector(2e-3) }, frame };
        let start = motion(&mut random);
        let disturbed = setting.fly(&start, 0.05, 600);
        let (mut free, around) = (start, setting.around(0.05));
        propagate(&around, &setting.vehicle, &mut free, &setting.held, &period(0.05, 600));
        let truncation = if frame == WrenchFrame::Lvlh { 1e-7 } else { 2e-12 }; // there the plant integrates another way
        assert_near(&disturbed.position.0, &free.position.0, 2e-11);
        assert!(angle_between(disturbed.chaser_attitude, free.chaser_attitude) < truncation);
        assert_near(&disturbed.debris_rate.0, &free.debris_rate.0, 1e-13);
        assert!(angle_between(disturbed.debris_attitude, free.debris_attitude) < 2e-12);
    }
}

#[test]
fn differential_drag_over_an_orbit_is_the_published_drift() {
    // x = 4π a/n², y = -6π² a/n² after one orbit from rest.
    let mut random = Random::new(22);
    let mut setting = Setting::new(&mut random);
    let rest = Motion { position: Vec3::zero(), velocity: Vec3::zero(), ..motion(&mut random) };
    let a = 1e-7;
    let drift = [4.0 * PI * a / (N * N), -6.0 * PI * PI * a / (N * N), 0.0];
    let steps = 5000;
    let on = |force: f64, mass: f64| Vec3([0.0, force * mass, 0.0]);
    setting.disturbances.constant.chaser_force = on(a, MASSES[0]);
    assert_near(&setting.fly(&rest, 2.0 * PI / N / f64::from(steps), steps).position.0, &drift, 1e-10);
    // The same on the debris drives it the other way; on both, nothing moves.
    setting.disturbances.constant.debris_force = on(a, MASSES[1]);
    assert_near(&setting.fly(&rest, 2.0 * PI / N / f64::from(steps), steps).position.0, &[0.0; 3], 1e-12);
    setting.disturbances.constant.chaser_force = Vec3::zero();
    let opposite = drift.map(|x| -x);
    assert_near(&setting.fly(&rest, 2.0 * PI / N / f64::from(steps), steps).position.0, &opposite, 1e-10);
}

#[test]
fn constant_body_torque_about_a_principal_axis_spins_evenly() {
    let mut random = Random::new(23);
    let mut setting = Setting::new(&mut random);
    setting.debris = Inertia::new(Mat3::diagonal(Vec3([0.02, 0.03, 0.04])));
    setting.acting.constant = LoadAxes::Body;
    setting.disturbances.constant.debris_torque = Vec3([0.0, 0.0, 1e-5]);
    let start = Motion { debris_rate: Vec3([0.0, 0.0, 0.05]), ..motion(&mut random) };
    let end = setting.fly(&start, 0.1, 1000);
    let (t, alpha) = (100.0, 1e-5 / 0.04);
    assert_near(&end.debris_rate.0, &[0.0, 0.0, 0.05 + alpha * t], 1e-14);
    let turned = start.debris_attitude * Quat::about_z(0.05 * t + 0.5 * alpha * t * t);
    assert!(angle_between(end.debris_attitude, turned) < 1e-12);
}

#[test]
fn a_joined_body_brings_its_load_and_the_lever_of_it() {
    let mut random = Random::new(24);
    let mut setting = Setting::new(&mut random);
    setting.acting.constant = LoadAxes::Body;
    let (mount, offset) = (random.attitude(), Vec3([0.4, -0.2, 0.3]));
    setting.joint = Joint { joined: 1.0, mount, offset };
    let [chaser, debris] = [random.vector(1e-3), random.vector(1e-3)];
    let [chaser_torque, debris_torque] = [random.vector(1e-4), random.vector(1e-4)];
    setting.disturbances.constant =
        Constant { chaser_force: chaser, chaser_torque, debris_force: debris, debris_torque };
    let around = setting.around(0.1);
    let found = setting.disturbed(&around).on(Which::Chaser, &random.attitude(), random.attitude());
    let pushed = mount.rotate(debris);
    // From the common centre of mass: the chaser lies at m_d/(m_c + m_d) of the offset, the debris on the other side.
    let [at_chaser, at_debris] = [offset * (4.0 / 13.0), offset * (-9.0 / 13.0)];
    let torque = chaser_torque + mount.rotate(debris_torque) + at_chaser.cross(chaser) + at_debris.cross(pushed);
    assert_near(&found.force.0, &(chaser + pushed).0, 1e-18);
    assert_near(&found.torque.0, &torque.0, 1e-18);
}

#[test]
fn disturbed_motion_converges_with_fourth_order() {
    for axes in [LoadAxes::Body, LoadAxes::Lvlh] {
        let mut random = Random::new(25);
        let mut setting = Setting::new(&mut random);
        setting.acting = Acting { constant: axes, gravity_gradient: true };
        setting.disturbances.constant = Constant {
            chaser_force: random.vector(0.05),
            chaser_torque: random.vector(5e-3),
            debris_force: random.vector(0.05),
            debris_torque: random.vector(1e-3),
        };
        setting.held.wrench = Wrench { force: random.vector(0.05), torque: random.vector(5e-3) };
        let start =
            Motion { chaser_rate: Vec3([0.3, -0.5, 0.4]), debris_rate: Vec3([0.4, 0.3, -0.5]), ..motion(&mut random) };
        let steps = [0.4, 0.2, 0.1, 0.05];
        let count = |step: f64| (20.0 / step).round() as u32;
        let fine = setting.fly(&start, 0.4 / 64.0, 64 * count(0.4));
        let ends = steps.map(|step| setting.fly(&start, step, count(step)));
        for (what, errors) in [
            ("chaser", ends.map(|end| angle_between(end.chaser_attitude, fine.chaser_attitude))),
            ("debris", ends.map(|end| angle_between(end.debris_attitude, fine.debris_attitude))),
            ("position", ends.map(|end| (end.position - fine.position).norm())),
        ] {
            if axes == LoadAxes::Lvlh && what == "position" {
                assert!(errors.iter().all(|error| *error < 2e-11), "held in H, forces act exactly: {errors:?}");
                continue;
            }
            let order = fitted_order(&steps, &errors);
            println!("{axes:?} {what}: order {order:.3}, errors {}", brief(&errors));
            assert!((order - 4.0).abs() < 0.2, "{axes:?} {what}: {order}");
        }
    }
}

#[test]
fn gravity_turns_the_stack_as_one_body() {
    let mut random = Random::new(26);
    let mut setting = Setting::new(&mut random);
    setting.acting = Acting { constant: LoadAxes::None, gravity_gradient: true };
    setting.joint = Joint { joined: 1.0, mount: random.attitude(), offset: random.vector(0.5) };
    let (to_lvlh, attitude) = (random.attitude(), random.attitude());
    let found = setting.disturbed(&setting.around(0.1)).on(Which::Chaser, &to_lvlh, attitude);
    // Up is the x axis of H; H -> N -> C.
    let up = attitude.rotate_inverse(to_lvlh.rotate_inverse(Vec3([1.0, 0.0, 0.0])));
    let known = up.cross(setting.vehicle.inertia.tensor * up) * (3.0 * N * N);
    assert_near(&found.torque.0, &known.0, 1e-21);
    assert_eq!(found.force, Vec3::zero());
}
