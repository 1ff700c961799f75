//! Many flights: lanes times threads. A lane whose flight is over takes the next one at once.

use crate::fleet::Fleet;
use detumble_core::batch::Batch;
use detumble_core::closed_loop::{Refill, fly};
use detumble_core::flight::Flight;
use detumble_core::metrics::{Impulse, Metrics, Summary};
use detumble_core::number::{Backend, Job, Mask, Real, Stream, dispatch};
use detumble_core::observer::Observer;
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
    /// Flights landed so far.
    pub landed: &'a AtomicUsize,
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
pub struct Results<T> {
    /// One for each flight; those that `stop` kept from flying are missing.
    pub flights: Vec<T>,
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

/// Flies the fleet with all metrics.
pub fn fly_many(fleet: &Fleet<'_>, operation: &Operation<'_>) -> Results<Outcome> {
    on_threads(fleet, operation, |next| dispatch(operation.backend, WithMetrics(Crew { fleet, operation, next })))
}

/// Flies the fleet as the reference workload does: end state, first capture and impulse only.
pub fn fly_workload(fleet: &Fleet<'_>, operation: &Operation<'_>) -> Results<Workload> {
    on_threads(fleet, operation, |next| dispatch(operation.backend, WithImpulse(Crew { fleet, operation, next })))
}

/// What one thread brings home: results with their flights' numbers.
struct Haul<T> {
    flights: Vec<(usize, T)>,
    ticks: u64,
    lane_ticks: u64,
}

fn on_threads<T: Send>(
    fleet: &Fleet<'_>,
    operation: &Operation<'_>,
    crew: impl Fn(&AtomicUsize) -> Haul<T> + Sync,
) -> Results<T> {
    let next = AtomicUsize::new(0);
    let crews = operation.threads.clamp(1, fleet.flights().div_ceil(operation.backend.lanes()).max(1));
    let hauls: Vec<Haul<T>> = std::thread::scope(|scope| {
        let others: Vec<_> = (1..crews).map(|_| scope.spawn(|| crew(&next))).collect();
        let own = crew(&next);
        std::iter::once(own).chain(others.into_iter().map(|other| other.join().expect("a crew panicked"))).collect()
    });
    let (mut ticks, mut lane_ticks) = (0, 0);
    let mut flights = Vec::with_capacity(fleet.flights());
    for haul in hauls {
        ticks += haul.ticks;
        lane_ticks += haul.lane_ticks;
        flights.extend(haul.flights);
    }
    flights.sort_unstable_by_key(|(i, _)| *i);
    Results { flights: flights.into_iter().map(|(_, result)| result).collect(), ticks, lane_ticks }
}

/// The lanes of one thread, and where they find work.
struct Crew<'a> {
    fleet: &'a Fleet<'a>,
    operation: &'a Operation<'a>,
    next: &'a AtomicUsize,
}

impl Crew<'_> {
    /// The number of a flight that nobody has begun.
    fn claim(&self) -> Option<usize> {
        if self.operation.stop.load(Ordering::Relaxed) {
            return None;
        }
        let i = self.next.fetch_add(1, Ordering::Relaxed);
        (i < self.fleet.flights()).then_some(i)
    }

    /// Flies until no work is left.
    #[inline(always)]
    fn fly<R: Real, O, T, F>(&self, read: F) -> Haul<T>
    where
        O: Observer<R> + Batch<R>,
        O::One: Default,
        F: Fn(&Scene<R>, &Flight<R>, R, &O, usize) -> T,
    {
        let Some(first) = self.claim() else {
            return Haul { flights: Vec::new(), ticks: 0, lane_ticks: 0 };
        };
        let idle = self.fleet.prepared(first);
        let mut scene = Scene::<R>::new(&self.fleet.recipe().plan, self.fleet.common(), &idle);
        let mut flight = Batch::<R>::same(&idle.start());
        let mut noise = Stream::new(self.operation.seed, |_| self.operation.stream(first));
        let mut observer = O::same(&O::One::default());
        let mut aboard = vec![None; R::LANES];
        aboard[0] = Some(first);
        let haul = Haul { flights: Vec::new(), ticks: 0, lane_ticks: 0 };
        let mut roster = Roster { crew: self, read, idle, aboard, haul };
        for lane in 1..R::LANES {
            roster.aboard[lane] = self.claim();
            roster.board(lane, &mut scene, &mut flight, &mut noise);
        }
        fly(&mut scene, &mut flight, &mut noise, &mut observer, &mut roster);
        roster.haul
    }
}

