//! Searches that begin on a relaxed problem, with fewer limits.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicU64, Ordering};

use driftless::optimiser::{Optimiser, Scp};
use driftless::search::{
    Bend, Bent, Bounds, ErrorSlopes, Evaluation, Failure, LinearLimit, LinearLimits, Oracle, Piece,
    Problem, Rng, Term, Timed, TimedWeights, Watch,
};
use nalgebra::{DMatrix, DVector};

const VARIABLES: usize = 6;

/// What a hill adds at its top, where that is, and its width.
const HEIGHT: f64 = 5.0;
const TOP: f64 = 1.0;
const WIDTH: f64 = 0.2;

/// `1 + |x_0| + ‖(x_1, …)‖ + 5 exp(−½ ((x_0 − 1) / 0.2)²)`, or the same without the last term, the hill. All starts are to the
/// right of the hill and the least cost to its left.
struct Hill {
    bounds: Bounds,
    relaxed: Option<Box<Self>>,
    is_high: bool,
    asked: AtomicU64,
}

impl Hill {
    fn new(is_high: bool, relaxed: Option<Self>) -> Self {
        let bounds = Bounds::cube(VARIABLES, [-2.0, 2.0]);
        Self { bounds, relaxed: relaxed.map(Box::new), is_high, asked: AtomicU64::new(0) }
    }

    fn asked(&self) -> u64 {
        self.asked.load(Ordering::Relaxed)
    }

    /// What `scp` comes to, and after how many evaluations.
    fn solve(&self, starts: usize) -> (Vec<f64>, f64, u64) {
        let watch = Watch::default();
        let mut oracle = Oracle::new(self, 10_000, &watch);
        let scp = Scp { starts: NonZeroUsize::new(starts), ..Scp::default() };
        assert_eq!(scp.minimise(&mut oracle, &mut Rng::new(1)), Ok(()));
        let best = oracle.best().unwrap();
        (best.x.clone(), best.evaluation.cost, oracle.evaluations())
    }
}

impl Problem for Hill {
    fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    fn evaluate(&self, x: &[f64]) -> Result<Evaluation, Failure> {
        Ok(self.weights().evaluation(&self.parts(x)?))
    }

    fn timed(&self) -> Option<&dyn Timed> {
        Some(self)
    }

    fn relaxed(&self) -> Option<&dyn Problem> {
        self.relaxed.as_deref().map(|relaxed| relaxed as &dyn Problem)
    }
}

impl Timed for Hill {
    fn limits(&self, x: &[f64]) -> Result<LinearLimits, Failure> {
        let limit = |(id, sign): (u32, f64)| {
            let mut slopes = [0.0; LinearLimit::MOST];
            slopes[0] = sign;
            LinearLimit { id: Some(id), power: 1, value: 1.0 + sign * x[0], first: 0, slopes }
        };
        let list = [(0, 1.0), (1, -1.0)].map(limit).to_vec();
        Ok(LinearLimits { time: 1.0 + x[0].abs(), excess: 0.0, list })
    }

    fn error(&self, x: &[f64]) -> Result<ErrorSlopes, Failure> {
        self.asked.fetch_add(1, Ordering::Relaxed);
        let slopes =
            DMatrix::from_fn(VARIABLES - 1, VARIABLES, |i, j| if i + 1 == j { 1.0 } else { 0.0 });
        Ok(ErrorSlopes { value: DVector::from_column_slice(&x[1..]), slopes })
    }

    fn bent(&self, x: &[f64]) -> Result<Bent, Failure> {
        if !self.is_high {
            return Ok(Bent::default());
        }
        let z = (x[0] - TOP) / WIDTH;
        let height = HEIGHT * (-z * z / 2.0).exp();
        let mut gradient = vec![0.0; VARIABLES];
        gradient[0] = -z / WIDTH * height;
        let hill = Term::max(1.0, vec![Piece::new(0, height, gradient)]).at_least(0.0);
        Ok(Bent::new(Vec::new(), vec![hill], 0.0))
    }

    fn bends(&self, _: &[f64]) -> Result<Vec<Bend>, Failure> {
        Ok(Vec::new())
    }

    fn weights(&self) -> TimedWeights {
        TimedWeights { time: 1.0, error: 1.0, excess: 1.0 }
    }

    fn start(&self, rng: &mut Rng, _: f64) -> Vec<f64> {
        let mut x = vec![0.1; VARIABLES];
        x[0] = rng.uniform(1.7, 2.0);
        x
    }
}

#[test]
fn scp_goes_on_under_the_limits_from_where_the_relaxed_problem_led_it() {
    let problem = Hill::new(true, Some(Hill::new(false, None)));
    let (x, cost, evaluations) = problem.solve(9);
    let relaxed = problem.relaxed.as_ref().unwrap().asked();
    assert!(relaxed > 0);
    assert_eq!(evaluations, problem.asked() + relaxed);
    // The hill's slope at zero is far less than that of |x_0|.
    let least = 1.0 + HEIGHT * (-0.5 * (TOP / WIDTH).powi(2)).exp();
    assert!((cost - least).abs() < 1e-6, "{cost}, expected {least}");
    assert!(x.iter().all(|x| x.abs() < 1e-6), "{x:?}");
}

#[test]
fn the_hill_is_in_the_way_of_a_search_that_does_not_begin_on_the_relaxed_problem() {
    let (x, cost, _) = Hill::new(true, None).solve(9);
    assert!(x[0] > TOP && cost > 1.0 + TOP, "{x:?}, {cost}");
    // Nor are two starts worth one.
    let problem = Hill::new(true, Some(Hill::new(false, None)));
    let (x, ..) = problem.solve(2);
    assert!(x[0] > TOP, "{x:?}");
    assert_eq!(problem.relaxed.as_ref().unwrap().asked(), 0);
}
