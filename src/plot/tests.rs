//! Every chart drawn from fixed data.

use std::collections::HashSet;
use std::sync::Arc;

use plotters::style::RGBColor;
use polars::prelude::*;

use super::charts::left_out;
use super::convergence::convergence;
use super::critical_difference::critical_difference;
use super::curves::curves;
use super::dimensions::dimensions;
use super::effect_sizes::effect_sizes;
use super::final_costs::final_costs;
use super::looks::Looks;
use super::running_times::{expected_running_time, profiles, running_time_distribution};
use crate::analysis::handmade::plan_on;
use crate::experiment::{Entrant, Registry, Run};
use crate::figure::Figure;
use crate::figure::stored_pictures::{check, texts};
use crate::functions::Functions;
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

/// A sweep over three settings of one optimiser, beside two settings that all have.
fn swept() -> Vec<Entrant> {
    let values = [("1.5", "1.5"), ("1.5", "2.5"), ("2.5", "1.5"), ("2.5", "2.5")];
    let values = values.into_iter().flat_map(|(a, b)| ["0.05", "0.1"].map(|c| (a, b, c)));
    let label = |(a, b, c)| {
        let label =
            format!("pso population=25 last=0.4 cognitive={a} social={b} velocity_limit={c}");
        Entrant::from(Settings::by_name("pso").unwrap()).labelled(&label)
    };
    values.map(label).collect()
}

/// Labels that differ where they are cut, with characters that no drawing can have.
fn unlike() -> Vec<Entrant> {
    let long = "a label that somebody gave without a thought for those who read it, ".repeat(3);
    let label = |end: &str| {
        let label = format!("{long}{end}\u{1}\u{FFFF}");
        Entrant::from(Settings::by_name("de").unwrap()).labelled(&label)
    };
    ["variant A", "variant B", "variant C"].map(label).to_vec()
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
        "gap quartile 1" => real(rows().map(|_| f64::NAN)),
        "gap median" => real(rows().map(|_| f64::NAN)),
        "gap quartile 3" => real(rows().map(|_| f64::NAN)),
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
    costs_of(&field(count), spread)
}

fn costs_of(field: &[Entrant], spread: f64) -> Figure {
    let labels = labels(field);
    let seeds: Vec<f64> = (0..15).map(f64::from).collect();
    let rows = || rows(&["a", "b"], &labels, &seeds);
    let cost = |i: usize, x: f64| 0.8 * (1.0 + spread * (i as f64 + (7.0 * x).sin().abs()));
    let frame = df!(
        "group" => rows().map(|r| r.0).collect::<Vec<_>>(),
        "optimiser" => rows().map(|r| r.2).collect::<Vec<_>>(),
        "best J" => real(rows().map(|(_, i, _, x)| {
            if i > 5 && x > 11.0 { f64::INFINITY } else { cost(i, x) }
        })),
        "gap" => real(rows().map(|_| f64::NAN)),
    );
    final_costs(&frame.unwrap(), &Looks::of(field), "J").unwrap().unwrap()
}

