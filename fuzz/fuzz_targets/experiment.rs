//! Experiment files: read or refused; what is read is planned or refused, and written and read again as the same plan.
#![no_main]

use driftless::experiment::Experiment;
use driftless::input::Document;
use driftless::registry;
use driftless_fuzz::{check_told, document};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Some(document) = document("experiment.toml", bytes) else { return };
    let registry = registry();
    let Some(experiment) = check_told(Experiment::read(&document, &registry)) else { return };
    let Some(plan) = check_told(experiment.plan()) else { return };
    let Ok(written) = plan.experiment.to_toml() else { return };
    let again = Document::embedded("again.toml", &written);
    let again = Experiment::read(&again, &registry).expect("what was written can be read");
    let again = again.plan().expect("and planned");
    let keys = |plan: &driftless::experiment::Plan| -> Vec<String> {
        plan.runs.iter().map(|run| run.key.clone()).collect()
    };
    assert_eq!(keys(&again), keys(&plan));
});
