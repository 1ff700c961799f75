//! Capture: every quantity strictly below its threshold, all at once, held for a dwell time.

use super::error::TrackingError;
use crate::batch_struct;
use crate::case_struct;
use crate::number::{Real, Vec3};
use crate::plant::motion::Motion;

case_struct! {
    /// Capture holds while every quantity is strictly below its threshold.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
    pub struct CaptureThresholds<R> {
        /// \[m\]
        pub distance: R,
        /// Of the attitude error \[rad\].
        pub angle: R,
        /// Relative angular rate \[rad/s\].
        pub rate: R,
        /// Relative speed \[m/s\]; infinite when the scenario sets none.
        pub speed: R,
    }
}

case_struct! {
    /// The stack is settled once it stays below both until the end of the flight.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
    pub struct SettledThresholds<R> {
        /// Stack axes against H \[rad\].
        pub angle: R,
        /// Rate relative to H \[rad/s\].
        pub rate: R,
    }
}

batch_struct! {
    /// Thresholds in the form in which they are compared: no root, no arc cosine in the loop.
    pub struct CaptureTest<R> {
        /// Distance² \[m²\].
        pub distance_squared: R,
        /// sin² of half the angle, to hold against |ε|²: unlike the cosine it stays sharp at small angles.
        pub sin_squared: R,
        /// Rate² \[rad²/s²\].
        pub rate_squared: R,
        /// Speed² \[m²/s²\].
        pub speed_squared: R,
    }
}

impl CaptureTest<f64> {
    /// From the thresholds as a person writes them.
    pub fn new(thresholds: &CaptureThresholds<f64>) -> Self {
        Self {
            distance_squared: thresholds.distance.powi(2),
            sin_squared: (0.5 * thresholds.angle).sin().powi(2),
            rate_squared: thresholds.rate.powi(2),
            speed_squared: thresholds.speed.powi(2),
        }
    }
}

/// What capture counts the distance from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum DistanceFrom {
    /// The goal: |r - r_des|.
    Goal,
    /// The debris: |r|.
    Debris,
}

impl DistanceFrom {
    /// The vector whose length counts \[m\].
    #[inline(always)]
    pub fn counted<R: Real>(self, motion: &Motion<R>, error: &TrackingError<R>) -> Vec3<R> {
        match self {
            DistanceFrom::Goal => error.position,
            DistanceFrom::Debris => motion.position,
        }
    }
}

/// The squares of what capture is judged by, at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Judged<R> {
    /// Distance² \[m²\].
    pub distance_squared: R,
    /// sin² of half the angle.
    pub sin_squared: R,
    /// Rate² \[rad²/s²\].
    pub rate_squared: R,
    /// Speed² \[m²/s²\].
    pub speed_squared: R,
}

impl<R: Real> Judged<R> {
    /// `error` is the true one, against the debris.
    #[inline(always)]
    pub fn of(error: &TrackingError<R>, motion: &Motion<R>, distance_from: DistanceFrom) -> Self {
        Self {
            distance_squared: distance_from.counted(motion, error).norm_squared(),
            sin_squared: error.attitude.vector().norm_squared(),
            rate_squared: error.rate.norm_squared(),
            speed_squared: error.velocity.norm_squared(),
        }
    }

    /// Lanes whose state is still made of numbers: whatever part of it leaves them, one of these squares does.
    #[inline(always)]
    pub fn is_finite(&self) -> R::Mask {
        (self.distance_squared + self.sin_squared + self.rate_squared + self.speed_squared).is_finite()
    }
}

impl<R: Real> CaptureTest<R> {
    /// Which lanes hold now.
    #[inline(always)]
    pub fn holds(&self, judged: &Judged<R>) -> R::Mask {
        judged.distance_squared.lt(self.distance_squared)
            & judged.sin_squared.lt(self.sin_squared)
            & judged.rate_squared.lt(self.rate_squared)
            & judged.speed_squared.lt(self.speed_squared)
    }
}

batch_struct! {
    /// Thresholds of a settled stack, likewise.
    pub struct SettledTest<R> {
        /// sin² of half the angle.
        pub sin_squared: R,
        /// Rate² \[rad²/s²\].
        pub rate_squared: R,
    }
}

impl SettledTest<f64> {
    /// From the thresholds as a person writes them.
    pub fn new(thresholds: &SettledThresholds<f64>) -> Self {
        Self { sin_squared: (0.5 * thresholds.angle).sin().powi(2), rate_squared: thresholds.rate.powi(2) }
    }
}

impl<R: Real> SettledTest<R> {
    /// Which lanes hold now. `error` is the true one, against H.
    #[inline(always)]
    pub fn holds(&self, error: &TrackingError<R>) -> R::Mask {
        error.attitude.vector().norm_squared().lt(self.sin_squared) & error.rate.norm_squared().lt(self.rate_squared)
    }
}

batch_struct! {
    /// The capture of each lane so far.
    pub struct CaptureState<R> {
        /// Ticks in a row for which the thresholds have held.
        pub held: R,
        /// Time of capture \[s\], infinite while there is none.
        pub time: R,
    }
}

impl<R: Real> CaptureState<R> {
    /// Nothing captured.
    #[inline(always)]
    pub fn open() -> Self {
        Self { held: R::zero(), time: R::splat(f64::INFINITY) }
    }

    /// Lanes that were captured at or before this time.
    #[inline(always)]
    pub fn captured(&self) -> R::Mask {
        self.time.lt(R::splat(f64::INFINITY))
    }

    /// Judges one tick; returns the lanes captured just now.
    #[inline(always)]
    pub fn judge(&mut self, holds: R::Mask, time: R, dwell_ticks: u32) -> R::Mask {
        self.held = R::select(holds, self.held + R::one(), R::zero());
        let newly = R::splat(f64::from(dwell_ticks)).lt(self.held) & !self.captured();
        self.time = R::select(newly, time, self.time);
        newly
    }
}

#[cfg(test)]
mod tests;
