//! [`Group`]: several numbers at once through the same formula.
//!
//! One evaluation of a polynomial waits for itself at every step, and loads a constant for every step. A group of
//! independent arguments fills the wait and shares the constants: three powers at once cost little more than two.

use super::real::{Bits, Mask, Real, Work};
use core::ops::{Add, AddAssign, BitAnd, BitOr, BitXor, Div, Mul, MulAssign, Neg, Not, Sub, SubAssign};

/// `N` numbers, masks or integers of the same kind. Lanes are those of the first, then of the second, and so on.
#[derive(Clone, Copy, Debug)]
pub struct Group<T, const N: usize>(pub [T; N]);

/// Applies a method to every member. A loop over indices, which needs no closure to be inlined.
macro_rules! each {
    ($self:expr, $function:ident $(::<$generic:ident>)? $(, $other:expr)*) => {{
        let mut result = $self.0;
        for i in 0..N {
            result[i] = result[i].$function$(::<$generic>)?($($other.0[i]),*);
        }
        Group(result)
    }};
}

/// The same, where the members of the result are of another kind.
macro_rules! each_into {
    ($kind:ty, $first:expr; $i:ident => $member:expr) => {{
        let mut result: [$kind; N] = [$first; N];
        for $i in 0..N {
            result[$i] = $member;
        }
        Group(result)
    }};
}

macro_rules! operators {
    ($($trait:ident $function:ident),*) => {$(
        impl<T: Copy + $trait<Output = T>, const N: usize> $trait for Group<T, N> {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                each!(self, $function, other)
            }
        }
    )*};
}
operators!(Add add, Sub sub, Mul mul, Div div, BitAnd bitand, BitOr bitor, BitXor bitxor);

macro_rules! prefixes {
    ($($trait:ident $function:ident),*) => {$(
        impl<T: Copy + $trait<Output = T>, const N: usize> $trait for Group<T, N> {
            type Output = Self;
            #[inline(always)]
            fn $function(self) -> Self {
                each!(self, $function)
            }
        }
    )*};
}
prefixes!(Neg neg, Not not);

macro_rules! assignments {
    ($($trait:ident $function:ident $operator:tt),*) => {$(
        impl<T: Real, const N: usize> $trait for Group<T, N> {
            #[inline(always)]
            fn $function(&mut self, other: Self) {
                *self = *self $operator other;
            }
        }
    )*};
}
assignments!(AddAssign add_assign +, SubAssign sub_assign -, MulAssign mul_assign *);

impl<T: Mask, const N: usize> Mask for Group<T, N> {
    const LANES: usize = N * T::LANES;
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self([T::splat(value); N])
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.0.iter().any(|mask| mask.any())
    }
    #[inline(always)]
    fn all(self) -> bool {
        self.0.iter().all(|mask| mask.all())
    }
    #[inline(always)]
    fn lane(self, i: usize) -> bool {
        self.0[i / T::LANES].lane(i % T::LANES)
    }
}

impl<T: Bits, const N: usize> Bits for Group<T, N> {
    const LANES: usize = N * T::LANES;
    #[inline(always)]
    fn splat(value: u64) -> Self {
        Self([T::splat(value); N])
    }
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> u64) -> Self {
        each_into!(T, T::splat(0); i => T::from_fn(|j| f(i * T::LANES + j)))
    }
    #[inline(always)]
    fn lane(self, i: usize) -> u64 {
        self.0[i / T::LANES].lane(i % T::LANES)
    }
    #[inline(always)]
    fn set_lane(&mut self, i: usize, value: u64) {
        self.0[i / T::LANES].set_lane(i % T::LANES, value);
    }
    #[inline(always)]
    fn shl<const S: u32>(self) -> Self {
        each!(self, shl::<S>)
    }
    #[inline(always)]
    fn shr<const S: u32>(self) -> Self {
        each!(self, shr::<S>)
    }
    #[inline(always)]
    fn mul_low32(self, other: Self) -> Self {
        each!(self, mul_low32, other)
    }
}

impl<T: Real, const N: usize> Real for Group<T, N> {
    const LANES: usize = N * T::LANES;
    const FUSED: bool = T::FUSED;
    type Mask = Group<T::Mask, N>;
    type Bits = Group<T::Bits, N>;

    #[inline(always)]
    fn apart<W: Work>(work: W) -> W::Output {
        T::apart(work)
    }

    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self([T::splat(x); N])
    }
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> f64) -> Self {
        each_into!(T, T::zero(); i => T::from_fn(|j| f(i * T::LANES + j)))
    }
    #[inline(always)]
    fn lane(self, i: usize) -> f64 {
        self.0[i / T::LANES].lane(i % T::LANES)
    }
    #[inline(always)]
    fn set_lane(&mut self, i: usize, x: f64) {
        self.0[i / T::LANES].set_lane(i % T::LANES, x);
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        each!(self, mul_add, a, b)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        each!(self, sqrt)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        each!(self, abs)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        each!(self, min, other)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        each!(self, max, other)
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        each!(self, copysign, sign)
    }
    #[inline(always)]
    fn is_sign_negative(self) -> Self::Mask {
        each_into!(T::Mask, T::Mask::splat(false); i => self.0[i].is_sign_negative())
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        each_into!(T::Mask, T::Mask::splat(false); i => self.0[i].lt(other.0[i]))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        each_into!(T::Mask, T::Mask::splat(false); i => self.0[i].le(other.0[i]))
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        each_into!(T, T::zero(); i => T::select(mask.0[i], yes.0[i], no.0[i]))
    }
    #[inline(always)]
    fn to_bits(self) -> Self::Bits {
        each_into!(T::Bits, T::Bits::splat(0); i => self.0[i].to_bits())
    }
    #[inline(always)]
    fn from_bits(bits: Self::Bits) -> Self {
        each_into!(T, T::zero(); i => T::from_bits(bits.0[i]))
    }
}
