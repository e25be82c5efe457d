//! The only door from an optimiser to a problem: it counts, keeps the best, and says when to stop.

use std::time::{Duration, Instant};

use nalgebra::DMatrix;

use super::evaluation::Evaluation;
use super::failure::Failure;
use super::points::{Bounds, Points};
use super::problem::{Coarse, Composite, Problem, Timed};
use super::rng::Rng;
use super::subgradient::Subgradient;
use super::terms::PieceId;
use super::terms::{Linearisation, Multipliers, Shape};
use super::timed::{Bend, Fold, LinearLimits, TimedParts, TimedWeights};
use super::watch::Watch;
use crate::words::plural;

/// Why an optimiser has to stop.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Stop {
    /// Every evaluation of the budget is spent.
    #[error("budget spent")]
    BudgetSpent,
    /// The problem has no derivatives, and the optimiser needs them.
    #[error("the problem has no derivatives")]
    NoDerivatives,
    /// The user wants the program to end.
    #[error("interrupted")]
    Interrupted,
    /// The problem failed, or was asked what it cannot be asked.
    #[error(transparent)]
    Failed(#[from] Failure),
}

/// The best point so far.
#[derive(Debug, Clone, PartialEq)]
pub struct Best {
    /// The point.
    pub x: Vec<f64>,
    /// What was found there.
    pub evaluation: Evaluation,
}

impl Best {
    /// Whether a cost is lower than the best so far, or the first.
    pub(super) fn is_above(best: Option<&Self>, cost: f64) -> bool {
        best.is_none_or(|best| cost < best.evaluation.cost)
    }
}

/// One row of a run's trace: an improvement, or the last evaluation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TracePoint {
    /// Which evaluation, counted from one.
    pub evaluation: u64,
    /// Best so far: cost and violation.
    pub best: Evaluation,
    /// Time since the run began.
    pub elapsed: Duration,
}

/// Evaluates a problem for an optimiser within a budget.
#[expect(missing_debug_implementations, reason = "a problem need not be printable")]
pub struct Oracle<'a> {
    pub(super) problem: &'a dyn Problem,
    /// The coarser problems down to the one that is asked, where it is not the problem itself.
    pub(super) coarser: Vec<&'a dyn Coarse>,
    pub(super) budget: u64,
    pub(super) watch: &'a Watch,
    pub(super) started: Instant,
    /// When the search ended, where that is not now.
    pub(super) stopped: Option<Instant>,
    pub(super) in_problem: Duration,
    pub(super) evaluations: u64,
    pub(super) linearisations: u64,
    pub(super) curvatures: u64,
    pub(super) conic_solves: u64,
    pub(super) conic_failures: u64,
    pub(super) first_feasible: Option<u64>,
    /// Weights and shapes of the cost's terms, once they are known.
    pub(super) form: Option<Vec<(f64, Shape)>>,
    pub(super) best: Option<Best>,
    /// The best of the search that is [`within`](Self::within), a point of the problem that is asked.
    pub(super) best_within: Option<Best>,
    pub(super) trace: Vec<TracePoint>,
    /// Whether searches [`from_each`](Self::from_each) of several points run at the same time.
    pub(super) is_parallel: bool,
    pub(super) remarks: Vec<String>,
}

impl<'a> Oracle<'a> {
    /// An oracle that has spent nothing yet of so many evaluations.
    pub fn new(problem: &'a dyn Problem, budget: u64, watch: &'a Watch) -> Self {
        Self {
            problem,
            coarser: Vec::new(),
            budget,
            watch,
            started: Instant::now(),
            stopped: None,
            in_problem: Duration::ZERO,
            evaluations: 0,
            linearisations: 0,
            curvatures: 0,
            conic_solves: 0,
            conic_failures: 0,
            first_feasible: None,
            form: None,
            best: None,
            best_within: None,
            trace: Vec::new(),
            is_parallel: false,
            remarks: Vec::new(),
        }
    }

    /// Lets the time of the search begin now, as where it is begun by a process that has to start first.
    pub fn start_clock(&mut self) {
        self.started = Instant::now();
    }

    /// Lets the time of the search end now, whatever is done before the run is.
    pub fn stop_clock(&mut self) {
        self.stopped = Some(Instant::now());
    }

