//! What the flights of a batch have in common, and their numbers lane by lane: everything that no event changes.

use crate::batch::Batch;
use crate::batch_struct;
use crate::case::{Case, FlightRecipe};
use crate::clock::Clock;
use crate::flight::{Flight, Memory};
use crate::gnc::allocation;
use crate::gnc::capture::{CaptureState, CaptureTest, SettledTest};
use crate::gnc::guidance::{self, Goal, GraspPoints, Target};
use crate::gnc::laws::{Law, LawRecipe, MassProperties, Phase, Segment, Setting};
use crate::gnc::navigation;
use crate::hardware::actuators::Actuators;
use crate::hardware::sensors::{Noisy, Sensors};
use crate::number::{Mask, Real, Vec3};
use crate::part::Part;
use crate::plan::Plan;
use crate::plant::attitude::Inertia;
use crate::plant::body::Vehicle;
use crate::plant::disturbed::Joint;
use crate::plant::lvlh::Lvlh;
use crate::plant::motion::Motion;
use crate::plant::orbit::HeldStep;
use crate::plant::propagate::{Shapes, Surroundings};
use crate::plant::stack::Transition;
use crate::plant::top::{FreeTop, is_symmetric_top};
use crate::plant::wrench::{Wrench, WrenchFrame};
use std::sync::Arc;

batch_struct! {
    /// Every number of a flight that no event changes.
    pub struct Numbers<R> {
        /// As the scenario gives them.
        pub case: Case<R>,
        /// Orbit and debris as the propagation wants them.
        pub around: Surroundings<R>,
        /// Thresholds as they are compared.
        pub capture: CaptureTest<R>,
        /// Thresholds of a settled stack as they are compared.
        pub settled: SettledTest<R>,
        /// The chaser before capture.
        pub chaser: Vehicle<R>,
    }
}

impl Numbers<f64> {
    /// Of one flight.
    pub fn new(case: &Case<f64>, plan: &Plan) -> Self {
        let debris = Inertia::new(case.debris.inertia);
        Self {
            case: *case,
            around: Surroundings {
                orbit: case.orbit,
                translation: HeldStep::new(case.orbit.mean_motion, plan.step()),
                half_step: HeldStep::new(case.orbit.mean_motion, 0.5 * plan.step()),
                debris,
                tumble: FreeTop::new(&debris, &case.start.debris(), plan.step()),
            },
            capture: CaptureTest::new(&case.capture),
            settled: SettledTest::new(&case.settled),
            chaser: Vehicle::new(case.chaser.mass, Inertia::new(case.chaser.inertia)),
        }
    }
}

/// A flight's law, built for both phases.
#[derive(Clone, Debug)]
pub struct Laws {
    recipe: Arc<LawRecipe>,
    setting: Setting,
    before: Option<Law<f64>>,
    after: Option<Law<f64>>,
}

impl Laws {
    /// For what the law believes of chaser and stack.
    pub fn new(recipe: &LawRecipe, case: &Case<f64>, plan: &Plan) -> Self {
        let setting = Setting {
            mean_motion: case.orbit.mean_motion,
            attitude_error: plan.attitude_error,
            surface_rate: plan.surface_rate,
        };
        let belief = &case.belief;
        let chaser = MassProperties { mass: belief.chaser_mass, inertia: belief.chaser_inertia };
        let stack = MassProperties { mass: belief.stack_mass, inertia: belief.stack_inertia };
        Self {
            before: recipe.build(Phase::BeforeCapture, &chaser, &setting),
            after: recipe.build(Phase::AfterCapture, &stack, &setting),
            recipe: Arc::new(recipe.clone()),
            setting,
        }
    }

    /// Whether all gains are numbers; a Riccati equation may have no solution in double precision.
    pub fn have_finite_gains(&self) -> bool {
        self.before.iter().chain(&self.after).all(Law::has_finite_gains)
    }
}

/// One flight, ready to be flown.
#[derive(Clone, Debug)]
pub struct PreparedFlight {
    /// Its numbers.
    pub numbers: Numbers<f64>,
    /// Its law.
    pub laws: Laws,
}

impl PreparedFlight {
    /// Of a recipe.
    pub fn new(recipe: &FlightRecipe) -> Self {
        Self {
            numbers: Numbers::new(&recipe.case, &recipe.plan),
            laws: Laws::new(&recipe.law, &recipe.case, &recipe.plan),
        }
    }

    /// The state in which the flight begins.
    pub fn start(&self, plan: &Plan) -> Flight<f64> {
        let case = &self.numbers.case;
        Flight {
            truth: case.start,
            vehicle: self.numbers.chaser,
            law: self.laws.before,
            memory: Memory {
                sensors: Sensors { sigmas: &case.sensors, noisy: Noisy::new(&case.sensors) }.begin(),
                navigator: Part::<f64>::begin(&navigation::Direct),
                law: self.laws.before.as_ref().map(Part::begin),
                allocator: Part::<f64>::begin(&allocation::Direct),
                actuators: Actuators { limits: &case.actuators, saturation: plan.saturation }.begin(),
            },
            capture: CaptureState::open(),
            joint: Joint::open(),
            stack_goal: case.goal.position,
            no_gains: self.laws.before.as_ref().map_or(0.0, no_gains),
        }
    }
}

/// 1 for a law that cannot command.
pub(crate) fn no_gains(law: &Law<f64>) -> f64 {
    f64::from(u8::from(!law.has_finite_gains()))
}

/// What is the same for all flights of a campaign, whichever of them share a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Common {
    /// Sensors that are noisy in any flight.
    pub noisy: Noisy,
    /// What is known of all flights' inertias.
    pub shapes: Shapes,
    /// All fly the same law with the same gains.
    pub same_laws: bool,
}

