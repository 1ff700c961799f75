//! Known answers of the laws. The numbers are worked out by hand, step by step in the comments, from the law table of
//! SPEC, with errors chosen so that each step is short.

use super::*;
use crate::number::Mat3;
use crate::number::Quat;
use crate::plant::motion::Motion;
use crate::tests::{Random, assert_near};

const BEFORE: MassProperties<f64> =
    MassProperties { mass: 9.0, inertia: Mat3([[0.10, 0.01, 0.0], [0.01, 0.12, 0.0], [0.0, 0.0, 0.05]]) };
/// Twice the chaser's inertia, so torques double; 14 kg.
const AFTER: MassProperties<f64> =
    MassProperties { mass: 14.0, inertia: Mat3([[0.20, 0.02, 0.0], [0.02, 0.24, 0.0], [0.0, 0.0, 0.10]]) };
const SETTING: Setting =
    Setting { mean_motion: 0.01, attitude_error: AttitudeError::Epsilon, surface_rate: SurfaceRate::Printed };
/// -A with n = 0.01 at r = (10, 20, -30), v = (0.5, -0.25, 7), see the orbit's own test.
const MINUS_NATURAL: [f64; 3] = [0.002, 0.01, -0.003];
/// ω × (I ω): I ω = (0.008, -0.023, 0.015) with ω = (0.1, -0.2, 0.3).
const GYROSCOPIC: [f64; 3] = [0.0039, 0.0009, -0.0007];

fn motion() -> Motion<f64> {
    Motion {
        position: Vec3([10.0, 20.0, -30.0]),
        velocity: Vec3([0.5, -0.25, 7.0]),
        chaser_attitude: Quat::identity(),
        chaser_rate: Vec3([0.1, -0.2, 0.3]),
        debris_attitude: Quat::identity(),
        debris_rate: Vec3::zero(),
    }
}

/// e_r, e_v, e_ω as below and this ε.
fn error_with(epsilon: [f64; 3]) -> TrackingError<f64> {
    let vector = Vec3(epsilon);
    TrackingError {
        position: Vec3([0.4, -0.2, 0.1]),
        velocity: Vec3([0.02, -0.01, 0.03]),
        attitude: Quat::from_parts((1.0 - vector.norm_squared()).sqrt(), vector),
        rate: Vec3([0.02, -0.04, 0.1]),
    }
}

/// ε = (0.5, -0.5, 0.1), q0 = 0.7.
fn error() -> TrackingError<f64> {
    error_with([0.5, -0.5, 0.1])
}

fn command(recipe: &LawRecipe, phase: Phase, setting: &Setting, error: &TrackingError<f64>) -> [[f64; 3]; 2] {
    let believed = if phase == Phase::BeforeCapture { BEFORE } else { AFTER };
    let law = recipe.build(phase, &believed, setting).unwrap();
    let input = LawInput {
        seen: Seen { estimate: &Estimate { motion: motion() }, error: *error },
        mean_motion: setting.mean_motion,
        feedforward: None,
        attitude_error: setting.attitude_error,
        period: 0.1,
    };
    let wrench = law.step(&mut law.begin(), input);
    [wrench.force.0, wrench.torque.0]
}

fn both<G: Copy>(form: Form, translation: G, rotation: G) -> Gains<G> {
    let gains = PhaseGains { translation, rotation };
    Gains { form: Some(form), before: gains, after: gains }
}

fn sum(a: [f64; 3], b: [f64; 3], factor: f64) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + factor * b[i])
}

fn times(a: [f64; 3], factor: f64) -> [f64; 3] {
    a.map(|x| x * factor)
}

#[track_caller]
fn check(recipe: &LawRecipe, phase: Phase, setting: &Setting, force: [f64; 3], torque: [f64; 3]) {
    let [got_force, got_torque] = command(recipe, phase, setting, &error());
    assert_near(&got_force, &force, 1e-14);
    assert_near(&got_torque, &torque, 1e-14);
}

