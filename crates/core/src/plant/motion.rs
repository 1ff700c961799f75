//! Position, velocity, attitudes and rates: the 20 numbers of the state.

use super::attitude::Spin;
use crate::case_struct;
use crate::number::{Quat, Real, Vec3};

case_struct! {
    /// State of both bodies. After capture `position`, `velocity` and `chaser_*` are the stack's, and the debris is fixed to it.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
    pub struct Motion<R> {
        /// r_CD_H: chaser relative to the debris' orbit, in H \[m\].
        pub position: Vec3<R>,
        /// Its rate of change as seen in the turning H \[m/s\].
        pub velocity: Vec3<R>,
        /// C -> N.
        pub chaser_attitude: Quat<R>,
        /// omega_CN_C \[rad/s\].
        pub chaser_rate: Vec3<R>,
        /// D -> N.
        pub debris_attitude: Quat<R>,
        /// omega_DN_D \[rad/s\].
        pub debris_rate: Vec3<R>,
    }
}

impl<R: Real> Motion<R> {
    /// Attitude and rate of the chaser (after capture of the stack).
    #[inline(always)]
    pub fn chaser(&self) -> Spin<R> {
        Spin { attitude: self.chaser_attitude, rate: self.chaser_rate }
    }

    /// Attitude and rate of the debris.
    #[inline(always)]
    pub fn debris(&self) -> Spin<R> {
        Spin { attitude: self.debris_attitude, rate: self.debris_rate }
    }

    #[inline(always)]
    pub(crate) fn set_chaser(&mut self, spin: Spin<R>) {
        (self.chaser_attitude, self.chaser_rate) = (spin.attitude, spin.rate);
    }

    #[inline(always)]
    pub(crate) fn set_debris(&mut self, spin: Spin<R>) {
        (self.debris_attitude, self.debris_rate) = (spin.attitude, spin.rate);
    }
}

impl Motion<f64> {
    /// Name and width of each part of the state, in the order of [`Motion::numbers`].
    pub const PARTS: [(&str, usize); 6] = [
        ("position", 3),
        ("velocity", 3),
        ("chaser_attitude", 4),
        ("chaser_rate", 3),
        ("debris_attitude", 4),
        ("debris_rate", 3),
    ];
    /// How many numbers they are.
    pub const NUMBERS: usize = 20;

    /// The state, number by number.
    pub fn numbers(&self) -> impl Iterator<Item = f64> + use<> {
        let translation = self.position.0.into_iter().chain(self.velocity.0);
        let chaser = self.chaser_attitude.0.into_iter().chain(self.chaser_rate.0);
        let debris = self.debris_attitude.0.into_iter().chain(self.debris_rate.0);
        translation.chain(chaser).chain(debris)
    }
}
