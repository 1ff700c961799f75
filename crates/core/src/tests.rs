//! What the tests of all rooms share: reproducible random numbers and comparisons that say what they met.

use crate::number::{Mat3, Quat, Stream, Vec3};

/// Random numbers, reproducible: the same name gives the same sequence.
pub struct Random {
    stream: Stream<f64>,
    drawn: u32,
}

impl Random {
    pub fn new(seed: u64) -> Self {
        Self { stream: Stream::new(seed, |_| 0), drawn: 0 }
    }

    /// Uniform in (low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.drawn += 1;
        low + (high - low) * self.stream.uniforms(self.drawn, 0)[0]
    }

    /// Uniform in (-size, size) per component.
    pub fn vector(&mut self, size: f64) -> Vec3<f64> {
        Vec3([0; 3].map(|_| self.between(-size, size)))
    }

    /// Uniform over all attitudes.
    pub fn attitude(&mut self) -> Quat<f64> {
        self.drawn += 1;
        Quat(self.stream.normals(self.drawn, 1)).normalized()
    }

    /// Of a body with mass everywhere on its random principal axes: triangle inequality holds, products of inertia do not vanish.
    pub fn inertia(&mut self, size: f64) -> Mat3<f64> {
        let [a, b, c] = [0; 3].map(|_| self.between(0.1 * size, size));
        let axes = self.attitude().to_matrix();
        let tensor = axes * Mat3::diagonal(Vec3([b + c, a + c, a + b])) * axes.transpose();
        (tensor + tensor.transpose()).scale(0.5)
    }
}

/// Fails unless |got - want| ≤ tolerance in every component; NaN fails.
#[track_caller]
pub fn assert_near(got: &[f64], want: &[f64], tolerance: f64) {
    let near = got.iter().zip(want).all(|(a, b)| (a - b).abs() <= tolerance);
    assert!(near && got.len() == want.len(), "{got:?} is not {want:?} to {tolerance:e}");
}

/// Angle between two attitudes \[rad\], accurate near 0.
pub fn angle_between(p: Quat<f64>, q: Quat<f64>) -> f64 {
    let error = p.conjugate() * q;
    2.0 * error.vector().norm().atan2(error.scalar().abs())
}

/// Slope of ln(error) over ln(step) by least squares: the order of convergence.
pub fn fitted_order(steps: &[f64], errors: &[f64]) -> f64 {
    let count = steps.len() as f64;
    let mean = |v: &[f64]| v.iter().map(|x| x.ln()).sum::<f64>() / count;
    let (x0, y0) = (mean(steps), mean(errors));
    let pairs = || steps.iter().zip(errors).map(|(x, y)| (x.ln() - x0, y.ln() - y0));
    pairs().map(|(x, y)| x * y).sum::<f64>() / pairs().map(|(x, _)| x * x).sum::<f64>()
}

/// Numbers for the eye: two digits each.
pub fn brief(numbers: &[f64]) -> String {
    numbers.iter().map(|x| format!("{x:.1e}")).collect::<Vec<_>>().join(", ")
}
