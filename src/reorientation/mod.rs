//! The reorientation task as a problem to search: its fitness in several formulations.

mod best_known;
mod derivatives;
mod fitness;
mod formulation;
mod measure;
mod motion;
mod published;
mod settings;

pub use best_known::{BestKnown, fingerprint};
pub use fitness::{Accuracy, Assessment, Reorientation};
pub use formulation::{Formulated, Formulation};
pub use measure::Workspace;
pub use motion::{JointMotion, Motion};
pub use published::{Published, Reading, ReplayFile};
#[cfg(feature = "harness")]
pub(crate) use settings::DEFAULTS;
pub use settings::{Boxes, TaskFile, TrajectoryTable};
