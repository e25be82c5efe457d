//! The best motions known are what the file says they are, and are found again whatever a task is
//! called and however it is written.

use driftless::input::Document;
use driftless::reorientation::{BestKnown, Reorientation, TaskFile, fingerprint};

fn problem(text: &str) -> Reorientation {
    let document = Document::embedded("task.toml", text);
    TaskFile::read(&document).unwrap().build(&document).unwrap().0
}

/// The durations are those of independent searches for the paper's task, to the digits in which those
/// agree: 7.818486 s, 6.314900 s and 6.14653 s with two, three and four terms.
#[test]
fn every_entry_replays_to_its_printed_digits() {
    for entry in BestKnown::all() {
        let (problem, assessment) = entry.replay().unwrap();
        assert_eq!(entry.fingerprint, fingerprint(&*problem), "{entry}");
        // Printed to ten digits, of which another order of summation may turn the last.
        assert!((assessment.cost - entry.j).abs() < 1e-9 * entry.j, "{entry}");
        assert!(assessment.penalty() < 1e-9, "{entry}");
        assert_eq!(entry.coefficients.len(), problem.task().robot.joint_count());
        let own = problem.dimension() / entry.coefficients.len();
        assert!(entry.coefficients.iter().all(|row| row.len() == own));
    }
    for (terms, duration, digits) in
        [(2, 7.818_486, 1e-6), (3, 6.314_900, 1e-6), (4, 6.14653, 1e-5)]
    {
        let known = BestKnown::of(&problem(&format!("[trajectory]\nterms = {terms}\n"))).unwrap();
        assert!((known.t_f - duration).abs() < digits, "{known}");
    }
}

#[test]
fn every_entry_has_a_task_of_its_own() {
    let mut fingerprints: Vec<&str> =
        BestKnown::all().iter().map(|entry| entry.fingerprint.as_str()).collect();
    let all = fingerprints.len();
    fingerprints.sort_unstable();
    fingerprints.dedup();
    assert_eq!(fingerprints.len(), all);
}

/// Turns of the base by whole circles, a turn of both its attitudes by the same angle about the axis
/// that they are told from, boxes and accuracies change nothing; whatever else does.
#[test]
fn fingerprints_tell_what_the_optimum_follows_from() {
    let paper = fingerprint(&problem(""));
    for same in [
        "[task.start]\nbase_zyx_deg = [366, 15, 7]\n",
        "[task.start]\nbase_zyx_deg = [36, 15, 7]\n[task.goal]\nbase_zyx_deg = [30, 0, 0]\n",
        "[task.limits]\njerk_deg_s3 = [80, 80, 80, 80, 80, 80]\n",
        "[trajectory]\nattitude_steps = 48\n[trajectory.box]\ncoefficient = [2]\n",
    ] {
        assert_eq!(fingerprint(&problem(same)), paper, "{same}");
    }
    for other in [
        "[task.start]\nbase_zyx_deg = [6, 15, 7.001]\n",
        "[task.start]\njoints_deg = [10, 30, 45, -20, -25, 40.001]\n",
        "[task.goal]\njoints_deg = [40, 60, 90, -10, -30, 60.001]\n",
        "[task.limits]\njerk_deg_s3 = [80, 80, 80, 80, 80, 81]\n",
        "[task.weights]\nbase = 0.8\n",
        "[trajectory]\nterms = 3\n",
    ] {
        assert_ne!(fingerprint(&problem(other)), paper, "{other}");
    }
}

/// A copy of the paper's robot under another name is the same robot; a heavier one is not.
#[test]
fn fingerprints_look_into_the_robot() {
    let folder = tempfile::tempdir().unwrap();
    let text = include_str!("../src/robot/shipped/xiao2023.toml");
    let with_robot = |text: String| {
        std::fs::write(folder.path().join("arm.toml"), text).unwrap();
        let task = folder.path().join("task.toml");
        let text = "[task]\nrobot = 'arm.toml'\n\
            start = { joints_deg = [10, 30, 45, -20, -25, 40], base_zyx_deg = [6, 15, 7] }\n\
            goal = { joints_deg = [40, 60, 90, -10, -30, 60], base_zyx_deg = [0, 0, 0] }\n\
            limits = { rate_deg_s = 60, acceleration_deg_s2 = 70, jerk_deg_s3 = 80 }\n";
        std::fs::write(&task, text).unwrap();
        let document = Document::read(&task).unwrap();
        fingerprint(&TaskFile::read(&document).unwrap().build(&document).unwrap().0)
    };
    let paper = fingerprint(&problem(""));
    assert_eq!(with_robot(text.replace("xiao2023", "copy")), paper);
    assert_ne!(with_robot(text.replace("mass = 600", "mass = 600.001")), paper);
}

#[test]
fn a_lower_cost_is_told_from_the_same_one() {
    let known = BestKnown::of(&problem("")).unwrap();
    for (share, beaten) in [(-1e-5, true), (-1e-7, false), (0.0, false), (1e-5, false)] {
        assert_eq!(known.is_beaten_by(known.j * (1.0 + share)), beaten);
    }
    assert_eq!(known.compared_with(known.j * 1.05), "5 % above the best known, 0.781849");
    assert_eq!(known.compared_with(known.j * 0.95), "5 % below the best known, 0.781849");
    assert_eq!(known.compared_with(known.j), "reaches the best known, 0.781849");
}
