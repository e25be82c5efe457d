//! The fitness of the paper (eqs. 18, 20, 25–28, 33): turn the base, soon, within limits.

use std::array::from_fn;
use std::sync::{Arc, OnceLock};

use nalgebra::UnitQuaternion;

use super::accuracy::Accuracy;
use super::measure::{Fitness, Given, Tables, Turn, Workspace};
use super::path::{PathPeak, Sampled, Way};
use super::terms::{Terms, penalty};
use crate::lanes::Width;
use crate::search::Evaluation;
use crate::task::{PathLimits, Task};
use crate::trajectory::{Family, Peaks, SinePolynomial, excess, longest_asked, powers};

/// The reorientation task over one trajectory family.
#[derive(Debug, Clone)]
pub struct Reorientation<F: Family = SinePolynomial> {
    task: Arc<Task>,
    family: Arc<F>,
    accuracy: Accuracy,
    tables: Arc<Tables<F>>,
    /// Those that [`certify`](Self::certify) needs for most motions, made when first asked for, for this problem and all its
    /// clones.
    fine: Arc<[OnceLock<Arc<Tables<F>>>; 2]>,
    width: Width,
    /// The task with sampled robots, which the cost looks at, too.
    variants: Arc<[Self]>,
}

/// What is known of one motion.
#[derive(Debug, Clone)]
pub struct Assessment {
    /// The cost `J` (eq. 25).
    pub cost: f64,
    /// `‖δq_b‖`, the sine of half the base's error angle.
    pub attitude_error: f64,
    /// Duration \[s\].
    pub duration: f64,
    /// `F` of eqs. 26–28 for rate, acceleration and jerk.
    pub excess: [f64; 3],
    /// By how much joints leave their ranges, as a share of half the range of the one that does so most.
    pub range_excess: f64,
    /// The excess over limits on the way, as a sum over what they are on.
    pub path_excess: f64,
    /// The largest of what has a limit on the way.
    pub path: Vec<PathPeak>,
    /// By how much [`residual`](Self::residual) may be wrong \[rad\], where [that was estimated](Reorientation::certify);
    /// infinite where the motion is too wild to tell.
    pub residual_error: Option<f64>,
    /// Largest rate, acceleration and jerk of each joint \[rad/s, rad/s², rad/s³\].
    pub peaks: Peaks,
}

impl Reorientation {
    /// The task over the family with `terms` free coefficients per joint.
    ///
    /// # Panics
    ///
    /// Panics without a term, a step or an interval, or when the task does not fit its robot.
    pub fn new(task: Arc<Task>, terms: usize, accuracy: Accuracy) -> Self {
        let family = task.sine_polynomials(terms);
        Self::over(task, family, accuracy)
    }
}

impl<F: Family> Reorientation<F> {
    /// The task over a family between its start and goal.
    ///
    /// # Panics
    ///
    /// Panics without a step or an interval, or when limits or family are not for the task's joints.
    pub fn over(task: Arc<Task>, family: F, accuracy: Accuracy) -> Self {
        assert!(accuracy.attitude_steps > 0 && accuracy.peak_intervals > 0, "no accuracy at all");
        assert_eq!(task.limits.0.len(), task.robot.joint_count(), "limits for every joint");
        assert_eq!(family.joints(), task.robot.joint_count(), "a path for every joint");
        assert!(
            task.robot.leading().eq(family.leading().iter().copied()),
            "the same joints follow others in family and robot"
        );
        let tables = Tables::new(&task, &family, accuracy);
        let fine = <[OnceLock<_>; 2]>::default();
        if accuracy == Accuracy::FINE {
            let _ = fine[0].set(tables.clone());
        }
        let (family, fine) = (Arc::new(family), Arc::new(fine));
        let variants = Self::variants_of(&task, &family, accuracy);
        Self { task, family, accuracy, tables, fine, width: Width::widest(), variants }
    }

    /// The same problem, evaluated more or less finely; what sampled robots add to the cost stays as it is. Tables for
    /// [`Accuracy::FINE`] are made once for all clones.
    #[must_use]
    pub fn with_accuracy(&self, accuracy: Accuracy) -> Self {
        let make = || Tables::new(&self.task, self.family(), accuracy);
        let is_next = |fine: &Arc<Tables<F>>| accuracy == fine.twice(Accuracy::FINE);
        let kept = match &*self.fine {
            [fine, _] if accuracy == Accuracy::FINE => Some(fine),
            [fine, next] => fine.get().is_some_and(is_next).then_some(next),
        };
        let tables = kept.map_or_else(make, |kept| kept.get_or_init(make).clone());
        Self { accuracy, tables, ..self.clone() }
    }

