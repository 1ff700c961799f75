//! Reaching laws: how s is to move, element by element.
//!
//!     constant plus proportional   ṡ = -K sat(s/φ) - α s                              0 ≤ α
//!     power rate                   ṡ = -K |s|^α sat(s/φ)                              0 < α < 1, as printed
//!                                  ṡ = -K max(|s|, φ)^α sat(s/φ)                      the same outside the layer
//!
//! K in s-units per second (power rate: to the power 1-α), φ in s-units. Times from s0 down to the layer |s| = φ:
//!
//!     constant                     (s0 - φ) / K
//!     constant plus proportional   ln((K + α s0) / (K + α φ)) / α
//!     power rate                   (s0^(1-α) - φ^(1-α)) / (K (1-α))
//!
//! Inside the layer the printed power rate is (K/φ) |s|^(1+α): slower than exponential. With max(|s|, φ) it is
//! exponential, with rate K φ^(α-1). Source: Gao & Hung 1993; Eng. Proc. 2026, 121(1), 25, §3.3–3.5.

use super::{Form, one_law_a_batch};
use crate::batch::Batch;
use crate::number::{Real, Vec3};

/// A reaching law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reaching<R> {
    /// ṡ = -K sat(s/φ) - α s
    Proportional {
        /// K
        gain: Vec3<R>,
        /// α \[1/s\]; zero for the constant-rate law.
        proportional: Vec3<R>,
        /// φ
        layer: Vec3<R>,
    },
    /// ṡ = -K |s|^α sat(s/φ)
    PowerRate {
        /// K
        gain: Vec3<R>,
        /// α
        exponent: R,
        /// φ
        layer: Vec3<R>,
        /// Printed: |s| throughout; corrected: max(|s|, φ).
        inside: Form,
    },
}

impl<R: Real> Reaching<R> {
    /// ṡ demanded.
    #[inline(always)]
    pub fn rate(&self, s: Vec3<R>) -> Vec3<R> {
        match self {
            Reaching::Proportional { gain, proportional, layer } => {
                -(*gain * (s / *layer).clamp_unit() + *proportional * s)
            }
            Reaching::PowerRate { gain, exponent, layer, inside } => {
                let size = match inside {
                    Form::Printed => s.abs(),
                    Form::Corrected => s.abs().max(*layer),
                };
                -(*gain * size.powf(*exponent) * (s / *layer).clamp_unit())
            }
        }
    }

    fn parts(&self) -> (Vec3<R>, Vec3<R>) {
        match self {
            Reaching::Proportional { gain, layer, .. } | Reaching::PowerRate { gain, layer, .. } => (*gain, *layer),
        }
    }
}

impl<R: Real> Batch<R> for Reaching<R> {
    type One = Reaching<f64>;

    fn gather<'a>(pick: &dyn Fn(usize) -> &'a Reaching<f64>) -> Self {
        let gain = Vec3::from_lanes(|i| pick(i).parts().0);
        let layer = Vec3::from_lanes(|i| pick(i).parts().1);
        match pick(0) {
            Reaching::Proportional { .. } => Reaching::Proportional {
                gain,
                layer,
                proportional: Vec3::from_lanes(|i| match pick(i) {
                    Reaching::Proportional { proportional, .. } => *proportional,
                    Reaching::PowerRate { .. } => one_law_a_batch(),
                }),
            },
            Reaching::PowerRate { inside, .. } => Reaching::PowerRate {
                gain,
                layer,
                inside: *inside,
                exponent: R::from_fn(|i| match pick(i) {
                    Reaching::PowerRate { exponent, inside: own, .. } if own == inside => *exponent,
                    _ => one_law_a_batch(),
                }),
            },
        }
    }

    fn scatter(&self, i: usize) -> Reaching<f64> {
        match self {
            Reaching::Proportional { gain, proportional, layer } => {
                Reaching::Proportional { gain: gain.lane(i), proportional: proportional.lane(i), layer: layer.lane(i) }
            }
            Reaching::PowerRate { gain, exponent, layer, inside } => Reaching::PowerRate {
                gain: gain.lane(i),
                exponent: exponent.lane(i),
                layer: layer.lane(i),
                inside: *inside,
            },
        }
    }

    fn choose(mask: R::Mask, yes: &Self, no: &Self) -> Self {
        let gain = Vec3::select(mask, yes.parts().0, no.parts().0);
        let layer = Vec3::select(mask, yes.parts().1, no.parts().1);
        match (yes, no) {
            (Reaching::Proportional { proportional: yes, .. }, Reaching::Proportional { proportional: no, .. }) => {
                Reaching::Proportional { gain, layer, proportional: Vec3::select(mask, *yes, *no) }
            }
            (Reaching::PowerRate { exponent: yes, inside, .. }, Reaching::PowerRate { exponent: no, .. }) => {
                Reaching::PowerRate { gain, layer, inside: *inside, exponent: R::select(mask, *yes, *no) }
            }
            _ => one_law_a_batch(),
        }
    }
}
