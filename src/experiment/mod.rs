//! From an experiment to stored runs: file, plan, runner, store.

mod budget;
mod caught;
mod entrant;
mod estimate;
mod field;
mod file;
mod folder;
mod instance;
mod kind;
mod plain;
mod plan;
mod record;
mod run;
mod runner;
pub mod schema;
mod shard;
mod standing;
mod store;
mod stored;
mod subject;
mod targets;

pub use entrant::Entrant;
pub use estimate::estimate;
pub use file::Experiment;
pub use folder::{Folder, FolderError, Options};
pub use instance::{Coordinate, Instance};
pub use kind::{Kind, Registry, Source, written};
pub use plan::{Plan, RunSpec};
pub use record::{Record, Status};
pub use run::{Improvement, Run, best_run, best_runs, load};
pub use runner::{Progress, RunError, run};
pub use shard::{Shard, ShardChoice, ShardError};
pub use standing::{Failure, Standing, Tally, standing};
pub use store::{Compaction, Store, StoreError};
pub use subject::{Judgement, Quantity, Subject, Unavailable, Value, ValueKind};
pub use targets::TargetTable;
