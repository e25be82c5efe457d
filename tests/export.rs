//! Runs of every kind become trials that other tools can read: none is lost, none is made better.
#![cfg(feature = "harness")]

use std::fs;
use std::num::NonZeroU64;

use driftless::experiment::{
    self, Experiment, Identity, Instance, Plan, Progress, Record, RunSpec, Store,
};
use driftless::export::{ExportedRun, Function, Suite, SuiteFormat, write_suite};
use driftless::functions::{Analytic, TestFunction};
use driftless::input::Document;
use driftless::optimiser::Settings;
use driftless::registry;
use driftless::search::Watch;
use driftless::search::{Bounds, Evaluation, Failure, Problem};

struct Silent;

impl Progress for Silent {
    fn finished(&self, _: &RunSpec, _: &Record) {}
}

/// What a problem gives in one half of its box; in the other, the sum of squares above 3.
#[derive(Clone, Copy)]
enum Half {
    Panics,
    NotANumber,
}

struct HalfSound {
    half: Half,
    always: bool,
    bounds: Bounds,
}

impl HalfSound {
    fn instance(label: &str, group: &str, half: Half, always: bool, dimension: usize) -> Instance {
        let bounds = Bounds::cube(dimension, [-1.0, 1.0]);
        let problem = Self { half, always, bounds };
        let mut instance =
            Instance::of_problem("half", Identity::new().with("version", label), problem);
        label.clone_into(&mut instance.label);
        group.clone_into(&mut instance.group);
        instance
    }
}

impl Problem for HalfSound {
    fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    fn evaluate(&self, x: &[f64]) -> Result<Evaluation, Failure> {
        let cost = match self.half {
            _ if x[0] > 0.0 && !self.always => 3.0 + x.iter().map(|x| x * x).sum::<f64>(),
            Half::Panics => panic!("the wrong half"),
            Half::NotANumber => f64::NAN,
        };
        Ok(cost.into())
    }
}

fn number(n: u64) -> NonZeroU64 {
    NonZeroU64::new(n).unwrap()
}

/// `random` and `scp`, which has to give up at once for want of derivatives, with eight seeds and twenty
/// evaluations each; also the spent evaluations of the stored runs.
fn suite(instances: Vec<Instance>) -> (Suite, Vec<u64>) {
    std::panic::set_hook(Box::new(|_| {}));
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let field = ["random", "scp"].map(|name| Settings::by_name(name).unwrap());
    let plan = Plan::over("halves", instances, field, number(8), number(20));
    let specs: Vec<&RunSpec> = plan.runs.iter().collect();
    experiment::run(&plan, &specs, &store, 1, &Watch::default(), &Silent).unwrap();
    let runs = experiment::load(&plan, &store).unwrap();
    let suite = Suite::new(&plan, &runs).unwrap();
    (suite, runs.iter().map(|run| run.evaluations).collect())
}

fn halves() -> Vec<Instance> {
    use Half::{NotANumber, Panics};
    vec![
        HalfSound::instance("a", "mixed", NotANumber, false, 2),
        HalfSound::instance("b", "mixed", Panics, false, 2),
        HalfSound::instance("c", "mixed", Panics, false, 3),
        HalfSound::instance("d", "none/such = 'a'\n+ b", NotANumber, true, 2),
    ]
}

#[test]
fn every_run_is_a_trial_from_its_first_to_its_last_evaluation() {
    let (suite, spent) = suite(halves());
    assert_eq!(suite.trials.len(), 4 * 2 * 8);
    let mut late = 0;
    for (trial, spent) in suite.trials.iter().zip(spent) {
        assert_eq!(trial.trace[0].0, 1);
        assert_eq!(trial.evaluations(), spent.max(1));
        assert!(trial.trace.is_sorted_by(|a, b| a.0 < b.0 && a.1 >= b.1), "{:?}", trial.trace);
        late += usize::from(trial.trace[0].1.is_infinite() && trial.best().is_finite());
        let is_scp = suite.algorithms[trial.algorithm].name == "scp";
        if is_scp || trial.function == 1 {
            assert!(trial.best().is_infinite());
        }
    }
    assert!(late > 0, "no run began with a cost that is not finite");
    let panicked = |trial: &&ExportedRun| trial.algorithm == 0 && trial.evaluations() < 20;
    assert!(suite.trials.iter().filter(panicked).count() > 8);
}

