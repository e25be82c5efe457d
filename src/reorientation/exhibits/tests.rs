//! What the task shows, from runs and data made by hand.

use std::f64::consts::TAU;
use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};

use super::base_attitude::base_attitude;
use super::derivatives::derivatives;
use super::joint_angles::joint_angles;
use super::on_the_way::on_the_way;
use super::pareto::{Trade, Traded, pareto};
use super::snapshots::snapshots;
use super::sweep_tests::{missed, poses, swept, two_settings};
use super::sweeps::{Swept, sweep as sweep_chart};
use crate::analysis::handmade::{answer, findings, plan_on, runs};
use crate::analysis::{Analysis, targets};
use crate::exhibit::{Exhibits, Finding};
use crate::experiment::{
    Experiment, Folder, Options, Plan, Progress, Record, Registry, Run, RunSpec, load,
};
use crate::figure::Figure;
use crate::figure::stored_pictures::check;
use crate::functions::Functions;
use crate::input::Document;
use crate::lanes::Width;
use crate::reorientation::best_known::BestKnown;
use crate::reorientation::kind::ReorientationTask;
use crate::reorientation::limited::{limited, nearest};
use crate::reorientation::motion::{JointMotion, Motion};
use crate::reorientation::settings::TaskFile;
use crate::reorientation::subject::{DURATION, RESIDUAL, TaskSubject};
use crate::robot::JointKind;
use crate::search::Watch;

/// What the tests' experiments are on.
fn registry() -> Registry {
    Registry::new().with(Arc::new(ReorientationTask)).with(Arc::new(Functions))
}

/// The plan of an experiment file without its name.
fn plan(text: &str) -> Plan {
    plan_on(text, &registry())
}

/// The measures of a motion that brings the base home.
fn measures(plan: &Plan, duration: f64) -> Vec<f64> {
    let mut measures = vec![f64::NAN; plan.measures().len()];
    measures[plan.measure(RESIDUAL).unwrap()] = 1e-7;
    measures[plan.measure(DURATION).unwrap()] = duration;
    measures
}

/// Runs of a task that end with the best motion known.
fn best_known(plan: &Plan) -> Vec<Run> {
    let known = |run: Run| {
        let subject = TaskSubject::of(&plan.instances[run.instance]).unwrap();
        let known = BestKnown::of(subject.reorientation()).unwrap();
        Run {
            cost: known.j,
            measures: measures(plan, known.t_f),
            x: known.coefficients.concat(),
            ..run
        }
    };
    runs(plan, |_| vec![(1, 1.0)]).into_iter().map(known).collect()
}

/// Half angles of 3°, 7.5° and 3.5° make a turn of 17.3°. The limit on rates binds at a jerk of 225 °/s³, as the page
/// of experiments has it, so at 80 °/s³ the largest rate is ∛(80/225) = 71 % of its limit.
#[test]
fn the_best_motion_is_described() {
    let plan = plan("seeds = 1\nbudget = { evaluations = 9 }\n[[optimiser]]\nscp = {}\n");
    let told = findings(&plan, &best_known(&plan));
    assert_eq!(
        answer(&told, "How good is it?"),
        "The best motion is by scp/time-free: J 0.781849 (reaches the best known, 0.781849), 7.818 s, and the base ends \
         within 0.001° of the goal."
    );
    let motion = answer(&told, "What does the motion look like?");
    for part in [
        "takes 7.818 s",
        "The goal is 17.3° from",
        "jerks reach the limit in all joints",
        "rates up to 71 %",
    ] {
        assert!(motion.contains(part), "{motion}");
    }
}

#[test]
fn a_sweep_of_one_optimiser_tells_its_range() {
    let plan = plan(
        "seeds = 2\nbudget = { evaluations = 9 }\n[sweep]\nterms = [2, 3]\n[[optimiser]]\nscp = {}\n",
    );
    let told = findings(&plan, &best_known(&plan));
    assert_eq!(
        answer(&told, "What does the sweep say?"),
        "Over 2 settings, the best J is least, 0.6315, at terms=3 and largest, 0.7818, at terms=2; the best motions take \
         6.315 s to 7.818 s and the residual stays below 0.001°."
    );
    assert_eq!(answer(&told, "Who won?"), "");
    assert_eq!(
        answer(&told, "How good is it?"),
        "A best cost is known of 2 instances; it was reached within 10⁻⁶ on 2. The base ends within 0.01° of \
         the goal on 2 of 2 instances, and the best motions take 6.315 s to 7.818 s."
    );
    let motion = answer(&told, "What does the motion look like?");
    assert!(motion.contains("and jerks on 2"), "{motion}");
}

