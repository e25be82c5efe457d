//! Promises about the physics that hold for every state and every motion.

use std::fmt::Write as _;

use driftless::attitude::net_rotation;
use driftless::input::Document;
use driftless::lanes::Width;
use driftless::momentum::{Arm, RateSlopes, base_map, base_twist, total_momentum};
use driftless::reorientation::{Accuracy, Boxes, Formulated, Formulation, Reorientation, TaskFile};
use driftless::robot::Robot;
use driftless::search::{Evaluation, Points, Problem};
use driftless::trajectory::Peaks;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use proptest::prelude::*;

fn paper() -> (Reorientation, Boxes) {
    let document = TaskFile::paper();
    TaskFile::read(&document).unwrap().build(&document).unwrap()
}

/// A serial arm with as many joints as there are rows of seven numbers from −1 to 1; about half of its
/// twists are quarter turns.
fn robot(joints: &[[f64; 7]]) -> Robot {
    let mut text = "name = 'drawn'\n[base]\nmass = 80\nmount = [0.4, -0.2, 0.3]\n\
         mount_zyx_deg = [20, -50, 70]\n\
         inertia = { xx = 9, yy = 11, zz = 7, xy = 0.3, xz = -0.2, yz = 0.4 }\n"
        .to_owned();
    for [a, d, alpha, offset, x, y, z] in joints {
        let _ = write!(
            text,
            "[[joint]]\ndh = {{ a = {a}, d = {d}, alpha_deg = {}, offset_deg = {} }}\n\
             range_deg = [-180, 180]\nmass = {}\ncentre_of_mass = [{x}, {y}, {z}]\n\
             inertia = {{ xx = 0.5, yy = 0.6, zz = 0.4, xy = {}, xz = {}, yz = {} }}\n",
            if *x > 0.0 { 90.0 * (2.0 * alpha).round() } else { 180.0 * alpha },
            180.0 * offset,
            5.0 + 4.0 * x,
            0.1 * x,
            0.1 * y,
            0.1 * z,
        );
    }
    Robot::from_document(&Document::embedded("drawn.toml", &text)).unwrap()
}

/// Coefficients within the default box of the two-term family, from numbers from −1 to 1.
fn in_box(unit: &[f64]) -> Vec<f64> {
    let widths = paper().1.coefficient;
    unit.iter().zip(widths.iter().cycle()).map(|(u, width)| u * width).collect()
}

/// The base's rotation by Runge–Kutta in time, along eq. 11's polynomial in powers of `t` with the
/// coefficients of eq. 24: nothing shared with the library but the base's rate.
fn rotation_in_time(
    problem: &Reorientation,
    alpha: &[f64],
    t_f: f64,
    steps: u32,
) -> UnitQuaternion<f64> {
    let task = problem.task();
    let joints = task.robot.joints().enumerate().map(|(i, joint)| {
        let [low, high] = joint.range;
        let (d1, d2) = ((high - low) / 2.0, f64::midpoint(high, low));
        let s0 = ((task.start.joints[i] - d2) / d1).asin();
        let delta = ((task.goal.joints[i] - d2) / d1).asin() - s0;
        let (p6, p7) = (alpha[i] * t_f.powi(6), alpha[i + 6] * t_f.powi(7));
        let a3 = (10.0 * delta - (3.0 * p7 + p6)) / t_f.powi(3);
        let a4 = (-15.0 * delta + 8.0 * p7 + 3.0 * p6) / t_f.powi(4);
        let a5 = (6.0 * delta - (6.0 * p7 + 3.0 * p6)) / t_f.powi(5);
        (d1, d2, [s0, 0.0, 0.0, a3, a4, a5, alpha[i], alpha[i + 6]])
    });
    let joints: Vec<_> = joints.collect();
    let omega = |t: f64| {
        let (mut angles, mut rates) = (Vec::new(), Vec::new());
        for (d1, d2, a) in &joints {
            let s: f64 = a.iter().rev().fold(0.0, |sum, c| sum * t + c);
            let slope = (1..8).rev().fold(0.0, |sum, j| sum * t + j as f64 * a[j]);
            angles.push(d1 * s.sin() + d2);
            rates.push(d1 * s.cos() * slope);
        }
        Vector3::from(base_twist(&task.robot, &angles, &rates).angular)
    };
    let h = t_f / f64::from(steps);
    let rate = |q: Quaternion<f64>, t: f64| q * Quaternion::from_imag(omega(t) * 0.5);
    let mut q = Quaternion::identity();
    for i in 0..steps {
        let t = f64::from(i) * h;
        let k1 = rate(q, t);
        let k2 = rate(q + k1 * (h / 2.0), t + h / 2.0);
        let k3 = rate(q + k2 * (h / 2.0), t + h / 2.0);
        let k4 = rate(q + k3 * h, t + h);
        q += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0);
    }
    UnitQuaternion::new_normalize(q)
}