    /// Twice as many steps and intervals as this problem's.
    pub(super) fn twice_as_fine(&self) -> Accuracy {
        self.tables.twice(self.accuracy)
    }

    /// The same problem, evaluated with so many lanes, or fewer where the machine has not so many; it
    /// begins with all that there are. Costs differ in their last digits between one lane and more, and
    /// not at all between more.
    #[must_use]
    pub fn with_width(&self, width: Width) -> Self {
        let width = width.min(Width::widest());
        let variants = self.variants.iter().map(|variant| variant.with_width(width)).collect();
        Self { width, variants, ..self.clone() }
    }

    /// The same problem with nothing asked for on the way, nor of robots other than the task's own.
    pub(super) fn relaxed(&self) -> Self {
        let task = Task { path: PathLimits::default(), robust: None, ..(*self.task).clone() };
        Self::over(Arc::new(task), (*self.family).clone(), self.accuracy).with_width(self.width)
    }

    /// The same problem over the family's [coarser](Family::coarser) one.
    pub(super) fn coarser(&self) -> Option<Self> {
        let coarser = Self::over(self.task.clone(), self.family.coarser()?, self.accuracy);
        Some(coarser.with_width(self.width))
    }

    /// The lanes that motions are evaluated with.
    pub fn width(&self) -> Width {
        self.width
    }

    /// How finely motions are evaluated.
    pub fn accuracy(&self) -> Accuracy {
        self.accuracy
    }

    /// The task.
    pub fn task(&self) -> &Arc<Task> {
        &self.task
    }

    /// The trajectory family.
    pub fn family(&self) -> &F {
        &self.family
    }

    pub(super) fn variants(&self) -> &[Self] {
        &self.variants
    }

    /// The terms of the cost.
    pub(super) fn terms(&self) -> Terms {
        let robust_weight = self.task.robust.as_ref().map_or(0.0, |robust| robust.weight);
        Terms::new(self.task.base_weight, robust_weight)
    }

