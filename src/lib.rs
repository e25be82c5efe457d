//! x
pub mod attitude;
pub mod input;
pub mod kinematics;
pub mod momentum;
pub mod problem;
pub mod robot;
pub mod scalar;
pub mod so3;
pub mod task;
pub mod trajectory;
