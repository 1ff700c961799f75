//! One flight with its full history. It fills all lanes of the back end with the same trajectory, so its bits are those
//! of the same flight in a fleet.

use detumble_core::batch::Batch;
use detumble_core::case::FlightRecipe;
use detumble_core::closed_loop::fly_alone;
use detumble_core::flight::Flight;
use detumble_core::gnc::error::TrackingError;
use detumble_core::history::{History, Merge, Series};
use detumble_core::metrics::{Metrics, Summary};
use detumble_core::number::{Backend, Job, Mask, Real, Stream, dispatch};
use detumble_core::observer::{Observer, Tick};
use detumble_core::plant::motion::Motion;
use detumble_core::scene::{Common, PreparedFlight, Scene};
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

/// Flies `recipe` with the noise of trajectory `index` of `seed`; breaks off once `stop` is set. `common` is that of the
/// campaign whose flight it is.
pub fn fly_one(
    recipe: &FlightRecipe,
    common: Common,
    seed: u64,
    index: u64,
    backend: Backend,
    stop: &AtomicBool,
) -> FlightRecord {
    dispatch(backend, OneFlight { recipe, common, seed, index, stop })
}

struct OneFlight<'a> {
    recipe: &'a FlightRecipe,
    common: Common,
    seed: u64,
    index: u64,
    stop: &'a AtomicBool,
}

impl Job for OneFlight<'_> {
    type Output = FlightRecord;

    #[inline(always)]
    fn run<R: Real>(self) -> FlightRecord {
        let (plan, prepared) = (&self.recipe.plan, PreparedFlight::new(self.recipe));
        let mut scene = Scene::<R>::new(plan, self.common, &prepared);
        let mut flight = Batch::<R>::same(&prepared.start(plan));
        let mut noise = Stream::new(self.seed, |_| self.index);
        let mut observer = (Interruptible(self.stop), (History::new(plan.periods), Metrics::default()));
        let last = fly_alone(&mut scene, &mut flight, &mut noise, &mut observer);
        let (_, (history, metrics)) = observer;
        let summary = metrics.summary(&scene, &flight, last, 0);
        FlightRecord { merge: history.merge, series: history.into_series(), summary }
    }
}

/// Its flight is over when someone says stop.
struct Interruptible<'a>(&'a AtomicBool);

impl<R: Real> Observer<R> for Interruptible<'_> {
    fn captured(&mut self, _: &Scene<R>, _: R::Mask, _: &Motion<R>, _: TrackingError<R>) {}

    #[inline(always)]
    fn observe(&mut self, _: &Scene<R>, _: &Flight<R>, _: &Tick<R>) {}

    #[inline(always)]
    fn over(&self, _: &Scene<R>, _: &Flight<R>, _: &Tick<R>) -> R::Mask {
        R::Mask::splat(self.0.load(Ordering::Relaxed))
    }
}
