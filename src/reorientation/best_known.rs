//! The best motions known, from `results/best-known.toml`.
//!
//! A task and a family are told by a fingerprint of all that the least cost follows from, so that neither names nor the
//! way in which a file is written matter.

use std::fmt;
use std::sync::{Arc, LazyLock};
use std::time::SystemTime;

use chrono::{DateTime, Utc};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::accuracy::Accuracy;
use super::any::AnyReorientation;
use super::family::{FamilyName, FamilySpec};
use super::fitness::Assessment;
use crate::digest::digest;
use crate::input::{Document, InputError};
use crate::task::{Task, TaskTable};

/// Share of the best known cost that tells a better motion from the same one.
const SAME: f64 = 1e-6;

/// Numbers of a task below this are zero: what is left of a right angle's cosine.
const ZERO: f64 = 1e-12;

/// One entry of the file, written by `driftless plan`.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BestKnown {
    /// [`fingerprint`] of the task and the family.
    pub fingerprint: String,
    /// The motion's family; the paper's where nothing is said.
    #[serde(default = "papers")]
    pub family: FamilyName,
    /// Free coefficients per joint of a sine polynomial.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub terms: Option<usize>,
    /// Pieces of a spline.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pieces: Option<usize>,
    /// Degree of a spline.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub degree: Option<usize>,
    /// The cost `J`, evaluated finely, to ten significant digits.
    pub j: f64,
    /// Duration \[s\].
    pub t_f: f64,
    /// The least cost found over motions of any shape, where somebody looked for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub free_form_j: Option<f64>,
    /// Coefficients of bumps, or what control points add to the straight path \[rad\]; one row per joint that follows no
    /// other.
    pub coefficients: Vec<Vec<f64>>,
    /// The command that found it.
    pub found_by: String,
    /// Year, month and day.
    pub date: String,
    /// The task, with nothing left out.
    pub task: TaskTable,
}

/// The whole file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct BestKnownFile {
    motion: Vec<BestKnown>,
}

fn papers() -> FamilyName {
    FamilyName::SinePolynomial
}

fn document() -> Document {
    Document::embedded("best-known.toml", include_str!("../../results/best-known.toml"))
}

impl BestKnown {
    /// Every entry.
    #[expect(clippy::expect_used, reason = "the file comes with the program, and a test reads it")]
    pub fn all() -> &'static [Self] {
        static ALL: LazyLock<BestKnownFile> =
            LazyLock::new(|| document().parse().expect("the best known motions are readable"));
        &ALL.motion
    }

    /// What is known of a task over its family.
    pub fn of(problem: &dyn AnyReorientation) -> Option<&'static Self> {
        let fingerprint = fingerprint(problem);
        Self::all().iter().find(|entry| entry.fingerprint == fingerprint)
    }

    /// A motion as an entry.
    pub fn new(
        problem: &dyn AnyReorientation,
        task: TaskTable,
        coefficients: &[f64],
        assessment: &Assessment,
        found_by: String,
    ) -> Self {
        let spec = problem.spec();
        Self {
            fingerprint: fingerprint(problem),
            family: spec.name(),
            terms: spec.terms(),
            pieces: spec.pieces(),
            degree: spec.degree(),
            j: significant::<10>(assessment.cost),
            t_f: assessment.duration,
            free_form_j: None,
            coefficients: problem.rows(coefficients),
            found_by,
            date: DateTime::<Utc>::from(SystemTime::now()).date_naive().to_string(),
            task,
        }
    }

    /// The cost that exceeds the best known by this share of it, to six significant digits.
    pub fn target(&self, gap: f64) -> f64 {
        significant::<6>(self.j * (1.0 + gap))
    }

    /// Whether a cost is lower, and by more than the last digits.
    pub fn is_beaten_by(&self, cost: f64) -> bool {
        self.gap(cost) < -SAME
    }

    /// By which share of it a cost exceeds the best known.
    fn gap(&self, cost: f64) -> f64 {
        (cost - self.j) / self.j
    }

    /// How a cost compares, in words.
    pub fn compared_with(&self, cost: f64) -> String {
        let percent = 100.0 * self.gap(cost);
        let known = format!("the best known, {:.6}", self.j);
        match percent {
            p if p.abs() <= 100.0 * SAME => format!("reaches {known}"),
            p if p > 0.0 => format!("{} % above {known}", significant::<3>(p)),
            p => format!("{} % below {known}", significant::<3>(-p)),
        }
    }

    /// The entry's motion over its task, evaluated finely.
    pub fn replay(&self) -> Result<(Arc<dyn AnyReorientation>, Assessment), InputError> {
        let document = document();
        let error = |message: &str| document.error_at(0..0, message, None);
        let spec = FamilySpec::of(self.family, self.terms, self.pieces, self.degree)
            .ok_or_else(|| error("found an entry without the size of its family"))?;
        let problem = spec.over(self.task.build(&document)?.into(), Accuracy::FINE);
        let coefficients = self.coefficients.concat();
        if coefficients.len() != problem.dimension() {
            return Err(error("found an entry with other coefficients than its family's"));
        }
        let assessment = problem.certify(&coefficients, Some(self.t_f));
        Ok((problem, assessment))
    }
}

