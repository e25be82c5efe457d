//! What the best motion is worth over a swept setting.

use super::best::BestMotion;
use crate::experiment::Instance;
use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::marks::{Line, Mark};
use crate::figure::panel::{MARGIN, Panel, extent, range};
use crate::figure::style::{Marker, Stroke};
use crate::reorientation::sweep::{shown, title};
use crate::reorientation::symbols::{K_B, T_F};

/// A setting that can be swept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Swept {
    /// `K_b`.
    WeightBase,
    /// Limit on rates.
    RateLimit,
    /// Limit on accelerations.
    AccelerationLimit,
    /// Limit on jerks.
    JerkLimit,
    /// Free coefficients per joint.
    Terms,
    /// Pieces of a spline.
    Pieces,
}

/// Most curves of a chart.
pub(super) const MOST_CURVES: usize = 8;

impl Swept {
    /// All of them.
    pub(super) const ALL: [Self; 6] = [
        Self::WeightBase,
        Self::RateLimit,
        Self::AccelerationLimit,
        Self::JerkLimit,
        Self::Terms,
        Self::Pieces,
    ];

    /// Its key in a file.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::WeightBase => "weight_base",
            Self::RateLimit => "rate_limit_deg_s",
            Self::AccelerationLimit => "acceleration_limit_deg_s2",
            Self::JerkLimit => "jerk_limit_deg_s3",
            Self::Terms => "terms",
            Self::Pieces => "pieces",
        }
    }

    fn label(self) -> String {
        match self {
            Self::WeightBase => format!("weight of the base {K_B}"),
            Self::RateLimit => "limit on rates [°/s]".to_owned(),
            Self::AccelerationLimit => "limit on accelerations [°/s²]".to_owned(),
            Self::JerkLimit => "limit on jerks [°/s³]".to_owned(),
            Self::Terms => "free coefficients per joint".to_owned(),
            Self::Pieces => "pieces".to_owned(),
        }
    }
}

/// The best motion at one value of a setting.
#[derive(Debug, Clone)]
pub(super) struct Point {
    /// All other settings, as charts write them.
    pub(super) others: String,
    pub(super) setting: f64,
    pub(super) cost: f64,
    /// Error of the base \[°\].
    pub(super) residual_deg: f64,
    /// Duration \[s\].
    pub(super) duration: f64,
}

/// The best motions at the values of a setting; none where an instance has none.
pub(super) fn points(best: &[BestMotion<'_>], swept: Swept) -> Vec<Point> {
    let point = |motion: &BestMotion<'_>| {
        Some(Point {
            others: others(motion.instance, swept.name()),
            setting: motion.instance.coordinate(swept.name())?.real()?,
            cost: motion.run.cost,
            residual_deg: motion.residual_deg,
            duration: motion.duration,
        })
    };
    best.iter().filter_map(point).collect()
}

/// The settings of an instance but for one, as charts write them.
pub(super) fn others(instance: &Instance, setting: &str) -> String {
    let others = instance.coordinates.iter().filter(|c| c.setting != setting);
    let titles = others.map(|c| title(&c.setting, &shown(&c.value)));
    titles.collect::<Vec<_>>().join(" ")
}

/// The best motions over one setting; one curve for each combination of the others.
struct Sweep {
    names: Vec<String>,
    /// Setting, cost, residual \[°\] and duration \[s\], by curve.
    curves: Vec<Vec<[f64; 4]>>,
}

impl Sweep {
    /// None where the setting does not vary, or other settings give too many curves.
    fn of(points: &[Point]) -> Option<Self> {
        let mut sweep = Self { names: Vec::new(), curves: Vec::new() };
        for point in points {
            let curve = sweep.names.iter().position(|known| *known == point.others);
            let curve = curve.unwrap_or_else(|| {
                sweep.names.push(point.others.clone());
                sweep.curves.push(Vec::new());
                sweep.names.len() - 1
            });
            let values = [point.setting, point.cost, point.residual_deg, point.duration];
            sweep.curves[curve].push(values);
        }
        sweep.curves.iter_mut().for_each(|curve| curve.sort_by(|a, b| a[0].total_cmp(&b[0])));
        let varies = sweep.curves.iter().any(|c| c.windows(2).any(|w| w[0][0] != w[1][0]));
        (varies && sweep.curves.len() <= MOST_CURVES).then_some(sweep)
    }