/// The least cost found stands in where none is known; of sound test functions it is zero.
#[test]
fn optima_are_known_or_least_found() {
    let sphere = Analytic::new(TestFunction::Sphere, 4, 1);
    let mut instances = halves();
    let mut instance = Instance::of_problem("sphere", Identity::new().with("version", 1), sphere);
    (instance.label, instance.group) = ("e".to_owned(), "e".to_owned());
    instances.push(instance);
    let (suite, _) = suite(instances);
    let [mixed, none, sphere] = &suite.functions[..] else { panic!() };
    for (i, objective) in mixed.instances.iter().enumerate() {
        let trials = suite.trials.iter().filter(|t| t.function == 0 && t.instance == i);
        let least = trials.map(ExportedRun::best).fold(f64::INFINITY, f64::min);
        assert!(least > 3.0 && !objective.is_known);
        assert_eq!(objective.optimum, least);
    }
    assert!(none.instances[0].optimum.is_infinite());
    assert!(sphere.instances[0].is_known);
    assert_eq!((sphere.instances[0].optimum, sphere.instances[0].dimension), (0.0, 4));
    assert_eq!(none.name, "half none/such = 'a' + b");
    assert_eq!(none.file, "half_none_such____a____b");
}

/// Two dimensions within a group are two tables, and no two trials share a number.
#[test]
fn groups_may_have_several_dimensions() {
    let (suite, _) = suite(halves());
    let folder = tempfile::tempdir().unwrap();
    for (format, out) in [(SuiteFormat::Ioh, "ioh"), (SuiteFormat::Coco, "coco")] {
        write_suite(&folder.path().join(out), format, &suite).unwrap();
    }
    let text = |path: &str| fs::read_to_string(folder.path().join(path)).unwrap();
    let [f1, f2] = [0, 1].map(|place: usize| suite.functions[place].number);
    let own = |place: usize| u64::from(suite.functions[0].instances[place].number);
    let index: serde_json::Value =
        serde_json::from_str(&text(&format!("ioh/random/IOHprofiler_f{f1}_half_mixed.json")))
            .unwrap();
    let of = |i: usize| {
        let scenario = &index["scenarios"][i];
        let runs = scenario["runs"].as_array().unwrap();
        let mut instances: Vec<u64> =
            runs.iter().map(|r| r["instance"].as_u64().unwrap()).collect();
        instances.dedup();
        (scenario["dimension"].as_u64().unwrap(), instances, runs.len())
    };
    assert_eq!((of(0), of(1)), ((2, vec![own(0), own(1)], 16), (3, vec![own(2)], 8)));
    let index = text(&format!("coco/random/bbobexp_f{f1}.info"));
    let entries: Vec<&str> =
        index.lines().filter(|line| line.starts_with(&format!("data_f{f1}/"))).collect();
    let numbers = entries.iter().flat_map(|entry| entry.split(", ").skip(1));
    let numbers: Vec<u64> =
        numbers.map(|cell| cell.split(':').next().unwrap().parse().unwrap()).collect();
    let expected = (0..3).flat_map(|i| (1..=8).map(move |seed| 2_000_000 * own(i) + seed));
    assert_eq!(numbers, expected.collect::<Vec<u64>>());
    assert!(entries[1].starts_with(&format!("data_f{f1}/bbobexp_f{f1}_DIM3.dat, ")), "{index}");
    for line in text(&format!("coco/scp/data_f{f2}/bbobexp_f{f2}_DIM2.tdat")).lines() {
        assert!(line.starts_with('%') || line == "1 0 1e300 1e300 1e300", "{line}");
    }
}

