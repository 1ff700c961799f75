//! The continuous algebraic Riccati equation of a second-order system, by Newton's method (Kleinman 1968).
//!
//! ```text
//! x = [e; v],  e' = c v,  v' = S e + D v + B u
//! AᵀP + P A - P B R⁻¹ Bᵀ P + Q = 0,   K = R⁻¹ Bᵀ P,   u = -K x
//! ```
//!
//! Each step solves a Lyapunov equation for the closed loop of the last gain,
//!
//! ```text
//! (A - B K)ᵀ P + P (A - B K) = -(Q + Kᵀ R K),
//! ```
//!
//! and from any stabilising gain the steps converge to the solution monotonically, in the end quadratically. A gain
//! that cancels S and D and makes three damped oscillators of the rest is stabilising, whatever the system.

use super::lqr::Weights;
use crate::number::Mat3;

const STATES: usize = 6;
const PAIRS: usize = STATES * STATES;
type Matrix = [[f64; STATES]; STATES];

/// e' = c v, v' = S e + D v + B u.
pub struct System {
    /// c
    pub coupling: f64,
    /// S \[1/s²\].
    pub stiffness: Mat3<f64>,
    /// D \[1/s\].
    pub damping: Mat3<f64>,
    /// B, invertible.
    pub input: Mat3<f64>,
}

/// K, split into the gains of e and of v. NaN where weights lie so far apart that double precision has no answer.
pub fn gain(system: &System, weights: &Weights) -> [Mat3<f64>; 2] {
    let mut k = stabilising_gain(system, weights);
    let scales = state_scales(system, weights);
    let mut change = f64::INFINITY;
    for _ in 0..60 {
        let next = newton_step(system, weights, &scales, &k);
        change = largest_difference(&next, &k);
        k = next;
        if change < 1e-14 {
            break;
        }
    }
    // Rounding keeps the last changes above zero; a change that stays large is no solution.
    if change < 1e-9 { k } else { [Mat3([[f64::NAN; 3]; 3]); 2] }
}

/// v' = -c₁ e - c₂ v, with the gains of the scalar problem at the mean weights.
fn stabilising_gain(system: &System, weights: &Weights) -> [Mat3<f64>; 2] {
    let inverse = system.input.inverse();
    let mean = |v: [f64; 3]| (v[0] + v[1] + v[2]) / 3.0;
    let effort = inverse.trace().abs() / 3.0;
    let for_error = (mean(weights.q_error.0) / weights.r).sqrt() / effort;
    let for_rate = (mean(weights.q_rate.0) / weights.r / (effort * effort) + 2.0 * system.coupling * for_error).sqrt();
    [
        inverse * (system.stiffness + Mat3::from_scale(for_error)),
        inverse * (system.damping + Mat3::from_scale(for_rate)),
    ]
}

/// Units for e and v in which P is of the order of 1 on the whole diagonal: the size of each axis' own scalar solution.
/// Weights many decades apart would otherwise drown the small entries in the rounding of the large ones.
fn state_scales(system: &System, weights: &Weights) -> [f64; STATES] {
    let inverse = system.input.inverse();
    let mut scales = [1.0; STATES];
    for i in 0..3 {
        let (q_error, q_rate, r) = (weights.q_error.0[i], weights.q_rate.0[i], weights.r);
        let effort = inverse.0[i][i].abs();
        let cross = effort * (r * q_error).sqrt();
        let rate = effort * (r * (q_rate + 2.0 * system.coupling * cross)).sqrt();
        let error = cross * rate / (system.coupling * effort * effort * r);
        scales[i] = error.sqrt().recip();
        scales[i + 3] = rate.sqrt().recip();
    }
    scales
}

fn newton_step(system: &System, weights: &Weights, scales: &[f64; STATES], k: &[Mat3<f64>; 2]) -> [Mat3<f64>; 2] {
    let closed = [system.stiffness - system.input * k[0], system.damping - system.input * k[1]];
    let mut a: Matrix = [[0.0; STATES]; STATES];
    let mut cost: Matrix = [[0.0; STATES]; STATES];
    for i in 0..3 {
        a[i][i + 3] = system.coupling;
        cost[i][i] = weights.q_error.0[i];
        cost[i + 3][i + 3] = weights.q_rate.0[i];
        for j in 0..STATES {
            a[i + 3][j] = closed[j / 3].0[i][j % 3];
        }
    }
    for i in 0..STATES {
        for j in 0..STATES {
            for input in 0..3 {
                cost[i][j] += weights.r * k[i / 3].0[input][i % 3] * k[j / 3].0[input][j % 3];
            }
        }
    }
    for i in 0..STATES {
        for j in 0..STATES {
            a[i][j] *= scales[j] / scales[i];
            cost[i][j] *= scales[i] * scales[j];
        }
    }
    let p = lyapunov(&a, &cost);
    let transposed_input = system.input.transpose();
    let block = |column: usize| {
        let mut m = Mat3([[0.0; 3]; 3]);
        for i in 0..3 {
            for j in 0..3 {
                m.0[i][j] = p[i + 3][column + j] / (scales[i + 3] * scales[column + j]);
            }
        }
        (transposed_input * m).scale(1.0 / weights.r)
    };
    [block(0), block(3)]
}

/// P of AᵀP + P A = -C: 36 linear equations, by elimination with row exchange.
fn lyapunov(a: &Matrix, cost: &Matrix) -> Matrix {
    let mut equations = [[0.0; PAIRS + 1]; PAIRS];
    for i in 0..STATES {
        for j in 0..STATES {
            let row = &mut equations[STATES * i + j];
            for l in 0..STATES {
                row[STATES * l + j] += a[l][i];
                row[STATES * i + l] += a[l][j];
            }
            row[PAIRS] = -cost[i][j];
            let largest = row[..PAIRS].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            row.iter_mut().for_each(|x| *x /= largest);
        }
    }
    for column in 0..PAIRS {
        let size = |row: &[f64; PAIRS + 1]| row[column].abs();
        let pivot =
            (column..PAIRS).max_by(|&i, &j| size(&equations[i]).total_cmp(&size(&equations[j]))).unwrap_or(column);
        equations.swap(column, pivot);
        let pivot_row = equations[column];
        for row in equations.iter_mut().skip(column + 1) {
            let factor = row[column] / pivot_row[column];
            if factor != 0.0 {
                for l in column..=PAIRS {
                    row[l] -= factor * pivot_row[l];
                }
            }
        }
    }
    let mut solution = [0.0; PAIRS];
    for row in (0..PAIRS).rev() {
        let mut sum = equations[row][PAIRS];
        for l in row + 1..PAIRS {
            sum -= equations[row][l] * solution[l];
        }
        solution[row] = sum / equations[row][row];
    }
    let mut p = [[0.0; STATES]; STATES];
    for i in 0..STATES {
        for j in 0..STATES {
            p[i][j] = 0.5 * (solution[STATES * i + j] + solution[STATES * j + i]);
        }
    }
    p
}

/// Largest change of a gain, relative to the largest of its block.
fn largest_difference(a: &[Mat3<f64>; 2], b: &[Mat3<f64>; 2]) -> f64 {
    let mut worst: f64 = 0.0;
    for (a, b) in a.iter().zip(b) {
        let largest = a.0.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
        for (x, y) in a.0.iter().flatten().zip(b.0.iter().flatten()) {
            worst = worst.max((x - y).abs() / largest);
        }
    }
    worst
}

#[cfg(test)]
mod tests;
