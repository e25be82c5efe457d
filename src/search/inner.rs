//! Searches within a search.

use rayon::prelude::*;

use super::oracle::{Best, Oracle, Stop, TracePoint};

/// A search on a relaxed problem may spend one in so many of the evaluations left.
const RELAXED: u64 = 4;

impl Oracle<'_> {
    /// Lets a search spend so many of the evaluations left, at most, and gives the best that it found.
    /// Where only these are spent, and not the whole budget, that is no reason to stop.
    pub fn within(
        &mut self,
        evaluations: u64,
        search: impl FnOnce(&mut Self) -> Result<(), Stop>,
    ) -> Result<Option<Best>, Stop> {
        let (budget, outer) = (self.budget, self.best_within.take());
        self.budget = budget.min(self.evaluations.saturating_add(evaluations));
        let outcome = search(self);
        self.budget = budget;
        let own = std::mem::replace(&mut self.best_within, outer);
        if let Some(own) = own.clone() {
            self.add_to_search(own);
        }
        match outcome {
            Err(stop) if stop != Stop::BudgetSpent || self.remaining() == 0 => Err(stop),
            _ => Ok(own),
        }
    }

    /// Has a search work on the [coarser](super::Problem::coarser) problem, where there is one, with the same budget. Its
    /// evaluations count here; the best of its points, and those that it ends with, become points of this problem.
    pub fn on_coarser(
        &mut self,
        search: impl FnOnce(&mut Self) -> Result<Vec<Best>, Stop>,
    ) -> Result<Option<Vec<Best>>, Stop> {
        let Some(coarse) = self.problem.coarser() else { return Ok(None) };
        self.check_dimension(coarse.prolong(&vec![0.0; coarse.bounds().len()]).len())?;
        let prolong = |best: Best| Best { x: coarse.prolong(&best.x), ..best };
        let (problem, outer) = (self.problem, self.best_within.take());
        self.problem = coarse;
        self.coarser.push(coarse);
        let outcome = search(self);
        self.coarser.pop();
        self.problem = problem;
        if let Some(own) = std::mem::replace(&mut self.best_within, outer) {
            self.add_to_search(prolong(own));
        }
        Ok(Some(outcome?.into_iter().map(prolong).collect()))
    }

    /// Whether the problem has a [relaxed](super::Problem::relaxed) one.
    pub fn is_relaxable(&self) -> bool {
        self.problem.relaxed().is_some()
    }

    /// Has a search work on the relaxed problem, with a share of the budget; nothing where there is none. Its evaluations count
    /// here, but what it ends with are starts and no points that were found.
    pub fn on_relaxed(
        &mut self,
        search: impl FnOnce(&mut Self) -> Result<Vec<Best>, Stop>,
    ) -> Result<Vec<Vec<f64>>, Stop> {
        let Some(relaxed) = self.problem.relaxed() else { return Ok(Vec::new()) };
        let mut own = Self {
            started: self.started,
            is_parallel: self.is_parallel,
            ..Self::new(relaxed, self.remaining() / RELAXED, self.watch)
        };
        let outcome = search(&mut own);
        self.count(&own);
        let ends = match outcome {
            Err(Stop::BudgetSpent) => own.best.into_iter().collect(),
            outcome => outcome?,
        };
        Ok(ends.into_iter().map(|end| end.x).collect())
    }

    /// Searches from several points, each of which may spend what is left, and gives the best that each found. Once
    /// [parallel](Self::parallel), they run at the same time, and each may spend an equal share of what is left.
    pub fn from_each(
        &mut self,
        starts: &[Vec<f64>],
        search: impl Fn(&mut Self, &[f64]) -> Result<(), Stop> + Sync,
    ) -> Result<Vec<Best>, Stop> {
        let mut found = Vec::new();
        if !self.is_parallel {
            for start in starts {
                found.extend(self.within(self.remaining(), |oracle| search(oracle, start))?);
            }
            return Ok(found);
        }
        self.check()?;
        let most = usize::try_from(self.remaining()).unwrap_or(usize::MAX);
        let starts = &starts[..starts.len().min(most)];
        let share = self.remaining() / starts.len().max(1) as u64;
        let run = |start: &Vec<f64>| {
            let mut own = self.fork(share);
            let outcome = search(&mut own, start);
            (own, outcome)
        };
        let runs: Vec<_> = starts.par_iter().map(run).collect();
        let mut stopped = Ok(());
        for (own, outcome) in runs {
            found.extend(self.join(own));
            if stopped.is_ok() && outcome != Err(Stop::BudgetSpent) {
                stopped = outcome;
            }
        }
        stopped.map(|()| found)
    }

    /// An oracle for a search at the same time as others.
    fn fork(&self, budget: u64) -> Self {
        Self {
            coarser: self.coarser.clone(),
            started: self.started,
            form: self.form.clone(),
            ..Self::new(self.problem, budget, self.watch)
        }
    }

    /// Takes what another oracle has spent and found as spent and found after its own; gives the best of its search.
    fn join(&mut self, other: Self) -> Option<Best> {
        let before = self.evaluations;
        self.count(&other);
        self.first_feasible = self.first_feasible.or(other.first_feasible.map(|at| before + at));
        let is_better = |cost: f64| Best::is_above(self.best.as_ref(), cost);
        let better = other.trace.into_iter().filter(|point| is_better(point.best.cost));
        self.trace.extend(
            better.map(|point| TracePoint { evaluation: before + point.evaluation, ..point }),
        );
        if let Some(best) = other.best.filter(|best| is_better(best.evaluation.cost)) {
            self.best = Some(best);
        }
        if let Some(own) = other.best_within.clone() {
            self.add_to_search(own);
        }
        other.best_within
    }

    /// Takes what another oracle has spent as spent.
    fn count(&mut self, other: &Self) {
        self.evaluations += other.evaluations;
        self.linearisations += other.linearisations;
        self.curvatures += other.curvatures;
        self.conic_solves += other.conic_solves;
        self.conic_failures += other.conic_failures;
        self.in_problem += other.in_problem;
    }

    fn add_to_search(&mut self, found: Best) {
        if Best::is_above(self.best_within.as_ref(), found.evaluation.cost) {
            self.best_within = Some(found);
        }
    }
}
