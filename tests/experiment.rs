//! Experiments survive problems that do not behave: what fails is recorded, and the rest goes on.
#![cfg(feature = "harness")]

use std::num::NonZeroU64;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use driftless::analysis;
use driftless::experiment::{
    self, Experiment, Identity, Instance, Plan, Progress, Record, RunSpec, Store,
};
use driftless::functions::{Analytic, TestFunction};
use driftless::input::Document;
use driftless::optimiser::Settings;
use driftless::registry;
use driftless::search::{Bounds, Evaluation, Failure, Points, Problem};
use driftless::search::{Oracle, Watch};
use polars::prelude::*;

/// What a problem does at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Mood {
    Sound,
    Panics,
    Fails,
    NotANumber,
    Infinite,
    MinusInfinite,
}

/// The sum of squares at half of the points, chosen by a hash of the point; the mood at the others,
/// or at all of them.
struct Fickle {
    mood: Mood,
    always: bool,
    bounds: Bounds,
    calls: AtomicU64,
}

impl Fickle {
    fn new(mood: Mood, always: bool) -> Self {
        let bounds = Bounds::cube(3, [-5.0, 5.0]);
        Self { mood, always, bounds, calls: AtomicU64::new(0) }
    }

    /// The sixth bit of an FNV-1a hash.
    fn is_moody(&self, x: &[f64]) -> bool {
        let bytes = x.iter().flat_map(|x| x.to_bits().to_le_bytes());
        let hash = bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        self.always || hash & 0x20 != 0
    }
}

impl Problem for Fickle {
    fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    fn evaluate(&self, x: &[f64]) -> Result<Evaluation, Failure> {
        self.calls.fetch_add(1, Ordering::Relaxed);
        let mood = if self.is_moody(x) { self.mood } else { Mood::Sound };
        let cost = match mood {
            Mood::Sound => x.iter().map(|x| x * x).sum(),
            Mood::Panics => panic!("out of sorts\nat {x:?}"),
            Mood::Fails => return Err(format!("no licence at {x:?}").into()),
            Mood::NotANumber => f64::NAN,
            Mood::Infinite => f64::INFINITY,
            Mood::MinusInfinite => f64::NEG_INFINITY,
        };
        Ok(cost.into())
    }
}

/// A problem that the test looks at, too.
struct Shared(Arc<Fickle>);

impl Problem for Shared {
    fn bounds(&self) -> &Bounds {
        self.0.bounds()
    }

    fn evaluate(&self, x: &[f64]) -> Result<Evaluation, Failure> {
        self.0.evaluate(x)
    }
}

struct Count(AtomicU64);

impl Progress for Count {
    fn finished(&self, _: &RunSpec, _: &Record) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }
}

/// Runs what is missing; how many runs that were.
fn run(plan: &Plan, store: &Store) -> u64 {
    let runs: Vec<&RunSpec> = plan.runs.iter().collect();
    let count = Count(AtomicU64::new(0));
    experiment::run(plan, &runs, store, 2, &Watch::default(), &count).unwrap();
    count.0.into_inner()
}

fn plan(mood: Mood, always: bool, budget: u64) -> (Plan, Arc<Fickle>) {
    let problem = Arc::new(Fickle::new(mood, always));
    let name = format!("{mood:?} {always}");
    let instance =
        Instance::of_problem(&name, Identity::new().with("version", 1), Shared(problem.clone()));
    let number = |n| NonZeroU64::new(n).unwrap();
    let plan = Plan::over("fickle", vec![instance], Settings::all(), number(1), number(budget));
    (plan, problem)
}

/// A problem without formulations, facts and measures has these alone.
const COLUMNS: [&str; 31] = [
    "format",
    "key",
    "recipe",
    "experiment",
    "problem",
    "instance",
    "group",
    "optimiser",
    "formulation",
    "settings",
    "targets",
    "seed",
    "budget",
    "j",
    "violation",
    "x",
    "certified_j",
    "evaluations",
    "first_feasible",
    "linearisations",
    "curvatures",
    "conic_solves",
    "conic_failures",
    "seconds",
    "seconds_in_problem",
    "status",
    "message",
    "version",
    "commit",
    "cpu",
    "date",
];

fn text(frame: &DataFrame, column: &str, i: usize) -> String {
    frame.column(column).unwrap().str().unwrap().get(i).unwrap().to_owned()
}

