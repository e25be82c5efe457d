//! The `[trajectory]` table, and the file of a single task.

use std::num::NonZeroUsize;
use std::ops::{Range, RangeInclusive};
use std::sync::Arc;

use serde::{Deserialize, Serialize, Serializer};
use toml::Spanned;

use super::accuracy::Accuracy;
use super::boxes::{BoxTable, Boxes, COARSE, Duration};
use super::family::FamilyName;
use super::fitness::Reorientation;
use super::spline_box::SplineBox;
use crate::input::{Document, InputError, optional_count};
use crate::task::{Task, TaskTable};
use crate::trajectory::Spline;

/// The default settings.
pub(super) const DEFAULTS: &str = include_str!("defaults.toml");

/// Most free coefficients per joint; beyond, powers of `t` no longer tell shapes apart.
const MOST_TERMS: usize = 16;

/// Pieces that a spline may have.
const PIECES: RangeInclusive<usize> = 4..=1000;

/// Pieces of the splines that `plan` searches, where nothing says.
const PLANNED_PIECES: usize = 80;

/// Degrees that a spline may have.
const DEGREES: RangeInclusive<usize> = 3..=5;

/// A file with one task.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct TaskFile {
    /// The task.
    pub task: TaskTable,
    /// The family to search and how.
    pub trajectory: TrajectoryTable,
}

/// The `[trajectory]` table. Sizes of all families have values; those of other families than its own matter where a sweep names them.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct TrajectoryTable {
    /// Whose motions are searched.
    family: Spanned<FamilyName>,
    /// Free coefficients per joint of a sine polynomial; two are the paper's.
    terms: Spanned<usize>,
    /// Equal pieces of a spline.
    pieces: Spanned<usize>,
    /// Degree of a spline.
    degree: Spanned<usize>,
    /// Magnus steps along the path during a search.
    #[serde(default, deserialize_with = "optional_count::<1, 10_000, _, _>")]
    attitude_steps: Option<NonZeroUsize>,
    /// Intervals in which peaks are bracketed during a search.
    #[serde(default, deserialize_with = "optional_count::<1, 100_000, _, _>")]
    peak_intervals: Option<NonZeroUsize>,
    /// Where to search.
    #[serde(rename = "box", default)]
    boxes: BoxTable,
    /// The families of a sweep; empty for the table's own.
    #[serde(skip)]
    swept: Vec<FamilyName>,
}

/// What the table says of its families, and nothing of others, so that it reads back.
#[derive(Serialize)]
struct WrittenTrajectory<'a> {
    family: FamilyName,
    #[serde(skip_serializing_if = "Option::is_none")]
    terms: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pieces: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    degree: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    attitude_steps: Option<NonZeroUsize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    peak_intervals: Option<NonZeroUsize>,
    #[serde(rename = "box", skip_serializing_if = "BoxTable::is_empty")]
    boxes: &'a BoxTable,
}

impl Serialize for TrajectoryTable {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let [is_sine, is_spline] = [FamilyName::SinePolynomial, FamilyName::Spline]
            .map(|family| self.families().contains(&family));
        let of = |is_used: bool, value: &Spanned<usize>| is_used.then(|| *value.get_ref());
        WrittenTrajectory {
            family: *self.family.get_ref(),
            terms: of(is_sine, &self.terms),
            pieces: of(is_spline, &self.pieces),
            degree: of(is_spline, &self.degree),
            attitude_steps: self.attitude_steps,
            peak_intervals: self.peak_intervals,
            boxes: &self.boxes,
        }
        .serialize(serializer)
    }
}

/// The task over the family that a file names, and where to search it.
#[derive(Debug, Clone)]
pub enum TaskProblem {
    /// Over sine polynomials.
    SinePolynomial(Reorientation, Boxes),
    /// Over splines.
    Spline(Reorientation<Spline>, SplineBox),
}

impl TaskProblem {
    /// The task.
    pub fn task(&self) -> &Arc<Task> {
        match self {
            Self::SinePolynomial(problem, _) => problem.task(),
            Self::Spline(problem, _) => problem.task(),
        }
    }
}

impl TaskFile {
    /// The file that leaves everything to the paper.
    pub fn paper() -> Document {
        Document::embedded("the paper's task", "")
    }

    /// Reads a file; what it leaves out of the task is that of its robot's own.
    pub fn read(document: &Document) -> Result<Self, InputError> {
        if let (Some(place), None) = (document.key("joint")?, document.key("task")?) {
            let message = "found the file of a robot, expected that of a task";
            let help = "a task names its robot's file as `robot` in `[task]`".to_owned();
            return Err(document.error_at(place, message, Some(help)));
        }
        let Self { task, trajectory } = document.parse_over(&[DEFAULTS])?;
        let trajectory = trajectory.implied();
        trajectory.check_keys(document)?;
        Ok(Self { task, trajectory })
    }

