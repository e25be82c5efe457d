//! Splines in the kernels: the base's rotation along them, beside a plain integration.

use std::num::NonZeroUsize;
use std::sync::Arc;

use driftless::input::Document;
use driftless::momentum::base_twist;
use driftless::optimiser::{Ending, Optimiser as _, Scp};
use driftless::reorientation::{Accuracy, Excursions, Formulated, Motion, Reorientation, TaskFile};
use driftless::robot::Robot;
use driftless::search::{Bend, LinearLimit, Oracle, Problem as _, Rng, Stop, Watch};
use driftless::task::Task;
use driftless::trajectory::{Curve as _, Family as _, Spline};
use nalgebra::{DVector, Quaternion, UnitQuaternion, Vector3};

fn paper() -> Arc<Task> {
    let document = TaskFile::paper();
    let (task, _) = TaskFile::read(&document).unwrap().build(&document).unwrap();
    task.task().clone()
}

/// The base's rotation by the classical Runge–Kutta method on `Q̇ = ½ Q ⊗ (0, ω_b)` (eq. 9), so many steps per piece.
fn integrated(
    task: &Task,
    family: &Spline,
    coefficients: &[f64],
    steps: usize,
) -> UnitQuaternion<f64> {
    integrated_by(task, family, coefficients, steps, |_, _, _| ())
}

/// The same, with a look at every step: at `τ`, the rotation so far, and the base's rate by `τ`.
fn integrated_by(
    task: &Task,
    family: &Spline,
    coefficients: &[f64],
    steps: usize,
    mut look: impl FnMut(f64, UnitQuaternion<f64>, Vector3<f64>),
) -> UnitQuaternion<f64> {
    let curves: Vec<_> = (0..family.joints())
        .map(|joint| family.curve(joint, &coefficients[family.coefficients_of(joint)]))
        .collect();
    let rate = |tau: f64| -> Vector3<f64> {
        let at: Vec<[f64; 2]> = curves.iter().map(|curve| curve.derivatives(tau)).collect();
        let [angles, rates] = [0, 1].map(|n| at.iter().map(|at| at[n]).collect::<Vec<f64>>());
        base_twist(&task.robot, &angles, &rates).angular.into()
    };
    let count = steps * family.knots().pieces();
    let h = 1.0 / count as f64;
    let mut q = Quaternion::identity();
    for i in 0..count {
        let start = i as f64 * h;
        let slope = |q: Quaternion<f64>, w: Vector3<f64>| q * Quaternion::from_imag(w) * 0.5;
        let [w1, w2, w3] = [rate(start), rate(start + 0.5 * h), rate(start + h)];
        look(start, UnitQuaternion::from_quaternion(q), w1);
        let k1 = slope(q, w1);
        let k2 = slope(q + k1 * (0.5 * h), w2);
        let k3 = slope(q + k2 * (0.5 * h), w2);
        let k4 = slope(q + k3 * h, w3);
        q += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0);
    }
    UnitQuaternion::from_quaternion(q)
}

/// Splines for a task, and the coefficients of one that swings about the straight path by up to so much \[rad\].
fn wavy(task: &Task, pieces: usize, degree: usize, size: f64) -> (Spline, Vec<f64>) {
    let family = Spline::new(&task.start.joints, &task.goal.joints, pieces, degree);
    let own = |i: usize| size * f64::sin(2.9 * i as f64);
    let coefficients = (0..family.dimension()).map(own).collect();
    (family, coefficients)
}

