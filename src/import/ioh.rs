//! IOHprofiler: an index `IOHprofiler_f*.json` per algorithm and function, and tables of the runs that it names.
//!
//! The layout is that of the logger `ioh` 0.3.3 to 0.4.2 (doi `10.1162/evco_a_00342`). A table may have any columns; those that are
//! read are `evaluations` and `raw_y`.

use std::collections::HashMap;
use std::fs;
use std::io::Read as _;
use std::num::NonZeroU64;
use std::path::Path;

use serde::Deserialize;
use serde_json::Value;

use super::collected::{Collected, ReadRun, Rows};
use super::error::ImportError;
use super::files::{beside, files, open};
use super::lines::{Lines, cut};
use super::{Import, bbob};
use crate::experiment::{DataFormat, EXPORTED_SUITE, ForeignOptimiser, Provenance};
use crate::words::plural;

/// The largest index \[bytes\].
const LARGEST_INDEX: u64 = 1 << 30;

/// What loggers write of a problem that belongs to no suite.
const NO_SUITE: &str = "unknown_suite";

#[derive(Debug, Deserialize)]
struct Index {
    #[serde(default)]
    suite: String,
    function_id: u32,
    #[serde(default)]
    function_name: String,
    #[serde(default)]
    maximization: bool,
    algorithm: Algorithm,
    #[serde(default)]
    experiment_attributes: Vec<HashMap<String, Value>>,
    scenarios: Vec<Scenario>,
}

#[derive(Debug, Deserialize)]
struct Algorithm {
    name: String,
    #[serde(default)]
    info: String,
}

#[derive(Debug, Deserialize)]
struct Scenario {
    dimension: u64,
    path: String,
    runs: Vec<IndexedRun>,
}

#[derive(Debug, Deserialize)]
struct IndexedRun {
    instance: u32,
    evals: u64,
    #[serde(default)]
    best: Best,
    seed: Option<Value>,
    budget: Option<Value>,
    optimum: Option<f64>,
    digest: Option<Value>,
}

#[derive(Debug, Default, Deserialize)]
struct Best {
    evals: Option<u64>,
    y: Option<f64>,
}

/// Reads a folder, or one index.
pub(super) fn read(data: &Path) -> Result<Import, ImportError> {
    let mut collected = Collected::default();
    for index in files(data, ["IOHprofiler_", "json"], "IOHprofiler_f*.json and the tables beside")?
    {
        read_index(&index, &mut collected)?;
    }
    collected.import(DataFormat::Ioh, data, Vec::new())
}

fn read_index(path: &Path, collected: &mut Collected) -> Result<(), ImportError> {
    let index = parse(path)?;
    if index.maximization {
        return Err(ImportError::of(path, "found a function that is maximised, expected costs"));
    }
    if index.algorithm.name.trim().is_empty() {
        return Err(ImportError::of(path, "found an algorithm without a name, expected one"));
    }
    let (name, info) = (index.algorithm.name.clone(), index.algorithm.info.clone());
    let optimiser = ForeignOptimiser { name, info };
    for scenario in &index.scenarios {
        let table = beside(path, 1, &scenario.path)?;
        let mut tables = Tables::open(&table)?;
        for (place, run) in scenario.runs.iter().enumerate() {
            let Some(mut rows) = tables.next()? else {
                let (found, expected) = (plural(place, "run"), scenario.runs.len());
                let message =
                    format!("found {found}, expected {expected} as in {}", path.display());
                return Err(ImportError::of(&table, message));
            };
            if rows.last() > run.evals {
                let message = format!(
                    "found the evaluation {} in run {}, expected {} at most as in {}",
                    rows.last(),
                    place + 1,
                    run.evals,
                    path.display()
                );
                return Err(ImportError::of(&table, message));
            }
            // A table need not have a row for every improvement.
            if let (Some(evaluation), Some(cost)) = (run.best.evals, run.best.y) {
                let mut best = Rows::default();
                best.push(evaluation.clamp(1, run.evals.max(1)), cost);
                rows = rows.with(best);
            }
            let provenance = Provenance {
                suite: index.suite().to_owned(),
                function: Some(index.function_id),
                name: index.function_name.clone(),
                dimension: Some(scenario.dimension),
                instance: Some(run.instance),
                digest: index.digest(run),
            };
            let no_seed = |found: &Value| {
                let (found, run) = (cut(&found.to_string()), place + 1);
                let message = format!(
                    "found the seed `{found}` of run {run} of {}, expected a whole number from 0",
                    scenario.path
                );
                ImportError::of(path, message)
            };
            let read = ReadRun {
                provenance,
                optimiser: optimiser.clone(),
                seed: run
                    .seed
                    .as_ref()
                    .map(|seed| whole(seed).ok_or_else(|| no_seed(seed)))
                    .transpose()?,
                budget: index.budget(run),
                optimum: index.optimum(run),
                trace: rows.into_trace(run.evals),
            };
            collected.add(read, path)?;
        }
        if tables.next()?.is_some() {
            let expected = scenario.runs.len();
            let message = format!("found more runs, expected {expected} as in {}", path.display());
            return Err(ImportError::of(&table, message));
        }
    }
    Ok(())
}

impl Index {
    /// The suite; empty for none. That of COCO has its name.
    fn suite(&self) -> &str {
        match self.suite.as_str() {
            NO_SUITE => "",
            suite if suite.eq_ignore_ascii_case(bbob::SUITE) => bbob::SUITE,
            suite => suite,
        }
    }

    /// What a run was allowed, as an export of this program tells; what others mean by the word is not known.
    fn budget(&self, run: &IndexedRun) -> Option<NonZeroU64> {
        let budget = run.budget.as_ref().or_else(|| self.attribute("budget"));
        budget.and_then(whole).and_then(NonZeroU64::new).filter(|_| self.suite == EXPORTED_SUITE)
    }

