//! What every optimiser promises that needs no more than a subgradient, whatever the problem.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use driftless::functions::{Analytic, TestFunction};
use driftless::optimiser::Settings;
use driftless::search::{Best, Oracle, Rng, Stop, Watch};
use driftless::search::{
    Bounds, Composite, Differentiable, Evaluation, Failure, Linearisation, Multipliers, Piece,
    PieceId, Problem, Slopes, Subgradient, Term,
};
use nalgebra::{DMatrix, DVector};

/// The cost to give at a point instead of the right one, if any.
type Spoilt = fn(&[f64]) -> Option<f64>;

/// A test function that watches who asks what.
struct Watched {
    inner: Analytic,
    spoilt: Spoilt,
    calls: AtomicU64,
    left_the_box: AtomicBool,
}

impl Watched {
    fn new(function: TestFunction, dimension: usize) -> Self {
        Self {
            inner: Analytic::new(function, dimension, 1),
            spoilt: |_| None,
            calls: AtomicU64::new(0),
            left_the_box: AtomicBool::new(false),
        }
    }
}

impl Problem for Watched {
    fn bounds(&self) -> &Bounds {
        self.inner.bounds()
    }

    fn evaluate(&self, x: &[f64]) -> Result<Evaluation, Failure> {
        self.calls.fetch_add(1, Ordering::Relaxed);
        if !self.bounds().contains(x) {
            self.left_the_box.store(true, Ordering::Relaxed);
        }
        let own = self.inner.evaluate(x)?;
        Ok((self.spoilt)(x).map_or(own, |cost| Evaluation { cost, ..own }))
    }

    fn slopes(&self) -> Option<Slopes<'_>> {
        Some(Slopes::Own(self))
    }
}

impl Differentiable for Watched {
    fn subgradient(&self, x: &[f64]) -> Result<Subgradient, Failure> {
        let evaluation = self.evaluate(x)?;
        Ok(Subgradient { evaluation, ..self.inner.subgradient(x)? })
    }
}

/// `Σ x_j²`, a maximum of one piece, with derivatives; one call may fail.
struct SumOfSquares {
    bounds: Bounds,
    fails_at: u64,
    calls: AtomicU64,
}

impl SumOfSquares {
    fn call(&self) -> Result<(), Failure> {
        let call = self.calls.fetch_add(1, Ordering::Relaxed) + 1;
        if call == self.fails_at { Err("enough".into()) } else { Ok(()) }
    }
}

impl Problem for SumOfSquares {
    fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    fn evaluate(&self, x: &[f64]) -> Result<Evaluation, Failure> {
        self.call()?;
        Ok(x.iter().map(|x| x * x).sum::<f64>().into())
    }

    fn composite(&self) -> Option<&dyn Composite> {
        Some(self)
    }
}

impl Composite for SumOfSquares {
    fn linearise(&self, x: &[f64]) -> Result<Linearisation, Failure> {
        self.call()?;
        let x = DVector::from_column_slice(x);
        let piece = Piece { id: PieceId::alone(0), value: x.norm_squared(), gradient: 2.0 * &x };
        Ok(Linearisation::new(vec![Term::max(1.0, vec![piece])]))
    }

    fn curvature(&self, x: &[f64], multipliers: &Multipliers) -> Result<DMatrix<f64>, Failure> {
        let lambda: f64 = multipliers.terms[0].iter().map(|(_, lambda)| lambda).sum();
        Ok(DMatrix::from_diagonal_element(x.len(), x.len(), 2.0 * lambda))
    }
}

/// All but those that need a cost's terms.
fn field() -> Vec<Settings> {
    let problem = Watched::new(TestFunction::Sphere, 2);
    Settings::all().into_iter().filter(|s| s.optimiser().lacks(&problem).is_none()).collect()
}

/// What a run left behind.
struct Run {
    stop: Result<(), Stop>,
    best: Option<Best>,
    evaluations: u64,
    trace: Vec<(u64, f64)>,
}

/// Runs, and checks what must hold of every run.
fn run(settings: &Settings, problem: &Watched, budget: u64, seed: u64) -> Run {
    problem.calls.store(0, Ordering::Relaxed);
    let watch = Watch::default();
    let mut oracle = Oracle::new(problem, budget, &watch);
    let stop = settings.optimiser().minimise(&mut oracle, &mut Rng::new(seed));
    let evaluations = oracle.evaluations();
    let (name, calls) = (settings.name(), problem.calls.load(Ordering::Relaxed));
    assert_eq!(evaluations, calls, "{name} with a budget of {budget}");
    assert!(evaluations <= budget, "{name}: {evaluations} of {budget}");
    assert!(!problem.left_the_box.load(Ordering::Relaxed), "{name} left the box");
    let best = oracle.best().cloned();
    let trace = oracle.into_trace();
    let trace = trace.iter().map(|point| (point.evaluation, point.best.cost)).collect();
    Run { stop, best, evaluations, trace }
}

fn best_cost(run: &Run) -> f64 {
    run.best.as_ref().map_or(f64::INFINITY, |best| best.evaluation.cost)
}

