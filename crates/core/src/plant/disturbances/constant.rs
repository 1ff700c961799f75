//! Forces and torques that stay as they are: solar pressure, drag over a short time, a leak.
//!
//! Assumptions: constant in body axes or in H, whatever the attitude; forces act at the centre of mass of their body.

use super::{Exposed, Which};
use crate::case_struct;
use crate::number::{Real, Vec3};
use crate::part::Part;
use crate::plant::wrench::Wrench;

case_struct! {
    /// Loads on both bodies, each in its body's axes or all in H.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
    pub struct Constant<R> {
        /// On the chaser \[N\].
        pub chaser_force: Vec3<R>,
        /// On the chaser \[N m\].
        pub chaser_torque: Vec3<R>,
        /// On the debris \[N\].
        pub debris_force: Vec3<R>,
        /// On the debris \[N m\].
        pub debris_torque: Vec3<R>,
    }
}

/// The axes in which loads are constant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum LoadAxes {
    /// There are no loads.
    #[default]
    None,
    /// Each load in the axes of its body.
    Body,
    /// H.
    Lvlh,
}

/// The loads, and their axes.
pub struct ConstantLoad<'a, R> {
    /// Forces and torques.
    pub loads: &'a Constant<R>,
    /// In which they are constant.
    pub axes: LoadAxes,
}

impl<R: Real> Part<R> for ConstantLoad<'_, R> {
    type Memory = ();
    type Input<'a> = &'a Exposed<'a, R>;
    type Output = Wrench<R>;

    fn begin(&self) {}

    #[inline(always)]
    fn step(&self, _: &mut (), body: &Exposed<'_, R>) -> Wrench<R> {
        let (force, torque) = match body.which {
            Which::Chaser => (self.loads.chaser_force, self.loads.chaser_torque),
            Which::Debris => (self.loads.debris_force, self.loads.debris_torque),
        };
        match self.axes {
            LoadAxes::None => Wrench::zero(),
            LoadAxes::Body => Wrench { force, torque },
            LoadAxes::Lvlh => {
                Wrench { force: body.to_lvlh.rotate_inverse(force), torque: body.to_lvlh.rotate_inverse(torque) }
            }
        }
    }
}
