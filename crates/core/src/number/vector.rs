//! [`Vec3`]: three components in some frame.

use super::group::Group;
use super::matrix::Mat3;
use super::real::Real;
use core::ops::{Add, AddAssign, Div, Index, Mul, Neg, Sub, SubAssign};

/// A vector of three components. `*` and `/` between vectors work component by component, as gains per axis do.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
pub struct Vec3<R>(pub [R; 3]);

/// A vector from an expression in the index of its component.
macro_rules! each {
    ($i:ident => $e:expr) => {
        Vec3([
            { const $i: usize = 0; $e },
            { const $i: usize = 1; $e },
            { const $i: usize = 2; $e },
        ])
    };
}

impl<R> Index<usize> for Vec3<R> {
    type Output = R;
    #[inline(always)]
    fn index(&self, i: usize) -> &R {
        &self.0[i]
    }
}

impl<R: Real> Vec3<R> {
    /// The same number in every component.
    #[inline(always)]
    pub fn splat(x: R) -> Self {
        Self([x; 3])
    }
    /// The zero vector.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::splat(R::zero())
    }
    /// The same vector in every lane.
    #[inline(always)]
    pub fn from_f64(v: [f64; 3]) -> Self {
        each!(I => R::splat(v[I]))
    }
    /// Lane `i` holds `f(i)`. `f` is called once for each lane and component.
    #[inline(always)]
    pub fn from_lanes(f: impl Fn(usize) -> Vec3<f64>) -> Self {
        each!(I => R::from_fn(|lane| f(lane)[I]))
    }
    /// The vector of lane `i`.
    #[inline(always)]
    pub fn lane(self, i: usize) -> Vec3<f64> {
        each!(I => self[I].lane(i))
    }
    /// Gives lane `i` another vector.
    #[inline(always)]
    pub fn set_lane(&mut self, i: usize, v: Vec3<f64>) {
        for k in 0..3 {
            self.0[k].set_lane(i, v.0[k]);
        }
    }
    /// `yes` in lanes where the mask holds, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        each!(I => R::select(mask, yes[I], no[I]))
    }

    /// Scalar product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> R {
        self[0].mul_add(other[0], self[1].mul_add(other[1], self[2] * other[2]))
    }
    /// Vector product.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        let (a, b) = (self, other);
        Self([
            a[1].mul_add(b[2], -(a[2] * b[1])),
            a[2].mul_add(b[0], -(a[0] * b[2])),
            a[0].mul_add(b[1], -(a[1] * b[0])),
        ])
    }
    /// Outer product `self otherᵀ`.
    #[inline(always)]
    pub fn outer(self, other: Self) -> Mat3<R> {
        Mat3([(other * self[0]).0, (other * self[1]).0, (other * self[2]).0])
    }
    /// Square of the length.
    #[inline(always)]
    pub fn norm_squared(self) -> R {
        self.dot(self)
    }
    /// Length.
    #[inline(always)]
    pub fn norm(self) -> R {
        self.norm_squared().sqrt()
    }
    /// Sum of the components.
    #[inline(always)]
    pub fn sum(self) -> R {
        self[0] + self[1] + self[2]
    }
    /// Greatest component; NaN if the first is NaN, which [`Real::max`] passes over in the others.
    #[inline(always)]
    pub fn max_component(self) -> R {
        self[0].max(self[1]).max(self[2])
    }

    /// `self * a + b`, component by component.
    #[inline(always)]
    pub fn mul_add(self, a: Self, b: Self) -> Self {
        each!(I => self[I].mul_add(a[I], b[I]))
    }
    /// Magnitude of each component.
    #[inline(always)]
    pub fn abs(self) -> Self {
        each!(I => self[I].abs())
    }
    /// Each component to the power `exponent`; see [`Real::powf`].
    #[inline(always)]
    pub fn powf(self, exponent: R) -> Self {
        Self(Group(self.0).powf(Group([exponent; 3])).0)
    }
    /// -1, 0 or 1 with the sign of each component; see [`Real::signum0`].
    #[inline(always)]
    pub fn signum0(self) -> Self {
        each!(I => self[I].signum0())
    }
    /// Each component held within [-1, 1].
    #[inline(always)]
    pub fn clamp_unit(self) -> Self {
        each!(I => self[I].clamp_unit())
    }
    /// Each component held within its own limits.
    #[inline(always)]
    pub fn clamp(self, lo: Self, hi: Self) -> Self {
        each!(I => self[I].clamp(lo[I], hi[I]))
    }
    /// The lesser of each pair of components; see [`Real::min`].
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        each!(I => self[I].min(other[I]))
    }
    /// The greater of each pair of components; see [`Real::max`].
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        each!(I => self[I].max(other[I]))
    }
}

impl<R: Real> Add for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        each!(I => self[I] + other[I])
    }
}

impl<R: Real> Sub for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        each!(I => self[I] - other[I])
    }
}

impl<R: Real> Neg for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        each!(I => -self[I])
    }
}

impl<R: Real> Mul<R> for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, scale: R) -> Self {
        each!(I => self[I] * scale)
    }
}

impl<R: Real> Mul for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        each!(I => self[I] * other[I])
    }
}

impl<R: Real> Div for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        each!(I => self[I] / other[I])
    }
}

impl<R: Real> AddAssign for Vec3<R> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<R: Real> SubAssign for Vec3<R> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: Vec3<f64> = Vec3([1.0, -2.0, 3.0]);
    const B: Vec3<f64> = Vec3([4.0, 0.5, -6.0]);

    #[test]
    fn products_have_their_known_values() {
        assert_eq!(A.dot(B), -15.0);
        assert_eq!(A.cross(B), Vec3([10.5, 18.0, 8.5]));
        assert_eq!(A * B, Vec3([4.0, -1.0, -18.0]));
        assert_eq!(A / B, Vec3([0.25, -4.0, -0.5]));
        assert_eq!(A * 2.0, Vec3([2.0, -4.0, 6.0]));
        assert_eq!(A.mul_add(B, A), Vec3([5.0, -3.0, -15.0]));
        assert_eq!(A.outer(B) * A, A * B.dot(A));
    }

    #[test]
    fn cross_product_is_orthogonal_to_both_and_turns_with_the_right_hand() {
        assert_eq!(A.cross(B).dot(A), 0.0);
        assert_eq!(A.cross(B).dot(B), 0.0);
        let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vec3::<f64>::from_f64);
        assert_eq!((x.cross(y), y.cross(z), z.cross(x)), (z, x, y));
    }

    #[test]
    fn component_functions_work_component_by_component() {
        let v = Vec3([-4.0, 0.0, 0.25]);
        assert_eq!(v.signum0(), Vec3([-1.0, 0.0, 1.0]));
        assert_eq!(v.clamp_unit(), Vec3([-1.0, 0.0, 0.25]));
        assert_eq!(v.clamp(A, B), Vec3([1.0, 0.0, -6.0]));
        assert_eq!((v.min(A), v.max(A)), (Vec3([-4.0, -2.0, 0.25]), Vec3([1.0, 0.0, 3.0])));
        assert_eq!((v.sum(), A.max_component()), (-3.75, 3.0));
        assert_eq!((v + A - A, -(-v)), (v, v));
        let root = v.abs().powf(0.5);
        assert!((root - Vec3([2.0, 0.0, 0.5])).norm() < 1e-15);
        assert_eq!(Vec3([3.0, 4.0, 12.0]).norm(), 13.0);
        assert_eq!((Vec3::select(true, A, B), Vec3::select(false, A, B)), (A, B));
        assert_eq!(Vec3::<f64>::from_lanes(|_| A).lane(0), A);
    }
}
