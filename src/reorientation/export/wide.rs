//! The table with one row for each time.

use super::record::{BASE, Quantity, Record};
use crate::robot::JointKind;

/// The columns' names, with units, of a motion of these joints: the time, each quantity of all joints, the base.
pub(in crate::reorientation) fn header<'a>(
    joints: impl Iterator<Item = (&'a str, JointKind)>,
) -> Vec<String> {
    let joints: Vec<_> = joints.collect();
    let mut names = vec!["time [s]".to_owned()];
    for quantity in Quantity::ALL {
        let name = |(joint, kind): &(&str, JointKind)| {
            format!("{joint}_{} [{}]", quantity.name(), quantity.unit(*kind))
        };
        names.extend(joints.iter().map(name));
    }
    names.extend(BASE.map(|(name, unit)| match unit {
        "" => name.to_owned(),
        unit => format!("{name} [{unit}]"),
    }));
    names
}

impl Record<'_> {
    /// The numbers of a row, in the columns' order.
    pub(super) fn wide_row(&self, time: usize) -> impl Iterator<Item = f64> {
        let joints = Quantity::ALL.into_iter().flat_map(move |quantity| {
            self.joints.iter().map(move |joint| joint.at(quantity, time))
        });
        std::iter::once(self.time[time]).chain(joints).chain(self.base[time])
    }
}
