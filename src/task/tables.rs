//! The tables of a `[task]`, as files state them and with what is filled in.

use std::num::NonZeroUsize;
use std::ops::Range;

use nalgebra::UnitQuaternion;
use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::cones::Cones;
use super::frame::attitude;
use super::joints::{self, JointValues, Limit, Positions};
use super::keep_out::KeepOut;
use super::path_limits::TurnFrom;
use super::pose::ViaTable;
use super::tool_goal::ToolTable;
use super::uncertainty::{RobustTable, UncertaintyTable};
use super::{PostureParts, shipped};
use crate::input::{Finite, Fraction, NonNegative, Positive, count, placeless};
use crate::robot::{BaseTable, Follows, Locked, PayloadTable, Robot, RobotFile};

/// What a file states.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct StatedTable {
    pub(super) robot: Option<Spanned<String>>,
    pub(super) locked: Locked,
    pub(super) follow: Follows,
    pub(super) base: Option<Spanned<BaseTable>>,
    pub(super) payload: Option<Spanned<PayloadTable>>,
    pub(super) start: PostureTable,
    pub(super) goal: PostureTable,
    pub(super) limits: LimitsTable,
    pub(super) weights: WeightsTable,
    pub(super) keep_out: KeepOut,
    pub(super) via: Vec<Spanned<ViaTable>>,
    pub(super) cycles: Option<Spanned<Cycles>>,
    pub(super) uncertainty: Option<UncertaintyTable>,
    pub(super) robust: Option<Spanned<RobustTable>>,
    pub(super) angular_momentum: Option<Spanned<[Finite; 3]>>,
}

/// How many swings a turn of the base is divided among.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Cycles(#[serde(deserialize_with = "count::<100, _, _>")] pub(super) NonZeroUsize);

#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct PostureTable {
    /// In degrees, for robots whose joints all turn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) joints_deg: Option<Spanned<Positions>>,
    /// In degrees or metres, by joint.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) joints: Option<Spanned<Positions>>,
    /// Where the tool is to be instead.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) tool: Option<Spanned<ToolTable>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) base_zyx_deg: Option<Spanned<[Finite; 3]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) tolerance_deg: Option<Spanned<Positive>>,
    /// How far the tool first goes straight back \[m\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) retreat_m: Option<Spanned<Positive>>,
    /// The base's angular velocity, base axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) base_rate_deg_s: Option<Spanned<[Finite; 3]>>,
    /// Whether a pose states the joints' positions or the tool's place, and the base's attitude.
    #[serde(skip)]
    pub(super) posed: [bool; 2],
}

/// Limits in degrees, for robots whose joints all turn, and by joint.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct LimitsTable {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) rate_deg_s: Option<Spanned<Limit>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) rate: Option<Spanned<Limit>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) acceleration_deg_s2: Option<Spanned<Limit>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) acceleration: Option<Spanned<Limit>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) jerk_deg_s3: Option<Spanned<Limit>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) jerk: Option<Spanned<Limit>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) base_turn_deg: Option<Spanned<Positive>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) base_turn_from: Option<TurnFrom>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) base_cone: Option<Spanned<Cones>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) base_rate_deg_s: Option<Spanned<Positive>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) tool_speed_m_s: Option<Spanned<Positive>>,
    /// In N·m of joints that turn, in N of those that slide.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) torque_n_m: Option<Spanned<Limit>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) clearance_m: Option<Spanned<NonNegative>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) least_duration_s: Option<Spanned<Positive>>,
}

/// Both keys of a limit, in degrees and by joint.
pub(super) const LIMIT_KEYS: [[&str; 2]; 3] =
    [["rate_deg_s", "rate"], ["acceleration_deg_s2", "acceleration"], ["jerk_deg_s3", "jerk"]];

#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct WeightsTable {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) base: Option<Spanned<Fraction>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) largest_turn: Option<Spanned<NonNegative>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) mean_turn: Option<Spanned<NonNegative>>,
}

/// What is filled in stands nowhere in the file.
pub(super) fn unplaced<T: Clone>(value: Option<&Spanned<T>>) -> Option<Spanned<T>> {
    value.map(placeless)
}

/// The value that the file states.
pub(super) fn placed<T: Clone>(value: Option<&Spanned<T>>) -> Option<Spanned<T>> {
    value.filter(|value| !value.span().is_empty()).cloned()
}

/// A file with a task and nothing else.
#[derive(Deserialize)]
struct TaskAlone {
    task: StatedTable,
}

impl StatedTable {
    /// The task that a robot comes with; nothing where it does not come with the program.
    pub(super) fn of(robot: &str) -> Self {
        // A test reads all of them.
        let file = shipped::task(robot).and_then(|text| toml::from_str::<TaskAlone>(text).ok());
        file.map(|file| file.task).unwrap_or_default()
    }

    /// Without the values of joints that are locked or follow others, of a robot that comes with the program.
    pub(super) fn freed(mut self, robot: &str, locked: &Locked, follow: &Follows) -> Self {
        if locked.is_empty() && follow.is_empty() {
            return self;
        }
        let is_free = |name: &str| !locked.has(name) && !follow.has(name);
        let file = Robot::embedded(robot).and_then(|file| RobotFile::read(&file).ok());
        let names = file.map(|file| file.joint_names()).unwrap_or_default();
        for posture in [&mut self.start, &mut self.goal] {
            for positions in [&mut posture.joints, &mut posture.joints_deg] {
                *positions = positions.take().map(|positions| freed(positions, &names, is_free));
            }
        }
        self.limits = self.limits.map(|_, pair| {
            pair.map(|limit| limit.cloned().map(|limit| freed(limit, &names, is_free)))
        });
        self
    }
}