    /// The task over the file's family, and where to search it.
    pub fn problem(&self, document: &Document) -> Result<TaskProblem, InputError> {
        self.trajectory.build(Arc::new(self.task.build(document)?), document)
    }

    /// A task over the paper's family.
    pub(super) fn few_terms(
        &self,
        task: Arc<Task>,
        document: &Document,
    ) -> Result<TaskProblem, InputError> {
        self.trajectory.clone().with_family(FamilyName::SinePolynomial).build(task, document)
    }

    /// The same over the family that `plan` searches.
    #[must_use]
    pub fn planned(self) -> Self {
        Self { trajectory: self.trajectory.planned(), ..self }
    }

    /// The same with the goal's tolerance, and the box and the accuracy of its problem, written out.
    #[must_use]
    pub fn resolved(self, problem: &TaskProblem) -> Self {
        Self {
            task: self.task.resolved(problem.task()),
            trajectory: self.trajectory.resolved(problem),
        }
    }

    /// The task over sine polynomials, its search settings and its boxes; a file that names another family is an error.
    pub fn build(&self, document: &Document) -> Result<(Reorientation, Boxes), InputError> {
        match self.problem(document)? {
            TaskProblem::SinePolynomial(problem, boxes) => Ok((problem, boxes)),
            TaskProblem::Spline(..) => {
                let message = "found another family, expected `sine-polynomial`";
                Err(document.error_at(self.trajectory.family.span(), message, None))
            }
        }
    }
}

impl TrajectoryTable {
    /// The family, as the file or a default names it.
    pub fn family(&self) -> FamilyName {
        *self.family.get_ref()
    }

    /// Whether the file itself names a family, by its name or by a key that only one has.
    pub fn states_family(&self) -> bool {
        let mut spans = self.own_keys().map(|(_, _, span)| span).into_iter();
        !self.family.span().is_empty() || spans.any(|span| !span.is_empty())
    }

    /// The same over splines fit for a single plan, unless the file names a family.
    #[must_use]
    pub fn planned(self) -> Self {
        let names_sines = self.states_family() && self.family() == FamilyName::SinePolynomial;
        if names_sines || !self.family.span().is_empty() {
            self
        } else if self.pieces.span().is_empty() {
            let pieces = Spanned::new(0..0, PLANNED_PIECES);
            self.with_family(FamilyName::Spline).with_pieces(pieces)
        } else {
            self.with_family(FamilyName::Spline)
        }
    }

    /// The same over another family.
    #[must_use]
    pub fn with_family(self, family: FamilyName) -> Self {
        Self { family: Spanned::new(0..0, family), ..self }
    }

    /// The same with another number of terms.
    #[must_use]
    pub fn with_terms(self, terms: Spanned<usize>) -> Self {
        Self { terms, ..self }
    }

    /// The same with another number of pieces.
    #[must_use]
    pub fn with_pieces(self, pieces: Spanned<usize>) -> Self {
        Self { pieces, ..self }
    }

    /// The same with splines of another degree.
    #[must_use]
    pub fn with_degree(self, degree: Spanned<usize>) -> Self {
        Self { degree, ..self }
    }

    fn resolved(self, problem: &TaskProblem) -> Self {
        let (accuracy, boxes) = match problem {
            TaskProblem::SinePolynomial(problem, boxes) => (problem.accuracy(), boxes.into()),
            TaskProblem::Spline(problem, SplineBox { duration }) => {
                let duration = Some(Duration(*duration));
                (problem.accuracy(), BoxTable { duration, ..BoxTable::default() })
            }
        };
        Self {
            attitude_steps: NonZeroUsize::new(accuracy.attitude_steps),
            peak_intervals: NonZeroUsize::new(accuracy.peak_intervals),
            boxes,
            ..self
        }
    }

    /// The same where a sweep has these families.
    #[cfg(feature = "harness")]
    pub(super) fn swept_over(self, families: &[FamilyName]) -> Self {
        Self { swept: families.to_vec(), ..self }
    }

    /// The same with as many pieces as a spline with so many free coefficients per joint has, unless the file states them.
    pub(super) fn for_free(self, free: usize) -> Self {
        let pieces = (free + 6).saturating_sub(*self.degree.get_ref());
        if free > 0 && self.pieces.span().is_empty() {
            self.with_pieces(Spanned::new(0..0, pieces))
        } else {
            self
        }
    }

    /// The families that are searched.
    fn families(&self) -> &[FamilyName] {
        if self.swept.is_empty() {
            std::slice::from_ref(self.family.get_ref())
        } else {
            &self.swept
        }
    }

