//! An optimiser that is a client: it connected by itself and is in charge.

use std::sync::{Mutex, MutexGuard, PoisonError};

use serde::Serialize;

use super::answer;
use super::conversation::Conversation;
use super::guest::Guest;
use super::session::{Session, opening};
use super::socket::Socket;
use crate::optimiser::Optimiser;
use crate::search::{Failure, Oracle, Rng, Stop};

/// An optimiser that searches from outside, over this program's standard streams or a [`Socket`]. It can search once.
#[derive(Debug)]
pub struct Client {
    talk: Mutex<Talk>,
}

#[derive(Debug)]
struct Talk {
    conversation: Conversation,
    name: Option<String>,
    /// Whether it was told that its search is over.
    is_told: bool,
}

impl Client {
    /// Whoever is on the other side of standard input and output.
    pub fn on_standard_streams() -> Result<Self, Failure> {
        Ok(Self::of(Guest::on_standard_streams()?))
    }

    /// Whoever comes to a socket and shows its token.
    pub fn on_socket(socket: Socket) -> Result<Self, Failure> {
        Ok(Self::of(Guest::on_socket(socket)?))
    }

    fn of(guest: Guest) -> Self {
        let conversation = Conversation::with_guest(guest);
        Self { talk: Mutex::new(Talk { conversation, name: None, is_told: false }) }
    }

    /// What it calls itself.
    pub fn name(&self) -> String {
        self.talk().name.clone().unwrap_or_else(|| "client".to_owned())
    }

    /// Says that its search has come to nothing, unless that was said, and nothing more.
    pub fn refuse(&self, error: &str) {
        let mut talk = self.talk();
        if !talk.is_told {
            talk.conversation
                .say(answer::line(&serde_json::json!({ "stop": "failed", "error": error })));
        }
        talk.conversation.close();
    }

    /// Says what its search has come to, and nothing more.
    pub fn tell(&self, result: &impl Serialize) {
        let mut talk = self.talk();
        talk.conversation.say(answer::line(&serde_json::json!({ "result": result })));
        talk.conversation.close();
    }

    fn talk(&self) -> MutexGuard<'_, Talk> {
        self.talk.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Optimiser for Client {
    fn minimise(&self, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop> {
        let Talk { conversation, name, is_told } = &mut *self.talk();
        conversation.say(opening(oracle, rng, &serde_json::json!({})));
        let mut session = Session::new(conversation);
        let outcome = session.run(oracle);
        session.tell_end(&outcome);
        *is_told = outcome.is_err();
        *name = session.name;
        outcome
    }
}
