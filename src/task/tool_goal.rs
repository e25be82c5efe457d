//! Goals of the tool: where it is to be instead of where the joints are.

use std::num::NonZeroUsize;

use nalgebra::{Unit, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::frame::{Frame, attitude};
use crate::input::{Finite, Positive, optional_count};
use crate::inverse_kinematics::{self, Miss, Orientation, Origin, ToolTarget};
use crate::robot::Robot;
use crate::straight::Straight;

/// The `tool` table of `[task.goal]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct ToolTable {
    #[serde(default)]
    frame: Frame,
    #[serde(skip_serializing_if = "Option::is_none")]
    position_m: Option<[Finite; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    zyx_deg: Option<[Finite; 3]>,
    /// Where one of the tool's axes is to point.
    #[serde(skip_serializing_if = "Option::is_none")]
    axis: Option<[Finite; 3]>,
    /// Which one, in the tool's axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    tool_axis: Option<[Finite; 3]>,
    /// Which of the solutions the motion ends in, the nearest being the first.
    #[serde(
        default,
        deserialize_with = "optional_count::<1, 1_000, _, _>",
        skip_serializing_if = "Option::is_none"
    )]
    branch: Option<NonZeroUsize>,
    /// How far the tool goes straight along its axis to get there, and back from there \[m\].
    #[serde(skip_serializing_if = "Option::is_none")]
    approach_m: Option<Positive>,
    #[serde(skip_serializing_if = "Option::is_none")]
    retreat_m: Option<Positive>,
    /// How the target moves while the robot does, inertial axes; position and orientation are those at the start.
    #[serde(skip_serializing_if = "Option::is_none")]
    velocity_m_s: Option<[Finite; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    angular_velocity_deg_s: Option<[Finite; 3]>,
    /// When it is met \[s\].
    #[serde(skip)]
    met_at: Option<f64>,
}

/// Where the tool is to be at the end, and how the joints bring it there.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolGoal {
    /// The axes that the task states it in.
    pub frame: Frame,
    /// In base axes, with the base at its goal.
    pub target: ToolTarget,
    /// The joints' positions that the task may end with \[rad or m\], nearest first.
    pub branches: Vec<Vec<f64>>,
}

impl ToolTable {
    /// The target in base axes once the base is at its goal.
    fn target(
        &self,
        inertial: Vector3<f64>,
        goal: &UnitQuaternion<f64>,
    ) -> Result<ToolTarget, String> {
        let vector = |values: [Finite; 3]| Vector3::from(values.map(|value| value.0));
        if self.moves() && self.frame == Frame::Base {
            return Err(
                "found a target in base axes that moves, expected one in inertial axes".to_owned()
            );
        }
        if self.moves() && self.met_at.is_none() {
            return Err(
                "found a target that moves, expected one only as the goal of a task of one motion"
                    .to_owned(),
            );
        }
        if self.moves() && (self.approach_m.is_some() || self.retreat_m.is_some()) {
            return Err(
                "found a straight line to a target that moves, expected one that stays".to_owned()
            );
        }
        let [shift, turn] = [self.velocity_m_s, self.angular_velocity_deg_s]
            .map(|rate| rate.map_or(Vector3::zeros(), vector) * self.met_at.unwrap_or_default());
        let turn = UnitQuaternion::from_scaled_axis(turn.map(f64::to_radians));
        // Scaled first, as squares of large numbers are infinite.
        let unit = |values: [Finite; 3], key: &str| {
            let values = vector(values);
            Unit::try_new(values / values.amax(), 1e-9)
                .ok_or_else(|| format!("`{key}` is zero, expected a direction"))
        };
        // Turns the axes of the table into base axes.
        let (into_base, origin) = match self.frame {
            Frame::Inertial => (goal.inverse(), Origin::System),
            Frame::Base => (UnitQuaternion::identity(), Origin::Base),
        };
        let offset = match self.frame {
            Frame::Inertial => inertial,
            Frame::Base => Vector3::zeros(),
        };
        let orientation = match (self.zyx_deg, self.axis, self.tool_axis) {
            (Some(_), Some(_), _) => {
                return Err("found both `zyx_deg` and `axis`, expected one of them".to_owned());
            }
            (None, None, Some(_)) if self.approach_m.is_none() && self.retreat_m.is_none() => {
                return Err("found `tool_axis` without `axis`, where it is to point".to_owned());
            }
            (None, None, _) => Orientation::Any,
            (Some(zyx), None, _) => {
                Orientation::Full((into_base * turn * attitude(zyx)).to_rotation_matrix())
            }
            (None, Some(axis), tool) => Orientation::Axis {
                tool: tool.map_or(Ok(Vector3::z_axis()), |tool| unit(tool, "tool_axis"))?,
                direction: into_base * (turn * unit(axis, "axis")?),
            },
        };
        if self.position_m.is_none() && orientation == Orientation::Any {
            return Err(
                "found neither `position_m` nor `zyx_deg` nor `axis`, expected one of them"
                    .to_owned(),
            );
        }
        let at = |position| into_base * (vector(position) + shift + offset);
        let position = self.position_m.map(at);
        Ok(ToolTarget { position, origin, orientation })
    }

