//! Many flights: blocks of as many as the back end has lanes, shared out over threads.

use detumble_core::batch::Batch;
use detumble_core::case::{Motion, Plan};
use detumble_core::closed_loop::{Flight, Observer, fly};
use detumble_core::hardware::sensors::Noisy;
use detumble_core::metrics::{Impulse, Metrics, Summary};
use detumble_core::number::{Backend, Job, Real, Stream, dispatch};
use detumble_core::scene::{Laws, Numbers, Scene};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// What is the same for every flight, and how many there are.
pub struct Fleet<'a> {
    /// Clocks and switches.
    pub plan: &'a Plan,
    /// Sensors that are noisy in any flight.
    pub noisy: Noisy,
    /// The law and its gains.
    pub laws: &'a Laws,
    /// Of the random streams.
    pub seed: u64,
    /// Index of the first flight; flight i draws from the stream of `first_index + i`.
    pub first_index: u64,
    /// Number of flights.
    pub flights: usize,
    /// Instructions to use.
    pub backend: Backend,
    /// Threads to use, at least one.
    pub threads: usize,
    /// Once set, blocks not yet begun are left out.
    pub stop: &'a AtomicBool,
}

/// A flight's end and metrics.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// State at the last tick.
    pub end: Motion<f64>,
    /// Metrics.
    pub summary: Summary,
}

/// What the reference workload keeps of a flight.
#[derive(Clone, Copy, Debug)]
pub struct Workload {
    /// State at the last tick.
    pub end: Motion<f64>,
    /// First capture \[s\], NaN if never.
    pub capture_time: f64,
    /// Σ |F_i| T \[N s\].
    pub impulse: f64,
}

/// Flies the fleet with all metrics; flight i has the numbers `numbers(i)`.
pub fn fly_many(fleet: &Fleet<'_>, numbers: &(impl Fn(usize) -> Numbers<f64> + Sync)) -> Vec<Outcome> {
    in_blocks(fleet, numbers, |block| dispatch(fleet.backend, WithMetrics(block)))
}

/// Flies the fleet as the reference workload does: end state, first capture and impulse only.
pub fn fly_workload(fleet: &Fleet<'_>, numbers: &(impl Fn(usize) -> Numbers<f64> + Sync)) -> Vec<Workload> {
    in_blocks(fleet, numbers, |block| dispatch(fleet.backend, WithImpulse(block)))
}

/// Flights that fly in lockstep.
struct Block<'a> {
    fleet: &'a Fleet<'a>,
    numbers: Vec<Numbers<f64>>,
    first: usize,
}

fn in_blocks<T: Send>(
    fleet: &Fleet<'_>,
    numbers: &(impl Fn(usize) -> Numbers<f64> + Sync),
    fly_block: impl Fn(Block<'_>) -> Vec<T> + Sync,
) -> Vec<T> {
    let lanes = fleet.backend.lanes();
    let blocks = fleet.flights.div_ceil(lanes);
    let one_block = |b: usize| {
        if fleet.stop.load(Ordering::Relaxed) {
            return Vec::new();
        }
        let first = b * lanes;
        let last = (first + lanes).min(fleet.flights);
        fly_block(Block { fleet, numbers: (first..last).map(numbers).collect(), first })
    };
    if fleet.threads <= 1 {
        return (0..blocks).flat_map(one_block).collect();
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(fleet.threads).build();
    let pool = pool.expect("the system refuses to start worker threads");
    pool.install(|| (0..blocks).into_par_iter().flat_map_iter(one_block).collect())
}

impl Block<'_> {
    /// Flies all lanes and reads each one's result; a last, short block repeats its last flight in the idle lanes.
    #[inline(always)]
    fn fly<R: Real, O: Observer<R>, T>(
        &self,
        mut observer: O,
        read: impl Fn(&Scene<'_, R>, &Flight<R>, &O, usize) -> T,
    ) -> Vec<T> {
        let fleet = self.fleet;
        let lane = |i: usize| i.min(self.numbers.len() - 1);
        let pick_laws = |_| fleet.laws;
        let scene = Scene::<R>::new(fleet.plan, fleet.noisy, &|i| &self.numbers[lane(i)], &pick_laws);
        let dice = Stream::new(fleet.seed, |i| fleet.first_index + (self.first + lane(i)) as u64);
        let mut flight = scene.start();
        fly(&scene, &mut flight, &dice, &mut observer);
        (0..self.numbers.len()).map(|i| read(&scene, &flight, &observer, i)).collect()
    }
}

struct WithMetrics<'a>(Block<'a>);

impl Job for WithMetrics<'_> {
    type Output = Vec<Outcome>;

    #[inline(always)]
    fn run<R: Real>(self) -> Vec<Outcome> {
        self.0.fly(Metrics::<R>::default(), |scene, flight, metrics, i| Outcome {
            end: Batch::<R>::scatter(&flight.truth, i),
            summary: metrics.summary(scene, flight, i),
        })
    }
}

struct WithImpulse<'a>(Block<'a>);

impl Job for WithImpulse<'_> {
    type Output = Vec<Workload>;

    #[inline(always)]
    fn run<R: Real>(self) -> Vec<Workload> {
        self.0.fly(Impulse { total: R::zero() }, |_, flight, impulse, i| {
            let time = flight.capture.time.lane(i);
            Workload {
                end: Batch::<R>::scatter(&flight.truth, i),
                capture_time: if time.is_finite() { time } else { f64::NAN },
                impulse: impulse.total.lane(i),
            }
        })
    }
}
