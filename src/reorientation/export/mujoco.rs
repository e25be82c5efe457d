//! A folder for MuJoCo: the robot, the motion, and a script that plays it.

use std::path::Path;

use super::record::Record;
use super::{ExportError, csv};
use crate::output::{write_file, write_folder};

/// The script, which reads both files beside it.
const PLAYER: &str = include_str!("play.py");

/// Writes the folder, whole or not at all.
pub(super) fn write(folder: &Path, record: &Record<'_>) -> Result<(), ExportError> {
    let error = |reason: &str| ExportError::Format { format: "MuJoCo", reason: reason.to_owned() };
    if record.joints.len() < record.robot.joint_count() {
        return Err(error("found some of the robot's joints, expected all"));
    }
    if !record.is_one_robot {
        return Err(error(
            "found a load that is caught or released during the motion, expected none",
        ));
    }
    let robot = record.robot.with_shapes().0.to_mjcf();
    let motion = csv::wide(record)?;
    write_folder(folder, |folder| {
        write_file(&folder.join("robot.xml"), robot.as_bytes())?;
        write_file(&folder.join("motion.wide.csv"), &motion)?;
        Ok(write_file(&folder.join("play.py"), PLAYER.as_bytes())?)
    })
}