fn freed<T: Copy>(
    values: Spanned<JointValues<T>>,
    names: &[String],
    is_free: impl Fn(&str) -> bool,
) -> Spanned<JointValues<T>> {
    Spanned::new(values.span(), values.into_inner().freed(names, is_free))
}

impl PostureTable {
    pub(super) fn filled(&mut self, default: &Self) {
        if self.is_without_joints() {
            self.joints = unplaced(default.joints.as_ref());
            self.joints_deg = unplaced(default.joints_deg.as_ref());
        }
        if self.base_zyx_deg.is_none() {
            self.base_zyx_deg = unplaced(default.base_zyx_deg.as_ref());
        }
    }

    pub(super) fn stated(&self) -> Self {
        let [joints_posed, base_posed] = self.posed;
        let joints = |value: Option<&Spanned<Positions>>| {
            if joints_posed { value.cloned() } else { placed(value) }
        };
        Self {
            joints_deg: joints(self.joints_deg.as_ref()),
            joints: joints(self.joints.as_ref()),
            tool: self.tool.clone(),
            base_zyx_deg: if base_posed {
                self.base_zyx_deg.clone()
            } else {
                placed(self.base_zyx_deg.as_ref())
            },
            tolerance_deg: self.tolerance_deg.clone(),
            retreat_m: self.retreat_m.clone(),
            base_rate_deg_s: self.base_rate_deg_s.clone(),
            posed: self.posed,
        }
    }

    /// The base's attitude.
    pub(super) fn base(&self) -> UnitQuaternion<f64> {
        let zyx = self.base_zyx_deg.as_ref().map_or([Finite(0.0); 3], |base| *base.get_ref());
        attitude(zyx)
    }

    /// Where the joints' positions stand, if they stand anywhere.
    pub(super) fn joints_span(&self) -> Option<Range<usize>> {
        joints::span_of([&self.joints, &self.joints_deg])
    }

    pub(super) fn is_without_joints(&self) -> bool {
        self.joints.is_none() && self.joints_deg.is_none() && self.tool.is_none()
    }

    /// Whether positions, and the attitude, are the file's own.
    pub(super) fn own(&self) -> [bool; 2] {
        let is_placed = |span: Option<Range<usize>>| span.is_some_and(|span| !span.is_empty());
        let joints = [&self.joints, &self.joints_deg];
        let [joints_posed, base_posed] = self.posed;
        [
            joints_posed
                || self.tool.is_some()
                || joints.iter().any(|joints| is_placed(joints.as_ref().map(Spanned::span))),
            base_posed || is_placed(self.base_zyx_deg.as_ref().map(Spanned::span)),
        ]
    }
}

/// A limit in degrees, and by joint.
pub(super) type Pair<'a> = [Option<&'a Spanned<Limit>>; 2];

impl LimitsTable {
    /// Those of rate, acceleration and jerk.
    pub(super) fn pairs(&self) -> [Pair<'_>; 3] {
        [
            [self.rate_deg_s.as_ref(), self.rate.as_ref()],
            [self.acceleration_deg_s2.as_ref(), self.acceleration.as_ref()],
            [self.jerk_deg_s3.as_ref(), self.jerk.as_ref()],
        ]
    }

    pub(super) fn map(&self, of: impl Fn(usize, Pair<'_>) -> [Option<Spanned<Limit>>; 2]) -> Self {
        let [a, b, c] = self.pairs();
        let ([rate_deg_s, rate], [acceleration_deg_s2, acceleration], [jerk_deg_s3, jerk]) =
            (of(0, a), of(1, b), of(2, c));
        Self {
            rate_deg_s,
            rate,
            acceleration_deg_s2,
            acceleration,
            jerk_deg_s3,
            jerk,
            ..self.clone()
        }
    }

    pub(super) fn filled(&self, default: &Self) -> Self {
        let defaults = default.pairs();
        self.map(|order, pair| {
            let is_missing = pair.iter().all(Option::is_none);
            if is_missing { defaults[order].map(unplaced) } else { pair.map(Option::<&_>::cloned) }
        })
    }

    pub(super) fn stated(&self) -> Self {
        self.map(|_, pair| pair.map(placed))
    }

    /// Whether a limit is the file's own.
    pub(super) fn own(&self) -> [bool; 3] {
        let is_placed = |limit: &Spanned<Limit>| !limit.span().is_empty();
        self.pairs().map(|pair| pair.into_iter().flatten().any(is_placed))
    }

    /// Where a limit on the way stands.
    pub(super) fn span_of(&self, key: &str) -> Range<usize> {
        let span = match key {
            "base_turn_deg" => self.base_turn_deg.as_ref().map(Spanned::span),
            "base_cone" => self.base_cone.as_ref().map(Spanned::span),
            "clearance_m" => self.clearance_m.as_ref().map(Spanned::span),
            _ => None,
        };
        span.unwrap_or_default()
    }

    pub(super) fn missing(&self) -> [bool; 3] {
        self.pairs().map(|pair| pair.iter().all(Option::is_none))
    }
}

impl PostureTable {
    /// The same posture but for some parts.
    pub(super) fn with(&self, parts: &PostureParts) -> Self {
        let base = parts.base_zyx_deg.map(|base| Spanned::new(0..0, base));
        let has_joints =
            parts.joints_deg.is_some() || parts.joints.is_some() || parts.tool.is_some();
        let own = self.clone();
        let (joints_deg, joints, tool) = if has_joints {
            (parts.joints_deg.clone(), parts.joints.clone(), parts.tool.clone())
        } else {
            (own.joints_deg, own.joints, own.tool)
        };
        Self {
            joints_deg,
            joints,
            tool,
            posed: [own.posed[0] || has_joints, own.posed[1] || base.is_some()],
            base_zyx_deg: base.or(own.base_zyx_deg),
            ..own
        }
    }
}
