//! Which optimiser ends lower: distributions of final costs.

use polars::prelude::DataFrame;

use super::costs::CostScale;
use super::curves::{MOST_PANELS, reals, texts};
use super::looks::Looks;
use crate::analysis::statistics::quantile;
use crate::figure::axis::Axis;
use crate::figure::marks::Mark;
use crate::figure::panel::{MARGIN, Panel};
use crate::figure::sheet::Anchor;
use crate::figure::style::{Stroke, TEXT_PT, Width};
use crate::figure::text::text_width;
use crate::figure::{Figure, FigureError};

/// Most runs of a box that are drawn one by one, and where there is one optimiser alone.
const MOST_POINTS: usize = 30;
const MOST_POINTS_ALONE: usize = 200;
/// Costs further apart than this have a logarithmic axis.
const WIDE: f64 = 8.0;
/// Half the least width of an axis, as a share of the costs.
const NARROW: f64 = 2e-3;
/// Height of a line \[mm\], with single runs below its box, and where there is one optimiser alone.
const ROW: f64 = 4.6;
const ROW_POINTS: f64 = 5.6;
const ROW_ALONE: f64 = 9.0;
/// Where a box and its single runs stand, as shares of a line's height.
const BOX_ABOVE: f64 = 0.17;
const POINTS_BELOW: f64 = 0.31;
const SCATTER: f64 = 0.05;
/// Room for the number of failed runs, as a share of the axis.
const FOR_FAILURES: f64 = 0.45;
/// Names of lines longer than this \[mm\] take the page's width.
const LONG: f64 = 40.0;

/// The final costs of all runs, from the table `runs`: quartiles as a box, least and largest as whiskers,
/// and single runs below where they are few; failed ones are counted at the end. A panel per group with a line per
/// optimiser, or for a single optimiser one panel with a line per group. Where some costs of a panel are negative and the
/// least is known, it shows what they are above that.
pub(super) fn final_costs(
    frame: &DataFrame,
    looks: &Looks,
    symbol: &str,
) -> Result<Option<Figure>, FigureError> {
    let (groups, optimisers) = (texts(frame, "group")?, texts(frame, "optimiser")?);
    let columns = [reals(frame, &format!("best {symbol}"))?, reals(frame, "gap")?];
    let mut names: Vec<&String> = groups.iter().collect();
    names.sort();
    names.dedup();
    names.sort_by_key(|group| groups.iter().position(|g| g == *group));
    if names.len() > MOST_PANELS {
        return Ok(None);
    }
    let labels: Vec<&str> = looks.labels().collect();
    // Costs and gaps, each in order.
    let of = |group: &String, label: &str| -> [Vec<f64>; 2] {
        [0, 1].map(|k| {
            let rows = (0..groups.len()).filter(|&i| groups[i] == *group && optimisers[i] == label);
            let mut costs: Vec<f64> = rows.map(|i| columns[k][i]).collect();
            costs.sort_by(f64::total_cmp);
            costs
        })
    };
    let alone = labels.len() == 1 && names.len() > 1;
    // One run on each of many instances is what sweeps are about.
    if alone && groups.len() <= names.len() {
        return Ok(None);
    }
    let most_points = if alone { MOST_POINTS_ALONE } else { MOST_POINTS };
    let panel = |lines: Vec<(String, [Vec<f64>; 2], Stroke)>| {
        let all = |k: usize| lines.iter().flat_map(move |(_, costs, _)| costs[k].iter().copied());
        let are_gaps = all(0).any(|cost| cost < 0.0) && all(1).all(|gap| !gap.is_nan());
        let (k, what) = if are_gaps { (1, " − least known") } else { (0, "") };
        let (x, scale) = cost_axis(&format!("final {symbol}{what}"), all(k));
        let marks = lines.iter().enumerate().flat_map(|(row, (_, costs, stroke))| {
            let costs: Vec<f64> = costs[k].iter().map(|cost| scale.drawn(*cost)).collect();
            let failed = costs.iter().filter(|cost| cost.is_infinite()).count();
            let ended = &costs[..costs.len() - failed];
            let boxed = boxed(row as f64, ended, *stroke, most_points);
            boxed.into_iter().chain(failures(row as f64, failed, &x))
        });
        let cut = scale.cut_across([-0.5, lines.len() as f64 - 0.5]);
        let marks = cut.into_iter().chain(marks).collect();
        let names: Vec<String> = lines.into_iter().map(|(name, ..)| name).collect();
        Panel::new(x, Axis::names("", &names).reversed(), marks)
    };
    let (panels, height) = if alone {
        let line = |group: &&String| {
            let stroke = looks.stroke(labels[0]);
            (looks.title(group), of(group, labels[0]), stroke)
        };
        (vec![panel(names.iter().map(line).collect())], ROW_ALONE * names.len() as f64)
    } else {
        let lines = |group: &String| -> Vec<_> {
            let name = |label: &str| looks.name(label).to_owned();
            let line = |&label: &&str| (name(label), of(group, label), looks.stroke(label));
            labels.iter().map(line).collect()
        };
        let panels = names.iter().map(|group| panel(lines(group)).titled(&looks.title(group)));
        let has_points =
            |group: &&String| labels.iter().any(|label| of(group, label)[0].len() <= MOST_POINTS);
        let row = if names.iter().any(has_points) { ROW_POINTS } else { ROW };
        (panels.collect(), row * labels.len() as f64)
    };
    let mut figure = Figure::grid(panels);
    let mut told = labels.iter().map(|label| looks.name(label));
    if !alone && told.any(|name| text_width(name, TEXT_PT) > LONG) {
        figure.width = Width::Page;
    }
    figure.height = height;
    Ok(Some(figure))
}

