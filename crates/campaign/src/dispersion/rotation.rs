//! Random directions and turns.
//!
//! In plain arithmetic, where the core's own quaternions fuse multiply and add on some machines and not on others.

use super::marginal::{Marginal, Quantile};
use core::f64::consts::TAU;
use serde::Deserialize;

/// A vector by its direction and its length.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DirectionDistribution {
    /// Middle of the cone, any length but zero.
    pub about: [f64; 3],
    /// Half angle of the cone \[rad\]; π is the whole sphere.
    pub cone: f64,
    /// Of the length.
    pub magnitude: Marginal,
}

/// A random turn.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Turn {
    /// None at all.
    None,
    /// Every attitude alike: uniform on SO(3).
    Uniform,
    /// By a rotation vector of independent components \[rad\].
    Vector {
        /// Distribution of each.
        component: Marginal,
    },
}

pub(super) struct DirectionSampler {
    /// Two axes across the cone, and its own.
    axes: [[f64; 3]; 3],
    /// 1 - cos of the half angle.
    height: f64,
    magnitude: Quantile,
}

impl DirectionSampler {
    pub(super) fn new(distribution: &DirectionDistribution) -> Self {
        let half = libm::sin(0.5 * distribution.cone);
        Self {
            axes: axes_about(distribution.about),
            height: 2.0 * half * half,
            magnitude: Quantile::new(&distribution.magnitude),
        }
    }

    /// From numbers that give length, angle off the axis, and angle around it. By Archimedes the height of a uniform point
    /// on the cap is uniform.
    #[inline]
    pub(super) fn at(&self, [u, v, w]: [f64; 3]) -> [f64; 3] {
        let length = self.magnitude.at(u);
        let depth = self.height * v;
        let across = (depth * (2.0 - depth)).sqrt();
        let (sin, cos) = libm::sincos(TAU * w);
        let local = [across * cos, across * sin, 1.0 - depth];
        let [x, y, z] = &self.axes;
        [0, 1, 2].map(|i| length * (local[0] * x[i] + local[1] * y[i] + local[2] * z[i]))
    }
}

/// Three perpendicular unit vectors, the third along `v`.
///
/// Duff et al., "Building an orthonormal basis, revisited", J. Comput. Graph. Tech. 6 (2017) 1.
fn axes_about(v: [f64; 3]) -> [[f64; 3]; 3] {
    // Scaled first, since squares of small numbers vanish.
    let largest = v.iter().fold(0.0, |most: f64, x| if x.abs() > most { x.abs() } else { most });
    let scaled = v.map(|x| x / largest);
    let norm = (scaled[0] * scaled[0] + scaled[1] * scaled[1] + scaled[2] * scaled[2]).sqrt();
    let [x, y, z] = scaled.map(|component| component / norm);
    let sign = 1f64.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    [[1.0 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y], [x, y, z]]
}

pub(super) enum TurnSampler {
    None,
    Uniform,
    Vector(Quantile),
}

impl TurnSampler {
    pub(super) fn new(turn: &Turn) -> Self {
        match turn {
            Turn::None => Self::None,
            Turn::Uniform => Self::Uniform,
            Turn::Vector { component } => Self::Vector(Quantile::new(component)),
        }
    }

    /// Uniform turns: Shoemake, "Uniform random rotations", Graphics Gems III (1992) 124.
    #[inline]
    pub(super) fn at(&self, [u, v, w]: [f64; 3]) -> Quaternion {
        match self {
            Self::None => Quaternion([1.0, 0.0, 0.0, 0.0]),
            Self::Uniform => {
                let (r, s) = ((1.0 - u).sqrt(), u.sqrt());
                let ((sin_v, cos_v), (sin_w, cos_w)) = (libm::sincos(TAU * v), libm::sincos(TAU * w));
                Quaternion([s * cos_w, r * sin_v, r * cos_v, s * sin_w])
            }
            Self::Vector(component) => Quaternion::of_vector([u, v, w].map(|u| component.at(u))),
        }
    }
}

/// An attitude: scalar first, Hamilton product, body → reference.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quaternion(pub [f64; 4]);