/// A panel is one piece or part of one, within which paths are smooth: few steps are enough for all degrees.
#[test]
fn rotations_are_those_of_a_plain_integration() {
    let task = paper();
    for (degree, pieces) in [(3, 10), (4, 12), (5, 4)] {
        let (family, coefficients) = wavy(&task, pieces, degree, 0.3);
        let expected = integrated(&task, &family, &coefficients, 2000 / pieces);
        let accuracy = Accuracy { attitude_steps: 3 * pieces.max(8), peak_intervals: 1 };
        let problem = Reorientation::over(task.clone(), family, accuracy);
        let miss = problem.net_rotation(&coefficients).angle_to(&expected);
        assert!(miss < 1e-7, "degree {degree}, {pieces} pieces: {miss} rad");
        let fine = problem.with_accuracy(Accuracy::FINE).net_rotation(&coefficients);
        assert!(fine.angle_to(&expected) < 1e-10, "degree {degree}: {}", fine.angle_to(&expected));
    }
}

/// What happens on the way is what a plain integration in 24,000 steps meets: the base's largest turn, when, and its largest
/// rate; and joints go as far as dense samples of their paths.
#[test]
fn extremes_on_the_way_are_those_of_a_plain_integration() {
    let task = paper();
    let duration = 7.0;
    for (degree, pieces, wide) in [(3, 10, 0.3), (4, 12, 1.0), (5, 4, 0.1)] {
        let (family, coefficients) = wavy(&task, pieces, degree, wide);
        let (mut turn, mut at, mut fastest) = (0.0, 0.0, 0.0_f64);
        integrated_by(&task, &family, &coefficients, 24_000 / pieces, |tau, q, rate| {
            if q.angle() > turn {
                (turn, at) = (q.angle(), tau);
            }
            fastest = fastest.max(rate.norm() / duration);
        });
        let accuracy = Accuracy { attitude_steps: 24, peak_intervals: 1 };
        let problem = Reorientation::over(task.clone(), family.clone(), accuracy);
        let motion = Motion::sample(&problem, &coefficients, duration, 2000);
        let found = Excursions::of(&task, &motion);
        assert!((found.base_turn - turn).abs() < 1e-7, "{} {turn}", found.base_turn);
        assert!((found.base_turn_at / duration - at).abs() < 1e-4, "{} {at}", found.base_turn_at);
        assert!((found.base_rate / fastest - 1.0).abs() < 1e-6, "{} {fastest}", found.base_rate);
        let used = found.range_used(&task);
        for (k, joint) in task.robot.joints().enumerate() {
            let curve = family.curve(k, &coefficients[family.coefficients_of(k)]);
            let angles = (0..=24_000).map(|i| curve.derivatives::<1>(f64::from(i) / 24_000.0)[0]);
            let [least, largest] =
                angles.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
            let [lower, upper] = joint.range;
            let expected = (2.0 * largest - lower - upper).max(lower + upper - 2.0 * least);
            assert!((found.positions[k][0] - least).abs() < 1e-7);
            assert!((found.positions[k][1] - largest).abs() < 1e-7);
            assert!((used[k] - expected / (upper - lower)).abs() < 1e-7);
        }
    }
}

fn free_form(task: &Arc<Task>, pieces: usize, degree: usize) -> Formulated<Spline> {
    let family = Spline::new(&task.start.joints, &task.goal.joints, pieces, degree);
    let accuracy = Accuracy { attitude_steps: 24, peak_intervals: 1 };
    Formulated::free_form(Arc::new(Reorientation::over(task.clone(), family, accuracy))).unwrap()
}

