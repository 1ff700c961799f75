//! Reaching laws: how s is to move, element by element.
//!
//! ```text
//! constant plus proportional   ṡ = -K sat(s/φ) - α s                              0 ≤ α
//! power rate                   ṡ = -K |s|^α sat(s/φ)                              0 < α < 1, as printed
//!                              ṡ = -K max(|s|, φ)^α sat(s/φ)                      the same outside the layer
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
//! exponential, with rate K φ^(α-1). Source: Gao & Hung 1993; Eng. Proc. 2026, 121(1), 25, §3.3–3.5.

use super::{ChannelMemory, Form};
use crate::number::{Real, Vec3};
use crate::{batch_enum, batch_struct};

batch_struct! {
    /// A reaching law.
    pub struct Reaching<R> {
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

batch_enum! {
    /// What distinguishes one reaching law from another.
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
    /// From gain K, layer φ and shape.
    pub fn new(gain: Vec3<f64>, layer: Vec3<f64>, shape: Shape<f64>) -> Self {
        Self { gain, layer, inverse_layer: Vec3([1.0; 3]) / layer, shape }
    }
}

impl<R: Real> Reaching<R> {
    /// What it remembers when a flight begins.
    pub(super) fn begin(&self) -> ChannelMemory<R> {
        ChannelMemory::None(())
    }

    /// ṡ demanded.
    #[inline(always)]
    pub fn step(&self, _memory: &mut ChannelMemory<R>, s: Vec3<R>, _period: R) -> Vec3<R> {
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
