//! Angles as one reads them.

use crate::exhibit::words::significant;

/// Angles below are as good as none: searches end with some 10⁻⁶ \[°\].
pub(super) const NONE_DEG: f64 = 1e-3;

/// Residuals above miss the goal \[°\].
pub(in crate::reorientation) const AT_GOAL_DEG: f64 = 0.01;

/// How far the base ends off the goal.
pub(super) fn off_the_goal(residual_deg: f64) -> String {
    if residual_deg < NONE_DEG {
        "within 0.001° of the goal".to_owned()
    } else {
        format!("{}° off the goal", significant(residual_deg, 2))
    }
}

#[cfg(test)]
mod tests {
    use super::off_the_goal;

    #[test]
    fn small_angles_are_none() {
        assert_eq!(off_the_goal(3e-7), "within 0.001° of the goal");
        assert_eq!(off_the_goal(0.12688), "0.13° off the goal");
    }
}
