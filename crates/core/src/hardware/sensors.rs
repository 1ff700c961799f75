//! Additive white Gaussian noise on what the laws see, drawn anew at every control tick.
//!
//!     r + N(0, σ_r)    v + N(0, σ_v)    q_C ⊗ [1, δ/2] normalised, δ ~ N(0, σ_q)    ω_C + N(0, σ_ω)
//!
//! Assumptions: the debris' attitude and rate are seen without noise; no bias, no delay.
//! Each quantity has random numbers of its own (Philox blocks 0 to 2), so switching one sensor's noise off leaves
//! the others' draws as they were. Only noise that is used is drawn.

use crate::case::{Motion, NoiseSigmas};
use crate::number::{Quat, Real, Stream, Vec3};

/// Which sensors are noisy in at least one flight of the batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Noisy {
    /// Relative position.
    pub position: bool,
    /// Relative velocity.
    pub velocity: bool,
    /// Chaser attitude.
    pub attitude: bool,
    /// Chaser rate.
    pub rate: bool,
}

impl Noisy {
    /// The sensors whose σ is not zero.
    pub fn new(sigmas: &NoiseSigmas<f64>) -> Self {
        Self {
            position: sigmas.position != 0.0,
            velocity: sigmas.velocity != 0.0,
            attitude: sigmas.attitude != 0.0,
            rate: sigmas.rate != 0.0,
        }
    }

    /// Noisy in either.
    pub fn or(self, other: Self) -> Self {
        Self {
            position: self.position || other.position,
            velocity: self.velocity || other.velocity,
            attitude: self.attitude || other.attitude,
            rate: self.rate || other.rate,
        }
    }
}

/// What the sensors see of the truth at control tick `tick`.
#[inline(always)]
pub fn sense<R: Real>(
    sigmas: &NoiseSigmas<R>,
    noisy: Noisy,
    truth: &Motion<R>,
    dice: &Stream<R>,
    tick: u32,
) -> Motion<R> {
    let mut seen = *truth;
    let Noisy { position, velocity, attitude, rate } = noisy;
    // Twelve normals in three blocks: position 0–2, attitude 3–5, rate 6–8, velocity 9–11.
    let block = |used: bool, number| if used { dice.normals(tick, number) } else { [R::zero(); 4] };
    let first = block(position || attitude, 0);
    let second = block(attitude || rate, 1);
    let third = if velocity {
        dice.normals(tick, 2)
    } else if rate {
        let [a, b] = dice.normal_pair(tick, 2);
        [a, b, R::zero(), R::zero()]
    } else {
        [R::zero(); 4]
    };

    if position {
        seen.position += Vec3([first[0], first[1], first[2]]) * sigmas.position;
    }
    if attitude {
        let half_angle = Vec3([first[3], second[0], second[1]]) * (sigmas.attitude * R::splat(0.5));
        let [x, y, z] = half_angle.0;
        seen.chaser_attitude = (truth.chaser_attitude * Quat([R::one(), x, y, z])).normalized();
    }
    if rate {
        seen.chaser_rate += Vec3([second[2], second[3], third[0]]) * sigmas.rate;
    }
    if velocity {
        seen.velocity += Vec3([third[1], third[2], third[3]]) * sigmas.velocity;
    }
    seen
}
