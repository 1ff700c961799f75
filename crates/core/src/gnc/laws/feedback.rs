//! Linear feedback of error and rate.
//!
//! ```text
//! u = -K_e e - K_r r
//! ```

use crate::batch_struct;
use crate::number::{Mat3, Real, Vec3};

batch_struct! {
    /// Gains of a linear channel.
    pub struct LinearFeedback<R> {
        /// K_e: \[N/m\] or \[N m\].
        pub error: Mat3<R>,
        /// K_r: \[N s/m\] or \[N m s\].
        pub rate: Mat3<R>,
        /// 1: rotation damps the body's own rate ω; 0: the rate error e_ω.
        pub damps_own_rate: R,
    }
}

impl<R: Real> LinearFeedback<R> {
    /// u, the force \[N\] or torque \[N m\] demanded.
    #[inline(always)]
    pub fn demand(&self, error: Vec3<R>, rate: Vec3<R>) -> Vec3<R> {
        -(self.error * error + self.rate * rate)
    }

    /// The rate that rotation damps: ω or e_ω.
    #[inline(always)]
    pub fn damped_rate(&self, own: Vec3<R>, error: Vec3<R>) -> Vec3<R> {
        Vec3::select(R::splat(0.5).lt(self.damps_own_rate), own, error)
    }
}
