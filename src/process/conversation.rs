//! Words with a process or a client, within their deadlines.

use std::time::{Duration, Instant};

use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::child::Child;
use super::command::{Command, Patience};
use super::guest::Guest;
use super::lines::{Line, Lines};
use super::request::parsed;
use crate::search::{Failure, Stop};

/// How often a program that does not read its answers is looked at.
const PAUSE: Duration = Duration::from_millis(1);

/// How often an interruption is looked for.
const LOOK: Duration = Duration::from_millis(50);

/// Who is spoken with.
#[derive(Debug)]
enum Peer {
    /// A process of this program.
    Process(Child),
    /// A client that connected.
    Guest(Guest),
}

/// A process or a client that is spoken with.
#[derive(Debug)]
pub(super) struct Conversation {
    peer: Peer,
    name: String,
    /// When it should not end.
    too_early: &'static str,
    patience: Patience,
    /// How many questions it was asked.
    questions: u64,
    /// How long it was waited for since it said `hello`.
    waited: Duration,
}

impl Conversation {
    /// Starts a process and says the first line; `too_early` says when it should not end.
    pub(super) fn open(
        command: &Command,
        patience: Patience,
        too_early: &'static str,
        opening: String,
    ) -> Result<Self, Failure> {
        let peer = Peer::Process(Child::start(command)?);
        let process = Self::with(peer, format!("`{command}`"), patience, too_early);
        process.say(opening);
        Ok(process)
    }

    /// With a client, which is waited for as long as it takes.
    pub(super) fn with_guest(guest: Guest) -> Self {
        let patience = Patience { start: Duration::MAX, silence: Duration::MAX, search: None };
        Self::with(Peer::Guest(guest), "the client".to_owned(), patience, "before it was done")
    }

    fn with(peer: Peer, name: String, patience: Patience, too_early: &'static str) -> Self {
        Self { peer, name, too_early, patience, questions: 0, waited: Duration::ZERO }
    }

    /// The number of the next question, unlike all before.
    pub(super) fn next_id(&mut self) -> u64 {
        self.questions += 1;
        self.questions - 1
    }

    fn lines(&self) -> &Lines {
        match &self.peer {
            Peer::Process(child) => &child.lines,
            Peer::Guest(guest) => &guest.lines,
        }
    }

    /// Says a line.
    pub(super) fn say(&self, line: String) {
        self.lines().say(line);
    }

    /// Waits until it is ready; what it says of itself.
    pub(super) fn greet<T: DeserializeOwned>(
        &mut self,
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<T, Stop> {
        #[derive(Deserialize)]
        struct Greeting<T> {
            hello: T,
        }
        let start = self.patience.start;
        let line = self.line(start, is_interrupted, || {
            format!("did not say `hello` within {} s", start.as_secs_f64())
        })?;
        match parsed::<serde_json::Value>(&line) {
            Ok(value) if value.get("hello").is_none() => {
                Err(self.failure("said something before it said `hello`").into())
            }
            Err(failure) => Err(self.failure(failure.reason()).into()),
            Ok(_) => match parsed::<Greeting<T>>(&line) {
                Ok(greeting) => Ok(greeting.hello),
                Err(failure) => Err(self.failure(failure.reason()).into()),
            },
        }
    }

    /// The next line. Silence for so many times its patience, a line that is no text and its end are failures.
    pub(super) fn hear(
        &mut self,
        times: u32,
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<String, Stop> {
        let began = Instant::now();
        let Patience { silence, search, .. } = self.patience;
        let silence = silence.saturating_mul(times);
        let left = search.map(|search| search.saturating_sub(self.waited));
        let line = match (left, search) {
            (Some(left), Some(search)) if left < silence => self.line(left, is_interrupted, || {
                format!("took more than {} s of its own time", search.as_secs_f64())
            }),
            _ => self.line(silence, is_interrupted, || {
                format!(
                    "said nothing for {} s; does it flush its output after every line?",
                    silence.as_secs_f64()
                )
            }),
        };
        self.waited += began.elapsed();
        line
    }

    fn line(
        &mut self,
        patience: Duration,
        is_interrupted: &dyn Fn() -> bool,
        gave_out: impl Fn() -> String,
    ) -> Result<String, Stop> {
        let deadline = Instant::now().checked_add(patience);
        let line = loop {
            if is_interrupted() {
                return Err(Stop::Interrupted);
            }
            let look = Instant::now() + LOOK;
            let until = deadline.map_or(look, |deadline| deadline.min(look));
            let is_behind = self.lines().is_behind();
            let line = if is_behind {
                std::thread::sleep(PAUSE);
                None
            } else {
                self.lines().next(until)
            };
            if let Some(line) = line {
                break line;
            }
            if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
                let what =
                    if is_behind { "does not read its answers".to_owned() } else { gave_out() };
                return Err(self.failure(&what).into());
            }
        };
        match line {
            Line::Message(line) => Ok(line),
            Line::NotText => Err(self.failure("sent a line that is not UTF-8").into()),
            Line::TooLong => Err(self.failure("sent a line of more than 64 MiB").into()),
            Line::End => Err(self.ended().into()),
        }
    }

    /// Ends the process, with all that it has started, or says nothing more to the client.
    pub(super) fn close(&mut self) {
        match &mut self.peer {
            Peer::Process(child) => {
                child.end();
            }
            Peer::Guest(guest) => guest.end(),
        }
    }

    /// What it did wrong, with its last words. A process is ended; what it says to that is no part of them.
    pub(super) fn failure(&mut self, what: &str) -> Failure {
        let failure = self.told(what);
        if let Peer::Process(child) = &mut self.peer {
            child.end();
        }
        failure
    }

    fn ended(&mut self) -> Failure {
        let status = match &mut self.peer {
            Peer::Process(child) => child.end(),
            Peer::Guest(_) => None,
        };
        let how = status
            .map_or_else(|| "closed its output".to_owned(), |status| format!("ended ({status})"));
        self.told(&format!("{how} {}", self.too_early))
    }

    fn told(&self, what: &str) -> Failure {
        let words = self.lines().last_words();
        let words = if words.is_empty() { words } else { format!("; its last words: {words}") };
        Failure::new(format!("{} {what}{words}", self.name))
    }
}
