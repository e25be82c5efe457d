//! What a solver asks, and the answers of an oracle.

use serde::Deserialize;
use serde_json::Value;

use super::answer::{self, Answer, Opening};
use super::conversation::Conversation;
use super::numbers::Coordinates;
use super::request::{Request, plural};
use crate::search::{Bounds, Evaluation, Oracle, Points, Rng, Stop};

/// How far beyond a bound a coordinate is taken for the bound, as a share of the variable's range: rounding.
const ROUNDING: f64 = 1e-12;

/// What a solver says of itself; nothing need be said.
#[derive(Debug, Deserialize)]
struct Hello {
    #[serde(default)]
    name: Option<String>,
    #[serde(default, rename = "version")]
    _version: Option<String>,
}

/// The first line to a solver.
pub(super) fn opening(oracle: &Oracle<'_>, rng: &Rng, settings: &Value) -> String {
    let mut has = vec!["batch", "violation"];
    has.extend(oracle.has_subgradients().then_some("subgradient"));
    has.extend(oracle.has_terms().then_some("linearise"));
    let size = (rng.seed(), oracle.remaining());
    answer::line(&Opening::new(oracle.bounds(), has, size, settings))
}

/// A search, from `hello` to its end.
pub(super) struct Session<'a> {
    peer: &'a mut Conversation,
    /// What the solver calls itself.
    pub(super) name: Option<String>,
    /// Points that were outside the box.
    outside: usize,
}

impl<'a> Session<'a> {
    pub(super) fn new(peer: &'a mut Conversation) -> Self {
        Self { peer, name: None, outside: 0 }
    }

    /// Answers until the search is over.
    pub(super) fn run(&mut self, oracle: &mut Oracle<'_>) -> Result<(), Stop> {
        let outcome = self.answer(oracle);
        oracle.stop_clock();
        if self.outside > 0 {
            let points = plural(self.outside, "point");
            oracle.remark(format!("{points} outside the box cost infinitely much"));
        }
        outcome
    }

    /// Says why the search is over, unless it ended by itself.
    pub(super) fn tell_end(&self, outcome: &Result<(), Stop>) {
        let message = match outcome {
            Ok(()) => return,
            Err(Stop::BudgetSpent) => serde_json::json!({ "stop": "budget" }),
            Err(Stop::Interrupted) => serde_json::json!({ "stop": "interrupted" }),
            Err(stop) => serde_json::json!({ "stop": "failed", "error": stop.to_string() }),
        };
        self.peer.say(answer::line(&message));
    }

    fn answer(&mut self, oracle: &mut Oracle<'_>) -> Result<(), Stop> {
        let hello: Hello = self.peer.greet(&|| oracle.is_interrupted())?;
        self.name = hello.name;
        oracle.start_clock();
        loop {
            let line = self.peer.hear(1, &|| oracle.is_interrupted())?;
            let request = Request::read(&line);
            match request.map_err(|failure| self.peer.failure(failure.reason()))? {
                Request::Costs(id, x) => self.costs(oracle, id.as_ref(), &x)?,
                Request::Slopes(id, x) => {
                    let x = self.point(oracle.bounds(), &x)?;
                    let found = oracle.subgradient(&x)?;
                    let answer = Answer::slopes(id.as_ref(), &found, oracle.remaining());
                    self.peer.say(answer::line(&answer));
                }
                Request::Terms(id, x) => {
                    let x = self.point(oracle.bounds(), &x)?;
                    let found = oracle.linearise(&x)?;
                    let answer = Answer::terms(id.as_ref(), &found, oracle.remaining());
                    self.peer.say(answer::line(&answer));
                }
                Request::Done => return Ok(()),
            }
        }
    }

    /// Answers with the costs that the budget is enough for; then, where it is not enough for all, it is spent.
    fn costs(
        &mut self,
        oracle: &mut Oracle<'_>,
        id: Option<&Value>,
        x: &Coordinates,
    ) -> Result<(), Stop> {
        if x.len() == 0 {
            return Err(self.peer.failure("asked for the costs of no points").into());
        }
        let points = x.points(oracle.bounds().len());
        let points = points.map_err(|failure| self.peer.failure(failure.reason()))?;
        let mut found = Vec::new();
        let outcome = self.evaluate(oracle, points, &mut found);
        if !found.is_empty() {
            let answer = Answer::costs(id, &found, x.is_single, oracle.remaining());
            self.peer.say(answer::line(&answer));
        }
        outcome
    }

    /// Evaluates points in their order.
    fn evaluate(
        &mut self,
        oracle: &mut Oracle<'_>,
        mut points: Points,
        found: &mut Vec<Evaluation>,
    ) -> Result<(), Stop> {
        let bounds = oracle.bounds();
        let is_inside: Vec<bool> =
            (0..points.len()).map(|i| put_into(bounds, &mut points[i])).collect();
        let mut place = 0;
        for inside in is_inside.chunk_by(|a, b| a == b) {
            if inside[0] {
                let mut part = Points::zeros(points.dimension(), inside.len());
                (0..inside.len()).for_each(|i| part[i].copy_from_slice(&points[place + i]));
                let before = oracle.evaluations();
                let mut answers = vec![Evaluation::default(); inside.len()];
                let outcome = oracle.evaluate_batch(&part, &mut answers);
                let made = (oracle.evaluations() - before) as usize;
                let is_answered = matches!(outcome, Ok(()) | Err(Stop::BudgetSpent));
                found.extend(answers.into_iter().take(if is_answered { made } else { 0 }));
                outcome?;
            } else {
                for _ in inside {
                    oracle.refuse()?;
                    self.outside += 1;
                    found.push(Evaluation::new(f64::INFINITY, f64::INFINITY));
                }
            }
            place += inside.len();
        }
        Ok(())
    }

    /// The only point of a request for derivatives, which there are within the box alone.
    fn point(&mut self, bounds: &Bounds, x: &Coordinates) -> Result<Vec<f64>, Stop> {
        let wrong = match x.single() {
            Err(failure) => failure.reason().to_owned(),
            Ok(x) if x.len() != bounds.len() => {
                format!("sent a point with {} variables, expected {}", x.len(), bounds.len())
            }
            Ok(x) => {
                let mut x = x.to_vec();
                if put_into(bounds, &mut x) {
                    return Ok(x);
                }
                "asked for derivatives outside the box".to_owned()
            }
        };
        Err(self.peer.failure(&wrong).into())
    }
}

/// Puts a point that is outside the box by rounding onto its walls; whether it is inside then.
fn put_into(bounds: &Bounds, x: &mut [f64]) -> bool {
    for (value, [lower, upper]) in x.iter_mut().zip(bounds.iter()) {
        let room = ROUNDING * (upper - lower);
        if *value >= lower - room && *value <= upper + room {
            *value = value.clamp(lower, upper);
        }
    }
    bounds.contains(x)
}
