//! `driftless status`.

use clap::Args;
use polars::prelude::*;
use serde::Serialize;

use super::CliError;
use super::results::{ResultsFolder, command};
use super::warnings::warn_of_damage;
use crate::analysis::render;
use crate::experiment::{Damage, FailedRun, Folder, Standing, Tally, standing};
use crate::words::plural;

/// Show which runs of an experiment are done, failed or missing
#[derive(Debug, Args)]
pub(super) struct Status {
    #[command(flatten)]
    results: ResultsFolder,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Failures that are shown one by one.
const MOST_SHOWN: usize = 10;

#[derive(Debug, Serialize)]
struct Counts {
    runs: usize,
    stored: usize,
    failed: usize,
    missing: usize,
}

impl From<Tally> for Counts {
    fn from(tally: Tally) -> Self {
        let Tally { planned, stored, failed } = tally;
        Self { runs: planned, stored, failed, missing: tally.missing() }
    }
}

#[derive(Debug, Serialize)]
struct StatusJson<'a> {
    experiment: &'a str,
    #[serde(flatten)]
    all: Counts,
    /// Stored runs of no use to this experiment.
    others: usize,
    /// Stored runs in another format than this version reads.
    unread: usize,
    batches: usize,
    /// Of imported results: what from.
    #[serde(skip_serializing_if = "Option::is_none")]
    imported: Option<String>,
    optimisers: Vec<EntrantJson<'a>>,
    failures: Vec<FailureJson<'a>>,
    /// Files that cannot be used, one per batch.
    damaged: Vec<DamageJson>,
}

#[derive(Debug, Serialize)]
struct DamageJson {
    file: String,
    reason: String,
    /// Whether it may be whole: the system did not let it be read.
    may_be_whole: bool,
}

impl From<Damage> for DamageJson {
    fn from(damage: Damage) -> Self {
        Self {
            file: damage.path.display().to_string(),
            reason: damage.reason,
            may_be_whole: damage.may_be_whole,
        }
    }
}

#[derive(Debug, Serialize)]
struct EntrantJson<'a> {
    optimiser: &'a str,
    #[serde(flatten)]
    counts: Counts,
}

#[derive(Debug, Serialize)]
struct FailureJson<'a> {
    key: &'a str,
    optimiser: &'a str,
    instance: &'a str,
    seed: u64,
    status: &'a str,
    message: &'a str,
}

impl Status {
    pub(super) fn execute(self) -> Result<(), CliError> {
        let results = self.results.open()?;
        let standing = standing(&results.plan, &results.store)?;
        let batches = results.store.batch_count()?;
        if self.json {
            say!("{}", serde_json::json!(json(&results, &standing, batches)));
            return Ok(());
        }
        tell(&results, &standing, batches)
    }
}

fn json<'a>(results: &'a Folder, standing: &'a Standing, batches: usize) -> StatusJson<'a> {
    let plan = &results.plan;
    let entrant = |(optimiser, tally): (usize, &Tally)| EntrantJson {
        optimiser: &plan.optimisers[optimiser].label,
        counts: (*tally).into(),
    };
    let failure = |failure: &'a FailedRun| {
        let run = &plan.runs[failure.run];
        FailureJson {
            key: &run.key,
            optimiser: &plan.optimisers[run.optimiser].label,
            instance: &plan.instances[run.instance].label,
            seed: run.seed,
            status: &failure.status,
            message: &failure.message,
        }
    };
    StatusJson {
        experiment: &plan.name,
        all: standing.tallies.iter().copied().sum::<Tally>().into(),
        others: standing.others,
        unread: standing.formats.values().sum(),
        batches,
        imported: plan.imported(),
        optimisers: standing.tallies.iter().enumerate().map(entrant).collect(),
        failures: standing.failures.iter().map(failure).collect(),
        damaged: results.store.damaged().into_iter().map(DamageJson::from).collect(),
    }
}

fn tell(results: &Folder, standing: &Standing, batches: usize) -> Result<(), CliError> {
    let (plan, tallies) = (&results.plan, &standing.tallies);
    let all: Tally = tallies.iter().copied().sum();
    let counts =
        |value: fn(&Tally) -> usize| tallies.iter().map(|t| value(t) as u64).collect::<Vec<_>>();
    let table = df!(
        "optimiser" => plan.optimisers.iter().map(|o| o.label.as_str()).collect::<Vec<_>>(),
        "runs" => counts(|t| t.planned),
        "stored" => counts(|t| t.stored),
        "failed" => counts(|t| t.failed),
        "missing" => counts(|t| t.missing()),
    )?;
    warn_of_damage(&results.store);
    say!("{}", render(&table)?);
    if let Some(from) = plan.imported() {
        say!("imported from {from}: runs of other programs, which can be reported and not be run");
    }
    say!(
        "{}: {} of {} are stored, {} failed, {} missing; {} per table",
        plan.name,
        all.stored,
        plural(all.planned, "run"),
        all.failed,
        all.missing(),
        plural(batches, "file")
    );
    for failure in standing.failures.iter().take(MOST_SHOWN) {
        let run = &plan.runs[failure.run];
        let (optimiser, instance) =
            (&plan.optimisers[run.optimiser].label, &plan.instances[run.instance].label);
        let space = if instance.is_empty() { "" } else { " " };
        let message = failure.message.lines().next().unwrap_or_default();
        say!("{}: {optimiser}{space}{instance} seed {}: {message}", failure.status, run.seed);
    }
    if standing.failures.len() > MOST_SHOWN {
        say!("… and {} more failed; --json lists all", standing.failures.len() - MOST_SHOWN);
    }
    if let Some(unread) = standing.unread() {
        say!("{unread}");
    }
    if let Some(others) = standing.others() {
        say!("{others}");
    }
    if all.missing() > 0 && plan.imported().is_none() {
        say!("what is missing: {}", command(results));
    }
    Ok(())
}
