//! Which optimiser ends lower: distributions of final costs, and every two beside each other.

use polars::prelude::DataFrame;

use super::curves::{MOST_PANELS, reals, texts};
use super::looks::Looks;
use crate::analysis::ALPHA;
use crate::analysis::statistics::quantile;
use crate::figure::axis::Axis;
use crate::figure::marks::Mark;
use crate::figure::panel::{MARGIN, Panel, range};
use crate::figure::sheet::{Anchor, fitted};
use crate::figure::style::{COLOURS, GRID, PAPER, Stroke, Width, mix};
use crate::figure::{Figure, FigureError};

/// Final costs below are drawn at the axis's lower end.
const LOWEST: f64 = 1e-10;
/// Most runs of a box that are drawn one by one, and where there is one optimiser alone.
const MOST_POINTS: usize = 30;
const MOST_POINTS_ALONE: usize = 200;
/// Costs further apart than this have a logarithmic axis.
const WIDE: f64 = 8.0;
/// Half the least width of an axis, as a share of the costs.
const NARROW: f64 = 2e-3;
/// Height of a line \[mm\], and where there is one optimiser alone.
const ROW: f64 = 4.6;
const ROW_ALONE: f64 = 9.0;
/// Room for the number of failed runs, as a share of the axis.
const FOR_FAILURES: f64 = 0.45;
/// Longest name in a heat map \[mm\].
const LONGEST_NAME: f64 = 48.0;

/// The final costs of all runs, from the table `runs`: quartiles as a box, least and largest as whiskers,
/// and single runs where they are few; failed ones are counted at the end. A panel per group with a line per optimiser, or
/// for a single optimiser one panel with a line per group.
pub(super) fn final_costs(
    frame: &DataFrame,
    looks: &Looks,
    symbol: &str,
) -> Result<Option<Figure>, FigureError> {
    let (groups, optimisers) = (texts(frame, "group")?, texts(frame, "optimiser")?);
    let costs = reals(frame, &format!("best {symbol}"))?;
    let mut names: Vec<&String> = groups.iter().collect();
    names.sort();
    names.dedup();
    names.sort_by_key(|group| groups.iter().position(|g| g == *group));
    if names.len() > MOST_PANELS {
        return Ok(None);
    }
    let labels: Vec<&str> = looks.labels().collect();
    let of = |group: &String, label: &str| -> Vec<f64> {
        let rows = (0..costs.len()).filter(|&i| groups[i] == *group && optimisers[i] == label);
        let mut costs: Vec<f64> = rows.map(|i| costs[i]).collect();
        costs.sort_by(f64::total_cmp);
        costs
    };
    let alone = labels.len() == 1 && names.len() > 1;
    // One run on each of many instances is what sweeps are about.
    if alone && costs.len() <= names.len() {
        return Ok(None);
    }
    let most_points = if alone { MOST_POINTS_ALONE } else { MOST_POINTS };
    let panel = |lines: Vec<(String, Vec<f64>, Stroke)>| {
        let rows: Vec<Vec<f64>> = lines.iter().map(|(_, costs, _)| costs.clone()).collect();
        let x = cost_axis(&format!("final {symbol}"), &rows);
        let marks = lines.iter().enumerate().flat_map(|(row, (_, costs, stroke))| {
            let failed = costs.iter().filter(|cost| cost.is_infinite()).count();
            let ended = &costs[..costs.len() - failed];
            let boxed = boxed(row as f64, ended, *stroke, most_points);
            boxed.into_iter().chain(failures(row as f64, failed, &x))
        });
        let marks = marks.collect();
        let names: Vec<String> = lines.into_iter().map(|(name, ..)| name).collect();
        Panel::new(x, Axis::names("", &names).reversed(), marks)
    };
    let (panels, height) = if alone {
        let line = |group: &&String| {
            let stroke = looks.stroke(labels[0]);
            (fitted(&looks.title(group), LONGEST_NAME), of(group, labels[0]), stroke)
        };
        (vec![panel(names.iter().map(line).collect())], ROW_ALONE * names.len() as f64)
    } else {
        let lines = |group: &String| -> Vec<_> {
            let line = |&label: &&str| (label.to_owned(), of(group, label), looks.stroke(label));
            labels.iter().map(line).collect()
        };
        let panels = names.iter().map(|group| panel(lines(group)).titled(&looks.title(group)));
        (panels.collect(), ROW * labels.len() as f64)
    };
    let mut figure = Figure::grid(panels);
    figure.height = height;
    Ok(Some(figure))
}

