//! [`Quat`]: attitudes.

use super::matrix::Mat3;
use super::real::Real;
use super::vector::Vec3;
use core::ops::Mul;

/// A quaternion, scalar part first, with the Hamilton product.
///
/// An attitude is a unit quaternion that turns body components into reference components: v_N = q ⊗ v_B ⊗ q*.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
pub struct Quat<R>(pub [R; 4]);

impl<R: Real> Quat<R> {
    /// No rotation.
    #[inline(always)]
    pub fn identity() -> Self {
        Self::from_parts(R::one(), Vec3::zero())
    }
    /// From scalar and vector part.
    #[inline(always)]
    pub fn from_parts(scalar: R, vector: Vec3<R>) -> Self {
        Self([scalar, vector[0], vector[1], vector[2]])
    }
    /// The same quaternion in every lane.
    #[inline(always)]
    pub fn from_f64(q: [f64; 4]) -> Self {
        Self::from_parts(R::splat(q[0]), Vec3::from_f64([q[1], q[2], q[3]]))
    }
    /// Lane `i` holds `f(i)`. `f` is called once for each lane and component.
    #[inline(always)]
    pub fn from_lanes(f: impl Fn(usize) -> Quat<f64>) -> Self {
        Self::from_parts(R::from_fn(|lane| f(lane).scalar()), Vec3::from_lanes(|lane| f(lane).vector()))
    }
    /// The quaternion of lane `i`.
    #[inline(always)]
    pub fn lane(self, i: usize) -> Quat<f64> {
        Quat::from_parts(self.scalar().lane(i), self.vector().lane(i))
    }
    /// Gives lane `i` another quaternion.
    #[inline(always)]
    pub fn set_lane(&mut self, i: usize, q: Quat<f64>) {
        for k in 0..4 {
            self.0[k].set_lane(i, q.0[k]);
        }
    }
    /// `yes` in lanes where the mask holds, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self::from_parts(R::select(mask, yes.scalar(), no.scalar()), Vec3::select(mask, yes.vector(), no.vector()))
    }
    /// The attitude after turning by `phi`, about its direction and by its length in rad (at most 2e4):
    /// (cos φ/2, φ/|φ| sin φ/2), to full precision however small φ.
    #[inline(always)]
    pub fn from_rotation_vector(phi: Vec3<R>) -> Self {
        let angle = phi.norm();
        let (sin, cos) = (angle * R::splat(0.5)).sin_cos();
        // Below this the square of the length leaves the normal numbers; sin(φ/2)/φ is 1/2 long before.
        let tiny = R::splat(1e-150);
        let ratio = R::select(angle.lt(tiny), R::splat(0.5), sin / angle.max(tiny));
        Self::from_parts(cos, phi * ratio)
    }
    /// The attitude after turning by `angle` (rad) about the z axis.
    #[inline(always)]
    pub fn about_z(angle: R) -> Self {
        let (sin, cos) = (angle * R::splat(0.5)).sin_cos();
        Self([cos, R::zero(), R::zero(), sin])
    }

    /// Scalar part.
    #[inline(always)]
    pub fn scalar(self) -> R {
        self.0[0]
    }
    /// Vector part.
    #[inline(always)]
    pub fn vector(self) -> Vec3<R> {
        Vec3([self.0[1], self.0[2], self.0[3]])
    }
    /// The inverse rotation, for a unit quaternion.
    #[inline(always)]
    pub fn conjugate(self) -> Self {
        Self::from_parts(self.scalar(), -self.vector())
    }
    /// Every component times a number.
    #[inline(always)]
    pub fn scale(self, scale: R) -> Self {
        Self::from_parts(self.scalar() * scale, self.vector() * scale)
    }
    /// Square of the length.
    #[inline(always)]
    pub fn norm_squared(self) -> R {
        self.scalar().mul_add(self.scalar(), self.vector().norm_squared())
    }
    /// The unit quaternion of the same direction.
    #[inline(always)]
    pub fn normalized(self) -> Self {
        self.scale(R::one() / self.norm_squared().sqrt())
    }
    /// The same rotation the short way round: of q and -q the one with scalar part >= 0. A scalar part of ±0 leaves q as it is.
    #[inline(always)]
    pub fn short_way(self) -> Self {
        // Adding 0 turns -0 into +0, so that copysign sees + there.
        self.scale(R::one().copysign(self.scalar() + R::zero()))
    }
    /// q ⊗ (0, w): with the body rate, twice the derivative of an attitude.
    #[inline(always)]
    pub fn times_pure(self, w: Vec3<R>) -> Self {
        let (s, v) = (self.scalar(), self.vector());
        Self::from_parts(-v.dot(w), w.mul_add(Vec3::splat(s), v.cross(w)))
    }
    /// Body components to reference components, for a unit quaternion: v + q₀ t + q⃗ × t with t = 2 q⃗ × v.
    #[inline(always)]
    pub fn rotate(self, v: Vec3<R>) -> Vec3<R> {
        let t = self.vector().cross(v + v);
        t.mul_add(Vec3::splat(self.scalar()), v + self.vector().cross(t))
    }
    /// Reference components to body components, for a unit quaternion.
    #[inline(always)]
    pub fn rotate_inverse(self, v: Vec3<R>) -> Vec3<R> {
        self.conjugate().rotate(v)
    }
    /// The matrix that does what [`Quat::rotate`] does: its columns are the body axes in reference components.
    #[inline(always)]
    pub fn to_matrix(self) -> Mat3<R> {
        let [w, x, y, z] = self.0;
        let (x2, y2, z2) = (x + x, y + y, z + z);
        let one = R::one();
        let (xx, yy, zz) = (x * x2, y * y2, z * z2);
        let (wx, wy, wz) = (w * x2, w * y2, w * z2);
        Mat3([
            [one - (yy + zz), x.mul_add(y2, -wz), x.mul_add(z2, wy)],
            [x.mul_add(y2, wz), one - (xx + zz), y.mul_add(z2, -wx)],
            [x.mul_add(z2, -wy), y.mul_add(z2, wx), one - (xx + yy)],
        ])
    }
}

