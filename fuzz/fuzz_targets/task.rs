//! Task files: read or refused; what is read is written and read again as the same, and its problem can be evaluated.
#![no_main]

use std::sync::Arc;

use driftless::input::Document;
use driftless::reorientation::{Formulated, Formulation, TaskFile, TaskProblem};
use driftless::search::Problem;
use driftless_fuzz::{check_told, document};
use libfuzzer_sys::fuzz_target;

/// Finer problems take a second each.
const FINEST: usize = 2_000;

fuzz_target!(|bytes: &[u8]| {
    let Some(document) = document("task.toml", bytes) else { return };
    let Some(file) = check_told(TaskFile::read(&document)) else { return };
    let Some(problem) = check_told(file.problem(&document)) else { return };
    let written = toml::to_string(&file.resolved(&problem)).expect("a task can be written");
    let again = Document::embedded("again.toml", &written);
    let file = TaskFile::read(&again).expect("what was written can be read");
    let same = file.problem(&again).expect("and built");
    assert_eq!(toml::to_string(&file.resolved(&same)).unwrap(), written);
    match problem {
        TaskProblem::SinePolynomial(problem, boxes) => {
            let accuracy = problem.accuracy();
            if accuracy.attitude_steps.max(accuracy.peak_intervals) > FINEST {
                return;
            }
            let problem = Arc::new(problem);
            for formulation in Formulation::ALL {
                if let Ok(formulated) = Formulated::new(formulation, problem.clone(), &boxes) {
                    evaluate(&formulated);
                }
            }
        }
        TaskProblem::Spline(problem, _) => {
            let accuracy = problem.accuracy();
            if accuracy.attitude_steps.max(accuracy.peak_intervals) > FINEST {
                return;
            }
            if let Ok(formulated) = Formulated::free_form(Arc::new(problem)) {
                evaluate(&formulated);
            }
        }
    }
});

fn evaluate(problem: &dyn Problem) {
    let middle: Vec<f64> = problem.bounds().iter().map(|[a, b]| a + 0.3 * (b - a)).collect();
    let _ = problem.evaluate(&middle);
}
