//! Sweeps obey the laws that follow from the cost: how the best duration depends on the jerk limit, and
//! when the base is worth its time.
#![cfg(feature = "harness")]

use std::sync::Arc;

use driftless::experiment::{
    self, Experiment, Instance, Plan, Progress, Record, Run, RunSpec, Store, load,
};
use driftless::input::Document;
use driftless::optimiser::{Ending, Scp};
use driftless::posture::Posture;
use driftless::registry;
use driftless::reorientation::{
    AnyReorientation, BestKnown, Formulated, Formulation, TaskFile, TaskSubject,
};
use driftless::robot::Shape;
use driftless::search::{Oracle, Watch};
use nalgebra::Vector3;

struct Quiet;

impl Progress for Quiet {
    fn finished(&self, _: &RunSpec, _: &Record) {}
}

fn plan(text: &str) -> Plan {
    let document = Document::embedded("experiment.toml", text);
    Experiment::read(&document, &registry()).unwrap().plan().unwrap()
}

/// The best motion of an instance.
struct Best {
    cost: f64,
    residual_deg: f64,
    duration: f64,
    coefficients: Vec<f64>,
}

fn task(instance: &Instance) -> &dyn AnyReorientation {
    TaskSubject::of(instance).unwrap().reorientation()
}

/// Runs an experiment of `scp`; the best motion of each instance.
fn best_motions(plan: &Plan) -> Vec<Best> {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let all: Vec<&RunSpec> = plan.runs.iter().collect();
    experiment::run(plan, &all, &store, 2, &Watch::default(), &Quiet).unwrap();
    let runs = load(plan, &store).unwrap();
    let measure = |run: &Run, name| plan.results(&runs).measure(run, name);
    let best = |run: &Run| Best {
        cost: run.cost,
        residual_deg: measure(run, "residual_deg"),
        duration: measure(run, "t_f"),
        coefficients: run.x.clone(),
    };
    let best: Vec<Best> = plan.results(&runs).best_runs().into_iter().map(best).collect();
    assert_eq!(best.len(), plan.instances.len());
    best
}

/// While jerk alone limits a motion its jerks scale with `t_f⁻³`, so `t_f ∝ j̄^(−1/3)`; its rates scale
/// with `1 / t_f`, which says where the first of them reaches its limit.
#[test]
fn durations_follow_the_jerk_limit_until_a_rate_joins() {
    const LIMITS: [f64; 6] = [20.0, 80.0, 160.0, 220.0, 230.0, 320.0];
    let plan = plan(&format!(
        "name = 'jerk'\nseeds = 1\nbudget = {{ evaluations = 150_000 }}\n\
         [sweep]\njerk_limit_deg_s3 = {LIMITS:?}\n[[optimiser]]\nscp = {{ starts = 12 }}\n"
    ));
    let best = best_motions(&plan);
    let reference = &best[1];
    let problem = task(&plan.instances[1]);
    let motion = problem.certify(&reference.coefficients, Some(reference.duration));
    let reached = |order: usize, limit: f64| {
        let peaks = motion.peaks.0.iter().map(|peaks| peaks[order].value.to_degrees());
        limit / peaks.fold(0.0, f64::max)
    };
    // The jerk limit at which the paper's limits on rate and acceleration are reached.
    let by_rate = LIMITS[1] * reached(0, 60.0).powi(3);
    let by_acceleration = LIMITS[1] * reached(1, 70.0).powf(1.5);
    assert!((220.0..230.0).contains(&by_rate) && by_acceleration > by_rate, "{by_rate}");
    for (run, limit) in best.iter().zip(LIMITS) {
        let law = reference.duration * (LIMITS[1] / limit).cbrt();
        let excess = run.duration / law - 1.0;
        assert!(run.residual_deg < 1e-4, "{limit} °/s³: {} °", run.residual_deg);
        if limit < by_rate {
            assert!(excess.abs() < 1e-4, "{limit} °/s³: {excess}");
        } else {
            assert!(excess > 1e-3, "{limit} °/s³: {excess}");
        }
    }
}

