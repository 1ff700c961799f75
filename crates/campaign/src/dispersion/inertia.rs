//! Random inertias, every one of which some rigid body has.
//!
//! An inertia I belongs to a body if and only if the second moments of its mass, Σ = ½ tr(I) 1 - I, are nowhere negative.
//!
//! ```text
//! Σ = V diag(λ) Vᵀ    Σ' = R V diag(λ exp(ρ z)) Vᵀ Rᵀ    I' = tr(Σ') 1 - Σ'
//! ```
//!
//! with independent normal z and a random turn R. So the triangle inequality holds for every draw, a flat body stays flat,
//! and the nominal principal second moments are the medians of the drawn ones.

use super::marginal::{Marginal, Quantile};
use super::rotation::{Turn, TurnSampler};
use serde::Deserialize;

type Matrix = [[f64; 3]; 3];

/// An inertia about the centre of mass.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InertiaDistribution {
    /// Symmetric, of a rigid body \[kg m²\].
    pub nominal: Matrix,
    /// Logarithm of the factor on each principal second moment.
    pub log_scale: Marginal,
    /// Of the principal axes.
    pub turn: Turn,
}

pub(super) struct InertiaSampler {
    moments: [f64; 3],
    /// Columns are the principal axes.
    axes: Matrix,
    log_scale: Quantile,
    turn: TurnSampler,
}

impl InertiaSampler {
    pub(super) fn new(distribution: &InertiaDistribution) -> Self {
        let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = distribution.nominal;
        let diagonal = [0.5 * (yy + zz - xx), 0.5 * (xx + zz - yy), 0.5 * (xx + yy - zz)];
        let (moments, axes) = eigen([[diagonal[0], -xy, -xz], [-xy, diagonal[1], -yz], [-xz, -yz, diagonal[2]]]);
        // Of a flat body rounding may leave less than nothing.
        let moments = moments.map(|moment| if moment > 0.0 { moment } else { 0.0 });
        Self {
            moments,
            axes,
            log_scale: Quantile::new(&distribution.log_scale),
            turn: TurnSampler::new(&distribution.turn),
        }
    }

    /// xx, yy, zz, xy, xz, yz from three numbers for the second moments and three for the turn.
    #[inline]
    pub(super) fn at(&self, [a, b, c, u, v, w]: [f64; 6]) -> [f64; 6] {
        let factors = [a, b, c].map(|a| libm::exp(self.log_scale.at(a)));
        let moments = [0, 1, 2].map(|k| self.moments[k] * factors[k]);
        let axes = match self.turn {
            TurnSampler::None => self.axes,
            _ => product(&self.turn.at([u, v, w]).matrix(), &self.axes),
        };
        let second = |i: usize, j: usize| {
            axes[i][0] * moments[0] * axes[j][0]
                + axes[i][1] * moments[1] * axes[j][1]
                + axes[i][2] * moments[2] * axes[j][2]
        };
        let (xx, yy, zz) = (second(0, 0), second(1, 1), second(2, 2));
        // Taken from 0.0, a zero keeps its sign.
        [yy + zz, xx + zz, xx + yy, 0.0 - second(0, 1), 0.0 - second(0, 2), 0.0 - second(1, 2)]
    }
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j]))
}