#[test]
fn pd_has_its_known_answers() {
    // Force: -(0.1·0.4 + 1·0.02, -0.2·0.2 - 2·0.01, 0.3·0.1 + 3·0.03), whatever the mass.
    let force = [-0.06, 0.06, -0.12];
    let law = |form| {
        let translation = pd::Gains { kp: Vec3([0.1, 0.2, 0.3]), kd: Vec3([1.0, 2.0, 3.0]) };
        let rotation = pd::Gains { kp: Vec3([0.02, 0.04, 0.1]), kd: Vec3([0.1, 0.05, 0.2]) };
        LawRecipe::Pd(both(form, translation, rotation))
    };
    for phase in [Phase::BeforeCapture, Phase::AfterCapture] {
        // Printed: Kp ε = (0.01, -0.02, 0.01), Kd ω = (0.01, -0.01, 0.06), in both phases.
        check(&law(Form::Printed), phase, &SETTING, force, [-0.02, 0.03, -0.07]);
        // Corrected: Kd e_ω = (0.002, -0.002, 0.02).
        check(&law(Form::Corrected), phase, &SETTING, force, [-0.012, 0.022, -0.03]);
        // 2 ε doubles Kp ε.
        let twice = Setting { attitude_error: AttitudeError::TwoEpsilon, ..SETTING };
        check(&law(Form::Printed), phase, &twice, force, [-0.03, 0.05, -0.08]);
    }
}

#[test]
fn lqr_has_its_known_answers_where_the_axes_are_apart() {
    // Without an orbit: K = (√(q_e/r), √(q_r/r + 2 √(q_e/r))) = (0.1, √(0.05 + 0.2) = 0.5). Attitude of a ball I = 0.1:
    // K = (√(4/100) = 0.2, √(0.25/100 + I·0.2) = 0.15); of 0.4: √(0.0025 + 0.08); with 2 ε, 0.1: √(0.0025 + 0.04).
    let [translation, rotation] = [(0.01, 0.05, 1.0), (4.0, 0.25, 100.0)].map(|(q_error, q_rate, r)| lqr::Weights {
        q_error: Vec3([q_error; 3]),
        q_rate: Vec3([q_rate; 3]),
        r,
    });
    let balls =
        [9.0, 14.0].map(|mass| MassProperties { mass, inertia: Mat3::from_scale(if mass == 9.0 { 0.1 } else { 0.4 }) });
    let demand = |form, phase, attitude_error| {
        let setting = Setting { mean_motion: 0.0, attitude_error, ..SETTING };
        let ball = &balls[usize::from(phase == Phase::AfterCapture)];
        let law = LawRecipe::Lqr(both(form, translation, rotation)).build(phase, ball, &setting).unwrap();
        let estimate = Estimate { motion: motion() };
        let (error, feedforward) = (error(), None);
        let input = LawInput {
            seen: Seen { estimate: &estimate, error },
            mean_motion: 0.0,
            feedforward,
            attitude_error,
            period: 0.1,
        };
        law.step(&mut law.begin(), input)
    };
    // K x = (0.04 + 0.01, -0.02 - 0.005, 0.01 + 0.015), times the mass.
    let force = [-0.05, 0.025, -0.025];
    // 0.2 ε = (0.1, -0.1, 0.02); 0.15 ω = (0.015, -0.03, 0.045); 0.15 e_ω = (0.003, -0.006, 0.015).
    let before = demand(Form::Printed, Phase::BeforeCapture, AttitudeError::Epsilon);
    assert_near(&before.force.0, &times(force, 9.0), 1e-12);
    assert_near(&before.torque.0, &[-0.115, 0.13, -0.065], 1e-13);
    let corrected = demand(Form::Corrected, Phase::BeforeCapture, AttitudeError::Epsilon);
    assert_near(&corrected.torque.0, &[-0.103, 0.106, -0.035], 1e-13);
    // After capture e_ω in both forms; √0.0825 = 0.287 228 132, times e_ω = (0.005 744 563, -0.011 489 125, 0.028 722 813).
    for form in [Form::Printed, Form::Corrected] {
        let after = demand(form, Phase::AfterCapture, AttitudeError::Epsilon);
        assert_near(&after.force.0, &times(force, 14.0), 1e-12);
        assert_near(&after.torque.0, &[-0.105744563, 0.111489125, -0.048722813], 1e-9);
    }
    // 2 ε: 0.2·2 ε = (0.2, -0.2, 0.04); √0.0425 = 0.206 155 281 times ω = (0.020 615 528, -0.041 231 056, 0.061 846 584).
    let twice = demand(Form::Printed, Phase::BeforeCapture, AttitudeError::TwoEpsilon);
    assert_near(&twice.torque.0, &[-0.220615528, 0.241231056, -0.101846584], 1e-9);
}