fn whole(frame: &DataFrame, column: &str, i: usize) -> u64 {
    frame.column(column).unwrap().u64().unwrap().get(i).unwrap()
}

fn real(frame: &DataFrame, column: &str, i: usize) -> Option<f64> {
    frame.column(column).unwrap().f64().unwrap().get(i)
}

/// What one row of the runs and its trace have to say, whatever went wrong.
fn check(plan: &Plan, mood: Mood, always: bool, runs: &DataFrame, traces: &DataFrame, i: usize) {
    let run = &plan.runs[i];
    let (status, message) = (text(runs, "status", i), text(runs, "message", i));
    let optimiser = text(runs, "optimiser", i);
    let context = format!("{mood:?} {always} {optimiser} {}: {status} {message}", run.budget);
    let evaluations = whole(runs, "evaluations", i);
    let entrant = &plan.optimisers[run.optimiser];
    let differentiates = entrant.needs_derivatives();
    // These have to differentiate before anything else.
    let at_once = ["scp", "l-bfgs-b", "slsqp"].contains(&entrant.kind());
    let fewest = u64::from(!at_once);
    assert!((fewest..=run.budget).contains(&evaluations), "{context}: {evaluations}");
    assert_eq!(text(runs, "key", i), run.key);
    assert!(runs.column("formulation").unwrap().get(i).unwrap().is_null(), "{context}");
    let expected: &[&str] = match mood {
        _ if at_once => &["no-derivatives"],
        Mood::Panics if always => &["panicked"],
        Mood::Panics if differentiates => &["panicked", "no-derivatives", "budget-spent"],
        Mood::Panics => &["panicked", "budget-spent", "finished"],
        Mood::Fails if always => &["failed"],
        Mood::Fails if differentiates => &["failed", "no-derivatives", "budget-spent"],
        Mood::Fails => &["failed", "budget-spent", "finished"],
        _ if differentiates => &["no-derivatives", "budget-spent"],
        _ => &["budget-spent", "finished"],
    };
    assert!(expected.contains(&status.as_str()), "{context}");
    if status == "panicked" {
        assert!(message.starts_with("out of sorts\nat [") && message.contains("experiment.rs:"));
    }
    if status == "failed" {
        assert!(message.starts_with("no licence at ["), "{context}");
    }
    let trace: Vec<(u64, f64)> = (0..traces.height())
        .filter(|&row| text(traces, "key", row) == run.key)
        .map(|row| (whole(traces, "evaluation", row), real(traces, "j", row).unwrap()))
        .collect();
    assert!(trace.is_sorted_by(|a, b| a.0 < b.0 && a.1 >= b.1), "{context}: {trace:?}");
    let best = real(runs, "j", i);
    assert_eq!(best, real(runs, "certified_j", i), "{context}");
    assert_eq!(best, trace.last().map(|row| row.1), "{context}");
    let x = runs.column("x").unwrap().list().unwrap().get_as_series(i);
    match best {
        Some(best) => {
            assert!(best.is_finite() && !always, "{context}: {best}");
            assert_eq!(trace.last().unwrap().0, evaluations, "{context}");
            let x: Vec<f64> = x.unwrap().f64().unwrap().into_no_null_iter().collect();
            assert_eq!(x.iter().map(|x| x * x).sum::<f64>(), best, "{context}");
        }
        None => assert!(x.is_none(), "{context}"),
    }
}

/// Panics of [`Fickle`] that reached the program's own panic hook, which would print them.
static HEARD: AtomicU64 = AtomicU64::new(0);

fn listen() {
    let print = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if panic.to_string().contains("out of sorts") {
            HEARD.fetch_add(1, Ordering::Relaxed);
        } else {
            print(panic);
        }
    }));
}

