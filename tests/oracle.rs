//! What the oracle makes of problems that fail and of optimisers that ask the impossible.

use std::sync::atomic::{AtomicU64, Ordering};

use driftless::search::{Bounds, Evaluation, Failure, Oracle, Points, Problem, Stop, Watch};

/// What a problem does with a batch.
#[derive(Clone, Copy)]
enum Batch {
    Default,
    /// Answers so many times, whatever it was asked.
    Answers(usize),
}

/// Costs 1, ½, ⅓, …; one call fails.
struct Fails {
    at: u64,
    batch: Batch,
    bounds: Bounds,
    calls: AtomicU64,
}

impl Fails {
    fn at(at: u64, batch: Batch) -> Self {
        Self { at, batch, bounds: Bounds::cube(2, [0.0, 1.0]), calls: AtomicU64::new(0) }
    }
}

impl Problem for Fails {
    fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    fn evaluate(&self, _: &[f64]) -> Result<Evaluation, Failure> {
        let call = self.calls.fetch_add(1, Ordering::Relaxed) + 1;
        if call == self.at {
            Err("the licence expired".into())
        } else {
            Ok((1.0 / call as f64).into())
        }
    }

    fn evaluate_batch(
        &self,
        points: &Points,
        each: &mut dyn FnMut(Evaluation),
    ) -> Result<(), Failure> {
        let count = match self.batch {
            Batch::Default => points.len(),
            Batch::Answers(count) => count,
        };
        for _ in 0..count {
            each(self.evaluate(&[0.0; 2])?);
        }
        Ok(())
    }
}

fn failed(reason: &str) -> Result<(), Stop> {
    Err(Stop::Failed(Failure::new(reason)))
}

#[test]
fn an_evaluation_that_fails_counts_and_leaves_what_was_found() {
    for call in 1..=9 {
        let (problem, watch) = (Fails::at(call, Batch::Default), Watch::default());
        let mut oracle = Oracle::new(&problem, 8, &watch);
        let mut out = [Evaluation::default(); 5];
        let stop = loop {
            if let Err(stop) = oracle.evaluate_batch(&Points::zeros(2, 5), &mut out) {
                break stop;
            }
        };
        let expected =
            if call <= 8 { failed("the licence expired") } else { Err(Stop::BudgetSpent) };
        assert_eq!(Err(stop), expected);
        assert_eq!((oracle.evaluations(), watch.evaluations()), (call.min(8), call.min(8)));
        let returned = call.min(9) - 1;
        let best = oracle.best().map(|best| best.evaluation.cost);
        assert_eq!(best, (returned > 0).then(|| 1.0 / returned as f64));
        let trace = oracle.into_trace();
        assert_eq!(trace.last().map(|row| row.evaluation), best.map(|_| call.min(8)));
    }
}

#[test]
fn one_point_that_fails_counts() {
    let (problem, watch) = (Fails::at(2, Batch::Default), Watch::default());
    let mut oracle = Oracle::new(&problem, 9, &watch);
    assert_eq!(oracle.evaluate(&[0.0; 2]), Ok(1.0.into()));
    assert_eq!(oracle.evaluate(&[0.0; 2]).map(drop), failed("the licence expired"));
    assert_eq!(oracle.evaluations(), 2);
}

/// Of too few answers the first that is missing counts, as one that failed.
#[test]
fn a_batch_answers_once_per_point() {
    for (answers, evaluations) in [(0, 1), (3, 4), (5, 5), (7, 5)] {
        let (problem, watch) = (Fails::at(0, Batch::Answers(answers)), Watch::default());
        let mut oracle = Oracle::new(&problem, 100, &watch);
        let mut out = [Evaluation::from(-1.0); 6];
        let outcome = oracle.evaluate_batch(&Points::zeros(2, 5), &mut out);
        let reason = format!("found {answers} answers to a batch of 5 points, expected 5");
        assert_eq!(outcome, if answers == 5 { Ok(()) } else { failed(&reason) });
        assert_eq!(oracle.evaluations(), evaluations);
        let best = oracle.best().map(|best| best.evaluation.cost);
        let kept = answers.min(5);
        assert_eq!(best, (kept > 0).then(|| 1.0 / kept as f64));
        assert!(out[kept..].iter().all(|evaluation| evaluation.cost == -1.0));
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let (problem, watch) = (Fails::at(0, Batch::Default), Watch::default());
    let mut oracle = Oracle::new(&problem, 100, &watch);
    let expected = failed("found a point with 3 variables, expected 2");
    assert_eq!(oracle.evaluate(&[0.0; 3]).map(drop), expected);
    let mut out = [Evaluation::default(); 4];
    assert_eq!(oracle.evaluate_batch(&Points::zeros(3, 4), &mut out), expected);
    assert_eq!(
        oracle.evaluate_batch(&Points::zeros(2, 5), &mut out),
        failed("found room for 4 evaluations, expected 5, one per point")
    );
    assert_eq!(oracle.evaluate_batch(&Points::zeros(2, 0), &mut out), Ok(()));
    assert_eq!(oracle.evaluations(), 0);
}