impl<R: Real> Mul for Quat<R> {
    type Output = Self;
    /// The Hamilton product: first `other`, then `self`, as rotations of components.
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (s, v) = (self.scalar(), self.vector());
        let (t, w) = (other.scalar(), other.vector());
        let vector = w.mul_add(Vec3::splat(s), v.mul_add(Vec3::splat(t), v.cross(w)));
        Self::from_parts(s.mul_add(t, -v.dot(w)), vector)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI};

    const V: Vec3<f64> = Vec3([1.0, -2.0, 3.0]);

    fn attitudes() -> [Quat<f64>; 2] {
        [Quat([0.3, -0.5, 0.7, 0.2]).normalized(), Quat([-0.8, 0.1, 0.4, -0.9]).normalized()]
    }

    #[track_caller]
    fn assert_close(a: &[f64], b: &[f64]) {
        let close = a.iter().zip(b).all(|(a, b)| (a - b).abs() < 2e-15);
        assert!(close, "{a:?} is not {b:?}");
    }

    #[test]
    fn units_multiply_as_hamilton_carved() {
        let [i, j, k] = [1, 2, 3].map(|n| {
            let mut q = [0.0; 4];
            q[n] = 1.0;
            Quat(q)
        });
        assert_eq!((i * j, j * k, k * i), (k, i, j));
        assert_eq!(i * j * k, Quat([-1.0, 0.0, 0.0, 0.0]));
    }

    #[test]
    fn a_quarter_turn_about_z_takes_x_to_y() {
        let q = Quat::<f64>::about_z(FRAC_PI_2);
        assert_close(&q.0, &[FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2]);
        assert_close(&q.rotate(Vec3([1.0, 0.0, 0.0])).0, &[0.0, 1.0, 0.0]);
        assert_close(&q.rotate_inverse(Vec3([0.0, 1.0, 0.0])).0, &[1.0, 0.0, 0.0]);
        assert_close(&Quat::<f64>::from_rotation_vector(Vec3([0.0, 0.0, FRAC_PI_2])).0, &q.0);
    }

    #[test]
    fn rotation_matrix_and_sandwich_product_agree() {
        for q in attitudes() {
            let rotated = q.rotate(V);
            assert_close(&(q.to_matrix() * V).0, &rotated.0);
            assert_close(&(q.times_pure(V) * q.conjugate()).vector().0, &rotated.0);
            assert_close(&q.rotate_inverse(rotated).0, &V.0);
            assert_close(&q.times_pure(V).0, &(q * Quat::from_parts(0.0, V)).0);
            assert!((rotated.norm() - V.norm()).abs() < 1e-15);
        }
    }

    #[test]
    fn products_compose_and_conjugates_undo() {
        let [p, q] = attitudes();
        assert_close(&(p * q).rotate(V).0, &p.rotate(q.rotate(V)).0);
        assert_close(&(p * p.conjugate()).0, &Quat::<f64>::identity().0);
        assert_close(&(p * q).conjugate().0, &(q.conjugate() * p.conjugate()).0);
    }

    #[test]
    fn short_way_never_has_a_negative_scalar_part() {
        for q in attitudes() {
            assert!(q.short_way().scalar() > 0.0);
            assert_close(&q.short_way().rotate(V).0, &q.rotate(V).0);
        }
        for zero in [0.0, -0.0] {
            let half_turn = Quat([zero, 0.6, -0.8, 0.0]);
            assert_eq!(half_turn.short_way(), half_turn);
        }
    }

    #[test]
    fn rotation_vectors_are_exact_at_every_size() {
        assert_eq!(Quat::from_rotation_vector(Vec3::<f64>::zero()), Quat::identity());
        let direction = Vec3([0.36, 0.48, -0.8]);
        for angle in [1e-300, 1e-160, 1e-150, 1e-20, 1e-8, 1e-3, 1.0, PI, 6.0] {
            let q = Quat::from_rotation_vector(direction * angle);
            let (sin, cos) = (0.5 * angle).sin_cos();
            assert!((q.scalar() - cos).abs() < 2e-16);
            let error = q.vector() - direction * sin;
            assert!(error.norm() <= 3e-16 * angle, "{angle}: {error:?}");
        }
    }

    #[test]
    fn lanes_and_selection_keep_every_component() {
        let [p, q] = attitudes();
        assert_eq!(Quat::<f64>::from_lanes(|_| p).lane(0), p);
        assert_eq!(Quat::<f64>::from_f64(q.0), q);
        assert_eq!((Quat::select(true, p, q), Quat::select(false, p, q)), (p, q));
    }
}
