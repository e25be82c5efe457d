//! A long table as comma-separated values: a row for each evaluation that is told of, in any order.

use std::collections::BTreeMap;
use std::num::NonZeroU64;
use std::path::Path;

use csv::{ReaderBuilder, StringRecord};

use super::Import;
use super::collected::{Collected, MOST_ROWS, ReadRun, Trace};
use super::error::ImportError;
use super::files::{files, open};
use super::lines::cut;
use crate::experiment::{DataFormat, ForeignOptimiser, ForeignStep, Provenance};

/// The columns that a table has to have, and those that it may have.
const REQUIRED: [&str; 5] = ["problem", "optimiser", "seed", "evaluation", "cost"];
const OPTIONAL: [&str; 4] = ["dimension", "instance", "budget", "seconds"];

/// A run by what tells it from others: instance, optimiser, seed.
type RunId = (Provenance, String, u64);

/// What tables say of a run.
#[derive(Debug, Default)]
struct LongRun {
    budget: Option<NonZeroU64>,
    rows: Vec<ForeignStep>,
}

/// Reads a folder of tables, or one.
pub(super) fn read(data: &Path) -> Result<Import, ImportError> {
    let mut runs: BTreeMap<RunId, LongRun> = BTreeMap::new();
    let mut count = 0;
    let tables = files(data, ["", "csv"], "tables called *.csv")?;
    for table in &tables {
        read_table(table, &mut runs, &mut count)?;
    }
    let mut collected = Collected::default();
    let mut lacks_dimension = false;
    for ((provenance, name, seed), LongRun { budget, rows }) in runs {
        let mut evaluations: Vec<u64> = rows.iter().map(|row| row.evaluation).collect();
        evaluations.sort_unstable();
        let of = format!("the run of `{name}` on `{}` with seed {seed}", provenance.name);
        let mut pairs = evaluations.iter().zip(evaluations.iter().skip(1));
        if let Some((twice, _)) = pairs.find(|(a, b)| a == b) {
            let message = format!("found the evaluation {twice} of {of} twice, expected it once");
            return Err(ImportError::of(data, message));
        }
        let last = evaluations.last().copied().unwrap_or_default();
        if let Some(budget) = budget.filter(|budget| budget.get() < last) {
            let message = format!(
                "found the evaluation {last} of {of}, expected {budget} at most, its budget"
            );
            return Err(ImportError::of(data, message));
        }
        lacks_dimension |= provenance.dimension.is_none();
        let optimiser = ForeignOptimiser { name, info: String::new() };
        let trace = Trace::of(rows, last);
        let run = ReadRun { provenance, optimiser, seed: Some(seed), budget, optimum: None, trace };
        collected.add(run, data)?;
    }
    let note =
        "where the data name no dimension it counts as one, unless the problem is another folder's";
    let notes = if lacks_dimension { vec![note.to_owned()] } else { Vec::new() };
    collected.import(DataFormat::Csv, data, notes)
}

fn read_table(
    path: &Path,
    runs: &mut BTreeMap<RunId, LongRun>,
    count: &mut usize,
) -> Result<(), ImportError> {
    let mut reader = ReaderBuilder::new().trim(csv::Trim::All).from_reader(open(path)?);
    let wrong = |error: csv::Error| csv_error(path, error);
    let columns = Columns::of(reader.headers().map_err(wrong)?, path)?;
    let mut record = StringRecord::new();
    while reader.read_record(&mut record).map_err(wrong)? {
        *count += 1;
        if *count > MOST_ROWS {
            let message =
                format!("found more than {MOST_ROWS} rows, expected fewer: import them in parts");
            return Err(ImportError::of(path, message));
        }
        let line = record.position().map_or(0, csv::Position::line);
        let row = Row { record: &record, columns: &columns, path, line };
        let (id, budget, step) = row.read()?;
        let run = runs.entry(id).or_default();
        match (run.budget, budget) {
            (Some(known), Some(budget)) if known != budget => {
                let message = format!(
                    "found the budget {budget}, expected {known} as in other rows of the run"
                );
                return Err(ImportError::at(path, line, message));
            }
            _ => run.budget = run.budget.or(budget),
        }
        run.rows.push(step);
    }
    Ok(())
}

