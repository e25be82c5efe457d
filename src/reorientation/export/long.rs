//! The table with one row for each time and joint.

use super::record::{BASE, Quantity, Record};

/// How many quantities and numbers of the base come first. All that came later stands behind them, for those who count columns.
const FIRST: [usize; 2] = [4, 4];

/// The columns with numbers, behind `time`, `joint` and, where a joint slides, `unit`.
pub(in crate::reorientation) fn number_columns() -> Vec<&'static str> {
    let position = |quantity| match quantity {
        Quantity::Position => "angle",
        _ => quantity.name(),
    };
    ordered(Quantity::ALL.map(position), BASE.map(|(name, _)| name))
}

/// What stands for quantities and for the base in the columns' order.
fn ordered<T: Copy>(quantities: [T; Quantity::ALL.len()], base: [T; BASE.len()]) -> Vec<T> {
    let [(first, rest), (base, more)] = [quantities.split_at(FIRST[0]), base.split_at(FIRST[1])];
    [first, base, rest, more].concat()
}

impl Record<'_> {
    /// The numbers of a row.
    pub(in crate::reorientation) fn numbers(&self, time: usize, joint: usize) -> Vec<f64> {
        let joint = &self.joints[joint];
        ordered(Quantity::ALL.map(|quantity| joint.at(quantity, time)), self.base[time])
    }

    /// Time and joint of each row.
    pub(in crate::reorientation) fn rows(&self) -> impl Iterator<Item = (usize, usize)> {
        let joints = self.joints.len();
        (0..self.time.len()).flat_map(move |time| (0..joints).map(move |joint| (time, joint)))
    }
}
