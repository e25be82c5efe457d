//! The task over whichever family: what files of motions and experiments ask of it.

use std::fmt::Debug;
use std::sync::Arc;

use nalgebra::UnitQuaternion;

use super::accuracy::Accuracy;
use super::boxes::Boxes;
use super::family::FamilySpec;
use super::fitness::{Assessment, Reorientation};
use super::formulation::{Formulated, Formulation};
use super::motion::Motion;
use super::sampling::Sampling;
use super::spline_box::SplineBox;
use crate::lanes::Width;
use crate::search::Failure;
use crate::task::Task;
use crate::trajectory::{Family, SinePolynomial, Spline};

/// A family that files name, with the variables and the box that it is searched in.
pub trait SearchedFamily: Family {
    /// Where it is searched.
    type Boxes: Debug + Clone + Send + Sync;

    /// Its formulations, the preferred one first.
    const FORMULATIONS: &[Formulation];

    /// Its name and size.
    fn spec(&self) -> FamilySpec;

    /// The task over it in one of its formulations.
    fn formulated(
        formulation: Formulation,
        task: Arc<Reorientation<Self>>,
        boxes: &Self::Boxes,
    ) -> Result<Formulated<Self>, Failure>;

    /// What keys of runs are made of.
    #[cfg(feature = "harness")]
    fn box_identity(boxes: &Self::Boxes) -> serde_json::Value;

    /// The paper's `α_6`, `α_7`, … \[s⁻⁶, s⁻⁷, …\] of a motion, one row per power, where the family has them.
    fn powers(&self, _coefficients: &[f64], _duration: f64) -> Option<Vec<Vec<f64>>> {
        None
    }
}

impl SearchedFamily for SinePolynomial {
    type Boxes = Boxes;

    const FORMULATIONS: &[Formulation] =
        &[Formulation::TimeFree, Formulation::Scaled, Formulation::Raw];

    fn spec(&self) -> FamilySpec {
        FamilySpec::SinePolynomial { terms: self.terms() }
    }

    fn formulated(
        formulation: Formulation,
        task: Arc<Reorientation>,
        boxes: &Boxes,
    ) -> Result<Formulated, Failure> {
        Ok(Formulated::new(formulation, task, boxes)?)
    }

    #[cfg(feature = "harness")]
    fn box_identity(boxes: &Boxes) -> serde_json::Value {
        serde_json::json!({
            "coefficient": boxes.coefficient,
            "duration": boxes.duration,
            "alpha": boxes.alpha,
        })
    }

    fn powers(&self, coefficients: &[f64], duration: f64) -> Option<Vec<Vec<f64>>> {
        let alpha = self.to_alpha(coefficients, duration);
        Some(alpha.chunks_exact(self.leading().len()).map(<[f64]>::to_vec).collect())
    }
}

impl SearchedFamily for Spline {
    type Boxes = SplineBox;

    const FORMULATIONS: &[Formulation] = &[Formulation::TimeFree, Formulation::Scaled];

    fn spec(&self) -> FamilySpec {
        FamilySpec::Spline { pieces: self.knots().pieces(), degree: self.knots().degree() }
    }

    fn formulated(
        formulation: Formulation,
        task: Arc<Reorientation<Self>>,
        boxes: &SplineBox,
    ) -> Result<Formulated<Self>, Failure> {
        Ok(match formulation {
            Formulation::TimeFree => Formulated::free_form(task)?,
            Formulation::Scaled => Formulated::free_form_scaled(task, boxes)?,
            Formulation::Raw => {
                return Err(
                    "splines have no powers of time, expected `time-free` or `scaled`".into()
                );
            }
        })
    }

    #[cfg(feature = "harness")]
    fn box_identity(boxes: &SplineBox) -> serde_json::Value {
        serde_json::json!({ "duration": boxes.duration })
    }
}

