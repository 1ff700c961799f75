//! PD (Eng. Proc. 2026, 121(1), 25, §3.1).
//!
//! ```text
//! U = -Kp e_r - Kd e_v
//! τ = -Kp ε - Kd ω        printed: the body's own rate, so a tumbling target is followed with a lag 2 asin(Kd ω/Kp)
//! τ = -Kp ε - Kd e_ω      corrected
//! ```

use super::{Channel, Form, LinearFeedback, PhaseGains, Setup};
use crate::number::{Mat3, Vec3};

/// Gains of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Gains {
    /// Kp \[N/m or N m\].
    pub kp: Vec3<f64>,
    /// Kd \[N s/m or N m s\].
    pub kd: Vec3<f64>,
}

crate::fields!(Gains: kp, kd);

/// Translation and rotation.
pub fn channels(gains: &PhaseGains<Gains>, setup: &Setup<'_>) -> (Channel<f64>, Channel<f64>) {
    let channel = |gains: &Gains, damps_own_rate| {
        Channel::Linear(LinearFeedback {
            error: Mat3::diagonal(gains.kp),
            rate: Mat3::diagonal(gains.kd),
            damps_own_rate,
        })
    };
    let own = if setup.form == Form::Printed { 1.0 } else { 0.0 };
    (channel(&gains.translation, 0.0), channel(&gains.rotation, own))
}
