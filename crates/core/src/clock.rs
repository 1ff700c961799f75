//! What the time of a control tick is called.
//!
//! k T in floating point is not what a person writes: 76 × 0.1 = 7.6000000000000005. So every time that is reported is the
//! double nearest to the decimal k T, with T as its shortest decimal. The physics keeps its own times.

/// Labels of the control ticks of one period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    period: f64,
    /// T = digits · 10^exponent
    digits: u64,
    exponent: i32,
    /// 10^|exponent|, exact where it is used.
    scale: f64,
}

impl Clock {
    /// Of a control period \[s\], greater than zero.
    pub fn new(period: f64) -> Self {
        let shortest = format!("{period:e}"); // the fewest digits that read back as the same number
        let (digits, exponent) = shortest.split_once('e').unwrap_or((&shortest, "0"));
        let decimals = digits.split_once('.').map_or(0, |(_, decimals)| decimals.len() as i32);
        let exponent = exponent.parse::<i32>().unwrap_or(0) - decimals;
        let scale = format!("1e{}", exponent.abs()).parse().unwrap_or(f64::INFINITY);
        Self { period, digits: digits.replace('.', "").parse().unwrap_or(0), exponent, scale }
    }

    /// The double nearest to k T \[s\].
    pub fn time_of(&self, tick: u64) -> f64 {
        let count = u128::from(self.digits) * u128::from(tick);
        if count < 1 << 53 && self.exponent.abs() <= 22 {
            // Both factors are exact, so that one operation rounds once.
            let count = count as f64;
            if self.exponent < 0 { count / self.scale } else { count * self.scale }
        } else {
            format!("{count}e{}", self.exponent).parse().unwrap_or(f64::NAN)
        }
    }

    /// The tick at a time that the physics has \[s\].
    pub fn tick_at(&self, time: f64) -> u64 {
        (time / self.period).round() as u64
    }
}

#[cfg(test)]
mod tests {
    use super::Clock;

    #[test]
    fn label_is_what_a_person_writes() {
        for (period, tick, label) in [
            (0.1, 76, "7.6"),
            (0.1, 868, "86.8"),
            (0.05, 3, "0.15"),
            (0.7, 3, "2.1"),
            (30.0, 7, "210"),
            (1e-3, 2_000_000, "2000"),
            (1e-7, 3, "3e-7"),
            (1.0 / 3.0, 3, "0.9999999999999999"),
            (1e-30, 7, "7e-30"),
            (0.1, 0, "0"),
        ] {
            assert_eq!(Clock::new(period).time_of(tick), label.parse().unwrap(), "{tick} x {period}");
        }
    }

    #[test]
    fn label_never_leaves_the_tick_of_its_time() {
        for period in [0.1, 0.05, 0.02, 1.0 / 3.0, 1e-3, 0.7, 30.0, 1e-7, 1.2345678901234567e-5] {
            let clock = Clock::new(period);
            let mut last = -1.0;
            for tick in (0..2_000_000_u64).step_by(997) {
                let label = clock.time_of(tick);
                assert_eq!((clock.tick_at(tick as f64 * period), clock.tick_at(label)), (tick, tick));
                assert!(label > last && (label - tick as f64 * period).abs() <= 2.0 * f64::EPSILON * label);
                last = label;
            }
        }
    }
}
