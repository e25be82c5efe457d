//! The command as its users meet it.

mod bad_input;
#[cfg(feature = "harness")]
mod experiments;
mod folder;
#[cfg(feature = "harness")]
mod sweeps;
mod verbs;