/// No run finds a motion, which leaves the tests what they are.
#[test]
fn poses_are_independent_whatever_the_budgets_beside_them() {
    let significance = |sweep: &str| {
        let plan = plan(&format!(
            "seeds = 1\nbudget = {{ evaluations = 9 }}\n[sweep]\n{sweep}\n\
             [[optimiser]]\nde = {{}}\n[[optimiser]]\nrandom = {{}}\n"
        ));
        let told = findings(&plan, &runs(&plan, |_| vec![]));
        answer(&told, "Is it significant?").to_owned()
    };
    let poses = significance("random_poses = { count = 3, seed = 1 }\nbudget = [10, 20]");
    assert!(poses.contains("Blocks are 3 instances"), "{poses}");
    assert!(!poses.contains("independent"), "{poses}");
    let terms = significance("terms = [2, 3]");
    assert!(terms.contains("Settings of one task are not independent"), "{terms}");
}

/// What a sweep says of runs with the best motion known of another, one cost per run.
fn sweep(settings: &str, cost: impl Fn(usize) -> f64) -> String {
    let head = "seeds = 1\nbudget = { evaluations = 9 }\n";
    let field = "[[optimiser]]\nscp = {}\n";
    let one = plan(&format!("{head}{field}"));
    let known = best_known(&one).remove(0);
    let plan = plan(&format!("{head}[sweep]\n{settings}\n{field}"));
    let with = |(i, run): (usize, Run)| Run {
        cost: cost(i),
        measures: known.measures.clone(),
        x: known.x.clone(),
        ..run
    };
    let runs: Vec<Run> =
        runs(&plan, |_| vec![(1, 1.0)]).into_iter().enumerate().map(with).collect();
    answer(&findings(&plan, &runs), "What does the sweep say?").to_owned()
}

#[test]
fn a_sweep_compares_no_costs_of_different_weights() {
    assert_eq!(
        sweep("weight_base = [0.1, 0.2]", |i| 1.0 + i as f64),
        "Over 2 settings, the best motions take 7.818 s and the residual stays below 0.001°."
    );
}

#[test]
fn a_sweep_tells_no_noise_apart() {
    assert_eq!(
        sweep("jerk_limit_deg_s3 = [80.0, 81.0]", |i| 0.5 + 1e-8 * i as f64),
        "Over 2 settings, the best J is the same, 0.5000; the best motions take 7.818 s and the residual stays below 0.001°."
    );
}

#[test]
fn all_who_tie_have_the_best_motion() {
    let plan = plan(
        "seeds = 1\nbudget = { evaluations = 9 }\n[[optimiser]]\nlabel = 'A'\nscp = {}\n\
         [[optimiser]]\nlabel = 'B'\nscp = { starts = 2 }\n[[optimiser]]\nlabel = 'C'\nscp = { starts = 3 }\n",
    );
    let mut runs = best_known(&plan);
    runs[0].cost *= 1.0 + 1e-8;
    runs[2].cost *= 1.0 + 1e-5;
    let told = findings(&plan, &runs);
    let good = answer(&told, "How good is it?");
    assert!(good.starts_with("The best motion is by A and B alike: J 0.781849"), "{good}");
}

#[test]
fn what_is_beaten_is_not_what_is_reached() {
    let plan = plan(
        "seeds = 1\nbudget = { evaluations = 9 }\n[sweep]\nterms = [2, 3]\n[[optimiser]]\nscp = {}\n",
    );
    let mut runs = best_known(&plan);
    runs[1].cost *= 0.9;
    let told = findings(&plan, &runs);
    let good = answer(&told, "How good is it?");
    let part = "of 2 instances; it was reached within 10⁻⁶ on 1, and beaten by more on 1.";
    assert!(good.contains(part), "{good}");
}

/// What is shown and said of a sweep whose runs all found the same motion.
fn exhibited(sweep: &str) -> (Exhibits, Vec<Finding>) {
    let field = "[[optimiser]]\nscp = {}\n";
    let head = "seeds = 1\nbudget = { evaluations = 9 }\n";
    let known = best_known(&plan(&format!("{head}{field}"))).remove(0);
    let plan = plan(&format!("{head}[sweep]\n{sweep}\n{field}"));
    let as_known = |run: Run| Run { measures: known.measures.clone(), x: known.x.clone(), ..run };
    let runs: Vec<Run> = runs(&plan, |_| vec![(1, 1.0)]).into_iter().map(as_known).collect();
    let targets = targets(&plan, &runs);
    let analysis = Analysis::new(&plan, &runs, &targets);
    let exhibits = analysis.exhibits();
    let findings = analysis.findings(&exhibits);
    (exhibits, findings)
}

