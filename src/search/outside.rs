//! What callers outside the crate ask, who may ask anything: points beyond the box cost infinitely much.

use super::evaluation::Evaluation;
use super::oracle::{Oracle, Stop};
use super::points::{Bounds, Points};

/// How far beyond a bound a coordinate is taken for the bound, as a share of the variable's range: rounding.
const ROUNDING: f64 = 1e-12;

impl Bounds {
    /// Puts a point that is outside the box by rounding onto its walls; whether it is inside then.
    pub fn snap(&self, x: &mut [f64]) -> bool {
        for (value, [lower, upper]) in x.iter_mut().zip(self.iter()) {
            let room = ROUNDING * (upper - lower);
            if *value >= lower - room && *value <= upper + room {
                *value = value.clamp(lower, upper);
            }
        }
        self.contains(x)
    }
}

impl Oracle<'_> {
    /// Evaluates points in their order, wherever they are, and puts what it finds into `found`: all, or those that came before the
    /// stop. Points outside the box cost infinitely much and count; how many these were.
    pub fn evaluate_anywhere(
        &mut self,
        mut points: Points,
        found: &mut Vec<Evaluation>,
    ) -> (usize, Result<(), Stop>) {
        let bounds = self.bounds();
        let is_inside: Vec<bool> = (0..points.len()).map(|i| bounds.snap(&mut points[i])).collect();
        let (mut place, mut outside) = (0, 0);
        for inside in is_inside.chunk_by(|a, b| a == b) {
            let outcome = if inside[0] {
                let mut part = Points::zeros(points.dimension(), inside.len());
                (0..inside.len()).for_each(|i| part[i].copy_from_slice(&points[place + i]));
                let before = self.evaluations();
                let mut answers = vec![Evaluation::default(); inside.len()];
                let outcome = self.evaluate_batch(&part, &mut answers);
                let made = (self.evaluations() - before) as usize;
                let is_answered = matches!(outcome, Ok(()) | Err(Stop::BudgetSpent));
                found.extend(answers.into_iter().take(if is_answered { made } else { 0 }));
                outcome
            } else {
                inside.iter().try_for_each(|_| {
                    self.refuse()?;
                    outside += 1;
                    found.push(Evaluation::new(f64::INFINITY, f64::INFINITY));
                    Ok(())
                })
            };
            if outcome.is_err() {
                return (outside, outcome);
            }
            place += inside.len();
        }
        (outside, Ok(()))
    }

    /// Remarks on how many points were outside the box, where any were.
    pub fn remark_outside(&mut self, points: usize) {
        if points > 0 {
            let s = if points == 1 { "" } else { "s" };
            self.remark(format!("{points} point{s} outside the box cost infinitely much"));
        }
    }
}
