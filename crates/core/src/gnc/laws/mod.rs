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
pub mod recipe;
pub mod riccati;
pub mod sliding;
pub mod sosmc;
pub mod stsmc;
pub mod surface;
pub mod tsmc;

use crate::batch::Batch;
use crate::gnc::error::TrackingError;
use crate::gnc::guidance::Target;
use crate::gnc::navigation::Estimate;
use crate::hardware::actuators::Applied;
use crate::number::{Real, Vec3};
use crate::part::Part;
use crate::plant::orbit::natural_acceleration;
use crate::plant::wrench::Wrench;
use crate::{batch_enum, batch_struct, batch_uniform};
pub use belief::{MassProperties, StackBelief};
pub use feedback::LinearFeedback;
pub use recipe::{Gains, LawRecipe, PhaseGains, Segment, Setting, Setup};
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

batch_enum! {
    /// What a channel remembers.
    pub enum ChannelMemory<R> {
        /// Nothing.
        None(()),
        /// An integral of the reaching law.
        Integral(Integral<R>),
    }
}

batch_struct! {
    /// An integral, element by element.
    pub struct Integral<R> {
        /// Its value.
        pub value: Vec3<R>,
        /// What it grows by over this period, where the actuators give what is asked for.
        pub growth: Vec3<R>,
    }
}

batch_struct! {
    /// What a law remembers.
    pub struct LawMemory<R> {
        /// Of the force.
        pub translation: ChannelMemory<R>,
        /// Of the torque.
        pub rotation: ChannelMemory<R>,
    }
}

impl<R: Real> ChannelMemory<R> {
    /// An integral of zero.
    pub(crate) fn integral() -> Self {
        Self::Integral(Integral { value: Vec3::zero(), growth: Vec3::zero() })
    }

    /// Integrals grow, but on axes on which the actuators are saturated: there they would wind up.
    #[inline(always)]
    fn grow(&mut self, saturated: &[R::Mask; 3]) {
        if let Self::Integral(Integral { value, growth }) = self {
            let grown = *value + *growth;
            let [x, y, z] = *saturated;
            *value = Vec3([
                R::select(x, value[0], grown[0]),
                R::select(y, value[1], grown[1]),
                R::select(z, value[2], grown[2]),
            ]);
        }
    }

    #[inline(always)]
    fn reset(&mut self, lanes: R::Mask) {
        if let Self::Integral(_) = self {
            *self = Self::choose(lanes, &Self::integral(), self);
        }
    }
}

impl<R: Real> LawMemory<R> {
    /// Integrals grow where the actuators give what was asked for.
    #[inline(always)]
    pub fn grow(&mut self, applied: &Applied<R>) {
        self.translation.grow(&applied.force_saturated);
        self.rotation.grow(&applied.torque_saturated);
    }
}

/// What a law sees of the motion. It is made of an estimate: no law sees the truth.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a, R> {
    estimate: &'a Estimate<R>,
    error: TrackingError<R>,
}

impl<'a, R: Real> Seen<'a, R> {
    /// An estimate against its goal.
    #[inline(always)]
    pub fn new(estimate: &'a Estimate<R>, goal: &Target<R>) -> Self {
        Self { estimate, error: TrackingError::between(&estimate.motion, goal) }
    }
}

/// What a law is given at a control tick.
#[derive(Clone, Copy, Debug)]
pub struct LawInput<'a, R> {
    /// Estimate and errors.
    pub seen: Seen<'a, R>,
    /// n \[rad/s\].
    pub mean_motion: R,
    /// a_des to feed forward \[m/s²\]; `None` when off.
    pub feedforward: Option<Vec3<R>>,
    /// ε or 2 ε.
    pub attitude_error: AttitudeError,
    /// Control period \[s\].
    pub period: R,
}

impl<R: Real> Part<R> for Law<R> {
    type Memory = LawMemory<R>;
    type Input<'a> = LawInput<'a, R>;
    type Output = Wrench<R>;

    fn begin(&self) -> LawMemory<R> {
        LawMemory { translation: self.translation.begin(), rotation: self.rotation.begin() }
    }

    /// Force in H \[N\] and torque in C \[N m\], before saturation.
    #[inline(always)]
    fn step(&self, memory: &mut LawMemory<R>, input: LawInput<'_, R>) -> Wrench<R> {
        Wrench { force: self.force(&mut memory.translation, &input), torque: self.torque(&mut memory.rotation, &input) }
    }

    /// Integrals begin anew: they belong to another body.
    #[inline(always)]
    fn hand_over(&self, memory: &mut LawMemory<R>, lanes: R::Mask) {
        memory.translation.reset(lanes);
        memory.rotation.reset(lanes);
    }
}

impl<R: Real> Channel<R> {
    fn begin(&self) -> ChannelMemory<R> {
        match self {
            Channel::Linear(_) => ChannelMemory::None(()),
            Channel::Sliding(sliding) => sliding.reaching.begin(),
        }
    }
}

impl<R: Real> Law<R> {
    #[inline(always)]
    fn force(&self, memory: &mut ChannelMemory<R>, input: &LawInput<'_, R>) -> Vec3<R> {
        let (error, motion) = (&input.seen.error, &input.seen.estimate.motion);
        let errors = ChannelError { error: error.position, rate: error.velocity, error_rate: error.velocity };
        let mass = self.believed.mass;
        let force = match &self.translation {
            Channel::Linear(linear) => linear.demand(errors.error, errors.rate),
            Channel::Sliding(sliding) => {
                let mut acceleration = sliding.acceleration(memory, &errors, input.period);
                if sliding.compensation.natural {
                    acceleration -= natural_acceleration(input.mean_motion, motion.position, motion.velocity);
                }
                acceleration * mass
            }
        };
        match input.feedforward {
            Some(acceleration) => force + acceleration * mass,
            None => force,
        }
    }

    #[inline(always)]
    fn torque(&self, memory: &mut ChannelMemory<R>, input: &LawInput<'_, R>) -> Vec3<R> {
        let error = &input.seen.error;
        let factor = R::splat(input.attitude_error.factor());
        let vector = error.attitude.vector();
        let rate = input.seen.estimate.motion.chaser_rate;
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
                let torque = *inertia * sliding.acceleration(memory, &errors, input.period);
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

#[cfg(test)]
mod tests;
