//! exp, ln, powf, sin and cos: one source for every number type, without branches or tables.
//!
//! Each reduces its argument to a small interval around 0 and evaluates a polynomial there. Coefficients:
//! fdlibm (Sun Microsystems 1993: `e_log.c`, `k_sin.c`, `k_cos.c`, `e_rem_pio2.c`), and Taylor for exp.
//! Where plain rounding would show in the result, the rounding error is computed too and carried along.
//!
//! Greatest difference from the standard library in the tests beside this file, with fused `mul_add` or without: exp 1 unit
//! in the last place, powf 3 for exponents up to 1 and two more for each unit beyond, the others 2.

use super::real::{Bits, Real};

/// `c0 + x (c1 + x (c2 + ...))`. A macro, since a loop over a table of coefficients need not be unrolled.
macro_rules! polynomial {
    ($x:expr; $c:expr) => { R::splat($c) };
    ($x:expr; $c:expr, $($rest:expr),+) => { polynomial!($x; $($rest),+).mul_add($x, R::splat($c)) };
}

pub(super) use polynomial;

/// Adding it leaves a number below 2^51 rounded to an integer, which then stands in the low bits in two's complement.
const ROUND: f64 = (3u64 << 51) as f64;

/// ln 2 in two parts: the first has 33 bits, so its products with exponents are exact.
const LN_2: [f64; 2] = [0.6931471803691238, 1.9082149292705877e-10];

/// π/2 in three parts: the first two have 33 bits, so their products with integers below 2^20 are exact.
const FRAC_PI_2: [f64; 3] = [1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21];

/// 2π less its nearest `f64`.
const TAU_REST: f64 = 2.4492935982947064e-16;

/// `c - a b` for `c` within rounding of `a b`: exact when fused, almost so otherwise.
#[inline(always)]
fn residual<R: Real>(c: R, a: R, b: R) -> R {
    if R::FUSED {
        return (-a).mul_add(b, c);
    }
    // Dekker's product: with 26 bits in the upper parts the partial products are exact.
    let upper = R::Bits::splat(!0 << 27);
    let (a0, b0) = (R::from_bits(a.to_bits() & upper), R::from_bits(b.to_bits() & upper));
    let (a1, b1) = (a - a0, b - b0);
    c - a0 * b0 - a0 * b1 - a1 * b0 - a1 * b1
}

/// The exponent's bias is added on the way to an integer, so that the low bits are those of 2^n.
const BIASED: f64 = ROUND + 1023.0;

/// A positive normal number as 2^k (1 + f), √½ <= 1 + f < √2: k and f.
#[inline(always)]
pub(super) fn exponent_and_fraction<R: Real>(x: R) -> (R, R) {
    const SQRT_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
    const EXPONENT: u64 = 0xfff << 52;
    const TWO_52: f64 = (1u64 << 52) as f64;
    let above = x.to_bits() - R::Bits::splat(SQRT_HALF);
    let one_plus_f = R::from_bits(x.to_bits() - (above & R::Bits::splat(EXPONENT)));
    // k is read as an integer laid into the mantissa of 2^52; the 1024 keep it positive.
    let k = (above + R::Bits::splat(1024 << 52)).shr::<52>() | R::Bits::splat(TWO_52.to_bits());
    (R::from_bits(k) - R::splat(TWO_52 + 1024.0), one_plus_f - R::one())
}

/// ln (1 + f) - 2 s = s (L1 s² + L2 s⁴ + ...) with s = f / (2 + f): at most a hundredth of 2 s.
#[inline(always)]
fn ln_tail<R: Real>(s: R) -> R {
    let z = s * s;
    let w = z * z;
    let even = polynomial!(w; 0.6666666666666735, 0.2857142874366239, 0.1818357216161805, 0.14798198605116586);
    let odd = polynomial!(w; 0.3999999999940942, 0.22222198432149784, 0.15313837699209373);
    (s * z) * odd.mul_add(z, even)
}

/// ln of a positive normal number; what it makes of others has no meaning.
///
/// ```text
/// ln x = k ln 2 + 2 s + s (L1 s² + L2 s⁴ + ...)
/// ```
#[inline(always)]
fn ln_of_normal<R: Real>(x: R) -> R {
    let (k, f) = exponent_and_fraction(x);
    let s = f / (R::splat(2.0) + f);
    k.mul_add(R::splat(core::f64::consts::LN_2), s + s + ln_tail(s))
}

/// ```text
/// x = n ln 2 + r, |r| <= ln 2 / 2        e^x = 2^n (1 + r + r² (1/2! + r/3! + ...))
/// ```
#[inline(always)]
pub(super) fn exp<R: Real>(x: R) -> R {
    let x = x.clamp(R::splat(-708.0), R::splat(708.0));
    let shifted = x.mul_add(R::splat(core::f64::consts::LOG2_E), R::splat(BIASED));
    let n = shifted - R::splat(BIASED);

    let r = n.mul_add(R::splat(-LN_2[1]), n.mul_add(R::splat(-LN_2[0]), x));
    let z = r * r;
    // Even and odd terms apart halve the chain of dependent operations.
    let even =
        polynomial!(z; 1.0 / 2.0, 1.0 / 24.0, 1.0 / 720.0, 1.0 / 40_320.0, 1.0 / 3_628_800.0, 1.0 / 479_001_600.0);
    let odd = polynomial!(z; 1.0 / 6.0, 1.0 / 120.0, 1.0 / 5_040.0, 1.0 / 362_880.0, 1.0 / 39_916_800.0, 1.0 / 6_227_020_800.0);
    let y = R::one() + z.mul_add(odd.mul_add(r, even), r);
    y * power_of_two(shifted)
}