impl Common {
    /// Of flights of this recipe that differ in the numbers at some paths. Such a number is not known beforehand, so it
    /// stands here as NaN: no noise of that size is silent, no such tensor has a shape, no such gain equals another.
    ///
    /// # Errors
    /// The path at which there is no number.
    pub fn new<'a>(recipe: &FlightRecipe, differing: impl IntoIterator<Item = &'a str>) -> Result<Self, &'a str> {
        let mut known = recipe.clone();
        for path in differing {
            known.field(path).ok_or(path)?.fill(f64::NAN);
        }
        let FlightRecipe { case, law, plan } = &known;
        let (chaser, debris) = (&case.chaser.inertia, &case.debris.inertia);
        let merges_askew = plan.transition == Transition::MomentumConserving;
        Ok(Self {
            noisy: Noisy::new(&case.sensors),
            shapes: Shapes {
                principal_axes: chaser.is_diagonal() && debris.is_diagonal() && !merges_askew,
                symmetric_debris: is_symmetric_top(debris) && !plan.disturbances.any(),
            },
            same_laws: *law == recipe.law
                && case.belief == recipe.case.belief
                && case.orbit.mean_motion == recipe.case.orbit.mean_motion,
        })
    }
}

/// What the flights of one batch have in common, and their numbers lane by lane.
pub struct Scene<R: Real> {
    /// Clocks and switches.
    pub plan: Plan,
    /// What holds for the whole campaign.
    pub common: Common,
    /// Numbers, a lane each.
    pub numbers: Numbers<R>,
    /// What the ticks' times are called.
    pub clock: Clock,
    /// Integration step \[s\].
    pub(crate) step: f64,
    pub(crate) law_after: Option<Law<R>>,
    laws: Vec<Laws>,
}

impl<R: Real> Scene<R> {
    /// All lanes fly `prepared`.
    pub fn new(plan: &Plan, common: Common, prepared: &PreparedFlight) -> Self {
        Self {
            plan: *plan,
            common,
            numbers: Batch::same(&prepared.numbers),
            clock: Clock::new(plan.control_period),
            step: plan.step(),
            law_after: Batch::<R>::same(&prepared.laws.after),
            laws: vec![prepared.laws.clone(); R::LANES],
        }
    }

    /// Lane `i` flies another prepared.
    pub fn put(&mut self, i: usize, prepared: &PreparedFlight) {
        self.numbers.put(i, &prepared.numbers);
        Batch::<R>::put(&mut self.law_after, i, &prepared.laws.after);
        self.laws[i].clone_from(&prepared.laws);
    }

    /// The sensors.
    #[inline(always)]
    pub(crate) fn sensors(&self) -> Sensors<'_, R> {
        Sensors { sigmas: &self.numbers.case.sensors, noisy: self.common.noisy }
    }

    /// The actuators.
    #[inline(always)]
    pub(crate) fn actuators(&self) -> Actuators<'_, R> {
        Actuators { limits: &self.numbers.case.actuators, saturation: self.plan.saturation }
    }

    /// The goal of two separate bodies.
    #[inline(always)]
    pub(crate) fn approach(&self, motion: &Motion<R>, time: R) -> Target<R> {
        let case = &self.numbers.case;
        if self.plan.goal == Goal::Fixed {
            return guidance::fixed_point(case.goal.position, motion);
        }
        let grasp = GraspPoints {
            chaser: case.chaser.grasp_point,
            debris: case.debris.grasp_point,
            debris_inertia: self.numbers.around.debris,
        };
        guidance::grasp_points(&grasp, motion, &Lvlh::at(&case.orbit, time), self.plan.goal.feeds_acceleration())
    }

    /// The laws of stacks that have just been made, for their true mass and inertia; in other lanes `designed`.
    pub(crate) fn laws_for(&self, made: R::Mask, vehicle: &Vehicle<R>, designed: &Law<R>) -> Law<R> {
        let mut laws = *designed;
        for i in (0..R::LANES).filter(|&i| made.lane(i)) {
            let Laws { recipe, setting, .. } = &self.laws[i];
            let truth = MassProperties { mass: vehicle.mass.lane(i), inertia: vehicle.inertia.tensor.lane(i) };
            let law = recipe.build(Phase::AfterCapture, &truth, setting);
            Batch::<R>::put(&mut laws, i, &law.expect("only laws are rebuilt at capture"));
        }
        laws
    }

    /// The wrench of the segment in force, or of the record, if any. All lanes are at the same tick: open loop, no flight
    /// ends early.
    pub(crate) fn open_loop(&self, tick: R) -> (Wrench<R>, WrenchFrame) {
        let recipe = &*self.laws[0].recipe;
        let number = tick.lane(0) as u32;
        let segment = recipe.segments().iter().find(|s| (s.first_tick..s.end_tick).contains(&number));
        let frame = match segment {
            Some(Segment { frame: WrenchFrame::Lvlh, torque: Vec3([0.0, 0.0, 0.0]), .. }) | None => {
                WrenchFrame::Command // a force held in H alone
            }
            Some(segment) => segment.frame,
        };
        let wrench = match recipe {
            LawRecipe::Recorded { wrenches, .. } => wrenches
                .get(number as usize)
                .map(|&[fx, fy, fz, tx, ty, tz]| Wrench { force: Vec3([fx, fy, fz]), torque: Vec3([tx, ty, tz]) }),
            _ => segment.map(|segment| Wrench { force: segment.force, torque: segment.torque }),
        };
        (Batch::<R>::same(&wrench.unwrap_or_else(Wrench::zero)), frame)
    }
}