fn sosmc_law(form: Form) -> LawRecipe {
    let translation = sosmc::Gains {
        slope: Vec3([0.1, 0.1, 0.5]),
        gain: Vec3([0.01, 0.02, 0.05]),
        proportional: Vec3([0.5, 1.0, 0.25]),
        layer: Vec3([0.05, 0.06, 0.1]),
    };
    let rotation = sosmc::Gains {
        slope: Vec3([0.2, 0.1, 1.0]),
        gain: Vec3([0.1, 0.2, 0.05]),
        proportional: Vec3([0.5, 1.0, 0.1]),
        layer: Vec3([0.1, 0.18, 0.25]),
    };
    LawRecipe::Sosmc(both(form, translation, rotation))
}

#[test]
fn sosmc_has_its_known_answers() {
    // s = (0.06, -0.03, 0.08), sat = (1, -0.5, 0.8): a = -(0.01 + 0.03, -0.01 - 0.03, 0.04 + 0.02). No -A.
    let acceleration = [-0.04, 0.04, -0.06];
    // s = (0.12, -0.09, 0.2), sat = (1, -0.5, 0.8): a = (-0.16, 0.19, -0.06), I a = (-0.016 + 0.0019, -0.0016 + 0.0228, -0.003).
    let torque = [-0.0141, 0.0212, -0.003];
    for (form, sign) in [(Form::Printed, -1.0), (Form::Corrected, 1.0)] {
        let law = sosmc_law(form);
        // The switch of the surface's rate has no say: SOSMC takes none off.
        for setting in [SETTING, Setting { surface_rate: SurfaceRate::Exact, ..SETTING }] {
            let known = sum(torque, GYROSCOPIC, sign);
            check(&law, Phase::BeforeCapture, &setting, times(acceleration, 9.0), known);
            check(&law, Phase::AfterCapture, &setting, times(acceleration, 14.0), times(known, 2.0));
        }
    }
    // 2 ε: s = (0.22, -0.14, 0.3), sat = (1, -0.777…, 1): a = -(0.1 + 0.11, -0.155 555 556 - 0.14, 0.05 + 0.03).
    let twice = Setting { attitude_error: AttitudeError::TwoEpsilon, ..SETTING };
    let [_, got] = command(&sosmc_law(Form::Corrected), Phase::BeforeCapture, &twice, &error());
    // I a = (-0.021 + 0.002 955 556, -0.0021 + 0.035 466 667, -0.004).
    assert_near(&got, &sum([-0.018044444, 0.033366667, -0.004], GYROSCOPIC, 1.0), 1e-9);
}

