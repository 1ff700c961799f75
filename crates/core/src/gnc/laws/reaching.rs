//! Reaching laws: how s is to move, element by element.
//!
//! ```text
//! constant plus proportional   ṡ = -K sat(s/φ) - α s                              0 ≤ α
//! power rate                   ṡ = -K |s|^α sat(s/φ)                              0 < α < 1, as printed
//!                              ṡ = -K max(|s|, φ)^α sat(s/φ)                      the same outside the layer
//! super-twisting               ṡ = -k1 |s|^½ sgn s + v,  v̇ = -k2 sgn s            v is remembered
//! ```
//!
//! K in s-units per second (power rate: to the power 1-α), φ in s-units. Times from s0 down to the layer |s| = φ:
//!
//! ```text
//! constant                     (s0 - φ) / K
//! constant plus proportional   ln((K + α s0) / (K + α φ)) / α
//! power rate                   (s0^(1-α) - φ^(1-α)) / (K (1-α))
//! ```
//!
//! Inside the layer the printed power rate is (K/φ) |s|^(1+α): slower than exponential. With max(|s|, φ) it is
//! exponential, with rate K φ^(α-1). Super-twisting reaches s = ṡ = 0 in finite time, whatever disturbance of slope below L
//! acts, with k1 = 1.5 √L and k2 = 1.1 L; v grows by an explicit step a control period, so that s stays within a band that
//! shrinks with the square of the period. Source: Gao & Hung 1993; Eng. Proc. 2026, 121(1), 25, §3.3–3.5; Levant 1998 and
//! Moreno & Osorio 2012 for super-twisting.

use super::{ChannelMemory, Form};
use crate::batch::lanes_differ;
use crate::number::{Real, Vec3};
use crate::{batch_enum, batch_struct};

batch_enum! {
    /// A reaching law.
    pub enum Reaching<R> {
        /// Of first order, with a boundary layer.
        Layered(Layered<R>),
        /// Of second order.
        SuperTwisting(SuperTwisting<R>),
    }
}

batch_struct! {
    /// A reaching law of first order.
    pub struct Layered<R> {
        /// K
        pub gain: Vec3<R>,
        /// φ
        pub layer: Vec3<R>,
        /// 1/φ
        pub inverse_layer: Vec3<R>,
        /// How K grows with |s|.
        pub shape: Shape<R>,
    }
}

batch_struct! {
    /// Gains of super-twisting.
    pub struct SuperTwisting<R> {
        /// k1 \[s-units^½ per s\]
        pub k1: Vec3<R>,
        /// k2 \[s-units per s²\]
        pub k2: Vec3<R>,
    }
}

batch_enum! {
    /// What distinguishes one reaching law of first order from another.
    pub enum Shape<R> {
        /// ṡ = -K sat(s/φ) - α s; constant rate where α = 0.
        Proportional(Proportional<R>),
        /// ṡ = -K |s|^α sat(s/φ)
        PowerRate(PowerRate<R>),
    }
}

batch_struct! {
    /// Proportional part of a reaching law.
    pub struct Proportional<R> {
        /// α \[1/s\]
        pub proportional: Vec3<R>,
    }
}

batch_struct! {
    /// Power of a reaching law.
    pub struct PowerRate<R> {
        /// α
        pub exponent: R,
        /// Printed: |s| throughout; corrected: max(|s|, φ).
        pub inside: Form,
    }
}

impl Reaching<f64> {
    /// Of first order, from gain K, layer φ and shape.
    pub fn new(gain: Vec3<f64>, layer: Vec3<f64>, shape: Shape<f64>) -> Self {
        Self::Layered(Layered { gain, layer, inverse_layer: Vec3([1.0; 3]) / layer, shape })
    }
}

impl<R: Real> Reaching<R> {
    /// What it remembers when a flight begins: v = 0.
    pub(super) fn begin(&self) -> ChannelMemory<R> {
        match self {
            Reaching::Layered(_) => ChannelMemory::None(()),
            Reaching::SuperTwisting(_) => ChannelMemory::integral(),
        }
    }

    /// ṡ demanded.
    #[inline(always)]
    pub fn step(&self, memory: &mut ChannelMemory<R>, s: Vec3<R>, period: R) -> Vec3<R> {
        match (self, memory) {
            (Reaching::Layered(layered), _) => layered.rate(s),
            (Reaching::SuperTwisting(SuperTwisting { k1, k2 }), ChannelMemory::Integral(v)) => {
                let ([x, y, z], sign) = (s.abs().0, s.signum0());
                let root = Vec3([x.sqrt(), y.sqrt(), z.sqrt()]);
                v.growth = -(*k2 * sign * period);
                v.value - *k1 * root * sign
            }
            (Reaching::SuperTwisting(_), ChannelMemory::None(())) => lanes_differ(),
        }
    }
}

impl<R: Real> Layered<R> {
    #[inline(always)]
    fn rate(&self, s: Vec3<R>) -> Vec3<R> {
        let toward = self.gain * (s * self.inverse_layer).clamp_unit();
        match &self.shape {
            Shape::Proportional(Proportional { proportional }) => -(toward + *proportional * s),
            Shape::PowerRate(PowerRate { exponent, inside: Form::Printed }) => -(toward * s.abs().powf(*exponent)),
            Shape::PowerRate(PowerRate { exponent, inside: Form::Corrected }) => {
                -(toward * self.layer.max(s.abs()).powf(*exponent))
            }
        }
    }
}

#[cfg(test)]
mod tests;
