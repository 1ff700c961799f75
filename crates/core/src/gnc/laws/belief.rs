//! What a law believes of the body that it flies.

use crate::number::Mat3;
use crate::{batch_struct, case_struct};

batch_struct! {
    /// What a law believes of the body it flies.
    pub struct MassProperties<R> {
        /// \[kg\]
        pub mass: R,
        /// C axes \[kg m²\].
        pub inertia: Mat3<R>,
    }
}

case_struct! {
    /// What the laws believe of the mass \[kg\] and inertia \[kg m²\] they fly.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
    pub struct Belief<R> {
        /// Before capture.
        pub chaser_mass: R,
        /// Before capture, C axes.
        pub chaser_inertia: Mat3<R>,
        /// After capture, unless the plan tells the laws the truth.
        pub stack_mass: R,
        /// After capture, C axes.
        pub stack_inertia: Mat3<R>,
    }
}

/// What the laws believe of the stack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum StackBelief {
    /// The design: mass and inertia that the case gives.
    Design,
    /// Its true mass and inertia at capture.
    True,
}
