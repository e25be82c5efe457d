//! Checks that a batch's tables are what a run writes.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use polars::prelude::*;

use super::name::is_key;
use super::stack::only;
use crate::digest::digest;
use crate::experiment::record::IMPORTED_STATUS;
use crate::experiment::schema::{Cell, Column, FORMAT, clocks, runs, traces};
use crate::words::plural;

/// For each key the lists of its run that have a length of their own, by their columns.
pub(super) type Lengths = HashMap<String, Arc<[(String, usize)]>>;

/// What a batch holds.
#[derive(Debug)]
pub(super) struct Contents {
    /// The keys of its runs.
    pub(super) keys: Vec<String>,
    /// Rows of its table of traces.
    pub(super) trace_rows: usize,
}

/// The columns of `runs` that may be null.
const NULLABLE: [&str; 6] = [
    runs::FORMULATION,
    runs::COST,
    runs::VIOLATION,
    runs::POINT,
    runs::CERTIFIED_COST,
    runs::FIRST_FEASIBLE,
];

/// And those that may be null of imported runs, of which no more is known than a trace.
const UNKNOWN: [&str; 10] = [
    runs::LINEARISATIONS,
    runs::CURVATURES,
    runs::CONIC_SOLVES,
    runs::CONIC_FAILURES,
    runs::SECONDS,
    runs::SECONDS_IN_PROBLEM,
    runs::CPU,
    runs::DATE,
    traces::VIOLATION,
    clocks::THREADS,
];

/// What is wrong with a table, to be read behind its file's name.
type Reason = String;

/// What a batch holds, or which of its tables is not as it should be, and why. Of rows in another format only the keys
/// are looked at.
pub(super) fn check(
    batch: &str,
    [traces, clocks, runs]: &[DataFrame; 3],
    lengths: &Lengths,
) -> Result<Contents, (&'static str, Reason)> {
    let of = |table: &'static str| move |reason: Reason| (table, reason);
    let (keys, found) = check_runs(batch, runs, lengths).map_err(of("runs"))?;
    let trace = own_rows(traces, &keys, &found).map_err(of("traces"))?;
    let clock = own_rows(clocks, &keys, &found).map_err(of("clocks"))?;
    if !found.is_empty() {
        let nullable: &[&str] = if are_imported(runs) { &UNKNOWN } else { &[] };
        check_trace(&trace, &found, nullable).map_err(of("traces"))?;
        check_clock(&clock, &trace, nullable).map_err(of("clocks"))?;
    }
    Ok(Contents { keys, trace_rows: traces.height() })
}

/// The keys of a batch's runs, and for those in this version's format whether they found anything.
fn check_runs(
    batch: &str,
    frame: &DataFrame,
    lengths: &Lengths,
) -> Result<(Vec<String>, HashMap<String, bool>), Reason> {
    let keys = keys(frame)?;
    let mut seen = HashSet::new();
    if let Some(twin) = keys.iter().find(|key| !seen.insert(*key)) {
        return Err(format!("has the run {twin} more than once"));
    }
    if is_key(batch) && keys != [batch] {
        return Err(format!("holds {}, expected the run that it is named by", keys.join(", ")));
    }
    let formats = column(frame, runs::FORMAT, &DataType::UInt64)?.u64().map_err(reason)?;
    let is_ours: BooleanChunked =
        formats.iter().map(|format| Some(format == Some(FORMAT))).collect();
    if formats.null_count() > 0 {
        return Err(null_in(runs::FORMAT));
    }
    let frame = frame.filter(&is_ours).map_err(reason)?;
    if frame.height() == 0 {
        return Ok((keys, HashMap::new()));
    }
    let unknown: &[&str] = if are_imported(&frame) { &UNKNOWN } else { &[] };
    check_columns(&frame, runs::COLUMNS, &[&NULLABLE[..], unknown].concat())?;
    check_finite(&frame, &[runs::COST, runs::SECONDS, runs::SECONDS_IN_PROBLEM])?;
    let our_keys = texts(&frame, runs::KEY)?;
    let recipes = texts(&frame, runs::RECIPE)?;
    for (key, recipe) in our_keys.iter().flatten().zip(recipes.iter().flatten()) {
        if digest(recipe) != key {
            return Err(format!("has the run {key} with a recipe that gives another key"));
        }
    }
    check_lists(&frame, our_keys, lengths)?;
    let costs = frame.column(runs::COST).map_err(reason)?.is_not_null();
    let found = our_keys.iter().flatten().map(str::to_owned).zip(costs.iter().flatten());
    Ok((keys, found.collect()))
}

/// Whether all runs of a table were imported: a batch has no others beside.
fn are_imported(frame: &DataFrame) -> bool {
    let statuses = texts(frame, runs::STATUS);
    statuses.is_ok_and(|all| all.iter().all(|status| status == Some(IMPORTED_STATUS)))
}

/// Whether lists of numbers have none missing, points are finite, and all have their lengths.
fn check_lists(frame: &DataFrame, keys: &StringChunked, lengths: &Lengths) -> Result<(), Reason> {
    for name in [runs::TARGETS, runs::POINT] {
        let lists = frame.column(name).map_err(reason)?.list().map_err(reason)?;
        for row in 0..frame.height() {
            let Some(list) = lists.get_as_series(row) else { continue };
            let values = list.f64().map_err(reason)?;
            if values.null_count() > 0 {
                return Err(null_in(name));
            }
            if name == runs::POINT && !values.iter().flatten().all(f64::is_finite) {
                return Err(not_finite(name));
            }
        }
    }
    for (row, key) in keys.iter().enumerate() {
        let expected = key.and_then(|key| lengths.get(key)).into_iter().flat_map(|own| own.iter());
        for (name, expected) in expected {
            let lists = frame.column(name).and_then(|column| column.list().cloned());
            let lists = lists.map_err(|_| format!("has no column `{name}` of lists"))?;
            if let Some(found) = lists.get_as_series(row).map(|list| list.len())
                && found != *expected
            {
                return Err(format!(
                    "has {} in `{name}`, expected {expected}",
                    plural(found, "number")
                ));
            }
        }
    }
    Ok(())
}

