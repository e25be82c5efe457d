//! The oracle of a run as a solver in Python sees it.

use std::collections::HashSet;
use std::ptr::NonNull;
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::{self, ThreadId};
use std::time::{Duration, Instant};

use driftless::search::{Bounds, Evaluation, Points, Stop};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays;
use crate::errors::{self, Raised as _};
use crate::problem::{Linearisation, Pair, both, inside};

/// How often a solver that goes on after its search is over is told that everything costs infinitely much. After that its thread is
/// stopped: it waits for ever within its next question.
const PATIENCE: u32 = 1000;

/// An oracle whose run is not over: what is behind the pointer outlives it, see [`Desk::open`].
struct Open(NonNull<driftless::search::Oracle<'static>>);

// SAFETY: an oracle is `Send`, which the constant below checks.
unsafe impl Send for Open {}

const fn is_send<T: Send>() {}
const _: () = is_send::<driftless::search::Oracle<'static>>();

/// What a run and its solver share.
pub(crate) struct Desk {
    state: Mutex<State>,
    /// The thread whose question is being answered: a problem may ask nothing itself.
    asking: Mutex<Option<ThreadId>>,
    /// Told when a solver goes on although its search is over.
    gone_on: Sender<super::solver::Ended>,
    process: u32,
    bounds: Bounds,
    budget: u64,
    has: [bool; 2],
}

#[derive(Default)]
struct State {
    /// None once the run is over.
    oracle: Option<Open>,
    /// Why the search is over, and since when.
    stop: Option<(Stop, Instant)>,
    /// The threads that have learnt of it.
    told: HashSet<ThreadId>,
    /// How often something was asked after that.
    asked_since: u32,
    /// The solver's own thread, and whether the run has gone on without it.
    solver: Option<ThreadId>,
    is_left: bool,
    /// Points that were outside the box.
    outside: usize,
}

/// Closes a desk when the run is over.
struct Close<'a>(&'a Desk);

impl Drop for Close<'_> {
    fn drop(&mut self) {
        self.0.lock().oracle = None;
    }
}

/// Says whose question is being answered, until it is.
struct Asked<'a>(&'a Mutex<Option<ThreadId>>);

impl<'a> Asked<'a> {
    fn by_this_thread(asking: &'a Mutex<Option<ThreadId>>) -> Self {
        *asking.lock().unwrap_or_else(PoisonError::into_inner) = Some(thread::current().id());
        Self(asking)
    }
}

impl Drop for Asked<'_> {
    fn drop(&mut self) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }
}

impl Desk {
    pub(crate) fn new(
        oracle: &driftless::search::Oracle<'_>,
        gone_on: Sender<super::solver::Ended>,
    ) -> Self {
        Self {
            state: Mutex::default(),
            asking: Mutex::default(),
            gone_on,
            process: std::process::id(),
            bounds: oracle.bounds().clone(),
            budget: oracle.remaining(),
            has: [oracle.has_subgradients(), oracle.has_terms()],
        }
    }

    /// Lets solvers ask an oracle while something is done.
    pub(crate) fn open<R>(
        &self,
        oracle: &mut driftless::search::Oracle<'_>,
        work: impl FnOnce() -> R,
    ) -> R {
        let pointer = NonNull::from(oracle).cast::<driftless::search::Oracle<'static>>();
        self.lock().oracle = Some(Open(pointer));
        let _close = Close(self);
        work()
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn try_lock(&self) -> Option<MutexGuard<'_, State>> {
        match self.state.try_lock() {
            Ok(state) => Some(state),
            Err(TryLockError::Poisoned(state)) => Some(state.into_inner()),
            Err(TryLockError::WouldBlock) => None,
        }
    }

    /// Why the search is over, and how many points were outside the box.
    pub(crate) fn outcome(&self) -> (Option<Stop>, usize) {
        let state = self.lock();
        (state.stop.as_ref().map(|(stop, _)| stop.clone()), state.outside)
    }

    /// Says that this is the solver's thread.
    pub(crate) fn enter(&self) {
        self.lock().solver = Some(thread::current().id());
    }

    /// Says that the run goes on without its solver.
    pub(crate) fn leave(&self) {
        self.lock().is_left = true;
    }

    /// How long the search has been over, where it is.
    pub(crate) fn over_for(&self) -> Option<Duration> {
        let state = self.try_lock()?;
        state.stop.as_ref().map(|(_, since)| since.elapsed())
    }

    /// Notices an interruption of a run whose solver asks nothing.
    pub(crate) fn look_for_interruption(&self) {
        let Some(mut state) = self.try_lock() else { return };
        let is_interrupted = state.oracle.as_ref().is_some_and(|oracle| {
            // SAFETY: as in `State::ask`.
            unsafe { oracle.0.as_ref() }.is_interrupted()
        });
        if is_interrupted && state.stop.is_none() {
            state.stop = Some((Stop::Interrupted, Instant::now()));
        }
    }

