//! Where the base ends if the robot is not quite what its file says.

use std::sync::Arc;

use rayon::prelude::*;
use serde::Serialize;

use super::any::AnyReorientation;
use crate::robot::RobotError;
use crate::task::{PathLimits, Task, Unknown};

/// Residuals of one motion over sampled robots.
#[derive(Debug, Clone, PartialEq)]
pub struct Robustness {
    /// The base's error angle \[rad\] with each of the robots that were drawn, in growing order.
    pub residuals: Vec<f64>,
    /// For each unknown by how much it turns the base at the end \[rad\], to first order, where it is off by all that it may be; the
    /// largest first.
    pub sensitivities: Vec<(Unknown, f64)>,
}

/// Shares of what unknowns may be off by, for differences.
const STEP: f64 = 0.05;

impl Robustness {
    /// Of a motion of a task that states what is uncertain; nothing of others.
    pub fn of(
        problem: &dyn AnyReorientation,
        coefficients: &[f64],
        duration: f64,
    ) -> Result<Option<Self>, RobotError> {
        let task = problem.task();
        let Some(uncertainty) = &task.uncertainty else { return Ok(None) };
        let plain = Task { path: PathLimits::default(), ..(**task).clone() };
        let error = |varied: Task| {
            let varied = problem.spec().over(Arc::new(varied), problem.accuracy());
            varied.error(coefficients, duration)
        };
        let drawn = uncertainty.draw(&plain)?;
        let mut residuals: Vec<f64> =
            drawn.into_par_iter().map(|task| error(task).angle()).collect();
        residuals.sort_by(f64::total_cmp);
        let sensitivity = |unknown: Unknown| {
            let at = |share| Ok(error(uncertainty.varied(&plain, &[(unknown, share)])?));
            let [up, down] = [at(STEP)?, at(-STEP)?];
            Ok((unknown, (down.inverse() * up).angle() / (2.0 * STEP)))
        };
        let unknowns = uncertainty.unknowns(&task.robot).into_par_iter();
        let mut sensitivities: Vec<_> =
            unknowns.map(sensitivity).collect::<Result<_, RobotError>>()?;
        sensitivities.sort_by(|a, b| b.1.total_cmp(&a.1));
        Ok(Some(Self { residuals, sensitivities }))
    }

    /// The residual \[rad\] that this share of the robots does not exceed.
    pub fn quantile(&self, share: f64) -> f64 {
        let last = self.residuals.len().saturating_sub(1);
        let place = (share * last as f64).round() as usize;
        self.residuals.get(place.min(last)).copied().unwrap_or_default()
    }
}

/// The field `uncertainty` of `plan --json`.
#[derive(Debug, Serialize)]
pub struct RobustnessJson {
    samples: usize,
    seed: u64,
    residual_deg: ResidualsJson,
    sensitivities: Vec<SensitivityJson>,
}

#[derive(Debug, Serialize)]
struct ResidualsJson {
    median: f64,
    p95: f64,
    worst: f64,
}

/// What one unknown does at most, to first order.
#[derive(Debug, Serialize)]
struct SensitivityJson {
    of: String,
    residual_deg: f64,
}

impl RobustnessJson {
    /// Of a motion of this task.
    pub fn new(robustness: &Robustness, task: &Task) -> Self {
        let quantile = |share| robustness.quantile(share).to_degrees();
        let sensitivity = |(unknown, angle): &(Unknown, f64)| SensitivityJson {
            of: unknown.name(&task.robot),
            residual_deg: angle.to_degrees(),
        };
        Self {
            samples: robustness.residuals.len(),
            seed: task.uncertainty.as_ref().map_or(0, |own| own.seed),
            residual_deg: ResidualsJson {
                median: quantile(0.5),
                p95: quantile(0.95),
                worst: quantile(1.0),
            },
            sensitivities: robustness.sensitivities.iter().map(sensitivity).collect(),
        }
    }
}