    /// How long the search has taken so far.
    pub fn elapsed(&self) -> Duration {
        self.stopped.unwrap_or_else(Instant::now).duration_since(self.started)
    }

    /// Has a remark kept with the run, whatever comes of it.
    pub fn remark(&mut self, remark: String) {
        self.remarks.push(remark);
    }

    /// The remarks, in their order.
    pub fn remarks(&self) -> &[String] {
        &self.remarks
    }

    /// Whether somebody wants the program to end.
    pub fn is_interrupted(&self) -> bool {
        self.watch.is_interrupted()
    }

    /// Whether the cost can be asked for as a sum of terms; see [`linearise`](Self::linearise).
    pub fn has_terms(&self) -> bool {
        self.problem.composite().is_some()
    }

    /// Whether costs have subgradients; see [`subgradient`](Self::subgradient).
    pub fn has_subgradients(&self) -> bool {
        self.problem.slopes().is_some()
    }

    /// Counts an evaluation of a point that is outside the box: its cost is infinite, and the problem is not asked.
    pub fn refuse(&mut self) -> Result<(), Stop> {
        self.check()?;
        self.begin();
        Ok(())
    }

    /// Has searches that do not depend on one another run at the same time, on the threads of the current pool. What they
    /// find does not depend on the number of threads.
    #[must_use]
    pub fn parallel(self) -> Self {
        Self { is_parallel: true, ..self }
    }

