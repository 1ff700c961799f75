//! Fleets of random starts near the paper's case, with every law and both ways of flying it.

use crate::{Column, Fleet, FlightRecord, Operation, Outcome, fly_many, fly_one};
use detumble_core::batch::Fields;
use detumble_core::case::*;
use detumble_core::gnc::capture::DistanceFrom;
use detumble_core::gnc::capture::{CaptureThresholds, SettledThresholds};
use detumble_core::gnc::guidance::GoalPositions;
use detumble_core::gnc::guidance::{Goal, StackGoal};
use detumble_core::gnc::laws::belief::Belief;
use detumble_core::gnc::laws::{
    AttitudeError, Form, Gains, LawRecipe, PhaseGains, StackBelief, SurfaceRate, lqr, pd, prrl, sosmc, stsmc, tsmc,
};
use detumble_core::hardware::actuators::Limits;
use detumble_core::hardware::actuators::Saturation;
use detumble_core::hardware::sensors::NoiseSigmas;
use detumble_core::number::{Backend, Mat3, Quat, Stream, Vec3};
use detumble_core::plan::{End, Plan};
use detumble_core::plant::body::Body;
use detumble_core::plant::disturbances::{Acting, Disturbances};
use detumble_core::plant::motion::Motion;
use detumble_core::plant::orbit::Orbit;
use detumble_core::plant::stack::Transition;
use detumble_core::scene::Common;
use std::sync::atomic::{AtomicBool, AtomicUsize};

pub const LAWS: [&str; 6] = ["pd", "lqr", "sosmc", "tsmc", "prrl", "stsmc"];

/// How a fleet flies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Printed forms, approximate transition, clipped limits, a fixed goal.
    Paper,
    /// Corrected forms, momentum conserved, scaled limits, and every other switch the other way round too.
    Corrected,
}

/// A fleet's recipe: law, way, length, noise.
#[derive(Clone)]
pub struct Campaign {
    pub law: LawRecipe,
    pub plan: Plan,
    pub noise: bool,
}

impl Campaign {
    pub fn new(law: &str, way: Way, seconds: u32, noise: bool) -> Self {
        Self { law: law_recipe(law, way), plan: plan(way, 10 * seconds), noise }
    }

    /// Everything about flight `i`.
    pub fn recipe(&self, i: usize) -> FlightRecipe {
        let mut case = case(i);
        if !self.noise {
            case.sensors = NoiseSigmas { position: 0.0, velocity: 0.0, attitude: 0.0, rate: 0.0 };
        }
        FlightRecipe { case, law: self.law.clone(), plan: self.plan }
    }

    pub fn fly(&self, flights: usize, backend: Backend, threads: usize) -> Vec<Outcome> {
        self.fly_changed(flights, backend, threads, |_, _| ())
    }

    /// With the case of each flight changed as `change` says.
    pub fn fly_changed(
        &self,
        flights: usize,
        backend: Backend,
        threads: usize,
        change: impl Fn(usize, &mut Case<f64>) + Sync,
    ) -> Vec<Outcome> {
        let case = |i: usize| {
            let mut case = self.recipe(i).case;
            change(i, &mut case);
            case
        };
        let cases: Vec<_> = (0..flights).map(case).collect();
        let recipe = FlightRecipe { case: case(0), law: self.law.clone(), plan: self.plan };
        let differing: Vec<_> = PATHS.iter().map(|path| (path, column(&cases, path))).collect();
        let columns = differing.iter().filter_map(|(path, values)| {
            let values = values.as_deref()?;
            Some(Column { path: path.to_string(), values })
        });
        let fleet = Fleet::new(recipe, columns.collect(), flights).unwrap();
        fly_many(&fleet, &operation(backend, threads)).flights
    }
}

/// Flight `i` by itself, as one of a fleet whose inertias differ.
pub fn alone(recipe: &FlightRecipe, i: usize, backend: Backend) -> FlightRecord {
    let common = Common::new(recipe, ["chaser.inertia", "debris.inertia"]).unwrap();
    fly_one(recipe, common, SEED, FIRST + i as u64, backend, &UNSTOPPED)
}

static UNSTOPPED: AtomicBool = AtomicBool::new(false);

