//! SOSMC (Eng. Proc. 2026, 121(1), 25, §3.3): linear surface, constant-plus-proportional reaching law. Despite its name
//! it is of first order. It compensates neither orbit nor the surface's own rate, in either form.
//!
//! ```text
//! s = e_v + c e_r     U = m (-K sat(s/φ) - α s)
//! s = e_ω + c ε       τ = I (-K sat(s/φ) - α s) ∓ ω × (I ω)      printed: minus; corrected: plus, which cancels
//! ```

use super::reaching::{Proportional, Reaching, Shape};
use super::sliding::{Compensation, OwnRate};
use super::surface::{self, Surface};
use super::{Channel, Form, PhaseGains, Setup, SlidingMode};
use crate::number::Vec3;

/// Gains of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Gains {
    /// c \[1/s\].
    pub slope: Vec3<f64>,
    /// K \[s-units per s\].
    pub gain: Vec3<f64>,
    /// α \[1/s\].
    pub proportional: Vec3<f64>,
    /// φ \[s-units\].
    pub layer: Vec3<f64>,
}

crate::fields!(Gains: slope, gain, proportional, layer);

/// Translation and rotation.
pub fn channels(gains: &PhaseGains<Gains>, setup: &Setup<'_>) -> (Channel<f64>, Channel<f64>) {
    let channel = |gains: &Gains, gyroscopic| {
        Channel::Sliding(SlidingMode {
            surface: Surface::Linear(surface::Linear { slope: gains.slope }),
            reaching: Reaching::new(
                gains.gain,
                gains.layer,
                Shape::Proportional(Proportional { proportional: gains.proportional }),
            ),
            compensation: Compensation { natural: false, surface_rate: OwnRate::Off, gyroscopic },
        })
    };
    let gyroscopic = if setup.form == Form::Printed { -1.0 } else { 1.0 };
    (channel(&gains.translation, 0.0), channel(&gains.rotation, gyroscopic))
}
