//! An optimiser that is a process.

use serde::Deserialize;
use serde_json::Value;

use super::answer::{self, Answer, Opening};
use super::command::{Command, Patience};
use super::conversation::Conversation;
use super::numbers::Coordinates;
use super::request::{Request, plural};
use crate::optimiser::Optimiser;
use crate::search::{Bounds, Evaluation, Oracle, Points, Rng, Stop};

/// How far beyond a bound a coordinate is taken for the bound, as a share of the variable's range: rounding.
const ROUNDING: f64 = 1e-12;

/// An optimiser that is a process of its own: each run starts it, and asks the oracle what it asks.
#[derive(Debug, Clone)]
pub struct Solver {
    command: Command,
    settings: Value,
    formulation: Option<String>,
    patience: Patience,
}

impl Solver {
    /// A command that speaks the protocol, and the settings that it is told, a JSON object.
    pub fn new(command: Command, settings: Value) -> Self {
        Self { command, settings, formulation: None, patience: Patience::default() }
    }

    /// The same in the variables of a formulation.
    #[must_use]
    pub fn in_formulation(self, formulation: Option<String>) -> Self {
        Self { formulation, ..self }
    }

    /// The same with other deadlines.
    #[must_use]
    pub fn with_patience(self, patience: Patience) -> Self {
        Self { patience, ..self }
    }

    /// What is started.
    pub fn command(&self) -> &Command {
        &self.command
    }
}

impl Optimiser for Solver {
    fn minimise(&self, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop> {
        let mut has = vec!["batch", "violation"];
        has.extend(oracle.has_subgradients().then_some("subgradient"));
        has.extend(oracle.has_terms().then_some("linearise"));
        let size = (rng.seed(), oracle.remaining());
        let opening = answer::line(&Opening::new(oracle.bounds(), has, size, &self.settings));
        self.command.check_files()?;
        let mut process =
            Conversation::open(&self.command, self.patience, "before it was done", opening)?;
        let mut search = Search { process: &mut process, outside: 0 };
        let outcome = search.run(oracle);
        oracle.stop_clock();
        if search.outside > 0 {
            let points = plural(search.outside, "point");
            oracle.remark(format!("{points} outside the box cost infinitely much"));
        }
        // A run of a program that was edited meanwhile is none of the one that the experiment names.
        let outcome = match outcome {
            Err(Stop::Interrupted) => outcome,
            _ => self.command.check_files().map_err(Stop::from).and(outcome),
        };
        let reason = match &outcome {
            Ok(()) => None,
            Err(Stop::BudgetSpent) => Some("budget"),
            Err(Stop::Interrupted) => Some("interrupted"),
            Err(_) => Some("failed"),
        };
        if let Some(reason) = reason {
            process.say(answer::line(&serde_json::json!({ "stop": reason })));
        }
        process.close();
        outcome
    }

    fn formulation(&self) -> Option<&str> {
        self.formulation.as_deref()
    }
}

/// What a solver says of itself; nothing need be said.
#[derive(Debug, Deserialize)]
struct Hello {
    #[serde(default, rename = "name")]
    _name: Option<String>,
    #[serde(default, rename = "version")]
    _version: Option<String>,
}

/// A run.
struct Search<'a> {
    process: &'a mut Conversation,
    /// Points that were outside the box.
    outside: usize,
}

impl Search<'_> {
    fn run(&mut self, oracle: &mut Oracle<'_>) -> Result<(), Stop> {
        let _: Hello = self.process.greet(&|| oracle.is_interrupted())?;
        oracle.start_clock();
        loop {
            let line = self.process.hear(1, &|| oracle.is_interrupted())?;
            let request = Request::read(&line);
            match request.map_err(|failure| self.process.failure(failure.reason()))? {
                Request::Costs(id, x) => self.costs(oracle, id.as_ref(), &x)?,
                Request::Slopes(id, x) => {
                    let x = self.point(oracle.bounds(), &x)?;
                    let found = oracle.subgradient(&x)?;
                    let answer = Answer::slopes(id.as_ref(), &found, oracle.remaining());
                    self.process.say(answer::line(&answer));
                }
                Request::Terms(id, x) => {
                    let x = self.point(oracle.bounds(), &x)?;
                    let found = oracle.linearise(&x)?;
                    let answer = Answer::terms(id.as_ref(), &found, oracle.remaining());
                    self.process.say(answer::line(&answer));
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
            return Err(self.process.failure("asked for the costs of no points").into());
        }
        let points = x.points(oracle.bounds().len());
        let points = points.map_err(|failure| self.process.failure(failure.reason()))?;
        let mut found = Vec::new();
        let outcome = self.evaluate(oracle, points, &mut found);
        if !found.is_empty() {
            let answer = Answer::costs(id, &found, x.is_single, oracle.remaining());
            self.process.say(answer::line(&answer));
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
        Err(self.process.failure(&wrong).into())
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