/// Minima are zero. Random search comes near none of them; every other method finds them all, but for
/// two of which that is not certain: a swarm creeps along the axes of an ellipsoid, and a small
/// population of differential evolution can stop short in a bent valley.
#[test]
fn minima_are_found_by_those_who_should() {
    use TestFunction::{Ellipsoid, Rastrigin, Rosenbrock, Sphere};
    let uncertain = [("pso", Ellipsoid), ("de", Rosenbrock)];
    for settings in field() {
        let name = settings.name();
        for (function, n) in [(Sphere, 4), (Ellipsoid, 4), (Rosenbrock, 3), (Rastrigin, 2)] {
            for seed in 1..=3 {
                let cost = best_cost(&run(&settings, &Watched::new(function, n), 40_000, seed));
                if !uncertain.contains(&(name, function)) {
                    assert_eq!(cost < 1e-6, name != "random", "{name}, {function:?}: {cost:e}");
                }
            }
        }
    }
}

/// A run ends within its budget, and spends it all; only a swarm may rest before.
#[test]
fn budgets_are_kept() {
    let problem = Watched::new(TestFunction::Rastrigin, 3);
    for settings in field() {
        for budget in (1..=50).chain([149, 150, 151, 997, 3_000]) {
            let run = run(&settings, &problem, budget, 1);
            assert_eq!(run.evaluations, budget, "{}", settings.name());
            assert!(run.stop == Err(Stop::BudgetSpent) || settings.name() == "pso");
        }
    }
}

#[test]
fn every_number_of_variables_will_do() {
    for settings in field() {
        for dimension in [1, 2, 7] {
            let problem = Watched::new(TestFunction::Sphere, dimension);
            let run = run(&settings, &problem, 3_000, 1);
            let first = run.trace[0].1;
            assert!(best_cost(&run) < first, "{} in {dimension} variables", settings.name());
        }
    }
}

#[test]
fn equal_seeds_give_equal_traces() {
    let problem = Watched::new(TestFunction::Rosenbrock, 5);
    for settings in field() {
        let [one, again, other] = [1, 1, 2].map(|seed| run(&settings, &problem, 4_000, seed).trace);
        assert_eq!(one, again, "{}", settings.name());
        assert_ne!(one, other, "{}", settings.name());
    }
}

/// Where the problem is undefined nothing panics, nothing hangs, and nothing counts as a find.
#[test]
fn costs_that_are_no_numbers_are_never_best() {
    let spoilings: [Spoilt; 6] = [
        |_| Some(f64::NAN),
        |_| Some(f64::INFINITY),
        |x| (x[0] > 0.0).then_some(f64::NAN),
        |x| (x[0] > 0.0).then_some(f64::INFINITY),
        |x| (x[1].to_bits() % 2 == 0).then_some(f64::NAN),
        |x| (x[1].to_bits() % 2 == 0).then_some(f64::INFINITY),
    ];
    for settings in field() {
        for (i, spoilt) in spoilings.into_iter().enumerate() {
            let problem = Watched { spoilt, ..Watched::new(TestFunction::Sphere, 3) };
            let run = run(&settings, &problem, 5_000, 1);
            assert_eq!(run.evaluations, 5_000, "{}, case {i}", settings.name());
            match run.best {
                None => assert!(i < 2, "{}, case {i}: nothing found", settings.name()),
                Some(best) => {
                    assert!(best.evaluation.cost.is_finite() && spoilt(&best.x).is_none());
                    assert_eq!(problem.inner.evaluate(&best.x), Ok(best.evaluation));
                }
            }
        }
    }
}

/// The second of three variables is fixed, or all of them are.
#[test]
fn variables_may_be_fixed() {
    let some = vec![[-2.0, 1.0], [0.5, 0.5], [-1.0, 2.0]];
    for (pairs, least) in [(some, 0.25), (vec![[0.5, 0.5]; 2], 0.5), (vec![[-1.0, 2.0]], 0.0)] {
        let problem =
            SumOfSquares { bounds: Bounds::new(pairs).unwrap(), fails_at: 0, calls: 0.into() };
        for settings in Settings::all() {
            let watch = Watch::default();
            let mut oracle = Oracle::new(&problem, 3_000, &watch);
            let stop = settings.optimiser().minimise(&mut oracle, &mut Rng::new(1));
            let name = settings.name();
            assert!(matches!(stop, Ok(()) | Err(Stop::BudgetSpent)), "{name}: {stop:?}");
            let best = oracle.best().unwrap();
            assert!(problem.bounds.contains(&best.x), "{name}: {:?}", best.x);
            let allowed = if name == "random" { 0.1 } else { 1e-3 };
            let cost = best.evaluation.cost;
            assert!(cost < least + allowed, "{name}: {cost}, not {least}");
        }
    }
}

#[test]
fn a_problem_that_fails_ends_the_run() {
    for settings in Settings::all() {
        for fails_at in [1, 2, 7, 64, 65, 200] {
            let bounds = Bounds::cube(3, [-2.0, 1.0]);
            let problem = SumOfSquares { bounds, fails_at, calls: 0.into() };
            let watch = Watch::default();
            let mut oracle = Oracle::new(&problem, 3_000, &watch);
            let stop = settings.optimiser().minimise(&mut oracle, &mut Rng::new(1));
            let name = settings.name();
            assert_eq!(stop, Err(Stop::Failed("enough".into())), "{name} {fails_at}");
            assert_eq!(oracle.evaluations(), fails_at, "{name}");
            assert_eq!(oracle.best().is_some(), fails_at > 1, "{name}");
        }
    }
}
