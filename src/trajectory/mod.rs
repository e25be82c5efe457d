//! Joint paths `θ = Δ₁ sin s + Δ₂` with a polynomial phase `s` (eqs. 11–15, 24), in normalised time
//! `τ = t / t_f`.
//!
//! The shape of a path is free of timing: rates scale with `1/t_f`, accelerations with `1/t_f²`,
//! jerks with `1/t_f³`.

mod basis;
mod family;
mod grid;
mod path;
mod peaks;
mod samples;
mod window;

pub use basis::Basis;
pub use family::Family;
pub(crate) use grid::Grid;
pub(crate) use path::AtPhase;
pub use path::{JointPath, Path};
pub use peaks::{Limits, LocalPeak, Peak, Peaks, duration_asked, excess, longest_asked};
pub(crate) use samples::ArchRoom;
pub use samples::{Sampler, Samples};
