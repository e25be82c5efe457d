//! Motions of a task.

use std::path::Path;
use std::sync::Arc;

use driftless::reorientation::{
    AnyReorientation, Assessment, AssessmentJson, Excursions, ExcursionsJson, FoundBy,
    MOST_SAMPLES, MotionFormat, Planned, Reach, Record, Remark, Sampling, ShapeJson, intervals,
    motion_scene, write_motion,
};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;
use serde_json::{Value, json};

use crate::errors::{self, OrRaise as _};
use crate::{arrays, json};

/// A motion of a task, and what is known of it.
#[pyclass(module = "driftless._driftless", frozen)]
pub(crate) struct Motion {
    problem: Arc<dyn AnyReorientation>,
    coefficients: Vec<f64>,
    /// Where the duration is not the shortest within the limits.
    duration: Option<f64>,
    assessment: Assessment,
    /// What `plan --json` prints.
    json: Value,
    remark: Option<Remark>,
    interrupted: bool,
    /// Path and text of the task, where they are known.
    source: Option<(String, String)>,
}

impl Motion {
    pub(crate) fn planned(
        planned: Planned,
        json: Value,
        remark: Option<Remark>,
        source: (String, String),
    ) -> Self {
        let fixed = planned.problem.certify(&planned.coefficients, None);
        let is_shortest = fixed.duration.to_bits() == planned.assessment.duration.to_bits();
        Self {
            duration: (!is_shortest).then_some(planned.assessment.duration),
            problem: planned.problem,
            coefficients: planned.coefficients,
            assessment: planned.assessment,
            interrupted: planned.interrupted,
            json,
            remark,
            source: Some(source),
        }
    }

    /// The motion with these coefficients, in `duration` seconds or the shortest time within the limits.
    pub(crate) fn assessed(
        problem: Arc<dyn AnyReorientation>,
        coefficients: Vec<f64>,
        duration: Option<f64>,
        source: Option<(String, String)>,
    ) -> Self {
        let assessment = problem.certify(&coefficients, duration);
        let task = problem.task();
        let reach = Reach::of(task, &assessment, f64::INFINITY);
        let excursions = Excursions::on_the_way(&*problem, &coefficients, assessment.duration);
        let mut all = serde_json::Map::new();
        for part in [
            json!(problem.spec()),
            json!({
                "status": reach,
                "reached": reach == Reach::Reached,
                "tolerance_deg": task.goal_tolerance_deg(),
                "within_limits": Reach::keeps_limits(&assessment),
            }),
            json!(AssessmentJson::new(&assessment, &task.robot)),
            json!(ExcursionsJson::new(&excursions, task, &assessment.peaks)),
            json!(ShapeJson::new(&*problem, &coefficients, assessment.duration)),
        ] {
            if let Value::Object(part) = part {
                all.extend(part);
            }
        }
        let json = Value::Object(all);
        let (remark, interrupted) = (None, false);
        Self { problem, coefficients, duration, assessment, json, remark, interrupted, source }
    }

    /// As users see it: an object of the class `driftless.Motion`.
    pub(crate) fn shown(self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
        let class = CLASS.import(py, "driftless._motion", "Motion")?;
        Ok(class.call1((Py::new(py, self)?,))?.unbind())
    }

    fn json_number(&self, key: &str) -> Option<u64> {
        self.json.get(key).and_then(Value::as_u64)
    }

    fn sampling(&self, dt: Option<f64>) -> PyResult<Sampling> {
        let Some(dt) = dt else { return Ok(intervals(self.problem.spec()).into()) };
        let duration = self.assessment.duration;
        let sampling = Sampling::of_step(dt).filter(|sampling| sampling.check(duration).is_ok());
        sampling.ok_or_else(|| {
            PyValueError::new_err(format!(
                "found dt = {dt} s, expected a time above zero that gives at most {MOST_SAMPLES} samples of {duration:.3} s"
            ))
        })
    }

    /// The motion at these times, and what follows from it.
    fn record(&self, sampling: Sampling) -> Record<'_> {
        let motion = self.problem.sample_at(&self.coefficients, self.assessment.duration, sampling);
        Record::new(&self.problem.task().robot, motion)
    }
}