/// `J = K_b e + K_t t_f` is linear in the weights for any one motion. Of two motions, the fastest that
/// ends at the goal and the fastest of all, the first is better as soon as `K_b / K_t` exceeds what it
/// takes longer over what the other leaves of `e`; no other motion is better than both.
#[test]
fn the_base_comes_home_as_soon_as_it_is_worth_its_time() {
    const WEIGHTS: [f64; 6] = [0.001, 0.08, 0.12, 0.2, 0.5, 0.9];
    let plan = plan(&format!(
        "name = 'weight'\nseeds = 1\nbudget = {{ evaluations = 150_000 }}\n\
         [sweep]\nweight_base = {WEIGHTS:?}\n[[optimiser]]\nscp = {{ starts = 20 }}\n"
    ));
    let best = best_motions(&plan);
    let (fastest, home) = (&best[0], &best[5]);
    let left = (fastest.residual_deg / 2.0).to_radians().sin() / 0.5_f64.to_radians().sin();
    let ratio = (home.duration - fastest.duration) / left;
    let threshold = ratio / (1.0 + ratio);
    assert!((0.12..0.2).contains(&threshold), "{threshold}");
    for (run, weight) in best.iter().zip(WEIGHTS) {
        let homing = (1.0 - weight) * home.duration;
        let hurried = weight * left + (1.0 - weight) * fastest.duration;
        let gap = run.cost / homing.min(hurried) - 1.0;
        assert!(gap.abs() < 1e-5, "K_b = {weight}: {gap}");
        if weight < threshold {
            assert!(run.residual_deg > 20.0, "K_b = {weight}: {} °", run.residual_deg);
        } else {
            assert!(run.residual_deg < 1e-4, "K_b = {weight}: {} °", run.residual_deg);
        }
    }
}

/// The best known motion, followed to its local optimum on another task; its residual and duration.
fn followed(task: &str) -> (f64, f64) {
    let problem = |text: &str| {
        let document = Document::embedded("task.toml", text);
        TaskFile::read(&document).unwrap().build(&document).unwrap()
    };
    let start = BestKnown::of(&problem("").0).unwrap().coefficients.concat();
    let (task, boxes) = problem(task);
    let problem = Formulated::new(Formulation::TimeFree, Arc::new(task), &boxes).unwrap();
    let watch = Watch::default();
    let mut oracle = Oracle::new(&problem, 10_000, &watch);
    // With the task's own weight from the start, and in small steps.
    let scp = Scp { first_weight: 1e9, radius: 1e-3, ..Scp::default() };
    assert_eq!(scp.follow(&mut oracle, &start), Ok(Ending::Optimal));
    let (_, motion) = problem.certify(&oracle.best().unwrap().x);
    (motion.residual().to_degrees(), motion.duration)
}

/// The theorem of exact penalties: a motion that ends at the goal is a local optimum as long as the
/// error weighs more than the constraint's multiplier, which is the gradient of the best duration by
/// the goal, found here from differences. An error of `θ` adds `K_b θ / (2 sin ½°)` to `J`.
#[test]
fn homing_is_locally_best_down_to_its_multiplier() {
    const TURN: f64 = 0.02;
    let slope = |axis: usize| {
        let duration = |turn: f64| {
            let mut goal = [0.0; 3];
            goal[axis] = turn;
            let (residual, duration) = followed(&format!("[task.goal]\nbase_zyx_deg = {goal:?}\n"));
            assert!(residual < 1e-4, "{residual}");
            duration
        };
        (duration(TURN) - duration(-TURN)) / (2.0 * TURN.to_radians())
    };
    let multiplier = (0..3).map(|axis| slope(axis).powi(2)).sum::<f64>().sqrt();
    let ratio = multiplier * 2.0 * 0.5_f64.to_radians().sin();
    let residual =
        |ratio: f64| followed(&format!("[task.weights]\nbase = {}\n", ratio / (1.0 + ratio))).0;
    assert!(residual(1.01 * ratio) < 1e-4, "{ratio}");
    assert!(residual(0.99 * ratio) > 1.0, "{ratio}");
}

