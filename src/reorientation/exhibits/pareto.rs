//! What weights trade against time.

use polars::prelude::df;

use super::best::BestMotion;
use super::sweeps::{MOST_CURVES, MOST_PANELS, duration, others};
use super::words::AT_GOAL_DEG;
use crate::exhibit::Table;
use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::marks::{Line, Mark};
use crate::figure::panel::{Panel, range};
use crate::figure::sheet::Anchor;
use crate::figure::style::{Marker, Stroke};
use crate::reorientation::symbols::K_B;
use crate::task::PathLimits;

/// How far the text beside a point stands above it \[mm\].
const ABOVE_FRONT: f64 = 1.9;
/// Shares of the axes within which points are one.
const TOGETHER: f64 = 0.02;
/// Share of the axis that a line of text needs.
const LINE: f64 = 0.09;
/// Most weights that are named one by one.
const MOST_NAMED: usize = 3;

/// The best motions of one task with any weight.
#[derive(Default)]
struct Front {
    name: String,
    /// Duration \[s\], what is traded \[°\] and weight.
    efficient: Vec<[f64; 3]>,
    beaten: Vec<[f64; 3]>,
}

impl Front {
    fn all(&self) -> impl Iterator<Item = &[f64; 3]> {
        self.efficient.iter().chain(&self.beaten)
    }

    /// The staircase of what is not beaten, and the points.
    fn marks(&self, stroke: Stroke, names: [&str; 2]) -> Vec<Mark> {
        let places =
            |motions: &[[f64; 3]]| motions.iter().map(|m| [m[0], m[1]]).collect::<Vec<_>>();
        let points = |name: &str, hollow: bool, motions: &[[f64; 3]]| Mark::Points {
            name: name.to_owned(),
            stroke: Stroke { hollow, width: 0.0, ..stroke },
            points: places(motions),
        };
        let front = places(&self.efficient);
        let corner = |w: &[[f64; 2]]| [w[0], [w[1][0], w[0][1]], w[1]];
        let stairs = front.windows(2).flat_map(corner).collect();
        let reference = Stroke { colour: stroke.colour, ..Stroke::reference() };
        let mut marks = vec![Mark::Line(Line::new("", reference, stairs))];
        if !self.beaten.is_empty() {
            marks.push(points(names[1], true, &self.beaten));
        }
        marks.push(points(names[0], false, &self.efficient));
        marks
    }
}

/// What is traded against time, by a weight of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Traded {
    /// The error of the base.
    Residual,
    /// The largest turn of the base on the way.
    LargestTurn,
}

impl Traded {
    pub(super) const ALL: [Self; 2] = [Self::Residual, Self::LargestTurn];

    /// The name of chart and table.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Residual => "pareto",
            Self::LargestTurn => "turn-pareto",
        }
    }

    /// What it is called.
    pub(super) fn title(self) -> &'static str {
        match self {
            Self::Residual => "Residual",
            Self::LargestTurn => "Largest turn",
        }
    }

    pub(super) fn caption(self) -> String {
        let which = match self {
            Self::Residual => "of the best motions of all weights",
            Self::LargestTurn => "of the best motions that reach their goal",
        };
        format!(
            "{} against duration {which}. A motion is efficient if no other weight's is better in one and at least as good \
             in the other.",
            self.title()
        )
    }

    /// The setting that is its weight, and the symbol of that.
    fn weight(self) -> (&'static str, &'static str) {
        match self {
            Self::Residual => ("weight_base", K_B),
            Self::LargestTurn => ("weight_largest_turn", "w"),
        }
    }

    fn weight_of(self, motion: &BestMotion<'_>) -> f64 {
        match self {
            Self::Residual => motion.problem.task().base_weight,
            Self::LargestTurn => motion.problem.task().path.turn_weights[0],
        }
    }

    fn value_of(self, motion: &BestMotion<'_>) -> f64 {
        match self {
            Self::Residual => motion.residual_deg,
            // Where nothing was asked of it, it was not stored; and it is stored from the start, whatever it is weighed from.
            Self::LargestTurn => {
                let task = motion.problem.task();
                let turns = motion.sample(TURN_SAMPLES).base;
                let turns = turns.iter().map(|base| task.path.turn_at(task, base));
                turns.fold(0.0, f64::max).to_degrees()
            }
        }
    }

    /// Whether two motions are of the same task but for this weight.
    fn differ(self, a: &BestMotion<'_>, b: &BestMotion<'_>) -> bool {
        let (own, other) = (a.problem.task(), b.problem.task());
        let unweighed = |path: &PathLimits| {
            let [_, mean] = path.turn_weights;
            PathLimits { turn_weights: [0.0, mean], ..path.clone() }
        };
        let same = match self {
            Self::Residual => own.path == other.path,
            Self::LargestTurn => {
                own.base_weight == other.base_weight
                    && unweighed(&own.path) == unweighed(&other.path)
            }
        };
        same && self.weight_of(a) != self.weight_of(b)
            && own.start == other.start
            && own.goal == other.goal
            && own.limits == other.limits
            && a.problem.spec() == b.problem.spec()
            && own.robot == other.robot
    }

    /// The motions that are compared, if the weight varies: a turn is of no interest where the goal is missed.
    fn of<'a, 'b>(self, best: &'a [BestMotion<'b>]) -> Vec<&'a BestMotion<'b>> {
        let counts =
            |motion: &&BestMotion<'_>| self == Self::Residual || motion.residual_deg <= AT_GOAL_DEG;
        let own: Vec<_> = best.iter().filter(counts).collect();
        let varies = own.windows(2).any(|pair| self.weight_of(pair[0]) != self.weight_of(pair[1]));
        if varies { own } else { Vec::new() }
    }
}

