//! Rotation of a rigid body.
//!
//!     I ω' + ω × (I ω) = τ        body axes, full inertia tensor
//!     q' = ½ q ⊗ [0, ω]           q: body -> N, scalar first
//!
//! Assumptions: rigid; constant inertia; torque constant in body axes over a step.
//! Source: Schaub & Junkins, *Analytical Mechanics of Space Systems*, ch. 3 and 4.

use super::rk4::{Dynamics, rk4_step};
use crate::batch_struct;
use crate::number::{Mat3, Quat, Real, Vec3};

batch_struct! {
    /// An inertia tensor and its inverse, body axes.
    pub struct Inertia<R> {
        /// \[kg m²\]
        pub tensor: Mat3<R>,
        /// \[1/(kg m²)\]
        pub inverse: Mat3<R>,
    }
}

impl<R: Real> Inertia<R> {
    /// From the tensor \[kg m²\], symmetric and positive definite.
    #[inline(always)]
    pub fn new(tensor: Mat3<R>) -> Self {
        Self { tensor, inverse: tensor.inverse() }
    }

    /// ω' = I⁻¹ (τ - ω × I ω) \[rad/s²\].
    #[inline(always)]
    pub fn angular_acceleration(&self, rate: Vec3<R>, torque: Vec3<R>) -> Vec3<R> {
        self.inverse * (torque - rate.cross(self.tensor * rate))
    }
}

/// Attitude (body -> N) and rate \[rad/s, body axes\] of one body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spin<R> {
    /// Body -> N.
    pub attitude: Quat<R>,
    /// Relative to N, body axes \[rad/s\].
    pub rate: Vec3<R>,
}

impl<R: Real> Spin<R> {
    /// state + time · rate, component by component.
    #[inline(always)]
    pub fn advance(&self, time: R, rate: &Self) -> Self {
        let mut attitude = self.attitude;
        for i in 0..4 {
            attitude.0[i] = time.mul_add(rate.attitude.0[i], attitude.0[i]);
        }
        Self { attitude, rate: Vec3::splat(time).mul_add(rate.rate, self.rate) }
    }

    /// q' and ω' under a torque in body axes \[N m\].
    #[inline(always)]
    pub fn derivative(&self, inertia: &Inertia<R>, torque: Vec3<R>) -> Self {
        let half_rate = self.rate * R::splat(0.5);
        Self { attitude: self.attitude.times_pure(half_rate), rate: inertia.angular_acceleration(self.rate, torque) }
    }

    /// Back to unit norm by one Newton step of 1/√x about 1: exact to the square of the drift of a single integration
    /// step, without root or division.
    #[inline(always)]
    pub fn renormalized(self) -> Self {
        let q = self.attitude;
        let norm_squared = q.0[0].mul_add(q.0[0], q.vector().norm_squared());
        let scale = R::splat(-0.5).mul_add(norm_squared, R::splat(1.5));
        let mut attitude = q;
        for i in 0..4 {
            attitude.0[i] = q.0[i] * scale;
        }
        Self { attitude, rate: self.rate }
    }
}

/// A body under a torque held in body axes.
struct HeldTorque<'a, R> {
    inertia: &'a Inertia<R>,
    torque: Vec3<R>,
}

impl<R: Real> Dynamics<R> for HeldTorque<'_, R> {
    type State = Spin<R>;

    #[inline(always)]
    fn rate(&self, _fraction: f64, spin: &Spin<R>) -> Spin<R> {
        spin.derivative(self.inertia, self.torque)
    }

    #[inline(always)]
    fn advance(spin: &Spin<R>, time: R, rate: &Spin<R>) -> Spin<R> {
        spin.advance(time, rate)
    }
}

/// One RK4 step of length `h` \[s\] under a torque held in body axes \[N m\].
#[inline(always)]
pub fn spin_step<R: Real>(inertia: &Inertia<R>, spin: &Spin<R>, torque: Vec3<R>, h: R) -> Spin<R> {
    rk4_step(&HeldTorque { inertia, torque }, spin, h).renormalized()
}
