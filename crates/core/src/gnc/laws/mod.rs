//! Control laws: from a tracking error to a wrench.
//!
//! A law is two channels, translation and rotation, each either a [`LinearFeedback`] or a [`SlidingMode`], the latter a
//! `surface × reaching law × compensation`. Each law's own file says which combination it is, with its equations.
//!
//! Translation demands a force in H, rotation a torque in C. A law sees navigation output only, and the mass and
//! inertia it believes in. Source of the five laws: Eng. Proc. 2026, 121(1), 25, §3, lost signs restored.

pub mod belief;
pub mod feedback;
pub mod lqr;
pub mod pd;
pub mod prrl;
pub mod reaching;
pub mod riccati;
pub mod sliding;
pub mod sosmc;
pub mod surface;
pub mod tsmc;

use crate::batch::Fields;
use crate::gnc::error::TrackingError;
use crate::number::{Real, Vec3};
use crate::plant::motion::Motion;
use crate::plant::orbit::natural_acceleration;
use crate::plant::wrench::{Wrench, WrenchFrame};
use crate::{batch_enum, batch_struct, batch_uniform};
pub use belief::{MassProperties, StackBelief};
pub use feedback::LinearFeedback;
pub use sliding::SlidingMode;

/// The paper's formula to the letter, or the form that does what the paper says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Form {
    /// As printed.
    Printed,
    /// As it has to be.
    Corrected,
}

batch_uniform!(Form);

/// What the laws take as attitude error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum AttitudeError {
    /// ε, the vector part of the error quaternion.
    Epsilon,
    /// 2 ε, about the angle.
    TwoEpsilon,
}

impl AttitudeError {
    /// κ of κ ε.
    #[inline(always)]
    pub fn factor(self) -> f64 {
        match self {
            AttitudeError::Epsilon => 1.0,
            AttitudeError::TwoEpsilon => 2.0,
        }
    }
}

/// What the sliding laws take off as the rate of their surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum SurfaceRate {
    /// What the paper prints for each law.
    Printed,
    /// The exact one.
    Exact,
}

/// Before capture a law flies the chaser against the debris; after it, the stack against H.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Two bodies.
    BeforeCapture,
    /// One.
    AfterCapture,
}

/// One channel's errors: `error` is e_r or the attitude error, `rate` is e_v or e_ω, `error_rate` the exact d(error)/dt.
#[derive(Clone, Copy, Debug)]
pub struct ChannelError<R> {
    /// e_r \[m\], or κ ε with κ = 1 or 2.
    pub error: Vec3<R>,
    /// e_v \[m/s\] or e_ω \[rad/s\].
    pub rate: Vec3<R>,
    /// e_v, or κ (q0 e_ω + ε × e_ω)/2.
    pub error_rate: Vec3<R>,
}

batch_enum! {
    /// One channel of a law.
    pub enum Channel<R> {
        /// PD, LQR.
        Linear(LinearFeedback<R>),
        /// SOSMC, TSMC, PRRL-SMC.
        Sliding(SlidingMode<R>),
    }
}

batch_struct! {
    /// A law with its gains, and what it believes it flies.
    pub struct Law<R> {
        /// Force in H.
        pub translation: Channel<R>,
        /// Torque in C.
        pub rotation: Channel<R>,
        /// Of the body in this phase.
        pub believed: MassProperties<R>,
    }
}

/// What a law is told at a control tick, besides its errors.
#[derive(Clone, Copy, Debug)]
pub struct Told<'a, R> {
    /// The motion as seen.
    pub motion: &'a Motion<R>,
    /// n \[rad/s\].
    pub mean_motion: R,
    /// a_des to feed forward \[m/s²\]; `None` when off.
    pub feedforward: Option<Vec3<R>>,
    /// ε or 2 ε.
    pub attitude_error: AttitudeError,
}

impl<R: Real> Law<R> {
    /// Force in H \[N\] and torque in C \[N m\], before saturation.
    #[inline(always)]
    pub fn command(&self, error: &TrackingError<R>, told: &Told<'_, R>) -> Wrench<R> {
        Wrench { force: self.force(error, told), torque: self.torque(error, told) }
    }

    #[inline(always)]
    fn force(&self, error: &TrackingError<R>, told: &Told<'_, R>) -> Vec3<R> {
        let errors = ChannelError { error: error.position, rate: error.velocity, error_rate: error.velocity };
        let mass = self.believed.mass;
        let force = match &self.translation {
            Channel::Linear(linear) => linear.demand(errors.error, errors.rate),
            Channel::Sliding(sliding) => {
                let mut acceleration = sliding.acceleration(&errors);
                if sliding.compensation.natural {
                    let natural = natural_acceleration(told.mean_motion, told.motion.position, told.motion.velocity);
                    acceleration -= natural;
                }
                acceleration * mass
            }
        };
        match told.feedforward {
            Some(acceleration) => force + acceleration * mass,
            None => force,
        }
    }

    #[inline(always)]
    fn torque(&self, error: &TrackingError<R>, told: &Told<'_, R>) -> Vec3<R> {
        let factor = R::splat(told.attitude_error.factor());
        let vector = error.attitude.vector();
        let rate = told.motion.chaser_rate;
        match &self.rotation {
            Channel::Linear(linear) => linear.demand(vector * factor, linear.damped_rate(rate, error.rate)),
            Channel::Sliding(sliding) => {
                let turning = error.rate * error.attitude.scalar() + vector.cross(error.rate);
                let errors = ChannelError {
                    error: vector * factor,
                    rate: error.rate,
                    error_rate: turning * (factor * R::splat(0.5)),
                };
                let inertia = &self.believed.inertia;
                let torque = *inertia * sliding.acceleration(&errors);
                torque + rate.cross(*inertia * rate) * R::splat(sliding.compensation.gyroscopic)
            }
        }
    }
}