#[test]
fn tsmc_has_its_known_answers() {
    let law = |exponent| {
        let gains = |slope, layer| tsmc::Gains { slope, gain: Vec3([0.1, 0.2, 0.05]), layer, exponent };
        let translation = gains(Vec3([0.5, 1.0, 2.0]), Vec3([0.1, 0.05, 0.4]));
        LawRecipe::Tsmc(both(Form::Printed, translation, gains(Vec3([1.0, 2.0, 0.5]), Vec3([0.5, 0.1, 0.2]))))
    };
    // Printed, 5/3: |0.512|^(5/3) = 0.8⁵ = 0.32768, |0.064|^(5/3) = 0.4⁵ = 0.01024, |0.216|^(5/3) = 0.6⁵ = 0.07776.
    let mut error = error_with([0.512, -0.064, 0.216]);
    error.position = Vec3([0.216, -0.064, 0.512]);
    // Translation: s = (0.02 + 0.03888, -0.01 - 0.01024, 0.03 + 0.65536) = (0.05888, -0.02024, 0.68536),
    // sat = (0.5888, -0.4048, 1), a = (-0.05888, 0.08096, -0.05).
    let force = |mass| times(sum([-0.05888, 0.08096, -0.05], MINUS_NATURAL, 1.0), mass);
    // Rotation: s = (0.02 + 0.32768, -0.04 - 0.02048, 0.1 + 0.03888) = (0.34768, -0.06048, 0.13888), sat = (0.69536, -0.6048, 0.6944),
    // a = (-0.069536, 0.12096, -0.03472), I a = (-0.0069536 + 0.0012096, -0.00069536 + 0.0145152, -0.001736).
    let torque = sum([-0.005744, 0.01381984, -0.001736], GYROSCOPIC, 1.0);
    let [got_force, got_torque] = command(&law(5.0 / 3.0), Phase::BeforeCapture, &SETTING, &error);
    assert_near(&got_force, &force(9.0), 1e-14);
    assert_near(&got_torque, &torque, 1e-15);
    let [got_force, got_torque] = command(&law(5.0 / 3.0), Phase::AfterCapture, &SETTING, &error);
    assert_near(&got_force, &force(14.0), 1e-14);
    assert_near(&got_torque, &times(torque, 2.0), 1e-15);

    // Corrected, 3/5: |0.03125|^(3/5) = 0.5³ = 0.125, |0.00032|^(3/5) = 0.008, |0.00243|^(3/5) = 0.027.
    let mut error = error_with([0.03125, -0.00032, 0.00243]);
    error.position = Vec3([0.00243, -0.00032, 0.03125]);
    // Translation: s = (0.02 + 0.0135, -0.01 - 0.008, 0.03 + 0.25) = (0.0335, -0.018, 0.28), sat = (0.335, -0.36, 0.7).
    let force = times(sum([-0.0335, 0.072, -0.035], MINUS_NATURAL, 1.0), 9.0);
    // Rotation: s = (0.145, -0.056, 0.1135), sat = (0.29, -0.56, 0.5675), a = (-0.029, 0.112, -0.028375),
    // I a = (-0.0029 + 0.00112, -0.00029 + 0.01344, -0.00141875).
    let torque = sum([-0.00178, 0.01315, -0.00141875], GYROSCOPIC, 1.0);
    let [got_force, got_torque] = command(&law(0.6), Phase::BeforeCapture, &SETTING, &error);
    assert_near(&got_force, &force, 1e-14);
    assert_near(&got_torque, &torque, 1e-15);
}

