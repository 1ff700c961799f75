use super::*;
use crate::tests::{brief, fitted_order};

/// y' = y cos t, so y = exp(sin t).
struct Swing {
    time: f64,
    step: f64,
}

impl Dynamics<f64> for Swing {
    type State = f64;

    fn rate(&self, fraction: f64, state: &f64) -> f64 {
        state * (self.time + fraction * self.step).cos()
    }

    fn advance(state: &f64, time: f64, rate: &f64) -> f64 {
        state + time * rate
    }
}

#[test]
fn order_is_four_with_time_in_the_right_hand_side() {
    let steps: [f64; 4] = [0.1, 0.05, 0.025, 0.0125];
    let errors = steps.map(|h| {
        let mut y = 1.0;
        for i in 0..(4.0 / h) as u32 {
            y = rk4_step(&Swing { time: f64::from(i) * h, step: h }, &y, h);
        }
        (y - 4.0_f64.sin().exp()).abs()
    });
    let order = fitted_order(&steps, &errors);
    println!("order {order:.3}, errors {}", brief(&errors));
    assert!((order - 4.0).abs() < 0.15);
}

#[test]
fn polynomials_of_third_degree_are_exact() {
    struct Cubic;
    impl Dynamics<f64> for Cubic {
        type State = f64;
        fn rate(&self, fraction: f64, _: &f64) -> f64 {
            let t = 2.0 * fraction;
            4.0 * t * t * t - 3.0 * t * t + 2.0 * t - 1.0
        }
        fn advance(state: &f64, time: f64, rate: &f64) -> f64 {
            state + time * rate
        }
    }
    // ∫ from 0 to 2: 16 - 8 + 4 - 2.
    assert!((rk4_step(&Cubic, &0.0, 2.0) - 10.0).abs() < 1e-14);
}
