//! Subgradients of every formulation and family against central differences of the cost alone.

use std::path::Path;
use std::sync::Arc;

use driftless::functions::{Analytic, TestFunction};
use driftless::input::Document;
use driftless::reorientation::{Accuracy, Boxes, Formulated, Formulation, Reorientation, TaskFile};
use driftless::search::{Bounds, Evaluation, Oracle, Problem, Rng, Stop, Watch};
use driftless::trajectory::Spline;
use nalgebra::DVector;

/// How many slopes were compared, and how many not because the cost has a kink there.
#[derive(Debug, Default)]
struct Tally {
    compared: usize,
    kinks: usize,
}

impl Tally {
    /// Compares every slope at a point with differences of the cost.
    fn check(&mut self, problem: &dyn Problem, x: &[f64], name: &str) {
        self.check_along(problem, problem.bounds(), x, &<[f64]>::to_vec, name);
    }

    /// Compares slopes by variables `z` in a box, of which the problem's are a function, with differences of the cost. A kink
    /// between their ends spoils these by no more than half of what the one ahead differs from the one back.
    fn check_along(
        &mut self,
        problem: &dyn Problem,
        bounds: &Bounds,
        z: &[f64],
        x: &dyn Fn(&[f64]) -> Vec<f64>,
        name: &str,
    ) {
        const STEP: f64 = 1e-6;
        let found = problem.slopes().unwrap().at(&x(z)).unwrap();
        let Evaluation { cost, violation } = problem.evaluate(&x(z)).unwrap();
        assert!((found.evaluation.cost - cost).abs() <= 1e-11 * cost.abs(), "{name}: {cost}");
        assert!((found.evaluation.violation - violation).abs() <= 1e-12, "{name}: {violation}");
        // Slope, and differences ahead and back, as if the box were one wide.
        let by_variable = |(j, [lower, upper]): (usize, [f64; 2])| {
            let [ahead, back] = [STEP, -STEP].map(|step| {
                let mut there = z.to_vec();
                there[j] += step * (upper - lower);
                x(&there)
            });
            let change = DVector::from_vec(ahead.clone()) - DVector::from_column_slice(&back);
            let slope = found.slopes.dot(&change) / (2.0 * STEP);
            let [ahead, back] = [ahead, back].map(|x| problem.evaluate(&x).unwrap().cost);
            [slope, (ahead - cost) / STEP, (cost - back) / STEP]
        };
        let all: Vec<_> = bounds.iter().enumerate().map(by_variable).collect();
        let largest = all.iter().map(|[slope, ..]| slope.abs()).fold(1.0, f64::max);
        for (j, [slope, ahead, back]) in all.into_iter().enumerate() {
            if (ahead - back).abs() > 4e-5 * largest {
                self.kinks += 1;
                continue;
            }
            let expected = f64::midpoint(ahead, back);
            let miss = (slope - expected).abs();
            assert!(miss < 2e-5 * largest, "{name}, x[{j}]: {slope} {expected} {largest}");
            self.compared += 1;
        }
    }

    fn end(&self, compared: usize) {
        assert!(self.compared >= compared && self.kinks * 10 < self.compared, "{self:?}");
    }
}

/// A point of the box shrunk about its middle.
fn point(problem: &dyn Problem, share: f64, rng: &mut Rng) -> Vec<f64> {
    let draw = |[lower, upper]: [f64; 2]| {
        let middle = f64::midpoint(lower, upper);
        middle + share * (rng.uniform(lower, upper) - middle)
    };
    problem.bounds().iter().map(draw).collect()
}

/// The paper's task, and turns of other arms.
fn tasks(terms: usize) -> Vec<(&'static str, Arc<Reorientation>, Boxes)> {
    let read = |name, document: &Document| {
        let file = TaskFile::read(document).unwrap();
        let (problem, boxes) = file.build(document).unwrap();
        (name, Arc::new(problem), boxes)
    };
    let paper = Document::embedded("paper", &format!("[trajectory]\nterms = {terms}\n"));
    let others = [("ur5", "tests/robots/ur5-turn.toml"), ("iiwa", "tests/robots/iiwa-turn.toml")];
    let others = others.map(|(name, path)| read(name, &Document::read(Path::new(path)).unwrap()));
    [read("paper", &paper)].into_iter().chain(others).collect()
}

#[test]
fn of_test_functions() {
    let (mut tally, mut rng) = (Tally::default(), Rng::new(1));
    for function in TestFunction::ALL {
        for (dimension, instance) in [(2, 0), (3, 1), (10, 2)] {
            let problem = Analytic::new(function, dimension, instance);
            for _ in 0..5 {
                let x = point(&problem, 0.9, &mut rng);
                tally.check(&problem, &x, &format!("{function:?} {dimension}"));
            }
        }
    }
    tally.end(400);
}

/// Durations far too short, too, so that limits of all orders are exceeded. Points of `raw` are those of `scaled` in other
/// variables: nearly all of its box is far from any motion.
#[test]
fn of_sine_polynomials_in_every_formulation() {
    let mut rng = Rng::new(2);
    for formulation in Formulation::ALL {
        let (mut tally, mut far_out) = (Tally::default(), 0);
        for terms in [1, 2, 4] {
            for (name, task, boxes) in tasks(terms) {
                let formulated = |f| Formulated::new(f, task.clone(), &boxes).unwrap();
                let (problem, scaled) = (formulated(formulation), formulated(Formulation::Scaled));
                let name = format!("{name} {}", formulation.name());
                for share in [0.0, 0.2, 0.5, 0.9] {
                    let violation = if formulation == Formulation::Raw {
                        let z = point(&scaled, share, &mut rng);
                        let raw = |z: &[f64]| {
                            let (coefficients, duration) = scaled.decode(z);
                            problem.encode(&coefficients, duration.unwrap())
                        };
                        tally.check_along(&problem, scaled.bounds(), &z, &raw, &name);
                        problem.evaluate(&raw(&z)).unwrap().violation
                    } else {
                        let x = point(&problem, share, &mut rng);
                        tally.check(&problem, &x, &name);
                        problem.evaluate(&x).unwrap().violation
                    };
                    far_out += usize::from(violation > 1.0);
                }
            }
        }
        tally.end(400);
        assert_eq!(far_out > 5, formulation != Formulation::TimeFree, "{far_out}");
    }
}

