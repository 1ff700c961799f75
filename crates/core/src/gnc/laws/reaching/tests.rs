use super::*;
use crate::tests::assert_near;

impl Reaching<f64> {
    /// ṡ at the first step of a flight.
    fn rate(&self, s: Vec3<f64>) -> Vec3<f64> {
        self.step(&mut self.begin(), s, 0.1)
    }
}

fn law(gain: f64, layer: f64, shape: Shape<f64>) -> Reaching<f64> {
    Reaching::new(Vec3([gain; 3]), Vec3([layer; 3]), shape)
}

fn proportional(alpha: f64) -> Shape<f64> {
    Shape::Proportional(Proportional { proportional: Vec3([alpha; 3]) })
}

fn power(exponent: f64, inside: Form) -> Shape<f64> {
    Shape::PowerRate(PowerRate { exponent, inside })
}

/// Time of s from `from` down to `to` under the law's own ṡ: RK4 in steps that change s by about 2e-3 of itself.
fn time_between(law: &Reaching<f64>, from: f64, to: f64) -> f64 {
    let rate = |s: f64| law.rate(Vec3([s, 1.0, 1.0]))[0];
    let (mut s, mut time) = (from, 0.0);
    while s > to {
        let h = 2e-3 * s / -rate(s);
        let k1 = rate(s);
        let k2 = rate(s + 0.5 * h * k1);
        let k3 = rate(s + 0.5 * h * k2);
        let k4 = rate(s + h * k3);
        let next = s + h * (k1 + 2.0 * (k2 + k3) + k4) / 6.0;
        // The last step by its share.
        time += h * ((s - to) / (s - next)).min(1.0);
        s = next;
    }
    time
}

#[test]
fn rates_have_their_known_values() {
    // s = (0.04, -0.09, 0.25), K = 2, φ = 0.1: sat = (0.4, -0.9, 1). α = 1/2: √|s| = (0.2, 0.3, 0.5).
    let s = Vec3([0.04, -0.09, 0.25]);
    let rate = |shape| law(2.0, 0.1, shape).rate(s).0;
    assert_near(&rate(proportional(0.0)), &[-0.8, 1.8, -2.0], 1e-15);
    assert_near(&rate(proportional(3.0)), &[-0.92, 2.07, -2.75], 1e-15);
    assert_near(&rate(power(0.5, Form::Printed)), &[-0.16, 0.54, -1.0], 1e-15);
    // Inside the layer √0.1 = 0.316 227 766 stands for √|s|.
    assert_near(&rate(power(0.5, Form::Corrected)), &[-0.252982213, 0.569209979, -1.0], 1e-9);
}

#[test]
fn laws_are_odd_vanish_on_the_surface_and_are_continuous_at_the_layer() {
    for shape in [proportional(0.0), proportional(0.7), power(0.7, Form::Printed), power(0.7, Form::Corrected)] {
        let law = law(0.3, 0.05, shape);
        assert_eq!(law.rate(Vec3::zero()).abs(), Vec3::zero());
        let s = Vec3([0.02, 0.05, 0.4]);
        assert_eq!(law.rate(-s), -law.rate(s));
        let [inner, outer] = [0.05 * (1.0 - 1e-12), 0.05 * (1.0 + 1e-12)].map(|s| law.rate(Vec3([s; 3])));
        assert_near(&inner.0, &outer.0, 1e-11);
    }
}

#[test]
fn each_axis_has_its_own_gain_and_layer() {
    let shape = Shape::Proportional(Proportional { proportional: Vec3([0.0, 1.0, 2.0]) });
    let law = Reaching::new(Vec3([1.0, 2.0, 3.0]), Vec3([0.1, 0.2, 0.4]), shape);
    // sat = (1, 0.5, 0.25).
    assert_near(&law.rate(Vec3([0.1; 3])).0, &[-1.0, -1.1, -0.95], 1e-15);
}

