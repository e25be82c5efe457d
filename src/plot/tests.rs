//! Every chart drawn from fixed data, beside a stored picture; and no two texts that touch.
//!
//! `DRIFTLESS_ACCEPT_CHARTS=1` stores what is drawn now. What differs is left in `target/charts`.

use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use nalgebra::UnitQuaternion;
use polars::prelude::*;
use resvg::usvg;

use super::curves::curves;
use super::{
    Looks, Swept, base_attitude, convergence, critical_difference, derivatives, effect_sizes,
    expected_running_time, final_costs, joint_angles, pareto, profiles, running_time_distribution,
    snapshots, sweep,
};
use crate::experiment::Entrant;
use crate::figure::{Figure, png};
use crate::optimiser::{Hybrid, Settings};
use crate::reorientation::{JointMotion, Motion, TaskFile};

/// Resolution of the stored pictures \[dots per inch\].
const DPI: f32 = 110.0;

/// A field of all kinds, with labels as long as they get.
fn field(count: usize) -> Vec<Entrant> {
    let pso = Settings::by_name("pso").unwrap();
    let mut kinds = Settings::all();
    kinds.push(Settings::Hybrid(Hybrid { search: Box::new(pso), ..Hybrid::default() }));
    let label = |(i, settings): (usize, Settings)| Entrant {
        label: format!(
            "{}/time-free{}",
            settings.title(),
            ["", " population=150", " b"][i / 9 % 3]
        ),
        settings,
        seeds: None,
        budget: None,
    };
    kinds.into_iter().cycle().take(count).enumerate().map(label).collect()
}

fn labels(field: &[Entrant]) -> Vec<&str> {
    field.iter().map(|entrant| entrant.label.as_str()).collect()
}

/// One row for each combination of panel, optimiser and abscissa.
fn rows<'a>(
    panels: &'a [&'a str],
    labels: &'a [&'a str],
    abscissae: &'a [f64],
) -> impl Iterator<Item = (&'a str, usize, &'a str, f64)> + Clone {
    panels.iter().flat_map(move |panel| {
        labels
            .iter()
            .enumerate()
            .flat_map(move |(i, label)| abscissae.iter().map(move |x| (*panel, i, *label, *x)))
    })
}

fn real(rows: impl Iterator<Item = f64>) -> Vec<f64> {
    rows.collect()
}

fn convergence_of(count: usize, panels: &[&str]) -> Figure {
    let field = field(count);
    let labels = labels(&field);
    let evaluations: Vec<f64> = (0..40).map(|i| 10_f64.powf(f64::from(i) / 8.0).round()).collect();
    let rows = || rows(panels, &labels, &evaluations);
    let median = |i: usize, x: f64| 0.8 + 30.0 / x.powf(0.25 + 0.05 * i as f64);
    let frame = df!(
        "group" => rows().map(|r| r.0).collect::<Vec<_>>(),
        "optimiser" => rows().map(|r| r.2).collect::<Vec<_>>(),
        "evaluations" => real(rows().map(|r| r.3)),
        "quartile 1" => real(rows().map(|(_, i, _, x)| 0.9 * median(i, x))),
        "median" => real(rows().map(|(_, i, _, x)| median(i, x))),
        "quartile 3" => real(rows().map(|(_, i, _, x)| 1.3 * median(i, x))),
    );
    convergence(&frame.unwrap(), &Looks::of(&field), "J").unwrap().unwrap()
}

fn distribution() -> Figure {
    let field = field(5);
    let labels = labels(&field);
    let evaluations: Vec<f64> = (0..60).map(|i| 10_f64.powf(f64::from(i) / 10.0).round()).collect();
    let rows = || rows(&["a", "b", "all"], &labels, &evaluations);
    let share = |i: usize, x: f64| (x.log10() / (3.0 + i as f64)).min(1.0 - 0.1 * i as f64);
    let frame = df!(
        "group" => rows().map(|r| r.0).collect::<Vec<_>>(),
        "optimiser" => rows().map(|r| r.2).collect::<Vec<_>>(),
        "evaluations" => real(rows().map(|r| r.3)),
        "share of runs" => real(rows().map(|(_, i, _, x)| share(i, x.min(1e5)))),
        "share with restarts" => real(rows().map(|(_, i, _, x)| share(i, x))),
    );
    running_time_distribution(&frame.unwrap(), &Looks::of(&field)).unwrap().unwrap()
}

