//! From an experiment file to stored runs: config, plan, runner, store.

mod config;
mod plan;
mod record;
mod runner;
mod store;

pub use config::{BudgetTable, ExperimentFile, Sweep};
pub use plan::{Entrant, Instance, Plan, RunSpec, Shard};
pub use record::{Record, Status};
pub use runner::{Progress, RunError, run};
pub use store::{Store, StoreError, write_table};
