//! What acts on the bodies besides their actuators: a sum of parts without memory, evaluated within the integration step.
//!
//! Before capture each body has its own. After it the stack has what acts on a body as a whole, and the loads of both bodies,
//! each at the centre of mass and in the axes of the body that it began on.

pub mod constant;
pub mod gravity_gradient;

use self::constant::{Constant, ConstantLoad, LoadAxes};
use self::gravity_gradient::GravityGradient;
use super::wrench::Wrench;
use crate::case_struct;
use crate::number::{Mat3, Quat, Real, Vec3};
use crate::part::Part;

/// Which disturbances act: the same in every flight of a batch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Acting {
    /// The axes in which loads are constant.
    pub constant: LoadAxes,
    /// The gravity gradient.
    pub gravity_gradient: bool,
}

impl Acting {
    /// Whether there is any.
    #[inline(always)]
    pub fn any(self) -> bool {
        self != Self::default()
    }
}

case_struct! {
    /// The numbers of all disturbances.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
    pub struct Disturbances<R> {
        /// Forces and torques that stay.
        pub constant: Constant<R>,
    }
}

/// Which body a disturbance acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// The chaser, after capture the stack.
    Chaser,
    /// The debris.
    Debris,
}

/// A body as a disturbance finds it.
#[derive(Clone, Copy, Debug)]
pub struct Exposed<'a, R> {
    /// Which one.
    pub which: Which,
    /// Body -> H.
    pub to_lvlh: Quat<R>,
    /// About its centre of mass, body axes \[kg m²\].
    pub inertia: &'a Mat3<R>,
    /// n \[rad/s\].
    pub mean_motion: R,
}

impl Disturbances<f64> {
    /// Of size zero.
    pub fn none() -> Self {
        let zero = Vec3::zero();
        Self { constant: Constant { chaser_force: zero, chaser_torque: zero, debris_force: zero, debris_torque: zero } }
    }
}

impl<R: Real> Disturbances<R> {
    /// What acts on a body as a whole, its axes.
    #[inline(always)]
    pub fn on_whole(&self, acting: Acting, body: &Exposed<'_, R>) -> Wrench<R> {
        if acting.gravity_gradient { GravityGradient.step(&mut (), body) } else { Wrench::zero() }
    }

    /// What stays with a body when it is joined to another, its axes.
    #[inline(always)]
    pub fn loads(&self, acting: Acting, body: &Exposed<'_, R>) -> Wrench<R> {
        ConstantLoad { loads: &self.constant, axes: acting.constant }.step(&mut (), body)
    }
}
