//! Where an experiment's results come from: which program, on which machine, when.

use std::collections::BTreeMap;

use polars::prelude::*;
use serde::Serialize;

use crate::experiment::{Plan, Store, StoreError};

/// One thing to know about how runs were made.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Fact {
    /// What it is.
    pub name: &'static str,
    /// Its values; where runs differ, each with the number of them.
    pub values: Vec<Origin>,
}

/// A value and the number of runs that have it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Origin {
    /// The value.
    pub value: String,
    /// Number of runs.
    pub runs: usize,
}

/// The columns of `runs` that tell, and what to call them.
const COLUMNS: [(&str, &str); 5] = [
    ("version", "Version of driftless"),
    ("commit", "Commit"),
    ("cpu", "Processor"),
    ("lanes", "Places of a path evaluated at once"),
    ("status", "How runs ended"),
];

/// What the stored runs of a plan say of how they were made. Nothing depends on when it is asked.
pub fn provenance(plan: &Plan, store: &Store) -> Result<Vec<Fact>, StoreError> {
    let planned = plan.places();
    let wanted = |key: &str| planned.contains_key(key);
    let mut counts = vec![Counts::default(); COLUMNS.len()];
    let mut dates = Counts::default();
    let mut names: Vec<&str> = COLUMNS.iter().map(|(column, _)| *column).collect();
    names.extend(["key", "date"]);
    store.visit("runs", &names, wanted, |frame| {
        for ((name, _), counts) in COLUMNS.iter().zip(&mut counts) {
            counts.add(frame.column(name)?)?;
        }
        dates.add(frame.column("date")?)
    })?;
    let mut threads = Counts::default();
    store.visit("clocks", &["key", "threads"], wanted, |frame| {
        threads.add(&one_row_a_run(frame)?)
    })?;
    let named = COLUMNS.iter().map(|(_, name)| *name).zip(counts);
    let facts = named.chain([("Runs at a time", threads)]);
    let facts = facts.map(|(name, counts)| Fact { name, values: counts.values() });
    Ok(facts.chain([dates.period()]).filter(|fact| !fact.values.is_empty()).collect())
}

/// The rows at which another run's begin.
fn one_row_a_run(clocks: &DataFrame) -> PolarsResult<Column> {
    let keys = clocks.column("key")?.str()?;
    let mut before = None;
    let begins = keys.iter().map(|key| std::mem::replace(&mut before, key) != key);
    let begins = BooleanChunked::from_iter_values("begins".into(), begins);
    clocks.column("threads")?.filter(&begins)
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
        Fact { name: "Runs ended", values }
    }
}
