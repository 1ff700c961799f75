//! Rigid bodies: as a scenario gives them, and the one that flies.

use super::attitude::Inertia;
use crate::number::{Mat3, Real, Vec3};
use crate::{batch_struct, case_struct};

case_struct! {
    /// A rigid body.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
    pub struct Body<R> {
        /// Mass \[kg\].
        pub mass: R,
        /// Inertia about the centre of mass, body axes \[kg m²\].
        pub inertia: Mat3<R>,
        /// Grasp point, body axes \[m\]; zero when the plan has none.
        pub grasp_point: Vec3<R>,
    }
}

batch_struct! {
    /// The body that flies: the chaser, after capture the stack.
    pub struct Vehicle<R> {
        /// \[kg\]
        pub mass: R,
        /// \[1/kg\]
        pub inverse_mass: R,
        /// About its centre of mass, C axes.
        pub inertia: Inertia<R>,
    }
}

impl<R: Real> Vehicle<R> {
    /// From mass \[kg\] and inertia.
    #[inline(always)]
    pub fn new(mass: R, inertia: Inertia<R>) -> Self {
        Self { mass, inverse_mass: R::one() / mass, inertia }
    }
}
