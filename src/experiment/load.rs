//! Reading stored runs.

use polars::prelude::*;

use super::plan::Plan;
use super::record::Status;
use super::run::{Improvement, Run};
use super::schema::{runs, traces};
use super::specs::RunSpec;
use super::store::{Store, StoreError};

/// The columns of `runs` that are read.
const COLUMNS: [&str; 7] = [
    runs::KEY,
    runs::STATUS,
    runs::EVALUATIONS,
    runs::FIRST_FEASIBLE,
    runs::CERTIFIED_COST,
    runs::SECONDS,
    runs::POINT,
];

/// The stored runs of a plan, in its order. They are labelled as the plan labels them: an edited
/// experiment may call a stored run by another name.
pub fn load(plan: &Plan, store: &Store) -> Result<Vec<Run>, StoreError> {
    let planned = plan.places();
    let wanted = |key: &str| planned.contains_key(key);
    let measures: Vec<&str> = plan.measures().iter().map(|m| m.name.as_str()).collect();
    let mut runs: Vec<Option<Run>> = Vec::new();
    runs.resize_with(plan.runs.len(), || None);
    store.visit("runs", &COLUMNS, &measures, wanted, |frame| {
        let columns = Columns::of(frame, &measures)?;
        for row in 0..frame.height() {
            if let Some(&i) = columns.key.get(row).and_then(|key| planned.get(key)) {
                runs[i] = Some(columns.run(row, &plan.runs[i])?);
            }
        }
        Ok(())
    })?;
    let columns = [traces::KEY, traces::EVALUATION, traces::COST];
    store.visit("traces", &columns, &[], wanted, |frame| {
        let keys = frame.column(traces::KEY)?.str()?;
        let evaluations = frame.column(traces::EVALUATION)?.u64()?;
        let costs = frame.column(traces::COST)?.f64()?;
        for ((key, evaluation), cost) in keys.iter().zip(evaluations.iter()).zip(costs.iter()) {
            let run = key.and_then(|key| planned.get(key)).and_then(|&i| runs[i].as_mut());
            if let (Some(run), Some(evaluation), Some(cost)) = (run, evaluation, cost) {
                run.trace.push(Improvement { evaluation, cost });
            }
        }
        Ok(())
    })?;
    Ok(runs.into_iter().flatten().collect())
}

/// The stored runs of a plan, of several stores; the first that has a run gives it.
pub fn load_all(plan: &Plan, stores: &[&Store]) -> Result<Vec<Run>, StoreError> {
    let mut found: Vec<Option<Run>> = Vec::new();
    found.resize_with(plan.runs.len(), || None);
    let places = plan.places();
    for store in stores {
        for run in load(plan, store)? {
            if let Some(&place) = places.get(run.key.as_str()) {
                found[place].get_or_insert(run);
            }
        }
    }
    Ok(found.into_iter().flatten().collect())
}

/// The columns of `runs` that are read.
struct Columns<'a> {
    key: &'a StringChunked,
    status: &'a StringChunked,
    evaluations: &'a UInt64Chunked,
    first_feasible: &'a UInt64Chunked,
    cost: &'a Float64Chunked,
    seconds: &'a Float64Chunked,
    x: &'a ListChunked,
    measures: Vec<Float64Chunked>,
}

impl<'a> Columns<'a> {
    fn of(frame: &'a DataFrame, measures: &[&str]) -> PolarsResult<Self> {
        let number = |name: &&str| {
            let column = frame.column(name)?;
            // What is no number, such as a list of coefficients, is stored and not read.
            let numbers = column.cast(&DataType::Float64);
            let none = || Float64Chunked::full_null((*name).into(), frame.height());
            numbers.map_or_else(|_| Ok(none()), |numbers| Ok(numbers.f64()?.clone()))
        };
        Ok(Self {
            key: frame.column(runs::KEY)?.str()?,
            status: frame.column(runs::STATUS)?.str()?,
            evaluations: frame.column(runs::EVALUATIONS)?.u64()?,
            first_feasible: frame.column(runs::FIRST_FEASIBLE)?.u64()?,
            cost: frame.column(runs::CERTIFIED_COST)?.f64()?,
            seconds: frame.column(runs::SECONDS)?.f64()?,
            x: frame.column(runs::POINT)?.list()?,
            measures: measures.iter().map(number).collect::<PolarsResult<_>>()?,
        })
    }

    fn run(&self, row: usize, spec: &RunSpec) -> PolarsResult<Run> {
        let failed = self.status.get(row).is_some_and(Status::is_failure);
        let cost = self.cost.get(row).filter(|cost| !failed && cost.is_finite());
        let x = match self.x.get_as_series(row) {
            Some(list) => list.f64()?.into_no_null_iter().collect(),
            None => Vec::new(),
        };
        Ok(Run {
            key: spec.key.clone(),
            optimiser: spec.optimiser,
            instance: spec.instance,
            seed: spec.seed,
            budget: spec.budget,
            cost: cost.unwrap_or(f64::INFINITY),
            measures: self.measures.iter().map(|m| m.get(row).unwrap_or(f64::NAN)).collect(),
            evaluations: self.evaluations.get(row).unwrap_or_default(),
            first_feasible: self.first_feasible.get(row),
            seconds: self.seconds.get(row).unwrap_or(f64::NAN),
            x,
            trace: Vec::new(),
        })
    }
}