/// A hundred random poses are within the robot's ranges, turn the base no further than asked for and do
/// not depend on how many there are.
#[test]
fn random_poses_are_within_their_bounds() {
    let poses = |count: usize| {
        plan(&format!(
            "name = 'poses'\nseeds = 1\n[sweep]\nterms = [1, 2]\n\
             random_poses = {{ count = {count}, seed = 7, joint_change_deg = 50, turn_deg = 25 }}\n\
             [[optimiser]]\nrandom = {{}}\n"
        ))
    };
    let plan = poses(100);
    assert_eq!(plan.instances.len(), 200);
    let (mut furthest, mut widest) = (0.0_f64, 0.0_f64);
    for (i, instance) in plan.instances.iter().enumerate() {
        let group = format!("terms={}", 1 + i / 100);
        assert_eq!(instance.group, group);
        assert_eq!(instance.label, format!("{group} pose={}", 1 + i % 100));
        let task = task(instance).task();
        let turn = task.start.base.angle_to(&task.goal.base).to_degrees();
        assert!(turn <= 25.0 + 1e-6, "{turn}");
        furthest = furthest.max(turn);
        for (joint, (start, goal)) in
            task.robot.joints().zip(task.start.joints.iter().zip(&task.goal.joints))
        {
            let [lower, upper] = joint.range;
            let (middle, half) = (f64::midpoint(lower, upper), 0.8 * (upper - lower) / 2.0);
            for angle in [start, goal] {
                assert!((angle - middle).abs() <= half + 1e-9, "{angle}");
            }
            let change = (goal - start).to_degrees().abs();
            assert!(change <= 50.0 + 2e-6, "{change}");
            widest = widest.max(change);
        }
    }
    assert!(furthest > 24.0 && widest > 49.0, "{furthest} {widest}");
    let fewer = poses(3);
    for (place, kept) in [(0, 0), (1, 1), (2, 2), (3, 100), (4, 101), (5, 102)] {
        assert_eq!(fewer.runs[place].key, plan.runs[kept].key);
    }
}

/// What is kept out of stands 3 m above where the base's centre of mass is at the start, which follows from the pose.
#[test]
fn what_is_kept_out_of_follows_the_pose() {
    let plan = plan(
        "name = 'poses'\nseeds = 1\n\
         [task.keep_out.ball]\nshapes = [{ sphere = { centre = [0, 0, 3], radius = 0.1 } }]\n\
         [sweep]\nclearance_m = [0.01, 0.02]\n\
         pose = [{ start.joints_deg = [0, 0, 0, 0, 0, 0] }, { start.joints_deg = [90, 0, 0, 0, 0, 0] }]\n\
         [[optimiser]]\nrandom = {}\n",
    );
    let mut centres = Vec::new();
    for (instance, least) in plan.instances.iter().zip([0.01, 0.01, 0.02, 0.02]) {
        let task = task(instance).task();
        let clearance = task.path.clearance.as_ref().unwrap();
        assert_eq!(clearance.least, least);
        let [solid] = clearance.solids() else { panic!("{:?}", clearance.solids()) };
        let Shape::Capsule { ends: [centre, _], .. } = &solid.shape else { panic!("{solid:?}") };
        let start = Posture::of(&task.robot, &task.start.joints, task.start.base);
        let above = centre - Vector3::from(start.position);
        assert!((above - Vector3::new(0.0, 0.0, 3.0)).norm() < 1e-12, "{above}");
        centres.push(*centre);
    }
    assert!((centres[0] - centres[1]).norm() > 0.01, "{centres:?}");
}
