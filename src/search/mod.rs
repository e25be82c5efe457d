//! What a search is: a problem in a box, and the oracle through which alone it is asked.
//!
//! A [`Problem`] has [`Bounds`] and gives every point of them an [`Evaluation`], a cost and by how much limits are
//! violated, or a [`Failure`], which ends the run. An optimiser asks the [`Oracle`], which counts, keeps the
//! best and the trace, and says when to [`Stop`].
//!
//! ```
//! use driftless::optimiser::{De, Optimiser};
//! use driftless::search::{Bounds, Evaluation, Failure, Oracle, Problem, Rng, Stop, Watch};
//!
//! /// `(x − 1)² + y²`
//! struct Bowl(Bounds);
//!
//! impl Problem for Bowl {
//!     fn bounds(&self) -> &Bounds {
//!         &self.0
//!     }
//!
//!     fn evaluate(&self, x: &[f64]) -> Result<Evaluation, Failure> {
//!         Ok(((x[0] - 1.0).powi(2) + x[1].powi(2)).into())
//!     }
//! }
//!
//! let bowl = Bowl(Bounds::new(vec![[-5.0, 5.0], [-2.0, 2.0]])?);
//! let watch = Watch::default();
//! let mut oracle = Oracle::new(&bowl, 2_000, &watch);
//! let stop = De::default().minimise(&mut oracle, &mut Rng::new(1));
//! assert_eq!(stop, Err(Stop::BudgetSpent));
//! assert!(oracle.best().unwrap().evaluation.cost < 1e-6);
//! # Ok::<(), driftless::search::BoundsError>(())
//! ```
//!
//! # Derivatives
//!
//! A cost is seldom smooth, but often a sum of convex functions of smooth ones. Such a problem is
//! [`Composite`]. With pieces `v_ki` that are smooth, its cost is
//!
//! ```text
//! J(x) = Σ_k w_k φ_k(v_k(x)),    φ(v) = ‖v‖, max_i v_i or Σ_i max(0, v_i),    w_k ≥ 0
//! ```
//!
//! one [`Term`] for each `k`, whose [`Shape`] is `φ_k`. Each shape is the largest of linear functions of `v`,
//! so at a minimum in the box's interior there are multipliers `λ` with
//!
//! ```text
//! Σ_k Σ_i λ_ki ∇v_ki = 0,    λ_k ∈ w_k ∂φ_k(v_k)
//!
//! norm     ‖λ_k‖ ≤ w_k, and λ_k = w_k v_k / ‖v_k‖ where v_k is not zero
//! max      λ_ki ≥ 0, Σ_i λ_ki = w_k, and λ_ki = 0 where v_ki is not the largest
//! hinge    0 ≤ λ_ki ≤ w_k, λ_ki = w_k above zero and 0 below
//! ```
//!
//! A smooth cost is a maximum of one piece, a constraint `h(x) ≤ 0` a hinge and `r(x) = 0` a norm, of a
//! weight above its multiplier. An optimiser asks for values and gradients of the pieces
//! ([`Linearisation`]) and for the second derivative of `Σ λ_ki v_ki` ([`Multipliers`]).
//!
//! ```
//! use driftless::optimiser::{Optimiser, Scp};
//! use driftless::search::{
//!     Bounds, Composite, Evaluation, Failure, Linearisation, Multipliers, Oracle, Piece, Problem,
//!     Rng, Term, Watch,
//! };
//! use nalgebra::DMatrix;
//!
//! /// `x + y` as low as it gets on the circle `x² + y² = 2`.
//! struct Circle(Bounds);
//!
//! impl Problem for Circle {
//!     fn bounds(&self) -> &Bounds {
//!         &self.0
//!     }
//!
//!     fn evaluate(&self, x: &[f64]) -> Result<Evaluation, Failure> {
//!         Ok(self.linearise(x)?.cost().into())
//!     }
//!
//!     fn composite(&self) -> Option<&dyn Composite> {
//!         Some(self)
//!     }
//! }
//!
//! impl Composite for Circle {
//!     fn linearise(&self, x: &[f64]) -> Result<Linearisation, Failure> {
//!         let sum = Piece::new(0, x[0] + x[1], [1.0, 1.0]);
//!         let circle = Piece::new(0, x[0] * x[0] + x[1] * x[1] - 2.0, [2.0 * x[0], 2.0 * x[1]]);
//!         Ok(Linearisation::new(vec![Term::max(1.0, vec![sum]), Term::norm(10.0, vec![circle])]))
//!     }
//!
//!     fn curvature(&self, _: &[f64], multipliers: &Multipliers) -> Result<DMatrix<f64>, Failure> {
//!         // The sum has none.
//!         let lambda: f64 = multipliers.terms[1].iter().map(|(_, lambda)| lambda).sum();
//!         Ok(DMatrix::from_diagonal_element(2, 2, 2.0 * lambda))
//!     }
//! }
//!
//! let circle = Circle(Bounds::cube(2, [-3.0, 3.0]));
//! let watch = Watch::default();
//! let mut oracle = Oracle::new(&circle, 500, &watch);
//! let _ = Scp::default().minimise(&mut oracle, &mut Rng::new(1));
//! assert!((oracle.best().unwrap().evaluation.cost + 2.0).abs() < 1e-8);
//!
//! // The norm grows by 10 · 2 x along x, the sum by one.
//! let there = circle.slopes().unwrap().at(&[2.0, 0.0])?;
//! assert_eq!((there.evaluation.cost, there.slopes[0], there.slopes[1]), (22.0, 41.0, 1.0));
//! # Ok::<(), Failure>(())
//! ```
//!
//! Optimisers that ask for no more than a [`Subgradient`] search these problems and those that are [`Differentiable`].

mod evaluation;
mod failure;
mod inner;
mod oracle;
mod outside;
mod points;
mod problem;
mod rng;
mod subgradient;
mod terms;
mod timed;
mod watch;

pub use evaluation::Evaluation;
pub use failure::Failure;
pub use oracle::{Best, Oracle, Stop, TracePoint};
pub use points::{Bounds, BoundsError, Points, PointsIter, PointsIterMut};
pub use problem::{Coarse, Composite, Differentiable, Problem, Slopes, Timed};
pub use rng::Rng;
pub use subgradient::Subgradient;
pub use terms::{Linearisation, Multipliers, Piece, PieceId, Shape, Term};
pub use timed::{
    Bend, Bent, ErrorSlopes, Fold, LinearLimit, LinearLimits, TimedParts, TimedWeights,
};
pub use watch::Watch;
