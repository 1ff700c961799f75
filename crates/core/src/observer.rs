//! What watches a flight: history, metrics, or both.

use crate::flight::Flight;
use crate::gnc::capture::Judged;
use crate::gnc::error::TrackingError;
use crate::gnc::guidance::Target;
use crate::hardware::actuators::Applied;
use crate::number::{Mask, Real};
use crate::plant::motion::Motion;
use crate::plant::wrench::Wrench;
use crate::scene::Scene;

/// One control tick, for those who watch. The motion is the flight's, after the merge. Each lane has its own clock.
#[derive(Clone, Copy, Debug)]
pub struct Tick<R: Real> {
    /// k
    pub number: R,
    /// t_k \[s\].
    pub time: R,
    /// Not the last tick of a whole flight, nor without a command. The wrench is flown, unless the observer says that the
    /// flight is over.
    pub flown: R::Mask,
    /// The true goal.
    pub target: Target<R>,
    /// What capture was judged by, before the merge.
    pub judged: Judged<R>,
    /// The true error: against the debris before capture, against H after it.
    pub error: TrackingError<R>,
    /// Demanded by the law.
    pub demand: Wrench<R>,
    /// Given by the actuators.
    pub applied: Applied<R>,
}

/// Watches a flight and keeps what it wants of it.
pub trait Observer<R: Real> {
    /// Lanes are captured: the motion before any merge, and the true error against the debris (by value: a reference that
    /// leaves the loop would keep it in memory at every tick).
    fn captured(&mut self, scene: &Scene<R>, lanes: R::Mask, before: &Motion<R>, error: TrackingError<R>);

    /// Lanes have just become stacks.
    fn merged(&mut self, _lanes: R::Mask, _flight: &Flight<R>) {}

    /// At each tick, after the merge and before the plant moves on.
    fn observe(&mut self, scene: &Scene<R>, flight: &Flight<R>, tick: &Tick<R>);

    /// Lanes whose flight is over before its last period.
    #[inline(always)]
    fn over(&self, _scene: &Scene<R>, _flight: &Flight<R>, _tick: &Tick<R>) -> R::Mask {
        R::Mask::splat(false)
    }
}

/// Two observers at once.
impl<R: Real, A: Observer<R>, B: Observer<R>> Observer<R> for (A, B) {
    fn captured(&mut self, scene: &Scene<R>, lanes: R::Mask, before: &Motion<R>, error: TrackingError<R>) {
        self.0.captured(scene, lanes, before, error);
        self.1.captured(scene, lanes, before, error);
    }

    fn merged(&mut self, lanes: R::Mask, flight: &Flight<R>) {
        self.0.merged(lanes, flight);
        self.1.merged(lanes, flight);
    }

    #[inline(always)]
    fn observe(&mut self, scene: &Scene<R>, flight: &Flight<R>, tick: &Tick<R>) {
        self.0.observe(scene, flight, tick);
        self.1.observe(scene, flight, tick);
    }

    #[inline(always)]
    fn over(&self, scene: &Scene<R>, flight: &Flight<R>, tick: &Tick<R>) -> R::Mask {
        self.0.over(scene, flight, tick) | self.1.over(scene, flight, tick)
    }
}