pub fn operation(backend: Backend, threads: usize) -> Operation<'static> {
    static COMPLETED: AtomicUsize = AtomicUsize::new(0);
    Operation {
        seed: SEED,
        first_index: FIRST,
        cycle: u64::MAX,
        backend,
        threads,
        completed: &COMPLETED,
        stop: &UNSTOPPED,
    }
}

/// Everything in which two cases can differ.
const PATHS: [&str; 33] = [
    "orbit.mean_motion",
    "orbit.lvlh_attitude",
    "chaser.mass",
    "chaser.inertia",
    "chaser.grasp_point",
    "debris.mass",
    "debris.inertia",
    "debris.grasp_point",
    "start.position",
    "start.velocity",
    "start.chaser_attitude",
    "start.chaser_rate",
    "start.debris_attitude",
    "start.debris_rate",
    "goal.position",
    "goal.after_capture",
    "capture.distance",
    "capture.angle",
    "capture.rate",
    "capture.speed",
    "settled.angle",
    "settled.rate",
    "actuators.force",
    "actuators.torque",
    "actuators.force_gain",
    "actuators.torque_gain",
    "sensors.position",
    "sensors.velocity",
    "sensors.attitude",
    "sensors.rate",
    "belief.chaser_mass",
    "belief.chaser_inertia",
    "belief.stack_mass",
];

/// The numbers of all cases at a path, unless they are the same.
fn column(cases: &[Case<f64>], path: &str) -> Option<Vec<f64>> {
    let rows: Vec<Vec<f64>> = cases.iter().map(|case| { *case }.field(path).unwrap().to_vec()).collect();
    let differ = rows.iter().any(|row| row != &rows[0]);
    differ.then(|| rows.concat())
}

pub const SEED: u64 = 2026;
/// Index of the first flight: streams are named by it, not by the place in the fleet.
pub const FIRST: u64 = 100;

/// Equal texts are equal bits: Rust prints the shortest number that reads back as the same one.
pub fn bits(value: &impl std::fmt::Debug) -> String {
    format!("{value:?}")
}

fn plan(way: Way, periods: u32) -> Plan {
    let corrected = way == Way::Corrected;
    Plan {
        control_period: 0.1,
        steps_per_period: 2,
        periods,
        dwell_ticks: if corrected { 3 } else { 0 },
        goal: if corrected { Goal::GraspFeedforward } else { Goal::Fixed },
        stack_goal: if corrected { StackGoal::Given } else { StackGoal::Reached },
        distance_from: DistanceFrom::Goal,
        transition: if corrected { Transition::MomentumConserving } else { Transition::Approximate },
        stack_belief: if corrected { StackBelief::True } else { StackBelief::Design },
        saturation: if corrected { Saturation::Scaled } else { Saturation::PerAxis },
        attitude_error: if corrected { AttitudeError::TwoEpsilon } else { AttitudeError::Epsilon },
        surface_rate: if corrected { SurfaceRate::Exact } else { SurfaceRate::Printed },
        disturbances: Acting::default(),
        end: End::Duration,
        hold_ticks: 0,
    }
}