/// The text to put into the file.
impl fmt::Display for BestKnown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let file = BestKnownFile { motion: vec![self.clone()] };
        f.write_str(&toml::to_string(&file).map_err(|_| fmt::Error)?)
    }
}

/// What the least cost of a task over a family follows from: the first 16 hexadecimal digits of the SHA-256 of a JSON text with sorted
/// keys, numbers rounded to nine significant digits, of the robot's joints and bodies at zero positions,
/// the joints' positions at both ends, the turn of the base from start to goal, the limits, `K_b` and the number of terms;
/// of a spline its pieces and degree instead of that.
///
/// Boxes and accuracies are those of a search, not of the task.
pub fn fingerprint(problem: &dyn AnyReorientation) -> String {
    let Task {
        robot,
        start,
        goal,
        tool: _,
        limits,
        angular_momentum,
        least_duration,
        base_weight,
        goal_tolerance: _,
        path,
        uncertainty: _,
        robust,
    } = &**problem.task();
    let turn = start.base.inverse() * goal.base;
    let components = [turn.w, turn.i, turn.j, turn.k];
    let first = components.into_iter().find(|component| component.abs() >= ZERO);
    // Of the two quaternions for one turn, the one whose first component, the real part before the
    // others, is positive.
    let sign = if first.is_some_and(|first| first < 0.0) { -1.0 } else { 1.0 };
    let mut determinants = json!({
        "robot": robot.identity(),
        "start": start.joints,
        "goal": goal.joints,
        "turn": components.map(|component| sign * component),
        "limits": limits.0,
        "base_weight": base_weight,
    });
    if let Some(path) = path.identity(robot) {
        // Cones stand in inertial axes.
        determinants["path"] = json!({ "limits": path, "start": start.base.coords.as_slice() });
    }
    if let Some(momentum) = angular_momentum {
        let at_start = start.base.inverse() * momentum;
        determinants["momentum"] = json!(at_start.as_slice());
    }
    if *least_duration > 0.0 {
        determinants["least_duration"] = json!(least_duration);
    }
    if let Some(robust) = robust {
        determinants["robust"] = robust.identity();
    }
    let spec = problem.spec();
    for (name, size) in
        [("terms", spec.terms()), ("pieces", spec.pieces()), ("degree", spec.degree())]
    {
        if let Some(size) = size {
            determinants[name] = size.into();
        }
    }
    digest(&canonical(determinants).to_string())
}

/// Keys sorted, numbers rounded.
fn canonical(value: Value) -> Value {
    match value {
        Value::Number(number) => {
            let number = number.as_f64().unwrap_or_default();
            let rounded = if number.abs() < ZERO { 0.0 } else { significant::<9>(number) };
            rounded.into()
        }
        Value::Array(values) => values.into_iter().map(canonical).collect(),
        Value::Object(map) => {
            let mut entries: Vec<_> = map.into_iter().collect();
            entries.sort_by(|a, b| a.0.cmp(&b.0));
            let entries = entries.into_iter().map(|(key, value)| (key, canonical(value)));
            Value::Object(entries.collect::<Map<_, _>>())
        }
        other => other,
    }
}

/// A number rounded to so many significant digits.
fn significant<const DIGITS: usize>(number: f64) -> f64 {
    let text = format!("{number:.*e}", DIGITS - 1);
    text.parse().unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is printed can be put into the file.
    #[test]
    fn an_entry_reads_back() {
        let entry = &BestKnown::all()[0];
        let (problem, assessment) = entry.replay().unwrap();
        let coefficients = entry.coefficients.concat();
        let text =
            BestKnown::new(&*problem, entry.task.clone(), &coefficients, &assessment, "x".into())
                .to_string();
        let file: BestKnownFile = Document::embedded("entry", &text).parse().unwrap();
        let [again] = &file.motion[..] else { panic!("expected one motion") };
        assert_eq!(again.fingerprint, entry.fingerprint);
        assert_eq!((again.j, again.t_f), (entry.j, entry.t_f));
        assert_eq!(again.coefficients, entry.coefficients);
        assert_eq!(again.replay().unwrap().1.cost, assessment.cost);
    }
}
