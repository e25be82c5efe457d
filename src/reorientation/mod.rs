//! The reorientation task: a problem to search in several formulations, and a subject of experiments.

mod accuracy;
mod any;
#[cfg(feature = "harness")]
mod bases;
mod best_known;
mod boxes;
mod certify;
mod derivatives;
mod excursions;
#[cfg(feature = "harness")]
mod exhibits;
mod export;
mod family;
#[cfg(feature = "film")]
mod film;
mod fitness;
mod formulation;
#[cfg(feature = "harness")]
mod interface;
mod json;
#[cfg(feature = "harness")]
mod keys;
#[cfg(feature = "harness")]
mod kind;
#[cfg(feature = "harness")]
mod limited;
mod measure;
mod motion;
mod path;
mod planner;
#[cfg(feature = "harness")]
mod poses;
mod published;
mod reach;
mod replayed;
mod robust;
mod robustness;
mod sampling;
mod settings;
#[cfg(feature = "film")]
mod snapshot;
mod spline_box;
#[cfg(feature = "harness")]
mod subject;
#[cfg(feature = "harness")]
mod sweep;
#[cfg(feature = "harness")]
mod symbols;
mod terms;
mod timed;

pub use accuracy::Accuracy;
pub use any::{AnyReorientation, SearchedFamily};
pub use best_known::{BestKnown, fingerprint};
pub use boxes::Boxes;
pub use excursions::{Closest, Excursions, PathLimit, ToolEnd, Used};
#[cfg(feature = "harness")]
pub use exhibits::{FoundBy, motion_scene};
#[cfg(all(feature = "cli", feature = "harness"))]
pub(crate) use exhibits::{SAMPLES, best::best_motions, write_motion_figures};
#[cfg(feature = "harness")]
pub use export::write_motions;
pub use export::{ExportError, MotionFormat, Record, intervals, write_motion};
pub use family::{FamilyName, FamilySpec};
#[cfg(feature = "film")]
#[doc(hidden)]
pub use film::MotionFilm;
pub use fitness::{Assessment, Reorientation};
pub use formulation::{Formulated, Formulation};
pub use json::{AssessmentJson, ExcursionsJson, NOT_CHECKED, ShapeJson};
#[cfg(feature = "harness")]
pub use kind::ReorientationTask;
pub use measure::Workspace;
pub use motion::{JointMotion, Motion};
pub use path::{PathPeak, Watched};
pub use planner::{
    Asked, FamilyChoice, LegMotion, MissionJson, OtherFamily, PlanError, Planned, PlannedJson,
    PlannedLeg, PlannedMission, Planner, Remark, Search, Spent, Walls,
};
pub use published::{Published, Reading, ReplayFile};
pub use reach::{Block, Reach};
pub use replayed::{
    AngleUnit, Fault, FaultKind, GivenTrajectory, JointPeaks, PeakJson, PointReading, ReadPath,
    Replayed, ReplayedJson, TrajectoryError,
};
pub use robustness::{Robustness, RobustnessJson};
pub use sampling::{INTERVALS, MOST_SAMPLES, Sampling, TooManySamples};
pub use settings::{TaskFile, TaskProblem, TrajectoryTable};
pub use spline_box::SplineBox;
#[cfg(feature = "harness")]
pub use subject::TaskSubject;
