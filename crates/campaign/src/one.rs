//! One flight with its full history. It fills all lanes of the back end with the same trajectory, so its bits are those
//! of the same flight in a fleet.

use detumble_core::case::FlightRecipe;
use detumble_core::closed_loop::{Laws, Numbers, Scene, fly};
use detumble_core::hardware::sensors::Noisy;
use detumble_core::history::{History, Merge, Series};
use detumble_core::metrics::{Metrics, Summary};
use detumble_core::number::{Backend, Job, Real, Stream, dispatch};

/// A flight: rows, events, numbers.
pub struct FlightRecord {
    /// A row at every control tick.
    pub series: Vec<Series>,
    /// What was before and after the merge, if there was one.
    pub merge: Option<Merge>,
    /// Metrics.
    pub summary: Summary,
}

/// Flies `recipe` with the noise of trajectory `index` of `seed`.
pub fn fly_one(recipe: &FlightRecipe, seed: u64, index: u64, backend: Backend) -> FlightRecord {
    let numbers = Numbers::new(&recipe.case, &recipe.plan);
    let laws = Laws::new(&recipe.law, &recipe.case, &recipe.plan);
    dispatch(backend, OneFlight { recipe, numbers: &numbers, laws: &laws, seed, index })
}

struct OneFlight<'a> {
    recipe: &'a FlightRecipe,
    numbers: &'a Numbers<f64>,
    laws: &'a Laws,
    seed: u64,
    index: u64,
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
        let mut observer = (History::new(plan.periods), Metrics::default());
        fly(&scene, &mut flight, &dice, &mut observer);
        let (history, metrics) = observer;
        let summary = metrics.summary(&scene, &flight, 0);
        FlightRecord { merge: history.merge, series: history.into_series(), summary }
    }
}