#[test]
fn stsmc_has_its_known_answers_and_learns() {
    let gains = |slope, k1, k2| stsmc::Gains { slope, k1: Vec3(k1), k2: Vec3(k2) };
    let translation = gains(Vec3([0.05, 0.1, 0.6]), [0.1, 0.2, 0.5], [0.01, 0.02, 0.05]);
    let rotation = gains(Vec3([0.4, 0.1, 0.21]), [0.2, 0.1, 0.05], [0.1, 0.2, 0.3]);
    let mut gains = both(Form::Printed, translation, rotation);
    gains.form = None;
    let law = LawRecipe::Stsmc(gains).build(Phase::BeforeCapture, &BEFORE, &SETTING).unwrap();
    // ε and e_r chosen so that the roots are exact: translation s = (0.02 + 0.02, -0.01 + 0.02, 0.03 + 0.06) = (0.04, 0.01, 0.09),
    // √|s| = (0.2, 0.1, 0.3): ṡ = -(0.02, 0.02, 0.15), less Λ e_v = (0.001, -0.001, 0.018).
    let mut error = error_with([0.05, 0.0, 0.0]);
    error.position = Vec3([0.4, 0.2, 0.1]);
    let force = times(sum([-0.021, -0.019, -0.168], MINUS_NATURAL, 1.0), 9.0);
    // Rotation: s = (0.02 + 0.02, -0.04, 0.1) = (0.04, -0.04, 0.1), √|s| = (0.2, 0.2, 0.316 227 766):
    // ṡ = (-0.04, 0.02, -0.015 811 388). With q0 = √(1 - 0.0025) = 0.998 749 218:
    // ε' = (q0 e_ω + ε × e_ω)/2 = (0.009 987 492, -0.022 474 984, 0.048 937 461), Λ ε' = (0.003 994 997, -0.002 247 498, 0.010 276 867).
    // I a with a = (-0.043 994 997, 0.022 247 498, -0.026 088 255): (-0.004 177 025, 0.002 229 750, -0.001 304 413).
    let torque = sum([-0.004177025, 0.002229750, -0.001304413], GYROSCOPIC, 1.0);
    let mut memory = law.begin();
    let estimate = Estimate { motion: motion() };
    let input = LawInput {
        seen: Seen { estimate: &estimate, error },
        mean_motion: SETTING.mean_motion,
        feedforward: None,
        attitude_error: SETTING.attitude_error,
        period: 0.5,
    };
    let first = law.step(&mut memory, input);
    assert_near(&first.force.0, &force, 1e-15);
    assert_near(&first.torque.0, &torque, 1e-9);
    // The second time v = -k2 T sgn s: (-0.005, -0.01, -0.025) in translation, (-0.05, 0.1, -0.15) in rotation.
    memory.translation.grow(&[false; 3]);
    memory.rotation.grow(&[false; 3]);
    let second = law.step(&mut memory, input);
    assert_near(&second.force.0, &sum(force, times([-0.005, -0.01, -0.025], 9.0), 1.0), 1e-15);
    let turned = BEFORE.inertia * Vec3([-0.05, 0.1, -0.15]);
    assert_near(&second.torque.0, &sum(torque, turned.0, 1.0), 1e-9);
}

fn prrl_law(form: Form) -> LawRecipe {
    let gains = |slope, gain, layer| prrl::Gains { slope, gain, layer, alpha: 0.5 };
    let translation = gains(Vec3([0.05, 0.75, 0.6]), Vec3([0.1, 0.2, 0.5]), Vec3([0.08, 0.16, 0.04]));
    let rotation = gains(Vec3([0.28, 0.1, 1.5]), Vec3([0.2, 0.1, 0.05]), Vec3([0.64, 0.1, 0.09]));
    LawRecipe::Prrl(both(form, translation, rotation))
}

