//! `scp` on costs of any terms, where the minimum is known in closed form or from the literature.

use driftless::optimiser::{Ending, Scp};
use driftless::search::{
    Bounds, Composite, Evaluation, Failure, Linearisation, Multipliers, Oracle, Piece, Problem,
    Rng, Shape, Term, Watch,
};
use nalgebra::{DMatrix, DVector};

/// `c + b · x + xᵀ diag(a) x`.
#[derive(Clone)]
struct Quadratic {
    a: Vec<f64>,
    b: Vec<f64>,
    c: f64,
}

fn quadratic<const N: usize>(a: [f64; N], b: [f64; N], c: f64) -> Quadratic {
    Quadratic { a: a.to_vec(), b: b.to_vec(), c }
}

/// `s x_j + c` of `n` variables.
fn linear(n: usize, j: usize, s: f64, c: f64) -> Quadratic {
    let mut b = vec![0.0; n];
    b[j] = s;
    Quadratic { a: vec![0.0; n], b, c }
}

/// The components of `x − a`.
fn from(a: &[f64]) -> Vec<Quadratic> {
    a.iter().enumerate().map(|(j, a_j)| linear(a.len(), j, 1.0, -a_j)).collect()
}

/// `x_j` and `−x_j` for all `n` variables.
fn both_signs(n: usize) -> Vec<Quadratic> {
    (0..n).flat_map(|j| [linear(n, j, 1.0, 0.0), linear(n, j, -1.0, 0.0)]).collect()
}

/// Weighted functions of quadratics.
struct Sum {
    bounds: Bounds,
    terms: Vec<(f64, Shape, Vec<Quadratic>)>,
}

impl Quadratic {
    fn piece(&self, track: u64, x: &[f64]) -> Piece {
        let each = self.a.iter().zip(&self.b).zip(x);
        let value = self.c + each.clone().map(|((a, b), x)| (a * x + b) * x).sum::<f64>();
        let gradient: Vec<f64> = each.map(|((a, b), x)| 2.0 * a * x + b).collect();
        Piece::new(track, value, gradient)
    }
}

impl Problem for Sum {
    fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    fn evaluate(&self, x: &[f64]) -> Result<Evaluation, Failure> {
        Ok(self.linearise(x)?.cost().into())
    }

    fn composite(&self) -> Option<&dyn Composite> {
        Some(self)
    }
}

impl Composite for Sum {
    fn linearise(&self, x: &[f64]) -> Result<Linearisation, Failure> {
        let term = |(weight, shape, pieces): &(f64, Shape, Vec<Quadratic>)| {
            let term = match shape {
                Shape::Norm => Term::norm,
                Shape::Max => Term::max,
                Shape::Hinge => Term::hinge,
            };
            let pieces = pieces.iter().zip(0..).map(|(q, track)| q.piece(track, x));
            term(*weight, pieces.collect())
        };
        Ok(Linearisation::new(self.terms.iter().map(term).collect()))
    }

    fn curvature(&self, x: &[f64], multipliers: &Multipliers) -> Result<DMatrix<f64>, Failure> {
        let mut diagonal = DVector::zeros(x.len());
        for ((_, _, pieces), weighed) in self.terms.iter().zip(&multipliers.terms) {
            for (id, lambda) in weighed {
                let a = &pieces[id.track as usize].a;
                diagonal += DVector::from_column_slice(a) * (2.0 * lambda);
            }
        }
        Ok(DMatrix::from_diagonal(&diagonal))
    }
}

/// Follows ten random starts in a box of half-width 3 about `centre`, all of which end at the minimum.
fn check(
    name: &str,
    terms: Vec<(f64, Shape, Vec<Quadratic>)>,
    centre: &[f64],
    x: &[f64],
    cost: f64,
) {
    let bounds = centre.iter().map(|c| [c - 3.0, c + 3.0]).collect();
    let problem = Sum { bounds: Bounds::new(bounds).unwrap(), terms };
    for seed in 1..=10 {
        let watch = Watch::default();
        let mut oracle = Oracle::new(&problem, 2_000, &watch);
        let mut rng = Rng::new(seed);
        let start: Vec<f64> = problem.bounds.iter().map(|[l, u]| rng.uniform(l, u)).collect();
        let ending = Scp::default().follow(&mut oracle, &start);
        let (best, steps) = (oracle.best().unwrap(), oracle.linearisations());
        let found = best.evaluation.cost;
        assert!(
            (found - cost).abs() < 1e-6,
            "{name}, seed {seed}: {found}, not {cost}; {ending:?}"
        );
        let distance = best.x.iter().zip(x).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(distance < 1e-2, "{name}, seed {seed}: {:?}", best.x);
        assert_eq!(ending, Ok(Ending::Optimal), "{name}, seed {seed}, {steps} steps");
    }
}

/// A norm is exact where it weighs more than the slope of the rest, here ½ against 1.
#[test]
fn a_norm_and_a_maximum() {
    let a = [1.0, 0.5];
    for (weight, x, cost) in [(0.5, a, 0.5), (2.0, [0.0; 2], 1.25_f64.sqrt())] {
        let terms = vec![(1.0, Shape::Norm, from(&a)), (weight, Shape::Max, both_signs(2))];
        check("norm and maximum", terms.clone(), &[0.3, -0.4], &x, cost);
        check("maximum and norm", terms.into_iter().rev().collect(), &[0.3, -0.4], &x, cost);
    }
}