/// An axis over the final costs of some optimisers, with room behind them where runs failed.
fn cost_axis(label: &str, all: impl Iterator<Item = f64> + Clone) -> (Axis, CostScale) {
    let scale = CostScale::of(all.clone());
    let [low, high] = scale.range;
    // Costs that are all but the same stay so.
    let (low, high) = (low - NARROW * low.abs(), high + NARROW * high.abs());
    let behind = if all.into_iter().any(f64::is_infinite) { FOR_FAILURES } else { 0.0 };
    if scale.is_logarithmic && (scale.is_cut || high / low > WIDE) {
        let high = high * (high / low).powf(behind);
        (Axis::logarithmic(label, [low, high], MARGIN).cut(scale.is_cut), scale)
    } else {
        let axis = Axis::linear(label, [low, high + behind * (high - low)], MARGIN);
        (axis, CostScale { is_logarithmic: false, is_cut: false, ..scale })
    }
}

/// How many runs failed, at the end of the axis.
fn failures(row: f64, failed: usize, x: &Axis) -> Option<Mark> {
    let text = format!("{failed} failed");
    let at = [x.end(), row];
    (failed > 0).then_some(Mark::Label { at, text, anchor: Anchor::Right, raised: 0.0 })
}

/// A box, with single runs below it where they are few; finite costs in order.
fn boxed(row: f64, costs: &[f64], stroke: Stroke, most_points: usize) -> Vec<Mark> {
    if costs.is_empty() {
        return Vec::new();
    }
    let five = [0.0, 0.25, 0.5, 0.75, 1.0].map(|q| quantile(costs, q));
    if costs.len() > most_points {
        return vec![Mark::Box { stroke, height: row, five }];
    }
    // Rows count downwards.
    let place = |i: usize| row + POINTS_BELOW + SCATTER * ((i as f64 * 0.618).fract() * 2.0 - 1.0);
    let points = costs.iter().enumerate().map(|(i, cost)| [*cost, place(i)]).collect();
    let hollow = Stroke { hollow: true, ..stroke };
    vec![
        Mark::Box { stroke, height: row - BOX_ABOVE, five },
        Mark::Points { name: String::new(), stroke: hollow, points },
    ]
}
