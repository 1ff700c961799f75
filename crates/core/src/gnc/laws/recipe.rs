//! Laws as a scenario gives them: kind, form, gains before and after capture; and the register of all laws.

use super::{AttitudeError, Channel, Form, Law, MassProperties, Phase, SurfaceRate, lqr, pd, prrl, sosmc, stsmc, tsmc};
use crate::batch::Fields;
use crate::number::Vec3;
use crate::plant::wrench::WrenchFrame;

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
    /// Printed or corrected; `None` for a law that has one form.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub form: Option<Form>,
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

/// All that a law's channels are made of, besides their gains.
#[derive(Clone, Copy, Debug)]
pub struct Setup<'a> {
    /// Printed or corrected; a law without forms does not look.
    pub form: Form,
    /// Before or after capture.
    pub phase: Phase,
    /// The body it flies, as it believes.
    pub believed: &'a MassProperties<f64>,
    /// Orbit and switches.
    pub setting: &'a Setting,
}

/// Declares the laws: name, gains of one channel, the function that makes both channels.
macro_rules! laws {
    ($($(#[$doc:meta])* $law:ident($gains:ty) => $channels:path,)*) => {
        /// A law as a scenario gives it.
        #[derive(Clone, Debug, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "lowercase"))]
        pub enum LawRecipe {
            $($(#[$doc])* $law(Gains<$gains>),)*
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

        impl LawRecipe {
            /// The law of one phase for a body it believes to be `believed`. `None` for open loop.
            pub fn build(
                &self,
                phase: Phase,
                believed: &MassProperties<f64>,
                setting: &Setting,
            ) -> Option<Law<f64>> {
                let (translation, rotation): (Channel<f64>, Channel<f64>) = match self {
                    $(LawRecipe::$law(gains) => {
                        let form = gains.form.unwrap_or(Form::Corrected);
                        $channels(gains.of(phase), &Setup { form, phase, believed, setting })
                    })*
                    LawRecipe::None { .. } | LawRecipe::Recorded { .. } => return None,
                };
                Some(Law { translation, rotation, believed: *believed })
            }

            /// The gains at a path: `before.rotation.slope`.
            pub fn field(&mut self, path: &str) -> Option<&mut [f64]> {
                match self {
                    $(LawRecipe::$law(gains) => gains.field(path),)*
                    LawRecipe::None { .. } | LawRecipe::Recorded { .. } => None,
                }
            }
        }
    };
}

laws! {
    /// Proportional–derivative.
    Pd(pd::Gains) => pd::channels,
    /// Linear quadratic regulator.
    Lqr(lqr::Weights) => lqr::channels,
    /// "Second-order" sliding mode, as the paper calls it.
    Sosmc(sosmc::Gains) => sosmc::channels,
    /// Terminal sliding mode.
    Tsmc(tsmc::Gains) => tsmc::channels,
    /// Power rate reaching law sliding mode.
    Prrl(prrl::Gains) => prrl::channels,
    /// Super-twisting sliding mode.
    Stsmc(stsmc::Gains) => stsmc::channels,
}

impl LawRecipe {
    /// The open-loop segments; empty for a law.
    pub fn segments(&self) -> &[Segment] {
        match self {
            LawRecipe::None { segments } | LawRecipe::Recorded { segments, .. } => segments,
            _ => &[],
        }
    }
}
