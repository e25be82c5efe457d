//! Where an experiment's results come from: which program, on which machine, when.

use std::collections::BTreeMap;

use polars::prelude::*;
use serde::Serialize;

use crate::experiment::schema::{clocks, runs};
use crate::experiment::{Plan, Store, StoreError};

/// One thing to know about how runs were made.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct Fact {
    /// What it is.
    pub(super) name: String,
    /// Its values; where runs differ, each with the number of them.
    pub(super) values: Vec<Origin>,
}

/// A value and the number of runs that have it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct Origin {
    /// The value.
    pub(super) value: String,
    /// Number of runs.
    pub(super) runs: usize,
}

/// The columns of `runs` that tell, and what to call them; behind these stand the subjects' own.
const COLUMNS: [(&str, &str); 3] =
    [(runs::VERSION, "Version of driftless"), (runs::COMMIT, "Commit"), (runs::CPU, "Processor")];

/// What runs were imported from.
fn imported(plan: &Plan) -> Fact {
    let mut counts = Counts::default();
    for run in &plan.runs {
        if let Some(from) = plan.optimisers[run.optimiser].imported() {
            *counts.0.entry(from.to_owned()).or_default() += 1;
        }
    }
    Fact { name: "Imported from".to_owned(), values: counts.values() }
}

/// What the stored runs of a plan say of how they were made. Nothing depends on when it is asked.
pub(super) fn provenance(plan: &Plan, stores: &[&Store]) -> Result<Vec<Fact>, StoreError> {
    let planned = plan.places();
    let wanted = |key: &str| planned.contains_key(key);
    let own = plan.facts().iter().filter_map(|f| Some((f.name.as_str(), f.provenance.as_deref()?)));
    let own: Vec<(&str, &str)> = own.collect();
    let columns: Vec<(&str, &str)> = COLUMNS
        .into_iter()
        .chain(own.iter().copied())
        .chain([(runs::STATUS, "How runs ended")])
        .collect();
    let mut counts = vec![Counts::default(); columns.len()];
    let mut dates = Counts::default();
    let mut names: Vec<&str> = COLUMNS.iter().map(|(column, _)| *column).collect();
    names.extend([runs::STATUS, runs::KEY, runs::DATE]);
    let optional: Vec<&str> = own.iter().map(|(column, _)| *column).collect();
    let mut threads = Counts::default();
    for store in stores {
        store.visit("runs", &names, &optional, wanted, |frame| {
            for ((name, _), counts) in columns.iter().zip(&mut counts) {
                counts.add(frame.column(name)?)?;
            }
            dates.add(frame.column(runs::DATE)?)
        })?;
        store.visit("clocks", &[clocks::KEY, clocks::THREADS], &[], wanted, |frame| {
            threads.add(&one_row_per_run(frame)?)
        })?;
    }
    let named = columns.iter().map(|(_, name)| *name).zip(counts);
    let facts = named.chain([("Runs at a time", threads)]);
    let facts = facts.map(|(name, counts)| Fact { name: name.to_owned(), values: counts.values() });
    Ok(facts
        .chain([dates.period(), imported(plan)])
        .filter(|fact| !fact.values.is_empty())
        .collect())
}

/// The rows at which another run's begin.
fn one_row_per_run(table: &DataFrame) -> PolarsResult<Column> {
    let keys = table.column(clocks::KEY)?.str()?;
    let mut before = None;
    let begins = keys.iter().map(|key| std::mem::replace(&mut before, key) != key);
    let begins = BooleanChunked::from_iter_values("begins".into(), begins);
    table.column(clocks::THREADS)?.filter(&begins)
}

/// How often each value stands in a column.
#[derive(Debug, Clone, Default)]
struct Counts(BTreeMap<String, usize>);

impl Counts {
    fn add(&mut self, column: &Column) -> PolarsResult<()> {
        for row in 0..column.len() {
            let value = column.get(row)?;
            if !value.is_null() {
                let text = value.get_str().map_or_else(|| value.to_string(), str::to_owned);
                *self.0.entry(text).or_default() += 1;
            }
        }
        Ok(())
    }

    fn values(self) -> Vec<Origin> {
        self.0.into_iter().map(|(value, runs)| Origin { value, runs }).collect()
    }

    /// From the first date to the last, to the second.
    fn period(&self) -> Fact {
        let [first, last] = [self.0.keys().next(), self.0.keys().next_back()]
            .map(|date| date.and_then(|date| date.get(..19)).map(|date| date.replace('T', " ")));
        let value = match (first, last) {
            (Some(first), Some(last)) if first == last => Some(format!("{first} UTC")),
            (Some(first), Some(last)) => Some(format!("{first} to {last} UTC")),
            _ => None,
        };
        let runs = self.0.values().sum();
        let values = value.into_iter().map(|value| Origin { value, runs }).collect();
        Fact { name: "Runs ended".to_owned(), values }
    }
}
