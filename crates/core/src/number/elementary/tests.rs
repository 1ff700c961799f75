//! Against the standard library (glibc's is within 0.6 units in the last place of the truth), on every back end that the CPU has.

use super::super::{Backend, Job, Real, dispatch};
use core::f64::consts::{PI, TAU};

#[derive(Clone, Copy, Debug)]
enum Function {
    Exp,
    Ln,
    Powf,
    Sin,
    Cos,
    SinTurns,
    CosTurns,
}
use Function::*;

/// A function over many arguments; lanes past the end repeat the last.
struct Map<'a> {
    function: Function,
    arguments: &'a [[f64; 2]],
}

impl Job for Map<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run<R: Real>(self) -> Vec<f64> {
        let mut values = Vec::new();
        for chunk in self.arguments.chunks(R::LANES) {
            let x = R::from_fn(|i| chunk[i.min(chunk.len() - 1)][0]);
            let a = R::from_fn(|i| chunk[i.min(chunk.len() - 1)][1]);
            let y = match self.function {
                Exp => x.exp(),
                Ln => x.ln(),
                Powf => x.powf(a),
                Sin => x.sin_cos().0,
                Cos => x.sin_cos().1,
                SinTurns => x.sin_cos_turns().0,
                CosTurns => x.sin_cos_turns().1,
            };
            values.extend((0..chunk.len()).map(|i| y.lane(i)));
        }
        values
    }
}

fn evaluate(backend: Backend, function: Function, arguments: &[[f64; 2]]) -> Vec<f64> {
    dispatch(backend, Map { function, arguments })
}

fn expected(function: Function, [x, a]: [f64; 2]) -> f64 {
    match function {
        Exp => f64::exp(x),
        Ln => f64::ln(x),
        Powf => f64::powf(x, a),
        Sin => f64::sin(x),
        Cos => f64::cos(x),
        SinTurns => sin_cos_of_turns(x).0,
        CosTurns => sin_cos_of_turns(x).1,
    }
}