/// The paper's bodies, orbit, limits and thresholds; start, tumble, attitudes, and every third inertia at random.
fn case(i: usize) -> Case<f64> {
    let noise = Stream::<f64>::new(1, |_| i as u64);
    let vector = |block, size: f64| {
        let [x, y, z, _] = noise.uniforms(0, block);
        Vec3([2.0 * x - 1.0, 2.0 * y - 1.0, 2.0 * z - 1.0]) * size
    };
    let identity = Quat([1.0, 0.0, 0.0, 0.0]);
    let [share, ..] = noise.uniforms(0, 9);
    let tilted = |inertia: Mat3<f64>, block| {
        if !i.is_multiple_of(3) {
            return inertia;
        }
        let axes = Quat::from_rotation_vector(vector(block, 0.6)).to_matrix();
        let turned = axes * inertia * axes.transpose();
        (turned + turned.transpose()).scale(0.5)
    };
    let body = |mass, inertia, grasp_point, block| Body {
        mass,
        inertia: tilted(Mat3::diagonal(Vec3(inertia)), block),
        grasp_point: Vec3(grasp_point),
    };
    let chaser = body(8.5 + share, [0.1, 0.1, 0.05], [0.0, -0.15, 0.0], 7);
    let debris = body(5.0, [0.05, 0.05, 0.08], [0.0, 0.12, 0.03], 8);
    let goal = Vec3([0.0, 0.3, 0.0]);
    let debris_attitude = Quat(noise.normals(0, 6)).normalized();
    Case {
        orbit: Orbit { mean_motion: (3.986004418e14_f64 / 7071e3_f64.powi(3)).sqrt(), lvlh_attitude: identity },
        chaser,
        debris,
        start: Motion {
            position: goal + vector(1, 1.5),
            velocity: vector(2, 0.005),
            chaser_attitude: debris_attitude * Quat::from_rotation_vector(vector(3, 0.8)),
            chaser_rate: vector(4, 0.01),
            debris_attitude,
            debris_rate: vector(5, 0.025),
        },
        goal: GoalPositions { position: goal, after_capture: Vec3([0.05, 0.2, -0.05]) },
        capture: CaptureThresholds { distance: 0.5, angle: 20f64.to_radians(), rate: 0.05, speed: f64::INFINITY },
        settled: SettledThresholds { angle: 2f64.to_radians(), rate: 0.005 },
        actuators: Limits::exact(Vec3([0.1; 3]), Vec3([0.01; 3])),
        disturbances: Disturbances::none(),
        sensors: NoiseSigmas { position: 1e-3, velocity: 1e-4, attitude: 2e-3, rate: 1e-4 },
        belief: Belief {
            chaser_mass: 9.0,
            chaser_inertia: Mat3::diagonal(Vec3([0.1, 0.1, 0.05])),
            stack_mass: 14.0,
            stack_inertia: Mat3::diagonal(Vec3([0.15, 0.15, 0.13])),
        },
    }
}

/// Gains of the project's own scenario of the paper's case.
fn law_recipe(law: &str, way: Way) -> LawRecipe {
    let v = |x| Vec3([x; 3]);
    let form = if way == Way::Paper { Form::Printed } else { Form::Corrected };
    match law {
        "pd" => {
            let gains = |kp, kd| pd::Gains { kp: v(kp), kd: v(kd) };
            LawRecipe::Pd(of(form, gains(0.00452, 1.0), gains(0.04, 0.08)))
        }
        "lqr" => {
            let weights = |q_error, q_rate, r| lqr::Weights { q_error: v(q_error), q_rate: v(q_rate), r };
            LawRecipe::Lqr(of(form, weights(4.35e-5, 0.1, 1.0), weights(0.02, 0.01, 20.0)))
        }
        "sosmc" => {
            let gains = |slope, gain, proportional, layer| sosmc::Gains {
                slope: v(slope),
                gain: v(gain),
                proportional: v(proportional),
                layer: v(layer),
            };
            LawRecipe::Sosmc(of(form, gains(0.018, 0.002, 0.1, 0.02), gains(0.3, 0.03, 0.3, 0.03)))
        }
        "tsmc" => {
            let gains = |slope, gain, layer, exponent| tsmc::Gains {
                slope: v(slope),
                gain: v(gain),
                layer: v(layer),
                exponent,
            };
            let (p, q) = if form == Form::Printed { (5.0 / 3.0, 5.0 / 3.0) } else { (0.6, 7.0 / 9.0) };
            LawRecipe::Tsmc(of(form, gains(0.0166, 0.008, 0.02, p), gains(0.6, 0.06, 0.03, q)))
        }
        "stsmc" => {
            let gains = |slope, k1, k2| stsmc::Gains { slope: v(slope), k1: v(k1), k2: v(k2) };
            let one = of(form, gains(0.0181, 6.68e-3, 5.91e-6), gains(0.6, 0.05, 1e-3));
            LawRecipe::Stsmc(Gains { form: None, ..one })
        }
        _ => {
            let gains =
                |slope, gain, layer| prrl::Gains { slope: v(slope), gain: v(gain), layer: v(layer), alpha: 0.7 };
            LawRecipe::Prrl(of(form, gains(0.14, 0.08, 0.02), gains(0.6, 0.5, 0.02)))
        }
    }
}

/// The same gains in both phases.
fn of<G: Copy>(form: Form, translation: G, rotation: G) -> Gains<G> {
    let gains = PhaseGains { translation, rotation };
    Gains { form: Some(form), before: gains, after: gains }
}
