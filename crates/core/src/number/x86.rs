//! Lanes on x86-64: [`F64x4`] (AVX2 + FMA) and [`F64x8`] (AVX-512).
//!
//! Sound because no safe code outside `number` can name these types: they are met only as the `R` of a [`super::Job`], and
//! `dispatch` runs a job with them only after the CPU was seen to have the instructions. So wherever a value
//! of these types exists, or one of their functions runs, the instructions exist too.
#![allow(unsafe_code)]

use super::real::{Bits, Mask, Real, Work};
use core::arch::x86_64::*;
use core::mem::transmute;
use core::ops::{Add, AddAssign, BitAnd, BitOr, BitXor, Div, Mul, MulAssign, Neg, Not, Sub, SubAssign};

/// Evaluates an expression of intrinsics, or a transmute between a vector and the array of its lanes, by value or by reference.
macro_rules! on_cpu {
    ($e:expr) => {
        // SAFETY: this runs only after `dispatch` saw that the CPU has the instructions (module doc);
        // the transmutes are between plain data of one size, and every bit pattern is valid; a vector is aligned
        // more strictly than the array of its lanes.
        unsafe { $e }
    };
}

/// `impl Operator for Type` from one binary intrinsic.
macro_rules! binary {
    ($type:ident: $($operator:ident::$method:ident = $intrinsic:ident),+) => {$(
        impl $operator for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(on_cpu!($intrinsic(self.0, other.0)))
            }
        }
    )+};
}

/// `impl OperatorAssign for Type` from the operator.
macro_rules! assign {
    ($type:ident: $($operator:ident::$method:ident = $symbol:tt),+) => {$(
        impl $operator for $type {
            #[inline(always)]
            fn $method(&mut self, other: Self) {
                *self = *self $symbol other;
            }
        }
    )+};
}

