//! Search boxes that follow the robot and the turn it is to make.

use std::num::NonZeroUsize;
use std::sync::Arc;

use driftless::input::Document;
use driftless::optimiser::{Optimiser, Scp};
use driftless::reorientation::{Boxes, Formulated, Formulation, Reorientation, TaskFile};
use driftless::search::{Oracle, Rng, Watch};

fn read(document: &Document) -> (Reorientation, Boxes) {
    TaskFile::read(document).unwrap().build(document).unwrap()
}

fn paper(text: &str) -> (Reorientation, Boxes) {
    read(&Document::embedded("task", text))
}

/// The paper's arm on a base that is so many times as heavy, turning about its first axis by so much.
fn on_base(times: f64, yaw_deg: f64, more: &str) -> (Reorientation, Boxes) {
    let folder = tempfile::tempdir().unwrap();
    let robot = include_str!("../src/robot/shipped/xiao2023.toml");
    let mut table: toml::Table = robot.parse().unwrap();
    let base = table["base"].as_table_mut().unwrap();
    let scaled = |value: &toml::Value| {
        let number = value.as_float().or_else(|| value.as_integer().map(|i| i as f64)).unwrap();
        toml::Value::Float(times * number)
    };
    base["mass"] = scaled(&base["mass"]);
    for (_, value) in base["inertia"].as_table_mut().unwrap() {
        *value = scaled(value);
    }
    std::fs::write(folder.path().join("arm.toml"), table.to_string()).unwrap();
    let path = folder.path().join("task.toml");
    let task = format!(
        "[task]\nrobot = 'arm.toml'\n\
         start = {{ joints_deg = [10, 30, 45, -20, -25, 40], base_zyx_deg = [{yaw_deg}, 0, 0] }}\n\
         goal = {{ joints_deg = [40, 60, 90, -10, -30, 60], base_zyx_deg = [0, 0, 0] }}\n\
         limits = {{ rate_deg_s = 60, acceleration_deg_s2 = 70, jerk_deg_s3 = 80 }}\n[trajectory]\n{more}\n"
    );
    std::fs::write(&path, task).unwrap();
    read(&Document::read(&path).unwrap())
}

/// What experiments with the paper's task were run with.
#[test]
fn the_papers_box_and_accuracy_are_what_they_were() {
    for terms in 1..=8 {
        let (problem, boxes) = paper(&format!("[trajectory]\nterms = {terms}\n"));
        let widths = [1.0, 0.35, 0.15, 0.05, 0.05, 0.05, 0.05, 0.05];
        assert_eq!(boxes.coefficient, widths[..terms]);
        let accuracy = problem.accuracy();
        assert_eq!((accuracy.attitude_steps, accuracy.peak_intervals), (24, 47));
    }
}

#[test]
fn boxes_widen_as_the_base_is_heavier_and_its_turn_larger() {
    let width = |times: f64, yaw_deg: f64| on_base(times, yaw_deg, "").1.coefficient[0];
    assert_eq!(width(1.0, 5.0), 1.0);
    let widths = [1.0, 3.0, 6.0, 1e4].map(|times| width(times, 20.0));
    assert!(widths.is_sorted() && widths[0] < widths[2], "{widths:?}");
    assert_eq!(widths[3], 16.0);
    let widths = [2.0, 10.0, 30.0, 90.0].map(|yaw| width(4.0, yaw));
    assert!(widths.is_sorted() && widths[0] == 1.0 && widths[3] > 1.0, "{widths:?}");
    // All bumps alike, and powers of time and durations follow.
    let [narrow, wide] = [on_base(1.0, 5.0, "").1, on_base(1e4, 20.0, "").1];
    assert_eq!(wide.coefficient[1], 16.0 * narrow.coefficient[1]);
    assert!(wide.duration[1] > 5.0 * narrow.duration[1], "{wide:?} {narrow:?}");
    assert!(wide.alpha[0] != narrow.alpha[0]);
    // A wider box holds the fast motions, too.
    let shortest = |wider: &str| on_base(1.0, 20.0, wider).1.duration[0];
    assert_eq!(shortest("box.coefficient = [16]\n"), shortest("box.coefficient = [1]\n"));
    assert!(shortest("box.coefficient = [0.3]\n") <= shortest(""));
}

/// A base of 6 t is out of reach of the narrowest box, not of its own.
#[test]
fn a_heavy_base_is_turned_in_its_own_box() {
    let residual = |more| {
        let (problem, boxes) = on_base(10.0, 20.0, more);
        let problem = Formulated::new(Formulation::TimeFree, Arc::new(problem), &boxes).unwrap();
        let watch = Watch::default();
        let mut oracle = Oracle::new(&problem, 150_000, &watch);
        let scp = Scp { starts: NonZeroUsize::new(20), ..Scp::default() };
        scp.minimise(&mut oracle, &mut Rng::new(1)).unwrap();
        problem.certify(&oracle.best().unwrap().x).1.residual().to_degrees()
    };
    let [own, narrowest] = [residual(""), residual("box.coefficient = [1, 0.35]\n")];
    assert!(own < 0.001 && narrowest > 5.0, "{own} {narrowest}");
}

#[test]
fn accuracy_follows_box_and_terms_and_what_is_stated_stands() {
    let of = |problem: &Reorientation| {
        let accuracy = problem.accuracy();
        (accuracy.attitude_steps, accuracy.peak_intervals)
    };
    assert_eq!(of(&on_base(1e4, 20.0, "").0), (96, 191));
    assert_eq!(of(&on_base(1e4, 20.0, "attitude_steps = 48\n").0), (48, 191));
    assert_eq!(of(&on_base(1e4, 20.0, "box.coefficient = [1]\n").0), (24, 47));
    assert_eq!(on_base(1e4, 20.0, "box.coefficient = [3]\n").1.coefficient, [3.0, 3.0]);
    assert_eq!(of(&paper("[trajectory]\nterms = 12\n").0), (24, 111));
    assert_eq!(of(&paper("[trajectory]\npeak_intervals = 63\n").0), (24, 63));
}
