//! Parts of start and goal that replace those of a `[task]` table.

use serde::{Deserialize, Serialize};
use toml::Spanned;

use crate::input::Finite;

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

/// Joint angles, base attitude, or both.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub struct PostureParts {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) joints_deg: Option<Spanned<Vec<Finite>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) base_zyx_deg: Option<[Finite; 3]>,
}

impl PostureParts {
    /// Both parts: joint angles, and the base's yaw, pitch and roll \[°\].
    pub fn new(joints_deg: Vec<f64>, base_zyx_deg: [f64; 3]) -> Self {
        let joints = joints_deg.into_iter().map(Finite).collect();
        Self {
            joints_deg: Some(Spanned::new(0..0, joints)),
            base_zyx_deg: Some(base_zyx_deg.map(Finite)),
        }
    }

    fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}
