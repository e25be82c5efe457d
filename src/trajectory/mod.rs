//! Families of joint paths in normalised time `τ = t / t_f`: the paper's `θ = Δ₁ sin s + Δ₂` with a polynomial phase
//! `s` (eqs. 11–15, 24), and splines.
//!
//! The shape of a path is free of timing: rates scale with `1/t_f`, accelerations with `1/t_f²`,
//! jerks with `1/t_f³`.

mod basis;
mod bernstein;
mod bspline;
mod family;
mod grid;
mod path;
mod peaks;
mod points;
mod rows;
mod samples;
mod sine;
mod sine_family;
mod spline;
mod spline_peaks;
mod window;

pub use basis::Basis;
pub use bspline::Knots;
pub use family::{AtPhase, Curve, Family, Site};
pub use grid::Grid;
pub use path::{JointPath, Path};
pub use peaks::{Limits, LocalPeak, Peak, Peaks, duration_asked, excess, longest_asked, powers};
pub use points::{Extent, Interpolation, Jump, PointPath, Points};
pub use samples::{Sampler, Samples};
pub use sine::SinePolynomial;
pub use sine_family::SineCurve;
pub use spline::{Spline, SplineCurve, SplineNodes};
pub use spline_peaks::{SplineSampler, SplineSamples};
