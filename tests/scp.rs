//! Sequential convex programming finds the optimum that IPOPT found, alone and after other optimisers.

use std::num::NonZeroUsize;
use std::sync::Arc;

use driftless::input::Document;
use driftless::optimiser::{De, Ending, Hybrid, Optimiser, Scp, Settings};
use driftless::reorientation::{Formulated, Formulation, TaskFile};
use driftless::search::{Composite, Problem};
use driftless::search::{Oracle, Rng, Stop, Watch};
use nalgebra::{DMatrix, DVector};

/// The best motion known with two terms per joint, which IPOPT finds too: `benches/peers/casadi`.
const BEST_KNOWN: f64 = 0.781_850;

fn task(text: &str) -> Formulated {
    let document = Document::embedded("task", text);
    let (problem, boxes) = TaskFile::read(&document).unwrap().build(&document).unwrap();
    Formulated::new(Formulation::TimeFree, Arc::new(problem), &boxes).unwrap()
}

/// A polynomial in `τ`, lowest power first.
type Polynomial = Vec<f64>;

fn times(a: &[f64], b: &[f64]) -> Polynomial {
    let mut product = vec![0.0; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            product[i + j] += x * y;
        }
    }
    product
}

fn slope(p: &[f64]) -> Polynomial {
    p.iter().enumerate().skip(1).map(|(n, c)| n as f64 * c).collect()
}

fn value(p: &[f64], tau: f64) -> f64 {
    p.iter().rev().fold(0.0, |sum, c| sum * tau + c)
}

/// Largest share of a limit that a motion of the paper's task with two terms uses, at 20,001 times.
///
/// The phase is written out in powers of `τ` and differentiated term by term, and the joint's
/// derivatives are eqs. 12 to 14 as they stand, nothing of which the library does.
fn largest_share(coefficients: &[f64], duration: f64) -> f64 {
    const START: [f64; 6] = [10.0, 30.0, 45.0, -20.0, -25.0, 40.0];
    const GOAL: [f64; 6] = [40.0, 60.0, 90.0, -10.0, -30.0, 60.0];
    const LIMITS: [f64; 3] = [60.0, 70.0, 80.0];
    let problem = task("");
    let mut largest = 0.0_f64;
    for (j, joint) in problem.task().task().robot.joints().enumerate() {
        let [low, high] = joint.range;
        let (amplitude, centre) = ((high - low) / 2.0, f64::midpoint(low, high));
        let phase = |deg: f64| ((deg.to_radians() - centre) / amplitude).asin();
        let (start, change) = (phase(START[j]), phase(GOAL[j]) - phase(START[j]));
        let step = [0.0, 0.0, 0.0, 10.0, -15.0, 6.0].map(|c| c * change);
        let window = [0.0, 0.0, 0.0, 64.0, -192.0, 192.0, -64.0];
        let root = 15.0_f64.sqrt();
        let [c0, c1] = [coefficients[2 * j], coefficients[2 * j + 1]];
        let mut s = times(&window, &[c0 - root * c1, 2.0 * root * c1]);
        s.iter_mut().zip(step).for_each(|(a, b)| *a += b);
        s[0] += start;
        let s1 = slope(&s);
        let s2 = slope(&s1);
        let s3 = slope(&s2);
        for i in 0..=20_000 {
            let tau = f64::from(i) / 20_000.0;
            let [s, s1, s2, s3] = [&s, &s1, &s2, &s3].map(|p| value(p, tau));
            let (sin, cos) = s.sin_cos();
            let derivatives = [
                cos * s1,
                cos * s2 - sin * s1 * s1,
                cos * s3 - 3.0 * sin * s1 * s2 - cos * s1.powi(3),
            ];
            for (order, derivative) in (1..).zip(derivatives) {
                let found = (amplitude * derivative / duration.powi(order)).to_degrees();
                largest = largest.max(found.abs() / LIMITS[order as usize - 1]);
            }
        }
    }
    largest
}