    /// What tells the instance from all others, as an export of this program says.
    fn digest(&self, run: &IndexedRun) -> Option<String> {
        let digest = run.digest.as_ref().and_then(Value::as_str)?;
        Some(digest.to_owned()).filter(|_| self.suite == EXPORTED_SUITE)
    }

    /// The least cost known: of differences from the optimum it is 0.
    fn optimum(&self, run: &IndexedRun) -> Option<f64> {
        match self.suite() {
            bbob::SUITE => Some(0.0),
            EXPORTED_SUITE if self.knows_optima() => run.optimum,
            _ => None,
        }
    }

    fn attribute(&self, name: &str) -> Option<&Value> {
        self.experiment_attributes.iter().find_map(|attributes| attributes.get(name))
    }

    /// Whether an export says that optima were known beforehand.
    fn knows_optima(&self) -> bool {
        let source = self.attribute("optimum_source").and_then(Value::as_str);
        source.is_some_and(|source| source.trim_matches('"') == "known")
    }
}

/// A whole number, also one that is written as a text or with a point.
fn whole(value: &Value) -> Option<u64> {
    let real = |value: f64| {
        (value >= 0.0 && value < 2_f64.powi(53) && value.fract() == 0.0).then_some(value as u64)
    };
    match value {
        Value::Number(number) => number.as_u64().or_else(|| number.as_f64().and_then(real)),
        Value::String(text) => text.parse().ok(),
        _ => None,
    }
}

fn parse(path: &Path) -> Result<Index, ImportError> {
    let size = fs::metadata(path).map_err(|source| ImportError::unreadable(path, source))?.len();
    if size > LARGEST_INDEX {
        let message = format!("found {size} bytes, expected {LARGEST_INDEX} at most");
        return Err(ImportError::of(path, message));
    }
    let mut text = String::new();
    open(path)?
        .read_to_string(&mut text)
        .map_err(|source| ImportError::unreadable(path, source))?;
    serde_json::from_str(&text).map_err(|error| {
        let line = error.line() as u64;
        let message = error.to_string();
        let place = format!(" at line {} column {}", error.line(), error.column());
        let message = message.strip_suffix(&place).unwrap_or(&message);
        ImportError::at(path, line, format!("found no index of IOHprofiler: {message}"))
    })
}

/// The runs of a table, one at a time. A run begins below a heading or, where headings are left out, with the first evaluation or one
/// before the last.
struct Tables {
    lines: Lines,
    columns: Option<Columns>,
    /// The first row of the next run.
    begun: Option<(u64, f64)>,
    is_at_end: bool,
}

/// Places of columns.
#[derive(Debug, Clone, Copy)]
struct Columns {
    evaluations: usize,
    cost: usize,
}

impl Tables {
    fn open(path: &Path) -> Result<Self, ImportError> {
        Ok(Self { lines: Lines::open(path)?, columns: None, begun: None, is_at_end: false })
    }

    fn next(&mut self) -> Result<Option<Rows>, ImportError> {
        let mut rows = Rows::default();
        let mut count = 0;
        if let Some((evaluation, cost)) = self.begun.take() {
            rows.push(evaluation, cost);
            count += 1;
        }
        while !self.is_at_end {
            let Some(line) = self.lines.next()? else {
                self.is_at_end = true;
                break;
            };
            if line.trim().is_empty() {
                continue;
            }
            if line.trim_start().starts_with(|c: char| c.is_alphabetic() || c == '"')
                && !is_number(&line)
            {
                self.columns = Some(self.heading(&line)?);
                if count > 0 {
                    break;
                }
                continue;
            }
            let (evaluation, cost) = self.row(&line)?;
            if count > 0 && (evaluation == 1 || evaluation < rows.last()) {
                self.begun = Some((evaluation, cost));
                break;
            }
            rows.push(evaluation, cost);
            count += 1;
        }
        Ok((count > 0).then_some(rows))
    }

    fn heading(&self, line: &str) -> Result<Columns, ImportError> {
        let names: Vec<&str> = line.split_whitespace().map(|name| name.trim_matches('"')).collect();
        let place = |wanted: &str| names.iter().position(|name| *name == wanted);
        let cost = place("raw_y").or_else(|| place("raw_y_best"));
        match (place("evaluations"), cost) {
            (Some(evaluations), Some(cost)) => Ok(Columns { evaluations, cost }),
            _ => Err(self.lines.unexpected(line, "the columns `evaluations` and `raw_y`")),
        }
    }

    fn row(&self, line: &str) -> Result<(u64, f64), ImportError> {
        let Some(columns) = self.columns else {
            return Err(self.lines.unexpected(line, "a heading with `evaluations` and `raw_y`"));
        };
        let field = |place: usize, expected: &str| {
            let field = line.split_whitespace().nth(place);
            field.ok_or_else(|| {
                self.lines.unexpected(line, &format!("{expected} in column {}", place + 1))
            })
        };
        let text = field(columns.evaluations, "an evaluation")?;
        let evaluation = text.parse().ok().filter(|evaluation| *evaluation > 0);
        let evaluation = evaluation
            .ok_or_else(|| self.lines.unexpected(text, "an evaluation, counted from one"))?;
        let text = field(columns.cost, "a cost")?;
        let cost = text.parse().map_err(|_| self.lines.unexpected(text, "a cost"))?;
        Ok((evaluation, cost))
    }
}

/// Whether a line begins with a number, as `inf` and `nan` are.
fn is_number(line: &str) -> bool {
    line.split_whitespace().next().is_some_and(|word| word.parse::<f64>().is_ok())
}