impl Quaternion {
    /// The turn about a vector's direction by its length \[rad\].
    fn of_vector([x, y, z]: [f64; 3]) -> Self {
        let angle = (x * x + y * y + z * z).sqrt();
        let (sin, cos) = libm::sincos(0.5 * angle);
        let ratio = if angle > 1e-150 { sin / angle } else { 0.5 };
        Self([cos, ratio * x, ratio * y, ratio * z])
    }

    /// First `other`, then `self`, as rotations of components.
    pub(super) fn times(self, other: Self) -> Self {
        let ([a, b, c, d], [w, x, y, z]) = (self.0, other.0);
        Self([
            a * w - b * x - c * y - d * z,
            a * x + b * w + c * z - d * y,
            a * y - b * z + c * w + d * x,
            a * z + b * y - c * x + d * w,
        ])
    }

    /// Of unit norm, scalar part not negative.
    pub(super) fn canonical(self) -> Self {
        let [w, x, y, z] = self.0;
        let norm = (w * w + x * x + y * y + z * z).sqrt();
        let signed = if w < 0.0 { -norm } else { norm };
        Self(self.0.map(|component| component / signed))
    }

    /// The rotation matrix of a unit quaternion, by rows.
    pub(super) fn matrix(self) -> [[f64; 3]; 3] {
        let [w, x, y, z] = self.0;
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use detumble_core::number::{Quat, Vec3};

    fn uniforms(count: u32) -> impl Iterator<Item = [f64; 3]> {
        // A Kronecker sequence: evenly spread, no two alike.
        (1..=count).map(|k| [0.8191725134, 0.6710436067, 0.5497004779].map(|step: f64| (step * f64::from(k)).fract()))
    }

    #[test]
    fn plain_quaternions_agree_with_the_cores() {
        let (uniform, small) = (TurnSampler::Uniform, Marginal::Normal { mean: 0.0, sigma: 0.3, low: -2.1, high: 2.1 });
        let small = TurnSampler::new(&Turn::Vector { component: small });
        for u in uniforms(100) {
            let (p, q) = (uniform.at(u), small.at(u));
            let (core_p, core_q) = (Quat(p.0), Quat(q.0));
            let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 2e-15);
            assert!(close(&p.times(q).0, &(core_p * core_q).0));
            assert!(close(p.matrix().as_flattened(), core_p.to_matrix().0.as_flattened()));
            assert!(close(&p.canonical().0, &core_p.normalized().short_way().0));
            assert!((core_p.norm_squared() - 1.0).abs() < 1e-15);
            let phi = u.map(|u| 6.0 * u - 3.0);
            assert!(close(&Quaternion::of_vector(phi).0, &Quat::from_rotation_vector(Vec3(phi)).0));
        }
        assert_eq!(Quaternion::of_vector([0.0; 3]).0, [1.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn axes_are_perpendicular_whatever_the_direction() {
        let corners = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1e-200, 0.0, 0.0], [1e-9, 0.0, -1.0], [0.0, -1e150, 0.0]];
        for v in uniforms(50).map(|u| u.map(|u| u - 0.5)).chain(corners) {
            let axes = axes_about(v);
            for i in 0..3 {
                for j in 0..3 {
                    let dot: f64 = (0..3).map(|k| axes[i][k] * axes[j][k]).sum();
                    let expected = if i == j { 1.0 } else { 0.0 };
                    assert!((dot - expected).abs() < 4e-16, "{v:?} {i} {j}: {dot}");
                }
            }
        }
    }

    #[test]
    fn directions_keep_to_their_cone_and_length() {
        let about = [0.3, -0.4, 1.2];
        for cone in [1e-7, 0.1, 1.0, 3.0] {
            let distribution =
                DirectionDistribution { about, cone, magnitude: Marginal::Uniform { low: 0.02, high: 0.02 } };
            let sampler = DirectionSampler::new(&distribution);
            let mut widest = 0.0;
            for u in uniforms(300) {
                let v = Vec3(sampler.at(u));
                assert!((v.norm() - 0.02).abs() < 1e-17);
                let (sine, cosine) = (v.cross(Vec3(about)).norm(), v.dot(Vec3(about)));
                widest = f64::max(widest, sine.atan2(cosine));
            }
            assert!(widest <= cone * (1.0 + 1e-9) && widest > 0.97 * cone, "{cone}: {widest}");
        }
    }
}
