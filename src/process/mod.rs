//! Optimisers and problems that are programs, in any language: one JSON object per line over standard input and output.
//!
//! `docs/protocol.md` is the specification. A [`Solver`] asks for costs whenever it likes; budget, counters, best point and
//! trace stay with the [`Oracle`](crate::search::Oracle) on this side of the pipe. A [`Program`] answers with costs.

mod answer;
mod child;
mod command;
mod conversation;
mod numbers;
mod problem;
mod request;
mod solver;

pub use command::{Command, CommandError, Patience};
pub use problem::{Program, Told};
pub use solver::Solver;
