//! Joint rates, accelerations and jerks over time with their limits: the paper's Figure 5.

use super::joint_angles::{joint_panel, kinds};
use crate::figure::Figure;
use crate::reorientation::motion::Motion;
use crate::robot::JointKind;
use crate::trajectory::Limits;

/// Joint rates, accelerations and jerks over time; dotted lines are the limits.
pub(super) fn derivatives(motion: &Motion, limits: &Limits) -> Figure {
    let of_kind = |kind: JointKind| {
        let unit = kind.symbol();
        let labels = [
            format!("rate [{unit}/s]"),
            format!("acceleration [{unit}/s²]"),
            format!("jerk [{unit}/s³]"),
        ];
        labels.into_iter().enumerate().map(move |(k, label)| {
            let own = motion.joints.iter().zip(&limits.0).filter(|(joint, _)| joint.kind == kind);
            let mut distinct: Vec<f64> =
                own.map(|(_, limit)| kind.to_file_units(limit[k])).collect();
            distinct.dedup();
            joint_panel(motion, kind, k + 1, &label, &distinct)
        })
    };
    let panels = kinds(motion).flat_map(of_kind);
    Figure::column(panels.collect(), 34.0)
}