    /// One of the ordinates of [`Self::curves`] over the setting.
    fn lines(&self, ordinate: usize) -> Vec<Line> {
        let lines = self.names.iter().zip(&self.curves).enumerate().map(|(i, (name, curve))| {
            let points = curve.iter().map(|values| [values[0], values[ordinate]]).collect();
            let marker = Marker::ALL[i % Marker::ALL.len()];
            let stroke = Stroke::of(i).with_marker(marker);
            let name = if self.names.len() > 1 { name.as_str() } else { "" };
            Line::new(name, stroke, points)
        });
        lines.collect()
    }

    fn settings(&self) -> [f64; 2] {
        range(self.curves.iter().flatten().map(|values| values[0]), 0.0)
    }
}

/// The best motions over one setting: over the weight of the base residual and duration, over
/// a limit the duration, over the number of terms or pieces the cost. None where the setting does not vary.
///
/// Over jerk limits a reference tells what follows while jerk alone limits the motion, `t_f ∝ j̄^(−1/3)`. `bound` is the
/// least cost whatever the number of terms, where it is known.
pub(super) fn sweep(points: &[Point], swept: Swept, bound: Option<f64>) -> Option<Figure> {
    let sweep = Sweep::of(points)?;
    let is_positive = sweep.curves.iter().flatten().all(|values| values[0] > 0.0);
    let x = match swept {
        Swept::Terms => Axis::linear(&swept.label(), sweep.settings(), MARGIN).whole(),
        _ if !is_positive => Axis::linear(&swept.label(), sweep.settings(), MARGIN),
        _ => Axis::logarithmic(&swept.label(), sweep.settings(), MARGIN),
    };
    let panel = |mut lines: Vec<Line>, reference: Option<Line>, label: &str, is_log: bool| {
        lines.splice(0..0, reference);
        let values = range(lines.iter().flat_map(|line| &line.points).map(|[_, y]| *y), 1e-12);
        let y = if is_log {
            Axis::logarithmic(label, values, MARGIN)
        } else {
            Axis::linear(label, extent(&lines), MARGIN)
        };
        Panel::new(x.clone(), y, lines.into_iter().map(Mark::Line).collect())
    };
    let figure = match swept {
        Swept::WeightBase => {
            let panels = vec![
                panel(sweep.lines(2), None, "residual [°]", false),
                panel(sweep.lines(3), None, &duration(), false),
            ];
            Figure::column(panels, 30.0)
        }
        Swept::Terms => {
            let level = |j| Line::level("free form, least found", j, sweep.settings());
            let bound = bound.filter(|_| sweep.curves.len() == 1).map(level);
            Figure::column(vec![panel(sweep.lines(1), bound, "best J", false)], 44.0)
        }
        Swept::Pieces => Figure::column(vec![panel(sweep.lines(1), None, "best J", false)], 44.0),
        Swept::JerkLimit => {
            let law = cube_root_law(&sweep);
            Figure::column(vec![panel(sweep.lines(3), law, &duration(), true)], 44.0)
        }
        _ => Figure::column(vec![panel(sweep.lines(3), None, &duration(), true)], 44.0),
    };
    Some(figure)
}

/// `t_f ∝ j̄^(−1/3)` from the lowest limit on, for one curve alone.
fn cube_root_law(sweep: &Sweep) -> Option<Line> {
    let [curve] = &sweep.curves[..] else { return None };
    let (first, last) = (curve.first()?, curve.last()?);
    let law = format!("{T_F} as the jerk limit to the power −1/3");
    let at = |jerk: f64| [jerk, first[3] * (jerk / first[0]).powf(-1.0 / 3.0)];
    Some(Line::new(&law, Stroke::reference(), vec![at(first[0]), at(last[0])]))
}

/// The label of an axis of durations.
pub(super) fn duration() -> String {
    format!("duration {T_F} [s]")
}
