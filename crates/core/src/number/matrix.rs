//! [`Mat3`]: inertia tensors, rotations, covariances.

use super::real::Real;
use super::vector::Vec3;
use core::ops::{Add, Mul, Sub};

/// A 3 × 3 matrix, by rows.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
pub struct Mat3<R>(pub [[R; 3]; 3]);

/// A matrix from an expression in the index of its row, giving the row as a vector.
macro_rules! rows {
    ($i:ident => $e:expr) => {
        Mat3([
            { const $i: usize = 0; $e.0 },
            { const $i: usize = 1; $e.0 },
            { const $i: usize = 2; $e.0 },
        ])
    };
}

impl<R: Real> Mat3<R> {
    /// The zero matrix.
    #[inline(always)]
    pub fn zero() -> Self {
        Self([[R::zero(); 3]; 3])
    }
    /// The identity.
    #[inline(always)]
    pub fn identity() -> Self {
        Self::from_scale(R::one())
    }
    /// The identity times a number.
    #[inline(always)]
    pub fn from_scale(scale: R) -> Self {
        Self::diagonal(Vec3::splat(scale))
    }
    /// These numbers on the diagonal, zeros elsewhere.
    #[inline(always)]
    pub fn diagonal(d: Vec3<R>) -> Self {
        let o = R::zero();
        Self([[d[0], o, o], [o, d[1], o], [o, o, d[2]]])
    }
    /// The same matrix in every lane.
    #[inline(always)]
    pub fn from_f64(m: [[f64; 3]; 3]) -> Self {
        rows!(I => Vec3::from_f64(m[I]))
    }
    /// Lane `i` holds `f(i)`. `f` is called once for each lane and element.
    #[inline(always)]
    pub fn from_lanes(f: impl Fn(usize) -> Mat3<f64>) -> Self {
        rows!(I => Vec3::from_lanes(|lane| f(lane).row(I)))
    }
    /// The matrix of lane `i`.
    #[inline(always)]
    pub fn lane(self, i: usize) -> Mat3<f64> {
        rows!(I => self.row(I).lane(i))
    }
    /// Gives lane `i` another matrix.
    #[inline(always)]
    pub fn set_lane(&mut self, i: usize, m: Mat3<f64>) {
        for (row, new) in self.0.iter_mut().zip(m.0) {
            for (element, new) in row.iter_mut().zip(new) {
                element.set_lane(i, new);
            }
        }
    }
    /// `yes` in lanes where the mask holds, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        rows!(I => Vec3::select(mask, yes.row(I), no.row(I)))
    }

    /// Row `i`.
    #[inline(always)]
    pub fn row(self, i: usize) -> Vec3<R> {
        Vec3(self.0[i])
    }
    /// Rows and columns exchanged.
    #[inline(always)]
    pub fn transpose(self) -> Self {
        let m = self.0;
        Self([[m[0][0], m[1][0], m[2][0]], [m[0][1], m[1][1], m[2][1]], [m[0][2], m[1][2], m[2][2]]])
    }
    /// Every element times a number.
    #[inline(always)]
    pub fn scale(self, scale: R) -> Self {
        rows!(I => self.row(I) * scale)
    }
    /// `selfᵀ v`.
    #[inline(always)]
    pub fn transposed_mul(self, v: Vec3<R>) -> Vec3<R> {
        let last = self.row(2) * v[2];
        let last = self.row(1).mul_add(Vec3::splat(v[1]), last);
        self.row(0).mul_add(Vec3::splat(v[0]), last)
    }
    /// The diagonal.
    #[inline(always)]
    pub fn diagonal_part(self) -> Vec3<R> {
        Vec3([self.0[0][0], self.0[1][1], self.0[2][2]])
    }

    /// Sum of the diagonal.
    #[inline(always)]
    pub fn trace(self) -> R {
        self.0[0][0] + self.0[1][1] + self.0[2][2]
    }
    /// Determinant: the volume spanned by the rows.
    #[inline(always)]
    pub fn determinant(self) -> R {
        self.row(0).dot(self.row(1).cross(self.row(2)))
    }
    /// Inverse: the adjugate over the determinant. Not finite if the matrix is singular.
    #[inline(always)]
    pub fn inverse(self) -> Self {
        let [a, b, c] = [self.row(0), self.row(1), self.row(2)];
        let adjugate = Self([b.cross(c).0, c.cross(a).0, a.cross(b).0]).transpose();
        adjugate.scale(R::one() / self.determinant())
    }
}

impl<R: Real> Mul<Vec3<R>> for Mat3<R> {
    type Output = Vec3<R>;
    #[inline(always)]
    fn mul(self, v: Vec3<R>) -> Vec3<R> {
        Vec3([self.row(0).dot(v), self.row(1).dot(v), self.row(2).dot(v)])
    }
}

impl<R: Real> Mul for Mat3<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        rows!(I => other.transposed_mul(self.row(I)))
    }
}

impl<R: Real> Add for Mat3<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        rows!(I => (self.row(I) + other.row(I)))
    }
}

impl<R: Real> Sub for Mat3<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        rows!(I => (self.row(I) - other.row(I)))
    }
}

impl Mat3<f64> {
    /// Whether everything off the diagonal is zero.
    pub fn is_diagonal(&self) -> bool {
        let m = self.0;
        [m[0][1], m[0][2], m[1][0], m[1][2], m[2][0], m[2][1]] == [0.0; 6]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const M: Mat3<f64> = Mat3([[2.0, -1.0, 0.5], [0.0, 3.0, 1.0], [4.0, 1.0, -2.0]]);
    const V: Vec3<f64> = Vec3([1.0, 2.0, -4.0]);

    #[test]
    fn products_have_their_known_values() {
        assert_eq!(M * V, Vec3([-2.0, 2.0, 14.0]));
        assert_eq!(M.transposed_mul(V), M.transpose() * V);
        assert_eq!((M * M) * V, M * (M * V));
        assert_eq!(M * Mat3::identity(), M);
        assert_eq!((M.trace(), M.determinant()), (3.0, -24.0));
        assert_eq!(Mat3::diagonal(V) * V, V * V);
        assert_eq!(M + M - M.scale(2.0), Mat3::zero());
    }

    #[test]
    fn inverse_undoes() {
        for product in [M * M.inverse(), M.inverse() * M] {
            let rest = product - Mat3::identity();
            assert!(rest.0.iter().flatten().all(|x| x.abs() < 1e-15), "{rest:?}");
        }
    }

    #[test]
    fn lanes_and_selection_keep_every_element() {
        assert_eq!(Mat3::<f64>::from_lanes(|_| M).lane(0), M);
        assert_eq!(Mat3::<f64>::from_f64(M.0), M);
        assert_eq!(Mat3::select(true, M, Mat3::zero()), M);
        assert_eq!(Mat3::select(false, M, Mat3::zero()), Mat3::zero());
    }
}
