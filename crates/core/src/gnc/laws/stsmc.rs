//! STSMC: sliding mode of second order, by super-twisting. Linear surface, full compensation.
//!
//! ```text
//! s = e_v + Λ e_r     U = m (-A(r, v) - Λ e_v - k1 |s|^½ sgn s + v_r)          v_r' = -k2 sgn s
//! s = e_ω + Λ ε       τ = I (-Λ ε' - k1 |s|^½ sgn s + v_ω) + ω × (I ω)         v_ω' = -k2 sgn s
//! ```
//!
//! v learns whatever acceleration the law does not know of, so that a disturbance leaves no error behind; there is no boundary
//! layer, and no form but this one. An axis of v is held while the actuators are saturated on it. At capture v begins anew: it
//! was learnt of another body. Source: Levant 1998; Moreno & Osorio 2012.

use super::reaching::{Reaching, SuperTwisting};
use super::sliding::{Compensation, OwnRate};
use super::surface::{self, Surface};
use super::{Channel, PhaseGains, Setup, SlidingMode};
use crate::number::Vec3;

/// Gains of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Gains {
    /// Λ \[1/s\].
    pub slope: Vec3<f64>,
    /// k1 \[s-units^½ per s\].
    pub k1: Vec3<f64>,
    /// k2 \[s-units per s²\].
    pub k2: Vec3<f64>,
}

crate::fields!(Gains: slope, k1, k2);

/// Translation and rotation.
pub fn channels(gains: &PhaseGains<Gains>, _: &Setup<'_>) -> (Channel<f64>, Channel<f64>) {
    let channel = |gains: &Gains, natural, gyroscopic| {
        Channel::Sliding(SlidingMode {
            surface: Surface::Linear(surface::Linear { slope: gains.slope }),
            reaching: Reaching::SuperTwisting(SuperTwisting { k1: gains.k1, k2: gains.k2 }),
            compensation: Compensation { natural, surface_rate: OwnRate::Exact, gyroscopic },
        })
    };
    (channel(&gains.translation, true, 0.0), channel(&gains.rotation, false, 1.0))
}