fn expectation() -> Figure {
    let field = field(5);
    let labels = labels(&field);
    let targets: Vec<f64> = (0..51).map(|i| 10_f64.powf(2.0 - f64::from(i) / 5.0)).collect();
    let rows = || rows(&[""], &labels, &targets);
    let time = |i: usize, x: f64| {
        if x < 10_f64.powi(-2 * i as i32) { f64::INFINITY } else { 100.0 * x.powf(-0.3) + i as f64 }
    };
    let frame = df!(
        "group" => rows().map(|r| r.0).collect::<Vec<_>>(),
        "optimiser" => rows().map(|r| r.2).collect::<Vec<_>>(),
        "above least" => real(rows().map(|r| r.3)),
        "expected running time" => real(rows().map(|(_, i, _, x)| time(i, x))),
    );
    expected_running_time(&frame.unwrap(), &Looks::of(&field), "J").unwrap().unwrap()
}

fn profile(time: &str, label: &str) -> Figure {
    let field = field(4);
    let labels = labels(&field);
    let steps = [1.0, 1.5, 3.0, 8.0, 40.0];
    let rows = || rows(&["J ≤ 0.86", "J ≤ 0.79"], &labels, &steps);
    let frame = df!(
        "target" => rows().map(|r| r.0).collect::<Vec<_>>(),
        "optimiser" => rows().map(|r| r.2).collect::<Vec<_>>(),
        time => real(rows().map(|(_, i, _, x)| x * (1.0 + i as f64))),
        "share" => real(rows().map(|(_, i, _, x)| x.ln() / 40_f64.ln() / (1.0 + 0.2 * i as f64))),
    );
    profiles(&frame.unwrap(), &Looks::of(&field), time, label).unwrap().unwrap()
}

fn costs(spread: f64) -> Figure {
    let field = field(8);
    let labels = labels(&field);
    let seeds: Vec<f64> = (0..15).map(f64::from).collect();
    let rows = || rows(&["a", "b"], &labels, &seeds);
    let cost = |i: usize, x: f64| 0.8 * (1.0 + spread * (i as f64 + (7.0 * x).sin().abs()));
    let frame = df!(
        "group" => rows().map(|r| r.0).collect::<Vec<_>>(),
        "optimiser" => rows().map(|r| r.2).collect::<Vec<_>>(),
        "best J" => real(rows().map(|(_, i, _, x)| {
            if i > 5 && x > 11.0 { f64::INFINITY } else { cost(i, x) }
        })),
    );
    final_costs(&frame.unwrap(), &Looks::of(&field), "J").unwrap().unwrap()
}

fn ranks(count: usize) -> (Vec<Entrant>, DataFrame) {
    let field = field(count);
    let means: Vec<f64> = (0..count).map(|i| 1.1 + 0.9 * i as f64).collect();
    let cliques: Vec<String> =
        (0..count).map(|i| format!("{} {}", i / 3 + 1, (i + 1) / 3 + 1)).collect();
    let frame = df!("optimiser" => labels(&field), "mean rank" => means, "cliques" => cliques);
    (field, frame.unwrap())
}

fn differences(count: usize) -> Figure {
    let (field, ranks) = ranks(count);
    let friedman = df!("critical difference" => [2.1]).unwrap();
    critical_difference(&ranks, &friedman, &Looks::of(&field)).unwrap()
}

