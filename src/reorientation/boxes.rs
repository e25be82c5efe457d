//! Where to search, and how finely: what a file does not say follows from the robot, its limits and the turn it is to make.

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::accuracy::Accuracy;
use super::fitness::Reorientation;
use crate::input::{Document, InputError, Positive, positive_interval};
use crate::search::Rng;
use crate::task::Task;
use crate::trajectory::{Family as _, Limits, Peaks, SinePolynomial};

/// The `[trajectory.box]` table.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct BoxTable {
    /// Half-widths for the coefficients of the first, second, … bump; the last serves all further.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) coefficient: Option<Spanned<Vec<Positive>>>,
    /// Shortest and longest duration \[s\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) duration: Option<Duration>,
    /// Half-widths for `α_6`, `α_7`, … \[s⁻⁶, s⁻⁷, …\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) alpha: Option<Spanned<Vec<Positive>>>,
}

/// Shortest and longest duration \[s\].
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Duration(#[serde(deserialize_with = "positive_interval")] pub(super) [f64; 2]);

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

/// Half-widths of the narrowest default box, by bump; the last serves all further ones.
const NARROWEST: [f64; 4] = [1.0, 0.35, 0.15, 0.05];

/// By what the widest default box is wider. A phase that goes so far and back takes its joint ten times through its range.
const WIDEST: f64 = 16.0;

/// A box suffices where the base has to turn by no more than so many times what it typically turns on a path in the box.
const SUFFICES: f64 = 4.0;

/// Terms of the paths that the base's turn is measured on, whatever the number to search.
const TERMS: usize = 2;

/// Random paths that it is measured on.
const PATHS: usize = 256;

/// Steps and intervals that serve splines, and of sine polynomials a box of up to [`SERVES`] times the narrowest, and terms up to [`SERVES_TERMS`].
pub(super) const COARSE: Accuracy = Accuracy { attitude_steps: 24, peak_intervals: 47 };
const SERVES: f64 = 4.0;
const SERVES_TERMS: usize = 8;

/// Intervals more for each further term.
const INTERVALS_PER_TERM: usize = 16;

impl BoxTable {
    pub(super) fn is_empty(&self) -> bool {
        self.coefficient.is_none() && self.duration.is_none() && self.alpha.is_none()
    }

    pub(super) fn build(
        &self,
        task: &Arc<Task>,
        terms: usize,
        document: &Document,
    ) -> Result<Boxes, InputError> {
        let coefficient = self.coefficients(task, terms, document)?;
        let problem = Reorientation::new(task.clone(), terms, COARSE);
        let family = problem.family();
        let around = |width| around_typical(family, &task.limits, width);
        let given = self.duration.map(|Duration(given)| given);
        let typical = given.unwrap_or_else(|| around(coefficient[0]));
        let duration = given.unwrap_or_else(|| {
            // A wider box leaves out no fast motion.
            [typical[0].min(around(NARROWEST[0])[0]), typical[1]]
        });
        let alpha = match &self.alpha {
            None => default_alpha(family, &coefficient, typical),
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
            let place = self.coefficient.as_ref().map_or(0..0, Spanned::span);
            return Err(document.error_at(place, message, None));
        }
        Ok(Boxes { coefficient, duration, alpha })
    }

    /// Half-widths of the coefficients, one per term.
    fn coefficients(
        &self,
        task: &Arc<Task>,
        terms: usize,
        document: &Document,
    ) -> Result<Vec<f64>, InputError> {
        let widths: Vec<f64> = if let Some(given) = &self.coefficient {
            given.get_ref().iter().map(|w| w.0).collect()
        } else {
            let wider = widening(task);
            NARROWEST.map(|width| wider * width).to_vec()
        };
        let Some(last) = widths.last() else {
            let message = "found an empty list, expected at least one half-width";
            let place = self.coefficient.as_ref().map_or(0..0, Spanned::span);
            return Err(document.error_at(place, message, None));
        };
        Ok(widths.iter().chain(std::iter::repeat(last)).copied().take(terms).collect())
    }
}

impl From<&Boxes> for BoxTable {
    fn from(boxes: &Boxes) -> Self {
        let stated = |widths: &[f64]| {
            Some(Spanned::new(0..0, widths.iter().copied().map(Positive).collect()))
        };
        Self {
            coefficient: stated(&boxes.coefficient),
            duration: Some(Duration(boxes.duration)),
            alpha: stated(&boxes.alpha),
        }
    }
}

impl Boxes {
    /// How finely motions in the box are evaluated during a search, where a file does not say.
    pub(super) fn accuracy(&self) -> Accuracy {
        let wider = self.coefficient.iter().zip(NARROWEST).map(|(width, narrow)| width / narrow);
        let wider = wider.fold(1.0, f64::max).min(WIDEST);
        let finer = (wider / SERVES).ceil() as usize;
        let more = INTERVALS_PER_TERM * self.coefficient.len().saturating_sub(SERVES_TERMS);
        Accuracy {
            attitude_steps: finer * COARSE.attitude_steps,
            // Ends of intervals fill the lanes.
            peak_intervals: finer * (COARSE.peak_intervals + 1 + more) - 1,
        }
    }
}

/// By what the default box is wider than the narrowest: a whole number from one to [`WIDEST`].
///
/// The straight path of phases leaves the base some way from its goal. How far paths in the narrowest box turn it that way is the
/// root mean square over random ones. Where a small multiple of that does not suffice, joints have to swing several times, and in a random
/// path in a wider box the turns of its swings add up like the steps of a random walk: with the root of the width.
fn widening(task: &Arc<Task>) -> f64 {
    let problem = Reorientation::new(task.clone(), TERMS, COARSE);
    let dimension = problem.family().dimension();
    let straight = problem.rotation_over(&vec![0.0; dimension], 0.0).inverse();
    let missing = (straight * task.start.base.inverse() * task.goal.base).scaled_axis();
    let mut rng = Rng::new(1);
    let square = |_| {
        let widths = NARROWEST[..TERMS].iter().cycle().take(dimension);
        let path: Vec<f64> = widths.map(|&width| rng.uniform(-width, width)).collect();
        let turn = (straight * problem.rotation_over(&path, 0.0)).scaled_axis();
        turn.dot(&missing).powi(2)
    };
    let typical = ((0..PATHS).map(square).sum::<f64>() / PATHS as f64).sqrt();
    // Of a base that no path turns this way, zero or an infinite or undefined number of times.
    let times = missing.norm_squared() / (SUFFICES * typical);
    if missing.norm() < NOTHING { 1.0 } else { times.powi(2).ceil().clamp(1.0, WIDEST) }
}

/// A turn below it is none \[rad\].
const NOTHING: f64 = 1e-9;

/// From a quarter to one and a half times the shortest duration of a typical shape: every joint's
/// first bump at half its half-width. Follows the limits, and is never zero, though start and goal be the same.
fn around_typical(family: &SinePolynomial, limits: &Limits, width: f64) -> [f64; 2] {
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
        for (sum, power) in alpha.iter_mut().zip(powers.iter().step_by(family.leading().len())) {
            *sum += power.abs();
        }
    }
    alpha
}
