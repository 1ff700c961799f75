//! The classical Runge–Kutta method of fourth order, fixed step.
//!
//! ```text
//! k1 = f(t, y)                 k2 = f(t + h/2, y + h/2 k1)
//! k3 = f(t + h/2, y + h/2 k2)  k4 = f(t + h, y + h k3)
//! y(t + h) = y + h (k1 + 2 k2 + 2 k3 + k4) / 6
//! ```
//!
//! Source: Hairer, Nørsett, Wanner, *Solving Ordinary Differential Equations I*, §II.1.

use crate::number::Real;

/// A right-hand side y' = f(t, y).
pub trait Dynamics<R: Real> {
    /// The state, and equally its rate of change.
    type State: Copy;

    /// The rate at a fraction (0, ½ or 1) of the step.
    fn rate(&self, fraction: f64, state: &Self::State) -> Self::State;

    /// state + time · rate.
    fn advance(state: &Self::State, time: R, rate: &Self::State) -> Self::State;
}

/// One step of length `h` \[s\].
#[inline(always)]
pub fn rk4_step<R: Real, D: Dynamics<R>>(dynamics: &D, state: &D::State, h: R) -> D::State {
    let k1 = dynamics.rate(0.0, state);
    D::advance(state, h * R::splat(1.0 / 6.0), &rk4_sum(dynamics, state, &k1, h))
}

/// k1 + 2 k2 + 2 k3 + k4, where the rate at the beginning, k1, is known already.
#[inline(always)]
pub fn rk4_sum<R: Real, D: Dynamics<R>>(dynamics: &D, state: &D::State, k1: &D::State, h: R) -> D::State {
    let half = h * R::splat(0.5);
    let k2 = dynamics.rate(0.5, &D::advance(state, half, k1));
    let k3 = dynamics.rate(0.5, &D::advance(state, half, &k2));
    let k4 = dynamics.rate(1.0, &D::advance(state, h, &k3));
    let two = R::splat(2.0);
    D::advance(&D::advance(&D::advance(k1, two, &k2), two, &k3), R::one(), &k4)
}

#[cfg(test)]
mod tests;