/// The parts of the cost, and their slopes, are those of what an evaluation says.
#[test]
fn limits_and_slopes_are_those_of_the_cost() {
    let task = paper();
    for (degree, pieces) in [(3, 9), (4, 12), (5, 7)] {
        let problem = free_form(&task, pieces, degree);
        let timed = problem.timed().unwrap();
        let mut rng = Rng::new(3);
        for far in [false, true] {
            let mut x = timed.start(&mut rng, 0.0);
            if far {
                // Far out of a range.
                x[2] = problem.bounds().iter().nth(2).unwrap()[1];
                x[3] = problem.bounds().iter().nth(3).unwrap()[1];
            }
            let parts = timed.parts(&x).unwrap();
            let (limits, error) = (&parts.limits, &parts.error);
            assert_eq!(limits.excess > 0.0, far);
            let evaluation = problem.evaluate(&x).unwrap();
            let cost = timed.weights().cost(&parts);
            assert!((cost - evaluation.cost).abs() < 1e-12 * cost, "{cost} {}", evaluation.cost);
            assert!((evaluation.violation - limits.excess).abs() < 1e-14);
            let (duration, h) = (problem.task().assess(&x, None).duration, 1e-6);
            assert!((limits.time - duration).abs() < 1e-13 * duration);
            for k in 0..x.len() {
                let at = |step: f64| {
                    let mut there = x.clone();
                    there[k] += step;
                    (timed.error(&there).unwrap().value, timed.limits(&there).unwrap().list)
                };
                let [(ahead, up), (back, down)] = [at(h), at(-h)];
                let slope = (ahead - back) / (2.0 * h);
                let miss = (slope - error.slopes.column(k)).amax();
                assert!(miss < 1e-8, "{degree}, variable {k}: {miss}");
                // Those that are there at every point are linear.
                let fixed = |list: &[LinearLimit]| -> Vec<LinearLimit> {
                    list.iter().filter(|limit| limit.id.is_some()).copied().collect()
                };
                let all = [&limits.list, &up, &down].map(|list| fixed(list));
                for ((here, up), down) in all[0].iter().zip(&all[1]).zip(&all[2]) {
                    assert_eq!(here.id, up.id);
                    let own = k.checked_sub(here.first).filter(|i| *i < LinearLimit::MOST);
                    let slope = own.map_or(0.0, |i| here.slopes[i]);
                    let found = (up.value - down.value) / (2.0 * h);
                    let size = here.slopes.iter().fold(1.0, |most: f64, g| most.max(g.abs()));
                    assert!((found - slope).abs() < 1e-7 * size, "{found} {slope}");
                }
            }
        }
    }
}

/// How the error bends is right to a few digits: along each direction it is the second difference of the error, of which two
/// evaluations apart from it tell.
#[test]
fn bends_are_second_differences_of_the_error() {
    let task = paper();
    for (degree, pieces) in [(3, 20), (4, 40), (5, 80)] {
        let problem = free_form(&task, pieces, degree);
        let timed = problem.timed().unwrap();
        let x = timed.start(&mut Rng::new(3), 1.0);
        let bends = timed.bends(&x).unwrap();
        assert_eq!(bends.len(), 8 * task.robot.joint_count());
        let at = |direction: &DVector<f64>, h: f64| {
            let there = DVector::from_column_slice(&x) + direction * h;
            timed.error(there.as_slice()).unwrap().value
        };
        let here = timed.error(&x).unwrap().value;
        let pair = |bend: &Bend| {
            let (d, h) = (&bend.direction, 1e-3);
            ((at(d, h) + at(d, -h) - &here * 2.0) / (h * h), &bend.change * d)
        };
        let pairs: Vec<_> = bends.iter().map(pair).collect();
        let largest = pairs.iter().map(|(found, _)| found.amax()).fold(0.0, f64::max);
        for (found, told) in &pairs {
            assert!((found - told).amax() < 0.02 * largest, "{found} {told}");
        }
    }
}

