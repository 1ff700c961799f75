//! Additive white Gaussian noise on what the laws see, drawn anew at every control tick.
//!
//! ```text
//! r + N(0, σ_r)    v + N(0, σ_v)    q_C ⊗ [1, δ/2]/√(1 + |δ|²/4), δ ~ N(0, σ_q)    ω_C + N(0, σ_ω)
//! ```
//!
//! Assumptions: the debris' attitude and rate are seen without noise; no bias, no delay.
//! Each quantity has random numbers of its own, so switching one sensor's noise off leaves the others' draws as they were.

use crate::case_struct;
use crate::number::{Quat, Real, Stream, Vec3};
use crate::part::Part;
use crate::plant::motion::Motion;

case_struct! {
    /// Standard deviations per axis of white Gaussian noise, drawn anew at every control tick.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
    pub struct NoiseSigmas<R> {
        /// Relative position \[m\].
        pub position: R,
        /// Relative velocity \[m/s\].
        pub velocity: R,
        /// Chaser attitude, small angle \[rad\].
        pub attitude: R,
        /// Chaser rate \[rad/s\].
        pub rate: R,
    }
}

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
}

/// What the sensors tell. Only navigation sees it.
#[derive(Clone, Copy, Debug)]
pub struct Measurement<R> {
    /// Measured motion, as [`Motion`] has it.
    pub motion: Motion<R>,
}

/// Sensors with white noise.
#[derive(Clone, Copy, Debug)]
pub struct Sensors<'a, R> {
    /// Standard deviations.
    pub sigmas: &'a NoiseSigmas<R>,
    /// Which of them are noisy.
    pub noisy: Noisy,
}

/// What there is to measure at a control tick.
pub struct Sensed<'a, R: Real> {
    /// The true motion.
    pub truth: &'a Motion<R>,
    /// Random numbers of the flight.
    pub noise: &'a Stream<R>,
    /// Number of the tick.
    pub tick: R,
}

impl<R: Real> Part<R> for Sensors<'_, R> {
    type Memory = ();
    type Input<'a> = Sensed<'a, R>;
    type Output = Measurement<R>;

    fn begin(&self) {}

    #[inline(always)]
    fn step(&self, (): &mut (), Sensed { truth, noise, tick }: Sensed<'_, R>) -> Measurement<R> {
        Measurement { motion: with_noise(self.sigmas, self.noisy, truth, noise, tick) }
    }
}

#[inline(always)]
fn with_noise<R: Real>(
    sigmas: &NoiseSigmas<R>,
    noisy: Noisy,
    truth: &Motion<R>,
    noise: &Stream<R>,
    tick: R,
) -> Motion<R> {
    // Twelve normals a tick: position 0–2, attitude 3–5, rate 6–8, velocity 9–11; none drawn beyond the last in use.
    let mut normals = [[R::zero(); 2]; 6];
    if noisy.velocity {
        normals = noise.normal_pairs::<6>(tick);
    } else if noisy.rate {
        normals[..5].copy_from_slice(&noise.normal_pairs::<5>(tick));
    } else if noisy.attitude {
        normals[..3].copy_from_slice(&noise.normal_pairs::<3>(tick));
    } else if noisy.position {
        normals[..2].copy_from_slice(&noise.normal_pairs::<2>(tick));
    }
    let [[x, y], [z, a], [b, c], [p, q], [r, u], [v, w]] = normals;

    let mut seen = *truth;
    if noisy.position {
        seen.position += Vec3([x, y, z]) * sigmas.position;
    }
    if noisy.attitude {
        let [x, y, z] = (Vec3([a, b, c]) * (sigmas.attitude * R::splat(0.5))).0;
        // The turn is normalised, not the product: a lane without noise keeps its bits beside noisy ones.
        seen.chaser_attitude = truth.chaser_attitude * Quat([R::one(), x, y, z]).normalized();
    }
    if noisy.rate {
        seen.chaser_rate += Vec3([p, q, r]) * sigmas.rate;
    }
    if noisy.velocity {
        seen.velocity += Vec3([u, v, w]) * sigmas.velocity;
    }
    seen
}

#[cfg(test)]
mod tests;