    /// The goal where the base is to have an attitude then, or what is wrong; `inertial` is the origin of inertial axes from the
    /// system's centre of mass \[m\], and of the joints' positions the first are nearest to `near`.
    pub(super) fn build(
        &self,
        robot: &Robot,
        inertial: Vector3<f64>,
        base: &UnitQuaternion<f64>,
        near: &[f64],
        efforts: &[f64],
    ) -> Result<ToolGoal, String> {
        let target = self.target(inertial, base)?;
        let branches = inverse_kinematics::solve(robot, &target, near, efforts);
        let branches = branches.map_err(|miss| unreachable(&target, miss))?;
        Ok(ToolGoal { frame: self.frame, target, branches })
    }

    /// How the tool comes straight to its goal, against the direction of its way, and how it leaves it.
    pub(super) fn straights(&self) -> [Option<Straight>; 2] {
        let axis = self.tool_axis.map_or([0.0, 0.0, 1.0], |axis| axis.map(|value| value.0));
        let keeps_orientation = self.zyx_deg.is_some() || self.axis.is_some();
        [self.approach_m, self.retreat_m].map(|distance| {
            let direction = -Vector3::from(axis);
            distance.map(|distance| Straight { direction, distance: distance.0, keeps_orientation })
        })
    }

    /// Whether the target moves.
    pub(super) fn moves(&self) -> bool {
        let rates = [self.velocity_m_s, self.angular_velocity_deg_s].into_iter().flatten();
        rates.flatten().any(|rate| rate.0 != 0.0)
    }

    /// The same, met after so many seconds.
    pub(super) fn met_at(&self, seconds: f64) -> Self {
        Self { met_at: Some(seconds), ..self.clone() }
    }

    /// The branch that is asked for, counted from one.
    pub(super) fn branch(&self) -> Option<usize> {
        self.branch.map(NonZeroUsize::get)
    }
}

/// Positions that differ by no more \[rad or m\] are the same configuration.
const SAME: f64 = 1e-3;

impl ToolGoal {
    /// Which of the branches joints \[rad or m\] are at, counted from one.
    pub(crate) fn branch_at(&self, joints: &[f64]) -> Option<usize> {
        let is_there =
            |branch: &Vec<f64>| branch.iter().zip(joints).all(|(own, at)| (own - at).abs() < SAME);
        self.branches.iter().position(is_there).map(|place| place + 1)
    }

    /// By how much the tool misses its goal where joints \[rad or m\] and base end so.
    pub(crate) fn miss(
        &self,
        robot: &Robot,
        goal: &UnitQuaternion<f64>,
        joints: &[f64],
        base: &UnitQuaternion<f64>,
    ) -> Miss {
        // What stands still in inertial axes is elsewhere in base axes when the base is.
        let turn = match self.frame {
            Frame::Inertial => base.inverse() * goal,
            Frame::Base => UnitQuaternion::identity(),
        };
        inverse_kinematics::miss(robot, &self.target.turned(&turn), joints)
    }
}

fn unreachable(target: &ToolTarget, Miss { position, angle }: Miss) -> String {
    let mut misses = Vec::new();
    if target.position.is_some() {
        misses.push(format!("{position:.4} m"));
    }
    if target.orientation != Orientation::Any {
        misses.push(format!("{:.3}°", angle.to_degrees()));
    }
    format!(
        "the tool cannot be brought there within the joints' ranges: the nearest configuration that was found misses by {}",
        misses.join(" and ")
    )
}
