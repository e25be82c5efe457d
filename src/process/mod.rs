//! Optimisers and problems that are programs, in any language: one JSON object per line over standard input and output, or a
//! loopback socket.
//!
//! `docs/protocol.md` is the specification. A [`Solver`] is started and asks for costs whenever it likes, a [`Client`] came by
//! itself; budget, counters, best point and trace stay with the [`Oracle`](crate::search::Oracle) on this side. A [`Program`]
//! answers with costs.

mod answer;
mod child;
mod client;
mod command;
mod conversation;
mod guest;
mod lines;
mod numbers;
mod problem;
mod request;
mod session;
mod socket;
mod solver;

pub use client::Client;
pub(crate) use command::is_on_path;
pub use command::{Command, CommandError, Patience};
pub use problem::{Program, Told};
pub use socket::{Socket, TOKEN};
pub use solver::Solver;
