//! A force and a torque, and the axes that they are given in.

use crate::batch_struct;
use crate::number::{Real, Vec3};
use core::ops::Add;

batch_struct! {
    /// A force \[N\] and a torque \[N m\].
    pub struct Wrench<R> {
        /// In the axes that its [`WrenchFrame`] names.
        pub force: Vec3<R>,
        /// Likewise.
        pub torque: Vec3<R>,
    }
}

impl<R: Real> Wrench<R> {
    /// No force, no torque.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { force: Vec3::zero(), torque: Vec3::zero() }
    }
}

impl<R: Real> Add for Wrench<R> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { force: self.force + other.force, torque: self.torque + other.torque }
    }
}

/// A wrench as the actuators hold it over a control period.
#[derive(Clone, Copy, Debug)]
pub struct Held<R> {
    /// Force and torque.
    pub wrench: Wrench<R>,
    /// Their axes.
    pub frame: WrenchFrame,
}

/// The axes in which a wrench is given, and in which it is held over the period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum WrenchFrame {
    /// Force in H, torque in body axes: what the laws command.
    Command,
    /// Both in H.
    Lvlh,
    /// Both in the chaser's body axes.
    Body,
}