fn csv_error(path: &Path, error: csv::Error) -> ImportError {
    let line = error.position().map(csv::Position::line);
    let message = match error.into_kind() {
        csv::ErrorKind::Io(source) => return ImportError::unreadable(path, source),
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("found {len} fields, expected {expected_len} as in the heading")
        }
        csv::ErrorKind::Utf8 { .. } => "found bytes that are not text, expected UTF-8".to_owned(),
        _ => "found no comma-separated values".to_owned(),
    };
    ImportError::Content { path: path.to_owned(), line, message }
}

/// Places of columns.
struct Columns {
    required: [usize; REQUIRED.len()],
    optional: [Option<usize>; OPTIONAL.len()],
}

impl Columns {
    fn of(heading: &StringRecord, path: &Path) -> Result<Self, ImportError> {
        let error = |message: String| Err(ImportError::at(path, 1, message));
        let mut required = [None; REQUIRED.len()];
        let mut optional = [None; OPTIONAL.len()];
        for (place, name) in heading.iter().enumerate() {
            let slots =
                REQUIRED.iter().zip(&mut required).chain(OPTIONAL.iter().zip(&mut optional));
            let Some((_, slot)) = slots.into_iter().find(|(known, _)| **known == name) else {
                return error(format!(
                    "found the column `{}`, expected {} and perhaps {}",
                    cut(name),
                    listed(&REQUIRED),
                    listed(&OPTIONAL)
                ));
            };
            if slot.replace(place).is_some() {
                return error(format!("found the column `{name}` twice, expected it once"));
            }
        }
        let mut places = [0; REQUIRED.len()];
        for ((name, found), place) in REQUIRED.iter().zip(required).zip(&mut places) {
            let Some(found) = found else {
                return error(format!("found no column `{name}`, expected {}", listed(&REQUIRED)));
            };
            *place = found;
        }
        Ok(Self { required: places, optional })
    }
}

fn listed(names: &[&str]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

/// A row on its way to values.
struct Row<'a> {
    record: &'a StringRecord,
    columns: &'a Columns,
    path: &'a Path,
    line: u64,
}

impl Row<'_> {
    fn read(&self) -> Result<(RunId, Option<NonZeroU64>, ForeignStep), ImportError> {
        let field = |column: usize| self.record.get(self.columns.required[column]).unwrap_or("");
        let [problem, optimiser, seed, evaluation, cost] = [0, 1, 2, 3, 4].map(field);
        if optimiser.is_empty() {
            return Err(self.wrong("optimiser", optimiser, "a name"));
        }
        let provenance = Provenance {
            name: problem.to_owned(),
            dimension: self.whole(0)?.map(NonZeroU64::get),
            instance: match self.given(1) {
                Some(text) => {
                    Some(text.parse().map_err(|_| self.wrong("instance", text, "a whole number"))?)
                }
                None => None,
            },
            ..Provenance::default()
        };
        let seed = seed.parse().map_err(|_| self.wrong("seed", seed, "a whole number from 0"))?;
        let evaluation: NonZeroU64 = evaluation
            .parse()
            .map_err(|_| self.wrong("evaluation", evaluation, "a whole number from 1"))?;
        let cost = cost.parse().map_err(|_| self.wrong("cost", cost, "a number"))?;
        let seconds = match self.given(3) {
            Some(text) => {
                let seconds = text.parse().ok().filter(|s: &f64| s.is_finite() && *s >= 0.0);
                Some(seconds.ok_or_else(|| self.wrong("seconds", text, "a number from 0"))?)
            }
            None => None,
        };
        let step = ForeignStep { evaluation: evaluation.get(), cost, seconds };
        Ok(((provenance, optimiser.to_owned(), seed), self.whole(2)?, step))
    }

    /// What stands in an optional column, if anything does.
    fn given(&self, column: usize) -> Option<&str> {
        let text = self.record.get(self.columns.optional[column]?)?;
        Some(text).filter(|text| !text.is_empty())
    }

    fn whole(&self, column: usize) -> Result<Option<NonZeroU64>, ImportError> {
        let wrong = |text| self.wrong(OPTIONAL[column], text, "a whole number from 1");
        self.given(column).map(|text| text.parse().map_err(|_| wrong(text))).transpose()
    }

    fn wrong(&self, column: &str, found: &str, expected: &str) -> ImportError {
        let message =
            format!("found `{}` in the column `{column}`, expected {expected}", cut(found));
        ImportError::at(self.path, self.line, message)
    }
}
