//! One flight with its full history. It fills all lanes of the back end with the same trajectory, so its bits are those
//! of the same flight in a fleet.

use detumble_core::case::FlightRecipe;
use detumble_core::case::Motion;
use detumble_core::closed_loop::{Flight, Observer, Tick, fly};
use detumble_core::gnc::error::TrackingError;
use detumble_core::hardware::sensors::Noisy;
use detumble_core::history::{History, Merge, Series};
use detumble_core::metrics::{Metrics, Summary};
use detumble_core::number::{Backend, Job, Real, Stream, dispatch};
use detumble_core::scene::{Laws, Numbers, Scene};
use std::sync::atomic::{AtomicBool, Ordering};

/// A flight: rows, events, numbers.
pub struct FlightRecord {
    /// A row at every control tick.
    pub series: Vec<Series>,
    /// What was before and after the merge, if there was one.
    pub merge: Option<Merge>,
    /// Metrics.
    pub summary: Summary,
}

/// Flies `recipe` with the noise of trajectory `index` of `seed`; breaks off once `stop` is set.
pub fn fly_one(recipe: &FlightRecipe, seed: u64, index: u64, backend: Backend, stop: &AtomicBool) -> FlightRecord {
    let numbers = Numbers::new(&recipe.case, &recipe.plan);
    let laws = Laws::new(&recipe.law, &recipe.case, &recipe.plan);
    dispatch(backend, OneFlight { recipe, numbers: &numbers, laws: &laws, seed, index, stop })
}

struct OneFlight<'a> {
    recipe: &'a FlightRecipe,
    numbers: &'a Numbers<f64>,
    laws: &'a Laws,
    seed: u64,
    index: u64,
    stop: &'a AtomicBool,
}

impl Job for OneFlight<'_> {
    type Output = FlightRecord;

    #[inline(always)]
    fn run<R: Real>(self) -> FlightRecord {
        let plan = &self.recipe.plan;
        let pick_laws = |_| self.laws;
        let scene = Scene::<R>::new(plan, Noisy::new(&self.recipe.case.sensors), &|_| self.numbers, &pick_laws);
        let dice = Stream::new(self.seed, |_| self.index);
        let mut flight = scene.start();
        let mut observer = (Interruptible(self.stop), (History::new(plan.periods), Metrics::default()));
        fly(&scene, &mut flight, &dice, &mut observer);
        let (_, (history, metrics)) = observer;
        let summary = metrics.summary(&scene, &flight, 0);
        FlightRecord { merge: history.merge, series: history.into_series(), summary }
    }
}

/// Has seen enough when someone says stop.
struct Interruptible<'a>(&'a AtomicBool);

impl<R: Real> Observer<R> for Interruptible<'_> {
    fn captured(&mut self, _: &Scene<'_, R>, _: R::Mask, _: &Motion<R>, _: &TrackingError<R>) {}

    #[inline(always)]
    fn observe(&mut self, _: &Scene<'_, R>, _: &Flight<R>, _: &Tick<R>) {}

    #[inline(always)]
    fn has_seen_enough(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
