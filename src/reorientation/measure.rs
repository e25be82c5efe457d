//! What of a motion the fitness follows from, in lanes.

use std::array::from_fn;
use std::sync::Arc;

use nalgebra::UnitQuaternion;

use super::accuracy::Accuracy;
use super::path::PathTables;
use crate::attitude::{Midpoints, Rollout};
use crate::lanes::{LaneWork, Lanes};
use crate::momentum::{Arm, JointState};
use crate::task::Task;
use crate::trajectory::{Family, SinePolynomial, longest_asked, powers};

/// All that does not depend on the motion, worked out once.
#[derive(Debug)]
pub(super) struct Tables<F: Family> {
    pub(super) arm: Arm,
    pub(super) rollout: Rollout<F>,
    pub(super) sampler: F::Sampler,
    /// For differences that need a few digits only.
    pub(super) rough: Rollout<F>,
    pub(super) midpoints: Midpoints<F>,
    /// Where the task asks for something on the way.
    pub(super) path: Option<PathTables<F>>,
    /// The joints' ranges.
    pub(super) ranges: Vec<[f64; 2]>,
}

/// Panels along the path, of six nodes each, where a few digits suffice.
const ROUGH_PANELS: usize = 8;

/// Midpoint steps along the path for the curvature.
const CURVATURE_STEPS: usize = 12;

impl<F: Family> Tables<F> {
    pub(super) fn new(task: &Task, family: &F, accuracy: Accuracy) -> Arc<Self> {
        Arc::new(Self {
            arm: Arm::new(&task.robot),
            rollout: Rollout::new(family, accuracy.attitude_steps),
            rough: Rollout::of_panels(family, ROUGH_PANELS),
            sampler: family.sampler(accuracy.peak_intervals),
            midpoints: Midpoints::new(family, CURVATURE_STEPS),
            path: PathTables::new(task, family, accuracy),
            ranges: task.robot.joints().map(|joint| joint.range).collect(),
        })
    }

    /// Twice the intervals, and twice the steps, of tables made with this accuracy.
    pub(super) fn twice(&self, accuracy: Accuracy) -> Accuracy {
        Accuracy {
            attitude_steps: 2 * self.rollout.steps(),
            peak_intervals: 2 * accuracy.peak_intervals,
        }
    }

    /// Room to evaluate motions in.
    pub(super) fn workspace(&self, family: &F) -> Workspace<F> {
        Workspace { samples: family.samples(&self.sampler), joints: Vec::new() }
    }
}

/// Room for the evaluation of one motion of the same problem after the other.
#[derive(Debug, Clone)]
pub struct Workspace<F: Family = SinePolynomial> {
    pub(super) samples: F::Samples,
    joints: Vec<JointState>,
}

/// What is the same for all motions of a problem.
pub(super) struct Given<'a, F: Family> {
    pub(super) task: &'a Task,
    pub(super) family: &'a F,
    pub(super) tables: &'a Tables<F>,
}

#[expect(
    clippy::expl_impl_clone_on_copy,
    reason = "derived, it would ask the family to be `Clone`"
)]
impl<F: Family> Clone for Given<'_, F> {
    fn clone(&self) -> Self {
        *self
    }
}

// Not derived, which would ask the family to be `Copy`.
impl<F: Family> Copy for Given<'_, F> {}

impl<F: Family> Given<'_, F> {
    /// The rotation from the goal to where the base ends after it has turned so.
    pub(super) fn error_after(&self, net: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        self.task.goal.base.inverse() * self.task.start.base * net
    }
}

/// All that the cost follows from: the base's rotation, unless it follows the duration, and of each order the largest peak as a
/// multiple of its limit, where it matters.
pub(super) struct Fitness<'a, F: Family> {
    pub(super) given: Given<'a, F>,
    pub(super) coefficients: &'a [f64],
    pub(super) duration: Option<f64>,
    pub(super) workspace: &'a mut Workspace<F>,
}

impl<F: Family> LaneWork for Fitness<'_, F> {
    type Output = (Option<UnitQuaternion<f64>>, [f64; 3]);

    #[inline(always)]
    fn run<T: Lanes>(self) -> Self::Output {
        let Self { given, coefficients, duration, workspace } = self;
        let Workspace { samples, joints } = workspace;
        given.family.sample::<T>(&given.tables.sampler, coefficients, samples);
        let matters = |known: [f64; 3]| match duration {
            // Within a limit it does not matter how far.
            Some(duration) => {
                let allowed = powers(duration);
                from_fn(|k| f64::max(known[k], allowed[k]))
            }
            None => powers(longest_asked(known)),
        };
        let (limits, family) = (&given.task.limits, given.family);
        let largest = family.largest_ratio::<T>(samples, limits, matters, coefficients);
        let net = if given.task.angular_momentum.is_none() {
            Some(Turn { given, coefficients, joints }.run::<T>())
        } else {
            None
        };
        (net, largest)
    }
}

/// The base's rotation over a path without momentum.
pub(super) struct Turn<'a, F: Family> {
    pub(super) given: Given<'a, F>,
    pub(super) coefficients: &'a [f64],
    pub(super) joints: &'a mut Vec<JointState>,
}

impl<F: Family> LaneWork for Turn<'_, F> {
    type Output = UnitQuaternion<f64>;

    #[inline(always)]
    fn run<T: Lanes>(self) -> UnitQuaternion<f64> {
        let (family, Tables { arm, rollout, .. }) = (self.given.family, self.given.tables);
        rollout.net_rotation::<T>(arm, family, self.coefficients, self.joints)
    }
}
