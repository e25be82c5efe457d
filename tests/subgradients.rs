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
