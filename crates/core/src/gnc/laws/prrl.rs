//! PRRL-SMC (Eng. Proc. 2026, 121(1), 25, §3.5): linear surface, power rate reaching law, full compensation.
//!
//! ```text
//! s = e_v + Λ e_r     U = m (-A(r, v) - Λ e_v - K |s|^α sat(s/φ))
//! s = e_ω + Λ ε       τ = I (-Λ e_ω - K |s|^α sat(s/φ)) + ω × (I ω)
//! ```
//!
//! Printed and corrected differ inside the boundary layer, see [`super::reaching`]. As printed, -Λ e_ω stands for the
//! rate of Λ ε, which is close to Λ e_ω/2; `surface_rate = "exact"` puts the true one there.

use super::reaching::{PowerRate, Reaching, Shape};
use super::sliding::{Compensation, OwnRate};
use super::surface::{self, Surface};
use super::{Channel, PhaseGains, Setup, SlidingMode, SurfaceRate};
use crate::number::Vec3;

/// Gains of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Gains {
    /// Λ \[1/s\].
    pub slope: Vec3<f64>,
    /// K, in s-units to the power 1-α per s.
    pub gain: Vec3<f64>,
    /// φ \[s-units\].
    pub layer: Vec3<f64>,
    /// α, 0 < α < 1.
    pub alpha: f64,
}

crate::fields!(Gains: slope, gain, layer, alpha);

/// Translation and rotation.
pub fn channels(gains: &PhaseGains<Gains>, setup: &Setup<'_>) -> (Channel<f64>, Channel<f64>) {
    let surface_rate = match setup.setting.surface_rate {
        SurfaceRate::Exact => OwnRate::Exact,
        SurfaceRate::Printed => OwnRate::Linear,
    };
    let channel = |gains: &Gains, natural, gyroscopic| {
        Channel::Sliding(SlidingMode {
            surface: Surface::Linear(surface::Linear { slope: gains.slope }),
            reaching: Reaching::new(
                gains.gain,
                gains.layer,
                Shape::PowerRate(PowerRate { exponent: gains.alpha, inside: setup.form }),
            ),
            compensation: Compensation { natural, surface_rate, gyroscopic },
        })
    };
    (channel(&gains.translation, true, 0.0), channel(&gains.rotation, false, 1.0))
}
