//! How far an experiment is.

use std::collections::BTreeMap;

use polars::prelude::DataType;

use super::plan::Plan;
use super::record::Status;
use super::schema::{FORMAT, runs};
use super::store::{Store, StoreError};

/// What there is to say of a run that ended as it should and found nothing.
pub const FOUND_NOTHING: &str = "no evaluation had a finite cost";

/// How far an experiment is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Standing {
    /// One entry per optimiser, in the plan's order.
    pub tallies: Vec<Tally>,
    /// Stored runs that failed or found nothing.
    pub failures: Vec<FailedRun>,
    /// Stored runs that do not belong to the plan.
    pub others: usize,
    /// Stored runs in another format than this version reads: how many of each.
    pub formats: BTreeMap<u64, usize>,
}

impl Standing {
    /// What there is to say of runs that do not belong to the plan, if there are any.
    pub fn others(&self) -> Option<String> {
        let (run, belong) = if self.others == 1 { ("run", "belongs") } else { ("runs", "belong") };
        (self.others > 0).then(|| {
            format!("{} stored {run} {belong} to another version of the experiment", self.others)
        })
    }

    /// What there is to say of runs in other formats, if there are any.
    pub fn unread(&self) -> Option<String> {
        let count = self.formats.values().sum::<usize>();
        let formats: Vec<String> = self.formats.keys().map(u64::to_string).collect();
        let (s, are) = if count == 1 { ("", "is") } else { ("s", "are") };
        (count > 0).then(|| {
            format!(
                "{count} run{s} {are} stored in format {}, which this version does not read: it reads format {FORMAT}. \
                 They stay as they are; the version that wrote them can report them.",
                formats.join(" and ")
            )
        })
    }
}

/// How many runs of an optimiser there are.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tally {
    /// In the plan.
    pub planned: usize,
    /// Stored, those that failed among them.
    pub stored: usize,
    /// Failed, or without a finite cost.
    pub failed: usize,
}

impl Tally {
    /// Not yet stored.
    pub fn missing(self) -> usize {
        self.planned.saturating_sub(self.stored)
    }
}

impl std::iter::Sum for Tally {
    fn sum<I: Iterator<Item = Self>>(tallies: I) -> Self {
        tallies.fold(Self::default(), |a, b| Self {
            planned: a.planned + b.planned,
            stored: a.stored + b.stored,
            failed: a.failed + b.failed,
        })
    }
}

/// A run that failed or found nothing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FailedRun {
    /// Index of the run in the plan.
    pub run: usize,
    /// The word in the `status` column.
    pub status: String,
    /// What there is to say beyond the word.
    pub message: String,
}

/// Looks what is stored of a plan.
pub fn standing(plan: &Plan, store: &Store) -> Result<Standing, StoreError> {
    let planned = plan.places();
    let mut tallies = vec![Tally::default(); plan.optimisers.len()];
    plan.runs.iter().for_each(|run| tallies[run.optimiser].planned += 1);
    let (mut failures, mut others, mut formats) = (Vec::new(), 0, BTreeMap::new());
    store.visit(
        "runs",
        &[runs::FORMAT, runs::KEY, runs::STATUS, runs::MESSAGE],
        // Of other formats it need not be there.
        &[runs::CERTIFIED_COST],
        |_| true,
        |frame| {
            let text = |name: &str| frame.column(name)?.str();
            let (keys, statuses, messages) =
                (text(runs::KEY)?, text(runs::STATUS)?, text(runs::MESSAGE)?);
            let costs = frame.column(runs::CERTIFIED_COST)?.cast(&DataType::Float64)?;
            let costs = costs.f64()?;
            let written = frame.column(runs::FORMAT)?.u64()?;
            for i in 0..frame.height() {
                let Some(&run) = keys.get(i).and_then(|key| planned.get(key)) else {
                    match written.get(i) {
                        Some(format) if format != FORMAT => {
                            *formats.entry(format).or_insert(0) += 1;
                        }
                        _ => others += 1,
                    }
                    continue;
                };
                let tally = &mut tallies[plan.runs[run].optimiser];
                tally.stored += 1;
                let status = statuses.get(i).unwrap_or_default();
                if Status::is_failure(status) || !costs.get(i).is_some_and(f64::is_finite) {
                    tally.failed += 1;
                    let message = messages.get(i).filter(|message| !message.is_empty());
                    let message = message.unwrap_or(FOUND_NOTHING).to_owned();
                    failures.push(FailedRun { run, status: status.to_owned(), message });
                }
            }
            Ok(())
        },
    )?;
    failures.sort_by_key(|failure| failure.run);
    Ok(Standing { tallies, failures, others, formats })
}
