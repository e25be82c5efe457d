//! The same task in different variables.

use std::sync::{Arc, OnceLock};

use nalgebra::{DMatrix, DVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::boxes::Boxes;
use super::fitness::{Assessment, Reorientation};
use super::measure::Workspace;
use super::spline_box::SplineBox;
use crate::search::{
    Bounds, BoundsError, Coarse, Composite, Differentiable, Evaluation, Failure, Linearisation,
    Multipliers, Points, Problem, Slopes, Subgradient, Timed,
};
use crate::trajectory::{Family, SinePolynomial, Spline};

/// The variables in which an optimiser sees the task.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Formulation {
    /// The paper's: `α_6` of all joints, `α_7` of all joints, …, `t_f`. Badly scaled.
    Raw,
    /// Bump coefficients, joint by joint, and `t_f`.
    Scaled,
    /// Bump coefficients alone; `t_f` is the shortest within the limits, so nothing is penalised.
    TimeFree,
}

impl Formulation {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Raw, Self::Scaled, Self::TimeFree];

    /// The formulation of a name; the preferred one where none is asked for.
    pub fn named(name: Option<&str>) -> Option<Self> {
        let Some(name) = name else { return Some(Self::TimeFree) };
        Self::ALL.into_iter().find(|known| known.name() == name)
    }

    /// The name used in files and tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Raw => "raw",
            Self::Scaled => "scaled",
            Self::TimeFree => "time-free",
        }
    }
}

/// The reorientation task in one of its formulations.
#[derive(Debug, Clone)]
pub struct Formulated<F: Family = SinePolynomial> {
    formulation: Formulation,
    task: Arc<Reorientation<F>>,
    bounds: Bounds,
    /// The family whose powers of time the variables are, where they are.
    powers: Option<SinePolynomial>,
    /// Makes the same over the family's coarser one, where the duration is no variable.
    make_coarser: fn(&Self) -> Option<Self>,
    /// What that made, once somebody asked.
    coarser: OnceLock<Option<Box<Self>>>,
    /// The same without what is asked for on the way, once somebody asked.
    relaxed: OnceLock<Box<Self>>,
}

impl Formulated {
    /// The task in these variables, within these boxes of its own family.
    pub fn new(
        formulation: Formulation,
        task: Arc<Reorientation>,
        boxes: &Boxes,
    ) -> Result<Self, BoundsError> {
        let family = task.family();
        let mut pairs: Vec<[f64; 2]> = match formulation {
            Formulation::Raw => {
                boxes.alpha.iter().flat_map(|&a| vec![[-a, a]; family.leading().len()]).collect()
            }
            Formulation::Scaled | Formulation::TimeFree => {
                let joint: Vec<_> = boxes.coefficient.iter().map(|&c| [-c, c]).collect();
                joint.repeat(family.leading().len())
            }
        };
        if formulation != Formulation::TimeFree {
            pairs.push(boxes.duration.map(|end| end.max(task.task().least_duration)));
        }
        let powers = (formulation == Formulation::Raw).then(|| family.clone());
        Ok(Self {
            formulation,
            task,
            bounds: Bounds::new(pairs)?,
            powers,
            make_coarser: Self::with_fewer_terms,
            coarser: OnceLock::new(),
            relaxed: OnceLock::new(),
        })
    }

    fn with_fewer_terms(&self) -> Option<Self> {
        let task = Arc::new(self.task.coarser()?);
        let all: Vec<[f64; 2]> = self.bounds.iter().collect();
        let joints = all.chunks_exact(self.task.family().terms());
        let pairs = joints.flat_map(|own| &own[..task.family().terms()]).copied().collect();
        let bounds = Bounds::new(pairs).ok()?;
        let (coarser, relaxed) = (OnceLock::new(), OnceLock::new());
        Some(Self { task, bounds, coarser, relaxed, ..self.clone() })
    }
}

impl Formulated<Spline> {
    /// The task without a duration over splines, which may leave the joints' ranges with every control point by a tenth of
    /// the range's width: a path that touches the end of a range has some beyond it.
    pub fn free_form(task: Arc<Reorientation<Spline>>) -> Result<Self, BoundsError> {
        let (family, mut pairs) = (task.family(), Vec::new());
        let mut straight = vec![0.0; family.knots().points()];
        let ranges: Vec<[f64; 2]> = task.task().robot.joints().map(|joint| joint.range).collect();
        for &joint in family.leading() {
            let [lower, upper] = ranges[joint];
            family.write_points(joint, &[], &mut straight);
            let more = (upper - lower) / 10.0;
            let own = &straight[family.fixed()..straight.len() - family.fixed()];
            pairs.extend(own.iter().map(|point| [lower - more - point, upper + more - point]));
        }
        Ok(Self {
            formulation: Formulation::TimeFree,
            task,
            bounds: Bounds::new(pairs)?,
            powers: None,
            make_coarser: |own| Self::free_form(Arc::new(own.task.coarser()?)).ok(),
            coarser: OnceLock::new(),
            relaxed: OnceLock::new(),
        })
    }

    /// The same with the duration as the last variable, in its box.
    pub fn free_form_scaled(
        task: Arc<Reorientation<Spline>>,
        boxes: &SplineBox,
    ) -> Result<Self, BoundsError> {
        let duration = boxes.duration.map(|end| end.max(task.task().least_duration));
        let free = Self::free_form(task)?;
        let bounds = Bounds::new(free.bounds.iter().chain([duration]).collect())?;
        Ok(Self { formulation: Formulation::Scaled, bounds, ..free })
    }
}

