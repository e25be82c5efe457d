//! The tasks that robots come with.

/// Robot and task, for every robot that comes with the program.
const TASKS: &[(&str, &str)] = &[
    ("xiao2023", include_str!("shipped/xiao2023.toml")),
    ("ets_vii", include_str!("shipped/ets_vii.toml")),
    ("canadarm2", include_str!("shipped/canadarm2.toml")),
    ("panda", include_str!("shipped/panda.toml")),
    ("ur5e", include_str!("shipped/ur5e.toml")),
    ("iiwa", include_str!("shipped/iiwa.toml")),
    ("dual_arm", include_str!("shipped/dual_arm.toml")),
];

/// The file of a robot's own task, if the robot comes with the program.
pub(super) fn task(robot: &str) -> Option<&'static str> {
    TASKS.iter().find(|(known, _)| *known == robot).map(|(_, text)| *text)
}
