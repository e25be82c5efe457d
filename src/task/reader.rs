//! Reading what a task states joint by joint.

use toml::Spanned;

use super::joints::{self, Key, Positions};
use super::tables::{LIMIT_KEYS, Pair, PostureTable};
use super::uncertainty::{Shares, Uncertainty, UncertaintyTable};
use super::{Posture, PostureParts};
use crate::input::{Document, Finite, InputError, Positive};
use crate::robot::{Follow, Robot};

/// How far a joint that follows may be stated from where it is \[° or m\].
const SAME_POSITION: f64 = 1e-6;

/// Reads what is listed joint by joint.
pub(super) struct Reader<'a> {
    pub(super) document: &'a Document,
    pub(super) robot: &'a Robot,
}

impl Reader<'_> {
    pub(super) fn posture(&self, table: &PostureTable) -> Result<Posture, InputError> {
        let joints = self.stated_joints([table.joints_deg.as_ref(), table.joints.as_ref()])?;
        Ok(Posture { joints, base: table.base() })
    }

    /// The joints' positions of a part of a posture \[rad or m\].
    pub(super) fn joints(&self, parts: &PostureParts) -> Result<Vec<f64>, InputError> {
        self.stated_joints([parts.joints_deg.as_ref(), parts.joints.as_ref()])
    }

    fn stated_joints(
        &self,
        pair: [Option<&Spanned<Positions>>; 2],
    ) -> Result<Vec<f64>, InputError> {
        let (values, key) = self.one_of(pair, ["joints_deg", "joints"])?;
        let joints = joints::read(values, |value: Finite| value.0, key, self.robot, self.document)?;
        self.positions(&joints)
            .map_err(|(message, help)| self.document.error_at(values.span(), message, help))
    }

    /// Positions \[rad or m\] from those that are stated; or what is wrong, and some help.
    fn positions(&self, stated: &[Option<f64>]) -> Result<Vec<f64>, (String, Option<String>)> {
        let mut positions = vec![0.0; stated.len()];
        for ((joint, stated), position) in self.robot.joints().zip(stated).zip(&mut positions) {
            if let (None, Some(stated)) = (joint.follows, stated) {
                *position = joint.position(*stated).map_err(|message| (message, None))?;
            }
        }
        self.robot.place_followers(&mut positions);
        for ((joint, stated), position) in self.robot.joints().zip(stated).zip(&positions) {
            let (Some(follow), Some(stated)) = (joint.follows, stated) else { continue };
            let at = joint.kind.to_file_units(*position);
            if (stated - at).abs() > SAME_POSITION {
                let leader = self.robot.joints().nth(follow.leader).map_or("", |joint| joint.name);
                let [stated, at] = [*stated, at].map(|at| joint.kind.told(at));
                let message = format!(
                    "found {stated} for joint `{}`, which follows joint `{leader}` to {at}",
                    joint.name
                );
                return Err((message, Some(format!("leave `{}` out", joint.name))));
            }
        }
        Ok(positions)
    }

    /// The limits on rate, acceleration or jerk. The rates are the robot's where the file has none; what a sweep states comes
    /// later.
    pub(super) fn limit(&self, pair: Pair<'_>, order: usize) -> Result<Vec<f64>, InputError> {
        if pair.iter().all(Option::is_none) {
            let rates: Vec<_> = self.robot.joints().map(|joint| joint.rate).collect();
            return Ok(self.with_followers(&rates));
        }
        self.positive(pair, LIMIT_KEYS[order])
    }

    /// What is not known exactly.
    pub(super) fn uncertainty(&self, table: &UncertaintyTable) -> Result<Uncertainty, InputError> {
        let pair = [table.joint_deg.as_ref(), table.joint.as_ref()];
        let joints = if pair.iter().all(Option::is_none) {
            vec![0.0; self.robot.joint_count()]
        } else {
            self.positive(pair, ["joint_deg", "joint"])?
        };
        Ok(Uncertainty {
            masses: Shares::listed(&table.mass, self.robot, self.document)?,
            inertias: Shares::listed(&table.inertia, self.robot, self.document)?,
            mount: table.mount_m.0,
            joints,
            samples: table.samples.get(),
            seed: table.seed,
        })
    }

    /// Positive numbers of all joints, in SI units.
    pub(super) fn positive(
        &self,
        pair: Pair<'_>,
        keys: [&'static str; 2],
    ) -> Result<Vec<f64>, InputError> {
        let (values, key) = self.one_of(pair, keys)?;
        let stated =
            joints::read(values, |value: Positive| value.0, key, self.robot, self.document)?;
        let joints = self.robot.joints().zip(stated);
        let in_si = joints.map(|(joint, value)| Some(joint.kind.from_file_units(value?)));
        Ok(self.with_followers(&in_si.collect::<Vec<_>>()))
    }

    /// Limits of all joints. Where one that follows another one has none, it is to keep up with that one.
    fn with_followers(&self, stated: &[Option<f64>]) -> Vec<f64> {
        let leading: Vec<f64> = stated.iter().map(|limit| limit.unwrap_or(1.0)).collect();
        let joints = self.robot.joints().zip(stated).zip(&leading);
        joints
            .map(|((joint, stated), own)| match (stated, joint.follows) {
                (None, Some(Follow { leader, multiplier, .. })) => {
                    multiplier.abs() * leading[leader]
                }
                _ => *own,
            })
            .collect()
    }

    /// What stands under one of two keys, the first of which is in degrees.
    fn one_of<'b, T>(
        &self,
        [in_degrees, by_joint]: [Option<&'b Spanned<T>>; 2],
        names: [&'static str; 2],
    ) -> Result<(&'b Spanned<T>, Key), InputError> {
        let key = |in_degrees: bool| Key { name: names[usize::from(!in_degrees)], in_degrees };
        match (in_degrees, by_joint) {
            (Some(values), None) => Ok((values, key(true))),
            (None, Some(values)) => Ok((values, key(false))),
            (Some(_), Some(second)) => {
                let message =
                    format!("found both `{}` and `{}`, expected one of them", names[0], names[1]);
                Err(self.document.error_at(second.span(), message, None))
            }
            (None, None) => {
                let message = format!("missing field `{}`", names[0]);
                Err(self.document.error_at(0..0, message, None))
            }
        }
    }
}