    fn given(&self) -> Given<'_, F> {
        Given { task: &self.task, family: &self.family, tables: &self.tables }
    }

    pub(super) fn tables(&self) -> &Tables<F> {
        &self.tables
    }

    /// Room to evaluate motions in.
    pub fn workspace(&self) -> Workspace<F> {
        self.tables.workspace(&self.family)
    }

    /// The motion along the path with these coefficients, in `duration` seconds or, without one, in
    /// the shortest time within the limits.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer coefficients than the family's dimension.
    pub fn assess(&self, coefficients: &[f64], duration: Option<f64>) -> Assessment {
        self.look(coefficients, duration).1
    }

    /// The same, and the rotation from the goal to where the base ends.
    pub(super) fn look(
        &self,
        coefficients: &[f64],
        duration: Option<f64>,
    ) -> (UnitQuaternion<f64>, Assessment) {
        self.check(coefficients);
        let samples = self.samples(coefficients);
        let peaks = self.family.peaks(&samples, coefficients);
        let range_excess = self.range_excess(&samples);
        let sampled = self.sampled(coefficients);
        let way = sampled.as_ref().map(Sampled::way).unwrap_or_default();
        let (duration, excess) = match duration {
            Some(duration) => (duration, peaks.over(duration).excess(&self.task.limits)),
            None => (self.allowed(peaks.shortest_duration(&self.task.limits), &way), [0.0; 3]),
        };
        let off = self.error_after(self.rotation_over(coefficients, duration));
        let attitude_error = off.imag().norm();
        let path_excess = way.excess(duration);
        let beyond = range_excess + path_excess;
        let assessment = Assessment {
            cost: self.terms().cost(attitude_error, duration, &excess, beyond)
                + Terms::turns(&self.task.path.turn_weights, &way.turns)
                + self.robust_cost(coefficients),
            attitude_error,
            duration,
            excess,
            range_excess,
            path_excess,
            path: sampled.map(|sampled| sampled.peaks(duration)).unwrap_or_default(),
            residual_error: None,
            peaks: peaks.over(duration),
        };
        (off, assessment)
    }

    /// The cost of that motion alone: what [`assess`](Self::assess) finds, without the peaks that the
    /// cost does not follow from.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer coefficients than the family's dimension.
    pub fn evaluate(
        &self,
        coefficients: &[f64],
        duration: Option<f64>,
        workspace: &mut Workspace<F>,
    ) -> Evaluation {
        self.check(coefficients);
        let (net, largest) =
            self.width.run(Fitness { given: self.given(), coefficients, duration, workspace });
        let way = self.sampled(coefficients).map(|sampled| sampled.way()).unwrap_or_default();
        let (duration, excess) = match duration {
            Some(duration) => {
                let allowed = powers(duration);
                (duration, excess(from_fn(|k| largest[k] / allowed[k])))
            }
            None => (self.allowed(longest_asked(largest), &way), [0.0; 3]),
        };
        let net = net.unwrap_or_else(|| self.rotation_over(coefficients, duration));
        let attitude_error = self.error_after(net).imag().norm();
        let beyond = self.range_excess(&workspace.samples) + way.excess(duration);
        let cost = self.terms().cost(attitude_error, duration, &excess, beyond)
            + Terms::turns(&self.task.path.turn_weights, &way.turns)
            + self.robust_cost(coefficients);
        Evaluation { cost, violation: excess.iter().sum::<f64>() + beyond }
    }

    /// The shortest duration where the joints' limits ask for one.
    fn allowed(&self, asked: f64, way: &Way) -> f64 {
        asked.max(way.duration()).max(self.task.least_duration)
    }

    /// The path, looked at where the task asks for something on the way.
    pub(super) fn sampled<'a>(&'a self, coefficients: &'a [f64]) -> Option<Sampled<'a, F>> {
        let tables = self.tables.path.as_ref()?;
        let (family, arm) = (&*self.family, &self.tables.arm);
        Some(Sampled::new(&self.task, family, tables, arm, self.width, coefficients))
    }

    fn range_excess(&self, samples: &F::Samples) -> f64 {
        self.family.range_excess(samples, &self.tables.ranges)
    }

    fn check(&self, coefficients: &[f64]) {
        assert_eq!(coefficients.len(), self.family.dimension(), "terms × joints coefficients");
    }

    /// The rotation from the goal to where the base ends after it has turned so.
    pub(super) fn error_after(&self, net: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        self.given().error_after(net)
    }

    /// The base's rotation over the path with these coefficients, in the shortest duration where it follows that.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer coefficients than the family's dimension.
    pub fn net_rotation(&self, coefficients: &[f64]) -> UnitQuaternion<f64> {
        self.rotation_over(coefficients, self.timing(coefficients).duration)
    }

    /// The same in `duration` seconds, which do not matter without momentum.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer coefficients than the family's dimension.
    pub fn rotation_over(&self, coefficients: &[f64], duration: f64) -> UnitQuaternion<f64> {
        self.check(coefficients);
        let Task { robot, start, .. } = &*self.task;
        let Some(drift) = self.task.drift(start.base, duration) else {
            let joints = &mut Vec::new();
            return self.width.run(Turn { given: self.given(), coefficients, joints });
        };
        let Tables { rollout, .. } = self.tables();
        rollout.drifting_rotation(self.width, robot, &self.family, coefficients, drift)
    }
}

/// `‖δq_b‖` of eq. 20, the vector part of the rotation from the goal to `end`.
pub(super) fn attitude_error(goal: &UnitQuaternion<f64>, end: &UnitQuaternion<f64>) -> f64 {
    (goal.inverse() * end).imag().norm()
}

impl Assessment {
    /// The base's error angle \[rad\].
    pub fn residual(&self) -> f64 {
        2.0 * self.attitude_error.clamp(0.0, 1.0).asin()
    }

    /// Whether the base ends within this angle \[rad\] of its goal, as far as is sure.
    pub fn is_within(&self, tolerance: f64) -> bool {
        self.residual() + self.residual_error.unwrap_or_default() <= tolerance
    }

    /// The last three terms of `J`, and more of the same weight for joints out of their ranges and limits on the way.
    pub fn penalty(&self) -> f64 {
        penalty(&self.excess, self.range_excess + self.path_excess)
    }
}
