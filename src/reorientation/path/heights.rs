//! Everything that is watched, at many places of a path.

use super::watched::{Place, Watched};
use crate::clearance::Bodies;
use crate::dynamics::{Dynamics, Quantity, State};
use crate::lanes::{LaneWork, Lanes, MOST};
use crate::so3::Quat;
use crate::task::Task;
use crate::vec3::Vec3;

/// The heights of all that is watched, at every place.
pub(in crate::reorientation) struct Heights<'a> {
    pub(in crate::reorientation) task: &'a Task,
    /// Whose clearances are watched.
    pub(in crate::reorientation) bodies: Option<&'a Bodies>,
    /// Clearances above it \[m\] may be taken for smaller ones that are above it too.
    pub(in crate::reorientation) far: f64,
    pub(in crate::reorientation) watched: &'a [Watched],
    pub(in crate::reorientation) places: &'a [Place],
}

impl LaneWork for Heights<'_> {
    type Output = Vec<Vec<f64>>;

    #[inline(always)]
    fn run<T: Lanes>(self) -> Vec<Vec<f64>> {
        let Self { task, bodies, far, watched, places } = self;
        let mut heights = vec![vec![0.0; places.len()]; watched.len()];
        let robot = &task.robot;
        let mut moves = false;
        for (heights, watched) in heights.iter_mut().zip(watched) {
            match watched {
                Watched::BaseTurn | Watched::BaseCone(_) => {
                    for (height, place) in heights.iter_mut().zip(places) {
                        *height = watched.height(task, place);
                    }
                }
                Watched::BaseRate | Watched::ToolSpeed | Watched::Torque(_) => moves = true,
                Watched::Clearance(_) => {}
            }
        }
        let joints = robot.joint_count();
        let mut dynamics = Dynamics::<T>::new(robot);
        let mut states = [0, 1, 2].map(|_| vec![T::of(0.0); joints]);
        let mut distances = vec![T::of(0.0); bodies.map_or(0, |bodies| bodies.pairs().len())];
        for first in (0..places.len()).step_by(T::COUNT) {
            // The last place stands for those beyond it.
            let place = |lane: usize| &places[(first + lane).min(places.len() - 1)];
            let [positions, rates, accelerations] = &mut states;
            let of_joints = positions.iter_mut().zip(rates).zip(accelerations).enumerate();
            for (joint, ((position, rate), acceleration)) in of_joints {
                let mut lanes = [[0.0; MOST]; 3];
                let [positions, rates, accelerations] = &mut lanes;
                let all = positions.iter_mut().zip(rates).zip(accelerations).enumerate();
                for (lane, ((position, rate), acceleration)) in all.take(T::COUNT) {
                    let own = place(lane);
                    *position = own.positions[joint];
                    *rate = own.rates[joint];
                    *acceleration = own.accelerations[joint];
                }
                *position = T::load(&lanes[0]);
                *rate = T::load(&lanes[1]);
                *acceleration = T::load(&lanes[2]);
            }
            let [positions, rates, accelerations] = &states;
            if moves {
                let component = |of: fn(Vec3<f64>) -> f64| {
                    let mut lanes = [0.0; MOST];
                    for (lane, number) in lanes.iter_mut().enumerate().take(T::COUNT) {
                        *number = of(place(lane).momentum);
                    }
                    T::load(&lanes)
                };
                let angular_momentum =
                    Vec3::new(component(|h| h.x), component(|h| h.y), component(|h| h.z));
                let state = State { positions, rates, accelerations, angular_momentum };
                dynamics.evaluate(robot, state);
            }
            if let Some(bodies) = bodies {
                let mut attitudes = [Quat::identity(); MOST];
                for (lane, attitude) in attitudes.iter_mut().enumerate().take(T::COUNT) {
                    *attitude = place(lane).attitude.into();
                }
                bodies.scan_within::<T>(far, positions, Quat::gather(&attitudes), &mut distances);
            }
            for (heights, watched) in heights.iter_mut().zip(watched) {
                let found = match watched {
                    Watched::BaseTurn | Watched::BaseCone(_) => continue,
                    Watched::BaseRate => dynamics.get(Quantity::BaseRate),
                    Watched::ToolSpeed => dynamics.get(Quantity::ToolSpeed),
                    Watched::Torque(joint) => dynamics.get(Quantity::Torque(*joint)).abs(),
                    Watched::Clearance(pair) => -distances[*pair],
                };
                let own = &mut heights[first..];
                let count = own.len().min(T::COUNT);
                own[..count].copy_from_slice(&found.numbers()[..count]);
            }
        }
        heights
    }
}
