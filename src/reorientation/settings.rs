//! The `[trajectory]` table, and the file of a single task.

use std::num::NonZeroUsize;
use std::ops::Range;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::accuracy::Accuracy;
use super::fitness::Reorientation;
use crate::input::{Document, InputError, Positive, count, positive_interval};
use crate::task::{Task, TaskTable};
use crate::trajectory::{Limits, Peaks, SinePolynomial};

/// The paper's task and the default settings.
pub(super) const DEFAULTS: &str = include_str!("defaults.toml");

/// Most free coefficients per joint; beyond, powers of `t` no longer tell shapes apart.
const MOST_TERMS: usize = 16;

/// A file with one task.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct TaskFile {
    /// The task.
    pub task: TaskTable,
    /// The family to search and how.
    pub trajectory: TrajectoryTable,
}

/// The `[trajectory]` table.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct TrajectoryTable {
    /// Free coefficients per joint; two are the paper's.
    terms: Spanned<usize>,
    /// Magnus steps along the path during a search.
    #[serde(deserialize_with = "count::<10_000, _, _>")]
    attitude_steps: NonZeroUsize,
    /// Intervals in which peaks are bracketed during a search.
    #[serde(deserialize_with = "count::<100_000, _, _>")]
    peak_intervals: NonZeroUsize,
    /// Where to search.
    #[serde(rename = "box")]
    boxes: BoxTable,
}

/// The `[trajectory.box]` table.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct BoxTable {
    /// Half-widths for the coefficients of the first, second, … bump; the last serves all further.
    coefficient: Spanned<Vec<Positive>>,
    /// Shortest and longest duration \[s\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    duration: Option<Duration>,
    /// Half-widths for `α_6`, `α_7`, … \[s⁻⁶, s⁻⁷, …\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    alpha: Option<Spanned<Vec<Positive>>>,
}

#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Duration(#[serde(deserialize_with = "positive_interval")] [f64; 2]);

/// The search box, in each formulation's variables.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Boxes {
    /// Half-width for the coefficient of each term.
    pub coefficient: Vec<f64>,
    /// Shortest and longest duration \[s\].
    pub duration: [f64; 2],
    /// Half-width for each power's `α` \[s⁻⁶, s⁻⁷, …\].
    pub alpha: Vec<f64>,
}

impl TaskFile {
    /// The file that leaves everything to the paper.
    pub fn paper() -> Document {
        Document::embedded("the paper's task", "")
    }

    /// Reads a file; what it leaves out is the paper's.
    pub fn read(document: &Document) -> Result<Self, InputError> {
        document.parse_over(&[DEFAULTS])
    }

    /// The task, its search settings and its boxes.
    pub fn build(&self, document: &Document) -> Result<(Reorientation, Boxes), InputError> {
        let task = Arc::new(self.task.build(document)?);
        self.trajectory.build(task, document)
    }
}

impl TrajectoryTable {
    /// Free coefficients per joint.
    #[cfg(feature = "harness")]
    pub(crate) fn terms(&self) -> &Spanned<usize> {
        &self.terms
    }

    /// The same settings with another number of terms.
    #[cfg(feature = "harness")]
    #[must_use]
    pub(crate) fn with_terms(&self, terms: Spanned<usize>) -> Self {
        Self { terms, ..self.clone() }
    }

    /// The problem over a task, and its search boxes.
    pub fn build(
        &self,
        task: Arc<Task>,
        document: &Document,
    ) -> Result<(Reorientation, Boxes), InputError> {
        let terms = *self.terms.get_ref();
        check_terms(terms, self.terms.span(), document)?;
        let accuracy = Accuracy {
            attitude_steps: self.attitude_steps.get(),
            peak_intervals: self.peak_intervals.get(),
        };
        let problem = Reorientation::new(task, terms, accuracy);
        let boxes = self.boxes.build(problem.family(), &problem.task().limits, document)?;
        Ok((problem, boxes))
    }
}

impl BoxTable {
    fn build(
        &self,
        family: &SinePolynomial,
        limits: &Limits,
        document: &Document,
    ) -> Result<Boxes, InputError> {
        let terms = family.terms();
        let given = self.coefficient.get_ref();
        let Some(last) = given.last() else {
            let message = "found an empty list, expected at least one half-width";
            return Err(document.error_at(self.coefficient.span(), message, None));
        };
        let widths = given.iter().chain(std::iter::repeat(last)).map(|w| w.0);
        let coefficient: Vec<f64> = widths.take(terms).collect();
        let duration = match self.duration {
            Some(Duration(given)) => given,
            None => default_duration(family, limits, coefficient[0]),
        };
        let alpha = match &self.alpha {
            None => default_alpha(family, &coefficient, duration),
            Some(widths) if widths.get_ref().len() == terms => {
                widths.get_ref().iter().map(|w| w.0).collect()
            }
            Some(widths) => {
                let found = widths.get_ref().len();
                let message = format!("found {found} half-widths, expected {terms}, one per term");
                return Err(document.error_at(widths.span(), message, None));
            }
        };
        let mut all = coefficient.iter().chain(&duration).chain(&alpha);
        if !all.all(|bound| bound.is_finite()) {
            let message = "durations or powers of time are infinite in this box: are limits and box of a sensible size?";
            return Err(document.error_at(self.coefficient.span(), message, None));
        }
        Ok(Boxes { coefficient, duration, alpha })
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

/// From a quarter to one and a half times the shortest duration of a typical shape: every joint's
/// first bump at half its half-width. Follows the limits, and is never zero, though start and goal be the same.
fn default_duration(family: &SinePolynomial, limits: &Limits, width: f64) -> [f64; 2] {
    let mut coefficients = vec![0.0; family.dimension()];
    coefficients.iter_mut().step_by(family.terms()).for_each(|c| *c = width / 2.0);
    let typical = Peaks::of(family, &coefficients, 256).shortest_duration(limits);
    [typical / 4.0, typical * 1.5]
}

/// The smallest box of `α` that holds the whole box of coefficients at the geometric mean of the
/// shortest and the longest duration.
fn default_alpha(
    family: &SinePolynomial,
    coefficient: &[f64],
    [shortest, longest]: [f64; 2],
) -> Vec<f64> {
    let duration = (shortest * longest).sqrt();
    let terms = family.terms();
    let mut alpha = vec![0.0; terms];
    for (k, width) in coefficient.iter().enumerate() {
        // The first joint stands for all: the change of basis is the same for each.
        let mut unit = vec![0.0; family.dimension()];
        unit[k] = *width;
        let powers = family.to_alpha(&unit, duration);
        for (sum, power) in alpha.iter_mut().zip(powers.iter().step_by(family.joints())) {
            *sum += power.abs();
        }
    }
    alpha
}
