//! Charts of sweeps, from points made by hand.

use super::sweeps::{Point, Shape, Swept, sweep as sweep_chart};
use crate::figure::Figure;
use crate::figure::marks::Mark;
use crate::figure::stored_pictures::texts;

fn points(setting: &[f64]) -> Vec<Point> {
    let point = |&value: &f64| Point {
        others: Vec::new(),
        pose: String::new(),
        setting: value,
        cost: 0.6 + 0.3 / value,
        residual_deg: if value < 0.15 { 29.0 } else { 0.0 },
        duration: 7.8 * (value / 80.0).powf(-1.0 / 3.0).max(0.6),
        turn_deg: 30.0 - 4.0 * value,
        shape: Shape::default(),
        follows_failure: false,
    };
    setting.iter().map(point).collect()
}

pub(super) fn swept(setting: Swept, values: &[f64], bound: Option<f64>) -> Figure {
    sweep_chart(&points(values), setting, bound).unwrap()
}

/// Durations \[s\] and residuals \[°\] over jerk limits on another arm: the lower limits leave too little time.
const MISSED: [(f64, f64, f64); 5] =
    [(20.0, 4.1, 0.4), (40.0, 4.1, 0.2), (80.0, 7.3, 0.0), (160.0, 5.8, 0.0), (320.0, 5.2, 0.0)];

pub(super) fn missed(others: &[String], pose: &str, times: f64) -> Vec<Point> {
    let point = |(setting, duration, residual_deg)| Point {
        others: others.to_vec(),
        pose: pose.to_owned(),
        setting,
        cost: duration / 10.0,
        residual_deg,
        duration: times * duration,
        turn_deg: f64::NAN,
        shape: Shape::default(),
        follows_failure: false,
    };
    MISSED.map(point).to_vec()
}

/// The same under ten limits on rates.
pub(super) fn two_settings() -> Vec<Point> {
    let rates =
        (1..=10).map(|rate| (format!("rate ≤ {} °/s", 10 * rate), 1.5 - 0.05 * f64::from(rate)));
    rates.flat_map(|(rate, times)| missed(&[rate], "", times)).collect()
}

/// Five poses, of which two reach the goal throughout.
pub(super) fn poses() -> Vec<Point> {
    let pose = |k: u32| {
        let mut points = missed(&[], &k.to_string(), 1.0 + 0.1 * f64::from(k));
        if k < 3 {
            for point in &mut points {
                point.residual_deg = 0.0;
            }
        }
        points
    };
    (1..=5).flat_map(pose).collect()
}

/// The lines of a figure's first panel with more than one point, by their abscissae.
fn joined(figure: &Figure) -> Vec<Vec<f64>> {
    let lines = figure.panels[0].marks.iter().filter_map(|mark| match mark {
        Mark::Line(line) => Some(line.points.iter().map(|[x, _]| *x).collect::<Vec<f64>>()),
        _ => None,
    });
    lines.filter(|line| line.len() > 1).collect()
}

/// Neither the curve nor the law joins motions that miss the goal to those that reach it; what they miss it by stands below.
#[test]
fn what_misses_the_goal_is_not_joined() {
    let figure = sweep_chart(&missed(&[], "", 1.0), Swept::JerkLimit, None).unwrap();
    let [law, curve] = &joined(&figure)[..] else { panic!("expected the law and a curve") };
    assert_eq!((law[0], law[law.len() - 1]), (80.0, 320.0));
    assert!(law.len() > 10 && law.is_sorted(), "{law:?}");
    assert_eq!(curve, &[80.0, 160.0, 320.0]);
    assert_eq!(figure.panels[1].y.label, "residual [°]");
    let texts = texts(figure.tree().unwrap().root());
    assert!(texts.iter().any(|(text, _)| text == "goal missed by more than 0.01°"), "{texts:?}");
    let reached = swept(Swept::JerkLimit, &[80.0, 160.0], None);
    assert_eq!(reached.panels[1].y.label, "residual [°]");
}

/// A quarter of the largest travel of a joint, which is two radians, is half a radian.
#[test]
fn lines_have_gaps_at_other_branches_and_failures() {
    let settings = [40.0, 80.0, 160.0, 320.0];
    let mut points = points(&settings);
    let joined_in =
        |points: &[Point]| joined(&sweep_chart(points, Swept::RateLimit, None).unwrap());
    for (point, middle) in points.iter_mut().zip([0.0, 0.4, 1.0, 1.4]) {
        point.shape = Shape([vec![vec![0.0, middle, 2.0]], Vec::new()]);
    }
    assert_eq!(joined_in(&points), [[40.0, 80.0], [160.0, 320.0]]);
    points[3].follows_failure = true;
    assert_eq!(joined_in(&points), [[40.0, 80.0]]);
}

#[test]
fn two_settings_have_two_panels_for_each_value_of_one() {
    let figure = sweep_chart(&two_settings(), Swept::JerkLimit, None).unwrap();
    let titles: Vec<&str> = figure.panels.iter().map(|panel| panel.title.as_str()).collect();
    assert_eq!(titles[..2], ["rate ≤ 10 °/s", "rate ≤ 20 °/s"]);
    assert_eq!(titles.iter().filter(|title| !title.is_empty()).count(), 20);
}

/// Of two poses that take 1.1 and 1.2 times as long.
#[test]
fn poses_have_a_median_of_those_that_reach_the_goal_throughout() {
    let figure = sweep_chart(&poses(), Swept::JerkLimit, None).unwrap();
    let median = figure.panels[0].marks.iter().find_map(|mark| match mark {
        Mark::Line(line) if line.name.starts_with("median") => Some(line),
        _ => None,
    });
    let median = median.unwrap();
    assert_eq!(median.name, "median of 2 poses that reach the goal throughout");
    assert!((median.points[2][1] - 1.15 * 7.3).abs() < 1e-12, "{median:?}");
}
