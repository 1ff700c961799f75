//! Many flights: lanes times threads. A lane whose flight is over takes the next one at once.

use crate::fleet::Fleet;
use detumble_core::batch::Batch;
use detumble_core::closed_loop::{Lanes, Refill, fly};
use detumble_core::flight::Flight;
use detumble_core::metrics::{Metrics, Summary};
use detumble_core::number::{Backend, Job, Mask, Real, Stream, dispatch};
use detumble_core::plant::motion::Motion;
use detumble_core::scene::{PreparedFlight, Scene};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// How a fleet is flown. Seed and first index name the random numbers; of all else only whether the back end is portable or
/// wide reaches the results, and that in the last bits.
pub struct Operation<'a> {
    /// Of the random streams.
    pub seed: u64,
    /// Flight i draws from the stream of `first_index + i mod cycle`.
    pub first_index: u64,
    /// Flights after which the random numbers begin again, so that all of several laws meet the same ones.
    pub cycle: u64,
    /// Instructions to use.
    pub backend: Backend,
    /// Threads to use, at least one.
    pub threads: usize,
    /// Flights completed so far.
    pub completed: &'a AtomicUsize,
    /// Once set, no flight begins any more.
    pub stop: &'a AtomicBool,
}

impl Operation<'_> {
    /// The random stream of flight i.
    fn stream(&self, i: usize) -> u64 {
        self.first_index + i as u64 % self.cycle
    }
}

/// Results of a fleet in the order of its flights, and how busy the lanes were.
#[derive(Clone, Debug)]
pub struct Results {
    /// One for each flight; those that `stop` kept from flying are missing.
    pub flights: Vec<Outcome>,
    /// Ticks in the flights of the fleet.
    pub ticks: u64,
    /// Ticks that the lanes of all threads went through meanwhile.
    pub lane_ticks: u64,
}

/// A flight's end and metrics.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// State at the last tick.
    pub end: Motion<f64>,
    /// Metrics.
    pub summary: Summary,
}

/// Flies the fleet.
pub fn fly_many(fleet: &Fleet<'_>, operation: &Operation<'_>) -> Results {
    let next = AtomicUsize::new(0);
    let fly = || dispatch(operation.backend, Worker { fleet, operation, next: &next });
    let threads = operation.threads.clamp(1, fleet.flights().div_ceil(operation.backend.lanes()).max(1));
    let flown: Vec<Flown> = std::thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(fly)).collect();
        let own = fly();
        std::iter::once(own).chain(others.into_iter().map(|other| other.join().expect("a thread panicked"))).collect()
    });
    let (ticks, lane_ticks) =
        flown.iter().fold((0, 0), |(ticks, lanes), one| (ticks + one.ticks, lanes + one.lane_ticks));
    let mut flights: Vec<_> = flown.into_iter().flat_map(|one| one.flights).collect();
    flights.sort_unstable_by_key(|(i, _)| *i);
    Results { flights: flights.into_iter().map(|(_, outcome)| outcome).collect(), ticks, lane_ticks }
}

/// What one thread has flown, with the index of each flight.
#[derive(Default)]
struct Flown {
    flights: Vec<(usize, Outcome)>,
    ticks: u64,
    lane_ticks: u64,
}

/// One thread: it fills its lanes with the next flights of the fleet until none is left.
#[derive(Clone, Copy)]
struct Worker<'a> {
    fleet: &'a Fleet<'a>,
    operation: &'a Operation<'a>,
    next: &'a AtomicUsize,
}

impl Worker<'_> {
    /// The index of a flight that no thread has begun.
    fn claim(&self) -> Option<usize> {
        if self.operation.stop.load(Ordering::Relaxed) {
            return None;
        }
        let i = self.next.fetch_add(1, Ordering::Relaxed);
        (i < self.fleet.flights()).then_some(i)
    }
}

impl Job for Worker<'_> {
    type Output = Flown;

    #[inline(always)]
    fn run<R: Real>(self) -> Flown {
        let Some(first) = self.claim() else {
            return Flown::default();
        };
        let idle = self.fleet.prepared(first);
        let mut scene = Scene::<R>::new(&self.fleet.recipe().plan, self.fleet.common(), &idle);
        let mut flight = Batch::<R>::same(&idle.start(&self.fleet.recipe().plan));
        let mut noise = Stream::new(self.operation.seed, |_| self.operation.stream(first));
        let mut metrics = Metrics::default();
        let mut assigned = vec![None; R::LANES];
        assigned[0] = Some(first);
        let mut assignment = Assignment { worker: self, idle, assigned, flown: Flown::default() };
        for lane in 1..R::LANES {
            assignment.assigned[lane] = self.claim();
            assignment.put(lane, &mut scene, &mut flight, &mut noise);
        }
        fly(&mut scene, &mut flight, &mut noise, &mut metrics, &mut assignment);
        assignment.flown
    }
}

/// Which flight each lane of a thread flies.
struct Assignment<'a> {
    worker: Worker<'a>,
    /// What a lane without a flight repeats, unrecorded.
    idle: PreparedFlight,
    /// Index of each lane's flight.
    assigned: Vec<Option<usize>>,
    flown: Flown,
}

impl Assignment<'_> {
    /// Puts a lane at the start of its flight.
    fn put<R: Real>(&self, lane: usize, scene: &mut Scene<R>, flight: &mut Flight<R>, noise: &mut Stream<R>) {
        let assigned = self.assigned[lane].map(|i| self.worker.fleet.prepared(i));
        let prepared = assigned.as_ref().unwrap_or(&self.idle);
        scene.put(lane, prepared);
        flight.put(lane, &prepared.start(&scene.plan));
        noise.set_lane(lane, self.worker.operation.stream(self.assigned[lane].unwrap_or(0)));
    }
}

impl<R: Real> Refill<R, Metrics<R>> for Assignment<'_> {
    #[cold]
    #[inline(never)]
    fn collect(
        &mut self,
        over: R::Mask,
        scene: &Scene<R>,
        flight: &Flight<R>,
        number: R,
        metrics: &Metrics<R>,
    ) -> bool {
        let ticks = |lane: usize| number.lane(lane) as u64 + 1;
        for lane in (0..R::LANES).filter(|&lane| over.lane(lane)) {
            self.flown.lane_ticks += ticks(lane);
            if let Some(i) = self.assigned[lane] {
                self.flown.ticks += ticks(lane);
                let end = Batch::<R>::scatter(&flight.truth, lane);
                self.flown.flights.push((i, Outcome { end, summary: metrics.summary(scene, flight, number, lane) }));
                self.worker.operation.completed.fetch_add(1, Ordering::Relaxed);
                self.assigned[lane] = self.worker.claim();
            }
        }
        let work_left = self.assigned.iter().any(Option::is_some);
        if !work_left {
            self.flown.lane_ticks += (0..R::LANES).filter(|&lane| !over.lane(lane)).map(ticks).sum::<u64>();
        }
        work_left
    }

    #[cold]
    #[inline(never)]
    fn begin(&mut self, over: R::Mask, lanes: Lanes<'_, R, Metrics<R>>) {
        for lane in (0..R::LANES).filter(|&lane| over.lane(lane)) {
            self.put(lane, lanes.scene, lanes.flight, lanes.noise);
            lanes.number.set_lane(lane, 0.0);
            Batch::<R>::put(lanes.observer, lane, &Metrics::default());
        }
    }
}
