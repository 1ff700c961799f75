//! TSMC (Eng. Proc. 2026, 121(1), 25, §3.4): terminal surface, constant-rate reaching law.
//!
//! ```text
//! s = e_v + α sgn(e_r) |e_r|^(p/q)     U = m (-β sat(s/φ) - A(r, v))
//! s = e_ω + α sgn(ε) |ε|^(p/q)         τ = I (-β sat(s/φ)) + ω × (I ω)
//! ```
//!
//! Printed: p/q > 1, which on the surface converges only polynomially. Corrected: p/q < 1, in finite time. The exponent
//! comes with the gains, so the form needs no switch here.

use super::reaching::{Proportional, Reaching, Shape};
use super::sliding::{Compensation, OwnRate};
use super::surface::{self, Surface};
use super::{Channel, PhaseGains, Setup, SlidingMode, SurfaceRate};
use crate::number::Vec3;

/// Gains of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Gains {
    /// α, in rate-units per error-unit to the power p/q.
    pub slope: Vec3<f64>,
    /// β \[s-units per s\].
    pub gain: Vec3<f64>,
    /// φ \[s-units\].
    pub layer: Vec3<f64>,
    /// p/q
    pub exponent: f64,
}

crate::fields!(Gains: slope, gain, layer, exponent);

/// Translation and rotation.
pub fn channels(gains: &PhaseGains<Gains>, setup: &Setup<'_>) -> (Channel<f64>, Channel<f64>) {
    let surface_rate = match setup.setting.surface_rate {
        SurfaceRate::Exact => OwnRate::Exact,
        SurfaceRate::Printed => OwnRate::Off,
    };
    let channel = |gains: &Gains, natural, gyroscopic| {
        Channel::Sliding(SlidingMode {
            surface: Surface::Terminal(surface::Terminal { slope: gains.slope, exponent: gains.exponent }),
            reaching: Reaching::new(
                gains.gain,
                gains.layer,
                Shape::Proportional(Proportional { proportional: Vec3([0.0; 3]) }),
            ),
            compensation: Compensation { natural, surface_rate, gyroscopic },
        })
    };
    (channel(&gains.translation, true, 0.0), channel(&gains.rotation, false, 1.0))
}
