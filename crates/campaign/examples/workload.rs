//! Speed of the reference workload, one core, every back end: `cargo run --release --example workload`.

use detumble_campaign::{Fleet, fly_workload};
use detumble_core::case::*;
use detumble_core::closed_loop::{Laws, Numbers};
use detumble_core::gnc::laws::{Form, Gains, LawRecipe, PhaseGains, prrl};
use detumble_core::hardware::sensors::Noisy;
use detumble_core::number::{Backend, Mat3, Quat, Stream, Vec3};
use std::time::Instant;

const FLIGHTS: usize = 512;
const PERIODS: u32 = 2400;

fn main() {
    let plan = plan();
    let case = case();
    let laws = Laws::new(&law(), &case, &plan);
    let shared = Numbers::new(&case, &plan);
    let numbers = |i: usize| Numbers { case: Case { start: start(i), ..case }, ..shared };
    for backend in Backend::available() {
        let fleet = Fleet {
            plan: &plan,
            noisy: Noisy::new(&case.sensors),
            laws: &laws,
            seed: 1,
            first_index: 0,
            flights: if backend == Backend::Portable { FLIGHTS / 4 } else { FLIGHTS },
            backend,
            threads: 1,
        };
        let mut rates: Vec<f64> = (0..9)
            .map(|_| {
                let begin = Instant::now();
                let outcomes = fly_workload(&fleet, &numbers);
                assert!(outcomes.iter().all(|o| o.impulse.is_finite()));
                fleet.flights as f64 * f64::from(PERIODS) / begin.elapsed().as_secs_f64()
            })
            .collect();
        rates.sort_by(f64::total_cmp);
        println!("{:9} {:6.2} M steps/s (median of {})", backend.name(), rates[rates.len() / 2] / 1e6, rates.len());
    }
}

fn plan() -> Plan {
    Plan {
        control_period: 0.05,
        steps_per_period: 1,
        periods: PERIODS,
        dwell_ticks: 0,
        grasp: false,
        feedforward: false,
        goal_after_given: false,
        distance_from_debris: false,
        momentum_conserving: false,
        merge: false,
        true_stack: false,
        scaled_saturation: false,
        two_epsilon: false,
        exact_surface_rate: false,
    }
}

fn case() -> Case<f64> {
    let body = |mass, inertia| Body { mass, inertia: Mat3::diagonal(Vec3(inertia)), grasp_point: Vec3([0.0; 3]) };
    let (chaser, debris) = (body(9.0, [0.1, 0.1, 0.05]), body(5.0, [0.05, 0.05, 0.08]));
    let goal = Vec3([0.0, 0.3, 0.0]);
    Case {
        orbit: Orbit {
            mean_motion: (3.986004418e14_f64 / 7071e3_f64.powi(3)).sqrt(),
            lvlh_attitude: Quat([1.0, 0.0, 0.0, 0.0]),
        },
        chaser,
        debris,
        start: start(0),
        goal: GoalPositions { position: goal, after_capture: goal },
        capture: CaptureThresholds { distance: 0.5, angle: 20f64.to_radians(), rate: 0.05, speed: f64::INFINITY },
        settled: SettledThresholds { angle: 0.1, rate: 0.005 },
        actuators: Limits { force: Vec3([0.1; 3]), torque: Vec3([0.01; 3]) },
        sensors: NoiseSigmas { position: 1e-3, velocity: 0.0, attitude: 0.1f64.to_radians(), rate: 1e-4 },
        belief: Belief {
            chaser_mass: chaser.mass,
            chaser_inertia: chaser.inertia,
            stack_mass: chaser.mass + debris.mass,
            stack_inertia: chaser.inertia + debris.inertia,
        },
    }
}

fn law() -> LawRecipe {
    let channel = |slope, gain, layer| prrl::Gains {
        slope: Vec3([slope; 3]),
        gain: Vec3([gain; 3]),
        layer: Vec3([layer; 3]),
        alpha: 0.7,
    };
    let gains = PhaseGains { translation: channel(0.15, 0.05, 0.05), rotation: channel(0.30, 0.20, 0.10) };
    LawRecipe::Prrl(Gains { form: Form::Printed, before: gains, after: gains })
}

/// r within ±2 m, random attitudes, the debris tumbling at up to 0.1 rad/s.
fn start(i: usize) -> Motion<f64> {
    let dice = Stream::<f64>::new(0, |_| i as u64);
    let [x, y, z, size] = dice.uniforms(0, 0);
    let (c, d, t) = (dice.normals(0, 1), dice.normals(0, 2), dice.normals(0, 3));
    let tumble = Vec3([t[0], t[1], t[2]]);
    Motion {
        position: Vec3([4.0 * x - 2.0, 4.0 * y - 2.0, 4.0 * z - 2.0]),
        velocity: Vec3([0.0; 3]),
        chaser_attitude: Quat(c).normalized(),
        chaser_rate: Vec3([0.0; 3]),
        debris_attitude: Quat(d).normalized(),
        debris_rate: tumble * (0.1 * size / tumble.norm()),
    }
}