/// Eigenvalues of a symmetric matrix, and its eigenvectors as columns, in the order of the axes that they come from: a diagonal
/// matrix has exactly the coordinate axes.
///
/// Cyclic Jacobi rotations: Golub & Van Loan, "Matrix Computations", section 8.5.
fn eigen(mut a: Matrix) -> ([f64; 3], Matrix) {
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // Convergence is quadratic: some five sweeps do.
    for (p, q) in [(0, 1), (0, 2), (1, 2)].repeat(12) {
        if a[p][q] == 0.0 {
            continue;
        }
        let tau = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
        let t = 1f64.copysign(tau) / (tau.abs() + (1.0 + tau * tau).sqrt());
        let c = 1.0 / (1.0 + t * t).sqrt();
        let s = t * c;
        let turned = |x: f64, y: f64| (c * x - s * y, s * x + c * y);
        for row in &mut a {
            (row[p], row[q]) = turned(row[p], row[q]);
        }
        for k in [0, 1, 2] {
            (a[p][k], a[q][k]) = turned(a[p][k], a[q][k]);
        }
        (a[p][q], a[q][p]) = (0.0, 0.0);
        for row in &mut v {
            (row[p], row[q]) = turned(row[p], row[q]);
        }
    }
    ([a[0][0], a[1][1], a[2][2]], v)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distribution(nominal: Matrix, relative: f64, turn: Turn) -> InertiaSampler {
        let log_scale = Marginal::Normal { mean: 0.0, sigma: relative, low: -7.0 * relative, high: 7.0 * relative };
        InertiaSampler::new(&InertiaDistribution { nominal, log_scale, turn })
    }

    const FULL: Matrix = [[0.19, 0.012, -0.008], [0.012, 0.31, 0.010], [-0.008, 0.010, 0.29]];
    const MIDDLE: [f64; 6] = [0.5; 6];

    #[test]
    fn eigenvectors_rebuild_the_matrix() {
        let matrices = [
            FULL,
            [[1.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 1.0, 1.0]],
            [[1.0, 1e-170, 0.0], [1e-170, 2.0, 0.0], [0.0, 0.0, 3.0]],
            [[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 2.0]],
        ];
        for a in matrices {
            let (moments, v) = eigen(a);
            for i in 0..3 {
                for j in 0..3 {
                    let rebuilt: f64 = (0..3).map(|k| v[i][k] * moments[k] * v[j][k]).sum();
                    let unit: f64 = (0..3).map(|k| v[k][i] * v[k][j]).sum();
                    assert!((rebuilt - a[i][j]).abs() < 4e-15, "{a:?} {i} {j}: {rebuilt}");
                    assert!((unit - f64::from(u8::from(i == j))).abs() < 1e-15);
                }
            }
        }
        // 2 - 2 cos(k π/4), the discrete Laplacian.
        let (mut moments, _) = eigen(matrices[3]);
        moments.sort_by(f64::total_cmp);
        for (k, moment) in moments.iter().enumerate() {
            let exact = 2.0 - 2.0 * (core::f64::consts::FRAC_PI_4 * (k + 1) as f64).cos();
            assert!((moment - exact).abs() < 4e-15);
        }
    }

    #[test]
    fn the_median_draw_is_the_nominal_inertia() {
        let [xx, yy, zz, xy, xz, yz] = distribution(FULL, 0.2, Turn::None).at(MIDDLE);
        for (i, row) in [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].iter().enumerate() {
            for (drawn, nominal) in row.iter().zip(FULL[i]) {
                assert!((drawn - nominal).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn a_diagonal_inertia_stays_exactly_diagonal_and_a_flat_body_flat() {
        let flat = distribution([[0.05, 0.0, 0.0], [0.0, 0.08, 0.0], [0.0, 0.0, 0.13]], 0.3, Turn::None);
        for k in 1..100 {
            let u = f64::from(k) / 100.0;
            let [xx, yy, zz, xy, xz, yz] = flat.at([u, 0.3, 1.0 - u, 0.1, 0.2, 0.3]);
            assert_eq!([xy, xz, yz].map(f64::to_bits), [0; 3]);
            assert!((xx + yy - zz).abs() <= 1e-16 * zz, "{xx} {yy} {zz}");
        }
    }

    #[test]
    fn a_turn_keeps_the_principal_moments() {
        let turned = distribution(FULL, 0.0, Turn::Uniform);
        let (mut nominal, _) = eigen(FULL);
        nominal.sort_by(f64::total_cmp);
        for k in 1..100 {
            let u = f64::from(k) / 100.0;
            let [xx, yy, zz, xy, xz, yz] = turned.at([0.9, 0.1, 0.3, u, (7.0 * u).fract(), (13.0 * u).fract()]);
            let (mut drawn, _) = eigen([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
            drawn.sort_by(f64::total_cmp);
            for (drawn, nominal) in drawn.iter().zip(nominal) {
                assert!((drawn - nominal).abs() < 1e-15);
            }
        }
    }
}