impl FamilySpec {
    /// The task over the family.
    ///
    /// # Panics
    ///
    /// Panics where [`Reorientation::new`] or [`Spline::new`] does.
    pub fn over(self, task: Arc<Task>, accuracy: Accuracy) -> Arc<dyn AnyReorientation> {
        match self {
            Self::SinePolynomial { terms } => Arc::new(Reorientation::new(task, terms, accuracy)),
            Self::Spline { pieces, degree } => {
                let family = task.splines(pieces, degree);
                Arc::new(Reorientation::over(task, family, accuracy))
            }
        }
    }
}

/// The task over a family, whichever it is.
pub trait AnyReorientation: Debug + Send + Sync {
    /// The task.
    fn task(&self) -> &Arc<Task>;

    /// The family's name and size.
    fn spec(&self) -> FamilySpec;

    /// Free coefficients in all.
    fn dimension(&self) -> usize;

    /// How finely motions are evaluated.
    fn accuracy(&self) -> Accuracy;

    /// The lanes that motions are evaluated with.
    fn width(&self) -> Width;

    /// The motion with these coefficients; see [`Reorientation::certify`].
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer coefficients than the family's dimension.
    fn certify(&self, coefficients: &[f64], duration: Option<f64>) -> Assessment;

    /// The rotation from the goal to where the base ends.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer coefficients than the family's dimension.
    fn error(&self, coefficients: &[f64], duration: f64) -> UnitQuaternion<f64>;

    /// The motion, sampled; see [`Motion::sample`].
    fn sample_at(&self, coefficients: &[f64], duration: f64, sampling: Sampling) -> Motion;

    /// The same at `intervals + 1` equally spaced times.
    fn sample(&self, coefficients: &[f64], duration: f64, intervals: usize) -> Motion {
        self.sample_at(coefficients, duration, Sampling::Intervals(intervals))
    }

    /// Whether motions beside this one end nearer to the goal; see [`Reorientation::is_held_by_time`].
    fn is_held_by_time(&self, coefficients: &[f64], duration: f64) -> bool;

    /// The paper's powers of time of a motion; see [`SearchedFamily::powers`].
    fn powers(&self, coefficients: &[f64], duration: f64) -> Option<Vec<Vec<f64>>>;

    /// The same as a value of its own.
    fn shared(&self) -> Arc<dyn AnyReorientation>;

    /// Coefficients in rows, one per joint that follows no other.
    fn rows(&self, coefficients: &[f64]) -> Vec<Vec<f64>> {
        let own = coefficients.len() / self.task().robot.leading_count();
        coefficients.chunks_exact(own).map(<[f64]>::to_vec).collect()
    }
}

impl<F: SearchedFamily> AnyReorientation for Reorientation<F> {
    fn task(&self) -> &Arc<Task> {
        self.task()
    }

    fn spec(&self) -> FamilySpec {
        self.family().spec()
    }

    fn dimension(&self) -> usize {
        self.family().dimension()
    }

    fn accuracy(&self) -> Accuracy {
        self.accuracy()
    }

    fn width(&self) -> Width {
        self.width()
    }

    fn certify(&self, coefficients: &[f64], duration: Option<f64>) -> Assessment {
        self.certify(coefficients, duration)
    }

    fn error(&self, coefficients: &[f64], duration: f64) -> UnitQuaternion<f64> {
        self.error_after(self.rotation_over(coefficients, duration))
    }

    fn sample_at(&self, coefficients: &[f64], duration: f64, sampling: Sampling) -> Motion {
        Motion::sample(self, coefficients, duration, sampling)
    }

    fn shared(&self) -> Arc<dyn AnyReorientation> {
        Arc::new(self.clone())
    }

    fn is_held_by_time(&self, coefficients: &[f64], duration: f64) -> bool {
        self.is_held_by_time(coefficients, duration)
    }

    fn powers(&self, coefficients: &[f64], duration: f64) -> Option<Vec<Vec<f64>>> {
        self.family().powers(coefficients, duration)
    }
}
