//! What is worth a warning before work begins.

use crate::experiment::{Plan, Store};

/// Says what is doubtful about an experiment's subjects, once each.
pub(super) fn warn_of_subjects(plan: &Plan) {
    let mut told = Vec::new();
    for warning in plan.instances.iter().filter_map(|instance| instance.subject.warning()) {
        if !told.contains(&warning) {
            note!("warning: {warning}");
            told.push(warning);
        }
    }
}

/// Says when a comparison is not one at the same price.
pub(super) fn warn_of_budgets(plan: &Plan) {
    if plan.is_uneven() {
        note!(
            "warning: budgets differ within the field, so final costs do not compare; evaluations to a \
             target do"
        );
    }
}

/// Files that are named one by one.
const MOST_NAMED: usize = 10;

/// Names the stored files that could not be used.
pub(super) fn warn_of_damage(store: &Store) {
    let damaged = store.damaged();
    for damage in damaged.iter().take(MOST_NAMED) {
        note!("warning: {damage}; its batch is left out");
    }
    match damaged.len() {
        0 => {}
        count if count > MOST_NAMED => {
            note!(
                "warning: {} more files are damaged; `driftless run` does their runs again",
                count - MOST_NAMED
            );
        }
        _ => note!("`driftless run` sets damaged files aside and does their runs again"),
    }
}