fn list(count: u32) -> String {
    format!("[{}]", (0..count).map(|i| (50 + i).to_string()).collect::<Vec<_>>().join(", "))
}

/// Every one of 30 motions can be chosen on the page.
#[test]
fn motions_of_many_instances_are_all_shown() {
    let (exhibits, _) = exhibited(&format!("jerk_limit_deg_s3 = {}", list(30)));
    assert_eq!((exhibits.scenes.len(), exhibits.scenes_found), (30, 30));
}

/// Of two jerk limits under 25 limits on rates the one chart would have 25 panels, the other has one with two curves.
#[test]
fn charts_that_are_left_out_are_told() {
    let (exhibits, told) =
        exhibited(&format!("jerk_limit_deg_s3 = [80, 90]\nrate_limit_deg_s = {}", list(25)));
    let names: Vec<&str> = exhibits.leading_charts.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["rate-sweep"]);
    assert_eq!(
        answer(&told, "Which charts are left out?"),
        "jerk-sweep: other settings have more than 24 combinations."
    );
}

/// A group of poses is no reason to leave the chart of a sweep out.
#[test]
fn sweeps_over_poses_are_drawn() {
    let (exhibits, _) =
        exhibited("jerk_limit_deg_s3 = [80, 90]\nrandom_poses = { count = 12, seed = 1 }");
    let names: Vec<&str> = exhibits.leading_charts.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["jerk-sweep"]);
}

/// Of three instances one is not tried yet.
#[test]
fn instances_not_tried_yet_are_not_off_the_goal() {
    let plan = plan(
        "seeds = 1\nbudget = { evaluations = 9 }\n[sweep]\nterms = [2, 3, 4]\n[[optimiser]]\nscp = {}\n",
    );
    let runs: Vec<Run> = best_known(&plan).into_iter().filter(|run| run.instance < 2).collect();
    let told = findings(&plan, &runs);
    let good = answer(&told, "How good is it?");
    let part = "The base ends within 0.01° of the goal on 2 of 2 instances";
    assert!(good.contains(part) && good.ends_with("One more is not tried yet."), "{good}");
}

fn front() -> Figure {
    let motions = [
        (0.01, 2.8, 29.0, true),
        (0.1, 2.8, 29.0, true),
        (0.2, 5.0, 12.0, true),
        (0.5, 7.0, 14.0, false),
        (0.9, 7.8, 0.0, true),
    ];
    let trade = |(weight, duration, value_deg, is_efficient)| Trade {
        others: String::new(),
        weight,
        duration,
        value_deg,
        is_efficient,
    };
    pareto(&motions.map(trade), Traded::Residual).unwrap()
}

/// More fronts than a panel can hold have panels of their own.
#[test]
fn many_fronts_are_drawn() {
    let trade = |(i, weight): (usize, f64)| Trade {
        others: format!("jerk ≤ {} °/s³", 20 * (i + 1)),
        weight,
        duration: 5.0 + weight,
        value_deg: 20.0 - 20.0 * weight,
        is_efficient: true,
    };
    let trades: Vec<Trade> =
        (0..10).flat_map(|i| [0.1, 0.9].map(|weight| (i, weight))).map(trade).collect();
    assert_eq!(pareto(&trades, Traded::LargestTurn).unwrap().panels.len(), 10);
}

fn motion() -> Motion {
    let time: Vec<f64> = (0..=200).map(|i| f64::from(i) * 0.05).collect();
    let joint = |i: usize| JointMotion {
        kind: JointKind::Revolute,
        name: format!("joint{}", i + 1),
        derivatives: time
            .iter()
            .map(|t| std::array::from_fn(|k| (t * TAU / 10.0 + (i + k) as f64).sin() * 1.2))
            .collect(),
    };
    let base = |t: &f64| UnitQuaternion::from_euler_angles(0.1 * t.sin(), 0.03 * t, -0.02 * t);
    Motion {
        joints: (0..7).map(joint).collect(),
        base: time.iter().map(base).collect(),
        time,
        ..Motion::default()
    }
}