/// 5.63565 s and 5.63617 s with 20 pieces of degree 3, 5.61012 s with 40, by sequential linear programming on other
/// quadrature, and 5.610 s by direct transcription (Betts 2010, doi:10.1137/1.9780898718577): from every random start,
/// with limits kept and the goal reached over continuous time.
#[test]
fn every_start_ends_at_the_fastest_free_form_motion() {
    let task = paper();
    for (pieces, degree, expected) in [(20, 3, 5.6363), (40, 3, 5.6103), (40, 4, 5.6152)] {
        let problem = free_form(&task, pieces, degree);
        for seed in 1..=4 {
            let start = problem.timed().unwrap().start(&mut Rng::new(seed), 0.0);
            let watch = Watch::default();
            let mut oracle = Oracle::new(&problem, 1_000, &watch);
            let ending = Scp::default().follow(&mut oracle, &start).unwrap();
            assert_eq!(ending, Ending::Optimal, "{pieces} pieces of degree {degree}, seed {seed}");
            let (coefficients, motion) = problem.certify(&oracle.best().unwrap().x);
            assert!(motion.duration <= expected, "seed {seed}: {} s", motion.duration);
            assert!(motion.residual().to_degrees() < 1e-6, "{}", motion.residual().to_degrees());
            assert_eq!((motion.range_excess, motion.excess), (0.0, [0.0; 3]));
            let family = problem.task().family();
            for (joint, limits) in task.limits.0.iter().enumerate() {
                let curve = family.curve(joint, &coefficients[family.coefficients_of(joint)]);
                for i in 0..=20_000 {
                    let at = curve.derivatives::<4>(f64::from(i) / 20_000.0);
                    for (order, limit) in (1..).zip(limits) {
                        let share = at[order].abs() / motion.duration.powi(order as i32) / limit;
                        assert!(share < 1.0 + 1e-9, "joint {joint}, order {order}: {share}");
                    }
                }
            }
            let expected = integrated(&task, family, &coefficients, 4_000 / pieces);
            let end = task.goal.base.inverse() * task.start.base * expected;
            assert!(end.angle().to_degrees() < 1e-5, "{}", end.angle().to_degrees());
        }
    }
}

/// A path with half as many pieces is one of the finer family, whatever the degree, and stays in its box.
#[test]
fn splitting_the_pieces_leaves_paths_as_they_are() {
    let task = paper();
    for degree in [3, 4, 5] {
        let fine = free_form(&task, 40, degree);
        let coarse = fine.coarser().unwrap();
        let x = coarse.timed().unwrap().start(&mut Rng::new(3), 1.0);
        let prolonged = coarse.prolong(&x);
        assert!(prolonged.iter().zip(fine.bounds().iter()).all(|(x, [a, b])| (a..=b).contains(x)));
        let half = Spline::new(&task.start.joints, &task.goal.joints, 20, degree);
        assert_eq!(
            (half.dimension(), fine.task().family().dimension()),
            (x.len(), prolonged.len())
        );
        for joint in 0..half.joints() {
            let own = half.curve(joint, &x[half.coefficients_of(joint)]);
            let family = fine.task().family();
            let split = family.curve(joint, &prolonged[family.coefficients_of(joint)]);
            for i in 0..=500 {
                let tau = f64::from(i) / 500.0;
                let [a, b] = [own.derivatives::<3>(tau), split.derivatives::<3>(tau)];
                for (a, b) in a.iter().zip(b) {
                    assert!(
                        (a - b).abs() < 1e-9 * (1.0 + a.abs()),
                        "degree {degree}, {tau}: {a} and {b}"
                    );
                }
            }
        }
        let [a, b] = [coarse.evaluate(&x), fine.evaluate(&prolonged)].map(|e| e.unwrap().cost);
        assert!((a - b).abs() < 1e-6 * b, "degree {degree}: {a} and {b}");
    }
    assert!(free_form(&task, 31, 4).coarser().is_none());
}

/// By way of fewer pieces, a search ends at the fastest motion as well.
#[test]
fn a_search_by_way_of_fewer_pieces_ends_at_the_fastest_motion() {
    let problem = free_form(&paper(), 40, 4);
    let watch = Watch::default();
    let mut oracle = Oracle::new(&problem, 10_000, &watch);
    let search = Scp { starts: NonZeroUsize::new(4), ..Scp::default() };
    search.minimise(&mut oracle, &mut Rng::new(1)).unwrap();
    let (_, motion) = problem.certify(&oracle.best().unwrap().x);
    assert!(motion.duration <= 5.6152, "{} s", motion.duration);
    assert!(motion.residual().to_degrees() < 1e-6, "{}°", motion.residual().to_degrees());
}

