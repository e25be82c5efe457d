//! What is worth a warning before work begins.

use crate::experiment::{Plan, Store};
use crate::words::plural;

/// Says what is doubtful about an experiment's subjects, once each.
pub(super) fn warn_of_subjects(plan: &Plan) {
    plan.instances.iter().for_each(|instance| super::warn_once(instance.subject.warning()));
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

/// Names the stored files that could not be used, and says what helps.
pub(super) fn warn_of_damage(store: &Store) {
    let damaged = store.damaged();
    for damage in damaged.iter().take(MOST_NAMED) {
        note!("warning: {damage}; its batch is left out");
    }
    if damaged.len() > MOST_NAMED {
        let more = plural(damaged.len() - MOST_NAMED, "more file");
        note!("warning: {more} cannot be used; `driftless status --json` names all");
    }
    if damaged.iter().any(|damage| damage.may_be_whole) {
        note!(
            "files that cannot be read may be whole, so `driftless run` stops until they can be: check their permissions and \
             their disk"
        );
    } else if !damaged.is_empty() {
        note!("`driftless run` sets damaged files aside and does their runs again");
    }
}
