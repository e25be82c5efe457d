//! One pair of axes with its lines.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::figure::PlotError;
use super::style::{FONT, GRID, INK, Stroke, text_size, units};

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Room above and to the right of the axes, and for a title \[mm\].
const TOP: f64 = 1.2;
const TITLE: f64 = 3.6;
const RIGHT: f64 = 2.0;

/// One pair of axes with its lines.
#[derive(Debug, Clone)]
pub(super) struct Panel {
    /// Stands above the axes, unless empty.
    pub(super) title: String,
    pub(super) x: Axis,
    pub(super) y: Axis,
    /// Drawn first, lightly filled.
    pub(super) bands: Vec<Band>,
    pub(super) lines: Vec<Line>,
}

/// An axis; a logarithmic one holds decimal logarithms.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    label: String,
    range: [f64; 2],
    /// Places and texts of the ticks.
    ticks: Vec<(f64, String)>,
    logarithmic: bool,
}

/// One line of a panel.
#[derive(Debug, Clone)]
pub(super) struct Line {
    /// Shown in the legend, unless empty.
    pub(super) name: String,
    pub(super) stroke: Stroke,
    pub(super) points: Vec<[f64; 2]>,
}

/// The area between two curves over the same abscissae: `[x, lower, upper]`.
#[derive(Debug, Clone)]
pub(super) struct Band {
    pub(super) colour: RGBColor,
    pub(super) points: Vec<[f64; 3]>,
}

/// Most powers of ten that are labelled on a logarithmic axis.
const MOST_DECADES: f64 = 8.0;

impl Axis {
    /// A linear axis over a range and a little more on both sides, as a share of its width.
    pub(super) fn linear(label: &str, [low, high]: [f64; 2], more: f64) -> Self {
        let more = more * (high - low);
        let (low, high) = (low - more, high + more);
        let step = tick_step(high - low);
        let first = (low / step - 1e-9).ceil() as i64;
        let last = (high / step + 1e-9).floor() as i64;
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        let ticks = (first..=last).map(|i| i as f64 * step);
        Self {
            label: label.to_owned(),
            range: [low, high],
            ticks: ticks.map(|t| (t, number(t, decimals))).collect(),
            logarithmic: false,
        }
    }

    /// A logarithmic axis over a range of positive values and a little more on both sides, as a
    /// share of its width.
    pub(super) fn logarithmic(label: &str, [low, high]: [f64; 2], more: f64) -> Self {
        let more = (high / low).powf(more);
        let (low, high) = (low / more, high * more);
        let decades = (high / low).log10();
        let mantissas: &[f64] = match decades {
            d if d < 0.7 => &[1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0],
            d if d < 2.5 => &[1.0, 2.0, 5.0],
            _ => &[1.0],
        };
        let every = ((decades / MOST_DECADES).ceil() as i32).max(1);
        let exponents = low.log10().floor() as i32..=high.log10().ceil() as i32;
        let ticks = exponents
            .flat_map(|e| mantissas.iter().map(move |&m| (m, e)))
            .filter(|&(m, e)| (low..=high * (1.0 + 1e-9)).contains(&(m * 10_f64.powi(e))))
            .filter(|(_, e)| e % every == 0)
            .map(|(m, e)| (m.log10() + f64::from(e), power(m, e)));
        Self {
            label: label.to_owned(),
            range: [low.log10(), high.log10()],
            ticks: ticks.collect(),
            logarithmic: true,
        }
    }

    /// A value's place on the axis.
    fn place(&self, value: f64) -> f64 {
        let place = if self.logarithmic { value.log10() } else { value };
        place.clamp(self.range[0], self.range[1])
    }

    fn tick_text(&self, place: f64) -> String {
        let tick = self.ticks.iter().find(|(p, _)| (p - place).abs() < 1e-9);
        tick.map_or_else(String::new, |(_, text)| text.clone())
    }

    /// Width of the widest tick text, in characters.
    fn tick_characters(&self) -> usize {
        self.ticks.iter().map(|(_, text)| text.chars().count()).max().unwrap_or(0)
    }
}

impl Ranged for Axis {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (low, high): (i32, i32)) -> i32 {
        let fraction = (value - self.range[0]) / (self.range[1] - self.range[0]);
        low + (fraction * f64::from(high - low)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            return Vec::new();
        }
        self.ticks.iter().map(|(place, _)| *place).collect()
    }

    fn range(&self) -> Range<f64> {
        self.range[0]..self.range[1]
    }
}

/// A step of 1, 2 or 5 times a power of ten that makes up to nine intervals.
fn tick_step(width: f64) -> f64 {
    let rough = if width > 0.0 { width / 9.0 } else { 1.0 };
    let power = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().find(|m| m * power >= rough).unwrap_or(10.0);
    step * power
}

/// A number with a true minus sign.
fn number(value: f64, decimals: usize) -> String {
    let value = if value.abs() < 1e-12 { 0.0 } else { value };
    format!("{value:.decimals$}").replace('-', "−")
}