/// Searches that run at the same time find, spend and tell what they would one after the other.
#[test]
fn searches_at_the_same_time_are_those_one_after_the_other() {
    let problem = free_form(&paper(), 16, 4);
    let search = Scp { starts: NonZeroUsize::new(5), ..Scp::default() };
    let [one, all] = [false, true].map(|is_parallel| {
        let watch = Watch::default();
        let oracle = Oracle::new(&problem, 10_000, &watch);
        let mut oracle = if is_parallel { oracle.parallel() } else { oracle };
        search.minimise(&mut oracle, &mut Rng::new(3)).unwrap();
        let spent = [oracle.evaluations(), oracle.linearisations(), oracle.curvatures()];
        let counts = (spent, oracle.conic_solves(), oracle.first_feasible());
        assert_eq!(watch.evaluations(), oracle.evaluations());
        let best = oracle.best().unwrap().clone();
        let trace: Vec<_> =
            oracle.into_trace().into_iter().map(|point| (point.evaluation, point.best)).collect();
        (counts, best, trace)
    });
    assert_eq!(one, all);
    assert!(one.2.len() > 5 && one.2.is_sorted_by(|a, b| a.0 < b.0 && a.1.cost >= b.1.cost));
}

/// However little there is to spend, searches at the same time spend no more.
#[test]
fn a_small_budget_is_shared() {
    let problem = free_form(&paper(), 16, 4);
    for budget in [1, 3, 20] {
        let watch = Watch::default();
        let mut oracle = Oracle::new(&problem, budget, &watch).parallel();
        let search = Scp { starts: NonZeroUsize::new(5), ..Scp::default() };
        assert_eq!(search.minimise(&mut oracle, &mut Rng::new(3)), Err(Stop::BudgetSpent));
        assert_eq!(oracle.evaluations(), budget);
        assert_eq!(oracle.best().unwrap().x.len(), problem.bounds().len());
    }
}

/// The paper's task with a narrower range of the fourth joint.
fn narrowed(task: &Task) -> Arc<Task> {
    let text = include_str!("../src/robot/shipped/xiao2023.toml");
    let narrow = text.replace("range_deg = [-170, 170]", "range_deg = [-45, 0]");
    assert_ne!(narrow, text);
    let robot = Robot::from_document(&Document::embedded("narrow", &narrow)).unwrap();
    Arc::new(Task { robot: Arc::new(robot), ..task.clone() })
}

/// A joint that would gain by leaving its range stays in it.
#[test]
fn ranges_are_kept() {
    let narrow = narrowed(&paper());
    let problem = free_form(&narrow, 20, 4);
    let watch = Watch::default();
    let mut oracle = Oracle::new(&problem, 10_000, &watch);
    // A single start may end where range and goal are at odds.
    let search = Scp { starts: NonZeroUsize::new(4), ..Scp::default() };
    search.minimise(&mut oracle, &mut Rng::new(5)).unwrap();
    let (coefficients, motion) = problem.certify(&oracle.best().unwrap().x);
    assert!(motion.range_excess < 1e-9 && motion.residual().to_degrees() < 1e-6);
    let family = problem.task().family();
    let mut touched = false;
    for (joint, [lower, upper]) in narrow.robot.joints().map(|joint| joint.range).enumerate() {
        let curve = family.curve(joint, &coefficients[family.coefficients_of(joint)]);
        for i in 0..=5_000 {
            let [angle] = curve.derivatives(f64::from(i) / 5_000.0);
            let half = (upper - lower) / 2.0;
            assert!(
                (lower - 1e-9 * half..=upper + 1e-9 * half).contains(&angle),
                "{joint}: {angle}"
            );
            touched |= f64::min(angle - lower, upper - angle) < 1e-4 * half && i % 5_000 != 0;
        }
    }
    assert!(touched, "no range mattered");
}
