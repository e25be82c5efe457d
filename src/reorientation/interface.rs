//! The task as the harness sees it.

use std::any::Any;
use std::sync::Arc;

use serde_json::json;

use super::best_known::BestKnown;
use super::exhibits;
use super::fitness::Assessment;
use super::subject::{DURATION, KIND, RESIDUAL, SAME_MOTION, TaskSubject};
use crate::exhibit::Exhibits;
use crate::experiment::schema::runs;
use crate::experiment::{
    Identity, Instance, Judgement, Number, Numbers, Quantity, Results, Subject, Value, ValueKind,
};
use crate::search::{Failure, Problem};
use crate::task::Task;

/// By how much a residual that is stored may be wrong \[rad\].
const UNCERTAIN: f64 = 1e-6;
/// The name of the measure that is a list.
const COEFFICIENTS: &str = "coefficients";

impl Subject for TaskSubject {
    fn kind(&self) -> &'static str {
        KIND
    }

    fn name(&self) -> &'static str {
        KIND
    }

    fn identity(&self) -> Identity {
        let problem = self.reorientation();
        let accuracy = problem.accuracy();
        Identity::of(json!({
            "task": problem.task().identity(),
            "family": problem.spec().identity(),
            "accuracy": {
                "attitude_steps": accuracy.attitude_steps,
                "peak_intervals": accuracy.peak_intervals,
            },
            "box": self.box_identity(),
        }))
    }

    /// A robot under its limits is a function, a pair of start and goal an instance.
    fn numbers(&self) -> Option<Numbers> {
        let (mut function, mut instance) = (self.reorientation().task().identity(), json!({}));
        for key in ["start", "goal"] {
            instance[key] = function[key].take();
        }
        function["family"] = self.reorientation().spec().identity();
        let [function, instance] = [function, instance].map(|one| Number::Of(Identity::of(one)));
        Some(Numbers { function, instance })
    }

    fn spaces(&self) -> Vec<String> {
        self.formulations().iter().map(|formulation| formulation.name().to_owned()).collect()
    }

    fn problem(&self, space: &str) -> Result<Arc<dyn Problem>, Failure> {
        Ok(self.formulated(space)?)
    }

    /// Free coefficients and duration, the paper's variables.
    fn dimension(&self) -> usize {
        self.reorientation().dimension() + 1
    }

    fn known_cost(&self) -> Option<f64> {
        BestKnown::of(self.reorientation()).map(|known| known.j)
    }

    fn facts(&self) -> Vec<(Quantity, Value)> {
        let problem = self.reorientation();
        let (task, family) = (problem.task(), problem.spec());
        let limit = |order: usize| Value::from(task.uniform_limit_deg(order));
        let count = |value: Option<usize>| value.map_or(Value::None, Value::from);
        let shown = |name: &str, kind, meaning| Quantity::new(name, kind, meaning).shown(name);
        let lanes = "how many places of a path the processor evaluated at once; 4 and 8 give the same bits, 1 may give \
            others in the last digits";
        vec![
            (
                Quantity::new("robot", ValueKind::Text, "name of the robot"),
                task.robot.name().into(),
            ),
            (shown("weight_base", ValueKind::Real, "`K_b`"), task.base_weight.into()),
            (
                shown(
                    "rate_limit_deg_s",
                    ValueKind::Real,
                    "limit of all joints [°/s]; null where joints differ",
                ),
                limit(0),
            ),
            (shown("acceleration_limit_deg_s2", ValueKind::Real, "the same [°/s²]"), limit(1)),
            (shown("jerk_limit_deg_s3", ValueKind::Real, "the same [°/s³]"), limit(2)),
            (
                shown(
                    "family",
                    ValueKind::Text,
                    "the family of motions, `sine-polynomial` or `spline`",
                ),
                family.name().name().into(),
            ),
            (
                shown(
                    "terms",
                    ValueKind::Count,
                    "free coefficients per joint of a sine polynomial",
                ),
                count(family.terms()),
            ),
            (shown("pieces", ValueKind::Count, "pieces of a spline"), count(family.pieces())),
            (shown("degree", ValueKind::Count, "degree of a spline"), count(family.degree())),
            (
                Quantity::new("lanes", ValueKind::Count, lanes)
                    .telling_provenance("Places of a path evaluated at once"),
                problem.width().lanes().into(),
            ),
        ]
    }

    fn measures(&self) -> Vec<Quantity> {
        vec![
            Quantity::new(RESIDUAL, ValueKind::Real, "the base's error [°]").shown("residual [°]"),
            Quantity::new(DURATION, ValueKind::Real, "duration [s]").shown("t_f [s]"),
            Quantity::new("penalty", ValueKind::Real, "penalty in `certified_j`"),
            Quantity::new(
                COEFFICIENTS,
                ValueKind::Reals,
                "the motion's free coefficients, joint by joint: of bumps, or what control points add to the straight path",
            ),
        ]
    }

    fn lengths(&self, space: &str) -> Vec<(String, usize)> {
        let variables = self.formulated(space).ok().map(|problem| problem.bounds().len());
        let coefficients = (COEFFICIENTS.to_owned(), self.reorientation().dimension());
        let point = variables.map(|count| (runs::POINT.to_owned(), count));
        point.into_iter().chain([coefficients]).collect()
    }

    fn judge(&self, space: &str, x: &[f64]) -> Result<Option<Judgement>, Failure> {
        let (coefficients, motion) = self.formulated(space)?.certify(x);
        if !motion.residual_error.is_some_and(|error| error <= UNCERTAIN) {
            return Err(Failure::new(
                "the best motion swings too often for the base's end to be evaluated: its box is too wide",
            ));
        }
        Ok(Some(Judgement { cost: motion.cost, measures: measured(&motion, coefficients) }))
    }

    fn cost_symbol(&self) -> &'static str {
        "J"
    }

    fn cost_text(&self, cost: f64) -> String {
        format!("{cost:.6}")
    }

    fn resolution(&self, lowest: f64, _: f64) -> f64 {
        SAME_MOTION * lowest.abs()
    }

    fn dependence(&self, instances: &[&Instance]) -> Option<&'static str> {
        let tasks: Vec<&Task> = instances
            .iter()
            .filter_map(|instance| Some(&**Self::of(instance)?.reorientation().task()))
            .collect();
        let is_same =
            |a: &Task, b: &Task| (&a.start, &a.goal) == (&b.start, &b.goal) && a.robot == b.robot;
        let mut pairs = tasks.iter().enumerate();
        pairs.any(|(i, a)| tasks[..i].iter().any(|b| is_same(a, b))).then_some(
            "Settings of one task are not independent tasks, so p-values are smaller than they should be.",
        )
    }

    fn warning(&self) -> Option<String> {
        self.reorientation().task().robot.warning()
    }

    fn exhibits(&self, results: &Results<'_>) -> Exhibits {
        exhibits::exhibits(results)
    }

    fn as_any(&self) -> Option<&dyn Any> {
        Some(self)
    }
}

/// The values of the measures.
fn measured(motion: &Assessment, coefficients: Vec<f64>) -> Vec<Value> {
    vec![
        motion.residual().to_degrees().into(),
        motion.duration.into(),
        motion.penalty().into(),
        coefficients.into(),
    ]
}