/// Who flies in which lane.
struct Roster<'a, T, F> {
    crew: &'a Crew<'a>,
    read: F,
    /// What a lane without a flight flies, in vain.
    idle: PreparedFlight,
    /// Flight of each lane.
    aboard: Vec<Option<usize>>,
    haul: Haul<T>,
}

impl<T, F> Roster<'_, T, F> {
    /// Puts a lane's flight at its start.
    fn board<R: Real>(&self, lane: usize, scene: &mut Scene<R>, flight: &mut Flight<R>, noise: &mut Stream<R>) {
        let claimed = self.aboard[lane].map(|i| self.crew.fleet.prepared(i));
        let prepared = claimed.as_ref().unwrap_or(&self.idle);
        scene.put(lane, prepared);
        flight.put(lane, &prepared.start());
        noise.set_lane(lane, self.crew.operation.stream(self.aboard[lane].unwrap_or(0)));
    }
}

impl<R, O, T, F> Refill<R, O> for Roster<'_, T, F>
where
    R: Real,
    O: Observer<R> + Batch<R>,
    O::One: Default,
    F: Fn(&Scene<R>, &Flight<R>, R, &O, usize) -> T,
{
    #[cold]
    #[inline(never)]
    fn land(&mut self, over: R::Mask, scene: &Scene<R>, flight: &Flight<R>, number: R, observer: &O) -> bool {
        let ticks = |lane: usize| number.lane(lane) as u64 + 1;
        for lane in (0..R::LANES).filter(|&lane| over.lane(lane)) {
            self.haul.lane_ticks += ticks(lane);
            if let Some(i) = self.aboard[lane] {
                self.haul.ticks += ticks(lane);
                self.haul.flights.push((i, (self.read)(scene, flight, number, observer, lane)));
                self.crew.operation.landed.fetch_add(1, Ordering::Relaxed);
                self.aboard[lane] = self.crew.claim();
            }
        }
        let work_left = self.aboard.iter().any(Option::is_some);
        if !work_left {
            self.haul.lane_ticks += (0..R::LANES).filter(|&lane| !over.lane(lane)).map(ticks).sum::<u64>();
        }
        work_left
    }

    #[cold]
    #[inline(never)]
    fn take_off(
        &mut self,
        over: R::Mask,
        scene: &mut Scene<R>,
        flight: &mut Flight<R>,
        noise: &mut Stream<R>,
        number: &mut R,
        observer: &mut O,
    ) {
        for lane in (0..R::LANES).filter(|&lane| over.lane(lane)) {
            self.board(lane, scene, flight, noise);
            number.set_lane(lane, 0.0);
            observer.put(lane, &O::One::default());
        }
    }
}

struct WithMetrics<'a>(Crew<'a>);

impl Job for WithMetrics<'_> {
    type Output = Haul<Outcome>;

    #[inline(always)]
    fn run<R: Real>(self) -> Haul<Outcome> {
        self.0.fly::<R, Metrics<R>, _, _>(|scene, flight, number, metrics, i| Outcome {
            end: Batch::<R>::scatter(&flight.truth, i),
            summary: metrics.summary(scene, flight, number, i),
        })
    }
}

struct WithImpulse<'a>(Crew<'a>);

impl Job for WithImpulse<'_> {
    type Output = Haul<Workload>;

    #[inline(always)]
    fn run<R: Real>(self) -> Haul<Workload> {
        self.0.fly::<R, Impulse<R>, _, _>(|scene, flight, _, impulse, i| {
            let time = flight.capture.time.lane(i);
            Workload {
                end: Batch::<R>::scatter(&flight.truth, i),
                capture_time: if time.is_finite() { scene.clock.time_of(scene.clock.tick_at(time)) } else { f64::NAN },
                impulse: impulse.total.lane(i),
            }
        })
    }
}
