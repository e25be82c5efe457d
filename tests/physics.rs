//! Promises about the physics that hold for every state and every motion.
use driftless::input::Document;
use driftless::momentum::{base_twist, total_momentum};
use driftless::problem::{Reorientation, TaskFile};
use proptest::prelude::*;

fn paper() -> Reorientation {
    let document = Document::embedded("empty", "");
    TaskFile::read(&document).unwrap().build(&document).unwrap().0
}

proptest! {
    #[test]
    fn total_momentum_is_zero(
        angles in prop::collection::vec(-5.0..5.0, 6),
        rates in prop::collection::vec(-2.0..2.0, 6),
    ) {
        let robot = &paper().task().robot.clone();
        let base = base_twist(robot, &angles, &rates);
        let (linear, angular) = total_momentum(robot, &angles, &rates, &base);
        prop_assert!(linear.norm() < 1e-10, "{linear}");
        prop_assert!(angular.norm() < 1e-10, "{angular}");
    }
}
