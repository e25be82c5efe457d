//! What the runs of an experiment minimise, whoever made it: subjects, and the instances that they are.

use std::any::Any;
use std::fmt;
use std::num::NonZeroU64;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::caught::caught;
use super::identity::Identity;
use super::run::{Run, best_run};
use super::schema::runs;
use super::value::{Judgement, Quantity, Value};
use crate::exhibit::Exhibits;
use crate::search::{Failure, Problem};

/// Where searches end, as a share of how far they come down.
const PRECISION: f64 = 1e-8;

/// What the runs of an instance minimise: a problem with all that the harness has to know of it.
///
/// Only [`kind`](Self::kind), [`name`](Self::name), [`identity`](Self::identity) and
/// [`problem`](Self::problem) have to be written; the rest has defaults.
pub trait Subject: Send + Sync {
    /// Who made it: the name of a kind of subjects, such as `reorientation`.
    fn kind(&self) -> &str;

    /// What it is called in tables, such as `sphere`.
    fn name(&self) -> &str;

    /// Everything that determines its costs. Runs whose identities differ have different keys; a stored
    /// run with the same identity is not done again. So put a version in it, and raise that when
    /// the code changes what a cost is.
    fn identity(&self) -> Identity;

    /// The formulations in which it can be searched, the preferred one first; empty where there is but one
    /// and it needs no name.
    fn spaces(&self) -> Vec<String> {
        Vec::new()
    }

    /// The problem in one of its formulations; `space` is empty where they need no name.
    fn problem(&self, space: &str) -> Result<Arc<dyn Problem>, Failure>;

    /// The number of variables, whatever the formulation, so that formulations of one subject compare.
    fn dimension(&self) -> usize {
        self.start_problem().map_or(1, |problem| problem.bounds().len())
    }

    /// The least cost that there is, where that is known.
    fn least_cost(&self) -> Option<f64> {
        self.start_problem().ok().and_then(|problem| problem.least_cost())
    }

    /// The least cost that anybody has found.
    fn known_cost(&self) -> Option<f64> {
        self.least_cost()
    }

    /// The cost in the middle of the box of the preferred formulation, from which Moré and Wild's targets start;
    /// NaN where it is not known.
    fn start_cost(&self) -> f64 {
        let cost = |problem: Arc<dyn Problem>| {
            let centre =
                problem.bounds().iter().map(|[a, b]| a + 0.5 * (b - a)).collect::<Vec<_>>();
            problem.evaluate(&centre).map_or(f64::NAN, |found| found.cost)
        };
        self.start_problem().map_or(f64::NAN, cost)
    }

    /// The problem in its preferred formulation.
    fn start_problem(&self) -> Result<Arc<dyn Problem>, Failure> {
        self.problem(self.spaces().first().map_or("", String::as_str))
    }

    /// What there is to know of it beside its name, stored with every run.
    fn facts(&self) -> Vec<(Quantity, Value)> {
        Vec::new()
    }

    /// What [`judge`](Self::judge) finds of a point beside its cost.
    fn measures(&self) -> Vec<Quantity> {
        Vec::new()
    }

    /// A run's best point, evaluated as finely as can be: its cost and one value for each of
    /// [`measures`](Self::measures). None where the search's own cost is all there is to know.
    fn judge(&self, space: &str, x: &[f64]) -> Result<Option<Judgement>, Failure> {
        let _ = (space, x);
        Ok(None)
    }

    /// The letter for its cost.
    #[expect(clippy::unnecessary_literal_bound, reason = "others own their letter")]
    fn cost_symbol(&self) -> &str {
        "f"
    }

    /// A cost as a line for a terminal has it.
    fn cost_text(&self, cost: f64) -> String {
        format!("{cost:.3e}")
    }

    /// By how much a final cost may exceed a lower one and still be taken for the same: where searches end. `descent` is how
    /// far searches come down to it, from the cost that they typically begin with; infinite where that is not known.
    ///
    /// By default 10⁻⁸ of the descent, since where a search ends follows from how costs vary, not from their level; but of no
    /// descent larger than one and than the cost itself, as the first costs may be penalties. With costs of order one
    /// that is COCO's final precision, doi 10.1080/10556788.2020.1808977. And never less than the rounding of the cost.
    fn resolution(&self, lowest: f64, descent: f64) -> f64 {
        let rounding = 4.0 * f64::EPSILON * lowest.abs();
        (PRECISION * descent.min(lowest.abs().max(1.0))).max(rounding)
    }

    /// How many numbers the lists have that are stored of a run, by their columns: the best point `x`, and what
    /// measures are lists of one length. A stored run with another number is taken for damaged.
    fn lengths(&self, space: &str) -> Vec<(String, usize)> {
        let variables = self.problem(space).ok().map(|problem| problem.bounds().len());
        variables.map(|count| (runs::POINT.to_owned(), count)).into_iter().collect()
    }

    /// Why results on these instances of this kind are not independent of each other, if they are not.
    fn dependence(&self, instances: &[&Instance]) -> Option<&'static str> {
        let _ = instances;
        None
    }

    /// What is doubtful about its data but can be computed with.
    fn warning(&self) -> Option<String> {
        None
    }

    /// What is shown of it and of all other instances of its kind beside what every experiment shows. The results are
    /// those of the whole experiment, on whatever subjects.
    fn exhibits(&self, results: &Results<'_>) -> Exhibits {
        let _ = results;
        Exhibits::default()
    }

    /// How exports number it, the same in every experiment; none where its group is a function, and its identity tells
    /// instances apart.
    fn numbers(&self) -> Option<Numbers> {
        None
    }

    /// Whether only the program that made the results can search it.
    #[doc(hidden)]
    fn is_foreign(&self) -> bool {
        false
    }

    /// The subject itself, for exhibits that have to know more of their instances than this trait tells.
    fn as_any(&self) -> Option<&dyn Any> {
        None
    }
}

