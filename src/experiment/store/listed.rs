//! The runs of an experiment, listed beside what is stored of them.

use polars::prelude::*;

use super::{Store, StoreError, write_table};
use crate::experiment::plan::Plan;
use crate::experiment::schema::plan;

/// What the list is called.
const LIST: &str = "plan.parquet";

impl Store {
    /// Lists a plan's runs in `plan.parquet`, with the labels that they have now; those stored with a run are of the time when
    /// it was made.
    pub(in crate::experiment) fn list_plan(&self, plan: &Plan) -> Result<(), StoreError> {
        let runs = || plan.runs.iter();
        let instances = || runs().map(|run| &plan.instances[run.instance]);
        let optimisers = || runs().map(|run| &plan.optimisers[run.optimiser]);
        let spaces = instances().zip(optimisers()).map(|(instance, own)| own.space(instance));
        let frame = df!(
            plan::KEY => runs().map(|run| run.key.as_str()).collect::<Vec<_>>(),
            plan::PROBLEM => instances().map(|own| own.subject.name()).collect::<Vec<_>>(),
            plan::INSTANCE => instances().map(|own| own.label.as_str()).collect::<Vec<_>>(),
            plan::GROUP => instances().map(|own| own.group.as_str()).collect::<Vec<_>>(),
            plan::OPTIMISER => optimisers().map(|own| &*own.label).collect::<Vec<_>>(),
            plan::FORMULATION => spaces.map(|space| Some(space).filter(|space| !space.is_empty())).collect::<Vec<_>>(),
            plan::SEED => runs().map(|run| run.seed).collect::<Vec<_>>(),
            plan::BUDGET => runs().map(|run| run.budget).collect::<Vec<_>>(),
        )?;
        write_table(&self.folder.join(LIST), frame)
    }
}