impl<F: Family> Formulated<F> {
    /// The task behind the formulation.
    pub fn task(&self) -> &Reorientation<F> {
        &self.task
    }

    /// What stands in an optimiser's variables.
    pub fn formulation(&self) -> Formulation {
        self.formulation
    }

    /// Coefficients and, where it is a variable, duration \[s\] of a point.
    pub fn decode(&self, x: &[f64]) -> (Vec<f64>, Option<f64>) {
        let mut coefficients = vec![0.0; self.task.family().dimension()];
        let duration = self.write_decoded(x, &mut coefficients);
        (coefficients, duration)
    }

    fn write_decoded(&self, x: &[f64], coefficients: &mut [f64]) -> Option<f64> {
        let (shape, duration) = x.split_at(coefficients.len());
        let duration = duration.first().copied();
        match (&self.powers, duration) {
            (Some(family), Some(t)) => family.write_from_alpha(shape, t, coefficients),
            _ => coefficients.copy_from_slice(shape),
        }
        duration
    }

    fn evaluate_in(
        &self,
        workspace: &mut Workspace<F>,
        coefficients: &mut [f64],
        x: &[f64],
    ) -> Evaluation {
        let duration = self.write_decoded(x, coefficients);
        self.task.evaluate(coefficients, duration, workspace)
    }

    /// The motion of a point, evaluated finely: its coefficients and what is known of it.
    pub fn certify(&self, x: &[f64]) -> (Vec<f64>, Assessment) {
        let (coefficients, duration) = self.decode(x);
        let assessment = self.task.certify(&coefficients, duration);
        (coefficients, assessment)
    }

    /// The point that stands for a motion; its duration is left out where it is no variable.
    pub fn encode(&self, coefficients: &[f64], duration: f64) -> Vec<f64> {
        let mut x = match &self.powers {
            Some(family) => family.to_alpha(coefficients, duration),
            None => coefficients.to_vec(),
        };
        if self.formulation != Formulation::TimeFree {
            x.push(duration);
        }
        x
    }
}

impl<F: Family> Problem for Formulated<F> {
    fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    fn evaluate(&self, x: &[f64]) -> Result<Evaluation, Failure> {
        let mut coefficients = vec![0.0; self.task.family().dimension()];
        Ok(self.evaluate_in(&mut self.task.workspace(), &mut coefficients, x))
    }

    fn evaluate_batch(
        &self,
        points: &Points,
        each: &mut dyn FnMut(Evaluation),
    ) -> Result<(), Failure> {
        let mut workspace = self.task.workspace();
        let mut coefficients = vec![0.0; self.task.family().dimension()];
        for x in points {
            each(self.evaluate_in(&mut workspace, &mut coefficients, x));
        }
        Ok(())
    }

    fn composite(&self) -> Option<&dyn Composite> {
        let is_composite =
            self.formulation == Formulation::TimeFree && !self.task.family().is_linear();
        is_composite.then_some(self)
    }

    fn timed(&self) -> Option<&dyn Timed> {
        let is_timed = self.formulation == Formulation::TimeFree && self.task.family().is_linear();
        is_timed.then_some(self)
    }

    fn coarser(&self) -> Option<&dyn Coarse> {
        if self.formulation != Formulation::TimeFree {
            return None;
        }
        let coarser = self.coarser.get_or_init(|| (self.make_coarser)(self).map(Box::new));
        coarser.as_deref().map(|coarser| coarser as &dyn Coarse)
    }

    fn relaxed(&self) -> Option<&dyn Problem> {
        let task = self.task.task();
        if (task.path.is_empty() && task.robust.is_none()) || self.timed().is_none() {
            return None;
        }
        let relax = || {
            let task = Arc::new(self.task.relaxed());
            let (coarser, relaxed) = (OnceLock::new(), OnceLock::new());
            Box::new(Self { task, coarser, relaxed, ..self.clone() })
        };
        Some(&**self.relaxed.get_or_init(relax))
    }

    fn slopes(&self) -> Option<Slopes<'_>> {
        Some(Slopes::Own(self))
    }
}

impl<F: Family> Coarse for Formulated<F> {
    fn prolong(&self, x: &[f64]) -> Vec<f64> {
        self.task.family().prolong(x)
    }
}

impl<F: Family> Differentiable for Formulated<F> {
    fn subgradient(&self, x: &[f64]) -> Result<Subgradient, Failure> {
        let (coefficients, duration) = self.decode(x);
        let Some(duration) = duration else {
            let is_linear = self.task().family().is_linear();
            return if is_linear { Slopes::Timed(self) } else { Slopes::Composite(self) }.at(x);
        };
        let (slopes, by_duration) = self.task().slopes_over(&coefficients, duration);
        let (slopes, by_duration) = match &self.powers {
            Some(family) => {
                let (slopes, through) = family.slopes_by_alpha(x, duration, slopes.as_slice());
                (slopes, by_duration + through)
            }
            None => (slopes.data.into(), by_duration),
        };
        let slopes = slopes.into_iter().chain([by_duration]);
        let slopes = DVector::from_iterator(x.len(), slopes);
        Ok(Subgradient { evaluation: self.evaluate(x)?, slopes })
    }
}

impl<F: Family> Composite for Formulated<F> {
    fn linearise(&self, x: &[f64]) -> Result<Linearisation, Failure> {
        Ok(self.task().linearise(x))
    }

    fn curvature(&self, x: &[f64], multipliers: &Multipliers) -> Result<DMatrix<f64>, Failure> {
        self.task().curvature(x, multipliers)
    }
}
