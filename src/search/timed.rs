//! The parts of a [`Timed`](super::Timed) cost.

use nalgebra::{DMatrix, DVector};

use super::evaluation::Evaluation;
use super::failure::Failure;
use super::subgradient::Subgradient;
use super::terms::{Piece, Shape, Term};

/// Weights of time, error and excess; finite and not negative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimedWeights {
    /// `w_T`.
    pub time: f64,
    /// `w_r`.
    pub error: f64,
    /// `w_s`.
    pub excess: f64,
}

/// `r` at a point.
#[derive(Debug, Clone)]
pub struct ErrorSlopes {
    /// `r`.
    pub value: DVector<f64>,
    /// `∂r/∂x`, one row per component.
    pub slopes: DMatrix<f64>,
}

/// What a timed cost follows from beside linear limits and the error: smooth functions of any variables.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Bent {
    /// Functions that the time is never below. Those that are far below it may be left out.
    pub durations: Vec<Piece>,
    /// Maxima that are added to the cost; as many at every point, in the same order, with the same weights.
    pub terms: Vec<Term>,
    /// By how much the point breaks the limits among them, as in [`Evaluation`].
    pub violation: f64,
}

/// All parts of a timed cost at a point.
#[derive(Debug, Clone)]
pub struct TimedParts {
    /// Time and excess that linear limits leave.
    pub limits: LinearLimits,
    /// The error.
    pub error: ErrorSlopes,
    /// All else.
    pub bent: Bent,
}

/// The error's second derivative in one direction.
#[derive(Debug, Clone)]
pub struct Bend {
    /// The direction.
    pub direction: DVector<f64>,
    /// The change of [`ErrorSlopes::slopes`] per unit of length along it.
    pub change: DMatrix<f64>,
}

/// A positive part `c q qᵀ` of a second derivative.
#[derive(Debug, Clone)]
pub struct Fold {
    /// `q`.
    pub direction: DVector<f64>,
    /// `c`, above zero.
    pub curvature: f64,
}

/// What limits of a point's time and excess are known.
#[derive(Debug, Clone, Default)]
pub struct LinearLimits {
    /// `T`.
    pub time: f64,
    /// `s`.
    pub excess: f64,
    /// Some `ℓ_i`, with the largest of all among them.
    pub list: Vec<LinearLimit>,
}

/// A function linear in the variables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearLimit {
    /// The same at every point for the same function. Without one it is unlike all others.
    pub id: Option<u32>,
    /// `p`.
    pub power: u8,
    /// `ℓ` at the point.
    pub value: f64,
    /// The first variable that it follows.
    pub first: usize,
    /// Its slopes by the variables from there on, filled up with zeros.
    pub slopes: [f64; Self::MOST],
}

impl LinearLimit {
    /// The most variables in a row that a limit may follow.
    pub const MOST: usize = 6;

    /// Its change over a step.
    pub fn change(&self, step: &DVector<f64>) -> f64 {
        let own = &step.as_slice()[self.first..];
        own.iter().zip(&self.slopes).map(|(d, slope)| d * slope).sum()
    }

    /// Adds so many times the slopes of the time, or for a power of zero the excess, that it asks for at the point.
    fn add_slopes(&self, weight: f64, sum: &mut DVector<f64>) {
        let size = self.value.abs();
        if size == 0.0 {
            return;
        }
        let by_size = match self.power {
            0 => 1.0,
            power => self.asks(size) / (f64::from(power) * size),
        };
        let own = sum.as_mut_slice()[self.first..].iter_mut().zip(&self.slopes);
        own.for_each(|(sum, slope)| *sum += weight * by_size * self.value.signum() * slope);
    }

    /// The time, or for a power of zero the excess, that it asks for with another value.
    pub fn asks(&self, value: f64) -> f64 {
        let value = value.abs();
        match self.power {
            0 => value - 1.0,
            1 => value,
            2 => value.sqrt(),
            _ => value.cbrt(),
        }
    }
}

impl TimedWeights {
    /// `J`.
    pub fn cost(&self, parts: &TimedParts) -> f64 {
        let TimedParts { limits, error, bent } = parts;
        let rest: f64 = bent.terms.iter().map(Term::cost).sum();
        self.time * parts.time()
            + self.error * error.value.norm()
            + self.excess * limits.excess
            + rest
    }

    /// Cost and violation.
    pub fn evaluation(&self, parts: &TimedParts) -> Evaluation {
        Evaluation::new(self.cost(parts), parts.limits.excess + parts.bent.violation)
    }

