//! A motion, sampled.

use polars::prelude::*;

use crate::exhibit::Table;
use crate::reorientation::export::{Record, number_columns};

/// One row per time and joint: time \[s\], joint, where joints slide the unit of its position, and the numbers that exports
/// have.
pub(in crate::reorientation) fn motion_table(record: &Record<'_>) -> PolarsResult<Table> {
    let own = |joint: usize| &record.joints[joint].motion;
    let times: Vec<f64> = record.rows().map(|(time, _)| record.time[time]).collect();
    let joints: Vec<&str> = record.rows().map(|(_, joint)| &*own(joint).name).collect();
    let mut columns = vec![Column::new("time".into(), times), Column::new("joint".into(), joints)];
    if record.slides() {
        let units: Vec<&str> = record.rows().map(|(_, joint)| own(joint).kind.si_unit()).collect();
        columns.push(Column::new("unit".into(), units));
    }
    let names = number_columns();
    let mut numbers = vec![Vec::with_capacity(columns[0].len()); names.len()];
    for (time, joint) in record.rows() {
        for (column, number) in numbers.iter_mut().zip(record.numbers(time, joint)) {
            column.push(number);
        }
    }
    columns.extend(names.iter().zip(numbers).map(|(name, own)| Column::new((*name).into(), own)));
    let caption = "The best motion: joint positions and derivatives in seconds and radians, or metres where a joint slides, torques in N m, or \
        forces in N, the quaternion that turns base axes into inertial axes, the base's ZYX Euler angles, where its centre of mass is in \
        inertial axes, from where it is at the start, and its angular velocity in base axes.";
    Ok(Table::curve("motion", caption, DataFrame::new(record.rows().count(), columns)?))
}