#[test]
fn reaching_times_are_the_exact_ones() {
    // SPEC, "What does not hold up", 5: K = 1, s0 = 1. A layer this thin takes no part: φ^(1-α) < 1e-12.
    let thin = 1e-120;
    for (alpha, seconds) in [(0.3, 1.43), (0.5, 2.00), (0.7, 3.33), (0.9, 10.0)] {
        let time = time_between(&law(1.0, thin, power(alpha, Form::Printed)), 1.0, thin);
        println!("power rate {alpha}: {time:.6} s");
        assert_near(&[time], &[1.0 / (1.0 - alpha)], 1e-5 * time);
        assert_near(&[time], &[seconds], 5e-3);
    }
    let constant = time_between(&law(1.0, thin, proportional(0.0)), 1.0, thin);
    assert_near(&[constant], &[1.0], 1e-9);
    let both = time_between(&law(1.0, thin, proportional(1.0)), 1.0, thin);
    assert_near(&[both], &[2f64.ln()], 1e-6);
    assert_near(&[both], &[0.693], 5e-4);
}

#[test]
fn reaching_times_to_the_layer_are_those_of_the_module_head() {
    let (gain, layer, start) = (0.4, 0.05, 2.0_f64);
    let exact = [
        (proportional(0.0), (start - layer) / gain),
        (proportional(0.6), ((gain + 0.6 * start) / (gain + 0.6 * layer)).ln() / 0.6),
        (power(0.7, Form::Printed), (start.powf(0.3) - layer.powf(0.3)) / (gain * 0.3)),
        (power(0.7, Form::Corrected), (start.powf(0.3) - layer.powf(0.3)) / (gain * 0.3)),
    ];
    for (shape, seconds) in exact {
        assert_near(&[time_between(&law(gain, layer, shape), start, layer)], &[seconds], 1e-5 * seconds);
    }
}

#[test]
fn power_rate_is_slow_inside_the_layer_as_printed_and_exponential_as_corrected() {
    // SPEC, 4: from φ to φ/10, φ = 0.01, K = 1, α = 0.7: printed 1.44 s, plain sat 0.023 s.
    let time = |shape| time_between(&law(1.0, 0.01, shape), 0.01, 0.001);
    assert_near(&[time(power(0.7, Form::Printed))], &[1.44], 5e-3);
    assert_near(&[time(proportional(0.0))], &[0.023], 5e-4);
    // Corrected: rate φ^(α-1) = 100^0.3 = 3.981, ln 10/3.981 = 0.578 s for each decade.
    let corrected = time(power(0.7, Form::Corrected));
    assert_near(&[corrected], &[0.5784], 1e-4);
    let next = time_between(&law(1.0, 0.01, power(0.7, Form::Corrected)), 0.001, 0.0001);
    assert_near(&[next], &[corrected], 1e-5);
}

/// L of the disturbances that super-twisting is tested against.
const SLOPE: f64 = 0.2;

fn super_twisting() -> Reaching<f64> {
    let (k1, k2) = (1.5 * SLOPE.sqrt(), 1.1 * SLOPE);
    Reaching::SuperTwisting(SuperTwisting { k1: Vec3([k1; 3]), k2: Vec3([k2; 3]) })
}

/// A constant, a ramp of the largest slope, and one that turns: d(t) [s-units per s] and slopes of at most L.
fn disturbances(t: f64) -> Vec3<f64> {
    Vec3([0.3, SLOPE * t, (SLOPE * t).sin()])
}

/// ṡ = u + d with u held over the period, from s0 for 40 s; d through its mean over the period, which is exact.
/// Gives the last time at which |s| was over `band` on each axis, largest |s| after 30 s, and v + d at the end.
fn reached(period: f64, band: f64) -> (Vec3<f64>, Vec3<f64>, Vec3<f64>) {
    let (law, start) = (super_twisting(), Vec3([0.5, -0.4, 0.3]));
    let (mut memory, mut s) = (law.begin(), start);
    let (mut last, mut largest) = (Vec3::zero(), Vec3::zero());
    let steps = (40.0 / period).round() as u32;
    for k in 0..steps {
        let t = f64::from(k) * period;
        let mean = (disturbances(t) + disturbances(t + 0.5 * period) * 4.0 + disturbances(t + period)) * (1.0 / 6.0);
        s = s + (law.step(&mut memory, s, period) + mean) * period;
        memory.grow(&[false; 3]);
        for i in 0..3 {
            if s[i].abs() > band {
                last.0[i] = t + period;
            }
            if t > 30.0 {
                largest.0[i] = f64::max(largest[i], s[i].abs());
            }
        }
    }
    let ChannelMemory::Integral(v) = memory else { panic!("super-twisting has an integral") };
    (last, largest, v.value + disturbances(40.0))
}

