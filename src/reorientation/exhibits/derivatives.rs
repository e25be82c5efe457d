//! Joint rates, accelerations and jerks over time with their limits: the paper's Figure 5.

use super::joint_angles::joint_panel;
use crate::figure::Figure;
use crate::reorientation::motion::Motion;
use crate::trajectory::Limits;

/// Joint rates, accelerations and jerks over time; dotted lines are the limits.
pub(super) fn derivatives(motion: &Motion, limits: &Limits) -> Figure {
    let labels = ["rate [°/s]", "acceleration [°/s²]", "jerk [°/s³]"];
    let panels = labels.iter().enumerate().map(|(k, label)| {
        let mut distinct: Vec<f64> = limits.0.iter().map(|limit| limit[k].to_degrees()).collect();
        distinct.dedup();
        joint_panel(motion, k + 1, label, &distinct)
    });
    Figure::column(panels.collect(), 34.0)
}
