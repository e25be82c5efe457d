//! What is worth a warning before work begins.

use crate::experiment::Plan;

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
