use super::super::{Bits, Mask, Quat, Real, Vec3};
use super::*;

/// Everything a lane type can do besides the elementary functions, lane by lane, for comparison with `f64`.
struct Operations<'a>(&'a [[f64; 3]]);

impl Job for Operations<'_> {
    type Output = Vec<[u64; 24]>;

    #[inline(always)]
    fn run<R: Real>(self) -> Vec<[u64; 24]> {
        let mut results = Vec::new();
        for chunk in self.0.chunks(R::LANES) {
            let gather = |k: usize| R::from_fn(|i| chunk[i.min(chunk.len() - 1)][k]);
            let (a, b, c) = (gather(0), gather(1), gather(2));
            let mut sum = a;
            sum += b;
            sum -= c;
            sum *= a;
            let (p, q) = (a.to_bits(), b.to_bits());
            let choose = |mask: R::Mask| R::select(mask, a, b);
            let numbers = [
                sum,
                a / b,
                -a,
                a.sqrt(),
                a.abs(),
                a.min(b),
                a.max(b),
                a.copysign(b),
                a.clamp(b, c),
                a.clamp_unit(),
                a.signum0(),
                R::from_u32(p),
                choose(a.lt(b)),
                choose(a.le(b)),
                choose(a.is_sign_negative()),
                choose(a.is_finite()),
                choose(a.lt(b) & b.lt(c)),
                choose(a.lt(b) | b.lt(c)),
                choose(!a.lt(b)),
            ];
            let bits = [(p + q) ^ (p - q), p & q | p.shl::<7>(), p.shr::<9>(), p.mul_low32(q), R::Bits::splat(3)];
            for i in 0..chunk.len() {
                let numbers = numbers.iter().map(|x| canonical(x.lane(i)));
                let bits = bits.iter().map(|x| x.lane(i));
                let all: Vec<u64> = numbers.chain(bits).collect();
                results.push(all.try_into().unwrap());
            }
        }
        results
    }
}

/// The bits; sign and payload of a NaN are not defined.
fn canonical(x: f64) -> u64 {
    if x.is_nan() { f64::NAN.to_bits() } else { x.to_bits() }
}

#[test]
fn operations_mean_the_same_on_every_backend_bit_for_bit() {
    let special = [0.0, -0.0, 1.0, -1.5, 3e-310, 1e308, -7e-5, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, -f64::NAN];
    let mut arguments = Vec::new();
    for a in special {
        for b in special {
            arguments.extend(special.map(|c| [a, b, c]));
        }
    }
    let portable = dispatch(Backend::Portable, Operations(&arguments));
    for backend in Backend::available() {
        let results = dispatch(backend, Operations(&arguments));
        for ((got, want), at) in results.iter().zip(&portable).zip(&arguments) {
            assert_eq!(got, want, "{} at {at:?}", backend.name());
        }
    }
}

#[test]
fn nan_is_never_hidden_by_limits() {
    let nan = f64::NAN;
    assert!(Real::min(nan, 1.0).is_nan() && Real::max(nan, 1.0).is_nan());
    assert!(Real::clamp(nan, -1.0, 1.0).is_nan() && nan.clamp_unit().is_nan() && nan.signum0().is_nan());
    assert!(!Real::is_finite(nan) && !Real::lt(nan, nan) && !Real::le(nan, nan));
}

/// Masks over lanes, and composites gathered and taken apart.
struct Lanes;

impl Job for Lanes {
    type Output = ();

    #[inline(always)]
    fn run<R: Real>(self) {
        let index = R::from_fn(|i| i as f64);
        for last in 0..R::LANES {
            let above = R::splat(last as f64).le(index);
            assert!(above.any() && above.all() == (last == 0));
            assert!((0..R::LANES).all(|i| above.lane(i) == (i >= last) && (!above).lane(i) != above.lane(i)));
        }
        let (yes, no) = (R::Mask::splat(true), R::Mask::splat(false));
        assert!(yes.all() && !no.any() && !(yes & no).any() && (yes | no).all() && (!no).all() && !(!yes).any());

        let vector = |i: usize| Vec3([i as f64, -1.0, 0.5]);
        let quaternion = |i: usize| Quat([0.1, i as f64, 2.0, 3.0]);
        let vectors = Vec3::<R>::from_lanes(vector);
        let quaternions = Quat::<R>::from_lanes(quaternion);
        let turned = quaternions.rotate(vectors);
        for i in 0..R::LANES {
            assert_eq!((vectors.lane(i), quaternions.lane(i)), (vector(i), quaternion(i)));
            let error = turned.lane(i) - quaternion(i).rotate(vector(i));
            assert!(error.norm() <= 1e-15 * (10.0 + (i * i) as f64) * 10.0);
        }
    }
}

#[test]
fn lanes_keep_apart() {
    for backend in Backend::available() {
        dispatch(backend, Lanes);
    }
}

struct CountLanes;

impl Job for CountLanes {
    type Output = usize;

    #[inline(always)]
    fn run<R: Real>(self) -> usize {
        R::LANES
    }
}

#[test]
fn dispatch_runs_on_the_backend_it_is_told() {
    assert_eq!(Backend::available().next(), Some(Backend::Portable));
    assert!(Backend::best().is_available());
    for backend in Backend::available() {
        assert_eq!(dispatch(backend, CountLanes), backend.lanes());
        assert_eq!(fma_peak(backend, 10), (10 * 24 * backend.lanes()) as f64);
    }
}
