//! Relative translation near a circular orbit (Hill–Clohessy–Wiltshire), in H: x radial out, y along-track, z normal.
//!
//! ```text
//! x'' - 2 n y' - 3 n² x = a_x
//! y'' + 2 n x'          = a_y
//! z'' + n² z            = a_z
//! ```
//!
//! Assumptions: circular target orbit, point-mass gravity, separation small against the orbit's radius (the error
//! grows with its square: 12 µm at 10 m, 1.2 mm at 100 m after 600 s in low Earth orbit), acceleration held in H.
//! Source: Clohessy & Wiltshire 1960; transition matrix as in Curtis, *Orbital Mechanics for Engineering Students*, ch. 7;
//! the response to a held acceleration is its integral.

use crate::batch_struct;
use crate::case_struct;
use crate::number::Quat;
use crate::number::{Real, Vec3};

case_struct! {
    /// The target's circular orbit.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
    pub struct Orbit<R> {
        /// Mean motion n \[rad/s\].
        pub mean_motion: R,
        /// Attitude of H at t = 0, H -> N.
        pub lvlh_attitude: Quat<R>,
    }
}

/// What orbit and turning frame do to a body by themselves: A(r, v) \[m/s²\].
#[inline(always)]
pub fn natural_acceleration<R: Real>(mean_motion: R, position: Vec3<R>, velocity: Vec3<R>) -> Vec3<R> {
    let n2 = mean_motion * mean_motion;
    let two_n = mean_motion + mean_motion;
    let [x, _, z] = position.0;
    let [vx, vy, _] = velocity.0;
    Vec3([two_n.mul_add(vy, R::splat(3.0) * n2 * x), -(two_n * vx), -(n2 * z)])
}

batch_struct! {
    /// The exact solution over a fixed time t under an acceleration held in H: the entries of its matrices that are
    /// neither 0 nor 1. With s = sin nt, c = cos nt:
    pub struct HeldStep<R> {
        /// t \[s\]
        pub time: R,
        /// c
        pub cos: R,
        /// s/n
        pub sin_by_n: R,
        /// 2 s
        pub two_sin: R,
        /// 4 - 3c
        pub x_from_x: R,
        /// 2 (1 - c)/n
        pub cross: R,
        /// (1 - c)/n²
        pub versine: R,
        /// 2 (nt - s)/n²
        pub lag: R,
        /// 6 (s - nt)
        pub y_from_x: R,
        /// (4 s - 3 nt)/n
        pub y_from_vy: R,
        /// 4 (1 - c)/n² - 3 t²/2
        pub y_from_ay: R,
        /// 3 n s
        pub vx_from_x: R,
        /// -6 n (1 - c)
        pub vy_from_x: R,
        /// 4 c - 3
        pub vy_from_vy: R,
        /// -n s
        pub vz_from_z: R,
    }
}

impl HeldStep<f64> {
    /// For mean motion n \[rad/s\] and time t \[s\].
    pub fn new(n: f64, t: f64) -> Self {
        let x = n * t;
        let (c1, c2, c3) = stumpff(x);
        let (s, versine) = (x * c1, x * x * c2);
        Self {
            time: t,
            cos: 1.0 - versine,
            sin_by_n: t * c1,
            two_sin: 2.0 * s,
            x_from_x: 1.0 + 3.0 * versine,
            cross: 2.0 * n * t * t * c2,
            versine: t * t * c2,
            lag: 2.0 * n * t * t * t * c3,
            y_from_x: -6.0 * x * x * x * c3,
            y_from_vy: t * (4.0 * c1 - 3.0),
            y_from_ay: t * t * (4.0 * c2 - 1.5),
            vx_from_x: 3.0 * n * s,
            vy_from_x: -6.0 * n * versine,
            vy_from_vy: 1.0 - 4.0 * versine,
            vz_from_z: -n * s,
        }
    }
}

/// sin x / x, (1 - cos x)/x², (x - sin x)/x³, without cancellation at small x.
fn stumpff(x: f64) -> (f64, f64, f64) {
    if x.abs() > 0.7 {
        let (s, c) = x.sin_cos();
        return (s / x, (1.0 - c) / (x * x), (x - s) / (x * x * x));
    }
    // Σ (-x²)^k / (2k + m)!, m = 1, 2, 3; nine terms reach 2⁻⁵³ at x = 0.7.
    let series = |m: u32| {
        let mut sum = 0.0;
        for k in (0..9).rev() {
            sum = 1.0 - x * x / f64::from((2 * k + m + 1) * (2 * k + m + 2)) * sum;
        }
        sum / f64::from((1..=m).product::<u32>())
    };
    (series(1), series(2), series(3))
}

impl<R: Real> HeldStep<R> {
    /// Position \[m\] and velocity \[m/s\] after the step under acceleration \[m/s²\] held in H.
    #[inline(always)]
    pub fn advance(&self, position: Vec3<R>, velocity: Vec3<R>, acceleration: Vec3<R>) -> (Vec3<R>, Vec3<R>) {
        let [x, y, z] = position.0;
        let [vx, vy, vz] = velocity.0;
        let [ax, ay, az] = acceleration.0;
        let (s_n, versine, cross, lag) = (self.sin_by_n, self.versine, self.cross, self.lag);

        let new_x = self.x_from_x.mul_add(x, s_n.mul_add(vx, cross.mul_add(vy, versine.mul_add(ax, lag * ay))));
        let new_y = y + self
            .y_from_x
            .mul_add(x, self.y_from_vy.mul_add(vy, self.y_from_ay.mul_add(ay, -cross.mul_add(vx, lag * ax))));
        let new_z = self.cos.mul_add(z, s_n.mul_add(vz, versine * az));
        let new_vx =
            self.cos.mul_add(vx, self.vx_from_x.mul_add(x, self.two_sin.mul_add(vy, s_n.mul_add(ax, cross * ay))));
        let new_vy = self
            .vy_from_vy
            .mul_add(vy, self.vy_from_x.mul_add(x, self.y_from_vy.mul_add(ay, -self.two_sin.mul_add(vx, cross * ax))));
        let new_vz = self.cos.mul_add(vz, self.vz_from_z.mul_add(z, s_n * az));
        (Vec3([new_x, new_y, new_z]), Vec3([new_vx, new_vy, new_vz]))
    }
}

#[cfg(test)]
mod tests;