/// 2πu rounded would spoil the comparison: take off whole eighths exactly, carry the rest of the product.
fn sin_cos_of_turns(u: f64) -> (f64, f64) {
    let quarters = (4.0 * u).round();
    let turns = u - 0.25 * quarters;
    let angle = turns * TAU;
    let rest = turns.mul_add(TAU, -angle) + turns * super::TAU_REST;
    let (s, c) = (angle.sin(), angle.cos());
    let (s, c) = (rest.mul_add(c, s), (-rest).mul_add(s, c));
    match quarters as i64 & 3 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// Distance in units in the last place.
fn ulps(a: f64, b: f64) -> u64 {
    let ordered = |x: f64| {
        let bits = x.to_bits() as i64;
        if bits < 0 { i64::MIN - bits } else { bits }
    };
    ordered(a).abs_diff(ordered(b))
}

/// Greatest distance from the standard library, and where.
fn greatest_error(backend: Backend, function: Function, arguments: &[[f64; 2]]) -> (u64, [f64; 2]) {
    evaluate(backend, function, arguments)
        .into_iter()
        .zip(arguments)
        .map(|(y, &x)| (ulps(y, expected(function, x)), x))
        .max_by_key(|&(error, _)| error)
        .unwrap()
}

#[track_caller]
fn assert_accurate(function: Function, arguments: &[[f64; 2]]) {
    assert_within(2, function, arguments);
}

#[track_caller]
fn assert_within(most: u64, function: Function, arguments: &[[f64; 2]]) {
    for backend in Backend::available() {
        let (error, at) = greatest_error(backend, function, arguments);
        assert!(error <= most, "{function:?} on {}: {error} ulp at {at:?}", backend.name());
    }
}

const COUNT: usize = 400_000;

/// A deterministic, irregular sweep of the unit square (multiples of the plastic number's inverse powers).
fn sweep() -> impl Iterator<Item = [f64; 2]> {
    (1..=COUNT).map(|i| [i as f64 * 0.7548776662466927 % 1.0, i as f64 * 0.5698402909980532 % 1.0])
}

fn over(lo: f64, hi: f64) -> Vec<[f64; 2]> {
    let mut arguments: Vec<_> = sweep().map(|[u, _]| [lo + (hi - lo) * u, 0.0]).collect();
    arguments.extend([[lo, 0.0], [hi, 0.0]]);
    arguments
}

/// Logarithmically dense towards 0.
fn over_decades(lo: i32, hi: i32) -> Vec<[f64; 2]> {
    let decades = (hi - lo) as f64;
    sweep().map(|[u, a]| [10f64.powf(lo as f64 + decades * u), a]).collect()
}

#[test]
fn exp_is_accurate() {
    assert_accurate(Exp, &over(-700.0, 700.0));
    assert_accurate(Exp, &over(-1.0, 1.0));
    assert_accurate(Exp, &over_decades(-300, 2));
}

#[test]
fn ln_is_accurate() {
    assert_accurate(Ln, &over_decades(-307, 308));
    assert_accurate(Ln, &over(0.5, 2.0));
    assert_accurate(Ln, &over(0.6, 0.71));
    // On both sides of 1 and of the seam at √½ 2^k, where cancellation would show.
    for centre in [1.0f64, 0.5f64.sqrt(), 2f64.sqrt()] {
        let near: Vec<_> =
            (0..COUNT as u64).map(|i| [f64::from_bits(centre.to_bits() + i - COUNT as u64 / 2), 0.0]).collect();
        assert_accurate(Ln, &near);
    }
    let near: Vec<_> = over_decades(-16, -1).iter().flat_map(|&[d, _]| [[1.0 + d, 0.0], [1.0 - d, 0.0]]).collect();
    assert_accurate(Ln, &near);
    assert_accurate(Ln, &[[f64::MIN_POSITIVE, 0.0], [f64::MAX, 0.0], [1.0, 0.0], [2.0, 0.0]]);
}

#[test]
fn powf_is_accurate() {
    let scaled = |most: f64| over_decades(-12, 3).into_iter().map(move |[x, a]| [x, most * a]);
    // Twice the exponent and a little more.
    assert_within(3, Powf, &scaled(1.0).collect::<Vec<_>>());
    assert_within(8, Powf, &scaled(3.0).collect::<Vec<_>>());
    assert_within(42, Powf, &scaled(20.0).collect::<Vec<_>>());
    let reaching: Vec<_> = scaled(0.0).map(|[x, _]| [x, 0.7]).collect();
    assert_within(3, Powf, &reaching);
    let near: Vec<_> = over(0.9, 1.1).iter().map(|&[x, _]| [x, 1.0 / 3.0]).collect();
    assert_within(3, Powf, &near);
}

#[test]
fn sin_and_cos_are_accurate() {
    // All multiples of π/2 up to 1e4, and the two numbers beside each: there the result is all cancellation.
    let zeros: Vec<_> = (-6366..=6366)
        .flat_map(|n| {
            let x = n as f64 * (PI / 2.0);
            [x, x.next_up(), x.next_down()].map(|x| [x, 0.0])
        })
        .filter(|[x, _]| x.abs() > 1e-300)
        .collect();
    for function in [Sin, Cos] {
        assert_accurate(function, &over(-1e4, 1e4));
        assert_accurate(function, &over(-PI, PI));
        assert_accurate(function, &over_decades(-300, 4));
        assert_accurate(function, &zeros);
    }
}

#[test]
fn sin_and_cos_of_turns_are_accurate_relative_even_at_their_zeros() {
    for function in [SinTurns, CosTurns] {
        assert_accurate(function, &over(0.0, 1.0));
        assert_accurate(function, &over(-1e4, 1e4));
        assert_accurate(function, &over_decades(-300, 0));
    }
    let quarters: Vec<_> = (0..4).map(|i| [i as f64 * 0.25, 0.0]).collect();
    for backend in Backend::available() {
        assert_eq!(evaluate(backend, SinTurns, &quarters), [0.0, 1.0, 0.0, -1.0]);
        assert_eq!(evaluate(backend, CosTurns, &quarters), [1.0, 0.0, -1.0, 0.0]);
    }
}

#[test]
fn special_values_are_as_documented() {
    let inf = f64::INFINITY;
    let subnormal = 1e-310;
    let (least, most) = (f64::exp(-708.0), f64::exp(708.0));
    let tiny = f64::MIN_POSITIVE.powf(0.7);
    let cases: &[(Function, [f64; 2], f64)] = &[
        (Exp, [0.0, 0.0], 1.0),
        (Exp, [-0.0, 0.0], 1.0),
        (Exp, [1e300, 0.0], most),
        (Exp, [inf, 0.0], most),
        (Exp, [-inf, 0.0], least),
        (Ln, [1.0, 0.0], 0.0),
        (Ln, [0.0, 0.0], -inf),
        (Ln, [subnormal, 0.0], -inf),
        (Ln, [inf, 0.0], inf),
        (Powf, [0.0, 0.7], tiny),
        (Powf, [-0.0, 0.7], tiny),
        (Powf, [subnormal, 0.7], tiny),
        (Powf, [-1.0, 0.7], tiny),
        (Powf, [0.0, 0.0], 1.0),
        (Powf, [5.0, 0.0], 1.0),
        (Powf, [1.0, 123.0], 1.0),
        (Powf, [inf, 0.7], inf),
        (Sin, [0.0, 0.0], 0.0),
        (Cos, [0.0, 0.0], 1.0),
    ];
    for backend in Backend::available() {
        for &(function, x, y) in cases {
            let got = evaluate(backend, function, &[x])[0];
            assert!(got == y || ulps(got, y) <= 2, "{function:?} {x:?} is {got}");
        }
        for (x, limit) in [(1e300, most), (1e-300, least)] {
            let got = evaluate(backend, Powf, &[[x, 1e9]])[0];
            assert!((got / limit).ln().abs() < 0.3, "{x}^1e9 is {got}");
        }
    }
}

#[test]
fn nan_stays_nan() {
    // Every payload and sign: a NaN must not become a number because its bits were read as one.
    let nans = [0x7ff8_0000_0000_0000, 0xfff8_0000_0000_0000, 0x7fff_ffff_ffff_ffff, 0x7ff0_0000_0000_0001u64];
    for backend in Backend::available() {
        for nan in nans.map(f64::from_bits) {
            for function in [Exp, Ln, Powf, Sin, Cos, SinTurns, CosTurns] {
                assert!(evaluate(backend, function, &[[nan, 0.7]])[0].is_nan(), "{function:?}");
            }
            assert!(evaluate(backend, Powf, &[[2.0, nan]])[0].is_nan());
            assert!(evaluate(backend, Powf, &[[nan, 0.0]])[0].is_nan());
        }
        assert!(evaluate(backend, Ln, &[[-1.0, 0.0]])[0].is_nan());
        assert!(evaluate(backend, Sin, &[[f64::INFINITY, 0.0]])[0].is_nan());
    }
}

#[test]
fn both_lane_types_give_the_same_bits() {
    if !Backend::Avx512.is_available() {
        return;
    }
    let cases = [
        (Exp, over(-800.0, 800.0)),
        (Ln, over_decades(-320, 308)),
        (Powf, over_decades(-20, 20)),
        (Sin, over(-1e5, 1e5)),
        (Cos, over(-1e5, 1e5)),
        (SinTurns, over(-2.0, 2.0)),
        (CosTurns, over(-2.0, 2.0)),
    ];
    for (function, arguments) in cases {
        let four = evaluate(Backend::Avx2, function, &arguments);
        let eight = evaluate(Backend::Avx512, function, &arguments);
        let same = four.iter().zip(&eight).all(|(a, b)| a.to_bits() == b.to_bits());
        assert!(same, "{function:?}");
    }
}
