//! COCO: an index `*.info` of entries of three lines, and for each entry tables of its runs, `.dat` by targets and `.tdat` by
//! evaluations.
//!
//! The layout is that of the logger `bbob`, formats `bbob-old` (2009) to `bbob-new2`, as `cocopp` 2.9.1 reads it
//! (doi 10.1080/10556788.2020.1808977). Both tables of an entry are rows of the same runs, so a trace has what either tells.

use std::collections::HashMap;
use std::num::NonZeroU64;
use std::path::{Path, PathBuf};

use super::collected::{Collected, ReadRun, Rows};
use super::error::ImportError;
use super::files::{beside, files};
use super::lines::Lines;
use super::{Import, bbob};
use crate::experiment::{DataFormat, EXPORTED_SUITE, ForeignOptimiser, Provenance};
use crate::words::plural;

/// Trial numbers of each instance in an export of this program: instance i with seed s is trial 2,000,000 i + s.
const SEEDS: u64 = 2_000_000;

/// Stands in such an export where no cost was finite.
const NOTHING: f64 = 1e300;

/// The formats of tables: the second column counts evaluations of constraints, or is a cost.
const OLD_FORMATS: [&str; 3] = ["", "bbob", "bbob-old"];
const NEW_FORMATS: [&str; 2] = ["bbob-new", "bbob-new2"];

/// Reads a folder, or one index.
pub(super) fn read(data: &Path) -> Result<Import, ImportError> {
    let mut collected = Collected::default();
    let mut has_differences = false;
    for index in files(data, ["", "info"], "*.info and the tables beside")? {
        let mut lines = Lines::open(&index)?;
        while let Some(entry) = Entry::next(&mut lines, &index)? {
            entry.read(&index, &mut collected)?;
            has_differences |= !entry.is_exported();
        }
    }
    let note = "costs are differences from the optimum, so the least is 0";
    let notes = if has_differences { vec![note.to_owned()] } else { Vec::new() };
    collected.import(DataFormat::Coco, data, notes)
}

/// An entry of an index: the runs of an algorithm on a function with so many variables.
#[derive(Debug, Default)]
struct Entry {
    suite: String,
    function: Option<u32>,
    dimension: Option<u64>,
    algorithm: String,
    format: String,
    /// The line that begins with `%`.
    comment: String,
    tables: Vec<Table>,
}

/// A table that an entry names, and its trials: number, and evaluations where the run came to its end.
#[derive(Debug)]
struct Table {
    path: PathBuf,
    trials: Vec<(u64, Option<u64>)>,
}

impl Entry {
    fn next(lines: &mut Lines, index: &Path) -> Result<Option<Self>, ImportError> {
        let head = loop {
            match lines.next()? {
                None => return Ok(None),
                Some(line) if line.trim().is_empty() => {}
                Some(line) => break line,
            }
        };
        let mut entry = Self::default();
        let mut folder = String::new();
        for (key, value) in pairs(&head) {
            let number = || value.parse().map_err(|_| lines.unexpected(&value, "a whole number"));
            match key.as_str() {
                "suite" => entry.suite = value,
                "funcId" | "function" => entry.function = Some(number()?),
                "DIM" | "dim" => entry.dimension = Some(number()?.into()),
                "algId" | "algorithm" => entry.algorithm = value,
                "data_format" => entry.format = value,
                "folder" => folder = value + "/",
                "indicator" => {
                    let message = "found a suite of two objectives, expected one objective";
                    return Err(lines.error(message));
                }
                _ => {}
            }
        }
        let is_known = OLD_FORMATS.iter().chain(&NEW_FORMATS).any(|known| *known == entry.format);
        if !is_known {
            let known = NEW_FORMATS.join(", ");
            return Err(
                lines.unexpected(&entry.format, &format!("a data_format of {known} or bbob-old"))
            );
        }
        if entry.function.is_none()
            || entry.dimension.is_none()
            || entry.algorithm.trim().is_empty()
        {
            return Err(lines.unexpected(
                &head,
                "funcId, DIM and algId, as in `funcId = 1, DIM = 2, algId = 'name'`",
            ));
        }
        entry.comment = lines.next()?.unwrap_or_default();
        if !entry.comment.starts_with('%') {
            return Err(lines.unexpected(&entry.comment, "a comment that begins with %"));
        }
        let data = lines.next()?.unwrap_or_default();
        for part in data.split(',').map(str::trim).filter(|part| !part.is_empty()) {
            if part.ends_with("dat") {
                let path = beside(index, lines.number(), &format!("{folder}{part}"))?;
                entry.tables.push(Table { path, trials: Vec::new() });
                continue;
            }
            let expected =
                "a table such as data_f1/bbobexp_f1_DIM2.dat and trials such as 1:50|2.3e-01";
            let (number, end) =
                part.split_once(':').map_or((part, None), |(n, end)| (n, Some(end)));
            let evaluations =
                end.map(|end| end.split('|').next().unwrap_or_default().trim().parse());
            match (entry.tables.last_mut(), number.trim().parse(), evaluations.transpose()) {
                (Some(table), Ok(number), Ok(evaluations)) => {
                    table.trials.push((number, evaluations));
                }
                _ => return Err(lines.unexpected(part, expected)),
            }
        }
        if entry.tables.is_empty() {
            return Err(lines.unexpected(&data, "a table such as data_f1/bbobexp_f1_DIM2.dat"));
        }
        Ok(Some(entry))
    }

