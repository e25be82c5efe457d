//! Rows of the `traces` table.

use std::collections::HashMap;

use polars::prelude::*;

/// Evaluation and best cost so far: improvements in order, then the last evaluation. Empty for a run
/// that found nothing.
pub type Trace = Vec<(u64, f64)>;

/// The rows of a `traces` table, by the run's key.
pub fn traces(frame: &DataFrame) -> PolarsResult<HashMap<String, Trace>> {
    let mut traces: HashMap<String, Trace> = HashMap::new();
    if frame.height() == 0 {
        return Ok(traces);
    }
    let keys = frame.column("key")?.str()?;
    let evaluations = frame.column("evaluation")?.u64()?;
    let costs = frame.column("j")?.f64()?;
    for i in 0..frame.height() {
        if let (Some(key), Some(n), Some(j)) = (keys.get(i), evaluations.get(i), costs.get(i)) {
            match traces.get_mut(key) {
                Some(trace) => trace.push((n, j)),
                None => drop(traces.insert(key.to_owned(), vec![(n, j)])),
            }
        }
    }
    Ok(traces)
}
