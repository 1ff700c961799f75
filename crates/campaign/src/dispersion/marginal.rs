//! Distributions of one number.

use super::normal::{cdf, quantile, quantile_between};
use serde::Deserialize;

/// A distribution of one number, in the unit of its field.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Marginal {
    /// `mean` + `sigma` z. A value beyond `low` or `high`, which lie where none is ever expected, is put on that bound.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation, not negative.
        sigma: f64,
        /// Least value.
        low: f64,
        /// Greatest value.
        high: f64,
    },
    /// The part of a normal distribution that lies between `low` and `high`, each within 35 `sigma` of the mean or beyond it
    /// on its own side.
    TruncatedNormal {
        /// Mean before the truncation.
        mean: f64,
        /// Standard deviation before the truncation, positive.
        sigma: f64,
        /// Lower bound.
        low: f64,
        /// Upper bound.
        high: f64,
    },
    /// Uniform between `low` and `high`; where they are equal, that number.
    Uniform {
        /// Lower bound.
        low: f64,
        /// Upper bound.
        high: f64,
    },
    /// Uniform in the logarithm; both bounds positive.
    LogUniform {
        /// Lower bound.
        low: f64,
        /// Upper bound.
        high: f64,
    },
}

/// A distribution's inverse: which value has a given share below it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quantile {
    curve: Curve,
    low: f64,
    high: f64,
}

#[derive(Clone, Copy, Debug)]
enum Curve {
    Normal { mean: f64, sigma: f64 },
    TruncatedNormal { mean: f64, sigma: f64, below: [f64; 2], above: [f64; 2] },
    Uniform { width: f64 },
    LogUniform { log_ratio: f64 },
}

impl Quantile {
    pub(super) fn new(marginal: &Marginal) -> Self {
        match *marginal {
            Marginal::Normal { mean, sigma, low, high } => Self { curve: Curve::Normal { mean, sigma }, low, high },
            Marginal::TruncatedNormal { mean, sigma, low, high } => {
                let (a, b) = ((low - mean) / sigma, (high - mean) / sigma);
                let (below, above) = ([cdf(a), cdf(b)], [cdf(-a), cdf(-b)]);
                Self { curve: Curve::TruncatedNormal { mean, sigma, below, above }, low, high }
            }
            Marginal::Uniform { low, high } => Self { curve: Curve::Uniform { width: high - low }, low, high },
            Marginal::LogUniform { low, high } => {
                let ratio = high / low;
                let log_ratio = if ratio.is_finite() { libm::log(ratio) } else { libm::log(high) - libm::log(low) };
                Self { curve: Curve::LogUniform { log_ratio }, low, high }
            }
        }
    }

    /// The value with the share `u` below it.
    #[inline]
    pub(super) fn at(&self, u: f64) -> f64 {
        match self.curve {
            Curve::Normal { .. } => self.at_normal(quantile(u)),
            Curve::TruncatedNormal { mean, sigma, below, above } => {
                self.held(mean + sigma * quantile_between(below, above, u))
            }
            Curve::Uniform { width } => self.held(self.low + width * u),
            Curve::LogUniform { log_ratio } if log_ratio < 700.0 => self.held(self.low * libm::exp(log_ratio * u)),
            Curve::LogUniform { log_ratio } => {
                let root = libm::exp(0.5 * log_ratio * u); // the whole would overflow
                self.held(self.low * root * root)
            }
        }
    }

    /// The value with the share Φ(z) below it.
    #[inline]
    pub(super) fn at_normal(&self, z: f64) -> f64 {
        match self.curve {
            Curve::Normal { mean, sigma } => self.held(mean + sigma * z),
            _ => self.at(cdf(z)),
        }
    }

    /// Rounding must not lead out of the bounds.
    #[inline]
    fn held(&self, x: f64) -> f64 {
        if x < self.low {
            self.low
        } else if x > self.high {
            self.high
        } else {
            x
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Marginal; 5] = [
        Marginal::Normal { mean: 9.0, sigma: 0.2, low: 7.6, high: 10.4 },
        Marginal::TruncatedNormal { mean: 9.0, sigma: 2.0, low: 8.5, high: 30.0 },
        Marginal::TruncatedNormal { mean: 0.1, sigma: 0.01, low: 0.3, high: 0.37 },
        Marginal::Uniform { low: 0.3, high: 0.5 },
        Marginal::LogUniform { low: 1e-4, high: 10.0 },
    ];

    #[test]
    fn no_value_leaves_its_bounds_even_at_the_ends() {
        for marginal in &ALL {
            let quantile = Quantile::new(marginal);
            let (low, high) = (quantile.low, quantile.high);
            for u in [0.0, 2f64.powi(-53), 0.5, 1.0 - 2f64.powi(-53), 1.0] {
                let x = quantile.at(u);
                assert!(low <= x && x <= high, "{marginal:?} {u}: {x}");
            }
            for z in [-40.0, -9.0, 9.0, 40.0] {
                let x = quantile.at_normal(z);
                assert!(low <= x && x <= high, "{marginal:?} {z}: {x}");
            }
        }
    }

    #[test]
    fn values_rise_with_their_share_and_agree_by_either_way() {
        for marginal in &ALL {
            let curve = Quantile::new(marginal);
            let mut last = f64::NEG_INFINITY;
            for k in 1..1000 {
                let u = f64::from(k) / 1000.0;
                let x = curve.at(u);
                assert!(last < x, "{marginal:?} {u}");
                assert!((curve.at_normal(quantile(u)) / x - 1.0).abs() < 1e-13, "{marginal:?} {u}");
                last = x;
            }
        }
    }

    #[test]
    fn medians_are_those_of_closed_forms() {
        let median = |marginal| Quantile::new(&marginal).at(0.5);
        assert_eq!(median(ALL[0]), 9.0);
        assert_eq!(median(ALL[3]), 0.4);
        assert!((median(ALL[4]) - (1e-4f64 * 10.0).sqrt()).abs() < 1e-16);
        let half_normal = Marginal::TruncatedNormal { mean: 0.0, sigma: 1.0, low: 0.0, high: 9.0 };
        assert!((median(half_normal) - 0.6744897501960817).abs() < 1e-15);
    }
}
