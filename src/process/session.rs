//! What a solver asks, and the answers of an oracle.

use serde::Deserialize;
use serde_json::Value;

use super::answer::{self, Answer, Opening};
use super::conversation::Conversation;
use super::numbers::Coordinates;
use super::request::Request;
use crate::search::{Bounds, Oracle, Rng, Stop};
use crate::words::plural;

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
        oracle.remark_outside(self.outside);
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
        let (outside, outcome) = oracle.evaluate_anywhere(points, &mut found);
        self.outside += outside;
        if !found.is_empty() {
            let answer = Answer::costs(id, &found, x.is_single, oracle.remaining());
            self.peer.say(answer::line(&answer));
        }
        outcome
    }

    /// The only point of a request for derivatives, which there are within the box alone.
    fn point(&mut self, bounds: &Bounds, x: &Coordinates) -> Result<Vec<f64>, Stop> {
        let wrong = match x.single() {
            Err(failure) => failure.reason().to_owned(),
            Ok(x) if x.len() != bounds.len() => {
                let found = plural(x.len(), "variable");
                format!("sent a point with {found}, expected {}", bounds.len())
            }
            Ok(x) => {
                let mut x = x.to_vec();
                if bounds.snap(&mut x) {
                    return Ok(x);
                }
                "asked for derivatives outside the box".to_owned()
            }
        };
        Err(self.peer.failure(&wrong).into())
    }
}
