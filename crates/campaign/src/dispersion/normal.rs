//! The standard normal distribution: Φ and its inverse, in plain `f64`.

/// Φ(x), with full relative precision in the lower tail too; the upper tail is Φ(-x).
pub(super) fn cdf(x: f64) -> f64 {
    0.5 * libm::erfc(-x * core::f64::consts::FRAC_1_SQRT_2)
}

/// The number below which the share `p` lies, infinite for 0 and 1; relative error about 1e-16 for p down to 1e-300.
///
/// Algorithm AS 241, PPND16: Wichura, "The percentage points of the normal distribution", Appl. Statist. 37 (1988) 477.
#[inline]
pub(super) fn quantile(p: f64) -> f64 {
    let q = p - 0.5;
    if q.abs() <= 0.425 {
        return q * ratio(&MIDDLE, 0.180625 - q * q);
    }
    // 1 - p is exact for p > 1/2.
    let r = (-libm::log(if q < 0.0 { p } else { 1.0 - p })).sqrt();
    let magnitude = if r <= 5.0 {
        ratio(&TAIL, r - 1.6)
    } else if r < f64::INFINITY {
        ratio(&FAR_TAIL, r - 5.0)
    } else {
        r
    };
    if q < 0.0 { -magnitude } else { magnitude }
}

/// The number that has the share `u` of what lies between a and b below it, of `below` = [Φ(a), Φ(b)] and
/// `above` = [Φ(-a), Φ(-b)]: taken from the lesser tail, and so precise however far out a and b are.
#[inline]
pub(super) fn quantile_between(below: [f64; 2], above: [f64; 2], u: f64) -> f64 {
    let between = |ends: [f64; 2]| (1.0 - u) * ends[0] + u * ends[1];
    let p = between(below);
    if p <= 0.5 { quantile(p) } else { -quantile(between(above)) }
}

/// Quotient of two polynomials of x, their coefficients from the constant on.
#[inline]
fn ratio([above, below]: &[[f64; 8]; 2], x: f64) -> f64 {
    let polynomial = |c: &[f64; 8]| c.iter().rev().fold(0.0, |sum, c| sum * x + c);
    polynomial(above) / polynomial(below)
}

const MIDDLE: [[f64; 8]; 2] = [
    [
        3.3871328727963665,
        133.14166789178438,
        1971.5909503065513,
        13731.69376550946,
        45921.95393154987,
        67265.7709270087,
        33430.57558358813,
        2509.0809287301227,
    ],
    [
        1.0,
        42.31333070160091,
        687.1870074920579,
        5394.196021424751,
        21213.794301586597,
        39307.89580009271,
        28729.085735721943,
        5226.495278852854,
    ],
];

const TAIL: [[f64; 8]; 2] = [
    [
        1.4234371107496835,
        4.630337846156546,
        5.769497221460691,
        3.6478483247632045,
        1.2704582524523684,
        0.2417807251774506,
        0.022723844989269184,
        0.0007745450142783414,
    ],
    [
        1.0,
        2.053191626637759,
        1.6763848301838038,
        0.6897673349851,
        0.14810397642748008,
        0.015198666563616457,
        0.0005475938084995345,
        1.0507500716444169e-9,
    ],
];

const FAR_TAIL: [[f64; 8]; 2] = [
    [
        6.657904643501103,
        5.463784911164114,
        1.7848265399172913,
        0.29656057182850487,
        0.026532189526576124,
        0.0012426609473880784,
        2.7115555687434876e-5,
        2.0103343992922881e-7,
    ],
    [
        1.0,
        0.599832206555888,
        0.1369298809227358,
        0.014875361290850615,
        0.0007868691311456133,
        1.8463183175100548e-5,
        1.421511758316446e-7,
        2.0442631033899397e-15,
    ],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_the_published_ones() {
        // The three checks of the algorithm's own paper.
        for (p, z) in [(0.25, -0.6744897501960817), (0.001, -3.090232306167814), (1e-20, -9.262340089798408)] {
            assert!((quantile(p) / z - 1.0f64).abs() < 1e-15, "{p}: {}", quantile(p));
        }
        assert_eq!(quantile(0.5), 0.0);
        assert_eq!(quantile(0.875), -quantile(0.125));
        assert_eq!((quantile(0.0), quantile(1.0)), (f64::NEG_INFINITY, f64::INFINITY));
    }

    #[test]
    fn quantile_undoes_the_distribution_far_into_the_tail() {
        for n in -3500..=0 {
            let x = 0.01 * f64::from(n);
            let tolerance = 1e-15 * x.abs().max(1.0);
            assert!((quantile(cdf(x)) - x).abs() <= tolerance, "{x}: {}", quantile(cdf(x)));
        }
    }

    #[test]
    fn a_share_between_two_bounds_is_precise_in_either_tail() {
        for (a, b) in [(-2.0, 1.0), (-30.0, -25.0), (25.0, 30.0), (-0.1, 20.0), (-20.0, 0.1), (7.0, 7.001)] {
            let (below, above) = ([cdf(a), cdf(b)], [cdf(-a), cdf(-b)]);
            let mirrored = |u| -quantile_between([cdf(-b), cdf(-a)], [cdf(b), cdf(a)], 1.0 - u);
            let mut last = a - 1e-13;
            for k in 0..=64 {
                let u = f64::from(k) / 64.0;
                let x = quantile_between(below, above, u);
                assert!(last < x && x <= b + 1e-13, "{a} {b} {u}: {x}");
                assert!((x - mirrored(u)).abs() < 1e-14 * x.abs().max(1.0), "{a} {b} {u}");
                last = x;
            }
        }
    }
}
