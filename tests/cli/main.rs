//! The command as its users meet it.

mod bad_input;
#[cfg(feature = "harness")]
mod experiments;
#[cfg(feature = "harness")]
mod export;
mod folder;
mod followers;
mod help;
#[cfg(feature = "harness")]
mod import;
#[cfg(feature = "harness")]
mod import_instances;
#[cfg(feature = "harness")]
mod import_mistakes;
mod json;
mod motions;
mod on_the_way;
#[cfg(feature = "harness")]
mod processes;
mod replay_mistakes;
mod replays;
#[cfg(feature = "harness")]
mod reports;
mod robots;
#[cfg(feature = "harness")]
mod shards;
#[cfg(feature = "harness")]
mod splines;
#[cfg(all(unix, feature = "harness"))]
mod submit;
#[cfg(feature = "harness")]
mod survival;
#[cfg(feature = "harness")]
mod sweeps;
mod verbs;
