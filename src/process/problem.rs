//! A problem that is a program.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::answer::{self, VERSION};
use super::command::{Command, Patience};
use super::conversation::Conversation;
use super::numbers::Numbers;
use super::request::{parsed, shortened};
use crate::search::{Bounds, Evaluation, Failure, Points, Problem, Stop, Watch};
use crate::words::plural;

/// By how much a cost may be below the least one, as a share of it or of one.
const ROUNDING: f64 = 1e-9;

/// Points of a batch that are asked for at once.
const AT_ONCE: usize = 256;

/// A program that says what points cost, and its processes.
#[derive(Debug)]
pub struct Program {
    command: Command,
    settings: Value,
    patience: Patience,
    /// Processes that nobody speaks with.
    idle: Mutex<Vec<Conversation>>,
}

/// What a program says of the problem that it is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Told {
    /// The lower bounds.
    pub lower: Vec<f64>,
    /// The upper bounds.
    pub upper: Vec<f64>,
    /// The least cost, where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub least_cost: Option<f64>,
    /// The cost in the middle of the box.
    #[serde(default = "unknown")]
    pub start_cost: f64,
}

fn unknown() -> f64 {
    f64::NAN
}

/// What a program says first.
#[derive(Debug, Deserialize)]
struct Hello {
    #[serde(default)]
    dimension: Option<usize>,
    lower: Numbers,
    upper: Numbers,
    #[serde(default)]
    least_cost: Option<f64>,
}

/// Costs of points.
#[derive(Debug, Deserialize)]
struct Reply {
    #[serde(default)]
    id: Option<u64>,
    #[serde(default)]
    cost: Option<Numbers>,
    #[serde(default)]
    violation: Option<Numbers>,
    #[serde(default)]
    error: Option<String>,
}

/// A question.
#[derive(Debug, Serialize)]
struct Question<'a> {
    id: u64,
    x: Vec<&'a [f64]>,
}

/// Nobody wants the program to end.
fn never() -> bool {
    false
}

impl Program {
    /// A command that speaks the protocol as a problem, and the settings that it is told, a JSON object.
    pub fn new(command: Command, settings: Value, patience: Patience) -> Self {
        Self { command, settings, patience, idle: Mutex::default() }
    }

    /// What is started.
    pub fn command(&self) -> &Command {
        &self.command
    }

    /// Starts it and asks what problem it is, and for the cost in the middle of its box.
    pub fn ask(self: &Arc<Self>) -> Result<Told, Failure> {
        let (process, Hello { lower, upper, least_cost, .. }) = self.start(&never)?;
        let mut told = Told { lower: lower.0, upper: upper.0, least_cost, start_cost: f64::NAN };
        self.give_back(process);
        let middle: Vec<f64> =
            told.lower.iter().zip(&told.upper).map(|(a, b)| a + 0.5 * (b - a)).collect();
        // A cost below the least one fails here, too.
        told.start_cost = self.problem(&told)?.evaluate(&middle)?.cost;
        Ok(told)
    }

    /// The problem, as the program has told of it; a process of its own for each.
    pub fn problem(self: &Arc<Self>, told: &Told) -> Result<Served, Failure> {
        let pairs = told.lower.iter().zip(&told.upper).map(|(a, b)| [*a, *b]).collect();
        Ok(Served {
            program: self.clone(),
            bounds: Bounds::new(pairs)?,
            least_cost: told.least_cost,
            talk: Mutex::default(),
            interrupted: OnceLock::new(),
        })
    }

    fn start(&self, is_interrupted: &dyn Fn() -> bool) -> Result<(Conversation, Hello), Failure> {
        self.command.check_files()?;
        let opening = serde_json::json!({
            "driftless": VERSION, "role": "problem", "settings": self.settings,
        });
        let mut process = Conversation::open(
            &self.command,
            self.patience,
            "while costs were asked of it",
            answer::line(&opening),
        )?;
        let hello: Hello = process.greet(is_interrupted).map_err(failed)?;
        let (count, others) = (hello.lower.0.len(), hello.upper.0.len());
        let dimension = hello.dimension.unwrap_or(count);
        if count == dimension && others == dimension {
            let pairs = hello.lower.0.iter().zip(&hello.upper.0).map(|(a, b)| [*a, *b]);
            return match Bounds::new(pairs.collect()) {
                Ok(_) => Ok((process, hello)),
                Err(error) => Err(process.failure(&format!("told of a box that is none: {error}"))),
            };
        }
        Err(process.failure(&format!(
            "told of {}, {count} lower and {others} upper bounds",
            plural(dimension, "variable")
        )))
    }

    fn idle(&self) -> MutexGuard<'_, Vec<Conversation>> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn give_back(&self, process: Conversation) {
        self.idle().push(process);
    }
}

fn failed(stop: Stop) -> Failure {
    match stop {
        Stop::Failed(failure) => failure,
        other => Failure::new(other.to_string()),
    }
}

/// A problem whose costs a process tells.
#[derive(Debug)]
pub struct Served {
    program: Arc<Program>,
    bounds: Bounds,
    least_cost: Option<f64>,
    talk: Mutex<Talk>,
    interrupted: OnceLock<Arc<AtomicBool>>,
}