fn effects(count: usize) -> Figure {
    let (field, ranks) = ranks(count);
    let labels = labels(&field);
    let pairs = || (0..count).flat_map(|i| (i + 1..count).map(move |j| (i, j)));
    let frame = df!(
        "first" => pairs().map(|(i, _)| labels[i]).collect::<Vec<_>>(),
        "second" => pairs().map(|(_, j)| labels[j]).collect::<Vec<_>>(),
        "A12" => real(pairs().map(|(i, j)| 0.5 + 0.5 * (j - i) as f64 / count as f64)),
        "p Holm" => real(pairs().map(|(i, j)| if j - i > 2 { 0.01 } else { 0.2 })),
    );
    effect_sizes(&frame.unwrap(), &ranks).unwrap()
}

fn best(column: &str, values: &[f64]) -> DataFrame {
    df!(
        "instance" => values.iter().map(|v| format!("{column}={v}")).collect::<Vec<_>>(),
        column => values,
        "best J" => real(values.iter().map(|v| 0.6 + 0.3 / v)),
        "residual [°]" => real(values.iter().map(|v| if *v < 0.15 { 29.0 } else { 0.0 })),
        "t_f [s]" => real(values.iter().map(|v| 7.8 * (v / 80.0).powf(-1.0 / 3.0).max(0.6))),
    )
    .unwrap()
}

fn swept(setting: Swept, values: &[f64], bound: Option<f64>) -> Figure {
    sweep(&best(setting.column(), values), setting, bound).unwrap().unwrap()
}

fn front() -> Figure {
    let frame = df!(
        "instance" => (0..5).map(|i| format!("weight_base={i}")).collect::<Vec<_>>(),
        "weight_base" => [0.01, 0.1, 0.2, 0.5, 0.9],
        "t_f [s]" => [2.8, 2.8, 5.0, 7.0, 7.8],
        "residual [°]" => [29.0, 29.0, 12.0, 14.0, 0.0],
        "efficient" => [true, true, true, false, true],
    );
    pareto(&frame.unwrap()).unwrap().unwrap()
}

fn motion() -> Motion {
    let time: Vec<f64> = (0..=200).map(|i| f64::from(i) * 0.05).collect();
    let joint = |i: usize| JointMotion {
        name: format!("joint{}", i + 1),
        derivatives: time
            .iter()
            .map(|t| std::array::from_fn(|k| (t * TAU / 10.0 + (i + k) as f64).sin() * 1.2))
            .collect(),
    };
    let base = |t: &f64| UnitQuaternion::from_euler_angles(0.1 * t.sin(), 0.03 * t, -0.02 * t);
    Motion { joints: (0..7).map(joint).collect(), base: time.iter().map(base).collect(), time }
}

/// Every chart by name.
fn charts() -> Vec<(&'static str, Figure)> {
    let document = TaskFile::paper();
    let (problem, _) = TaskFile::read(&document).unwrap().build(&document).unwrap();
    let task = problem.task();
    vec![
        ("convergence", convergence_of(5, &[""])),
        (
            "convergence-groups",
            convergence_of(6, &["sphere", "ellipsoid", "rastrigin", "rosenbrock"]),
        ),
        ("convergence-crowd", convergence_of(20, &[""])),
        ("running-time-distribution", distribution()),
        ("expected-running-time", expectation()),
        ("performance-profiles", profile("ratio", "ratio to the fewest evaluations")),
        ("data-profiles", profile("simplex gradients", "simplex gradients")),
        ("final-costs", costs(0.05)),
        ("final-costs-wide", costs(3.0)),
        ("effect-sizes", effects(5)),
        ("effect-sizes-crowd", effects(20)),
        ("critical-difference", differences(4)),
        ("critical-difference-crowd", differences(20)),
        ("weight-sweep", swept(Swept::WeightBase, &[0.001, 0.01, 0.1, 0.2, 0.5, 0.9], None)),
        ("jerk-sweep", swept(Swept::JerkLimit, &[20.0, 40.0, 80.0, 160.0, 320.0, 640.0], None)),
        ("rate-sweep", swept(Swept::RateLimit, &[10.0, 20.0, 40.0, 60.0], None)),
        ("terms-sweep", swept(Swept::Terms, &[1.0, 2.0, 3.0, 4.0, 8.0], Some(0.6))),
        ("pareto", front()),
        ("joint-angles", joint_angles(&motion())),
        ("joint-derivatives", derivatives(&motion(), &task.limits)),
        ("base-attitude", base_attitude(&motion(), task)),
        ("snapshots", snapshots(&Motion::sample(&problem, &[0.1; 12], 8.0, 100), task)),
    ]
}