#[test]
fn a_few_starts_find_the_best_known_motion() {
    let problem = task("");
    for seed in 1..=100 {
        let watch = Watch::default();
        let mut oracle = Oracle::new(&problem, 150_000, &watch);
        let scp = Scp { starts: NonZeroUsize::new(12), ..Scp::default() };
        assert_eq!(scp.minimise(&mut oracle, &mut Rng::new(seed)), Ok(()));
        let (coefficients, motion) = problem.certify(&oracle.best().unwrap().x);
        assert!(motion.cost <= BEST_KNOWN, "seed {seed}: {}", motion.cost);
        assert!(motion.residual().to_degrees() < 1e-4, "seed {seed}: {}", motion.residual());
        let share = largest_share(&coefficients, motion.duration);
        assert!(share <= 1.0 + 1e-6, "seed {seed}: {share} of a limit");
        assert!(share >= 1.0 - 1e-6, "seed {seed}: no limit is reached, {share}");
    }
}

#[test]
fn single_starts_find_it_often() {
    let problem = task("");
    let found = (1..=100).filter(|&seed| {
        let watch = Watch::default();
        let mut oracle = Oracle::new(&problem, 150_000, &watch);
        let scp = Scp { starts: NonZeroUsize::new(1), ..Scp::default() };
        scp.minimise(&mut oracle, &mut Rng::new(seed)).unwrap();
        problem.certify(&oracle.best().unwrap().x).1.cost <= BEST_KNOWN
    });
    let found = found.count();
    assert!(found >= 45, "{found} of 100");
}

/// The thresholds are durations of 6.3150 s and 6.1466 s. IPOPT, with exact derivatives from `CasADi`
/// and limits at the peaks it found, ended at 6.31490 s and 6.14654 s.
#[test]
fn more_terms_are_faster() {
    for (terms, threshold) in [(3, 0.631_50), (4, 0.614_66)] {
        let problem = task(&format!("[trajectory]\nterms = {terms}\n"));
        let watch = Watch::default();
        let mut oracle = Oracle::new(&problem, 150_000, &watch);
        let scp = Scp { starts: NonZeroUsize::new(20), ..Scp::default() };
        scp.minimise(&mut oracle, &mut Rng::new(1)).unwrap();
        let (_, motion) = problem.certify(&oracle.best().unwrap().x);
        assert!(motion.cost <= threshold, "{terms} terms: {}", motion.cost);
        assert!(motion.residual().to_degrees() < 1e-4, "{terms} terms: {}", motion.residual());
    }
}

/// Random steps along which the base's end stays, brought back onto it, find nothing lower.
#[test]
fn ends_where_nothing_near_is_better() {
    let problem = task("");
    let watch = Watch::default();
    for seed in 1..=10 {
        let mut oracle = Oracle::new(&problem, 150_000, &watch);
        let start = Scp::start(problem.bounds(), &mut Rng::new(seed));
        assert_eq!(Scp::default().follow(&mut oracle, &start), Ok(Ending::Optimal), "seed {seed}");
        let best = oracle.best().unwrap().clone();
        let parts = problem.linearise(&best.x).unwrap();
        let rows: Vec<_> = parts.terms[0].pieces.iter().map(|p| p.gradient.transpose()).collect();
        let jacobian = DMatrix::from_rows(&rows);
        let inverse = jacobian.clone().pseudo_inverse(1e-9).unwrap();
        let mut rng = Rng::new(seed);
        for _ in 0..500 {
            let any = DVector::from_fn(best.x.len(), |_, _| 1e-4 * rng.uniform(-1.0, 1.0));
            let step = &any - &inverse * (&jacobian * &any);
            let mut x = DVector::from_column_slice(&best.x) + step;
            for _ in 0..2 {
                let parts = problem.linearise(x.as_slice()).unwrap();
                let error = parts.terms[0].pieces.iter().map(|piece| piece.value);
                x -= &inverse * DVector::from_iterator(3, error);
            }
            let cost = problem.evaluate(x.as_slice()).unwrap().cost;
            assert!(cost > best.evaluation.cost - 1e-8, "seed {seed}: {cost}");
        }
    }
}