/// Words with a process, once there are any.
#[derive(Debug, Default)]
struct Talk {
    process: Option<Conversation>,
    /// Why there is none.
    failure: Option<Failure>,
}

impl Served {
    fn is_interrupted(&self) -> bool {
        self.interrupted.get().is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// The process, started where there is none. After a failure there is none any more.
    fn process<'a>(&self, talk: &'a mut Talk) -> Result<&'a mut Conversation, Failure> {
        if talk.process.is_none() && talk.failure.is_none() {
            let idle = self.program.idle().pop();
            match idle.map_or_else(|| self.fresh(), Ok) {
                Ok(process) => talk.process = Some(process),
                Err(failure) => talk.failure = Some(failure),
            }
        }
        let Talk { process, failure, .. } = talk;
        process
            .as_mut()
            .ok_or_else(|| failure.clone().unwrap_or_else(|| Failure::new("there is no process")))
    }

    /// A process that is the same problem as those before it.
    fn fresh(&self) -> Result<Conversation, Failure> {
        let (mut process, hello) = self.program.start(&|| self.is_interrupted())?;
        let pairs = hello.lower.0.iter().zip(&hello.upper.0).map(|(a, b)| [*a, *b]);
        if pairs.eq(self.bounds.iter()) {
            Ok(process)
        } else {
            Err(process.failure("told of another box than before"))
        }
    }

    /// Asks for costs; a process that fails is not asked again.
    fn ask(&self, points: &[&[f64]]) -> Result<Vec<Evaluation>, Failure> {
        let mut talk = self.talk.lock().unwrap_or_else(PoisonError::into_inner);
        let process = self.process(&mut talk)?;
        let id = process.next_id();
        process.say(answer::line(&Question { id, x: points.to_vec() }));
        let times = u32::try_from(points.len()).unwrap_or(u32::MAX);
        let found =
            process.hear(times, &|| self.is_interrupted()).map_err(failed).and_then(|line| {
                evaluations(&line, id, points.len(), self.least_cost)
                    .map_err(|wrong| process.failure(&wrong))
            });
        if let Err(failure) = &found {
            talk.process = None;
            talk.failure = Some(failure.clone());
        }
        found
    }
}

/// The costs of a reply to a question about so many points, or what is wrong with it.
fn evaluations(
    line: &str,
    id: u64,
    count: usize,
    least_cost: Option<f64>,
) -> Result<Vec<Evaluation>, String> {
    let reply: Reply = parsed(line).map_err(|failure| failure.reason().to_owned())?;
    if let Some(error) = reply.error {
        let error = error.split_whitespace().collect::<Vec<_>>().join(" ");
        return Err(format!(
            "failed: {}",
            if error.is_empty() { "no reason given" } else { &error }
        ));
    }
    if reply.id.is_some_and(|found| found != id) {
        return Err(format!("sent `{}`, expected an answer to {id}", shortened(line)));
    }
    let Some(Numbers(costs)) = reply.cost else {
        return Err(format!("sent `{}`, expected a `cost`", shortened(line)));
    };
    if costs.len() != count {
        return Err(format!("sent {} for {}", plural(costs.len(), "cost"), plural(count, "point")));
    }
    let violations = reply.violation.map_or_else(|| vec![0.0; count], |found| found.0);
    if violations.len() != count {
        let found = plural(violations.len(), "violation");
        return Err(format!("sent {found} for {}", plural(count, "point")));
    }
    if let Some(wrong) =
        violations.iter().find(|violation| !(0.0..f64::INFINITY).contains(*violation))
    {
        return Err(format!(
            "sent a violation of {wrong}, expected a finite number, zero or above"
        ));
    }
    let least = least_cost.unwrap_or(f64::NEG_INFINITY);
    if let Some(cost) = costs.iter().find(|cost| **cost < least - ROUNDING * least.abs().max(1.0)) {
        return Err(format!(
            "sent a cost of {cost:e}, below the least cost {least:e} that it told of"
        ));
    }
    let pairs = costs.into_iter().zip(violations);
    Ok(pairs.map(|(cost, violation)| Evaluation::new(cost, violation)).collect())
}

impl Problem for Served {
    fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    fn evaluate(&self, x: &[f64]) -> Result<Evaluation, Failure> {
        let found = self.ask(&[x])?;
        Ok(found[0])
    }

    fn evaluate_batch(
        &self,
        points: &Points,
        each: &mut dyn FnMut(Evaluation),
    ) -> Result<(), Failure> {
        let all: Vec<&[f64]> = points.iter().collect();
        for some in all.chunks(AT_ONCE) {
            self.ask(some)?.into_iter().for_each(&mut *each);
        }
        Ok(())
    }

    fn prepare(&self, watch: &Watch) {
        let _ = self.interrupted.set(watch.flag());
        // What goes wrong here goes wrong again when it is asked, and is told then.
        let _ = self.process(&mut self.talk.lock().unwrap_or_else(PoisonError::into_inner));
    }

    fn least_cost(&self) -> Option<f64> {
        self.least_cost
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let is_interrupted = self.is_interrupted();
        let talk = self.talk.get_mut().unwrap_or_else(PoisonError::into_inner);
        if let Some(process) = talk.process.take()
            && !is_interrupted
        {
            self.program.give_back(process);
        }
    }
}