/// Whether traces are those of the runs that found something, each in order.
fn check_trace(
    rows: &DataFrame,
    found: &HashMap<String, bool>,
    nullable: &[&str],
) -> Result<(), Reason> {
    check_columns(rows, traces::COLUMNS, nullable)?;
    check_finite(rows, &[traces::COST])?;
    let keys = texts(rows, traces::KEY)?;
    let evaluations = rows.column(traces::EVALUATION).and_then(|c| c.u64()).map_err(reason)?;
    let costs = rows.column(traces::COST).and_then(|c| c.f64()).map_err(reason)?;
    let steps = keys.iter().flatten().zip(evaluations.iter().flatten());
    let mut seen = HashSet::new();
    let mut before: Option<(&str, u64, f64)> = None;
    for ((key, evaluation), cost) in steps.zip(costs.iter().flatten()) {
        match before {
            Some((last, at, best)) if last == key => {
                let is_in_order = at < evaluation && cost <= best;
                if !is_in_order {
                    return Err(format!("has the trace of the run {key} out of order"));
                }
            }
            _ if !seen.insert(key) => {
                return Err(format!("has the trace of the run {key} in pieces"));
            }
            _ => {}
        }
        before = Some((key, evaluation, cost));
    }
    match found.iter().find(|(key, found)| **found != seen.contains(key.as_str())) {
        Some((key, true)) => Err(format!("has no trace of the run {key}")),
        Some((key, false)) => Err(format!("has a trace of the run {key}, which found nothing")),
        None => Ok(()),
    }
}

/// Whether clocks have a row for each of the traces.
fn check_clock(rows: &DataFrame, trace: &DataFrame, nullable: &[&str]) -> Result<(), Reason> {
    check_columns(rows, clocks::COLUMNS, nullable)?;
    check_finite(rows, &[clocks::SECONDS])?;
    let is_same = [traces::KEY, traces::EVALUATION].iter().all(|name| {
        let columns = (rows.column(name), trace.column(name));
        matches!(columns, (Ok(clock), Ok(trace)) if clock.equals(trace))
    });
    if is_same { Ok(()) } else { Err("does not have the rows of the batch's traces".to_owned()) }
}

/// The rows of the runs in this version's format; an error where others than the batch's runs have rows.
fn own_rows(
    frame: &DataFrame,
    keys: &[String],
    found: &HashMap<String, bool>,
) -> Result<DataFrame, Reason> {
    let batch: HashSet<&str> = keys.iter().map(String::as_str).collect();
    let rows = texts(frame, runs::KEY)?;
    if rows.null_count() > 0 {
        return Err(null_in(runs::KEY));
    }
    if let Some(other) = rows.iter().flatten().find(|key| !batch.contains(key)) {
        return Err(format!("has rows of {other}, which is no run of its batch"));
    }
    only(frame, |key| found.contains_key(key)).map_err(reason)
}

/// Whether a table has these columns, of these types, with nothing missing but where it may be.
fn check_columns(frame: &DataFrame, columns: &[Column], nullable: &[&str]) -> Result<(), Reason> {
    for expected in columns {
        let kind = match expected.cell {
            Cell::Text => DataType::String,
            Cell::Count => DataType::UInt64,
            Cell::Real => DataType::Float64,
            Cell::Reals => DataType::List(Box::new(DataType::Float64)),
            Cell::OfSubject => continue,
        };
        let found = column(frame, expected.name, &kind)?;
        if found.null_count() > 0 && !nullable.contains(&expected.name) {
            return Err(null_in(expected.name));
        }
    }
    Ok(())
}

/// Whether columns have only finite numbers where they have any.
fn check_finite(frame: &DataFrame, names: &[&str]) -> Result<(), Reason> {
    for name in names {
        let values = frame.column(name).and_then(|column| column.f64()).map_err(reason)?;
        if !values.iter().flatten().all(f64::is_finite) {
            return Err(not_finite(name));
        }
    }
    Ok(())
}

/// The keys of a table of runs.
fn keys(frame: &DataFrame) -> Result<Vec<String>, Reason> {
    let keys = texts(frame, runs::KEY)?;
    match keys.null_count() {
        0 => Ok(keys.iter().flatten().map(str::to_owned).collect()),
        _ => Err(null_in(runs::KEY)),
    }
}

fn texts<'a>(frame: &'a DataFrame, name: &str) -> Result<&'a StringChunked, Reason> {
    column(frame, name, &DataType::String)?.str().map_err(reason)
}

fn column<'a>(
    frame: &'a DataFrame,
    name: &str,
    kind: &DataType,
) -> Result<&'a polars::prelude::Column, Reason> {
    let column = frame.column(name).map_err(|_| format!("has no column `{name}`"))?;
    let found = column.dtype();
    if found == kind {
        Ok(column)
    } else {
        Err(format!("has {found} in the column `{name}`, expected {kind}"))
    }
}

fn null_in(name: &str) -> Reason {
    format!("has a null in the column `{name}`")
}

fn not_finite(name: &str) -> Reason {
    format!("has a number that is not finite in the column `{name}`")
}

#[expect(clippy::needless_pass_by_value, reason = "as `map_err` gives it")]
fn reason(error: PolarsError) -> Reason {
    error.to_string()
}
