//! Results of other programs: traces of runs, whose subjects and optimisers can be reported and not be run.
//!
//! [`Foreign`] is what a reader of other tools' files hands over. A folder keeps it as every other experiment, with an
//! `[imported]` table that says where it comes from and which runs there are.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::fmt::Write as _;
use std::num::NonZeroU64;

use toml::Spanned;

use super::entrant::Entrant;
use super::field::Entry;
use super::file::Experiment;
use super::identity::Identity;
use super::import_table::{DataFormat, ImportTable, RunsTable};
use super::plan::Plan;
use super::provenance::Provenance;
use super::specs::RunSpec;
use super::stored::ProblemTable;
use crate::digest::digest;
use crate::input::InputError;

/// How far above a known least cost the targets are: those of the test functions.
const TARGETS: [f64; 3] = [1e-2, 1e-5, 1e-8];

/// Results of other programs.
#[derive(Debug, Clone, PartialEq)]
pub struct Foreign {
    /// Whose format the data have.
    pub format: DataFormat,
    /// What the data are called.
    pub from: String,
    /// The instances.
    pub problems: Vec<ForeignProblem>,
    /// The optimisers.
    pub optimisers: Vec<ForeignOptimiser>,
    /// The runs: of one optimiser on one instance with one seed there is one.
    pub runs: Vec<ForeignRun>,
}

/// An instance of another program.
#[derive(Debug, Clone, PartialEq)]
pub struct ForeignProblem {
    /// What determines it.
    pub provenance: Provenance,
    /// The least cost that there is, or that is known, if any is.
    pub optimum: Option<f64>,
}

/// An optimiser of another program.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ForeignOptimiser {
    /// Its name.
    pub name: String,
    /// What the data say of it beside; may be empty.
    pub info: String,
}

/// A run of another program.
#[derive(Debug, Clone, PartialEq)]
pub struct ForeignRun {
    /// Index of the instance.
    pub problem: usize,
    /// Index of the optimiser.
    pub optimiser: usize,
    /// Seed, or the number of the repetition.
    pub seed: u64,
    /// Evaluations that it was allowed.
    pub budget: NonZeroU64,
    /// Evaluations that it made.
    pub evaluations: u64,
    /// Improvements of the best cost and the last evaluation, in order; empty where no cost was finite.
    pub trace: Vec<ForeignStep>,
}

/// A row of an imported run's trace.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForeignStep {
    /// Which evaluation, counted from one.
    pub evaluation: u64,
    /// Best cost so far.
    pub cost: f64,
    /// Wall time since the run began \[s\], if it is known.
    pub seconds: Option<f64>,
}

impl Foreign {
    /// The results as an experiment of that name.
    pub fn experiment(&self, name: &str) -> Result<Experiment, InputError> {
        let mut experiment = Experiment::new(name)?;
        let document = experiment.document.clone();
        let starts = self.starts().into_iter().zip(self.labels());
        for (problem, (start, label)) in self.problems.iter().zip(starts) {
            experiment = experiment.with_instance(problem.table(label, start).instance(&document)?);
        }
        let kept: Vec<(String, Identity)> = self.entrants();
        for (optimiser, (label, settings)) in self.optimisers.iter().zip(kept) {
            let kind = format!("{} ({})", optimiser.name, self.format.name());
            let entrant = Entrant::outside(kind, settings).labelled(&label);
            experiment.field.push(Entry::from(entrant));
        }
        experiment.seeds = self.most_seeds();
        let budgets = self.runs.iter().map(|run| run.budget);
        experiment.budget = budgets.max().unwrap_or(NonZeroU64::MIN);
        let table = self.table();
        experiment.mark_imported(table);
        Ok(experiment)
    }