/// How exports number a subject.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Numbers {
    /// Of the function that it is an instance of, whatever its number of variables.
    pub function: Number,
    /// Of the instance.
    pub instance: Number,
}

/// How exports number a function, or an instance of one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Number {
    /// With the number that it is known by, from 1 to 10,000; a larger one is replaced by one that follows from it.
    Known(u32),
    /// With one that follows from what determines it.
    Of(Identity),
    /// With the one that an export of this program gave it; the identity tells it from others with this number.
    Exported(u32, Identity),
}

/// One problem of an experiment.
#[derive(Clone)]
#[non_exhaustive]
pub struct Instance {
    /// What tells it from the others, such as `weight_base=0.5 terms=4`; empty where there is but one.
    pub label: String,
    /// What it shares with those it is summarised and drawn with; the label where there are none.
    pub group: String,
    /// The group as charts write it.
    pub title: String,
    /// What it shares with groups that differ from its own in the number of variables alone, as charts write it.
    pub series: String,
    /// The settings that a sweep has given it.
    pub coordinates: Vec<Coordinate>,
    /// What is minimised.
    pub subject: Arc<dyn Subject>,
    /// Evaluations that each run may spend, instead of the experiment's budget.
    pub budget: Option<NonZeroU64>,
    /// Costs that runs are asked to reach.
    pub targets: Vec<f64>,
}

/// A setting and its value on one instance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coordinate {
    /// The setting.
    pub setting: String,
    /// Its value.
    pub value: Value,
}

impl fmt::Debug for Instance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = f.debug_struct("Instance");
        shown.field("label", &self.label).field("subject", &self.subject.name());
        shown.finish_non_exhaustive()
    }
}

impl Instance {
    /// An instance on a subject.
    pub fn new(label: impl Into<String>, subject: Arc<dyn Subject>) -> Self {
        let label = label.into();
        Self {
            group: label.clone(),
            title: label.clone(),
            series: label.clone(),
            label,
            coordinates: Vec::new(),
            subject,
            budget: None,
            targets: Vec::new(),
        }
    }

    /// With costs that runs are asked to reach.
    #[must_use]
    pub fn with_targets(self, targets: impl Into<Vec<f64>>) -> Self {
        Self { targets: targets.into(), ..self }
    }

    /// The cost in the middle of the box; NaN where the problem panics there.
    pub(crate) fn start_cost(&self) -> f64 {
        caught(|| self.subject.start_cost()).unwrap_or(f64::NAN)
    }

    /// The formulation in which an optimiser searches it that asks for one, or for none; empty where it has but one.
    pub fn space(&self, asked: Option<&str>) -> String {
        let preferred = || self.subject.spaces().into_iter().next().unwrap_or_default();
        asked.map_or_else(preferred, str::to_owned)
    }

    /// The value of a setting of the sweep.
    pub fn coordinate(&self, setting: &str) -> Option<&Value> {
        let found = self.coordinates.iter().find(|coordinate| coordinate.setting == setting);
        found.map(|coordinate| &coordinate.value)
    }
}

/// What an experiment has found so far.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Results<'a> {
    /// The instances of the plan.
    pub instances: &'a [Instance],
    /// The labels of its optimisers, and the formulations that they ask for.
    pub optimisers: Vec<(&'a str, Option<&'a str>)>,
    /// The measures of all subjects, each once.
    pub measures: &'a [Quantity],
    /// The stored runs.
    pub runs: &'a [Run],
}

impl<'a> Results<'a> {
    /// A run's instance.
    pub fn instance(&self, run: &Run) -> &'a Instance {
        &self.instances[run.instance]
    }

    /// The label of a run's optimiser.
    pub fn label(&self, run: &Run) -> &'a str {
        self.optimisers[run.optimiser].0
    }

    /// The formulation in which a run searched; empty where its subject has but one.
    pub fn space(&self, run: &Run) -> String {
        self.instance(run).space(self.optimisers[run.optimiser].1)
    }

    /// A measure of a run, by its name; NaN where there is none.
    pub fn measure(&self, run: &Run, name: &str) -> f64 {
        let place = self.measures.iter().position(|measure| measure.name == name);
        place.map_or(f64::NAN, |place| run.measure(place))
    }

    /// The best run of every instance that has one, in the order of the plan.
    pub fn best_runs(&self) -> Vec<&'a Run> {
        self.best_runs_where(|_| true)
    }

    /// The best of those runs that have a point, as imported ones do not, of every instance that has one, in the order of the
    /// plan.
    pub fn best_runs_with_points(&self) -> Vec<&'a Run> {
        self.best_runs_where(|run| !run.x.is_empty())
    }

    fn best_runs_where(&self, counts: impl Fn(&Run) -> bool) -> Vec<&'a Run> {
        let mut by_instance: Vec<Vec<&Run>> = vec![Vec::new(); self.instances.len()];
        let runs = self.runs.iter().filter(|run| counts(run));
        runs.for_each(|run| by_instance[run.instance].push(run));
        by_instance.into_iter().filter_map(|runs| best_run(runs.into_iter())).collect()
    }
}
