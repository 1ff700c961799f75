//! Sliding surfaces, element by element.
//!
//! ```text
//! linear     s = rate + Λ e                   own rate  Λ e'
//! terminal   s = rate + Λ sgn(e) |e|^p        own rate  Λ p |e|^(p-1) e'
//! ```
//!
//! On s = 0 the linear surface decays exponentially, the terminal one in finite time for p < 1 and only polynomially for
//! p > 1. Where |e|^(p-1) is not finite (e = 0, p < 1) the own rate counts as zero.

use super::ChannelError;
use crate::number::{Real, Vec3};
use crate::{batch_enum, batch_struct};

batch_enum! {
    /// A sliding surface.
    pub enum Surface<R> {
        /// s = rate + Λ e
        Linear(Linear<R>),
        /// s = rate + Λ sgn(e) |e|^p
        Terminal(Terminal<R>),
    }
}

batch_struct! {
    /// A linear surface.
    pub struct Linear<R> {
        /// Λ \[1/s\].
        pub slope: Vec3<R>,
    }
}

batch_struct! {
    /// A terminal surface.
    pub struct Terminal<R> {
        /// Λ in rate-units per error-unit to the power p.
        pub slope: Vec3<R>,
        /// p
        pub exponent: R,
    }
}

impl<R: Real> Surface<R> {
    /// Λ
    #[inline(always)]
    pub fn slope(&self) -> Vec3<R> {
        match self {
            Surface::Linear(Linear { slope }) | Surface::Terminal(Terminal { slope, .. }) => *slope,
        }
    }

    /// s
    #[inline(always)]
    pub fn value(&self, errors: &ChannelError<R>) -> Vec3<R> {
        match self {
            Surface::Linear(Linear { slope }) => slope.mul_add(errors.error, errors.rate),
            Surface::Terminal(Terminal { slope, exponent }) => {
                let power = errors.error.abs().powf(*exponent);
                (*slope * errors.error.signum0()).mul_add(power, errors.rate)
            }
        }
    }

    /// The part of ṡ that no control makes: the rate of the error's term.
    #[inline(always)]
    pub fn own_rate(&self, errors: &ChannelError<R>) -> Vec3<R> {
        match self {
            Surface::Linear(Linear { slope }) => *slope * errors.error_rate,
            Surface::Terminal(Terminal { slope, exponent }) => {
                let size = errors.error.abs();
                let power = size.powf(*exponent);
                let mut steepness = Vec3::zero();
                for i in 0..3 {
                    let nonzero = R::zero().lt(size.0[i]);
                    steepness.0[i] = R::select(nonzero, power.0[i] / size.0[i], R::zero());
                }
                *slope * steepness * errors.error_rate * *exponent
            }
        }
    }
}

#[cfg(test)]
mod tests;
