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
//! # Example
//!
//! ```
//! use driftless::reorientation::{Accuracy, TaskFile};
//!
//! let document = TaskFile::paper();
//! let (problem, _) = TaskFile::read(&document)?.build(&document)?;
//! let straight = vec![0.0; problem.family().dimension()];
//! let motion = problem.with_accuracy(Accuracy::FINE).assess(&straight, None);
//! assert!(motion.duration < 4.0 && motion.residual().to_degrees() > 10.0);
//! # Ok::<(), driftless::input::InputError>(())
//! ```

#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[cfg(feature = "harness")]
pub mod analysis;
pub mod attitude;
#[cfg(feature = "cli")]
pub mod cli;
pub mod digest;
#[cfg(feature = "harness")]
pub mod exhibit;
#[cfg(feature = "harness")]
pub mod experiment;
#[cfg(feature = "harness")]
pub mod export;
#[cfg(feature = "harness")]
pub mod figure;
pub mod functions;
pub mod input;
pub mod kinematics;
pub mod lanes;
pub mod momentum;
pub mod optimiser;
pub mod output;
#[cfg(feature = "harness")]
pub mod plot;
pub mod posture;
#[cfg(feature = "harness")]
pub mod registry;
pub mod reorientation;
#[cfg(feature = "harness")]
pub mod report;
pub mod robot;
pub mod scalar;
pub mod search;
pub mod so3;
pub mod task;
pub mod trajectory;
pub mod vec3;
