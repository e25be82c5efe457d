//! Every chart drawn from fixed data.

use polars::prelude::*;

use super::comparison::{effect_sizes, final_costs};
use super::convergence::convergence;
use super::critical_difference::critical_difference;
use super::curves::curves;
use super::dimensions::dimensions;
use super::looks::Looks;
use super::running_times::{expected_running_time, profiles, running_time_distribution};
use crate::experiment::Entrant;
use crate::figure::Figure;
use crate::figure::stored_pictures::check;
use crate::optimiser::{Hybrid, Settings};

/// A field of all kinds, with labels as long as they get.
fn field(count: usize) -> Vec<Entrant> {
    let pso = Settings::by_name("pso").unwrap();
    let mut kinds = Settings::all();
    kinds.push(Settings::Hybrid(Hybrid { search: Box::new(pso), ..Hybrid::default() }));
    let count_of_kinds = kinds.len();
    let label = |(i, settings): (usize, Settings)| {
        let more = ["", " population=150", " b"][i / count_of_kinds % 3];
        let label = format!("{}/time-free{more}", settings.title());
        Entrant::from(settings).labelled(&label)
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

fn costs(count: usize, spread: f64) -> Figure {
    let field = field(count);
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

fn growth(count: usize) -> Figure {
    let field = field(count);
    let labels = labels(&field);
    let variables = [6.0, 12.0, 36.0, 84.0, 180.0];
    let rows = || rows(&["sine-polynomial", "spline"], &labels, &variables);
    let cost = |i: usize, x: f64| 0.56 + 0.02 * i as f64 * x.powf(0.3 * i as f64);
    let frame = df!(
        "series" => rows().map(|r| r.0).collect::<Vec<_>>(),
        "optimiser" => rows().map(|r| r.2).collect::<Vec<_>>(),
        "variables" => real(rows().map(|r| r.3)),
        "median" => real(rows().map(|(_, i, _, x)| {
            if i == 4 && x > 100.0 { f64::INFINITY } else { cost(i, x) }
        })),
    );
    dimensions(&frame.unwrap(), &Looks::of(&field), "J").unwrap().unwrap()
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

/// Every chart by name.
fn charts() -> Vec<(&'static str, Figure)> {
    vec![
        ("convergence", convergence_of(5, &[""])),
        (
            "convergence-groups",
            convergence_of(6, &["sphere", "ellipsoid", "rastrigin", "rosenbrock"]),
        ),
        ("convergence-crowd", convergence_of(20, &[""])),
        ("dimensions", growth(5)),
        ("running-time-distribution", distribution()),
        ("expected-running-time", expectation()),
        ("performance-profiles", profile("ratio", "ratio to the fewest evaluations")),
        ("data-profiles", profile("simplex gradients", "simplex gradients")),
        ("final-costs", costs(8, 0.05)),
        ("final-costs-wide", costs(8, 3.0)),
        ("final-costs-alone", costs(1, 0.5)),
        ("effect-sizes", effects(5)),
        ("effect-sizes-crowd", effects(20)),
        ("critical-difference", differences(4)),
        ("critical-difference-crowd", differences(20)),
    ]
}

#[test]
fn charts_look_as_stored() {
    check(&charts());
}

#[test]
fn a_table_without_its_columns_is_an_error() {
    let frame = df!("group" => ["a"], "optimiser" => ["pso"]).unwrap();
    assert!(curves(&frame, "group", "evaluations", &["median"]).is_err());
}
