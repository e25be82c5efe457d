//! Costs and residuals of random tasks and robots against a slow integrator of its own.
#![no_main]

use driftless::input::Document;
use driftless::reorientation::TaskFile;
use driftless_fuzz::reference::Draw;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Some(draw) = Draw::new(bytes) else { return };
    let folder = std::env::temp_dir().join(format!("driftless-fuzz-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for the robot");
    std::fs::write(folder.join("robot.toml"), draw.robot_text()).expect("a robot file");
    let path = folder.join("task.toml");
    std::fs::write(&path, draw.task_text()).expect("a task file");
    let document = Document::read(&path).expect("the task");
    let (problem, _) =
        TaskFile::read(&document).and_then(|file| file.build(&document)).expect("a sound task");
    let motion = problem.certify(&draw.coefficients, None);
    let expected = draw.integrate();
    let near = |what: &str, found: f64, expected: f64, by: f64| {
        assert!((found - expected).abs() <= by, "{what}: {found} instead of {expected}\n{draw:?}");
    };
    near("residual", motion.residual(), expected.residual, 2e-7);
    // Samples miss a peak by a little, and never invent one.
    near("duration", motion.duration, expected.duration, 1e-5 * expected.duration);
    assert!(motion.duration >= expected.duration * (1.0 - 1e-9), "{draw:?}");
    near("J", motion.cost, expected.cost, 1e-4 * expected.cost.max(1.0));
});
