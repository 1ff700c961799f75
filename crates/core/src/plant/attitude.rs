//! Rotation of a rigid body.
//!
//! ```text
//! I ω' + ω × (I ω) = τ        body axes, full inertia tensor
//! q' = ½ q ⊗ [0, ω]           q: body -> N, scalar first
//! ```
//!
//! One step of length h, of fourth order. The angular momentum L = I ω goes through RK4,
//!
//! ```text
//! L' = τ - ω × L,   ω = I⁻¹ L
//! ```
//!
//! and the attitude follows by the Magnus expansion of the same order, the integral of ω by the corrected trapezoidal rule:
//!
//! ```text
//! φ = h/2 (ω0 + ω1) + h²/12 I⁻¹ (L0' - L1') + h²/12 ω0 × ω1
//! q1 = q0 ⊗ [cos |φ|/2, sin(|φ|/2) φ/|φ|]
//! ```
//!
//! This is cheaper than RK4 on the quaternion, more accurate, and keeps its norm.
//! Assumptions: rigid; constant inertia; torque constant in body axes over a step.
//! Source: Schaub & Junkins, *Analytical Mechanics of Space Systems*, ch. 3 and 4; Iserles et al., *Lie-group methods*,
//! Acta Numerica 2000, §4.

use super::rk4::{Dynamics, rk4_sum};
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

/// A body that turns ω into L and back.
pub trait RigidBody<R: Real> {
    /// L = I ω \[N m s\].
    fn momentum(&self, rate: Vec3<R>) -> Vec3<R>;
    /// ω = I⁻¹ L \[rad/s\].
    fn rate(&self, momentum: Vec3<R>) -> Vec3<R>;
}

impl<R: Real> RigidBody<R> for Inertia<R> {
    #[inline(always)]
    fn momentum(&self, rate: Vec3<R>) -> Vec3<R> {
        self.tensor * rate
    }

    #[inline(always)]
    fn rate(&self, momentum: Vec3<R>) -> Vec3<R> {
        self.inverse * momentum
    }
}

/// A body whose axes are its principal axes in every lane: the same results, since the products left out are zeros,
/// for a third of the multiplications.
pub struct Principal<'a, R>(pub &'a Inertia<R>);

impl<R: Real> RigidBody<R> for Principal<'_, R> {
    #[inline(always)]
    fn momentum(&self, rate: Vec3<R>) -> Vec3<R> {
        self.0.tensor.diagonal_part() * rate
    }

    #[inline(always)]
    fn rate(&self, momentum: Vec3<R>) -> Vec3<R> {
        self.0.inverse.diagonal_part() * momentum
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

/// L' of a body under a torque held in body axes.
struct HeldTorque<'a, R, B> {
    body: &'a B,
    torque: Vec3<R>,
}

impl<R: Real, B: RigidBody<R>> HeldTorque<'_, R, B> {
    #[inline(always)]
    fn momentum_rate(&self, rate: Vec3<R>, momentum: Vec3<R>) -> Vec3<R> {
        let ([wx, wy, wz], [lx, ly, lz], [x, y, z]) = (rate.0, momentum.0, self.torque.0);
        Vec3([
            wz.mul_add(ly, (-wy).mul_add(lz, x)),
            wx.mul_add(lz, (-wz).mul_add(lx, y)),
            wy.mul_add(lx, (-wx).mul_add(ly, z)),
        ])
    }
}

impl<R: Real, B: RigidBody<R>> Dynamics<R> for HeldTorque<'_, R, B> {
    type State = Vec3<R>;

    #[inline(always)]
    fn rate(&self, _fraction: f64, momentum: &Vec3<R>) -> Vec3<R> {
        self.momentum_rate(self.body.rate(*momentum), *momentum)
    }

    #[inline(always)]
    fn advance(momentum: &Vec3<R>, time: R, rate: &Vec3<R>) -> Vec3<R> {
        Vec3::splat(time).mul_add(*rate, *momentum)
    }
}

/// One step of length `h` \[s\] under a torque held in body axes \[N m\].
#[inline(always)]
pub fn spin_step<R: Real, B: RigidBody<R>>(body: &B, spin: &Spin<R>, torque: Vec3<R>, h: R) -> Spin<R> {
    let dynamics = HeldTorque { body, torque };
    let momentum = body.momentum(spin.rate);
    let pull = dynamics.momentum_rate(spin.rate, momentum);
    // Momentum and rate grow by increments, so that turning one into the other at every step costs no energy to rounding.
    let gain = rk4_sum(&dynamics, &momentum, &pull, h) * (h * R::splat(1.0 / 6.0));
    let (new_momentum, new_rate) = (momentum + gain, spin.rate + body.rate(gain));

    let bend = pull - dynamics.momentum_rate(new_rate, new_momentum);
    Spin { attitude: rotated(body, spin, new_rate, bend, h), rate: new_rate }
}

/// The attitude after a step: from the rates at both ends and the difference of L' between them.
#[inline(always)]
pub fn rotated<R: Real, B: RigidBody<R>>(body: &B, spin: &Spin<R>, new_rate: Vec3<R>, bend: Vec3<R>, h: R) -> Quat<R> {
    let twelfth = Vec3::splat(h * h * R::splat(1.0 / 12.0));
    let curved = twelfth * (body.rate(bend) + spin.rate.cross(new_rate));
    let turn = Vec3::splat(h * R::splat(0.5)).mul_add(spin.rate + new_rate, curved);
    renormalized(spin.attitude * small_rotation(turn))
}

/// The rotation by a vector. The series end at (|φ|/2)¹⁰: rounding for turns up to 0.3 rad.
#[inline(always)]
fn small_rotation<R: Real>(turn: Vec3<R>) -> Quat<R> {
    let half = turn * R::splat(0.5);
    let x = half.norm_squared();
    let k = R::splat;
    let sine = x.mul_add(x.mul_add(k(1.0 / 362_880.0), k(-1.0 / 5040.0)), k(1.0 / 120.0));
    let sine = x.mul_add(x.mul_add(sine, k(-1.0 / 6.0)), k(1.0));
    let cosine = x.mul_add(x.mul_add(k(-1.0 / 3_628_800.0), k(1.0 / 40_320.0)), k(-1.0 / 720.0));
    let cosine = x.mul_add(x.mul_add(x.mul_add(cosine, k(1.0 / 24.0)), k(-0.5)), k(1.0));
    Quat::from_parts(cosine, half * sine)
}

/// Back to unit norm by one Newton step of 1/√x about 1, exact to the square of the error: round-off, unless the body
/// turns a large part of a radian in a step.
#[inline(always)]
pub fn renormalized<R: Real>(q: Quat<R>) -> Quat<R> {
    q.scale(R::splat(-0.5).mul_add(q.norm_squared(), R::splat(1.5)))
}

#[cfg(test)]
mod tests;
