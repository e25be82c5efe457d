//! How far the base and the joints go on the way.

use nalgebra::Vector3;

use super::motion::Motion;
use crate::momentum::base_twist;
use crate::task::Task;

/// The extremes of a motion between its start and its end. They are read off the samples of a motion and parabolas through
/// these.
#[derive(Debug, Clone, PartialEq)]
pub struct Excursions {
    /// Largest turn of the base from its attitude at the start \[rad\].
    pub base_turn: f64,
    /// When it is turned so far \[s\].
    pub base_turn_at: f64,
    /// Largest angular speed of the base \[rad/s\].
    pub base_rate: f64,
    /// Each joint's least and largest position \[rad\].
    pub positions: Vec<[f64; 2]>,
}

impl Excursions {
    /// Those of a motion that has been sampled finely.
    pub fn of(task: &Task, motion: &Motion) -> Self {
        let joints = task.robot.joint_count();
        let base_rate = |at: usize| {
            let [positions, rates] = [0, 1].map(|order| -> Vec<f64> {
                motion.joints.iter().map(|joint| joint.derivatives[at][order]).collect()
            });
            Vector3::from(base_twist(&task.robot, &positions, &rates).angular).norm()
        };
        let count = motion.time.len();
        let turn = |at: usize| motion.base[0].angle_to(&motion.base[at]);
        let (base_turn, place) = peak(count, turn);
        let duration = motion.time.last().copied().unwrap_or_default();
        let positions = (0..joints).map(|joint| {
            let position = |at: usize| motion.joints[joint].derivatives[at][0];
            [-peak(count, |at| -position(at)).0, peak(count, position).0]
        });
        Self {
            base_turn,
            base_turn_at: duration * place,
            base_rate: peak(count, base_rate).0,
            positions: positions.collect(),
        }
    }

    /// How far each joint goes from the middle of its range, as a share of half the range: 1 at either end.
    pub fn range_used(&self, task: &Task) -> Vec<f64> {
        let joints = task.robot.joints().zip(&self.positions);
        let used = joints.map(|(joint, [least, largest])| {
            let [lower, upper] = joint.range;
            let (middle, half) = (f64::midpoint(lower, upper), (upper - lower) / 2.0);
            (largest - middle).max(middle - least) / half
        });
        used.collect()
    }
}

/// The largest value, and where it is as a share of the way.
fn peak(count: usize, value: impl Fn(usize) -> f64) -> (f64, f64) {
    let values: Vec<f64> = (0..count).map(value).collect();
    let place = (0..count).max_by(|&a, &b| values[a].total_cmp(&values[b])).unwrap_or_default();
    let intervals = (count.max(2) - 1) as f64;
    let at = place as f64;
    let [Some(before), Some(after)] =
        [place.checked_sub(1), Some(place + 1)].map(|k| k.and_then(|k| values.get(k)))
    else {
        return (values.get(place).copied().unwrap_or_default(), at / intervals);
    };
    let (slope, bend) = ((after - before) / 2.0, before + after - 2.0 * values[place]);
    if bend < 0.0 {
        let step = -slope / bend;
        (values[place] + slope * step / 2.0, (at + step) / intervals)
    } else {
        (values[place], at / intervals)
    }
}