/// Every chart by name.
fn charts() -> Vec<(&'static str, Figure)> {
    let document = TaskFile::paper();
    let (problem, _) = TaskFile::read(&document).unwrap().build(&document).unwrap();
    let task = problem.task();
    vec![
        ("weight-sweep", swept(Swept::WeightBase, &[0.001, 0.01, 0.1, 0.2, 0.5, 0.9], None)),
        ("jerk-sweep", swept(Swept::JerkLimit, &[20.0, 40.0, 80.0, 160.0, 320.0, 640.0], None)),
        ("jerk-sweep-missed", sweep_chart(&missed(&[], "", 1.0), Swept::JerkLimit, None).unwrap()),
        ("jerk-sweep-rates", sweep_chart(&two_settings(), Swept::JerkLimit, None).unwrap()),
        ("jerk-sweep-poses", sweep_chart(&poses(), Swept::JerkLimit, None).unwrap()),
        ("rate-sweep", swept(Swept::RateLimit, &[10.0, 20.0, 40.0, 60.0], None)),
        ("terms-sweep", swept(Swept::Terms, &[1.0, 2.0, 3.0, 4.0, 8.0], Some(0.6))),
        ("pieces-sweep", swept(Swept::Pieces, &[4.0, 8.0, 16.0, 32.0, 64.0], None)),
        ("pareto", front()),
        ("joint-angles", joint_angles(&motion())),
        ("joint-derivatives", derivatives(&motion(), &task.limits)),
        ("base-attitude", base_attitude(&motion(), task)),
        ("snapshots", snapshots(&Motion::sample(&problem, &[0.1; 12], 8.0, 100), task)),
    ]
}

/// The task with limits on the way has a panel for each; the largest turn of a base that turns about one axis is known.
#[test]
fn limits_on_the_way_have_a_panel_each() {
    let text = "[task.limits]\nbase_turn_deg = 30\nbase_turn_from = 'start'\nbase_rate_deg_s = 4\ntorque_n_m = 9\nclearance_m = 0.01\n";
    let document = Document::embedded("task.toml", text);
    let (problem, _) = TaskFile::read(&document).unwrap().build(&document).unwrap();
    let task = problem.task();
    let motion = Motion::sample(&problem, &[0.1; 12], 8.0, 100);
    let limited = limited(task, &motion);
    let limits: Vec<(&str, f64)> =
        limited.iter().map(|one| (one.name.as_str(), one.limit)).collect();
    let names = ["turn of the base", "rate of the base", "torque", "clearance"];
    for ((name, limit), (expected, at)) in
        limits.iter().zip(names.into_iter().zip([30.0, 4.0, 1.0, 0.01]))
    {
        assert_eq!(*name, expected);
        assert!((limit - at).abs() < 1e-12, "{limit}");
    }
    let largest = limited[0].values.iter().fold(0.0, |most: f64, turn| most.max(*turn));
    let turns = motion.base.iter().map(|base| motion.base[0].angle_to(base).to_degrees());
    assert!((largest - turns.fold(0.0, f64::max)).abs() < 1e-9, "{largest}");
    // At rest at both ends.
    let rates = &limited[1].values;
    assert!(rates[0] < 1e-9 && rates[100] < 1e-9, "{rates:?}");
    assert_eq!(on_the_way(&motion, task).unwrap().panels.len(), 4);
    let points = nearest(task, &motion).unwrap();
    for (distance, [one, other]) in limited[3].values.iter().zip(points) {
        let apart = (Vector3::from(one) - Vector3::from(other)).norm();
        assert!((apart - distance.abs()).abs() < 1e-9, "{apart} {distance}");
    }
    let document = TaskFile::paper();
    let (problem, _) = TaskFile::read(&document).unwrap().build(&document).unwrap();
    let motion = Motion::sample(&problem, &[0.1; 12], 8.0, 100);
    assert!(on_the_way(&motion, problem.task()).is_none());
}

#[test]
fn charts_look_as_stored() {
    check(&charts());
}

struct Quiet;

impl Progress for Quiet {
    fn finished(&self, _: &RunSpec, _: &Record) {}
}

/// The default experiment with a small budget, evaluated with so many lanes.
fn default_findings(width: Width) -> Vec<Finding> {
    let experiment = Experiment::read(&Experiment::embedded(), &registry()).unwrap();
    let mut plan = experiment.with_budget(2000.try_into().unwrap()).plan().unwrap();
    for instance in &mut plan.instances {
        let subject = TaskSubject::of(instance).unwrap().with_width(width);
        instance.subject = Arc::new(subject);
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = Folder::create(folder.path(), plan).unwrap();
    folder.run(Options::default(), &Watch::default(), &Quiet).unwrap();
    findings(&folder.plan, &load(&folder.plan, &folder.store).unwrap())
}

/// The same whatever the number of lanes.
#[test]
fn findings_of_the_default_experiment() {
    let told = default_findings(Width::widest());
    assert_eq!(told, default_findings(Width::Scalar));
    let lines = told.iter().map(|f| format!("{}\n{}\n", f.question, f.answer));
    insta::assert_snapshot!(lines.collect::<Vec<_>>().join("\n"));
}