/// Costs `r² − 100` whose least is not known and is known, and `r²` with an end at zero, in panels of their own: the costs,
/// what they are above −100 and the symbol's column with `also`.
fn signs() -> [(&'static str, f64, f64); 3] {
    [("unknown", 100.0, f64::NAN), ("known", 100.0, 100.0), ("zero", 0.0, 0.0)]
}

/// `r²` after so many evaluations.
fn square(i: usize, x: f64) -> f64 {
    if x > 1e4 { 0.0 } else { 50.0 * (-(1.0 + i as f64) * x.ln()).exp() }
}

fn convergence_below_zero() -> Figure {
    let field = field(3);
    let labels = labels(&field);
    let evaluations: Vec<f64> = (0..42).map(|i| 10_f64.powf(f64::from(i) / 10.0).round()).collect();
    let panels = signs().map(|(name, ..)| name);
    let rows = || rows(&panels, &labels, &evaluations);
    let sign = |panel: &str| signs().into_iter().find(|sign| sign.0 == panel).unwrap();
    let cost = |r: (&str, usize, &str, f64), times: f64| times * square(r.1, r.3) - sign(r.0).1;
    let gap = |r: (&str, usize, &str, f64), times: f64| cost(r, times) + sign(r.0).2;
    let frame = df!(
        "group" => rows().map(|r| r.0).collect::<Vec<_>>(),
        "optimiser" => rows().map(|r| r.2).collect::<Vec<_>>(),
        "evaluations" => real(rows().map(|r| r.3)),
        "quartile 1" => real(rows().map(|r| cost(r, 0.5))),
        "median" => real(rows().map(|r| cost(r, 1.0))),
        "quartile 3" => real(rows().map(|r| cost(r, 3.0))),
        "gap quartile 1" => real(rows().map(|r| gap(r, 0.5))),
        "gap median" => real(rows().map(|r| gap(r, 1.0))),
        "gap quartile 3" => real(rows().map(|r| gap(r, 3.0))),
    );
    convergence(&frame.unwrap(), &Looks::of(&field), "f").unwrap().unwrap()
}

fn costs_below_zero() -> Figure {
    let field = field(3);
    let labels = labels(&field);
    let seeds: Vec<f64> = (0..10).map(f64::from).collect();
    let panels = signs().map(|(name, ..)| name);
    let rows = || rows(&panels, &labels, &seeds);
    let sign = |panel: &str| signs().into_iter().find(|sign| sign.0 == panel).unwrap();
    let cost = |r: (&str, usize, &str, f64)| square(r.1, 3.0_f64.powf(r.3)) - sign(r.0).1;
    let frame = df!(
        "group" => rows().map(|r| r.0).collect::<Vec<_>>(),
        "optimiser" => rows().map(|r| r.2).collect::<Vec<_>>(),
        "best f" => real(rows().map(cost)),
        "gap" => real(rows().map(|r| cost(r) + sign(r.0).2)),
    );
    final_costs(&frame.unwrap(), &Looks::of(&field), "f").unwrap().unwrap()
}

/// A budget of one evaluation.
fn one_evaluation() -> Figure {
    let field = field(3);
    let labels = labels(&field);
    let rows = || rows(&[""], &labels, &[1.0]);
    let cost = |i: usize, k: f64| (1.0 + i as f64) * k;
    let frame = df!(
        "group" => rows().map(|r| r.0).collect::<Vec<_>>(),
        "optimiser" => rows().map(|r| r.2).collect::<Vec<_>>(),
        "evaluations" => real(rows().map(|r| r.3)),
        "quartile 1" => real(rows().map(|r| cost(r.1, 2.0))),
        "median" => real(rows().map(|r| cost(r.1, 3.0))),
        "quartile 3" => real(rows().map(|r| cost(r.1, 4.0))),
        "gap quartile 1" => real(rows().map(|_| f64::NAN)),
        "gap median" => real(rows().map(|_| f64::NAN)),
        "gap quartile 3" => real(rows().map(|_| f64::NAN)),
    );
    convergence(&frame.unwrap(), &Looks::of(&field), "J").unwrap().unwrap()
}

/// Three targets reached, by one optimiser each.
fn few_expectations() -> Figure {
    let field = field(3);
    let labels = labels(&field);
    let rows = || rows(&[""], &labels, &[100.0, 63.1, 39.8]);
    let time = |i: usize, x: f64| {
        let own = [100.0, 63.1, 39.8][i];
        if (x - own).abs() < 1.0 { 10.0 + 3.0 * i as f64 } else { f64::INFINITY }
    };
    let frame = df!(
        "group" => rows().map(|r| r.0).collect::<Vec<_>>(),
        "optimiser" => rows().map(|r| r.2).collect::<Vec<_>>(),
        "above least" => real(rows().map(|r| r.3)),
        "expected running time" => real(rows().map(|(_, i, _, x)| time(i, x))),
    );
    expected_running_time(&frame.unwrap(), &Looks::of(&field), "J").unwrap().unwrap()
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

fn ranks(field: &[Entrant]) -> DataFrame {
    let count = field.len();
    let means: Vec<f64> = (0..count).map(|i| 1.1 + 0.9 * i as f64).collect();
    let cliques: Vec<String> =
        (0..count).map(|i| format!("{} {}", i / 3 + 1, (i + 1) / 3 + 1)).collect();
    df!("optimiser" => labels(field), "mean rank" => means, "cliques" => cliques).unwrap()
}

fn differences(field: &[Entrant]) -> Figure {
    critical_difference(&ranks(field), &Looks::of(field)).unwrap()
}

fn effects(field: &[Entrant]) -> Figure {
    let count = field.len();
    let labels = labels(field);
    let pairs = || (0..count).flat_map(|i| (i + 1..count).map(move |j| (i, j)));
    let frame = df!(
        "first" => pairs().map(|(i, _)| labels[i]).collect::<Vec<_>>(),
        "second" => pairs().map(|(_, j)| labels[j]).collect::<Vec<_>>(),
        "A12" => real(pairs().map(|(i, j)| 0.5 + 0.5 * (j - i) as f64 / count as f64)),
        "p Holm" => real(pairs().map(|(i, j)| if j - i > 2 { 0.01 } else { 0.2 })),
    );
    effect_sizes(&frame.unwrap(), &ranks(field), &Looks::of(field)).unwrap()
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
        ("convergence-below-zero", convergence_below_zero()),
        ("convergence-one-evaluation", one_evaluation()),
        ("dimensions", growth(5)),
        ("running-time-distribution", distribution()),
        ("expected-running-time", expectation()),
        ("expected-running-time-few", few_expectations()),
        ("performance-profiles", profile("ratio", "ratio to the fewest evaluations")),
        ("data-profiles", profile("simplex gradients", "simplex gradients")),
        ("final-costs", costs(8, 0.05)),
        ("final-costs-wide", costs(8, 3.0)),
        ("final-costs-alone", costs(1, 0.5)),
        ("final-costs-below-zero", costs_below_zero()),
        ("final-costs-swept", costs_of(&swept(), 0.05)),
        ("effect-sizes", effects(&field(5))),
        ("effect-sizes-crowd", effects(&field(20))),
        ("effect-sizes-swept", effects(&swept())),
        ("critical-difference", differences(&field(4))),
        ("critical-difference-crowd", differences(&field(20))),
        ("critical-difference-swept", differences(&swept())),
    ]
}

#[test]
fn charts_look_as_stored() {
    check(&charts());
}

/// Eight combinations of a sweep, and labels that differ where they are cut: no two look the same.
#[test]
fn optimisers_can_be_told_apart() {
    for (field, what) in [(swept(), "swept"), (unlike(), "unlike")] {
        for figure in [costs_of(&field, 0.05), effects(&field), differences(&field)] {
            let texts = texts(figure.tree().unwrap().root());
            let names = texts.iter().map(|(text, _)| text.as_str());
            let names: Vec<&str> = names.filter(|t| t.contains("pso") || t.contains('…')).collect();
            let distinct: HashSet<&str> = names.iter().copied().collect();
            assert!(names.len() >= field.len(), "{what}: {names:?}");
            assert_eq!(distinct.len(), field.len(), "{what}: {names:?}");
            for setting in ["population", "last="] {
                assert!(names.iter().all(|name| !name.contains(setting)), "{what}: {names:?}");
            }
        }
    }
}

/// In the field's order, from the first again where there are too few.
#[test]
fn optimisers_take_the_colours_asked_for() {
    let field = field(5);
    let looks = Looks::new(&field, &[], &[[255, 0, 0], [0, 0, 255]]);
    let colours = labels(&field).into_iter().map(|label| looks.stroke(label).colour);
    let [red, blue] = [RGBColor(255, 0, 0), RGBColor(0, 0, 255)];
    assert_eq!(colours.collect::<Vec<_>>(), [red, blue, red, blue, red]);
}

/// 25 dimensions of a function are 25 groups, of which those with stored runs count.
#[test]
fn charts_left_out_for_their_groups_are_told() {
    let dimensions: Vec<String> = (2..27).map(|dimension| dimension.to_string()).collect();
    let plan = plan_on(
        &format!(
            "seeds = 1\nbudget = {{ evaluations = 9 }}\n[functions]\nname = ['sphere']\n\
             dimension = [{}]\n[[optimiser]]\nde = {{}}\n",
            dimensions.join(", ")
        ),
        &Registry::new().with(Arc::new(Functions)),
    );
    let runs: Vec<Run> = (0..25).map(|instance| Run { instance, ..Run::default() }).collect();
    assert_eq!(left_out(&plan, &runs[..24]), None);
    let told = left_out(&plan, &runs).unwrap().answer;
    assert!(told.contains("they would need 25 panels, and a chart has 24 at most"), "{told}");
}

#[test]
fn a_table_without_its_columns_is_an_error() {
    let frame = df!("group" => ["a"], "optimiser" => ["pso"]).unwrap();
    assert!(curves(&frame, "group", "evaluations", &["median"]).is_err());
}