impl Law<f64> {
    /// Whether all gains computed rather than given are numbers.
    pub fn has_finite_gains(&self) -> bool {
        [&self.translation, &self.rotation].iter().all(|channel| match channel {
            Channel::Linear(linear) => linear.error.0.iter().chain(&linear.rate.0).flatten().all(|k| k.is_finite()),
            Channel::Sliding(_) => true,
        })
    }
}

/// A phase's gains of both channels.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct PhaseGains<G> {
    /// Gains of the force.
    pub translation: G,
    /// Gains of the torque.
    pub rotation: G,
}

/// Form and gains of a law, before and after capture.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Gains<G> {
    /// Printed or corrected.
    pub form: Form,
    /// Against the debris.
    pub before: PhaseGains<G>,
    /// The stack against H.
    pub after: PhaseGains<G>,
}

impl<G: Fields> Fields for Gains<G> {
    fn field(&mut self, path: &str) -> Option<&mut [f64]> {
        let (phase, rest) = path.split_once('.')?;
        let gains = match phase {
            "before" => &mut self.before,
            "after" => &mut self.after,
            _ => return None,
        };
        let (channel, gain) = rest.split_once('.')?;
        match channel {
            "translation" => gains.translation.field(gain),
            "rotation" => gains.rotation.field(gain),
            _ => None,
        }
    }
}

impl<G> Gains<G> {
    fn of(&self, phase: Phase) -> &PhaseGains<G> {
        match phase {
            Phase::BeforeCapture => &self.before,
            Phase::AfterCapture => &self.after,
        }
    }
}

/// A wrench held from one control tick to another, open loop.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Segment {
    /// First tick at which it acts.
    pub first_tick: u32,
    /// First tick at which it acts no more.
    pub end_tick: u32,
    /// Axes in which it is given and held.
    pub frame: WrenchFrame,
    /// \[N\]
    pub force: Vec3<f64>,
    /// \[N m\]
    pub torque: Vec3<f64>,
}

/// A law as a scenario gives it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "lowercase"))]
pub enum LawRecipe {
    /// Proportional–derivative.
    Pd(Gains<pd::Gains>),
    /// Linear quadratic regulator.
    Lqr(Gains<lqr::Weights>),
    /// "Second-order" sliding mode, as the paper calls it.
    Sosmc(Gains<sosmc::Gains>),
    /// Terminal sliding mode.
    Tsmc(Gains<tsmc::Gains>),
    /// Power rate reaching law sliding mode.
    Prrl(Gains<prrl::Gains>),
    /// No law: open-loop segments.
    None {
        /// In order of time, not overlapping.
        segments: Vec<Segment>,
    },
    /// No law: what a flight before commanded.
    Recorded {
        /// Force \[N\] and torque \[N m\] tick by tick; after the last row, none.
        wrenches: Vec<[f64; 6]>,
        /// Which tell the axes, if they were commanded open loop.
        segments: Vec<Segment>,
    },
}

/// What a law's construction depends on besides its gains.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// n \[rad/s\].
    pub mean_motion: f64,
    /// ε or 2 ε.
    pub attitude_error: AttitudeError,
    /// What sliding laws take off.
    pub surface_rate: SurfaceRate,
}

impl LawRecipe {
    /// The law of one phase for a body it believes to be `believed`. `None` for open loop.
    pub fn build(&self, phase: Phase, believed: &MassProperties<f64>, setting: &Setting) -> Option<Law<f64>> {
        let (translation, rotation) = match self {
            LawRecipe::Pd(gains) => pd::channels(gains.of(phase), gains.form),
            LawRecipe::Lqr(weights) => lqr::channels(weights.of(phase), weights.form, phase, believed, setting),
            LawRecipe::Sosmc(gains) => sosmc::channels(gains.of(phase), gains.form),
            LawRecipe::Tsmc(gains) => tsmc::channels(gains.of(phase), setting),
            LawRecipe::Prrl(gains) => prrl::channels(gains.of(phase), gains.form, setting),
            LawRecipe::None { .. } | LawRecipe::Recorded { .. } => return None,
        };
        Some(Law { translation, rotation, believed: *believed })
    }

    /// The gains at a path: `before.rotation.slope`.
    pub fn field(&mut self, path: &str) -> Option<&mut [f64]> {
        match self {
            LawRecipe::Pd(gains) => gains.field(path),
            LawRecipe::Lqr(weights) => weights.field(path),
            LawRecipe::Sosmc(gains) => gains.field(path),
            LawRecipe::Tsmc(gains) => gains.field(path),
            LawRecipe::Prrl(gains) => gains.field(path),
            LawRecipe::None { .. } | LawRecipe::Recorded { .. } => None,
        }
    }

    /// The open-loop segments; empty for a law.
    pub fn segments(&self) -> &[Segment] {
        match self {
            LawRecipe::None { segments } | LawRecipe::Recorded { segments, .. } => segments,
            _ => &[],
        }
    }
}

#[cfg(test)]
mod tests;
