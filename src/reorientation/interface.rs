//! The task as the harness sees it.

use std::any::Any;
use std::sync::Arc;

use serde_json::json;

use super::best_known::BestKnown;
use super::excursions::Excursions;
use super::exhibits;
use super::fitness::Assessment;
use super::subject::{DURATION, KIND, LARGEST_TURN, RESIDUAL, SAME_MOTION, TaskSubject};
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
        let mut facts = vec![
            (
                Quantity::new("robot", ValueKind::Text, "name of the robot"),
                task.robot.name().into(),
            ),
            (shown("weight_base", ValueKind::Real, "`K_b`"), task.base_weight.into()),
            (
                shown(
                    "rate_limit_deg_s",
                    ValueKind::Real,
                    "limit of all joints [°/s]; null where joints differ or one slides",
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
        ];
        facts.extend(facts_of_the_way(task));
        facts
    }

    fn measures(&self) -> Vec<Quantity> {
        vec![
            Quantity::new(RESIDUAL, ValueKind::Real, "the base's error [°]").shown("residual [°]"),
            Quantity::new(DURATION, ValueKind::Real, "duration [s]").shown("t_f [s]"),
            Quantity::new("penalty", ValueKind::Real, "penalty in `certified_j`"),
            Quantity::new(
                COEFFICIENTS,
                ValueKind::Reals,
                "the motion's free coefficients, joint by joint but for those that follow others: of bumps, or what control points add to the straight path",
            ),
            on_the_way(LARGEST_TURN, "largest turn of the base from its attitude at the start [°]"),
            on_the_way(
                "clearance_m",
                "least distance between bodies [m]; negative where they overlap",
            ),
            on_the_way("path_excess", "the sum of the relative excesses over path limits"),
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
        Ok(Some(Judgement { cost: motion.cost, measures: self.measured(&motion, coefficients) }))
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
        self.reorientation().task().robot.unexpected_warning()
    }

    fn exhibits(&self, results: &Results<'_>) -> Exhibits {
        exhibits::exhibits(results)
    }

    fn as_any(&self) -> Option<&dyn Any> {
        Some(self)
    }
}

impl TaskSubject {
    /// The values of the measures. How far a motion goes on the way takes longer to tell than many a cost, so it is told only
    /// where the task asks for something there.
    fn measured(&self, motion: &Assessment, coefficients: Vec<f64>) -> Vec<Value> {
        let problem = self.reorientation();
        let excursions = (!problem.task().path.is_empty())
            .then(|| Excursions::on_the_way(problem, &coefficients, motion.duration));
        let excursions = excursions.as_ref();
        let closest = excursions.and_then(|found| found.closest.as_ref());
        vec![
            motion.residual().to_degrees().into(),
            motion.duration.into(),
            motion.penalty().into(),
            coefficients.into(),
            excursions.map(|found| found.base_turn.to_degrees()).into(),
            closest.map(|closest| closest.distance).into(),
            excursions.map(|_| motion.path_excess).into(),
        ]
    }
}

/// A measure of what is on the way.
fn on_the_way(name: &str, meaning: &str) -> Quantity {
    let meaning = format!("{meaning}; null where the task has no path limits");
    Quantity::new(name, ValueKind::Real, &meaning)
}

/// What a task asks for on the way. Tables show what it asks for.
fn facts_of_the_way(task: &Task) -> Vec<(Quantity, Value)> {
    let path = &task.path;
    let fact = |name: &str, kind, meaning: &str, value: Value| {
        let meaning = format!("{meaning}; null without");
        let quantity = Quantity::new(name, kind, &meaning);
        let is_asked = value != Value::None;
        (if is_asked { quantity.shown(name) } else { quantity }, value)
    };
    let real = |name: &str, meaning: &str, value: Option<f64>| {
        fact(name, ValueKind::Real, meaning, value.into())
    };
    let [largest, mean] = path.turn_weights.map(|weight| (weight > 0.0).then_some(weight));
    let turn = path.base_turn.or(largest).or(mean).map(|_| path.turn_from.name());
    let cone = match &path.base_cones[..] {
        [cone] => Some(cone.angle),
        _ => None,
    };
    let torque = path.torque.as_ref().and_then(|torque| {
        let first = torque.first().copied()?;
        torque.iter().all(|limit| *limit == first).then_some(first)
    });
    let clearance = path.clearance.as_ref().map(|clearance| clearance.least);
    vec![
        real("base_turn_limit_deg", "limit on the base's turn [°]", path.base_turn.map(in_degrees)),
        fact(
            "base_turn_from",
            ValueKind::Text,
            "what its turn is measured from where it has a limit or a weight, `start`, `goal` or `nearer` of the two",
            turn.map_or(Value::None, Value::from),
        ),
        real(
            "base_cone_deg",
            "angle of the one cone for an axis of the base [°]",
            cone.map(in_degrees),
        ),
        real(
            "base_rate_limit_deg_s",
            "limit on the base's rate [°/s]",
            path.base_rate.map(in_degrees),
        ),
        real("tool_speed_limit_m_s", "limit on the tool's speed [m/s]", path.tool_speed),
        real(
            "torque_limit_n_m",
            "limit of all joints on torques [N·m]; null where joints differ",
            torque,
        ),
        real("clearance_limit_m", "least distance between bodies that is asked for [m]", clearance),
        real("weight_largest_turn", "what a degree of the largest turn adds to the cost", largest),
        real("weight_mean_turn", "what a degree of the mean turn adds to the cost", mean),
    ]
}

/// As written, without the rounding of its way through radians.
fn in_degrees(radians: f64) -> f64 {
    (radians.to_degrees() * 1e9).round() / 1e9
}