/// Labels that differ in signs or capitals alone have folders of their own.
#[test]
fn folders_are_told_apart() {
    let problem = Analytic::new(TestFunction::Sphere, 2, 0);
    let instances =
        vec![Instance::of_problem("sphere", Identity::new().with("version", 0), problem)];
    let mut plan = Plan::over("labels", instances, Settings::all(), number(1), number(1));
    for (entrant, label) in plan.optimisers.iter_mut().zip(["a/b", "a b", "A=b", "a_b-2"]) {
        label.clone_into(&mut entrant.label);
    }
    let suite = Suite::new(&plan, &[]).unwrap();
    let folders: Vec<&str> = suite.algorithms.iter().map(|a| a.folder.as_str()).collect();
    assert_eq!(folders[..4], ["a_b", "a_b-2", "A_b-3", "a_b-2-2"]);
}

/// Number and name of a function, and dimension and number of each of its instances.
type Numbered = (u32, String, Vec<(u16, u32)>);

/// The functions of an experiment.
fn numbers(experiment: &str) -> Vec<Numbered> {
    let text = format!("name = 'numbers'\nseeds = 2\n{experiment}\n[[optimiser]]\nrandom = {{}}\n");
    let document = Document::embedded("numbers.toml", &text);
    let plan = Experiment::read(&document, &registry()).unwrap().plan().unwrap();
    let functions = Suite::new(&plan, &[]).unwrap().functions.into_iter();
    let of = |f: Function| {
        (f.number, f.name, f.instances.iter().map(|i| (i.dimension, i.number)).collect())
    };
    functions.map(of).collect()
}

/// A function has one number, and an instance too, whatever else an experiment has; dimensions of one function are no functions.
#[test]
fn numbers_mean_the_same_in_every_experiment() {
    let spheres = numbers("[functions]\nname = ['sphere']\ndimension = [5, 10]\ninstances = 2");
    let instances = vec![(5, 1), (5, 2), (10, 1), (10, 2)];
    assert_eq!(spheres, [(1, "sphere".to_owned(), instances)]);
    let two = numbers("[functions]\nname = ['rastrigin', 'sphere']\ndimension = [5]");
    let named = |number, name: &str| (number, name.to_owned(), vec![(5, 1)]);
    assert_eq!(two, [named(4, "rastrigin"), named(1, "sphere")]);

    let alone = numbers("[task.limits]\njerk_deg_s3 = 40");
    let [_, stated, _] = &numbers("[sweep]\njerk_limit_deg_s3 = [20, 40, 80]")[..] else {
        panic!()
    };
    assert_eq!((alone[0].0, &alone[0].2), (stated.0, &stated.2));
    let papers = numbers("[task]");
    assert_ne!(papers[0].0, stated.0);
    let poses = numbers("[sweep]\npose = [{ start = { base_zyx_deg = [1, 2, 3] } }, {}]");
    assert_eq!((poses.len(), poses[0].0), (1, papers[0].0));
    assert_eq!(poses[0].2[1], papers[0].2[0], "the second pose is the paper's");
    let mut all: Vec<u32> = numbers("[sweep]\nrandom_poses = { count = 100 }")[0]
        .2
        .iter()
        .map(|(_, number)| *number)
        .collect();
    assert!(all.iter().all(|number| (10_001..=65_535).contains(number)), "{all:?}");
    all.sort_unstable();
    all.dedup();
    assert_eq!(all.len(), 100);
    let budgets = numbers("[sweep]\nbudget = [100, 200]");
    let [first, second] = &budgets[0].2[..] else { panic!("{budgets:?}") };
    assert_eq!((budgets[0].0, first), (papers[0].0, &papers[0].2[0]));
    assert_ne!(first, second, "runs with two budgets are trials of their own");
}
