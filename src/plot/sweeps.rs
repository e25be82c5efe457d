//! What the best motion is worth over a swept setting.

use polars::prelude::DataFrame;

use super::axis::Axis;
use super::curves::{range, reals, texts};
use super::figure::{Figure, PlotError};
use super::marks::{Line, Mark};
use super::panel::{MARGIN, Panel, extent};
use super::sheet::{K_B, T_F, titled};
use super::style::{Marker, Stroke};

/// A setting that can be swept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Swept {
    /// `K_b`.
    WeightBase,
    /// Limit on rates.
    RateLimit,
    /// Limit on accelerations.
    AccelerationLimit,
    /// Limit on jerks.
    JerkLimit,
    /// Free coefficients a joint.
    Terms,
}

/// Most curves of a chart.
pub(super) const MOST_CURVES: usize = 8;

impl Swept {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::WeightBase, Self::RateLimit, Self::AccelerationLimit, Self::JerkLimit, Self::Terms];

    /// The column of the table `best`, and the name in an instance's label.
    pub fn column(self) -> &'static str {
        match self {
            Self::WeightBase => "weight_base",
            Self::RateLimit => "rate_limit_deg_s",
            Self::AccelerationLimit => "acceleration_limit_deg_s2",
            Self::JerkLimit => "jerk_limit_deg_s3",
            Self::Terms => "terms",
        }
    }

    fn label(self) -> String {
        match self {
            Self::WeightBase => format!("weight of the base {K_B}"),
            Self::RateLimit => "limit on rates [°/s]".to_owned(),
            Self::AccelerationLimit => "limit on accelerations [°/s²]".to_owned(),
            Self::JerkLimit => "limit on jerks [°/s³]".to_owned(),
            Self::Terms => "free coefficients a joint".to_owned(),
        }
    }
}

/// The best motions over one setting; one curve for each combination of the others.
struct Sweep {
    names: Vec<String>,
    /// Setting, cost, residual \[°\] and duration \[s\], by curve.
    curves: Vec<Vec<[f64; 4]>>,
}

impl Sweep {
    /// None where the setting does not vary, or other settings give too many curves.
    fn of(best: &DataFrame, swept: Swept) -> Result<Option<Self>, PlotError> {
        if best.column(swept.column()).is_err() {
            return Ok(None);
        }
        let values = reals(best, swept.column())?;
        let columns =
            [reals(best, "best J")?, reals(best, "residual [°]")?, reals(best, "t_f [s]")?];
        let mut sweep = Self { names: Vec::new(), curves: Vec::new() };
        for (i, label) in texts(best, "instance")?.iter().enumerate() {
            let name = without(label, swept.column());
            let curve = sweep.names.iter().position(|known| *known == name);
            let curve = curve.unwrap_or_else(|| {
                sweep.names.push(name);
                sweep.curves.push(Vec::new());
                sweep.names.len() - 1
            });
            if values[i].is_finite() {
                sweep.curves[curve].push([values[i], columns[0][i], columns[1][i], columns[2][i]]);
            }
        }
        sweep.curves.iter_mut().for_each(|curve| curve.sort_by(|a, b| a[0].total_cmp(&b[0])));
        let varies = sweep.curves.iter().any(|c| c.windows(2).any(|w| w[0][0] != w[1][0]));
        Ok((varies && sweep.curves.len() <= MOST_CURVES).then_some(sweep))
    }

    /// One of the ordinates of [`Self::curves`] over the setting.
    fn lines(&self, ordinate: usize) -> Vec<Line> {
        let lines = self.names.iter().zip(&self.curves).enumerate().map(|(i, (name, curve))| {
            let points = curve.iter().map(|values| [values[0], values[ordinate]]).collect();
            let marker = Marker::ALL[i % Marker::ALL.len()];
            let stroke = Stroke::of(i).with_marker(marker);
            let name = if self.names.len() > 1 { titled(name) } else { String::new() };
            Line::new(&name, stroke, points)
        });
        lines.collect()
    }

    fn settings(&self) -> [f64; 2] {
        range(self.curves.iter().flatten().map(|values| values[0]), 0.0)
    }
}

/// The best motions over one setting, from the table `best`: over the weight of the base residual and duration, over
/// a limit the duration, over the number of terms the cost. None where the setting does not vary.
///
/// Over jerk limits a reference tells what follows while jerk alone limits the motion, `t_f ∝ j̄^(−1/3)`. `bound` is the
/// least cost whatever the number of terms, where it is known.
pub fn sweep(
    best: &DataFrame,
    swept: Swept,
    bound: Option<f64>,
) -> Result<Option<Figure>, PlotError> {
    let Some(sweep) = Sweep::of(best, swept)? else { return Ok(None) };
    let is_positive = sweep.curves.iter().flatten().all(|values| values[0] > 0.0);
    let x = match swept {
        Swept::Terms => Axis::linear(&swept.label(), sweep.settings(), MARGIN).whole(),
        _ if swept == Swept::Terms || !is_positive => {
            Axis::linear(&swept.label(), sweep.settings(), MARGIN)
        }
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
        Swept::JerkLimit => {
            let law = cube_root_law(&sweep);
            Figure::column(vec![panel(sweep.lines(3), law, &duration(), true)], 44.0)
        }
        _ => Figure::column(vec![panel(sweep.lines(3), None, &duration(), true)], 44.0),
    };
    Ok(Some(figure))
}

/// `t_f ∝ j̄^(−1/3)` from the lowest limit on, for one curve alone.
fn cube_root_law(sweep: &Sweep) -> Option<Line> {
    let [curve] = &sweep.curves[..] else { return None };
    let (first, last) = (curve.first()?, curve.last()?);
    let law = format!("{T_F} as the jerk limit to the power −1/3");
    let at = |jerk: f64| [jerk, first[3] * (jerk / first[0]).powf(-1.0 / 3.0)];
    Some(Line::new(&law, Stroke::reference(), vec![at(first[0]), at(last[0])]))
}

/// An instance's label without one of the settings that it names.
pub(super) fn without(label: &str, setting: &str) -> String {
    let is_other = |part: &&str| part.split('=').next() != Some(setting);
    label.split(' ').filter(is_other).collect::<Vec<_>>().join(" ")
}

pub(super) fn duration() -> String {
    format!("duration {T_F} [s]")
}