/// Also where a joint leaves its range.
#[test]
fn of_splines() {
    let (mut tally, mut rng, mut left) = (Tally::default(), Rng::new(3), 0);
    for (name, task, _) in tasks(2) {
        for (degree, pieces) in [(3, 8), (4, 9), (5, 7)] {
            let ends = (&task.task().start.joints, &task.task().goal.joints);
            let family = Spline::new(ends.0, ends.1, pieces, degree);
            let accuracy = Accuracy { attitude_steps: 24, peak_intervals: 1 };
            let task = Reorientation::over(task.task().clone(), family, accuracy);
            let problem = Formulated::free_form(Arc::new(task)).unwrap();
            for share in [0.1, 0.5, 1.0] {
                let mut x = point(&problem, share, &mut rng);
                if share == 1.0 {
                    let upper = problem.bounds().iter().map(|[_, upper]| upper);
                    x.iter_mut().zip(upper).take(3).for_each(|(x, upper)| *x = upper);
                }
                tally.check(&problem, &x, &format!("{name}, degree {degree}"));
                left += usize::from(problem.evaluate(&x).unwrap().violation > 0.0);
            }
        }
    }
    tally.end(700);
    assert!(left > 3, "{left}");
}

/// What tasks may ask for on the way, each narrow enough to be broken.
const ON_THE_WAY: [&str; 10] = [
    "limits = { base_turn_deg = 9 }\n",
    "limits = { base_turn_deg = 19, base_turn_from = 'start' }\n",
    "limits = { base_cone = [\n\
     { axis = [0, 0, 1], from = [0.1, 0.2, 1], within_deg = 22 },\n\
     { axis = [1, 0, 0], from = [0.4, 0.3, 0.5], outside_deg = 35 }] }\n",
    "limits = { base_rate_deg_s = 0.5 }\n",
    "limits = { tool_speed_m_s = 0.2 }\n",
    "limits = { torque_n_m = [40, 60, 50, 20, 3, 1] }\n",
    "limits = { clearance_m = 0.15 }\n",
    "[task.keep_out.target]\nshapes = [{ sphere = { centre = [0.9, -1.1, 2.2], radius = 0.3 } }]\n\
     [task.keep_out.antenna]\nframe = 'base'\n\
     shapes = [{ box = { centre = [0.5, 0.5, 1.6], size = [0.4, 0.3, 0.6], zyx_deg = [20, 30, 40] } }]\n",
    "weights = { largest_turn = 0.2 }\n",
    "weights = { mean_turn = 0.3 }\n",
];

#[test]
fn of_what_is_asked_for_on_the_way() {
    let (mut rng, mut broken) = (Rng::new(4), 0);
    for asked in ON_THE_WAY {
        let mut tally = Tally::default();
        let document = Document::embedded("task", &format!("[task]\n{asked}"));
        let file = TaskFile::read(&document).unwrap_or_else(|error| panic!("{error:?}"));
        let (task, boxes) = file.build(&document).unwrap();
        let task = Arc::new(task);
        let ends = (&task.task().start.joints, &task.task().goal.joints);
        let family = Spline::new(ends.0, ends.1, 9, 3);
        let accuracy = Accuracy { attitude_steps: 24, peak_intervals: 1 };
        let spline = Arc::new(Reorientation::over(task.task().clone(), family, accuracy));
        let splines = Formulated::free_form(spline).unwrap();
        let sines = Formulation::ALL.map(|f| Formulated::new(f, task.clone(), &boxes).unwrap());
        let [_, scaled, time_free] = &sines;
        let problems: [&dyn Problem; 3] = [scaled, time_free, &splines];
        for (k, problem) in problems.into_iter().enumerate() {
            for share in [0.1, 0.3, 0.5, 0.8] {
                let x = point(problem, share, &mut rng);
                tally.check(problem, &x, &format!("{asked}, {k}, {share}"));
                broken += usize::from(problem.evaluate(&x).unwrap().violation > 0.0);
            }
        }
        tally.end(150);
    }
    assert!(broken > 20, "{broken}");
}

/// One evaluation and one linearisation each, within the budget.
#[test]
fn are_counted() {
    let (problem, watch) = (Analytic::new(TestFunction::Sphere, 3, 0), Watch::default());
    let mut oracle = Oracle::new(&problem, 2, &watch);
    oracle.evaluate(&[3.0; 3]).unwrap();
    let found = oracle.subgradient(&[1.0, 2.0, -0.5]).unwrap();
    assert_eq!((found.evaluation.cost, found.slopes.as_slice()), (5.25, &[2.0, 4.0, -1.0][..]));
    assert_eq!((oracle.evaluations(), oracle.linearisations()), (2, 1));
    assert_eq!(oracle.best().unwrap().evaluation.cost, 5.25);
    assert_eq!(oracle.subgradient(&[0.0; 3]), Err(Stop::BudgetSpent));
}
