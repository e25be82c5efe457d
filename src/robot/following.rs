//! Robots whose joints follow others.

use nalgebra::{DMatrix, DMatrixView};

use super::error::RobotError;
use super::follow::Follow;
use super::follow_table::is_factor;
use super::link::{Axis, Joint};
use super::tree::Robot;

impl Robot {
    /// The same where joints follow others, from one entry for each joint that moves. Ranges become those that followers and
    /// their leaders keep together.
    pub fn following(mut self, follows: Vec<Option<Follow>>) -> Result<Self, RobotError> {
        let names: Vec<String> = self.joints().map(|joint| joint.name.to_owned()).collect();
        let mut ranges: Vec<[f64; 2]> = self.joints().map(|joint| joint.range).collect();
        if follows.len() != names.len() {
            return Err(RobotError::Followers { found: follows.len(), expected: names.len() });
        }
        for (joint, follow) in follows.iter().enumerate() {
            let Some(follow) = follow else { continue };
            let leads = follows.get(follow.leader).is_some_and(Option::is_none);
            let is_sound = is_factor(follow.multiplier) && follow.offset.is_finite();
            if !(leads && is_sound) {
                return Err(RobotError::Follow(names[joint].clone()));
            }
            let ([lower, upper], allowed) = (ranges[follow.leader], follow.allowed(ranges[joint]));
            let common = [lower.max(allowed[0]), upper.min(allowed[1])];
            if common[0] >= common[1] {
                let [joint, leader] = [joint, follow.leader].map(|joint| names[joint].clone());
                return Err(RobotError::NoCommonRange { joint, leader });
            }
            ranges[follow.leader] = common;
        }
        for (joint, follow) in follows.iter().enumerate() {
            if let Some(follow) = follow {
                ranges[joint] = follow.reached(ranges[follow.leader]);
                // A tiny multiplier leaves nothing beside the offset.
                if ranges[joint][0] >= ranges[joint][1] {
                    return Err(RobotError::Follow(names[joint].clone()));
                }
            }
        }
        self.set_ranges(&ranges);
        self.follows = follows;
        Ok(self)
    }

    fn set_ranges(&mut self, ranges: &[[f64; 2]]) {
        let axes = self.links.iter_mut().filter_map(|link| match &mut link.joint {
            Joint::Revolute(axis) | Joint::Prismatic(axis) => Some(axis),
            Joint::Fixed => None,
        });
        for (Axis { range, .. }, own) in axes.zip(ranges) {
            *range = *own;
        }
    }

    /// Of every joint how it follows another one.
    pub fn follows(&self) -> &[Option<Follow>] {
        &self.follows
    }

    /// The joints that follow none, by their index.
    pub fn leading(&self) -> impl Iterator<Item = usize> {
        self.follows.iter().enumerate().filter(|(_, follow)| follow.is_none()).map(|(i, _)| i)
    }

    /// How many joints follow none.
    pub fn leading_count(&self) -> usize {
        self.leading().count()
    }

    /// Puts joints that follow others where they are then \[rad or m\].
    pub(crate) fn place_followers(&self, positions: &mut [f64]) {
        for (joint, follow) in self.follows.iter().enumerate() {
            if let Some(follow) = follow {
                positions[joint] = follow.position(positions[follow.leader]);
            }
        }
    }

    /// Derivatives by the joints that follow none, a column each, from those by all joints: what follows moves with its leader.
    pub(crate) fn by_leading(&self, by_joint: DMatrixView<'_, f64>) -> DMatrix<f64> {
        let leading: Vec<usize> = self.leading().collect();
        let mut by_leading = by_joint.select_columns(&leading);
        for (joint, follow) in self.follows.iter().enumerate() {
            let Some(follow) = follow else { continue };
            if let Some(place) = leading.iter().position(|leader| *leader == follow.leader) {
                let mut column = by_leading.column_mut(place);
                column += by_joint.column(joint) * follow.multiplier;
            }
        }
        by_leading
    }

    /// The same with rates, or what else does not know the offset.
    pub(crate) fn drive_followers(&self, rates: &mut [f64]) {
        for (joint, follow) in self.follows.iter().enumerate() {
            if let Some(follow) = follow {
                rates[joint] = follow.multiplier * rates[follow.leader];
            }
        }
    }
}
