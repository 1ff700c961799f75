//! Two bodies become one.
//!
//! `approximate`, the paper's transition: the stack takes the chaser's position, velocity, attitude and rate; its mass is
//! m_c + m_d, its inertia I_c + I_d as matrices. Momentum is not conserved.
//!
//! `momentum_conserving`, a rigid, perfectly inelastic merge. With d = r in C, d' = (v + ω_H × r) in C, R = D -> C and the
//! reduced mass μ = m_c m_d / (m_c + m_d):
//!
//! ```text
//! I_S = I_c + R I_d Rᵀ + μ (|d|² 1 - d dᵀ)
//! h   = I_c ω_c + R I_d ω_d + μ d × d'          about the common centre of mass, non-rotating axes
//! ω_S = I_S⁻¹ h,   r_S = m_c r / (m_c + m_d),   v_S likewise (the debris rests at H's origin)
//! ```
//!
//! Stack axes are the chaser's. Source: parallel-axis theorem and momentum balance, e.g. Schaub & Junkins, ch. 2 and 4.

use super::attitude::Inertia;
use super::body::{Body, Vehicle};
use super::lvlh::Lvlh;
use super::motion::Motion;
use crate::number::{Mat3, Real, Vec3};

/// How the bodies join at capture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Transition {
    /// They do not: the first time the thresholds hold is only noted.
    None,
    /// The paper's approximation.
    Approximate,
    /// Linear and angular momentum are conserved.
    MomentumConserving,
}

impl Transition {
    /// Whether the bodies become one.
    #[inline(always)]
    pub fn merges(self) -> bool {
        self != Transition::None
    }
}

/// The stack: what it weighs and how it moves at the instant of the merge.
#[derive(Clone, Copy, Debug)]
pub struct Stack<R> {
    /// Mass and inertia.
    pub vehicle: Vehicle<R>,
    /// r, v, q, ω of the stack; the debris' part is left as it was.
    pub motion: Motion<R>,
    /// From the debris' centre of mass to the chaser's, C axes \[m\]; zero where it is neglected.
    pub offset: Vec3<R>,
}

/// The paper's transition.
pub fn merge_approximate<R: Real>(chaser: &Body<R>, debris: &Body<R>, motion: &Motion<R>) -> Stack<R> {
    Stack {
        vehicle: Vehicle::new(chaser.mass + debris.mass, Inertia::new(chaser.inertia + debris.inertia)),
        motion: *motion,
        offset: Vec3::zero(),
    }
}

/// The transition that conserves linear and angular momentum.
pub fn merge_conserving<R: Real>(chaser: &Body<R>, debris: &Body<R>, motion: &Motion<R>, lvlh: &Lvlh<R>) -> Stack<R> {
    let mass = chaser.mass + debris.mass;
    let reduced_mass = chaser.mass * debris.mass / mass;

    let chaser_to_lvlh = lvlh.attitude.conjugate() * motion.chaser_attitude;
    let offset = chaser_to_lvlh.rotate_inverse(motion.position);
    let offset_rate = chaser_to_lvlh.rotate_inverse(motion.velocity + lvlh.rate.cross(motion.position));

    let debris_to_chaser = (motion.chaser_attitude.conjugate() * motion.debris_attitude).to_matrix();
    let debris_inertia = debris_to_chaser * debris.inertia * debris_to_chaser.transpose();
    let parallel_axis = Mat3::from_scale(offset.norm_squared()) - offset.outer(offset);
    let inertia = Inertia::new(symmetric(chaser.inertia + debris_inertia + parallel_axis.scale(reduced_mass)));

    let momentum = chaser.inertia * motion.chaser_rate
        + debris_to_chaser * (debris.inertia * motion.debris_rate)
        + offset.cross(offset_rate) * reduced_mass;

    let share = chaser.mass / mass;
    let mut merged = *motion;
    merged.position = motion.position * share;
    merged.velocity = motion.velocity * share;
    merged.chaser_rate = inertia.inverse * momentum;
    Stack { vehicle: Vehicle::new(mass, inertia), motion: merged, offset }
}

/// Symmetric to the last bit: R I Rᵀ is so only to round-off.
fn symmetric<R: Real>(m: Mat3<R>) -> Mat3<R> {
    (m + m.transpose()).scale(R::splat(0.5))
}

#[cfg(test)]
mod tests;
