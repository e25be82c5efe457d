//! Parts of start and goal that replace those of a `[task]` table.

use std::ops::Range;

use nalgebra::UnitQuaternion;
use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::frame::attitude;
use super::joints::{self, Positions};
use super::tool_goal::ToolTable;
use crate::input::Finite;
use crate::robot::{PayloadTable, Robot};

/// A pair of start and goal; what it leaves out is the task's.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub struct PoseTable {
    /// Where the motion starts.
    #[serde(skip_serializing_if = "PostureParts::is_empty")]
    pub start: PostureParts,
    /// Where it is to end.
    #[serde(skip_serializing_if = "PostureParts::is_empty")]
    pub goal: PostureParts,
}

/// Joint positions or a place of the tool, base attitude, or both.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub struct PostureParts {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) joints_deg: Option<Spanned<Positions>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) joints: Option<Spanned<Positions>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) tool: Option<Spanned<ToolTable>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) base_zyx_deg: Option<[Finite; 3]>,
}

/// A stop on the way: a posture, and what the tool does there.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct ViaTable {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) joints_deg: Option<Spanned<Positions>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) joints: Option<Spanned<Positions>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) tool: Option<Spanned<ToolTable>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) base_zyx_deg: Option<[Finite; 3]>,
    /// What the tool catches; its centre of mass is at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) capture: Option<Spanned<PayloadTable>>,
    /// What it catches turns: its angular momentum about its centre of mass, inertial axes \[N·m·s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) angular_momentum: Option<Spanned<[Finite; 3]>>,
    /// Whether it lets go of what it has caught.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) release: Option<Spanned<bool>>,
}

impl ViaTable {
    /// Whether the tool catches something or lets go of it.
    pub(super) fn changes_load(&self) -> bool {
        self.capture.is_some() || self.releases().is_some()
    }

    /// Where the file says that the tool lets go of what it has caught, if it does.
    pub(super) fn releases(&self) -> Option<Range<usize>> {
        self.release.as_ref().filter(|release| *release.get_ref()).map(Spanned::span)
    }

    /// The posture.
    pub(super) fn parts(&self) -> PostureParts {
        let Self { joints_deg, joints, tool, base_zyx_deg, .. } = self.clone();
        PostureParts { joints_deg, joints, tool, base_zyx_deg }
    }
}

impl PostureParts {
    /// Positions of a robot's joints \[° or m\] alone.
    pub(super) fn of_joints(robot: &Robot, positions: Vec<f64>) -> Self {
        Self { base_zyx_deg: None, ..Self::new(robot, positions, [0.0; 3]) }
    }

    /// Both parts: positions of a robot's joints \[° or m\], all or those that follow none, and the base's yaw, pitch and roll \[°\].
    pub fn new(robot: &Robot, positions: Vec<f64>, base_zyx_deg: [f64; 3]) -> Self {
        let positions = Positions::Each(positions.into_iter().map(Finite).collect());
        let positions = Some(Spanned::new(0..0, positions));
        let base_zyx_deg = Some(base_zyx_deg.map(Finite));
        if robot.sliding_joint().is_none() {
            Self { joints_deg: positions, base_zyx_deg, ..Self::default() }
        } else {
            Self { joints: positions, base_zyx_deg, ..Self::default() }
        }
    }

    /// The base's attitude, if it is stated.
    pub(super) fn base(&self) -> Option<UnitQuaternion<f64>> {
        self.base_zyx_deg.map(attitude)
    }

    /// Where the joints' positions stand, if they stand anywhere.
    pub(super) fn joints_span(&self) -> Option<Range<usize>> {
        joints::span_of([&self.joints, &self.joints_deg])
    }

    fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}
