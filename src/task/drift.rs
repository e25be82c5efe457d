//! The angular momentum that a robot starts with.

use std::ops::Range;

use nalgebra::Vector3;
use toml::Spanned;

use super::{Posture, Task, TaskTable};
use crate::input::{Document, Finite, InputError};
use crate::momentum::locked_momentum;
use crate::robot::Robot;
use crate::vec3::Vec3;

impl TaskTable {
    /// Total angular momentum, inertial axes \[N·m·s\]: as stated, or what the base's rate at the start comes to while the joints
    /// stand still. None where it is zero.
    pub(super) fn total_angular_momentum(
        &self,
        start: &Posture,
        robot: &Robot,
        document: &Document,
    ) -> Result<Option<Vector3<f64>>, InputError> {
        if let Some(rate) = &self.goal.base_rate_deg_s {
            let message = "found `base_rate_deg_s`, which is for the start alone: at the goal it follows from the momentum";
            return Err(document.error_at(rate.span(), message, None));
        }
        let vector = |numbers: &[Finite; 3]| Vector3::from(numbers.map(|number| number.0));
        let momentum = match (&self.angular_momentum, &self.start.base_rate_deg_s) {
            (Some(momentum), Some(_)) => {
                let message = "found both `angular_momentum` and the start's `base_rate_deg_s`, expected one of them";
                return Err(document.error_at(momentum.span(), message, None));
            }
            (Some(momentum), None) => vector(momentum.get_ref()),
            (None, Some(rate)) => {
                let rate = Vec3::of(&vector(rate.get_ref()).map(f64::to_radians));
                start.base * Vector3::from(locked_momentum(robot, &start.joints, rate))
            }
            (None, None) => return Ok(None),
        };
        Ok((momentum.norm() > 0.0).then_some(momentum))
    }

    /// Refuses what is not planned for robots that have momentum.
    pub(super) fn check_drifting(
        &self,
        task: &Task,
        document: &Document,
    ) -> Result<(), InputError> {
        let is_spun = self.via.iter().any(|via| via.get_ref().angular_momentum.is_some());
        if task.angular_momentum.is_none() && !is_spun {
            return Ok(());
        }
        let (limits, weights) = (&self.limits, &self.weights);
        let keys = [
            ("base_turn_deg", span(limits.base_turn_deg.as_ref())),
            ("base_cone", span(limits.base_cone.as_ref())),
            ("base_rate_deg_s", span(limits.base_rate_deg_s.as_ref())),
            ("tool_speed_m_s", span(limits.tool_speed_m_s.as_ref())),
            ("torque_n_m", span(limits.torque_n_m.as_ref())),
            ("largest_turn", span(weights.largest_turn.as_ref())),
            ("mean_turn", span(weights.mean_turn.as_ref())),
            ("keep_out", self.keep_out.inertial()),
            ("robust", span(self.robust.as_ref())),
        ];
        let mut keys = keys.into_iter().filter_map(|(key, span)| Some((key, span?)));
        let Some((key, span)) = keys.next() else { return Ok(()) };
        let message = format!("found `{key}`, expected none for a robot that has angular momentum");
        let help = "such robots are planned within the limits of the joints, `clearance_m` and `keep_out` of what stands \
                    on the base"
            .to_owned();
        Err(document.error_at(span, message, Some(help)))
    }
}

fn span<T>(value: Option<&Spanned<T>>) -> Option<Range<usize>> {
    value.map(Spanned::span)
}
