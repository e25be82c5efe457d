//! Where a robot is along a motion, for drawing it.

use nalgebra::{UnitQuaternion, Vector3};

use super::motion::Motion;
use crate::posture::{Branches, Posture};
use crate::task::Task;

/// The robot at one time, inertial axes with their origin at the system's centre of mass.
pub(super) struct Snapshot {
    pub(super) time: f64,
    pub(super) attitude: UnitQuaternion<f64>,
    pub(super) base: Vector3<f64>,
    pub(super) tool: Vector3<f64>,
    /// The ends of each link.
    pub(super) links: Vec<[Vector3<f64>; 2]>,
}

impl Snapshot {
    pub(super) fn of(task: &Task, branches: &Branches, motion: &Motion, i: usize) -> Self {
        let angles: Vec<f64> = motion.joints.iter().map(|j| j.derivatives[i][0]).collect();
        let attitude = motion.base[i];
        let posture = Posture::with(branches, &task.robot, &angles, attitude);
        let base = Vector3::from(posture.position);
        let place = |place: &[f64; 3]| base + attitude * Vector3::from(*place);
        let origins: Vec<Vector3<f64>> = posture.origins.iter().map(place).collect();
        let carried = origins.iter().zip(&branches.carriers);
        let carried = carried.filter_map(|(end, carrier)| Some([origins[(*carrier)?], *end]));
        let tips = posture.tips.iter().map(place).zip(&branches.tip_carriers);
        let tips = tips.map(|(end, carrier)| [origins[*carrier], end]);
        Self {
            time: motion.time[i],
            attitude,
            base,
            tool: origins.last().copied().unwrap_or(base),
            links: carried.chain(tips).collect(),
        }
    }
}