    /// Adds the runs.
    fn read(&self, index: &Path, collected: &mut Collected) -> Result<(), ImportError> {
        let digests = self.digests();
        for table in &self.tables {
            let (by_target, by_evaluation) =
                (table.path.with_extension("dat"), table.path.with_extension("tdat"));
            let mut parts = Vec::new();
            if by_target.exists() || !by_evaluation.exists() {
                parts.push((Sections::open(&by_target, self)?, by_target));
            }
            if by_evaluation.exists() {
                parts.push((Sections::open(&by_evaluation, self)?, by_evaluation));
            }
            for (place, (number, evaluations)) in table.trials.iter().enumerate() {
                let mut all: Option<Section> = None;
                for (sections, path) in &mut parts {
                    let Some(section) = sections.next()? else {
                        let expected = table.trials.len();
                        let message = format!(
                            "found {}, expected {expected} as in {}",
                            plural(place, "run"),
                            index.display()
                        );
                        return Err(ImportError::of(path, message));
                    };
                    all = Some(match all {
                        Some(first) => Section { rows: first.rows.with(section.rows), ..first },
                        None => section,
                    });
                }
                let Section { rows, optimum } = all.unwrap_or_default();
                if let Some(end) = evaluations.filter(|end| rows.last() > *end) {
                    let message = format!(
                        "found the evaluation {} in run {}, expected {end} at most as in {}",
                        rows.last(),
                        place + 1,
                        index.display()
                    );
                    return Err(ImportError::of(&table.path, message));
                }
                let (instance, seed) = self.trial(*number, index)?;
                let run = ReadRun {
                    provenance: Provenance {
                        suite: self.suite.clone(),
                        function: self.function,
                        name: self.function_name(),
                        dimension: self.dimension,
                        instance: Some(instance),
                        digest: digests.get(&instance).cloned(),
                    },
                    optimiser: ForeignOptimiser {
                        name: self.algorithm.clone(),
                        info: String::new(),
                    },
                    seed,
                    budget: self.budget(),
                    optimum,
                    trace: rows.into_trace(evaluations.unwrap_or(0)),
                };
                collected.add(run, index)?;
            }
            for (sections, path) in &mut parts {
                if sections.next()?.is_some() {
                    let expected = table.trials.len();
                    let message =
                        format!("found more runs, expected {expected} as in {}", index.display());
                    return Err(ImportError::of(path, message));
                }
            }
        }
        Ok(())
    }

    fn is_exported(&self) -> bool {
        self.suite == EXPORTED_SUITE
    }

    /// Instance and seed of a trial.
    fn trial(&self, number: u64, index: &Path) -> Result<(u32, Option<u64>), ImportError> {
        let (instance, seed) = if self.is_exported() {
            (number / SEEDS, Some(number % SEEDS))
        } else {
            (number, None)
        };
        let instance = u32::try_from(instance).map_err(|_| {
            ImportError::of(
                index,
                format!("found the trial {number}, expected an instance's number"),
            )
        })?;
        Ok((instance, seed))
    }

    /// The function's name, which exports of this program have in the comment, before that of the algorithm.
    fn function_name(&self) -> String {
        if self.suite == bbob::SUITE {
            return self.function.and_then(bbob::name).unwrap_or_default().to_owned();
        }
        let comment = self.comment.trim_start_matches('%').trim_start();
        let name = comment.split_once(&format!(": {} ", self.algorithm)).map(|(name, _)| name);
        name.filter(|_| self.is_exported()).unwrap_or_default().to_owned()
    }

    /// What runs were allowed, which an export of this program says at the end of the comment.
    fn budget(&self) -> Option<NonZeroU64> {
        let (_, budget) = self.comment.rsplit_once("; budget ")?;
        budget.trim().parse().ok().filter(|_| self.is_exported())
    }

    /// What tells instances from all others, by their numbers, which an export of this program says in the comment, before the
    /// budget.
    fn digests(&self) -> HashMap<u32, String> {
        let behind = self.comment.rsplit_once("; digests of instances ").map(|(_, behind)| behind);
        let digests = behind.and_then(|behind| behind.split_once(';')).map(|(digests, _)| digests);
        let digest = |part: &str| {
            let (number, digest) = part.trim().split_once(' ')?;
            Some((number.parse().ok()?, digest.to_owned()))
        };
        let parts = digests.filter(|_| self.is_exported()).unwrap_or_default().split(',');
        parts.filter_map(digest).collect()
    }