/// With all weight on the base any motion that brings it there is best.
#[test]
fn brings_the_base_home_when_time_is_free() {
    let problem = task("[task.weights]\nbase = 1\n");
    let watch = Watch::default();
    let mut oracle = Oracle::new(&problem, 1_000, &watch);
    let start = Scp::start(problem.bounds(), &mut Rng::new(1));
    assert_eq!(Scp::default().follow(&mut oracle, &start), Ok(Ending::Optimal));
    assert!(oracle.best().unwrap().evaluation.cost < 1e-6);
}

/// Three joints cannot bring the base all the way. CMA-ES and L-SHADE, in each of three runs of 150,000
/// evaluations, end at a J of 13.4718.
#[test]
fn gets_as_near_as_others_where_the_goal_is_out_of_reach() {
    let folder = tempfile::tempdir().unwrap();
    let robot: Vec<_> =
        include_str!("../src/robot/shipped/xiao2023.toml").split("[[joint]]").collect();
    std::fs::write(folder.path().join("arm.toml"), robot[..4].join("[[joint]]")).unwrap();
    let path = folder.path().join("task.toml");
    let text = "[task]\nrobot = 'arm.toml'\n\
        start = { joints_deg = [10, 30, 45], base_zyx_deg = [6, 15, 7] }\n\
        goal = { joints_deg = [40, 60, 90], base_zyx_deg = [0, 0, 0] }\n\
        limits = { rate_deg_s = 60, acceleration_deg_s2 = 70, jerk_deg_s3 = 80 }\n";
    std::fs::write(&path, text).unwrap();
    let document = Document::read(&path).unwrap();
    let (problem, boxes) = TaskFile::read(&document).unwrap().build(&document).unwrap();
    let problem = Formulated::new(Formulation::TimeFree, Arc::new(problem), &boxes).unwrap();
    for seed in 1..=20 {
        let watch = Watch::default();
        let mut oracle = Oracle::new(&problem, 150_000, &watch);
        let scp = Scp { starts: NonZeroUsize::new(4), ..Scp::default() };
        assert_eq!(scp.minimise(&mut oracle, &mut Rng::new(seed)), Ok(()));
        let (_, motion) = problem.certify(&oracle.best().unwrap().x);
        assert!(motion.cost <= 13.4719, "seed {seed}: {}", motion.cost);
    }
}

#[test]
fn refines_what_another_optimiser_found() {
    let problem = task("");
    let watch = Watch::default();
    let search = Box::new(Settings::De(De::default()));
    let hybrid = Hybrid { search, share: 0.4, ..Hybrid::default() };
    let mut oracle = Oracle::new(&problem, 5_000, &watch);
    let stop = hybrid.minimise(&mut oracle, &mut Rng::new(1));
    assert_eq!((stop, oracle.evaluations()), (Err(Stop::BudgetSpent), 5_000));
    // Two rounds of 2000 and a part of a third.
    let steps = oracle.linearisations();
    assert!((20..1_000).contains(&steps), "{steps}");
    let refined = oracle.best().unwrap().evaluation.cost;

    let mut alone = Oracle::new(&problem, 5_000, &watch);
    let stop = De::default().minimise(&mut alone, &mut Rng::new(1));
    assert_eq!(stop, Err(Stop::BudgetSpent));
    assert!(refined < alone.best().unwrap().evaluation.cost);
}

#[test]
fn budgets_are_kept_and_the_box_not_left() {
    for budget in 1..=60 {
        let optimisers: [&dyn Optimiser; 2] = [&Scp::default(), &Hybrid::default()];
        for optimiser in optimisers {
            let problem = task("[trajectory.box]\ncoefficient = [0.3, 0.1]\n");
            let watch = Watch::default();
            let mut oracle = Oracle::new(&problem, budget, &watch);
            let stop = optimiser.minimise(&mut oracle, &mut Rng::new(budget));
            assert_eq!((stop, oracle.evaluations()), (Err(Stop::BudgetSpent), budget));
            assert!(problem.bounds().contains(&oracle.best().unwrap().x));
        }
    }
}
