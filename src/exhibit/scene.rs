//! A mechanism over time as a page shows it in three dimensions.

use serde::Serialize;
use serde_json::Value;

/// What a mechanism does over the best run of an instance, in the form that the page's view reads.
///
/// The view (`report/script/view.js`) shows a floating base with arms: `label`, `optimiser`, `seed`, `cost`,
/// `duration`, `largest_turn`, `largest_turn_at`, `satellite`, `joints`, `frames` and `goal`, and where the task asks for them
/// `limited`, `keep_outs` and `closest`; lengths in metres, times in seconds, angles in degrees.
#[derive(Debug, Clone, Serialize)]
#[serde(transparent)]
pub struct Scene(Value);

impl Scene {
    /// From data that the view can read; none where they have no JSON form.
    pub fn new(data: &impl Serialize) -> Option<Self> {
        serde_json::to_value(data).ok().map(Self)
    }
}
