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

use super::{Form, one_law_a_batch};
use crate::batch::Batch;
use crate::batch_struct;
use crate::number::{Real, Vec3};

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

/// What distinguishes one reaching law from another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape<R> {
    /// ṡ = -K sat(s/φ) - α s; constant rate where α = 0.
    Proportional {
        /// α \[1/s\]
        proportional: Vec3<R>,
    },
    /// ṡ = -K |s|^α sat(s/φ)
    PowerRate {
        /// α
        exponent: R,
        /// Printed: |s| throughout; corrected: max(|s|, φ).
        inside: Form,
    },
}

impl Reaching<f64> {
    /// From gain K, layer φ and shape.
    pub fn new(gain: Vec3<f64>, layer: Vec3<f64>, shape: Shape<f64>) -> Self {
        Self { gain, layer, inverse_layer: Vec3([1.0; 3]) / layer, shape }
    }
}

impl<R: Real> Reaching<R> {
    /// ṡ demanded.
    #[inline(always)]
    pub fn rate(&self, s: Vec3<R>) -> Vec3<R> {
        let toward = self.gain * (s * self.inverse_layer).clamp_unit();
        match &self.shape {
            Shape::Proportional { proportional } => -(toward + *proportional * s),
            Shape::PowerRate { exponent, inside: Form::Printed } => -(toward * s.abs().powf(*exponent)),
            Shape::PowerRate { exponent, inside: Form::Corrected } => {
                -(toward * self.layer.max(s.abs()).powf(*exponent))
            }
        }
    }
}

impl<R: Real> Batch<R> for Shape<R> {
    type One = Shape<f64>;

    fn same(one: &Shape<f64>) -> Self {
        match one {
            Shape::Proportional { proportional } => Shape::Proportional { proportional: Batch::same(proportional) },
            Shape::PowerRate { exponent, inside } => {
                Shape::PowerRate { exponent: R::splat(*exponent), inside: *inside }
            }
        }
    }

    fn put(&mut self, i: usize, one: &Shape<f64>) {
        match (self, one) {
            (Shape::Proportional { proportional }, Shape::Proportional { proportional: one }) => {
                proportional.set_lane(i, *one);
            }
            (Shape::PowerRate { exponent, inside }, Shape::PowerRate { exponent: one, inside: own })
                if inside == own =>
            {
                exponent.set_lane(i, *one);
            }
            _ => one_law_a_batch(),
        }
    }

    fn scatter(&self, i: usize) -> Shape<f64> {
        match self {
            Shape::Proportional { proportional } => Shape::Proportional { proportional: proportional.lane(i) },
            Shape::PowerRate { exponent, inside } => Shape::PowerRate { exponent: exponent.lane(i), inside: *inside },
        }
    }

    fn choose(mask: R::Mask, yes: &Self, no: &Self) -> Self {
        match (yes, no) {
            (Shape::Proportional { proportional: yes }, Shape::Proportional { proportional: no }) => {
                Shape::Proportional { proportional: Vec3::select(mask, *yes, *no) }
            }
            (Shape::PowerRate { exponent: yes, inside }, Shape::PowerRate { exponent: no, .. }) => {
                Shape::PowerRate { exponent: R::select(mask, *yes, *no), inside: *inside }
            }
            _ => one_law_a_batch(),
        }
    }
}

#[cfg(test)]
mod tests;