/// The same system without sampling, s and v through RK4 at 0.1 ms: the last time at which |s| was over `band`.
fn reached_finely(axis: usize, band: f64) -> f64 {
    let (k1, k2) = (1.5 * SLOPE.sqrt(), 1.1 * SLOPE);
    let rate = |t: f64, [s, v]: [f64; 2]| {
        let sign = if s > 0.0 {
            1.0
        } else if s < 0.0 {
            -1.0
        } else {
            0.0
        };
        [-k1 * s.abs().sqrt() * sign + v + disturbances(t)[axis], -k2 * sign]
    };
    let (mut y, mut last, h) = ([[0.5, -0.4, 0.3][axis], 0.0], 0.0, 1e-4);
    for k in 0..400_000 {
        let t = f64::from(k) * h;
        let ahead = |y: [f64; 2], k: [f64; 2], h: f64| [y[0] + h * k[0], y[1] + h * k[1]];
        let a = rate(t, y);
        let b = rate(t + 0.5 * h, ahead(y, a, 0.5 * h));
        let c = rate(t + 0.5 * h, ahead(y, b, 0.5 * h));
        let d = rate(t + h, ahead(y, c, h));
        y = ahead(y, [0, 1].map(|i| a[i] + 2.0 * (b[i] + c[i]) + d[i]), h / 6.0);
        if y[0].abs() > band {
            last = t + h;
        }
    }
    last
}

#[test]
fn super_twisting_reaches_the_surface_in_finite_time_under_disturbances_of_bounded_slope() {
    let band = 1e-4;
    let (last, largest, left) = reached(1e-3, band);
    for axis in 0..3 {
        let fine = reached_finely(axis, band);
        println!(
            "axis {axis}: reached after {:.3} s, finely {fine:.3} s; then |s| < {:.1e}",
            last[axis], largest[axis]
        );
        assert!((last[axis] - fine).abs() < 0.02 * fine, "axis {axis}: {} against {fine}", last[axis]);
        assert!(left[axis].abs() < 2e-3, "v has learnt the disturbance: {}", left[axis]);
    }
    assert!(last.max_component() < 30.0, "before the band was measured");
}

#[test]
fn the_band_of_super_twisting_shrinks_with_the_square_of_the_period() {
    for period in [0.08, 0.04, 0.02, 0.01, 0.005] {
        let widest = reached(period, 1.0).1.max_component();
        println!("super-twisting: period {period}, band {:.2} L T²", widest / (SLOPE * period * period));
        assert!(widest < 8.0 * SLOPE * period * period, "{period}: {widest}");
    }
}

#[test]
fn an_integral_is_held_on_saturated_axes_and_begins_anew_at_capture() {
    let law = super_twisting();
    let mut memory = law.begin();
    for saturated in [[false; 3], [true, false, false]] {
        law.step(&mut memory, Vec3([1.0, -1.0, 1.0]), 0.5);
        memory.grow(&saturated);
    }
    let ChannelMemory::Integral(v) = memory else { panic!("super-twisting has an integral") };
    let step = 1.1 * SLOPE * 0.5;
    assert_near(&v.value.0, &[-step, 2.0 * step, -2.0 * step], 1e-15);
    memory.reset(false);
    assert_eq!(memory, ChannelMemory::Integral(v));
    memory.reset(true);
    assert_eq!(memory, ChannelMemory::integral());
}