fn rows() -> impl Strategy<Value = Vec<[f64; 7]>> {
    prop::collection::vec(prop::array::uniform7(-1.0..1.0), 1..9)
}

/// No files of earlier failures: a failure prints the case, which then becomes a test of its own.
fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn total_momentum_is_zero(
        angles in prop::collection::vec(-5.0..5.0, 6),
        rates in prop::collection::vec(-2.0..2.0, 6),
    ) {
        let robot = &paper().0.task().robot.clone();
        let (linear, angular) =
            total_momentum(robot, &angles, &rates, &base_twist(robot, &angles, &rates));
        let [linear, angular] = [linear, angular].map(Vector3::from);
        prop_assert!(linear.norm() < 1e-10, "{linear}");
        prop_assert!(angular.norm() < 1e-10, "{angular}");
    }

    #[test]
    fn total_momentum_is_zero_for_any_arm(
        rows in rows(),
        angles in prop::collection::vec(-5.0..5.0, 8),
        rates in prop::collection::vec(-2.0..2.0, 8),
    ) {
        let robot = robot(&rows);
        let (angles, rates) = (&angles[..rows.len()], &rates[..rows.len()]);
        let (linear, angular) =
            total_momentum(&robot, angles, rates, &base_twist(&robot, angles, rates));
        let [linear, angular] = [linear, angular].map(Vector3::from);
        prop_assert!(linear.norm() < 1e-10, "{linear}");
        prop_assert!(angular.norm() < 1e-10, "{angular}");
    }

    /// Derivatives of the base's rate in closed form against differences, and against unit rates.
    #[test]
    fn rate_slopes_are_derivatives_for_any_arm(
        rows in rows(),
        angles in prop::collection::vec(-5.0..5.0, 8),
        rates in prop::collection::vec(-2.0..2.0, 8),
    ) {
        let robot = robot(&rows);
        let (angles, rates) = (&angles[..rows.len()], &rates[..rows.len()]);
        let mut slopes = RateSlopes::new(&robot);
        slopes.evaluate(&robot, angles, rates);
        let map = base_map(&robot, angles);
        let here = Vector3::from(base_twist(&robot, angles, rates).angular);
        prop_assert!((Vector3::from(slopes.angular) - here).norm() < 1e-12 * (1.0 + here.norm()));
        for j in 0..rows.len() {
            let at = |step: f64| {
                let mut angles = angles.to_vec();
                angles[j] += step;
                Vector3::from(base_twist(&robot, &angles, rates).angular)
            };
            let h = 1e-3;
            let near = (at(h) - at(-h)) / (2.0 * h);
            let far = (at(2.0 * h) - at(-2.0 * h)) / (4.0 * h);
            let expected = (near * 4.0 - far) / 3.0;
            let miss = (Vector3::from(slopes.by_position[j]) - expected).norm();
            prop_assert!(miss < 1e-8 * (1.0 + expected.norm()), "{j}: {miss:e}");
            let miss = (Vector3::from(slopes.by_rate[j]) - map.fixed_view::<3, 1>(3, j)).norm();
            prop_assert!(miss < 1e-12, "{j}: {miss:e}");
        }
    }

    /// The inward sweep of the fitness against the outward one, for any arm.
    #[test]
    fn both_sweeps_give_the_same_rate(
        rows in rows(),
        angles in prop::collection::vec(-5.0..5.0, 8),
        rates in prop::collection::vec(-2.0..2.0, 8),
    ) {
        let robot = robot(&rows);
        let (angles, rates) = (&angles[..rows.len()], &rates[..rows.len()]);
        let inward = Arm::new(&robot).base_rate_at(angles, rates);
        let outward = Vector3::from(base_twist(&robot, angles, rates).angular);
        let miss = (inward - outward).norm();
        prop_assert!(miss < 1e-13 * (1.0 + outward.norm()), "{miss:e}");
    }

    /// Any number of lanes, one point or many: the same cost, to the last bit where products and sums
    /// are rounded at once, to 1e-12 otherwise; and `assess` finds it too.
    #[test]
    fn the_cost_does_not_depend_on_lanes(
        unit in prop::collection::vec(-1.0..1.0, 36),
        terms in 1_usize..=3,
        stretch in 0.3..1.5,
    ) {
        let (paper, _) = paper();
        let problem = Reorientation::new(paper.task().clone(), terms, paper.accuracy());
        let coefficients = &unit[..problem.family().dimension()];
        let shortest = problem.assess(coefficients, None);
        for duration in [None, Some(stretch * shortest.duration)] {
            let expected = problem.assess(coefficients, duration);
            let mut fused = Vec::new();
            for width in Width::available() {
                let problem = problem.with_width(width);
                let found = problem.evaluate(coefficients, duration, &mut problem.workspace());
                let violation: f64 = expected.excess.iter().sum();
                for (found, expected) in [(found.cost, expected.cost), (found.violation, violation)] {
                    let miss = (found - expected).abs();
                    prop_assert!(miss <= 1e-12 * expected.max(1.0), "{width:?}: {found} {expected}");
                }
                if width != Width::Scalar {
                    fused.push(found.cost.to_bits());
                }
            }
            prop_assert!(fused.windows(2).all(|pair| pair[0] == pair[1]), "{fused:x?}");
        }
    }

    /// A point's cost is the same to the last bit alone and in any company.
    #[test]
    fn the_cost_does_not_depend_on_the_batch(
        unit in prop::collection::vec(-1.0..1.0, 12 * 13),
        turned in 0_usize..12,
    ) {
        let (problem, boxes) = paper();
        let problem = std::sync::Arc::new(problem);
        for formulation in Formulation::ALL {
            let problem = Formulated::new(formulation, problem.clone(), &boxes).unwrap();
            let bits = |e: Evaluation| [e.cost, e.violation].map(f64::to_bits);
            let mut points = Points::zeros(problem.bounds().len(), 12);
            for (x, unit) in points.iter_mut().zip(unit.chunks_exact(13)) {
                let bounds = problem.bounds().iter();
                for ((x, unit), [lower, upper]) in x.iter_mut().zip(unit).zip(bounds) {
                    *x = f64::midpoint(lower, upper) + unit * (upper - lower) / 2.0;
                }
            }
            let mut other = points.clone();
            for (i, x) in points.iter().enumerate() {
                other[(i + turned) % 12].copy_from_slice(x);
            }
            let batch = |points: &Points| {
                let mut found = Vec::new();
                problem.evaluate_batch(points, &mut |e| found.push(bits(e))).unwrap();
                found
            };
            let alone: Vec<_> = points.iter().map(|x| bits(problem.evaluate(x).unwrap())).collect();
            prop_assert_eq!(&batch(&points), &alone);
            let mut found = batch(&other);
            found.rotate_left(turned);
            prop_assert_eq!(found, alone);
        }
    }

    /// Eq. 15, for families of any number of terms.
    #[test]
    fn paths_start_and_end_at_rest(
        unit in prop::collection::vec(-1.0..1.0, 48),
        terms in 1_usize..=8,
    ) {
        let task = paper().0.task().clone();
        let problem = Reorientation::new(task.clone(), terms, Accuracy::FINE);
        let path = problem.family().path(&unit[..problem.family().dimension()]);
        for (i, joint) in path.joints().enumerate() {
            let (start, end) = (joint.derivatives::<5>(0.0), joint.derivatives::<5>(1.0));
            prop_assert!((start[0] - task.start.joints[i]).abs() < 1e-10);
            prop_assert!((end[0] - task.goal.joints[i]).abs() < 1e-10);
            for k in [1, 2] {
                prop_assert!(start[k].abs() < 1e-10 && end[k].abs() < 1e-10);
            }
        }
    }

    /// Each derivative against central differences of the one below, extrapolated to fourth order.
    #[test]
    fn derivatives_agree_with_differences(
        unit in prop::collection::vec(-1.0..1.0, 12),
        tau in 0.01..0.99,
    ) {
        let problem = paper().0;
        let coefficients = in_box(&unit);
        let path = problem.family().path(&coefficients);
        let h = 1e-3;
        for joint in path.joints() {
            let exact = joint.derivatives::<5>(tau);
            let at = |step: f64| joint.derivatives::<5>(tau + step);
            let (p1, m1, p2, m2) = (at(h), at(-h), at(2.0 * h), at(-2.0 * h));
            for k in 1..5 {
                let difference =
                    (8.0 * (p1[k - 1] - m1[k - 1]) - (p2[k - 1] - m2[k - 1])) / (12.0 * h);
                let scale = 20_f64.powi(k as i32);
                prop_assert!((difference - exact[k]).abs() < 1e-7 * scale, "order {k}");
            }
        }
    }

    /// No denser look finds a higher peak, and none is invented, with up to eight terms. The look itself
    /// misses a peak by no more than its bend over half the way between two looks.
    #[test]
    fn peaks_are_those_of_a_dense_look(
        unit in prop::collection::vec(-1.0..1.0, 48),
        terms in 1_usize..=8,
    ) {
        let paper = paper().0;
        let problem = Reorientation::new(paper.task().clone(), terms, paper.accuracy());
        let widths = [1.0, 0.35, 0.15, 0.05, 0.05, 0.05, 0.05, 0.05];
        let dimension = problem.family().dimension();
        let widths = widths[..terms].iter().cycle();
        let coefficients: Vec<f64> =
            unit[..dimension].iter().zip(widths).map(|(u, width)| u * width).collect();
        let path = problem.family().path(&coefficients);
        let samples: Vec<Vec<_>> = path.joints().map(|joint| {
            (0..=20_000).map(|i| joint.derivatives::<6>(f64::from(i) / 20_000.0)).collect()
        }).collect();
        let half = 0.5 / 20_000.0;
        for intervals in [problem.accuracy().peak_intervals, Accuracy::FINE.peak_intervals] {
            let Peaks(peaks) = Peaks::of(problem.family(), &coefficients, intervals);
            for ((joint, samples), peaks) in path.joints().zip(&samples).zip(peaks) {
                for (k, peak) in peaks.into_iter().enumerate() {
                    let largest = |order: usize| {
                        samples.iter().map(|s: &[f64; 6]| s[order].abs()).fold(0.0, f64::max)
                    };
                    let dense = largest(k + 1);
                    let error = (peak.value - dense) / dense;
                    let missed = 1.01 * largest(k + 3) * half * half / 2.0 / dense;
                    prop_assert!(
                        (-1e-12..missed + 1e-12).contains(&error),
                        "order {}: {error:e}, {missed:e}",
                        k + 1
                    );
                    let there = joint.derivatives::<5>(peak.tau)[k + 1].abs();
                    prop_assert!((there - peak.value).abs() < 1e-12 * dense);
                }
            }
        }
    }

    /// The same motion in every formulation has the same cost.
    #[test]
    fn formulations_agree(unit in prop::collection::vec(-1.0..1.0, 12), stretch in 0.7..1.5) {
        let (problem, boxes) = paper();
        let problem = std::sync::Arc::new(problem);
        let coefficients = in_box(&unit);
        let shortest = problem.assess(&coefficients, None).duration;
        let cost = |formulation, duration| {
            let formulated = Formulated::new(formulation, problem.clone(), &boxes).unwrap();
            formulated.evaluate(&formulated.encode(&coefficients, duration)).unwrap().cost
        };
        let free = cost(Formulation::TimeFree, shortest);
        prop_assert!((cost(Formulation::Scaled, shortest) - free).abs() < 1e-9);
        prop_assert!((cost(Formulation::Raw, shortest) - free).abs() < 1e-9);
        let duration = stretch * shortest;
        let (scaled, raw) = (cost(Formulation::Scaled, duration), cost(Formulation::Raw, duration));
        prop_assert!((scaled - raw).abs() < 1e-9 * scaled.max(1.0), "{scaled} {raw}");
    }
}