/// `mantissa · 10^exponent`, written out where that is short.
fn power(mantissa: f64, exponent: i32) -> String {
    let value = mantissa * 10_f64.powi(exponent);
    if (-3..4).contains(&exponent) {
        let decimals =
            (-exponent).max(0) as usize + usize::from(mantissa.fract() != 0.0 && exponent < 1);
        return number(value, decimals);
    }
    let raised = |c: char| match c.to_digit(10) {
        Some(digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(digit as usize).unwrap_or(c),
        // The font has no raised minus sign; its macron looks like one.
        None => '¯',
    };
    let digits: String = exponent.to_string().chars().map(raised).collect();
    if mantissa == 1.0 { format!("10{digits}") } else { format!("{mantissa}·10{digits}") }
}

/// Room that the horizontal axis needs \[mm\].
fn below(with_label: bool) -> f64 {
    if with_label { 8.0 } else { 4.4 }
}

impl Line {
    /// Values at given times.
    pub(super) fn over_time(
        name: &str,
        stroke: Stroke,
        time: &[f64],
        values: impl Iterator<Item = f64>,
    ) -> Self {
        let points = time.iter().zip(values).map(|(t, v)| [*t, v]).collect();
        Self { name: name.to_owned(), stroke, points }
    }

    /// A reference at one height, from time zero to `end`.
    pub(super) fn level(name: &str, height: f64, end: f64) -> Self {
        let points = vec![[0.0, height], [end, height]];
        Self { name: name.to_owned(), stroke: Stroke::reference(), points }
    }
}

/// Free share of a vertical axis above and below its lines.
pub(super) const MARGIN: f64 = 0.04;

/// The smallest and the largest ordinate of all lines.
pub(super) fn extent(lines: &[Line]) -> [f64; 2] {
    let values = lines.iter().flat_map(|line| line.points.iter().map(|[_, y]| *y));
    let [low, high] =
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], y| [l.min(y), h.max(y)]);
    if high - low > 1e-9 { [low, high] } else { [low - 1.0, high + 1.0] }
}

impl Panel {
    /// Draws the panel; `left` is the room for the vertical axis \[mm\].
    pub(super) fn draw(
        &self,
        area: &Area<'_>,
        left: f64,
        with_x_label: bool,
    ) -> Result<(), PlotError> {
        let mut chart = ChartBuilder::on(area)
            .margin_top(units(self.top()))
            .margin_right(units(RIGHT))
            .set_label_area_size(LabelAreaPosition::Left, units(left))
            .set_label_area_size(LabelAreaPosition::Bottom, units(below(with_x_label)))
            .build_cartesian_2d(self.x.clone(), self.y.clone())?;
        let text = (FONT, text_size()).into_font().color(&INK);
        let axis = INK.stroke_width(units(0.2).unsigned_abs());
        let mut mesh = chart.configure_mesh();
        mesh.bold_line_style(GRID.stroke_width(units(0.12).unsigned_abs()))
            .light_line_style(TRANSPARENT)
            .axis_style(axis)
            .label_style(text.clone())
            .set_all_tick_mark_size(units(0.8));
        let (x_text, y_text) = (|v: &f64| self.x.tick_text(*v), |v: &f64| self.y.tick_text(*v));
        mesh.x_label_formatter(&x_text).y_label_formatter(&y_text).draw()?;
        for band in &self.bands {
            let lower =
                band.points.iter().map(|[x, low, _]| (self.x.place(*x), self.y.place(*low)));
            let upper =
                band.points.iter().map(|[x, _, high]| (self.x.place(*x), self.y.place(*high)));
            let outline: Vec<_> = lower.chain(upper.rev()).collect();
            chart.draw_series([Polygon::new(outline, band.colour.mix(0.18).filled())])?;
        }
        for line in &self.lines {
            self.draw_line(&mut chart, line)?;
        }
        self.draw_labels(area, left, with_x_label)
    }

    fn draw_line(
        &self,
        chart: &mut ChartContext<'_, SVGBackend<'_>, Cartesian2d<Axis, Axis>>,
        line: &Line,
    ) -> Result<(), PlotError> {
        let points = line.points.iter().map(|[x, y]| (self.x.place(*x), self.y.place(*y)));
        let points: Vec<_> = points.collect();
        let style = line.stroke.shape();
        match line.stroke.dash {
            None => chart.draw_series(LineSeries::new(points, style))?,
            Some((dash, gap)) => {
                let (dash, gap) = (units(dash), units(gap));
                chart.draw_series(DashedLineSeries::new(points, dash, gap, style))?
            }
        };
        Ok(())
    }

    /// Axis labels, placed by hand: plotters would put them against the edge of the figure.
    fn draw_labels(&self, area: &Area<'_>, left: f64, with_x_label: bool) -> Result<(), PlotError> {
        let (width, height) = area.dim_in_pixel();
        let (width, height) = (width.cast_signed(), height.cast_signed());
        let text = (FONT, text_size()).into_font().color(&INK);
        let below = units(below(with_x_label));
        if with_x_label {
            let middle = units(left) + (width - units(left) - units(RIGHT)) / 2;
            let style = text.clone().pos(Pos::new(HPos::Center, VPos::Bottom));
            area.draw_text(&self.x.label, &style, (middle, height - units(0.3)))?;
        }
        let style = text.clone().pos(Pos::new(HPos::Left, VPos::Top));
        area.draw_text(&self.title, &style, (units(left), units(0.4)))?;
        let top = units(self.top());
        let middle = top + (height - below - top) / 2;
        let style = text.transform(FontTransform::Rotate270).pos(Pos::new(HPos::Center, VPos::Top));
        area.draw_text(&self.y.label, &style, (units(0.3), middle))?;
        Ok(())
    }

    /// Room above the axes \[mm\].
    fn top(&self) -> f64 {
        if self.title.is_empty() { TOP } else { TOP + TITLE }
    }

    /// Room that the vertical axis needs \[mm\]: its label, its tick texts, its ticks.
    pub(super) fn left(&self) -> f64 {
        5.2 + 1.55 * self.y.tick_characters() as f64
    }
}