#[test]
fn every_run_leaves_a_record_whatever_the_problem_does() {
    listen();
    let moods = [Mood::Panics, Mood::Fails, Mood::NotANumber, Mood::Infinite, Mood::MinusInfinite];
    for (mood, always) in moods.into_iter().flat_map(|mood| [(mood, false), (mood, true)]) {
        for budget in [1, 2, 10, 64, 65, 151, 400] {
            let folder = tempfile::tempdir().unwrap();
            let store = Store::open(folder.path()).unwrap();
            let (plan, problem) = plan(mood, always, budget);
            assert_eq!(run(&plan, &store), plan.runs.len() as u64);
            let keys = || plan.runs.iter().map(|run| run.key.as_str());
            let (runs, traces) =
                (store.read("runs", keys()).unwrap(), store.read("traces", keys()).unwrap());
            assert_eq!(runs.get_column_names(), COLUMNS);
            assert_eq!(runs.height(), plan.runs.len());
            (0..runs.height()).for_each(|i| check(&plan, mood, always, &runs, &traces, i));
            let counted: u64 = (0..runs.height()).map(|i| whole(&runs, "evaluations", i)).sum();
            assert_eq!(counted, problem.calls.load(Ordering::Relaxed), "{mood:?}, {budget}");
            assert_eq!(run(&plan, &store), 0, "done again");
            let stored = experiment::load(&plan, &store).unwrap();
            let targets = analysis::targets(&plan, &stored);
            let summary = analysis::summary(&plan, &stored, &targets).unwrap();
            assert_eq!(summary.height(), plan.optimisers.len());
        }
    }
    assert_eq!(HEARD.load(Ordering::Relaxed), 0, "panics were heard");
}

/// Hundreds of runs that end at once: none begins within another, where they would use up the stack.
#[test]
fn many_short_runs_are_stored() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let problem = Analytic::new(TestFunction::Sphere, 3, 0);
    let instance = Instance::of_problem("sphere", Identity::new().with("version", 0), problem);
    let number = |n| NonZeroU64::new(n).unwrap();
    let random = [Settings::by_name("random").unwrap()];
    let plan = Plan::over("many", vec![instance], random, number(600), number(5));
    assert_eq!(run(&plan, &store), 600);
    let stored = store.keys().unwrap();
    assert!(plan.runs.iter().all(|run| stored.contains(&run.key)));
    assert!(store.batch_count().unwrap() < 10);
}

/// Costs its number of calls so far; panics at one call.
struct PanicsAt {
    call: u64,
    bounds: Bounds,
    calls: AtomicU64,
}

impl Problem for PanicsAt {
    fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    fn evaluate(&self, _: &[f64]) -> Result<Evaluation, Failure> {
        let call = self.calls.fetch_add(1, Ordering::Relaxed) + 1;
        assert!(call != self.call, "enough");
        Ok((1.0 / call as f64).into())
    }
}

/// Of a batch that panics, what returned is counted and kept, and what panicked is counted.
#[test]
fn a_panic_within_a_batch_leaves_exact_counts() {
    for call in 1..=9 {
        let bounds = Bounds::cube(1, [0.0, 1.0]);
        let problem = PanicsAt { call, bounds, calls: AtomicU64::new(0) };
        let watch = Watch::default();
        let mut oracle = Oracle::new(&problem, 8, &watch);
        let points = Points::zeros(1, 5);
        let mut out = [Evaluation::default(); 5];
        let attempt = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            while oracle.evaluate_batch(&points, &mut out).is_ok() {}
        }));
        assert_eq!(attempt.is_err(), call <= 8);
        assert_eq!(oracle.evaluations(), call.min(8));
        assert_eq!(watch.evaluations(), call.min(8));
        let returned = call.min(9) - 1;
        let best = oracle.best().map(|best| best.evaluation.cost);
        assert_eq!(best, (returned > 0).then(|| 1.0 / returned as f64));
        let trace = oracle.into_trace();
        assert_eq!(trace.last().map(|row| row.evaluation), best.map(|_| call.min(8)));
    }
}

/// Quantities that would share a column are refused before anything runs.
#[test]
fn quantities_have_columns_of_their_own() {
    let real = |name: &str| format!("{{ name = '{name}', kind = 'real' }}");
    for measures in [real("seconds"), format!("{}, {{ name = 'q', kind = 'text' }}", real("q"))] {
        let text = format!(
            "name = 'clash'\n[[problem]]\nkind = 'problem'\nname = 'p'\ndimension = 2\nstart_cost = 1.0\n\
             identity = '{{}}'\nmeasures = [{measures}]\n[[optimiser]]\nrandom = {{}}\n"
        );
        let document = Document::embedded("clash.toml", &text);
        let experiment = Experiment::read(&document, &registry()).unwrap();
        let refused = experiment.plan().unwrap_err().to_string();
        assert!(refused.contains("found the quantity"), "{refused}");
    }
}