    /// Cost and violation, and a subgradient of the cost.
    pub fn subgradient(&self, parts: &TimedParts) -> Subgradient {
        let TimedParts { limits, error, bent } = parts;
        let mut slopes = DVector::zeros(error.slopes.ncols());
        let norm = error.value.norm();
        if norm > 0.0 {
            slopes.gemv_tr(self.error / norm, &error.slopes, &error.value, 0.0);
        }
        match bent.longest().filter(|piece| piece.value > limits.time) {
            Some(piece) => slopes.axpy(self.time, &piece.gradient, 1.0),
            None => {
                if let Some(limit) = limits.longest() {
                    limit.add_slopes(self.time, &mut slopes);
                }
            }
        }
        bent.terms.iter().for_each(|term| term.add_slopes(&mut slopes));
        if limits.excess > 0.0
            && let Some(limit) = limits.farthest()
        {
            limit.add_slopes(self.excess, &mut slopes);
        }
        Subgradient { evaluation: self.evaluation(parts), slopes }
    }
}

impl TimedParts {
    /// `T`, by linear limits and all else.
    pub fn time(&self) -> f64 {
        self.bent.longest().map_or(self.limits.time, |piece| piece.value.max(self.limits.time))
    }
}

impl Bent {
    /// The durations and the maxima.
    pub fn new(durations: Vec<Piece>, terms: Vec<Term>, violation: f64) -> Self {
        Self { durations, terms, violation }
    }

    fn longest(&self) -> Option<&Piece> {
        self.durations.iter().max_by(|a, b| a.value.total_cmp(&b.value))
    }

    /// Whether all terms are maxima and all slopes of so many variables.
    pub(super) fn check(&self, variables: usize) -> Result<(), Failure> {
        if self.terms.iter().any(|term| term.shape != Shape::Max) {
            return Err(Failure::new("found a term of another shape than a maximum"));
        }
        let pieces = self.terms.iter().flat_map(|term| &term.pieces).chain(&self.durations);
        let found = pieces.map(|piece| piece.gradient.len()).find(|&found| found != variables);
        found.map_or(Ok(()), |found| {
            Err(format!("found a gradient of {found} components, expected {variables}").into())
        })
    }
}

impl ErrorSlopes {
    /// Whether slopes are of so many variables.
    pub(super) fn check(&self, variables: usize) -> Result<(), Failure> {
        let (expected, found) = ((self.value.len(), variables), self.slopes.shape());
        if found == expected {
            return Ok(());
        }
        let [found, expected] = [found, expected].map(|(m, n)| format!("{m} × {n}"));
        Err(format!("found slopes of an error of {found}, expected {expected}").into())
    }
}

impl Bend {
    /// Whether it is of so many components and variables.
    pub(super) fn check(&self, components: usize, variables: usize) -> Result<(), Failure> {
        let found = (self.direction.len(), self.change.shape());
        if found == (variables, (components, variables)) {
            return Ok(());
        }
        let (length, (m, n)) = found;
        let expected = format!("expected {variables} and {components} × {variables}");
        Err(format!("found a direction of {length} and changes of {m} × {n}, {expected}").into())
    }
}

impl LinearLimits {
    /// The first limit of those that ask for the longest time.
    fn longest(&self) -> Option<&LinearLimit> {
        Self::most(self.list.iter().filter(|limit| limit.power > 0))
    }

    /// The first of those that ask for the largest excess.
    fn farthest(&self) -> Option<&LinearLimit> {
        Self::most(self.list.iter().filter(|limit| limit.power == 0))
    }

    /// A subgradient of the time, by so many variables.
    pub fn time_slopes(&self, variables: usize) -> DVector<f64> {
        let mut slopes = DVector::zeros(variables);
        if let Some(limit) = self.longest() {
            limit.add_slopes(1.0, &mut slopes);
        }
        slopes
    }

    fn most<'a>(limits: impl Iterator<Item = &'a LinearLimit>) -> Option<&'a LinearLimit> {
        limits.reduce(
            |most, limit| {
                if limit.asks(limit.value) > most.asks(most.value) { limit } else { most }
            },
        )
    }

    /// Whether they are of so many variables.
    pub(super) fn check(&self, variables: usize) -> Result<(), Failure> {
        for LinearLimit { first, slopes, .. } in &self.list {
            let last = slopes.iter().rposition(|slope| *slope != 0.0).map_or(*first, |i| first + i);
            if last >= variables {
                let expected = format!("expected one of {variables}");
                return Err(format!("found a limit on variable {last}, {expected}").into());
            }
        }
        Ok(())
    }
}