#[test]
fn prrl_has_its_known_answers() {
    // Translation: s = (0.02 + 0.02, -0.01 - 0.15, 0.03 + 0.06) = (0.04, -0.16, 0.09), √|s| = (0.2, 0.4, 0.3), sat = (0.5, -1, 1):
    // K √|s| sat = (0.01, -0.08, 0.15); Λ e_v = (0.001, -0.0075, 0.018). a = (-0.011, 0.0875, -0.168).
    let acceleration = sum([-0.011, 0.0875, -0.168], MINUS_NATURAL, 1.0);
    // Rotation: s = (0.02 + 0.14, -0.04 - 0.05, 0.1 + 0.15) = (0.16, -0.09, 0.25), √|s| = (0.4, 0.3, 0.5), sat = (0.25, -0.9, 1):
    // K √|s| sat = (0.02, -0.027, 0.025); Λ e_ω = (0.0056, -0.004, 0.15). a = (-0.0256, 0.031, -0.175),
    // I a = (-0.00256 + 0.00031, -0.000256 + 0.00372, -0.00875).
    let torque = sum([-0.00225, 0.003464, -0.00875], GYROSCOPIC, 1.0);
    let law = prrl_law(Form::Printed);
    check(&law, Phase::BeforeCapture, &SETTING, times(acceleration, 9.0), torque);
    check(&law, Phase::AfterCapture, &SETTING, times(acceleration, 14.0), times(torque, 2.0));

    // Corrected: √φ where |s| < φ. Translation x: √0.08 = 0.282 842 712, K … = 0.014 142 136.
    let acceleration = sum([-0.015142136, 0.0875, -0.168], MINUS_NATURAL, 1.0);
    // Rotation x: √0.64 = 0.8, K … = 0.04; y: √0.1 = 0.316 227 766, K … = -0.028 460 499. a = (-0.0456, 0.032 460 499, -0.175),
    // I a = (-0.00456 + 0.000 324 605, -0.000456 + 0.003 895 260, -0.00875).
    let torque = sum([-0.004235395, 0.003439260, -0.00875], GYROSCOPIC, 1.0);
    let [got_force, got_torque] = command(&prrl_law(Form::Corrected), Phase::BeforeCapture, &SETTING, &error());
    assert_near(&got_force, &times(acceleration, 9.0), 1e-8);
    assert_near(&got_torque, &torque, 1e-9);
}

#[test]
fn two_epsilon_doubles_the_attitude_error_of_sliding_laws_and_its_exact_rate() {
    // PRRL, s = e_ω + 2 Λ ε = (0.30, -0.14, 0.40): sat = (0.46875, -1, 1), √|s| = (0.547 722 558, 0.374 165 739, 0.632 455 532),
    // K √|s| sat = (0.051 348 990, -0.037 416 574, 0.031 622 777). Printed compensation Λ e_ω as before.
    let twice = Setting { attitude_error: AttitudeError::TwoEpsilon, ..SETTING };
    let [_, got] = command(&prrl_law(Form::Printed), Phase::BeforeCapture, &twice, &error());
    let a = [-0.051348990 - 0.0056, 0.037416574 + 0.004, -0.031622777 - 0.15];
    let torque = [0.1 * a[0] + 0.01 * a[1], 0.01 * a[0] + 0.12 * a[1], 0.05 * a[2]];
    assert_near(&got, &sum(torque, GYROSCOPIC, 1.0), 1e-9);
}

#[test]
fn exact_surface_rate_is_the_derivative_of_the_surface_along_the_motion() {
    // What the switch changes in the torque is I times the change of compensation; held against finite differences of the
    // attitude error itself under a constant e_ω.
    let mut noise = Random::new(31);
    let tsmc_gains =
        tsmc::Gains { slope: Vec3([0.3, 0.2, 0.1]), gain: Vec3([0.1; 3]), layer: Vec3([0.5; 3]), exponent: 0.6 };
    let tsmc_law = LawRecipe::Tsmc(both(Form::Corrected, tsmc_gains, tsmc_gains));
    for attitude_error in [AttitudeError::Epsilon, AttitudeError::TwoEpsilon] {
        let factor = attitude_error.factor();
        for _ in 0..20 {
            let attitude = noise.attitude().short_way();
            let error = TrackingError { attitude, rate: noise.vector(0.2), ..error() };
            let at = |t: f64| (attitude * Quat::from_rotation_vector(error.rate * t)).vector() * factor;
            let derivative = |f: &dyn Fn(Vec3<f64>) -> Vec3<f64>| (f(at(1e-4)) - f(at(-1e-4))) * 5e3;
            let change = |law: &LawRecipe| {
                let torque = |surface_rate| {
                    let setting = Setting { attitude_error, surface_rate, ..SETTING };
                    Vec3(command(law, Phase::BeforeCapture, &setting, &error)[1])
                };
                BEFORE.inertia.inverse() * (torque(SurfaceRate::Exact) - torque(SurfaceRate::Printed))
            };
            // PRRL: from -Λ e_ω to -d(Λ ε)/dt.
            let slope = Vec3([0.28, 0.1, 1.5]);
            let known = slope * error.rate - derivative(&|e| slope * e);
            assert_near(&change(&prrl_law(Form::Printed)).0, &known.0, 1e-8);
            // TSMC: from nothing to -d(α sgn(ε) |ε|^p)/dt. Away from ε = 0, where it has no bound.
            if attitude.vector().abs().0.iter().all(|x| *x > 0.02) {
                let surface = |e: Vec3<f64>| {
                    Vec3(std::array::from_fn(|i| tsmc_gains.slope[i] * e[i].signum() * e[i].abs().powf(0.6)))
                };
                assert_near(&change(&tsmc_law).0, &(-derivative(&surface)).0, 1e-6);
            }
        }
    }
}

