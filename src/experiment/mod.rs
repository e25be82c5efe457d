//! From an experiment file to stored runs: config, plan, runner, store.

mod caught;
mod config;
mod estimate;
mod field;
mod instance;
mod plan;
mod poses;
mod record;
mod runner;
mod shard;
mod store;
mod sweep;
mod targets;

pub use config::{BudgetTable, Evaluations, ExperimentFile, Sweep};
pub use estimate::estimate;
pub use field::EntrantTable;
pub use instance::{Instance, Subject};
pub use plan::{Entrant, Plan, RunSpec};
pub use poses::RandomPoses;
pub use record::{Record, Status};
pub use runner::{Progress, RunError, run};
pub use shard::{Shard, ShardChoice, ShardError};
pub use store::{Compaction, Store, StoreError};
pub use targets::TargetTable;