    /// The problem's box.
    pub fn bounds(&self) -> &'a Bounds {
        self.problem.bounds()
    }

    /// Evaluations left.
    pub fn remaining(&self) -> u64 {
        self.budget - self.evaluations
    }

    /// Evaluations made: those that returned, and the one that failed or panicked where one did.
    pub fn evaluations(&self) -> u64 {
        self.evaluations
    }

    /// Linearisations made.
    pub fn linearisations(&self) -> u64 {
        self.linearisations
    }

    /// Second derivatives of Lagrangians found.
    pub fn curvatures(&self) -> u64 {
        self.curvatures
    }

    /// Conic subproblems solved or given up.
    pub fn conic_solves(&self) -> u64 {
        self.conic_solves
    }

    /// Conic subproblems given up.
    pub fn conic_failures(&self) -> u64 {
        self.conic_failures
    }

    /// The first evaluation within all limits.
    pub fn first_feasible(&self) -> Option<u64> {
        self.first_feasible
    }

    /// Time spent inside the problem.
    pub fn time_in_problem(&self) -> Duration {
        self.in_problem
    }

    /// The best so far, a point of the whole problem; a cost that is infinite or NaN is never best.
    pub fn best(&self) -> Option<&Best> {
        self.best.as_ref()
    }

    /// Evaluates one point, whose length is the problem's dimension.
    pub fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, Stop> {
        self.check()?;
        self.check_dimension(x.len())?;
        self.begin();
        let problem = self.problem;
        let evaluation = self.clocked(|| problem.evaluate(x))?;
        self.record(x, evaluation);
        Ok(evaluation)
    }

    /// Evaluates many points; `out` has one place for each, or more. Where the budget ends within them,
    /// the first ones are evaluated and the run stops.
    ///
    /// A batch that answers to fewer points than asked, or to more, fails; the answers to points that were
    /// asked are kept.
    pub fn evaluate_batch(&mut self, points: &Points, out: &mut [Evaluation]) -> Result<(), Stop> {
        self.check()?;
        self.check_dimension(points.dimension())?;
        if out.len() < points.len() {
            let (room, count) = (out.len(), points.len());
            let reason = format!(
                "found room for {}, expected {count}, one per point",
                plural(room, "evaluation")
            );
            return Err(Failure::new(reason).into());
        }
        let affordable = usize::try_from(self.remaining()).unwrap_or(usize::MAX);
        let cut = (affordable < points.len()).then(|| points.prefix(affordable));
        let points = cut.as_ref().unwrap_or(points);
        if points.is_empty() {
            return Ok(());
        }
        self.begin();
        let (mut answers, count) = (0, points.len());
        let clock = Instant::now();
        let outcome = self.problem.evaluate_batch(points, &mut |evaluation| {
            if answers < count {
                out[answers] = evaluation;
                self.record(&points[answers], evaluation);
            }
            answers += 1;
            if answers < count {
                self.begin();
            }
        });
        self.in_problem += clock.elapsed();
        outcome?;
        if answers != count {
            let (answers, points) = (plural(answers, "answer"), plural(count, "point"));
            let reason = format!("found {answers} to a batch of {points}, expected {count}");
            return Err(Failure::new(reason).into());
        }
        if cut.is_some() { Err(Stop::BudgetSpent) } else { Ok(()) }
    }

    /// Evaluates one point together with its first derivatives: one evaluation and one linearisation. A
    /// gradient of another length than the point's, a weight that is negative or not finite, two pieces of a
    /// term with one id, or terms of another form than at the first point, is a failure.
    pub fn linearise(&mut self, x: &[f64]) -> Result<Linearisation, Stop> {
        let composite = self.composite(x)?;
        self.begin();
        self.linearisations += 1;
        let linearisation = self.clocked(|| composite.linearise(x))?;
        let form = self.form.get_or_insert_with(|| linearisation.form().collect());
        linearisation.check(x.len(), form)?;
        self.record(x, linearisation.evaluation());
        Ok(linearisation)
    }

    /// Evaluates one point together with a subgradient: one evaluation and one linearisation. A subgradient of another
    /// length than the point's is a failure.
    pub fn subgradient(&mut self, x: &[f64]) -> Result<Subgradient, Stop> {
        self.check()?;
        self.check_dimension(x.len())?;
        let slopes = self.problem.slopes().ok_or(Stop::NoDerivatives)?;
        self.begin();
        self.linearisations += 1;
        let subgradient = self.clocked(|| slopes.at(x))?;
        subgradient.check(x.len())?;
        self.record(x, subgradient.evaluation);
        Ok(subgradient)
    }

    /// Evaluates one point of a [`Timed`](super::Timed) problem together with all that its cost follows from: one
    /// evaluation and one linearisation. Slopes of another shape than error and point ask for are a failure.
    pub fn timing(&mut self, x: &[f64]) -> Result<TimedParts, Stop> {
        self.check()?;
        self.check_dimension(x.len())?;
        let problem = self.problem.timed().ok_or(Stop::NoDerivatives)?;
        self.begin();
        self.linearisations += 1;
        let parts = self.clocked(|| problem.parts(x))?;
        parts.limits.check(x.len())?;
        parts.error.check(x.len())?;
        parts.bent.check(x.len())?;
        self.record(x, problem.weights().evaluation(&parts));
        Ok(parts)
    }

    /// The limits of a [`Timed`](super::Timed) problem at a point, which is part of the model of its cost and no evaluation.
    pub fn limits(&mut self, x: &[f64]) -> Result<LinearLimits, Stop> {
        self.check_dimension(x.len())?;
        let problem = self.problem.timed().ok_or(Stop::NoDerivatives)?;
        let limits = self.clocked(|| problem.limits(x))?;
        limits.check(x.len())?;
        Ok(limits)
    }

    /// How the error of a [`Timed`](super::Timed) problem bends at a point, where it has so many components: a second
    /// derivative.
    pub fn bends(&mut self, x: &[f64], components: usize) -> Result<Vec<Bend>, Stop> {
        self.check()?;
        self.check_dimension(x.len())?;
        let problem = self.problem.timed().ok_or(Stop::NoDerivatives)?;
        self.curvatures += 1;
        let bends = self.clocked(|| problem.bends(x))?;
        bends.iter().try_for_each(|bend| bend.check(components, x.len()))?;
        Ok(bends)
    }

    /// How else a [`Timed`](super::Timed) cost bends at a point, to go with [`bends`](Self::bends).
    pub fn folds(&mut self, x: &[f64], multipliers: &[(PieceId, f64)]) -> Result<Vec<Fold>, Stop> {
        self.check_dimension(x.len())?;
        let problem = self.problem.timed().ok_or(Stop::NoDerivatives)?;
        let folds = self.clocked(|| problem.folds(x, multipliers))?;
        if let Some(fold) = folds.iter().find(|fold| fold.direction.len() != x.len()) {
            let (found, expected) = (fold.direction.len(), x.len());
            let message = format!("found a direction of {found} components, expected {expected}");
            return Err(Failure::new(message).into());
        }
        Ok(folds)
    }

    /// What parts of a [`Timed`](super::Timed) cost weigh, where the problem has one.
    pub fn timed_weights(&self) -> Option<TimedWeights> {
        self.problem.timed().map(Timed::weights)
    }

    /// A random point to search a [`Timed`](super::Timed) problem from; see [`Timed::start`].
    pub fn timed_start(&self, rng: &mut Rng, spread: f64) -> Option<Vec<f64>> {
        self.problem.timed().map(|problem| problem.start(rng, spread))
    }

    /// The second derivative of a Lagrangian at a point, `n × n` for `n` variables.
    pub fn curvature(
        &mut self,
        x: &[f64],
        multipliers: &Multipliers,
    ) -> Result<DMatrix<f64>, Stop> {
        let composite = self.composite(x)?;
        self.curvatures += 1;
        let curvature = self.clocked(|| composite.curvature(x, multipliers))?;
        if curvature.shape() != (x.len(), x.len()) {
            let ((rows, columns), n) = (curvature.shape(), x.len());
            let reason =
                format!("found a second derivative of {rows} × {columns}, expected {n} × {n}");
            return Err(Failure::new(reason).into());
        }
        Ok(curvature)
    }

    /// Counts the conic subproblem that `solve` solves, or fails to.
    pub fn conic<S>(&mut self, solve: impl FnOnce() -> Option<S>) -> Result<Option<S>, Stop> {
        self.check()?;
        self.conic_solves += 1;
        let solution = solve();
        self.conic_failures += u64::from(solution.is_none());
        Ok(solution)
    }

    /// The improvements and, unless no cost was finite, the last evaluation, in order.
    pub fn into_trace(mut self) -> Vec<TracePoint> {
        if let (Some(last), Some(best)) = (self.trace.last(), &self.best)
            && last.evaluation < self.evaluations
        {
            self.trace.push(TracePoint {
                evaluation: self.evaluations,
                best: best.evaluation,
                elapsed: self.started.elapsed(),
            });
        }
        self.trace
    }

    pub(super) fn check(&self) -> Result<(), Stop> {
        if self.watch.is_interrupted() {
            Err(Stop::Interrupted)
        } else if self.remaining() == 0 {
            Err(Stop::BudgetSpent)
        } else {
            Ok(())
        }
    }

    fn composite(&self, x: &[f64]) -> Result<&'a dyn Composite, Stop> {
        self.check()?;
        self.check_dimension(x.len())?;
        self.problem.composite().ok_or(Stop::NoDerivatives)
    }

    pub(super) fn check_dimension(&self, found: usize) -> Result<(), Stop> {
        let expected = self.problem.bounds().len();
        if found == expected {
            return Ok(());
        }
        let reason =
            format!("found a point with {}, expected {expected}", plural(found, "variable"));
        Err(Failure::new(reason).into())
    }

    /// Does work that is the problem's, on its clock.
    fn clocked<R>(&mut self, work: impl FnOnce() -> R) -> R {
        let clock = Instant::now();
        let result = work();
        self.in_problem += clock.elapsed();
        result
    }

    /// Counts an evaluation that is about to be made: it may fail or panic and never be recorded.
    fn begin(&mut self) {
        self.evaluations += 1;
        self.watch.add_evaluations(1);
    }

    fn record(&mut self, x: &[f64], evaluation: Evaluation) {
        if !evaluation.cost.is_finite() {
            return;
        }
        if self.first_feasible.is_none() && evaluation.violation <= 0.0 {
            self.first_feasible = Some(self.evaluations);
        }
        if Best::is_above(self.best_within.as_ref(), evaluation.cost) {
            self.best_within = Some(Best { x: x.to_vec(), evaluation });
        }
        if Best::is_above(self.best.as_ref(), evaluation.cost) {
            let levels = self.coarser.iter().rev();
            let x = levels.fold(x.to_vec(), |x, coarse| coarse.prolong(&x));
            self.best = Some(Best { x, evaluation });
            self.trace.push(TracePoint {
                evaluation: self.evaluations,
                best: evaluation,
                elapsed: self.started.elapsed(),
            });
        }
    }
}
