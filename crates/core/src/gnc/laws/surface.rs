//! Sliding surfaces, element by element.
//!
//! ```text
//! linear     s = rate + Λ e                   own rate  Λ e'
//! terminal   s = rate + Λ sgn(e) |e|^p        own rate  Λ p |e|^(p-1) e'
//! ```
//!
//! On s = 0 the linear surface decays exponentially, the terminal one in finite time for p < 1 and only polynomially for
//! p > 1. Where |e|^(p-1) is not finite (e = 0, p < 1) the own rate counts as zero.

use super::{ChannelError, one_law_a_batch};
use crate::batch::Batch;
use crate::number::{Real, Vec3};

/// A sliding surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surface<R> {
    /// s = rate + Λ e
    Linear {
        /// Λ \[1/s\].
        slope: Vec3<R>,
    },
    /// s = rate + Λ sgn(e) |e|^p
    Terminal {
        /// Λ in rate-units per error-unit to the power p.
        slope: Vec3<R>,
        /// p
        exponent: R,
    },
}

impl<R: Real> Surface<R> {
    /// Λ
    #[inline(always)]
    pub fn slope(&self) -> Vec3<R> {
        match self {
            Surface::Linear { slope } | Surface::Terminal { slope, .. } => *slope,
        }
    }

    /// s
    #[inline(always)]
    pub fn value(&self, errors: &ChannelError<R>) -> Vec3<R> {
        match self {
            Surface::Linear { slope } => slope.mul_add(errors.error, errors.rate),
            Surface::Terminal { slope, exponent } => {
                let power = errors.error.abs().powf(*exponent);
                (*slope * errors.error.signum0()).mul_add(power, errors.rate)
            }
        }
    }

    /// The part of ṡ that no control makes: the rate of the error's term.
    #[inline(always)]
    pub fn own_rate(&self, errors: &ChannelError<R>) -> Vec3<R> {
        match self {
            Surface::Linear { slope } => *slope * errors.error_rate,
            Surface::Terminal { slope, exponent } => {
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

impl<R: Real> Batch<R> for Surface<R> {
    type One = Surface<f64>;

    fn same(one: &Surface<f64>) -> Self {
        let slope = Batch::same(&one.slope());
        match one {
            Surface::Linear { .. } => Surface::Linear { slope },
            Surface::Terminal { exponent, .. } => Surface::Terminal { slope, exponent: R::splat(*exponent) },
        }
    }

    fn put(&mut self, i: usize, one: &Surface<f64>) {
        match (self, one) {
            (Surface::Linear { slope }, Surface::Linear { slope: one }) => slope.set_lane(i, *one),
            (Surface::Terminal { slope, exponent }, Surface::Terminal { slope: one, exponent: own }) => {
                slope.set_lane(i, *one);
                exponent.set_lane(i, *own);
            }
            _ => one_law_a_batch(),
        }
    }

    fn scatter(&self, i: usize) -> Surface<f64> {
        match self {
            Surface::Linear { slope } => Surface::Linear { slope: slope.lane(i) },
            Surface::Terminal { slope, exponent } => {
                Surface::Terminal { slope: slope.lane(i), exponent: exponent.lane(i) }
            }
        }
    }

    fn choose(mask: R::Mask, yes: &Self, no: &Self) -> Self {
        let slope = Vec3::select(mask, yes.slope(), no.slope());
        match (yes, no) {
            (Surface::Linear { .. }, Surface::Linear { .. }) => Surface::Linear { slope },
            (Surface::Terminal { exponent: yes, .. }, Surface::Terminal { exponent: no, .. }) => {
                Surface::Terminal { slope, exponent: R::select(mask, *yes, *no) }
            }
            _ => one_law_a_batch(),
        }
    }
}

#[cfg(test)]
mod tests;