/// A lane type and its integers, from the table of the intrinsics that differ in name between vector widths.
macro_rules! lanes {
    (
        $(#[$doc:meta])*
        $float:ident($vector:ty), $bits:ident($integers:ty), $mask:ident, $lanes:literal, $features:literal,
        set1: $set1:ident, add: $add:ident, sub: $sub:ident, mul: $mul:ident, div: $div:ident,
        fmadd: $fmadd:ident, sqrt: $sqrt:ident, min: $min:ident, max: $max:ident, cmp: $cmp:ident,
        to_bits: $to_bits:ident, from_bits: $from_bits:ident,
        set1_int: $set1_int:ident, add_int: $add_int:ident, sub_int: $sub_int:ident, mul_low: $mul_low:ident,
        and: $and:ident, or: $or:ident, xor: $xor:ident, shl: $shl:ident, shr: $shr:ident,
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $float($vector);

        /// The lanes as integers.
        #[derive(Clone, Copy, Debug)]
        pub struct $bits($integers);

        binary!($float: Add::add = $add, Sub::sub = $sub, Mul::mul = $mul, Div::div = $div);
        assign!($float: AddAssign::add_assign = +, SubAssign::sub_assign = -, MulAssign::mul_assign = *);
        binary!($bits: Add::add = $add_int, Sub::sub = $sub_int);
        binary!($bits: BitAnd::bitand = $and, BitOr::bitor = $or, BitXor::bitxor = $xor);

        impl Neg for $float {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self::from_bits(self.to_bits() ^ $bits::splat(SIGN))
            }
        }

        impl Bits for $bits {
            const LANES: usize = $lanes;
            #[inline(always)]
            fn splat(value: u64) -> Self {
                Self(on_cpu!($set1_int(value as i64)))
            }
            #[inline(always)]
            fn from_fn(f: impl FnMut(usize) -> u64) -> Self {
                let lanes: [u64; $lanes] = core::array::from_fn(f);
                Self(on_cpu!(transmute::<[u64; $lanes], $integers>(lanes)))
            }
            #[inline(always)]
            fn lane(self, i: usize) -> u64 {
                on_cpu!(transmute::<$integers, [u64; $lanes]>(self.0))[i]
            }
            #[inline(always)]
            fn set_lane(&mut self, i: usize, value: u64) {
                on_cpu!(transmute::<&mut $integers, &mut [u64; $lanes]>(&mut self.0))[i] = value;
            }
            #[inline(always)]
            fn shl<const N: u32>(self) -> Self {
                Self(on_cpu!($shl(self.0, _mm_cvtsi32_si128(N as i32))))
            }
            #[inline(always)]
            fn shr<const N: u32>(self) -> Self {
                Self(on_cpu!($shr(self.0, _mm_cvtsi32_si128(N as i32))))
            }
            #[inline(always)]
            fn mul_low32(self, other: Self) -> Self {
                Self(on_cpu!($mul_low(self.0, other.0)))
            }
        }

        impl Real for $float {
            const LANES: usize = $lanes;
            const FUSED: bool = true;
            type Mask = $mask;
            type Bits = $bits;

            #[inline(always)]
            fn apart<W: Work>(work: W) -> W::Output {
                #[inline(never)]
                #[target_feature(enable = $features)]
                fn with_instructions<W: Work>(work: W) -> W::Output {
                    work.run()
                }
                on_cpu!(with_instructions(work))
            }
            #[inline(always)]
            fn splat(x: f64) -> Self {
                Self(on_cpu!($set1(x)))
            }
            #[inline(always)]
            fn from_fn(f: impl FnMut(usize) -> f64) -> Self {
                let lanes: [f64; $lanes] = core::array::from_fn(f);
                Self(on_cpu!(transmute::<[f64; $lanes], $vector>(lanes)))
            }
            #[inline(always)]
            fn lane(self, i: usize) -> f64 {
                on_cpu!(transmute::<$vector, [f64; $lanes]>(self.0))[i]
            }
            #[inline(always)]
            fn set_lane(&mut self, i: usize, x: f64) {
                on_cpu!(transmute::<&mut $vector, &mut [f64; $lanes]>(&mut self.0))[i] = x;
            }
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                Self(on_cpu!($fmadd(self.0, a.0, b.0)))
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Self(on_cpu!($sqrt(self.0)))
            }
            #[inline(always)]
            fn abs(self) -> Self {
                Self::from_bits(self.to_bits() & $bits::splat(!SIGN))
            }
            // The instructions return their second operand when the comparison fails, NaN included.
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                Self(on_cpu!($min(other.0, self.0)))
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                Self(on_cpu!($max(other.0, self.0)))
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                let magnitude = self.to_bits() & $bits::splat(!SIGN);
                Self::from_bits(magnitude | (sign.to_bits() & $bits::splat(SIGN)))
            }
            #[inline(always)]
            fn is_sign_negative(self) -> $mask {
                $mask::of_signs(self.0)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> $mask {
                $mask(on_cpu!($cmp::<_CMP_LT_OQ>(self.0, other.0)))
            }
            #[inline(always)]
            fn le(self, other: Self) -> $mask {
                $mask(on_cpu!($cmp::<_CMP_LE_OQ>(self.0, other.0)))
            }
            #[inline(always)]
            fn select(mask: $mask, yes: Self, no: Self) -> Self {
                Self(mask.blend(yes.0, no.0))
            }
            #[inline(always)]
            fn to_bits(self) -> $bits {
                $bits(on_cpu!($to_bits(self.0)))
            }
            #[inline(always)]
            fn from_bits(bits: $bits) -> Self {
                Self(on_cpu!($from_bits(bits.0)))
            }
        }
    };
}

const SIGN: u64 = 1 << 63;

