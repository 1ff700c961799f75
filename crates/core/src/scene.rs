//! What the flights of a batch have in common, and their numbers lane by lane: everything that no event changes.

use crate::batch::Batch;
use crate::batch_struct;
use crate::case::{Case, Motion, Plan};
use crate::closed_loop::Flight;
use crate::gnc::capture::{CaptureState, CaptureTest, SettledTest};
use crate::gnc::guidance::{self, GraspPoints, Target};
use crate::gnc::laws::{Law, LawRecipe, MassProperties, Phase, Setting};
use crate::hardware::sensors::Noisy;
use crate::number::{Quat, Real, Vec3};
use crate::plant::attitude::Inertia;
use crate::plant::lvlh::Lvlh;
use crate::plant::orbit::HeldStep;
use crate::plant::propagate::{Surroundings, Vehicle, Wrench, WrenchFrame};

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
        Self {
            case: *case,
            around: Surroundings {
                orbit: case.orbit,
                translation: HeldStep::new(case.orbit.mean_motion, plan.step()),
                half_step: HeldStep::new(case.orbit.mean_motion, 0.5 * plan.step()),
                debris: Inertia::new(case.debris.inertia),
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
    recipe: LawRecipe,
    setting: Setting,
    before: Option<Law<f64>>,
    after: Option<Law<f64>>,
}

impl Laws {
    /// For what the law believes of chaser and stack.
    pub fn new(recipe: &LawRecipe, case: &Case<f64>, plan: &Plan) -> Self {
        let setting = Setting {
            mean_motion: case.orbit.mean_motion,
            two_epsilon: plan.two_epsilon,
            exact_surface_rate: plan.exact_surface_rate,
        };
        let belief = &case.belief;
        let chaser = MassProperties { mass: belief.chaser_mass, inertia: belief.chaser_inertia };
        let stack = MassProperties { mass: belief.stack_mass, inertia: belief.stack_inertia };
        Self {
            before: recipe.build(Phase::BeforeCapture, &chaser, &setting),
            after: recipe.build(Phase::AfterCapture, &stack, &setting),
            recipe: recipe.clone(),
            setting,
        }
    }

    /// Whether all gains are numbers; a Riccati equation may have no solution in double precision.
    pub fn have_finite_gains(&self) -> bool {
        self.before.iter().chain(&self.after).all(Law::has_finite_gains)
    }
}

/// What the flights of one batch have in common, and their numbers lane by lane.
pub struct Scene<'a, R: Real> {
    /// Clocks and switches.
    pub plan: &'a Plan,
    /// Numbers, a lane each.
    pub numbers: Numbers<R>,
    /// Which sensors are noisy anywhere in the campaign.
    pub noisy: Noisy,
    /// No lane ever has a product of inertia.
    pub(crate) principal_axes: bool,
    pub(crate) law_after: Option<Law<R>>,
    laws: &'a dyn Fn(usize) -> &'a Laws,
}

impl<'a, R: Real> Scene<'a, R> {
    /// Lane `i` flies `numbers(i)` with `laws(i)`.
    pub fn new(
        plan: &'a Plan,
        noisy: Noisy,
        numbers: &dyn Fn(usize) -> &'a Numbers<f64>,
        laws: &'a dyn Fn(usize) -> &'a Laws,
    ) -> Self {
        let diagonal = |i: usize| {
            let Numbers { case: Case { chaser, debris, .. }, .. } = numbers(i);
            chaser.inertia.is_diagonal() && debris.inertia.is_diagonal()
        };
        let stays_diagonal = !(plan.merge && plan.momentum_conserving);
        Self {
            plan,
            numbers: Batch::gather(numbers),
            noisy,
            principal_axes: stays_diagonal && (0..R::LANES).all(diagonal),
            law_after: gather_law(laws, |laws| &laws.after),
            laws,
        }
    }

    /// The state in which the flights begin.
    pub fn start(&self) -> Flight<R> {
        let case = &self.numbers.case;
        Flight {
            truth: case.start,
            vehicle: self.numbers.chaser,
            law: gather_law(self.laws, |laws| &laws.before),
            capture: CaptureState::open(),
            mount: Quat::identity(),
            stack_goal: case.goal.position,
        }
    }

    /// The goal of two separate bodies.
    #[inline(always)]
    pub(crate) fn approach(&self, motion: &Motion<R>, time: f64) -> Target<R> {
        let case = &self.numbers.case;
        if !self.plan.grasp {
            return guidance::fixed_point(case.goal.position, motion);
        }
        let grasp = GraspPoints {
            chaser: case.chaser.grasp_point,
            debris: case.debris.grasp_point,
            debris_inertia: self.numbers.around.debris,
        };
        guidance::grasp_points(&grasp, motion, &Lvlh::at(&case.orbit, time), self.plan.feedforward)
    }

    /// The law of a stack whose true mass and inertia it is told.
    pub(crate) fn law_for(&self, vehicle: &Vehicle<R>) -> Law<R> {
        let build = |i: usize| {
            let laws = (self.laws)(i);
            let truth = MassProperties { mass: vehicle.mass.lane(i), inertia: vehicle.inertia.tensor.lane(i) };
            laws.recipe.build(Phase::AfterCapture, &truth, &laws.setting)
        };
        let built: [Option<Law<f64>>; MAX_LANES] = std::array::from_fn(|i| if i < R::LANES { build(i) } else { None });
        Batch::gather(&|i| built[i].as_ref().expect("only laws are rebuilt at capture"))
    }

    /// The wrench of the segment in force, if any.
    pub(crate) fn open_loop(&self, number: u32) -> (Wrench<R>, WrenchFrame) {
        let segments = (self.laws)(0).recipe.segments();
        match segments.iter().find(|s| (s.first_tick..s.end_tick).contains(&number)) {
            Some(segment) => {
                let wrench =
                    Wrench { force: Vec3::from_lanes(|_| segment.force), torque: Vec3::from_lanes(|_| segment.torque) };
                let frame = if segment.body_frame {
                    WrenchFrame::Body
                } else if segment.torque == Vec3([0.0; 3]) {
                    WrenchFrame::Command // a force held in H alone
                } else {
                    WrenchFrame::Lvlh
                };
                (wrench, frame)
            }
            None => (Wrench::zero(), WrenchFrame::Command),
        }
    }
}

/// Lanes of the widest number type.
const MAX_LANES: usize = 8;

fn gather_law<'a, R: Real>(
    laws: &dyn Fn(usize) -> &'a Laws,
    phase: impl Fn(&'a Laws) -> &'a Option<Law<f64>>,
) -> Option<Law<R>> {
    phase(laws(0)).as_ref()?;
    Some(Batch::gather(&|i| phase(laws(i)).as_ref().expect("either all lanes fly a law or none does")))
}
