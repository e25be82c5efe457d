//! From stored runs to tables of what they say.

mod blocks;
mod format;
mod grouped;
#[cfg(test)]
pub(crate) mod handmade;
mod latex;
mod pairs;
pub mod statistics;
mod summary;
pub mod tables;
mod targets;
mod ties;
mod verdict;

pub use blocks::ALPHA;
pub use format::{csv, markdown, render};
pub use grouped::Analysis;
pub use latex::latex;
pub use summary::summary;
pub use targets::{Targets, least_found, targets};
