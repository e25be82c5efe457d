//! Which joints of a robot follow others, from all that is said of it.

use std::fmt;
use std::ops::Range;

use toml::Spanned;

use super::error::RobotError;
use super::follow::Follow;
use super::follow_table::{FollowTable, Follows};
use super::link::JointKind;
use super::outfit::Locked;
use super::tree::{MovingJoint, Robot};
use crate::input::{Document, InputError, nearest};

/// What a file says of one joint that follows.
pub(super) struct Stated<'a> {
    pub(super) joint: &'a str,
    pub(super) table: &'a FollowTable,
    pub(super) document: &'a Document,
    pub(super) place: Range<usize>,
    /// Whether a joint that is locked as well is locked and no more.
    pub(super) yields: bool,
}

/// What comes of all that is stated, chains resolved.
pub(super) struct Resolved<'a> {
    /// Joints that follow one that is locked, and where they are \[° or m\].
    locked: Vec<(&'a Stated<'a>, f64)>,
    /// Joints that follow one that moves, and its name.
    following: Vec<(&'a Stated<'a>, String, Follow)>,
}

impl<'a> Stated<'a> {
    /// All that a document says of joints that follow. What is locked elsewhere follows no longer.
    pub(super) fn all(
        follows: &'a Follows,
        document: &'a Document,
        elsewhere: Option<&'a Locked>,
    ) -> impl Iterator<Item = Self> {
        follows.iter().map(move |(name, table)| Self {
            joint: name.get_ref(),
            table,
            document,
            place: name.span(),
            yields: elsewhere.is_some_and(|locked| locked.has(name.get_ref())),
        })
    }

    fn error(&self, message: impl fmt::Display, help: Option<String>) -> InputError {
        self.document.error_at(self.place.clone(), message, help)
    }

    fn find(&self, called: &str, joints: &[MovingJoint<'_>]) -> Result<usize, InputError> {
        joints.iter().position(|joint| joint.name == called).ok_or_else(|| {
            let what = if called == self.joint {
                String::new()
            } else {
                format!("joint `{}` follows joint `{called}`: ", self.joint)
            };
            let message = format!("{what}the robot has no joint `{called}` that moves");
            let names = joints.iter().map(|joint| joint.name);
            let help = nearest(called, names).map(|name| format!("did you mean `{name}`?"));
            let lock =
                || format!("a joint that is locked follows none: `locked = [{:?}]`", self.joint);
            let help = help.or_else(|| (called != self.joint).then(lock));
            self.error(message, help)
        })
    }

    fn offset(&self, kind: JointKind) -> Result<f64, InputError> {
        match self.table.offset {
            None => Ok(0.0),
            Some((given, offset)) if given == kind => Ok(kind.from_file_units(offset)),
            Some(_) => {
                let (moves, key) = match kind {
                    JointKind::Revolute => ("turns", "offset_deg"),
                    JointKind::Prismatic => ("slides", "offset_m"),
                };
                let message = format!("joint `{}` {moves}, so its offset is `{key}`", self.joint);
                Err(self.error(message, None))
            }
        }
    }
}

/// Resolves what is stated, of which what comes later counts. `locked` says where a joint is locked \[rad or m\].
pub(super) fn resolve<'a>(
    stated: &'a [Stated<'a>],
    robot: &Robot,
    locked: impl Fn(&MovingJoint<'_>) -> Result<Option<f64>, InputError>,
) -> Result<Resolved<'a>, InputError> {
    let joints: Vec<MovingJoint<'_>> = robot.joints().collect();
    let mut leads: Vec<Option<(Follow, &Stated<'_>)>> = vec![None; joints.len()];
    for own in stated {
        let joint = own.find(own.joint, &joints)?;
        if locked(&joints[joint])?.is_some() {
            if own.yields {
                continue;
            }
            let message = format!("joint `{}` is locked and cannot follow another one", own.joint);
            return Err(own.error(message, None));
        }
        let leader = own.find(&own.table.joint, &joints)?;
        let offset = own.offset(joints[joint].kind)?;
        leads[joint] = Some((Follow { leader, multiplier: own.table.multiplier, offset }, own));
    }
    let mut resolved = Resolved { locked: Vec::new(), following: Vec::new() };
    for (joint, lead) in leads.iter().enumerate() {
        let Some((mut follow, own)) = *lead else { continue };
        for _ in 0..joints.len() {
            if follow.leader == joint {
                let by_way = if own.table.joint == own.joint {
                    String::new()
                } else {
                    format!(" by way of joint `{}`", own.table.joint)
                };
                return Err(
                    own.error(format!("joint `{}` follows itself{by_way}", own.joint), None)
                );
            }
            let Some((next, _)) = &leads[follow.leader] else { break };
            follow = follow.through(next);
        }
        let leader = &joints[follow.leader];
        match locked(leader)? {
            Some(place) => {
                let at = joints[joint].kind.to_file_units(follow.position(place));
                joints[joint].position(at).map_err(|message| {
                    let leader = leader.name;
                    let message = format!(
                        "joint `{}` follows joint `{leader}`, which is locked: {message}",
                        own.joint
                    );
                    own.error(message, None)
                })?;
                resolved.locked.push((own, at));
            }
            None => resolved.following.push((own, leader.name.to_owned(), follow)),
        }
    }
    Ok(resolved)
}

impl Resolved<'_> {
    /// The robot with the joints fixed that follow one which is locked.
    pub(super) fn lock(&self, mut robot: Robot) -> Result<Robot, InputError> {
        for (own, position) in &self.locked {
            let name = Spanned::new(own.place.clone(), own.joint.to_owned());
            robot = Locked::at(name, *position).apply(robot, own.document)?;
        }
        Ok(robot)
    }

    /// The robot whose joints follow others. Nothing may be rebuilt of it.
    pub(super) fn follow(&self, robot: Robot) -> Result<Robot, InputError> {
        let Some((first, ..)) = self.following.first() else { return Ok(robot) };
        let mut follows = vec![None; robot.joint_count()];
        let place = |name: &str| robot.joints().position(|joint| joint.name == name);
        for (own, leader, follow) in &self.following {
            if let (Some(joint), Some(leader)) = (place(own.joint), place(leader)) {
                follows[joint] = Some(Follow { leader, ..*follow });
            }
        }
        robot.following(follows).map_err(|error| {
            let about = match &error {
                RobotError::Follow(joint) | RobotError::NoCommonRange { joint, .. } => joint,
                _ => first.joint,
            };
            let own = self.following.iter().find(|(own, ..)| own.joint == about);
            let help = "what is locked need not follow, and what follows it is locked with it";
            own.map_or(first, |(own, ..)| own).error(&error, Some(help.to_owned()))
        })
    }
}