    /// Whether an export of this program says in the comment that optima are known beforehand.
    fn knows_optima(&self) -> bool {
        self.comment.contains("; Fopt: known beforehand;")
    }
}

/// Keys and values of an entry's first line, `key = value, key = 'value'`.
fn pairs(line: &str) -> Vec<(String, String)> {
    let mut pairs = Vec::new();
    let mut rest = line;
    while let Some((key, behind)) = rest.split_once('=') {
        let behind = behind.trim_start();
        let quote = behind.chars().next().filter(|c| ['\'', '"'].contains(c));
        // A quote within a value is one that no comma follows.
        let end = quote.and_then(|quote| {
            let ends = behind.match_indices(quote).skip(1).map(|(end, _)| end);
            let is_last = |end: &usize| {
                let after = behind[end + 1..].trim_start();
                after.is_empty() || after.starts_with(',')
            };
            ends.into_iter().find(is_last)
        });
        let (value, after) = match end {
            Some(end) => (&behind[1..end], &behind[end + 1..]),
            None => behind
                .split_once(',')
                .map_or((behind, ""), |(value, _)| (value, &behind[value.len()..])),
        };
        pairs.push((key.trim().to_owned(), value.trim().to_owned()));
        rest = after.trim_start().strip_prefix(',').unwrap_or_default();
    }
    pairs
}

/// A run as a table has it.
#[derive(Debug, Default)]
struct Section {
    rows: Rows,
    optimum: Option<f64>,
}

/// The runs of a table, one at a time: rows between comments.
struct Sections<'a> {
    lines: Lines,
    entry: &'a Entry,
    /// The optimum that the last comment tells.
    optimum: Option<f64>,
}

impl<'a> Sections<'a> {
    fn open(path: &Path, entry: &'a Entry) -> Result<Self, ImportError> {
        Ok(Self { lines: Lines::open(path)?, entry, optimum: None })
    }

    fn next(&mut self) -> Result<Option<Section>, ImportError> {
        let mut section: Option<Section> = None;
        while let Some(line) = self.lines.next()? {
            if line.trim().is_empty() {
                continue;
            }
            if line.starts_with('%') {
                let optimum = stated_optimum(&line);
                if section.is_some() {
                    self.optimum = optimum;
                    break;
                }
                self.optimum = optimum;
                continue;
            }
            let (evaluation, cost) = self.row(&line)?;
            let begun = section
                .get_or_insert_with(|| Section { optimum: self.least(), ..Section::default() });
            if evaluation < begun.rows.last() {
                let expected = format!("one from {} on, as in the row before", begun.rows.last());
                return Err(self.lines.unexpected(&evaluation.to_string(), &expected));
            }
            begun.rows.push(evaluation, cost);
        }
        Ok(section)
    }

    /// The least cost that is known.
    fn least(&self) -> Option<f64> {
        if self.entry.is_exported() {
            self.optimum.filter(|_| self.entry.knows_optima())
        } else {
            Some(0.0)
        }
    }

    /// Evaluation and cost: the difference from the optimum, since instances of one function differ in their optimum, and values
    /// are written with ten digits, which leave nothing of a small difference. What this program has exported are the values, with
    /// all digits.
    fn row(&self, line: &str) -> Result<(u64, f64), ImportError> {
        let columns: Vec<&str> = line.split_whitespace().take(5).collect();
        let number = |place: usize| -> Result<f64, ImportError> {
            let text = columns.get(place).ok_or_else(|| {
                self.lines.unexpected(line, &format!("a number in column {}", place + 1))
            })?;
            text.parse().map_err(|_| self.lines.unexpected(text, "a number"))
        };
        let evaluation = columns[0].parse().ok().filter(|evaluation| *evaluation > 0);
        let evaluation = evaluation
            .ok_or_else(|| self.lines.unexpected(columns[0], "an evaluation, counted from one"))?;
        if NEW_FORMATS.contains(&self.entry.format.as_str()) && number(1)? != 0.0 {
            let message =
                "found evaluations of constraints, expected a problem without constraints";
            return Err(self.lines.error(message));
        }
        let cost = number(if self.entry.is_exported() { 4 } else { 2 })?;
        let is_nothing = self.entry.is_exported() && cost >= NOTHING;
        Ok((evaluation, if is_nothing { f64::INFINITY } else { cost }))
    }
}

/// The optimum that a comment states, as in `best noise-free fitness - Fopt (7.948000000000e+01)`.
fn stated_optimum(comment: &str) -> Option<f64> {
    let (_, behind) = comment.split_once("Fopt (")?;
    let (number, _) = behind.split_once(')')?;
    number.trim().parse().ok().filter(|optimum: &f64| optimum.is_finite())
}
