//! Where splines are searched.

use crate::task::Task;
use crate::trajectory::{Family as _, Spline};

/// Share of its range that every joint of a typical shape swings by.
const SWING: f64 = 0.25;

/// The search box of splines. That of the control points follows from the joints' ranges.
#[derive(Debug, Clone, PartialEq)]
pub struct SplineBox {
    /// Shortest and longest duration \[s\].
    pub duration: [f64; 2],
}

impl SplineBox {
    /// From a quarter to three times the shortest duration of a typical shape: every joint swings by a quarter of its
    /// range and back on its way.
    pub fn around(family: &Spline, task: &Task) -> Self {
        let mut coefficients = vec![0.0; family.dimension()];
        let ranges: Vec<[f64; 2]> = task.robot.joints().map(|joint| joint.range).collect();
        for &joint in family.leading() {
            let [lower, upper] = ranges[joint];
            let own = &mut coefficients[family.coefficients_of(joint)];
            let count = own.len();
            for (k, coefficient) in own.iter_mut().enumerate() {
                let tau = (k + 1) as f64 / (count + 1) as f64;
                let window = 64.0 * (tau * (1.0 - tau)).powi(3);
                *coefficient = SWING * (upper - lower) * window;
            }
        }
        let sampler = family.sampler(1);
        let mut samples = family.samples(&sampler);
        family.sample::<f64>(&sampler, &coefficients, &mut samples);
        let typical = family.peaks(&samples, &coefficients).shortest_duration(&task.limits);
        Self { duration: [typical / 4.0, 3.0 * typical] }
    }
}
