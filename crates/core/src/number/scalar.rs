//! `f64` as a [`Real`]: one trajectory, on any machine.

use super::real::{Bits, Mask, Real, Work};
use core::num::Wrapping;

impl Mask for bool {
    const LANES: usize = 1;
    #[inline(always)]
    fn splat(value: bool) -> Self {
        value
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn all(self) -> bool {
        self
    }
    #[inline(always)]
    fn lane(self, _: usize) -> bool {
        self
    }
}

impl Bits for Wrapping<u64> {
    const LANES: usize = 1;
    #[inline(always)]
    fn splat(value: u64) -> Self {
        Wrapping(value)
    }
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> u64) -> Self {
        Wrapping(f(0))
    }
    #[inline(always)]
    fn lane(self, _: usize) -> u64 {
        self.0
    }
    #[inline(always)]
    fn set_lane(&mut self, _: usize, value: u64) {
        self.0 = value;
    }
    #[inline(always)]
    fn shl<const N: u32>(self) -> Self {
        Wrapping(self.0 << N)
    }
    #[inline(always)]
    fn shr<const N: u32>(self) -> Self {
        Wrapping(self.0 >> N)
    }
    #[inline(always)]
    fn mul_low32(self, other: Self) -> Self {
        Wrapping((self.0 & u32::MAX as u64) * (other.0 & u32::MAX as u64))
    }
}

impl Real for f64 {
    const LANES: usize = 1;
    // Without the instruction f64::mul_add calls a software routine of some fifty times the cost.
    const FUSED: bool = cfg!(any(target_feature = "fma", target_arch = "aarch64"));
    type Mask = bool;
    type Bits = Wrapping<u64>;

    #[inline(never)]
    fn apart<W: Work>(work: W) -> W::Output {
        work.run()
    }
    #[inline(always)]
    fn splat(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> f64) -> Self {
        f(0)
    }
    #[inline(always)]
    fn lane(self, _: usize) -> f64 {
        self
    }
    #[inline(always)]
    fn set_lane(&mut self, _: usize, x: f64) {
        *self = x;
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        if Self::FUSED { f64::mul_add(self, a, b) } else { self * a + b }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        f64::copysign(self, sign)
    }
    #[inline(always)]
    fn is_sign_negative(self) -> bool {
        f64::is_sign_negative(self)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self <= other
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn to_bits(self) -> Wrapping<u64> {
        Wrapping(f64::to_bits(self))
    }
    #[inline(always)]
    fn from_bits(bits: Wrapping<u64>) -> Self {
        f64::from_bits(bits.0)
    }
}