/// Time; joints' derivatives of orders 0 to 3 and their torques; the base's attitude as quaternions and as Euler angles, its
/// position and its rate.
type Samples<'py> =
    (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray3<f64>>, [Bound<'py, PyArray2<f64>>; 4]);

#[pymethods]
impl Motion {
    #[getter]
    fn cost(&self) -> f64 {
        self.assessment.cost
    }

    #[getter]
    fn duration(&self) -> f64 {
        self.assessment.duration
    }

    #[getter]
    fn residual_deg(&self) -> f64 {
        self.assessment.residual().to_degrees()
    }

    #[getter]
    fn reached(&self) -> bool {
        self.json.get("reached").and_then(Value::as_bool).unwrap_or_default()
    }

    #[getter]
    fn interrupted(&self) -> bool {
        self.interrupted
    }

    #[getter]
    fn remark(&self) -> Option<&str> {
        self.remark.as_ref().map(|remark| match remark {
            Remark::Warning(text) | Remark::Note(text) => &**text,
        })
    }

    /// Whether the remark is a warning.
    #[getter]
    fn is_warned_of(&self) -> bool {
        matches!(self.remark, Some(Remark::Warning(_)))
    }

    #[getter]
    fn joints(&self) -> Vec<String> {
        self.problem.task().robot.joints().map(|joint| joint.name.to_owned()).collect()
    }

    /// `rad` or `m`, joint by joint.
    #[getter]
    fn units(&self) -> Vec<&'static str> {
        self.problem.task().robot.joints().map(|joint| joint.kind.si_unit()).collect()
    }

    #[getter]
    fn limits(&self) -> Vec<[f64; 3]> {
        self.problem.task().limits.0.clone()
    }

    /// ZYX Euler angles of the goal nearest to those at the end of the motion \[rad\].
    #[getter]
    fn goal_zyx(&self) -> [f64; 3] {
        let (roll, pitch, yaw) = self.problem.task().goal.base.euler_angles();
        [yaw, pitch, roll]
    }

    #[getter]
    fn coefficients<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = self.problem.task().robot.leading_count();
        let columns = self.coefficients.len() / rows;
        arrays::matrix(py, rows, columns, self.coefficients.clone())
    }

    #[getter]
    fn json<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.json)
    }

    /// Path and text of the task, coefficients and, where it is not the shortest, duration.
    #[getter]
    fn state(&self) -> Option<(String, String, Vec<f64>, Option<f64>)> {
        let (path, text) = self.source.clone()?;
        Some((path, text, self.coefficients.clone(), self.duration))
    }

    fn sample<'py>(&self, py: Python<'py>, dt: Option<f64>) -> PyResult<Samples<'py>> {
        let sampling = self.sampling(dt)?;
        let (record, joints) = py.detach(|| {
            let record = self.record(sampling);
            let joints = record.by_quantity().collect();
            (record, joints)
        });
        let (count, shape) = (record.time().len(), [5, record.time().len(), record.joint_count()]);
        let base = |from: usize, to: usize| {
            let numbers = record.base().iter().flat_map(|base| base[from..to].to_vec());
            arrays::matrix(py, count, to - from, numbers.collect())
        };
        Ok((
            arrays::vector(py, record.time().to_vec()),
            arrays::vector(py, joints).reshape(shape)?,
            [base(0, 4)?, base(4, 7)?, base(7, 10)?, base(10, 13)?],
        ))
    }

    fn save(&self, py: Python<'_>, path: &str, dt: Option<f64>) -> PyResult<()> {
        let format = MotionFormat::of(Path::new(path)).ok_or_else(|| {
            let expected = format!("expected a name in {}", MotionFormat::endings());
            PyValueError::new_err(format!("cannot tell the format of {path}, {expected}"))
        })?;
        let sampling = self.sampling(dt)?;
        py.detach(|| write_motion(Path::new(path), format, &self.record(sampling))).or_raise()
    }

    /// The page that shows the motion in three dimensions.
    fn page(&self, py: Python<'_>) -> PyResult<String> {
        let name = format!("Motion of {}", self.problem.task().robot.name());
        let optimiser = self.json.get("optimiser").and_then(Value::as_str).unwrap_or_default();
        let found = FoundBy {
            label: "",
            optimiser,
            seed: self.json_number("seed").unwrap_or_default(),
            cost: self.assessment.cost,
        };
        let duration = self.assessment.duration;
        let page = py.detach(|| {
            let scene = motion_scene(&*self.problem, &self.coefficients, duration, found)?;
            Some(driftless::report::motion_page(&name, scene))
        });
        let none = || errors::search("the motion cannot be shown");
        page.ok_or_else(none)?.or_raise()
    }
}