/// The best motion of one weight.
#[derive(Debug, Clone)]
pub(super) struct Trade {
    /// All other settings, as charts write them.
    pub(super) others: String,
    pub(super) weight: f64,
    /// Duration \[s\].
    pub(super) duration: f64,
    /// What is traded \[°\].
    pub(super) value_deg: f64,
    /// Whether no other weight's motion is better in one and no worse in the other.
    pub(super) is_efficient: bool,
}

/// Angles that differ by less are the same, in degrees: searches end with residuals of some 10⁻⁶, and turns are sampled.
const SAME_DEG: f64 = 1e-5;
const SAME_TURN_DEG: f64 = 1e-3;
/// Intervals at which the largest turn is sampled.
const TURN_SAMPLES: usize = 2_000;
/// Durations that differ by a smaller share are the same.
const SAME_DURATION: f64 = 1e-6;

/// The best motions as what their weights trade; none unless the weight varies.
pub(super) fn trades(best: &[BestMotion<'_>], traded: Traded) -> Vec<Trade> {
    let same = if traded == Traded::Residual { SAME_DEG } else { SAME_TURN_DEG };
    let own = |motion| (motion, traded.value_of(motion));
    let motions: Vec<(&BestMotion<'_>, f64)> = traded.of(best).into_iter().map(own).collect();
    let dominates = |(a, own): &(&BestMotion<'_>, f64), (b, other): &(&BestMotion<'_>, f64)| {
        let no_worse = *own <= other + same && a.duration <= b.duration * (1.0 + SAME_DURATION);
        let better = *own < other - same || a.duration < b.duration * (1.0 - SAME_DURATION);
        traded.differ(a, b) && no_worse && better
    };
    let trade = |own: &(&BestMotion<'_>, f64)| Trade {
        others: others(own.0.instance, &[traded.weight().0]).join(", "),
        weight: traded.weight_of(own.0),
        duration: own.0.duration,
        value_deg: own.1,
        is_efficient: !motions.iter().any(|other| dominates(other, own)),
    };
    motions.iter().map(trade).collect()
}

/// The table of the trades; none where there are none.
pub(super) fn table(best: &[BestMotion<'_>], traded: Traded) -> Option<Table> {
    let (motions, trades) = (traded.of(best), trades(best, traded));
    let value = format!("{} [°]", traded.title().to_lowercase());
    let numbers = |of: fn(&Trade) -> f64| trades.iter().map(of).collect::<Vec<_>>();
    let frame = df!(
        "instance" => motions.iter().map(|motion| motion.instance.label.as_str()).collect::<Vec<_>>(),
        traded.weight().0 => numbers(|trade| trade.weight),
        value.as_str() => numbers(|trade| trade.value_deg),
        "t_f [s]" => numbers(|trade| trade.duration),
        "efficient" => trades.iter().map(|trade| trade.is_efficient).collect::<Vec<_>>(),
    );
    let frame = frame.ok().filter(|_| !trades.is_empty())?;
    Some(Table::of(traded.name(), traded.caption(), frame))
}

/// The fronts of the trades, each in the order of its durations.
fn fronts(trades: &[Trade]) -> Vec<Front> {
    let mut fronts: Vec<Front> = Vec::new();
    for trade in trades {
        let place = fronts.iter().position(|front| front.name == trade.others);
        let place = place.unwrap_or_else(|| {
            fronts.push(Front { name: trade.others.clone(), ..Front::default() });
            fronts.len() - 1
        });
        let front = &mut fronts[place];
        let motions = if trade.is_efficient { &mut front.efficient } else { &mut front.beaten };
        motions.push([trade.duration, trade.value_deg, trade.weight]);
    }
    for front in &mut fronts {
        front.efficient.sort_by(|a, b| a[0].total_cmp(&b[0]));
    }
    fronts
}

/// What is traded against duration, of the best motions of all weights: a front for each task but for its weight; filled points
/// are efficient. Of a single front weights stand beside points where there is room; more than a few have panels of their
/// own. None where there are no trades or too many fronts.
pub(super) fn pareto(trades: &[Trade], traded: Traded) -> Option<Figure> {
    let fronts = fronts(trades);
    if fronts.is_empty() || fronts.len() > MOST_PANELS {
        return None;
    }
    let values = |k: usize| range(fronts.iter().flat_map(Front::all).map(|motion| motion[k]), 0.0);
    let x = Axis::linear(&duration(), values(0), 0.12);
    let y = Axis::linear(&format!("{} [°]", traded.title().to_lowercase()), values(1), 0.08);
    let alone = ["efficient", "beaten by another weight"];
    let stroke = |i: usize| Stroke::of(i).with_marker(Marker::ALL[i % Marker::ALL.len()]);
    if fronts.len() > MOST_CURVES {
        let panel = |front: &Front| {
            Panel::new(x.clone(), y.clone(), front.marks(stroke(0), alone)).titled(&front.name)
        };
        return Some(Figure::grid(fronts.iter().map(panel).collect()));
    }
    let mut marks = Vec::new();
    for (i, front) in fronts.iter().enumerate() {
        let stroke = stroke(i);
        let names = if fronts.len() == 1 { alone } else { [front.name.as_str(), ""] };
        marks.extend(front.marks(stroke, names));
    }
    if fronts.len() > 1 && fronts.iter().any(|front| !front.beaten.is_empty()) {
        marks.push(Mark::Note(format!("hollow: {}", alone[1])));
    }
    if let [front] = &fronts[..] {
        let all: Vec<[f64; 3]> = front.all().copied().collect();
        marks.extend(labels(&all, traded.weight().1, &x, &y));
    }
    Some(Figure::column(vec![Panel::new(x, y, marks)], 44.0))
}

/// The weights beside points that lie on each other, where no other point is in the way.
fn labels(motions: &[[f64; 3]], symbol: &str, x: &Axis, y: &Axis) -> Vec<Mark> {
    let places: Vec<[f64; 2]> = motions.iter().map(|m| [x.place(m[0]), y.place(m[1])]).collect();
    let mut weights: Vec<f64> = motions.iter().map(|motion| motion[2]).collect();
    weights.sort_by(f64::total_cmp);
    let mut marks = Vec::new();
    for (first, own) in clusters(&places, motions) {
        let [at_x, at_y] = places[first];
        let is_right = at_x > 0.6;
        let is_free = |other: &[f64; 2]| {
            let (along, up) = (other[0] - at_x, (other[1] - at_y).abs());
            let away = if is_right { -along } else { along };
            up > LINE || away < -TOGETHER || away.abs() < TOGETHER
        };
        if places.iter().all(is_free) {
            let anchor = if is_right { Anchor::Right } else { Anchor::Left };
            let at = [motions[first][0], motions[first][1]];
            marks.push(Mark::Label {
                at,
                text: told(symbol, &own, &weights),
                anchor,
                raised: ABOVE_FRONT,
            });
        }
    }
    marks
}

/// Points that lie on each other: the first one's index, and the weights of all in order.
fn clusters(places: &[[f64; 2]], motions: &[[f64; 3]]) -> Vec<(usize, Vec<f64>)> {
    let mut clusters: Vec<(usize, Vec<f64>)> = Vec::new();
    for (i, [x, y]) in places.iter().enumerate() {
        let near = |first: usize| {
            (places[first][0] - x).abs() < TOGETHER && (places[first][1] - y).abs() < TOGETHER
        };
        match clusters.iter_mut().find(|(first, _)| near(*first)) {
            Some((_, own)) => own.push(motions[i][2]),
            None => clusters.push((i, vec![motions[i][2]])),
        }
    }
    for (_, own) in &mut clusters {
        own.sort_by(f64::total_cmp);
    }
    clusters
}

/// Some of all weights: one by one, as a range where they are all that lie in it, or how many they are.
fn told(symbol: &str, own: &[f64], all: &[f64]) -> String {
    let [low, high] = [own[0], own[own.len() - 1]];
    let between = all.iter().filter(|weight| (low..=high).contains(*weight)).count();
    if own.len() > 2 && between == own.len() {
        return format!("{symbol} = {low} to {high}");
    }
    if own.len() > MOST_NAMED {
        return format!("{} weights", own.len());
    }
    let own: Vec<String> = own.iter().map(ToString::to_string).collect();
    format!("{symbol} = {}", own.join(", "))
}
