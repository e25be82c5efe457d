//! A motion, sampled.

use polars::prelude::*;

use crate::exhibit::Table;
use crate::reorientation::motion::Motion;

/// One row per time and joint: time \[s\], joint, angle \[rad\] and its derivatives \[rad, s\], and the base's attitude as a
/// quaternion that turns base axes into inertial axes. Where joints slide, a column says in which unit each row's position is.
pub(in crate::reorientation) fn motion_table(motion: &Motion) -> PolarsResult<Table> {
    let places = || {
        let joints = motion.joints.len();
        (0..motion.time.len()).flat_map(move |i| (0..joints).map(move |j| (i, j)))
    };
    let derivative = |k: usize| -> Vec<f64> {
        places().map(|(i, j)| motion.joints[j].derivatives[i][k]).collect()
    };
    let base = |k: usize| -> Vec<f64> {
        // nalgebra keeps x, y, z, w.
        places().map(|(i, _)| motion.base[i].coords[k]).collect()
    };
    let mut frame = df!(
        "time" => places().map(|(i, _)| motion.time[i]).collect::<Vec<_>>(),
        "joint" => places().map(|(_, j)| motion.joints[j].name.as_str()).collect::<Vec<_>>(),
        "angle" => derivative(0),
        "rate" => derivative(1),
        "acceleration" => derivative(2),
        "jerk" => derivative(3),
        "base_w" => base(3),
        "base_x" => base(0),
        "base_y" => base(1),
        "base_z" => base(2),
    )?;
    if motion.slides() {
        let units: Vec<&str> = places().map(|(_, j)| motion.joints[j].kind.si_unit()).collect();
        frame.insert_column(2, Column::new("unit".into(), units))?;
    }
    let caption = "The best motion: joint positions and derivatives in seconds and radians, or metres where a joint slides, and the \
        quaternion that turns base axes into inertial axes.";
    Ok(Table::curve("motion", caption, frame))
}
