//! LQR (Eng. Proc. 2026, 121(1), 25, §3.2): continuous algebraic Riccati equation, Q = diag(q_e, q_r), R = r 1.
//!
//! ```text
//! translation   x = [e_r; e_v] on the full HCW matrix, input acceleration        U = -m K x
//! rotation      x = [ε; rate],  ε' = e_ω/2,  I e_ω' = τ                          τ = -K x
//! ```
//!
//! With the attitude error 2 ε the model is (2ε)' = e_ω. The rate is ω before and e_ω after capture as printed, e_ω
//! throughout as corrected.

use super::riccati::{self, System};
use super::{AttitudeError, Channel, Form, LinearFeedback, Phase, PhaseGains, Setup};
use crate::number::{Mat3, Vec3};

/// Weights of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Weights {
    /// Diagonal of Q for the error \[1/m² or 1\].
    pub q_error: Vec3<f64>,
    /// Diagonal of Q for the rate \[s²/m² or s²/rad²\].
    pub q_rate: Vec3<f64>,
    /// R = r 1 \[s⁴/m² or 1/(N m)²\].
    pub r: f64,
}

crate::fields!(Weights: q_error, q_rate, r);

/// Translation and rotation.
pub fn channels(weights: &PhaseGains<Weights>, setup: &Setup<'_>) -> (Channel<f64>, Channel<f64>) {
    let Setup { form, phase, believed, setting } = *setup;
    let [error, rate] = translation_gain(&weights.translation, setting.mean_motion);
    let translation =
        LinearFeedback { error: error.scale(believed.mass), rate: rate.scale(believed.mass), damps_own_rate: 0.0 };
    let [error, rate] = rotation_gain(&weights.rotation, &believed.inertia, setting.attitude_error);
    let printed_before = form == Form::Printed && phase == Phase::BeforeCapture;
    let rotation = LinearFeedback { error, rate, damps_own_rate: if printed_before { 1.0 } else { 0.0 } };
    (Channel::Linear(translation), Channel::Linear(rotation))
}

/// K of the HCW model, input acceleration: \[K_r, K_v\].
pub fn translation_gain(weights: &Weights, mean_motion: f64) -> [Mat3<f64>; 2] {
    let n = mean_motion;
    let stiffness = Mat3([[3.0 * n * n, 0.0, 0.0], [0.0; 3], [0.0, 0.0, -n * n]]);
    let coriolis = Mat3([[0.0, 2.0 * n, 0.0], [-2.0 * n, 0.0, 0.0], [0.0; 3]]);
    let system = System { coupling: 1.0, stiffness, damping: coriolis, input: Mat3::identity() };
    riccati::gain(&system, weights)
}

/// K of the linearised attitude, input torque: \[K_ε, K_ω\].
pub fn rotation_gain(weights: &Weights, inertia: &Mat3<f64>, attitude_error: AttitudeError) -> [Mat3<f64>; 2] {
    let system = System {
        coupling: 0.5 * attitude_error.factor(),
        stiffness: Mat3([[0.0; 3]; 3]),
        damping: Mat3([[0.0; 3]; 3]),
        input: inertia.inverse(),
    };
    riccati::gain(&system, weights)
}

#[cfg(test)]
mod tests;
