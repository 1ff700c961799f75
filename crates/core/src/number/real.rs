//! [`Real`]: what a number must be able to do to fly through the closed loop.

use super::elementary;
use core::ops::{Add, AddAssign, BitAnd, BitOr, BitXor, Div, Mul, MulAssign, Neg, Not, Sub, SubAssign};

/// One truth value per lane.
pub trait Mask: Copy + 'static + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// Truth values held side by side.
    const LANES: usize;
    /// The same value in every lane.
    fn splat(value: bool) -> Self;
    /// Whether at least one lane holds.
    fn any(self) -> bool;
    /// Whether every lane holds.
    fn all(self) -> bool;
    /// The value of lane `i`.
    fn lane(self, i: usize) -> bool;
}

/// One unsigned 64-bit integer per lane. Arithmetic wraps.
pub trait Bits:
    Copy
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
{
    /// Integers held side by side.
    const LANES: usize;
    /// The same integer in every lane.
    fn splat(value: u64) -> Self;
    /// Lane `i` holds `f(i)`.
    fn from_fn(f: impl FnMut(usize) -> u64) -> Self;
    /// The integer of lane `i`.
    fn lane(self, i: usize) -> u64;
    /// Gives lane `i` another integer.
    fn set_lane(&mut self, i: usize, value: u64);
    /// Shift left by `N` < 64 bits.
    fn shl<const N: u32>(self) -> Self;
    /// Shift right by `N` < 64 bits, filling with zeros.
    fn shr<const N: u32>(self) -> Self;
    /// 64-bit product of the low 32 bits of both; the high halves are not read.
    fn mul_low32(self, other: Self) -> Self;
}

/// Work on numbers of one type: a closure whose attributes can be trusted.
pub trait Work {
    /// What the work results in.
    type Output;
    /// Does the work. Mark the implementation `#[inline(always)]`, and all it calls that touches a [`Real`].
    fn run(self) -> Self::Output;
}

/// A real number, or several in lockstep: `f64`, or SIMD lanes of `f64`.
///
/// Operations work lane by lane and mean the same on every type, bit for bit, with one exception: [`Real::mul_add`]
/// rounds once where the hardware has it, else twice. NaN is never hidden: a trajectory that has become non-finite stays visible.
pub trait Real:
    Copy
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
{
    /// Trajectories held side by side.
    const LANES: usize;
    /// Whether [`Real::mul_add`] rounds only once.
    const FUSED: bool;
    /// Result of comparisons.
    type Mask: Mask;
    /// The lanes as 64-bit integers.
    type Bits: Bits;

    /// Does work in a function of its own, with the instructions of this type: for what the loop seldom does.
    fn apart<W: Work>(work: W) -> W::Output;

    /// The same number in every lane.
    fn splat(x: f64) -> Self;
    /// Lane `i` holds `f(i)`.
    fn from_fn(f: impl FnMut(usize) -> f64) -> Self;
    /// The number of lane `i`.
    fn lane(self, i: usize) -> f64;
    /// Gives lane `i` another number.
    fn set_lane(&mut self, i: usize, x: f64);
    /// `self * a + b`.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// Square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// `other` if it is less, else `self`; so NaN in `self` stays, NaN in `other` is passed over.
    fn min(self, other: Self) -> Self;
    /// `other` if it is greater, else `self`; so NaN in `self` stays, NaN in `other` is passed over.
    fn max(self, other: Self) -> Self;
    /// Magnitude of `self` with the sign of `sign`.
    fn copysign(self, sign: Self) -> Self;
    /// Whether the sign bit is set: true of -0.0, and of some NaN.
    fn is_sign_negative(self) -> Self::Mask;
    /// `self < other`; false for NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`; false for NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// `yes` in lanes where the mask holds, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// The IEEE 754 encoding.
    fn to_bits(self) -> Self::Bits;
    /// The number with this IEEE 754 encoding.
    fn from_bits(bits: Self::Bits) -> Self;

    /// The low 32 bits of each lane as a number, exactly.
    #[inline(always)]
    fn from_u32(bits: Self::Bits) -> Self {
        // Laid into the mantissa of 2^52 the integer needs no conversion instruction, which AVX2 lacks.
        const TWO_52: f64 = (1u64 << 52) as f64;
        let mantissa = bits & Self::Bits::splat(u32::MAX as u64);
        Self::from_bits(mantissa | Self::Bits::splat(TWO_52.to_bits())) - Self::splat(TWO_52)
    }
    /// 0.
    #[inline(always)]
    fn zero() -> Self {
        Self::splat(0.0)
    }
    /// 1.
    #[inline(always)]
    fn one() -> Self {
        Self::splat(1.0)
    }
    /// The nearest number in `[lo, hi]`; NaN stays NaN.
    #[inline(always)]
    fn clamp(self, lo: Self, hi: Self) -> Self {
        self.max(lo).min(hi)
    }
    /// The nearest number in [-1, 1]: the saturation function of sliding-mode control. NaN stays NaN.
    #[inline(always)]
    fn clamp_unit(self) -> Self {
        self.clamp(-Self::one(), Self::one())
    }
    /// -1, 0 or 1 with the sign of `self`: 0 at 0, unlike [`f64::signum`]. NaN stays NaN.
    #[inline(always)]
    fn signum0(self) -> Self {
        Self::select(Self::zero().lt(self.abs()), Self::one().copysign(self), self)
    }
    /// Neither NaN nor infinite.
    #[inline(always)]
    fn is_finite(self) -> Self::Mask {
        self.abs().lt(Self::splat(f64::INFINITY))
    }
    /// e to the power `self`, held within [exp(-708), exp(708)]: neither overflows nor vanishes.
    #[inline(always)]
    fn exp(self) -> Self {
        elementary::exp(self)
    }
    /// Natural logarithm: -∞ from 0 up to the smallest normal number, NaN below 0, +∞ of +∞.
    #[inline(always)]
    fn ln(self) -> Self {
        elementary::ln(self)
    }
    /// `self` to the power `exponent`, for `self` >= 0 and |`exponent`| <= 1e9. Like [`Real::exp`] it saturates near exp(±708).
    ///
    /// Bases below the smallest normal number, 2.2e-308, count as that number: 0^a is tiny, not 0, for a > 0. ∞^a = ∞ for
    /// a > 0, x^0 = 1 for finite x. NaN in either stays NaN.
    #[inline(always)]
    fn powf(self, exponent: Self) -> Self {
        elementary::powf(self, exponent)
    }
    /// Sine and cosine of `self` in radians, for |`self`| <= 1e4.
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        elementary::sin_cos(self)
    }
    /// Sine and cosine of 2π `self`, for |`self`| <= 1e4: an angle counted in turns needs no reduction by an inexact π.
    #[inline(always)]
    fn sin_cos_turns(self) -> (Self, Self) {
        elementary::sin_cos_turns(self)
    }
}