    /// The keys that only one family has, whose they are, and where they stand in the file, if they do.
    fn own_keys(&self) -> [(&'static str, FamilyName, Range<usize>); 5] {
        use FamilyName::{SinePolynomial, Spline};
        let BoxTable { coefficient, alpha, .. } = &self.boxes;
        let span = |widths: &Option<_>| widths.as_ref().map_or(0..0, Spanned::span);
        [
            ("terms", SinePolynomial, self.terms.span()),
            ("box.coefficient", SinePolynomial, span(coefficient)),
            ("box.alpha", SinePolynomial, span(alpha)),
            ("pieces", Spline, self.pieces.span()),
            ("degree", Spline, self.degree.span()),
        ]
    }

    /// The same over the family that its keys imply, unless it names one.
    #[must_use]
    pub(super) fn implied(self) -> Self {
        let keys = self.own_keys();
        match keys.into_iter().find(|(_, _, span)| !span.is_empty()) {
            Some((_, family, _)) if self.family.span().is_empty() => self.with_family(family),
            _ => self,
        }
    }

    /// Whether all keys that the file states are of the families that are searched.
    pub(super) fn check_keys(&self, document: &Document) -> Result<(), InputError> {
        let strange = |(_, family, span): &(&str, FamilyName, Range<usize>)| {
            !span.is_empty() && !self.families().contains(family)
        };
        match self.own_keys().into_iter().find(strange) {
            Some((key, family, span)) => Err(family.alone(key, span, document)),
            None => Ok(()),
        }
    }

    /// The problem over a task, and where to search it.
    pub fn build(&self, task: Arc<Task>, document: &Document) -> Result<TaskProblem, InputError> {
        match self.family() {
            FamilyName::SinePolynomial => {
                let terms = *self.terms.get_ref();
                check_terms(terms, self.terms.span(), document)?;
                let boxes = self.boxes.build(&task, terms, document)?;
                let problem = Reorientation::new(task, terms, self.accuracy(boxes.accuracy()));
                Ok(TaskProblem::SinePolynomial(problem, boxes))
            }
            FamilyName::Spline => {
                let family = self.spline(&task, document)?;
                let problem = Reorientation::over(task, family, self.accuracy(COARSE));
                let boxes = self.spline_box(&problem, document)?;
                Ok(TaskProblem::Spline(problem, boxes))
            }
        }
    }

    /// As finely as the file says, and as this where it does not.
    fn accuracy(&self, default: Accuracy) -> Accuracy {
        let given = |given: Option<NonZeroUsize>, default| given.map_or(default, NonZeroUsize::get);
        Accuracy {
            attitude_steps: given(self.attitude_steps, default.attitude_steps),
            peak_intervals: given(self.peak_intervals, default.peak_intervals),
        }
    }

    /// Splines between a task's start and goal.
    pub(super) fn spline(&self, task: &Task, document: &Document) -> Result<Spline, InputError> {
        let (pieces, degree) = (*self.pieces.get_ref(), *self.degree.get_ref());
        check_pieces(pieces, self.pieces.span(), document)?;
        if !DEGREES.contains(&degree) {
            let message = format!("found {degree}, expected a degree of 3, 4 or 5");
            return Err(document.error_at(self.degree.span(), message, None));
        }
        Ok(task.splines(pieces, degree))
    }

    fn spline_box(
        &self,
        problem: &Reorientation<Spline>,
        document: &Document,
    ) -> Result<SplineBox, InputError> {
        let boxes = match self.boxes.duration {
            Some(Duration(duration)) => SplineBox { duration },
            None => SplineBox::around(problem.family(), problem.task()),
        };
        if boxes.duration.iter().all(|bound| bound.is_finite()) {
            return Ok(boxes);
        }
        let message = "durations are infinite: are limits of a sensible size?";
        Err(document.error_at(self.family.span(), message, None))
    }
}

/// Whether a family can have so many terms.
pub(super) fn check_terms(
    terms: usize,
    span: Range<usize>,
    document: &Document,
) -> Result<(), InputError> {
    if (1..=MOST_TERMS).contains(&terms) {
        return Ok(());
    }
    let message = format!("found {terms}, expected 1 to {MOST_TERMS} terms");
    Err(document.error_at(span, message, None))
}

/// Whether a spline can have so many pieces.
pub(super) fn check_pieces(
    pieces: usize,
    span: Range<usize>,
    document: &Document,
) -> Result<(), InputError> {
    if PIECES.contains(&pieces) {
        return Ok(());
    }
    let (fewest, most) = PIECES.into_inner();
    let message = format!("found {pieces}, expected {fewest} to {most} pieces");
    Err(document.error_at(span, message, None))
}
