//! Planning the motion of free-floating space robots, and a fair race for those who plan it.
//!
//! A robot arm on a satellite turns the satellite as it moves. With zero momentum the base moves
//! only as the joints move it: the system is *driftless*,
//!
//! ```text
//!     ω_b = W(θ) θ̇              base angular rate, base axes          (eqs. 5–7)
//!     Q̇   = ½ Q ⊗ (0, ω_b)      base attitude, base → inertial axes   (eq. 9)
//! ```
//!
//! and not integrable, so the base can be brought to any attitude by moving the joints alone. Each
//! joint follows `θ = Δ₁ sin s(τ) + Δ₂`, which never leaves its range, along a polynomial phase that
//! meets both ends at rest (eqs. 11–15, 24),
//!
//! ```text
//!     s(τ) = s_0 + (s_f − s_0) (10τ³ − 15τ⁴ + 6τ⁵) + 64 τ³(1−τ)³ Σ_k c_k P_k(2τ−1),   τ = t / t_f
//! ```
//!
//! and the free coefficients `c` and the duration `t_f` are chosen to minimise (eqs. 25–28, 33)
//!
//! ```text
//!     J = K_b ‖δq_b‖ / k_q + K_t t_f + (F_v + F_a + F_j) / 0.01
//! ```
//!
//! the error of the base's final attitude, the time, and the excess over the limits on rate,
//! acceleration and jerk. Equation numbers are those of Xiao, Zhou, Zhou, Si and Zhou (2023),
//! "Non-Holonomic Path Planning for Space Robots Based on Jerk Constraints", Int. J. Astronaut.
//! Aeronautical Eng. 8:065; what is misprinted there is said where it matters.
//!
//! # Plan a motion
//!
//! A [`Problem`](search::Problem) is a box and a cost; an [`Optimiser`](optimiser::Optimiser) asks an
//! [`Oracle`](search::Oracle) for costs, which counts them and keeps the best.
//!
//! ```
//! use std::{num::NonZeroUsize, sync::Arc};
//!
//! use driftless::optimiser::{Optimiser as _, Scp};
//! use driftless::reorientation::{Formulated, Formulation, TaskFile};
//! use driftless::search::{Oracle, Rng, Watch};
//!
//! let document = TaskFile::paper(); // `Document::read` takes a file instead
//! let (task, boxes) = TaskFile::read(&document)?.build(&document)?;
//! let problem = Formulated::new(Formulation::TimeFree, Arc::new(task), &boxes)?;
//! let watch = Watch::default();
//! let mut oracle = Oracle::new(&problem, 20_000, &watch);
//! let scp = Scp { starts: NonZeroUsize::new(10), ..Scp::default() };
//! scp.minimise(&mut oracle, &mut Rng::new(1))?;
//! let best = oracle.best().expect("a motion");
//! let (_, motion) = problem.certify(&best.x);
//! assert!(motion.duration < 8.0 && motion.residual().to_degrees() < 1e-4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![cfg_attr(feature = "harness", doc = include_str!("harness.md"))]
//!
//! # Features
//!
//! `harness` (default): experiments, stored results, tables and figures. `cli` (default): the command `driftless`.
//! `film`, a part of `harness`: films of motions.
//! Without all: the planner, the optimisers and the test functions.

#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[cfg(feature = "harness")]
pub mod exhibit;
#[cfg(feature = "harness")]
pub mod experiment;
pub mod functions;
#[cfg(feature = "harness")]
pub mod import;
pub mod input;
pub mod optimiser;
#[cfg(feature = "harness")]
pub mod process;
pub mod reorientation;
#[cfg(feature = "harness")]
pub mod report;
pub mod robot;
pub mod search;
pub mod task;

#[cfg(feature = "harness")]
mod registry;
#[cfg(feature = "harness")]
pub use registry::registry;

// What the command, the tests and the benchmarks of this repository use beside: it may change in any version.
#[cfg(feature = "harness")]
#[doc(hidden)]
pub mod analysis;
#[doc(hidden)]
pub mod attitude;
#[doc(hidden)]
pub mod clearance;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
#[doc(hidden)]
pub mod dynamics;
#[cfg(feature = "harness")]
#[doc(hidden)]
pub mod export;
#[cfg(feature = "film")]
#[doc(hidden)]
pub mod film;
#[doc(hidden)]
pub mod inverse_kinematics;
#[doc(hidden)]
pub mod kinematics;
#[doc(hidden)]
pub mod lanes;
#[doc(hidden)]
pub mod momentum;
#[doc(hidden)]
pub mod posture;
#[doc(hidden)]
pub mod scalar;
#[doc(hidden)]
pub mod so3;
#[doc(hidden)]
pub mod straight;
#[doc(hidden)]
pub mod trajectory;
#[doc(hidden)]
pub mod vec3;

pub use output::FileError;

mod digest;
#[cfg(feature = "harness")]
mod figure;
mod output;
#[cfg(feature = "harness")]
mod plot;
mod words;

/// Jacobians of a free-floating robot (eqs. 1–7).
pub mod jacobian {
    pub use crate::kinematics::{Jacobian, base_jacobian, manipulator_jacobian};
    pub use crate::momentum::{base_map, generalised_jacobian};
}