/// `½ ‖x − a‖² + w ‖x‖₁` is least at the soft threshold of `a`.
#[test]
fn a_lasso_of_hinges() {
    let (a, w) = ([2.0, -0.3, 0.6, -1.5], 0.5);
    let x = a.map(|a: f64| a.signum() * (a.abs() - w).max(0.0));
    let square = quadratic([0.5; 4], a.map(|a| -a), a.iter().map(|a| a * a / 2.0).sum());
    let cost = x.iter().zip(a).map(|(x, a)| (x - a).powi(2) / 2.0 + w * x.abs()).sum();
    let terms = vec![(1.0, Shape::Max, vec![square]), (w, Shape::Hinge, both_signs(4))];
    check("lasso", terms, &[0.1; 4], &x, cost);
}

/// The heavier of two points is nearest to both; of an equilateral triangle's corners the centre is.
#[test]
fn several_norms() {
    let (a, b) = ([1.0, 2.0], [-0.5, 0.0]);
    let terms = vec![(1.0, Shape::Norm, from(&a)), (2.0, Shape::Norm, from(&b))];
    check("two norms", terms, &[0.0; 2], &b, 2.5);
    let root = 3.0_f64.sqrt();
    let corners = [[1.0, 0.0], [-0.5, root / 2.0], [-0.5, -root / 2.0]];
    let terms = corners.iter().map(|corner| (1.0, Shape::Norm, from(corner)));
    check("three norms", terms.collect(), &[0.4, 0.3], &[0.0; 2], 3.0);
}

/// The distance from `a` to the half-space `x_0 ≤ 0`, and the rest of the way for a weak hinge.
#[test]
fn a_norm_and_hinges() {
    let a = [1.0, -2.0];
    let terms =
        |w| vec![(1.0, Shape::Norm, from(&a)), (w, Shape::Hinge, vec![linear(2, 0, 1.0, 0.0)])];
    check("strong hinge", terms(3.0), &[0.5, 0.0], &[0.0, -2.0], 1.0);
    check("weak hinge", terms(0.3), &[0.5, 0.0], &a, 0.3);
}

/// Condition number 10⁴; the least value is negative.
#[test]
fn a_smooth_function_alone() {
    let smooth = quadratic([1.0, 100.0, 1e4], [-2.0, 100.0, 0.0], -30.0);
    check("quadratic", vec![(2.0, Shape::Max, vec![smooth])], &[0.3; 3], &[1.0, -0.5, 0.0], -112.0);
}

/// The least of `x + y` on a circle of radius √2, as an exact penalty; the multiplier is ½.
#[test]
fn a_curved_constraint() {
    let sum = quadratic([0.0; 2], [1.0; 2], 0.0);
    let circle = quadratic([1.0; 2], [0.0; 2], -2.0);
    for shape in [Shape::Norm, Shape::Hinge] {
        let terms = vec![(1.0, Shape::Max, vec![sum.clone()]), (10.0, shape, vec![circle.clone()])];
        check("circle", terms, &[-1.2, -0.8], &[-1.0; 2], -2.0);
    }
}

/// Squares against hinges that are strong enough to hold `x_0 ≥ 1`, and not.
#[test]
fn hinges_as_constraints() {
    let terms = |w| {
        let square = quadratic([1.0; 2], [0.0; 2], 0.0);
        vec![(1.0, Shape::Max, vec![square]), (w, Shape::Hinge, vec![linear(2, 0, -1.0, 1.0)])]
    };
    check("held", terms(5.0), &[0.5, 0.2], &[1.0, 0.0], 1.0);
    check("not held", terms(1.0), &[0.5, 0.2], &[0.5, 0.0], 0.75);
}

/// Rosen and Suzuki's problem as a minimax: Lukšan and Vlček (2000), Test Problems for Nonsmooth
/// Unconstrained and Linearly Constrained Optimization, problem 2.3.
#[test]
fn rosen_and_suzuki() {
    let f = quadratic([1.0, 1.0, 2.0, 1.0], [-5.0, -5.0, -21.0, 7.0], 0.0);
    let penalised = |a: [f64; 4], b: [f64; 4], c: f64| Quadratic {
        a: f.a.iter().zip(a).map(|(f, a)| f + 10.0 * a).collect(),
        b: f.b.iter().zip(b).map(|(f, b)| f + 10.0 * b).collect(),
        c: 10.0 * c,
    };
    let pieces = vec![
        f.clone(),
        penalised([1.0; 4], [1.0, -1.0, 1.0, -1.0], -8.0),
        penalised([1.0, 2.0, 1.0, 2.0], [-1.0, 0.0, 0.0, -1.0], -10.0),
        penalised([2.0, 1.0, 1.0, 0.0], [2.0, -1.0, 0.0, -1.0], -5.0),
    ];
    let terms = vec![(1.0, Shape::Max, pieces)];
    check("Rosen–Suzuki", terms, &[0.5, 0.5, 0.5, 0.5], &[0.0, 1.0, 2.0, -1.0], -44.0);
}

/// Terms without pieces, and of no weight, cost nothing and hurt nothing.
#[test]
fn terms_may_be_empty() {
    let square = quadratic([1.0; 2], [0.0; 2], 1.0);
    let terms = vec![
        (1.0, Shape::Norm, vec![]),
        (1.0, Shape::Max, vec![square]),
        (2.0, Shape::Max, vec![]),
        (2.0, Shape::Hinge, vec![]),
        (0.0, Shape::Norm, from(&[1.0, 1.0])),
        (0.0, Shape::Hinge, both_signs(2)),
    ];
    check("empty", terms, &[0.3; 2], &[0.0; 2], 1.0);
}
