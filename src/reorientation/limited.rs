//! What a task limits on the way, over the samples of a motion.

use nalgebra::Vector3;
use serde::Serialize;

use super::excursions::{highest_sample, peak, places};
use super::motion::Motion;
use super::path::{Heights, Watched};
use crate::clearance::Scene;
use crate::lanes::Width;
use crate::posture::Posture;
use crate::so3::Quat;
use crate::task::{ClearanceLimit, Task};
use crate::vec3::Vec3;

/// Something that has a limit on the way, over time.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Limited {
    /// What it is.
    pub(super) name: String,
    /// `°`, `°/s`, `m/s` or `m`; nothing of shares.
    pub(super) unit: &'static str,
    /// In this unit.
    pub(super) limit: f64,
    /// Whether there has to be at least so much of it.
    pub(super) is_least: bool,
    /// At every sample.
    pub(super) values: Vec<f64>,
    /// The value that uses most of the limit, and when \[s\].
    pub(super) worst: f64,
    pub(super) worst_at: f64,
}

/// The two closest points of bodies that have to keep a distance, inertial axes with the origin at the system's centre of
/// mass \[m\].
pub(super) type Nearest = [[f64; 3]; 2];

/// All that a task limits; nothing where it limits nothing.
pub(super) fn limited(task: &Task, motion: &Motion) -> Vec<Limited> {
    let path = &task.path;
    if path.is_empty() {
        return Vec::new();
    }
    let cones = (0..path.base_cones.len()).map(Watched::BaseCone);
    let torques = (0..task.robot.joint_count()).map(Watched::Torque);
    let watched = [Watched::BaseTurn, Watched::BaseRate, Watched::ToolSpeed];
    let watched: Vec<Watched> = watched.into_iter().chain(cones).chain(torques).collect();
    let places = places(task, motion);
    let heights =
        Heights { task, bodies: None, far: f64::INFINITY, watched: &watched, places: &places };
    let heights = Width::widest().run(heights);
    let of = |one: Watched| {
        let index = watched.iter().position(|own| *own == one)?;
        Some(heights[index].clone())
    };
    let duration = motion.time.last().copied().unwrap_or_default();
    let mut all = Vec::new();
    let mut tell = |name: &str, unit, limit: Option<f64>, is_least, values: Option<Vec<f64>>| {
        let limited = limit.zip(values);
        all.extend(limited.map(|(limit, values)| {
            let sign = if is_least { -1.0 } else { 1.0 };
            let heights = values.iter().map(|value| sign * value).collect::<Vec<f64>>();
            // Another pair of bodies may be the closest at the next sample, so there is no parabola.
            let (height, share) = match unit {
                "m" => highest_sample(&heights),
                _ => peak(heights.len(), |at| heights[at]),
            };
            let (worst, worst_at) = (sign * height, share * duration);
            Limited { name: name.to_owned(), unit, limit, is_least, values, worst, worst_at }
        }));
    };
    let in_degrees = |values: Option<Vec<f64>>| {
        values.map(|values| values.into_iter().map(f64::to_degrees).collect())
    };
    let angle = |limit: Option<f64>| limit.map(f64::to_degrees);
    let turn = in_degrees(of(Watched::BaseTurn));
    tell("turn of the base", "°", angle(path.base_turn), false, turn);
    for (k, cone) in path.base_cones.iter().enumerate() {
        let name = match path.base_cones.len() {
            1 => "angle to the cone".to_owned(),
            _ => format!("angle to cone {}", k + 1),
        };
        // Of a cone to stay out of the height is the angle with the other sign.
        let values = in_degrees(
            of(Watched::BaseCone(k)).map(|heights| heights.into_iter().map(f64::abs).collect()),
        );
        tell(&name, "°", angle(Some(cone.angle)), cone.outside, values);
    }
    let rate = in_degrees(of(Watched::BaseRate));
    tell("rate of the base", "°/s", angle(path.base_rate), false, rate);
    tell("speed of the tool", "m/s", path.tool_speed, false, of(Watched::ToolSpeed));
    let torques = path.torque.iter().flatten().enumerate();
    let torques = torques.filter_map(|(joint, limit)| {
        let values = of(Watched::Torque(joint))?;
        Some(values.into_iter().map(|torque| torque / limit).collect::<Vec<f64>>())
    });
    let largest = torques.reduce(|a, b| a.iter().zip(b).map(|(a, b)| a.max(b)).collect());
    tell("torque", "", largest.is_some().then_some(1.0), false, largest);
    if let Some(limit) = &path.clearance {
        let distance = |at| Some(nearest_pair(limit, &scene(limit, motion, at))?.1);
        let distances: Option<Vec<f64>> = (0..motion.time.len()).map(distance).collect();
        tell("clearance", "m", Some(limit.least), true, distances);
    }
    all
}

/// The closest points of what has to keep a distance, at every sample; nothing where nothing has to.
pub(super) fn nearest(task: &Task, motion: &Motion) -> Option<Vec<Nearest>> {
    let limit = task.path.clearance.as_ref()?;
    let points = |at: usize| {
        let scene = scene(limit, motion, at);
        let (pair, _) = nearest_pair(limit, &scene)?;
        let attitude = motion.base[at];
        let origin = Posture::of(&task.robot, &positions(motion, at), attitude).position;
        let in_inertial_axes =
            |point: Vec3<f64>| (attitude * Vector3::from(point) + Vector3::from(origin)).into();
        Some(scene.clearance(pair).points.map(in_inertial_axes))
    };
    (0..motion.time.len()).map(points).collect()
}

fn positions(motion: &Motion, at: usize) -> Vec<f64> {
    motion.joints.iter().map(|joint| joint.derivatives[at][0]).collect()
}

fn scene<'a>(limit: &'a ClearanceLimit, motion: &Motion, at: usize) -> Scene<'a> {
    limit.bodies.at(&positions(motion, at), Quat::from(motion.base[at]))
}

/// The pair that is nearest, and how far its bodies are apart; of pairs that have to keep no distance only those that overlap.
fn nearest_pair(limit: &ClearanceLimit, scene: &Scene<'_>) -> Option<(usize, f64)> {
    let distances = scene.distances().into_iter().enumerate();
    let counted = distances
        .filter(|(pair, distance)| *distance < 0.0 || limit.least_of_pairs[*pair] == limit.least);
    counted.min_by(|a, b| a.1.total_cmp(&b.1))
}