#[test]
fn exact_surface_rate_in_translation_changes_tsmc_alone() {
    let exact = Setting { surface_rate: SurfaceRate::Exact, ..SETTING };
    let force = |law: &LawRecipe, setting| command(law, Phase::BeforeCapture, setting, &error())[0];
    for law in [prrl_law(Form::Printed), sosmc_law(Form::Printed)] {
        assert_eq!(force(&law, &SETTING), force(&law, &exact));
    }
    // TSMC, exponent 2: d(α |e| e)/dt = 2 α |e| e_v = 2·(0.5·0.4·0.02, -1·0.2·0.01, 2·0.1·0.03), times -9 kg.
    let gains =
        tsmc::Gains { slope: Vec3([0.5, 1.0, 2.0]), gain: Vec3([0.1; 3]), layer: Vec3([1.0; 3]), exponent: 2.0 };
    let law = LawRecipe::Tsmc(both(Form::Printed, gains, gains));
    let change = sum(force(&law, &exact), force(&law, &SETTING), -1.0);
    assert_near(&change, &[-0.072, 0.036, -0.108], 1e-14);
}

#[test]
fn feedforward_adds_mass_times_the_goals_acceleration_to_every_law() {
    for law in [prrl_law(Form::Printed), sosmc_law(Form::Corrected)] {
        let law = law.build(Phase::BeforeCapture, &BEFORE, &SETTING).unwrap();
        let estimate = Estimate { motion: motion() };
        let attitude_error = AttitudeError::Epsilon;
        let input = |feedforward| LawInput {
            seen: Seen { estimate: &estimate, error: error() },
            mean_motion: 0.01,
            feedforward,
            attitude_error,
            period: 0.1,
        };
        let plain = law.step(&mut law.begin(), input(None));
        let fed = law.step(&mut law.begin(), input(Some(Vec3([0.01, -0.02, 0.03]))));
        assert_near(&(fed.force - plain.force).0, &[0.09, -0.18, 0.27], 1e-14);
        assert_eq!(fed.torque, plain.torque);
    }
}

#[test]
fn each_phase_flies_its_own_gains() {
    let gains = |kp| pd::Gains { kp: Vec3([kp; 3]), kd: Vec3::zero() };
    let phase_gains = |kp| PhaseGains { translation: gains(kp), rotation: gains(2.0 * kp) };
    let law = LawRecipe::Pd(Gains { form: Some(Form::Printed), before: phase_gains(1.0), after: phase_gains(10.0) });
    check(&law, Phase::BeforeCapture, &SETTING, [-0.4, 0.2, -0.1], [-1.0, 1.0, -0.2]);
    check(&law, Phase::AfterCapture, &SETTING, [-4.0, 2.0, -1.0], [-10.0, 10.0, -2.0]);
}

#[test]
fn open_loop_builds_no_law() {
    assert!(LawRecipe::None { segments: Vec::new() }.build(Phase::BeforeCapture, &BEFORE, &SETTING).is_none());
    assert!(prrl_law(Form::Printed).segments().is_empty());
}
