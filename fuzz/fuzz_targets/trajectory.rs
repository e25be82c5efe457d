//! Trajectories of other programs: read, or refused with an error; what is read is evaluated to numbers, the momentum on the way
//! being none.
#![no_main]

use std::fs;
use std::sync::LazyLock;

use driftless::reorientation::{AngleUnit, GivenTrajectory, Replayed, TaskFile};
use driftless::task::Task;
use libfuzzer_sys::fuzz_target;

static TASK: LazyLock<Task> = LazyLock::new(|| {
    let document = TaskFile::paper();
    TaskFile::read(&document).and_then(|file| file.task.build(&document)).expect("the paper's task")
});

// The first byte is the format.
fuzz_target!(|bytes: &[u8]| {
    let [which, bytes @ ..] = bytes else { return };
    let (name, unit) = match which % 3 {
        0 => ("t.yaml", None),
        1 => ("t.csv", Some(AngleUnit::Rad)),
        _ => ("t.parquet", Some(AngleUnit::Deg)),
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    fs::write(&path, bytes).expect("a trajectory");
    let Ok(trajectory) = GivenTrajectory::read(&path, &TASK.robot, unit) else { return };
    let replayed = Replayed::new(&TASK, &trajectory.points);
    assert!(replayed.played.residual.is_finite(), "{replayed:?}");
    // Relative to what the arm's links, some forty kilograms, have at such rates.
    let fastest = replayed.played.largest_share(&TASK, 0).max(1.0);
    assert!(replayed.momentum.iter().all(|momentum| *momentum < 1e-9 * fastest), "{replayed:?}");
});
