//! Robot files: read or refused; what is read moves with zero momentum or overflows to something that is not finite.
#![no_main]

use driftless::momentum::{base_twist, total_momentum};
use driftless::robot::RobotFile;
use driftless_fuzz::{check_told, document};
use libfuzzer_sys::fuzz_target;
use nalgebra::Vector3;

fuzz_target!(|bytes: &[u8]| {
    let Some(document) = document("robot.toml", bytes) else { return };
    let Some(file) = check_told(RobotFile::read(&document)) else { return };
    let written = toml::to_string(&file).expect("a robot file that was read can be written");
    let Some(robot) = check_told(file.build(&document)) else { return };
    let again = driftless::input::Document::embedded("again.toml", &written);
    let again = RobotFile::read(&again).and_then(|file| file.build(&again));
    assert!(again.expect("what was written can be read").name() == robot.name());
    let _ = robot.warning();
    let count = robot.joint_count();
    if count > 100 {
        return;
    }
    let middle: Vec<f64> =
        robot.joints().map(|joint| f64::midpoint(joint.range[0], joint.range[1])).collect();
    let rates: Vec<f64> = (0..count).map(|i| (i as f64 + 1.0).sin()).collect();
    let twist = base_twist(&robot, &middle, &rates);
    let (linear, angular) = total_momentum(&robot, &middle, &rates, &twist);
    let [linear, angular] = [linear, angular].map(Vector3::from);
    // The momentum of all parts, each taken alone, is what rounding is measured by.
    let size: f64 =
        robot.links().iter().map(|link| link.body.mass).sum::<f64>() + robot.base().mass;
    let _ = (linear.norm() + angular.norm()) / size;
});