fn decoded(bytes: &[u8]) -> (u32, Vec<u8>) {
    let mut reader = ::png::Decoder::new(bytes).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size()];
    let info = reader.next_frame(&mut pixels).unwrap();
    (info.width, pixels)
}

#[test]
fn charts_look_as_stored() {
    let (stored, drawn) = (Path::new("tests/charts"), Path::new("target/charts"));
    let mut changed = Vec::new();
    for (name, figure) in charts() {
        let bytes = png(&figure.tree().unwrap(), DPI).unwrap();
        let file = format!("{name}.png");
        if std::env::var_os("DRIFTLESS_ACCEPT_CHARTS").is_some() {
            fs::create_dir_all(stored).unwrap();
            fs::write(stored.join(&file), &bytes).unwrap();
        }
        let expected = fs::read(stored.join(&file)).ok().map(|bytes| decoded(&bytes));
        let (width, pixels) = decoded(&bytes);
        // Last digits of sines may differ, so an edge's pixel may be a little darker; no more.
        let is_same = expected.is_some_and(|(expected_width, expected)| {
            let far = expected.iter().zip(&pixels).filter(|(a, b)| a.abs_diff(**b) > 40).count();
            width == expected_width && pixels.len() == expected.len() && far * 5000 < pixels.len()
        });
        if !is_same {
            fs::create_dir_all(drawn).unwrap();
            fs::write(drawn.join(&file), &bytes).unwrap();
            changed.push(file);
        }
    }
    assert!(changed.is_empty(), "look at {changed:?} in {}", drawn.display());
}

/// All texts, with the bounding boxes of what is seen of them.
fn texts(group: &usvg::Group) -> Vec<(String, usvg::Rect)> {
    let of = |node: &usvg::Node| match node {
        usvg::Node::Group(group) => texts(group),
        usvg::Node::Text(text) => {
            let chunks = text.chunks().iter().map(usvg::TextChunk::text);
            let seen = text.flattened().bounding_box().transform(text.abs_transform());
            vec![(chunks.collect(), seen.unwrap())]
        }
        _ => Vec::new(),
    };
    group.children().iter().flat_map(of).collect()
}

#[test]
fn no_text_touches_another_or_the_edge() {
    for (name, figure) in charts() {
        let tree = figure.tree().unwrap();
        let texts = texts(tree.root());
        assert!(!texts.is_empty(), "{name} has no text");
        for (i, (text, a)) in texts.iter().enumerate() {
            let size = tree.size();
            let is_within = a.left() >= 0.0
                && a.top() >= 0.0
                && a.right() <= size.width()
                && a.bottom() <= size.height();
            assert!(is_within, "{name}: {text:?} is cut off: {a:?} of {size:?}");
            for (other, b) in &texts[i + 1..] {
                let apart = a.right() <= b.left()
                    || b.right() <= a.left()
                    || a.bottom() <= b.top()
                    || b.bottom() <= a.top();
                assert!(apart, "{name}: {text:?} touches {other:?}");
            }
        }
    }
}

#[test]
fn a_table_without_its_columns_is_an_error() {
    let frame = df!("group" => ["a"], "optimiser" => ["pso"]).unwrap();
    assert!(curves(&frame, "group", "evaluations", &["median"]).is_err());
}