lanes! {
    /// Four trajectories: AVX2 and FMA.
    F64x4(__m256d), U64x4(__m256i), Mask4, 4, "avx2,fma,bmi2",
    set1: _mm256_set1_pd, add: _mm256_add_pd, sub: _mm256_sub_pd, mul: _mm256_mul_pd, div: _mm256_div_pd,
    fmadd: _mm256_fmadd_pd, sqrt: _mm256_sqrt_pd, min: _mm256_min_pd, max: _mm256_max_pd, cmp: _mm256_cmp_pd,
    to_bits: _mm256_castpd_si256, from_bits: _mm256_castsi256_pd,
    set1_int: _mm256_set1_epi64x, add_int: _mm256_add_epi64, sub_int: _mm256_sub_epi64, mul_low: _mm256_mul_epu32,
    and: _mm256_and_si256, or: _mm256_or_si256, xor: _mm256_xor_si256, shl: _mm256_sll_epi64, shr: _mm256_srl_epi64,
}

lanes! {
    /// Eight trajectories: AVX-512.
    F64x8(__m512d), U64x8(__m512i), Mask8, 8, "avx512f,avx512dq,avx512vl,avx512bw,avx2,fma,bmi2",
    set1: _mm512_set1_pd, add: _mm512_add_pd, sub: _mm512_sub_pd, mul: _mm512_mul_pd, div: _mm512_div_pd,
    fmadd: _mm512_fmadd_pd, sqrt: _mm512_sqrt_pd, min: _mm512_min_pd, max: _mm512_max_pd, cmp: _mm512_cmp_pd_mask,
    to_bits: _mm512_castpd_si512, from_bits: _mm512_castsi512_pd,
    set1_int: _mm512_set1_epi64, add_int: _mm512_add_epi64, sub_int: _mm512_sub_epi64, mul_low: _mm512_mul_epu32,
    and: _mm512_and_si512, or: _mm512_or_si512, xor: _mm512_xor_si512, shl: _mm512_sll_epi64, shr: _mm512_srl_epi64,
}

/// AVX2 has no mask registers: a lane holds where its sign bit is set, and no other bit is looked at.
#[derive(Clone, Copy, Debug)]
pub struct Mask4(__m256d);

binary!(Mask4: BitAnd::bitand = _mm256_and_pd, BitOr::bitor = _mm256_or_pd);

impl Mask4 {
    #[inline(always)]
    fn of_signs(vector: __m256d) -> Self {
        Self(vector)
    }
    #[inline(always)]
    fn blend(self, yes: __m256d, no: __m256d) -> __m256d {
        on_cpu!(_mm256_blendv_pd(no, yes, self.0))
    }
    #[inline(always)]
    fn to_u8(self) -> u8 {
        on_cpu!(_mm256_movemask_pd(self.0)) as u8
    }
}

impl Not for Mask4 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self((-F64x4(self.0)).0)
    }
}

impl Mask for Mask4 {
    const LANES: usize = 4;
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self(F64x4::splat(if value { -0.0 } else { 0.0 }).0)
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.to_u8() != 0
    }
    #[inline(always)]
    fn all(self) -> bool {
        self.to_u8() == 0b1111
    }
    #[inline(always)]
    fn lane(self, i: usize) -> bool {
        self.to_u8() >> i & 1 != 0
    }
}

/// One bit per lane, in a mask register.
#[derive(Clone, Copy, Debug)]
pub struct Mask8(__mmask8);

impl Mask8 {
    #[inline(always)]
    fn of_signs(vector: __m512d) -> Self {
        Self(on_cpu!(_mm512_movepi64_mask(_mm512_castpd_si512(vector))))
    }
    #[inline(always)]
    fn blend(self, yes: __m512d, no: __m512d) -> __m512d {
        on_cpu!(_mm512_mask_blend_pd(self.0, no, yes))
    }
}

impl BitAnd for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl Not for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl Mask for Mask8 {
    const LANES: usize = 8;
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self(if value { u8::MAX } else { 0 })
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.0 != 0
    }
    #[inline(always)]
    fn all(self) -> bool {
        self.0 == u8::MAX
    }
    #[inline(always)]
    fn lane(self, i: usize) -> bool {
        self.0 >> i & 1 != 0
    }
}