proptest! {
    #![proptest_config(cases(12))]

    /// The base ends the same however long the motion takes, and as eq. 11 in time says it does.
    #[test]
    fn the_final_attitude_does_not_depend_on_timing(
        unit in prop::collection::vec(-1.0..1.0, 12),
        t_f in 2.0..20.0,
    ) {
        let problem = paper().0;
        let coefficients = in_box(&unit);
        let path = problem.family().path(&coefficients);
        let robot = &problem.task().robot;
        let ours = net_rotation(robot, &path, Accuracy::FINE.attitude_steps);
        for t_f in [t_f, 2.0 * t_f] {
            let alpha = problem.family().to_alpha(&coefficients, t_f);
            let theirs = rotation_in_time(&problem, &alpha, t_f, 4000);
            prop_assert!(ours.angle_to(&theirs) < 1e-9, "{t_f} s: {}", ours.angle_to(&theirs));
        }
    }
}

/// Joints that go hundreds of times through their ranges: where the base ends is what Runge–Kutta in time has it in up to 800,000 steps,
/// and peaks are those of a look at 2,000,000 places. Beyond what can be evaluated, that is said.
#[test]
fn wild_motions_are_evaluated_finely_or_said_to_be_uncertain() {
    let problem = paper().0;
    let task = problem.task();
    let wild = |size: f64| -> Vec<f64> {
        (0..12_u8).map(|i| size * (1.3 * f64::from(i) + 0.4).sin()).collect()
    };
    for (size, steps, way_at_least) in
        [(1.0, 4_000, 0.1), (100.0, 200_000, 20.0), (1000.0, 800_000, 200.0)]
    {
        let coefficients = wild(size);
        let motion = problem.certify(&coefficients, None);
        let alpha = problem.family().to_alpha(&coefficients, motion.duration);
        let net = rotation_in_time(&problem, &alpha, motion.duration, steps);
        let residual = (task.start.base * net).angle_to(&task.goal.base);
        let miss = (motion.residual() - residual).abs();
        assert!(miss < 1e-8, "{size}: {} instead of {residual}", motion.residual());
        let error = motion.residual_error.unwrap();
        assert!(error < 1e-6 && miss <= error + 1e-8, "{size}: {error}");
        let path = problem.family().path(&coefficients);
        let joint = path.joints().next().unwrap();
        let (mut way, mut before) = (0.0, task.start.joints[0]);
        let (mut jerk, mut bend) = (0.0_f64, 0.0_f64);
        for i in 0..=2_000_000 {
            let at = joint.derivatives::<6>(f64::from(i) / 2e6);
            way += (at[0] - before).abs();
            before = at[0];
            (jerk, bend) = (jerk.max(at[3].abs()), bend.max(at[5].abs()));
        }
        assert!(way > way_at_least, "{size}: {way} rad");
        // The look misses a peak by no more than its bend over half the way between two places.
        let missed = 1.01 * bend * 2.5e-7_f64.powi(2) / 2.0 / jerk;
        let peak = motion.peaks.0[0][2].value * motion.duration.powi(3);
        let error = peak / jerk - 1.0;
        assert!((-1e-9..missed + 1e-9).contains(&error), "{size}: {error:e}, {missed:e}");
    }
    let motion = problem.certify(&wild(1e7), None);
    assert_eq!(motion.residual_error, Some(f64::INFINITY));
    assert!(!motion.is_within(std::f64::consts::PI));
}