/// 2^n from n + [`BIASED`]. To be multiplied with, not added to exponent bits: NaN times anything is NaN.
#[inline(always)]
fn power_of_two<R: Real>(shifted: R) -> R {
    R::from_bits(shifted.to_bits().shl::<52>())
}

#[inline(always)]
pub(super) fn ln<R: Real>(x: R) -> R {
    let infinity = R::splat(f64::INFINITY);
    let below = R::select(x.lt(R::zero()), R::splat(f64::NAN), -infinity);
    let y = R::select(x.lt(R::splat(f64::MIN_POSITIVE)), below, ln_of_normal(x));
    // False for NaN too, whose bits would have been read as a number.
    R::select(x.lt(infinity), y, x)
}

/// ```text
/// x = 2^k (1 + f)        x^a = 2^(a k + a log2(1 + f)) = 2^n 2^r, |r| <= 1/2
/// ```
///
/// Only a k can be large; its rounding error is carried along, so that r is good to a few units of 2^-54 whatever n is.
#[inline(always)]
pub(super) fn powf<R: Real>(x: R, a: R) -> R {
    let smallest = R::splat(f64::MIN_POSITIVE);
    let (k, f) = exponent_and_fraction(x.max(smallest));
    let log = log2_of_one_plus(f);
    let whole = a * k;
    let rest = a.mul_add(log, -residual(whole, a, k));

    let p = (whole + rest).clamp(R::splat(-1021.0), R::splat(1021.0));
    let shifted = p + R::splat(BIASED);
    let half = R::splat(0.5);
    // Held within its range for exponents beyond all bounds.
    let r = ((whole - (shifted - R::splat(BIASED))) + rest).clamp(-half, half);

    let z = r * r;
    let even = polynomial!(z; 0.24022650695910071, 0.009618129107628477, 0.0001540353039338161,
        1.321548679014431e-6, 7.054911620801123e-9, 2.5678435993488205e-11);
    let odd = polynomial!(z; 0.05550410866482158, 0.0013333558146428443, 1.525273380405984e-5,
        1.01780860092397e-7, 4.4455382718708115e-10);
    let y = R::one() + z.mul_add(odd.mul_add(r, even), r * R::splat(core::f64::consts::LN_2));
    R::select(x.lt(R::splat(f64::INFINITY)), y * power_of_two(shifted), x)
}

/// log2 (1 + f), √½ <= 1 + f < √2: the series of [`ln_tail`] over ln 2.
#[inline(always)]
fn log2_of_one_plus<R: Real>(f: R) -> R {
    let s = f / (R::splat(2.0) + f);
    let z = s * s;
    let w = z * z;
    let even = polynomial!(w; 0.9617966939259855, 0.41219858559594116, 0.2623334938321297, 0.213492877416917);
    let odd = polynomial!(w; 0.5770780163470651, 0.3205985547571299, 0.2209319770562782);
    s.mul_add(R::splat(2.8853900817779268), (s * z) * odd.mul_add(z, even))
}

#[inline(always)]
pub(super) fn sin_cos<R: Real>(x: R) -> (R, R) {
    let shifted = x.mul_add(R::splat(core::f64::consts::FRAC_2_PI), R::splat(ROUND));
    let n = shifted - R::splat(ROUND);
    // Cody and Waite: all exact but the last line, so angles next to a multiple of π/2 keep their relative precision.
    let a = n.mul_add(R::splat(-FRAC_PI_2[0]), x);
    let b = n * R::splat(FRAC_PI_2[1]);
    let difference = a - b;
    let rest = (a - difference) - b;
    let theta = difference + n.mul_add(R::splat(-FRAC_PI_2[2]), rest);
    sin_cos_in_quadrant(theta, shifted.to_bits())
}

#[inline(always)]
pub(super) fn sin_cos_turns<R: Real>(u: R) -> (R, R) {
    let shifted = u.mul_add(R::splat(4.0), R::splat(ROUND));
    let quarters = shifted - R::splat(ROUND);
    let turns = quarters.mul_add(R::splat(-0.25), u);
    let theta = turns.mul_add(R::splat(core::f64::consts::TAU), turns * R::splat(TAU_REST));
    sin_cos_in_quadrant(theta, shifted.to_bits())
}

/// Sine and cosine of `theta + quadrant π/2`, |theta| <= π/4; of `quadrant` only the two lowest bits count.
#[inline(always)]
fn sin_cos_in_quadrant<R: Real>(theta: R, quadrant: R::Bits) -> (R, R) {
    let z = theta * theta;
    let s = polynomial!(z; -0.16666666666666632, 0.00833333333332249, -0.0001984126982985795,
        2.7557313707070068e-6, -2.5050760253406863e-8, 1.58969099521155e-10);
    let c = polynomial!(z; 0.0416666666666666, -0.001388888888887411, 2.480158728947673e-5,
        -2.7557314351390663e-7, 2.087572321298175e-9, -1.1359647557788195e-11);
    let s = (theta * z).mul_add(s, theta);
    let c = (z * z).mul_add(c, z.mul_add(R::splat(-0.5), R::one()));

    let odd = R::from_bits(quadrant.shl::<63>()).is_sign_negative();
    let (sin, cos) = (R::select(odd, c, s), R::select(odd, s, c));
    // Bit 1, moved to the sign: the sine is negative in quadrants 2 and 3, the cosine in 1 and 2.
    let sign = R::Bits::splat(1 << 63);
    let sin_sign = quadrant.shl::<62>() & sign;
    let cos_sign = (quadrant + R::Bits::splat(1)).shl::<62>() & sign;
    (R::from_bits(sin.to_bits() ^ sin_sign), R::from_bits(cos.to_bits() ^ cos_sign))
}

#[cfg(test)]
mod tests;
