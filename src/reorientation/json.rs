//! What is known of a motion, as JSON: the fields that `plan --json` and `replay --json` share.

use serde::Serialize;

use super::any::AnyReorientation;
use super::excursions::Excursions;
use super::fitness::Assessment;
use crate::task::Task;

/// Intervals in which a motion is looked at between its start and its end.
const LOOKS: usize = 2000;

impl Excursions {
    /// How far base and joints go on the way of a motion.
    pub fn on_the_way(
        problem: &dyn AnyReorientation,
        coefficients: &[f64],
        duration: f64,
    ) -> Excursions {
        Excursions::of(problem.task(), &problem.sample(coefficients, duration, LOOKS))
    }
}

/// Cost and its parts.
#[derive(Debug, Serialize)]
pub struct AssessmentJson {
    j: f64,
    t_f: f64,
    residual_deg: f64,
    /// Null where it was not estimated, or the motion is too wild to.
    residual_error_deg: Option<f64>,
    penalty: f64,
    peaks: PeaksDeg,
}

#[derive(Debug, Serialize)]
struct PeaksDeg {
    rate_deg_s: Vec<f64>,
    acceleration_deg_s2: Vec<f64>,
    jerk_deg_s3: Vec<f64>,
}

impl From<&Assessment> for AssessmentJson {
    fn from(assessment: &Assessment) -> Self {
        let all = |k: usize| assessment.peaks.0.iter().map(|p| p[k].value.to_degrees()).collect();
        Self {
            j: assessment.cost,
            t_f: assessment.duration,
            residual_deg: assessment.residual().to_degrees(),
            residual_error_deg: assessment.residual_error.map(f64::to_degrees),
            penalty: assessment.penalty(),
            peaks: PeaksDeg {
                rate_deg_s: all(0),
                acceleration_deg_s2: all(1),
                jerk_deg_s3: all(2),
            },
        }
    }
}

/// How far base and joints go on the way.
#[derive(Debug, Serialize)]
pub struct ExcursionsJson {
    largest_base_turn_deg: f64,
    largest_base_turn_at: f64,
    largest_base_rate_deg_s: f64,
    range_used: Vec<f64>,
}

impl ExcursionsJson {
    /// Of a motion of a task.
    pub fn new(excursions: &Excursions, task: &Task) -> Self {
        Self {
            largest_base_turn_deg: excursions.base_turn.to_degrees(),
            largest_base_turn_at: excursions.base_turn_at,
            largest_base_rate_deg_s: excursions.base_rate.to_degrees(),
            range_used: excursions.range_used(task),
        }
    }
}

/// The shape of a motion: the paper's parameters only where it has them.
#[derive(Debug, Serialize)]
pub struct ShapeJson {
    #[serde(skip_serializing_if = "Option::is_none")]
    alpha6: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    alpha7: Option<Vec<f64>>,
    coefficients: Vec<Vec<f64>>,
}

impl ShapeJson {
    /// Of the motion with these coefficients, which takes so long \[s\].
    pub fn new(problem: &dyn AnyReorientation, coefficients: &[f64], duration: f64) -> Self {
        let powers = problem.powers(coefficients, duration);
        let mut papers = powers.filter(|powers| powers.len() == 2).into_iter().flatten();
        Self {
            alpha6: papers.next(),
            alpha7: papers.next(),
            coefficients: problem.rows(coefficients),
        }
    }
}