    /// The runs of a plan of theirs, each with what was read of it; where nothing was, the run is the error.
    pub(super) fn paired<'a>(
        &'a self,
        plan: &'a Plan,
    ) -> Result<Vec<(&'a RunSpec, &'a ForeignRun)>, &'a RunSpec> {
        let place = |run: &ForeignRun| (run.problem, run.optimiser, run.seed);
        let by_place: BTreeMap<_, _> = self.runs.iter().map(|run| (place(run), run)).collect();
        let pair = |spec: &'a RunSpec| {
            let found = by_place.get(&(spec.instance, spec.optimiser, spec.seed));
            found.map(|run| (spec, *run)).ok_or(spec)
        };
        plan.runs.iter().map(pair).collect()
    }

    /// Labels that tell the instances apart: exports of several experiments may use one number for several.
    fn labels(&self) -> Vec<String> {
        let labels: Vec<String> =
            self.problems.iter().map(|problem| problem.provenance.label()).collect();
        let mut counts: HashMap<&str, usize> = HashMap::new();
        for label in &labels {
            *counts.entry(label).or_default() += 1;
        }
        let label = |(problem, label): (&ForeignProblem, &String)| match &problem.provenance.digest
        {
            Some(digest) if counts[label.as_str()] > 1 => format!("{label} ({digest})"),
            _ => label.clone(),
        };
        self.problems.iter().zip(&labels).map(label).collect()
    }

    /// Labels that tell the optimisers apart, and all that tells each from those of other data: also the data themselves, since a
    /// name and a seed do not say what a run did.
    fn entrants(&self) -> Vec<(String, Identity)> {
        let mut data = vec![BTreeMap::new(); self.optimisers.len()];
        for run in &self.runs {
            let provenance = &self.problems[run.problem].provenance;
            data[run.optimiser].insert((provenance, run.seed), digest(&written(run)));
        }
        let mut taken = HashSet::new();
        let entrant =
            |(optimiser, runs): (&ForeignOptimiser, BTreeMap<(&Provenance, u64), String>)| {
                let runs = serde_json::to_string(&runs.into_iter().collect::<Vec<_>>());
                let settings = serde_json::json!({
                    "imported": self.format.name(),
                    "info": optimiser.info,
                    "data": digest(&runs.unwrap_or_default()),
                });
                let mut label = optimiser.name.clone();
                for n in 2.. {
                    if taken.insert(label.clone()) {
                        break;
                    }
                    label = format!("{} {n}", optimiser.name);
                }
                (label, Identity::of(settings))
            };
        self.optimisers.iter().zip(data).map(entrant).collect()
    }

    /// Of each instance the median of the first costs, which stands for the cost in the middle of the box; NaN where there is
    /// none.
    fn starts(&self) -> Vec<f64> {
        let mut first = vec![Vec::new(); self.problems.len()];
        for run in &self.runs {
            first[run.problem].extend(run.trace.first().map(|step| step.cost));
        }
        let median = |mut costs: Vec<f64>| {
            costs.sort_by(f64::total_cmp);
            costs.get(costs.len() / 2).copied().unwrap_or(f64::NAN)
        };
        first.into_iter().map(median).collect()
    }

    fn most_seeds(&self) -> NonZeroU64 {
        let mut counts: BTreeMap<(usize, usize), u64> = BTreeMap::new();
        for run in &self.runs {
            *counts.entry((run.problem, run.optimiser)).or_default() += 1;
        }
        counts.into_values().max().and_then(NonZeroU64::new).unwrap_or(NonZeroU64::MIN)
    }

    fn table(&self) -> ImportTable {
        let mut cells: BTreeMap<(usize, usize, NonZeroU64), Vec<u64>> = BTreeMap::new();
        for run in &self.runs {
            let cell = (run.optimiser, run.problem, run.budget);
            cells.entry(cell).or_default().push(run.seed);
        }
        let mut tables: BTreeMap<(usize, NonZeroU64, Vec<u64>), Vec<usize>> = BTreeMap::new();
        for ((optimiser, problem, budget), mut seeds) in cells {
            seeds.sort_unstable();
            tables.entry((optimiser, budget, seeds)).or_default().push(problem + 1);
        }
        let table = |((optimiser, budget, seeds), problems)| {
            let optimiser = optimiser + 1;
            Spanned::new(0..0, RunsTable { optimiser, budget, seeds, problems })
        };
        let runs = tables.into_iter().map(table).collect();
        ImportTable { format: self.format, from: self.from.clone(), runs }
    }
}

impl ForeignProblem {
    fn table(&self, label: String, start_cost: f64) -> ProblemTable {
        let optimum = self.optimum.filter(|optimum| optimum.is_finite());
        let targets = optimum.map(|optimum| TARGETS.map(|target| optimum + target));
        ProblemTable::imported(
            &self.provenance,
            label,
            optimum,
            start_cost,
            targets.as_ref().map_or(&[], |t| t),
        )
    }
}

/// A run in full, whatever file it stood in.
fn written(run: &ForeignRun) -> String {
    let mut text = format!("{} {}", run.budget, run.evaluations);
    for step in &run.trace {
        let seconds = step.seconds.map_or(u64::MAX, f64::to_bits);
        let _ = write!(text, " {} {:x} {seconds:x}", step.evaluation, step.cost.to_bits());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn foreign() -> Foreign {
        let provenance = Provenance { name: "p".to_owned(), ..Provenance::default() };
        let run = |seed| ForeignRun {
            problem: 0,
            optimiser: 0,
            seed,
            budget: NonZeroU64::MIN,
            evaluations: 1,
            trace: vec![ForeignStep { evaluation: 1, cost: seed as f64, seconds: None }],
        };
        Foreign {
            format: DataFormat::Csv,
            from: String::new(),
            problems: vec![ForeignProblem { provenance, optimum: None }],
            optimisers: vec![ForeignOptimiser { name: "o".to_owned(), info: String::new() }],
            runs: [3, 1, 2].map(run).into(),
        }
    }

    /// A run that was not read is named, and takes no other's trace.
    #[test]
    fn runs_and_traces_are_paired_by_what_they_are_of() {
        let mut foreign = foreign();
        let plan = foreign.experiment("e").unwrap().plan().unwrap();
        let pairs = foreign.paired(&plan).unwrap();
        assert_eq!(pairs.len(), 3);
        assert!(pairs.iter().all(|(spec, run)| spec.seed == run.seed));
        foreign.runs.retain(|run| run.seed != 2);
        assert_eq!(foreign.paired(&plan).unwrap_err().seed, 2);
    }
}
