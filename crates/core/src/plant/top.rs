//! The torque-free tumble of a symmetric top, in closed form.
//!
//! ```text
//! I = diag(I_t, I_t, I_z)      λ = (I_z - I_t)/I_t ω_z, constant
//!
//! ω(t) = R_z(λ t) ω(0)         the transverse rate turns about the axis, in body axes
//! q(t) = exp(L t / I_t) ⊗ q(0) ⊗ exp(-λ t e_z)        precession about L, held in N, and proper spin
//! ```
//!
//! Source: Schaub & Junkins, *Analytical Mechanics of Space Systems*, §4.2; L is the angular momentum.

use super::attitude::{Inertia, Spin, renormalized};
use crate::batch_struct;
use crate::number::{Mat3, Quat, Real, Vec3};

batch_struct! {
    /// One step of a fixed length.
    pub struct FreeTop<R> {
        /// exp(L h / I_t), in N.
        pub precession: Quat<R>,
        /// cos(λ h / 2), sin(λ h / 2)
        pub half_spin: [R; 2],
        /// cos(λ h), sin(λ h)
        pub spin: [R; 2],
    }
}

/// Whether a body is a symmetric top about its z axis.
pub fn is_symmetric_top(inertia: &Mat3<f64>) -> bool {
    inertia.is_diagonal() && inertia.0[0][0] == inertia.0[1][1]
}

impl FreeTop<f64> {
    /// From the inertia and the motion at any instant. Without meaning for a body that is no symmetric top.
    pub fn new(inertia: &Inertia<f64>, start: &Spin<f64>, step: f64) -> Self {
        let [transverse, axial] = [inertia.tensor.0[0][0], inertia.tensor.0[2][2]];
        let momentum = start.attitude.rotate(inertia.tensor * start.rate);
        let angle = (axial - transverse) / transverse * start.rate[2] * step;
        let (half_sin, half_cos) = (0.5 * angle).sin_cos();
        let (sin, cos) = angle.sin_cos();
        Self {
            precession: Quat::from_rotation_vector(momentum * (step / transverse)),
            half_spin: [half_cos, half_sin],
            spin: [cos, sin],
        }
    }
}

impl<R: Real> FreeTop<R> {
    /// The motion a step later.
    #[inline(always)]
    pub fn step(&self, spin: &Spin<R>) -> Spin<R> {
        let [c, s] = self.half_spin;
        let [w, x, y, z] = spin.attitude.0;
        // q ⊗ [c, 0, 0, -s]
        let spun = Quat([w.mul_add(c, z * s), x.mul_add(c, -(y * s)), y.mul_add(c, x * s), z.mul_add(c, -(w * s))]);
        let [c, s] = self.spin;
        let [x, y, z] = spin.rate.0;
        Spin {
            attitude: renormalized(self.precession * spun),
            rate: Vec3([x.mul_add(c, -(y * s)), x.mul_add(s, y * c), z]),
        }
    }
}

#[cfg(test)]
mod tests;