/// The default boxes hold the published solution and the best known one. The latter's coefficients
/// are from IPOPT 3.14 on a grid of 601 points, started at random.
#[test]
fn default_boxes_hold_the_solutions_of_interest() {
    let best = [
        [0.518_196, 0.034_236],
        [-0.189_152, -0.080_074],
        [-0.277_630, 0.117_767],
        [-0.588_259, 0.002_780],
        [0.036_600, 0.076_002],
        [-0.017_762, -0.176_705],
    ];
    let best: Vec<f64> = best.concat();
    let (problem, boxes) = paper();
    let replay = driftless::reorientation::ReplayFile::paper();
    let published =
        driftless::reorientation::ReplayFile::read(&replay).unwrap().build(&replay).unwrap();
    let fine = problem.with_accuracy(Accuracy::FINE).assess(&best, None);
    assert!((fine.duration - 7.8185).abs() < 1e-3 && fine.residual() < 1e-4, "{fine:?}");
    let problem = std::sync::Arc::new(problem);
    for formulation in Formulation::ALL {
        let formulated = Formulated::new(formulation, problem.clone(), &boxes).unwrap();
        for (coefficients, duration) in
            [(&best, 7.8185), (&published.coefficients, published.duration)]
        {
            let x = formulated.encode(coefficients, duration);
            assert!(formulated.bounds().contains(&x), "{formulation:?}");
        }
    }
}