/// An axis over the final costs of some optimisers, with room behind them where runs failed.
fn cost_axis(label: &str, rows: &[Vec<f64>]) -> Axis {
    let all = rows.iter().flatten().copied();
    let [low, high] = range(all.clone(), LOWEST);
    // Costs that are all but the same stay so.
    let (low, high) = (low - NARROW * low.abs(), high + NARROW * high.abs());
    let behind = if all.into_iter().any(f64::is_infinite) { FOR_FAILURES } else { 0.0 };
    if high / low > WIDE {
        Axis::logarithmic(label, [low, high * (high / low).powf(behind)], MARGIN)
    } else {
        Axis::linear(label, [low, high + behind * (high - low)], MARGIN)
    }
}

/// How many runs failed, at the end of the axis.
fn failures(row: f64, failed: usize, x: &Axis) -> Option<Mark> {
    let text = format!("{failed} failed");
    let at = [x.end(), row];
    (failed > 0).then_some(Mark::Label { at, text, anchor: Anchor::Right, raised: 0.0 })
}

/// A box, with single runs where they are few; finite costs in order.
fn boxed(row: f64, costs: &[f64], stroke: Stroke, most_points: usize) -> Vec<Mark> {
    if costs.is_empty() {
        return Vec::new();
    }
    let five = [0.0, 0.25, 0.5, 0.75, 1.0].map(|q| quantile(costs, q).max(LOWEST));
    let mut marks = vec![Mark::Box { stroke, height: row, five }];
    if costs.len() <= most_points {
        let aside = |i: usize| 0.18 * ((i as f64 * 0.618).fract() * 2.0 - 1.0);
        let points = costs.iter().enumerate().map(|(i, cost)| [cost.max(LOWEST), row + aside(i)]);
        let stroke = Stroke { hollow: true, ..stroke };
        marks.push(Mark::Points { name: String::new(), stroke, points: points.collect() });
    }
    marks
}

/// Vargha and Delaney's A12 of every two optimisers as a heat map, from the table `pairs`, in the order of the
/// table `ranks`: the probability that a run of the row's ends lower than one of the column's. A star marks pairs that
/// differ significantly; pairs that do not are pale.
pub(super) fn effect_sizes(pairs: &DataFrame, ranks: &DataFrame) -> Result<Figure, FigureError> {
    let order = texts(ranks, "optimiser")?;
    let place = |label: &String| order.iter().position(|name| name == label).unwrap_or_default();
    let (first, second) = (texts(pairs, "first")?, texts(pairs, "second")?);
    let (effects, p) = (reals(pairs, "A12")?, reals(pairs, "p Holm")?);
    let count = order.len();
    let points = match count {
        0..=5 => 7.0,
        6..=8 => 6.0,
        _ => 5.5,
    };
    let mut marks: Vec<Mark> =
        (0..count).map(|i| cell(i, i, GRID, String::new(), points)).collect();
    for (i, (first, second)) in first.iter().zip(&second).enumerate() {
        let (row, column) = (place(first), place(second));
        for (row, column, effect) in [(row, column, effects[i]), (column, row, 1.0 - effects[i])] {
            let is_significant = p[i] <= ALPHA;
            let star = if is_significant { "*" } else { "" };
            let text = format!("{effect:.2}{star}");
            // Where there is little room, 0.93 is .93.
            let short = text.strip_prefix('0').filter(|_| count > 8).map(ToOwned::to_owned);
            let text = short.unwrap_or(text);
            marks.push(cell(row, column, shade(effect, is_significant), text, points));
        }
    }
    let numbers: Vec<String> = (1..=count).map(|n| n.to_string()).collect();
    let names = order.iter().enumerate();
    let names: Vec<String> =
        names.map(|(i, name)| format!("{}\u{2002}{}", fitted(name, LONGEST_NAME), i + 1)).collect();
    let x = Axis::names("the row's runs end lower than the column's", &numbers);
    let panel = Panel::new(x, Axis::names("", &names).reversed(), marks);
    let width = if count > 8 { Width::Page } else { Width::Column };
    Ok(Figure { width, across: 1, height: ROW * count as f64, panels: vec![panel] })
}

fn cell(
    row: usize,
    column: usize,
    colour: plotters::style::RGBColor,
    text: String,
    points: f64,
) -> Mark {
    Mark::Cell { at: [column as f64, row as f64], colour, text, points }
}

/// Blue where the row is lower, orange where the column is.
fn shade(effect: f64, is_significant: bool) -> plotters::style::RGBColor {
    let end = if effect > 0.5 { COLOURS[0] } else { COLOURS[1] };
    let strength = (2.0 * effect - 1.0).abs() * if is_significant { 0.85 } else { 0.35 };
    mix(mix(PAPER, GRID, 0.3), end, strength)
}