    /// Whether this thread may ask: it is of this process, and not being answered already.
    fn check_entry(&self) -> PyResult<()> {
        if self.process != std::process::id() {
            return Err(errors::closed("this oracle belongs to a run of another process"));
        }
        let asking = *self.asking.lock().unwrap_or_else(PoisonError::into_inner);
        if asking == Some(thread::current().id()) {
            return Err(errors::search("a problem cannot ask the oracle that asks it"));
        }
        Ok(())
    }

    /// Asks the oracle, from whichever thread. None where the search has been over for some time and a solver has not noticed.
    fn ask<R: Send>(
        &self,
        py: Python<'_>,
        is_long: bool,
        question: impl FnOnce(&mut driftless::search::Oracle<'_>, &mut usize) -> Result<R, Stop> + Send,
    ) -> PyResult<Option<R>> {
        self.check_entry()?;
        let asking = &self.asking;
        let question = move |oracle: &mut driftless::search::Oracle<'_>, outside: &mut usize| {
            let _asked = Asked::by_this_thread(asking);
            question(oracle, outside)
        };
        // A thread that has the lock may need Python before it lets go of it, so it is waited for without.
        let free = if is_long { None } else { self.try_lock() };
        let answer = match free {
            Some(mut state) => state.ask(question),
            None => py.detach(|| self.lock().ask(question)),
        };
        match answer {
            Answer::Found(found) => Ok(Some(found)),
            Answer::Stopped(stop) => Err(stop.raised()),
            Answer::Over => Ok(None),
            Answer::Ended => Err(errors::closed("the run of this oracle is over")),
            Answer::NeverMind => {
                let _ = self.gone_on.send(super::solver::Ended::WentOn);
                py.detach(|| {
                    loop {
                        thread::park();
                    }
                })
            }
        }
    }
}

/// What comes of a question.
enum Answer<R> {
    Found(R),
    /// The search is over, and the solver learns of it.
    Stopped(Stop),
    /// It has learnt of it and goes on.
    Over,
    /// It goes on and on.
    NeverMind,
    /// The run is over.
    Ended,
}

impl State {
    fn ask<R>(
        &mut self,
        question: impl FnOnce(&mut driftless::search::Oracle<'_>, &mut usize) -> Result<R, Stop>,
    ) -> Answer<R> {
        let is_solver = self.solver == Some(thread::current().id());
        let Some(oracle) = &mut self.oracle else {
            return if self.is_left && is_solver { Answer::NeverMind } else { Answer::Ended };
        };
        if let Some((stop, _)) = &self.stop {
            if self.told.insert(thread::current().id()) {
                return Answer::Stopped(stop.clone());
            }
            self.asked_since += 1;
            return match (self.asked_since > PATIENCE, is_solver) {
                (false, _) => Answer::Over,
                (true, true) => Answer::NeverMind,
                // Others may be waited for when Python ends.
                (true, false) => Answer::Stopped(stop.clone()),
            };
        }
        // SAFETY: `Desk::open` borrows the oracle mutably until it drops `Close`, which takes the pointer away under the lock that
        // is held here. So the oracle is alive, and nobody else uses it.
        let oracle = unsafe { oracle.0.as_mut() };
        match question(oracle, &mut self.outside) {
            Ok(found) => Answer::Found(found),
            Err(stop) => {
                self.stop = Some((stop.clone(), Instant::now()));
                self.told.insert(thread::current().id());
                Answer::Stopped(stop)
            }
        }
    }
}

/// The only door from an optimiser to its problem: it counts evaluations and keeps the best.
///
/// Once the budget is spent, the next question raises `BudgetSpent`. After that every cost is infinite; a solver that goes on asking is
/// abandoned. Threads of a solver may share an oracle.
#[pyclass(module = "driftless", frozen)]
pub(crate) struct Oracle(pub(crate) Arc<Desk>);

impl Oracle {
    fn dimension_of(&self) -> usize {
        self.0.bounds.len()
    }

    fn costs(&self, py: Python<'_>, x: &Bound<'_, PyAny>) -> PyResult<Vec<Evaluation>> {
        let points = arrays::points(x, self.dimension_of())?;
        let count = points.len();
        if count == 0 {
            return Ok(Vec::new());
        }
        let found = self.0.ask(py, true, |oracle, outside| {
            let mut found = Vec::with_capacity(count);
            let (beyond, outcome) = oracle.evaluate_anywhere(points, &mut found);
            *outside += beyond;
            outcome.map(|()| found)
        })?;
        Ok(found.unwrap_or_else(|| vec![Evaluation::new(f64::INFINITY, f64::INFINITY); count]))
    }

    fn one(&self, py: Python<'_>, x: &Bound<'_, PyAny>) -> PyResult<Evaluation> {
        let mut points = Points::zeros(self.dimension_of(), 1);
        points[0].copy_from_slice(&arrays::point(x, self.dimension_of())?);
        let found = self.0.ask(py, false, |oracle, outside| {
            if oracle.bounds().snap(&mut points[0]) {
                return oracle.evaluate(&points[0]);
            }
            oracle.refuse()?;
            *outside += 1;
            Ok(Evaluation::new(f64::INFINITY, f64::INFINITY))
        })?;
        Ok(found.unwrap_or(Evaluation::new(f64::INFINITY, f64::INFINITY)))
    }

