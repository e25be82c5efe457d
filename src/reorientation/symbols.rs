//! The task's symbols as charts write them, letters lowered.

/// The duration.
pub(super) const T_F: &str = "t\u{E000}f\u{E002}";
/// The weight of the base.
pub(super) const K_B: &str = "K\u{E000}b\u{E002}";
