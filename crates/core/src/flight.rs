//! The state of a flight.

use crate::batch_struct;
use crate::gnc::capture::CaptureState;
use crate::gnc::laws::{Law, LawMemory};
use crate::number::{Real, Vec3};
use crate::plant::body::Vehicle;
use crate::plant::disturbed::Joint;
use crate::plant::motion::Motion;

batch_struct! {
    /// What the parts on board remember from one control period to the next.
    pub struct Memory<R> {
        /// Sensors.
        pub sensors: (),
        /// Navigator.
        pub navigator: (),
        /// Law; `None` in open loop.
        pub law: Option<LawMemory<R>>,
        /// Allocator.
        pub allocator: (),
        /// Actuators.
        pub actuators: (),
    }
}

batch_struct! {
    /// The state of a batch of flights.
    pub struct Flight<R> {
        /// The true motion; after capture the stack's.
        pub truth: Motion<R>,
        /// What flies: the chaser, after capture the stack.
        pub vehicle: Vehicle<R>,
        /// The law with the gains of each lane's phase; `None` in open loop.
        pub law: Option<Law<R>>,
        /// What the parts on board remember.
        pub memory: Memory<R>,
        /// Capture so far.
        pub capture: CaptureState<R>,
        /// How the debris sits on the chaser, fixed at capture.
        pub joint: Joint<R>,
        /// r_des of the stack \[m, H\].
        pub stack_goal: Vec3<R>,
        /// 1 where the law of this phase has no gains: a Riccati equation without a solution in double precision.
        pub no_gains: R,
    }
}

impl<R: Real> Flight<R> {
    /// Lanes whose law can command; any other flight is over.
    #[inline(always)]
    pub fn commanded(&self) -> R::Mask {
        !R::zero().lt(self.no_gains)
    }
}