    /// What the oracle itself says, where its run is not over.
    fn look<R: Send>(
        &self,
        py: Python<'_>,
        question: impl FnOnce(&driftless::search::Oracle<'_>) -> R + Send,
    ) -> PyResult<R> {
        self.0.check_entry()?;
        let look = || {
            let state = self.0.lock();
            // SAFETY: as in `State::ask`.
            state.oracle.as_ref().map(|oracle| question(unsafe { oracle.0.as_ref() }))
        };
        py.detach(look).ok_or_else(|| errors::closed("the run of this oracle is over"))
    }

    /// Evaluations made, and left.
    fn counts(&self, py: Python<'_>) -> PyResult<(u64, u64)> {
        self.look(py, |oracle| (oracle.evaluations(), oracle.remaining()))
    }
}

#[pymethods]
impl Oracle {
    /// The number of variables, n.
    #[getter]
    fn dimension(&self) -> usize {
        self.dimension_of()
    }

    /// Lower bounds, shape (n,).
    #[getter]
    fn lower<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::walls(py, &self.0.bounds, 0)
    }

    /// Upper bounds, shape (n,).
    #[getter]
    fn upper<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::walls(py, &self.0.bounds, 1)
    }

    /// Evaluations that the run may spend.
    #[getter]
    fn budget(&self) -> u64 {
        self.0.budget
    }

    /// Evaluations that are left.
    #[getter]
    fn remaining(&self, py: Python<'_>) -> PyResult<u64> {
        Ok(self.counts(py)?.1)
    }

    /// Evaluations made.
    #[getter]
    fn evaluations(&self, py: Python<'_>) -> PyResult<u64> {
        Ok(self.counts(py)?.0)
    }

    /// The best point so far, shape (n,), and its cost.
    #[getter]
    fn best<'py>(&self, py: Python<'py>) -> PyResult<Option<(Bound<'py, PyArray1<f64>>, f64)>> {
        let best = self.look(py, |oracle| oracle.best().cloned())?;
        Ok(best.map(|best| (arrays::vector(py, best.x), best.evaluation.cost)))
    }

    /// Whether there are subgradients.
    #[getter]
    fn has_subgradient(&self) -> bool {
        self.0.has[0]
    }

    /// Whether the cost is a sum of terms with smooth pieces.
    #[getter]
    fn has_linearise(&self) -> bool {
        self.0.has[1]
    }

    /// The cost of a point, shape (n,): one evaluation.
    fn __call__(&self, py: Python<'_>, x: &Bound<'_, PyAny>) -> PyResult<f64> {
        Ok(self.one(py, x)?.cost)
    }

    /// Cost and violation of a point: one evaluation.
    fn evaluate(&self, py: Python<'_>, x: &Bound<'_, PyAny>) -> PyResult<(f64, f64)> {
        let found = self.one(py, x)?;
        Ok((found.cost, found.violation))
    }

    /// Costs of points, shape (m, n) to shape (m,): m evaluations.
    fn batch<'py>(
        &self,
        py: Python<'py>,
        x: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let found = self.costs(py, x)?;
        Ok(arrays::vector(py, found.into_iter().map(|found| found.cost).collect()))
    }

    /// Costs and violations of points: m evaluations.
    fn evaluate_batch(&self, py: Python<'_>, x: &Bound<'_, PyAny>) -> PyResult<Pair> {
        Ok(both(py, &self.costs(py, x)?))
    }

    /// The cost of a point within the box, with a subgradient: one evaluation.
    fn subgradient<'py>(
        &self,
        py: Python<'py>,
        x: &Bound<'py, PyAny>,
    ) -> PyResult<(f64, Bound<'py, PyArray1<f64>>)> {
        self.check(0)?;
        let x = inside(&self.0.bounds, x)?;
        let found = self.0.ask(py, true, |oracle, _| oracle.subgradient(&x))?;
        let found = found.ok_or_else(|| Stop::BudgetSpent.raised())?;
        Ok((found.evaluation.cost, arrays::vector(py, found.slopes.as_slice().to_vec())))
    }

    /// The cost of a point within the box as a sum of terms: one evaluation.
    fn linearise(&self, py: Python<'_>, x: &Bound<'_, PyAny>) -> PyResult<Linearisation> {
        self.check(1)?;
        let x = inside(&self.0.bounds, x)?;
        let found = self.0.ask(py, true, |oracle, _| oracle.linearise(&x))?;
        Linearisation::of(py, &found.ok_or_else(|| Stop::BudgetSpent.raised())?, x.len())
    }

    fn _enter(&self, py: Python<'_>) {
        py.detach(|| self.0.enter());
    }

    fn __repr__(&self) -> String {
        format!("<driftless.Oracle {} variables, budget {}>", self.dimension_of(), self.0.budget)
    }
}

impl Oracle {
    /// Whether there are derivatives of a kind. To ask for others is a mistake of the solver and no end of the search.
    fn check(&self, kind: usize) -> PyResult<()> {
        if self.0.has[kind] { Ok(()) } else { Err(Stop::NoDerivatives.raised()) }
    }
}
