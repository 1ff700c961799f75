use super::*;
use crate::gnc::laws::reaching::{self, Reaching, Shape};
use crate::gnc::laws::surface::{self, Surface};
use crate::gnc::laws::{Channel, Form, LinearFeedback, SlidingMode, sliding};
use crate::number::{Backend, Job, Mask, dispatch};
use crate::plant::wrench::Wrench;
use std::fmt::Debug;

/// Gathers different values into lanes, takes them apart, and chooses lane by lane.
struct RoundTrip<V>(Vec<V>);

/// Implemented for each batched type under test, since `Batch` cannot be named for lanes that have no name.
macro_rules! round_trip {
    ($type:ident) => {
        impl Job for RoundTrip<$type<f64>> {
            type Output = ();

            #[inline(always)]
            fn run<R: Real>(self) {
                let values = &self.0;
                let lanes: $type<R> = Batch::gather(&|i| &values[i]);
                let others: $type<R> = Batch::gather(&|i| &values[i + 1]);
                check(R::LANES, values, |i| Batch::<R>::scatter(&lanes, i));
                for chosen in 0..R::LANES {
                    let one = R::splat(chosen as f64);
                    let mask = one.le(R::from_fn(|i| i as f64)) & R::from_fn(|i| i as f64).le(one);
                    let mixed = Batch::choose(mask, &others, &lanes);
                    for i in 0..R::LANES {
                        let want = if mask.lane(i) { values[i + 1] } else { values[i] };
                        assert_eq!(Batch::<R>::scatter(&mixed, i), want);
                    }
                }
            }
        }
    };
}
round_trip!(Wrench);
round_trip!(Channel);

fn check<V: PartialEq + Debug>(lanes: usize, values: &[V], scatter: impl Fn(usize) -> V) {
    for (i, value) in values.iter().enumerate().take(lanes) {
        assert_eq!(scatter(i), *value);
    }
}

fn vector(seed: usize) -> Vec3<f64> {
    let x = seed as f64;
    Vec3([x, -2.0 * x, 0.1 * x + 1.0])
}

fn sliding_mode(i: usize, surface: Surface<f64>, shape: Shape<f64>) -> Channel<f64> {
    Channel::Sliding(SlidingMode {
        surface,
        reaching: Reaching::new(vector(i), vector(i + 20), shape),
        compensation: sliding::Compensation { natural: true, surface_rate: sliding::OwnRate::Exact, gyroscopic: 1.0 },
    })
}

fn linear(i: usize) -> Channel<f64> {
    let gain = Mat3([vector(i).0, vector(i + 1).0, vector(i + 2).0]);
    Channel::Linear(LinearFeedback { error: gain, rate: gain.transpose(), damps_own_rate: (i % 2) as f64 })
}

#[test]
fn what_is_gathered_comes_apart_as_it_was_and_lanes_are_chosen_one_by_one() {
    for backend in Backend::available() {
        dispatch(backend, RoundTrip((0..9).map(|i| Wrench { force: vector(i), torque: vector(i + 9) }).collect()));
        dispatch(backend, RoundTrip((0..9).map(linear).collect()));
        let terminal = |i: usize| Surface::Terminal(surface::Terminal { slope: vector(i), exponent: 0.1 * i as f64 });
        let flat = |i: usize| Surface::Linear(surface::Linear { slope: vector(i) });
        let power =
            |i: usize| Shape::PowerRate(reaching::PowerRate { exponent: 0.1 * i as f64, inside: Form::Corrected });
        let proportional = |i: usize| Shape::Proportional(reaching::Proportional { proportional: vector(i + 40) });
        dispatch(backend, RoundTrip((0..9).map(|i| sliding_mode(i, terminal(i), proportional(i))).collect()));
        dispatch(backend, RoundTrip((0..9).map(|i| sliding_mode(i, flat(i), power(i))).collect()));
    }
}

#[test]
#[should_panic(expected = "must fly the same law")]
fn two_laws_in_one_batch_are_refused() {
    let pair = [
        linear(1),
        sliding_mode(
            1,
            Surface::Linear(surface::Linear { slope: vector(1) }),
            Shape::PowerRate(reaching::PowerRate { exponent: 0.7, inside: Form::Printed }),
        ),
    ];
    // A single f64 lane chooses between both.
    let _ = <Channel<f64> as Batch<f64>>::choose(true, &pair[0], &pair[1]);
}
