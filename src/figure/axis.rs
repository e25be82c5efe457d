//! An axis: its range, its scale, and ticks that have room.

use super::style::TEXT_PT;
use super::text::{fitted_apart, raised, text_width};

/// An axis; a logarithmic one holds decimal logarithms.
#[derive(Debug, Clone)]
pub(crate) struct Axis {
    pub(crate) label: String,
    /// What its ends stand for; the first end is at the left or at the bottom.
    range: [f64; 2],
    scale: Scale,
    /// Whether values below its lower end are drawn there.
    pub(crate) is_cut: bool,
}

#[derive(Debug, Clone)]
enum Scale {
    Linear,
    /// Linear, with ticks at whole numbers alone.
    Whole,
    Logarithmic,
    /// Names at 0, 1, …
    Names(Vec<String>),
}

/// Most powers of ten that are labelled on a logarithmic axis.
const MOST_DECADES: f64 = 8.0;
/// Longest name \[mm\]; a longer one is cut.
pub(crate) const LONGEST_NAME: f64 = 65.0;
/// Values that a linear axis writes out where the largest is one of them; others have a power of ten.
const WRITTEN_OUT: std::ops::Range<f64> = 1e-4..1e7;
/// Values beyond are drawn at the ends of an axis.
const LARGEST: f64 = 1e300;
/// Most intervals of a linear axis.
const MOST_INTERVALS: f64 = 9.0;

impl Axis {
    /// A linear axis over a range and a little more on both sides, as a share of its width.
    pub(crate) fn linear(label: &str, [low, high]: [f64; 2], more: f64) -> Self {
        let [low, high] = [low, high].map(|end| end.clamp(-LARGEST, LARGEST));
        let aside =
            if (0.1..1e3).contains(&low.abs()) || low == 0.0 { 0.5 } else { 0.1 * low.abs() };
        let [low, high] = if high > low { [low, high] } else { [low - aside, low + aside] };
        let more = more * (high - low);
        Self {
            label: label.to_owned(),
            range: [low - more, high + more],
            scale: Scale::Linear,
            is_cut: false,
        }
    }

    /// A logarithmic axis over a range of positive values and a little more on both sides, as a
    /// share of its width.
    pub(crate) fn logarithmic(label: &str, [low, high]: [f64; 2], more: f64) -> Self {
        let [low, high] = [low, high].map(|end| end.clamp(LARGEST.recip(), LARGEST));
        let [low, high] = if high > low { [low, high] } else { [low / 3.0, low * 3.0] };
        let (low, high) = (low.log10(), high.log10());
        let more = more * (high - low);
        let range = [low - more, high + more];
        Self { label: label.to_owned(), range, scale: Scale::Logarithmic, is_cut: false }
    }

    /// Names, the first at the left or at the bottom.
    pub(crate) fn names(label: &str, names: &[String]) -> Self {
        let names = fitted_apart(names, LONGEST_NAME);
        let range = [-0.5, names.len() as f64 - 0.5];
        Self { label: label.to_owned(), range, scale: Scale::Names(names), is_cut: false }
    }

    /// The same with ticks at whole numbers alone, where it is linear.
    pub(crate) fn whole(self) -> Self {
        Self { scale: Scale::Whole, ..self }
    }

    /// Linear over the same range, where it is logarithmic.
    pub(crate) fn make_linear(&mut self) {
        if matches!(self.scale, Scale::Logarithmic) {
            self.range = self.range.map(|end| 10_f64.powf(end).clamp(-LARGEST, LARGEST));
            self.scale = Scale::Linear;
            self.is_cut = false;
        }
    }

    /// The same with a mark at its lower end, below which values are not drawn in their places.
    pub(crate) fn cut(self, is_cut: bool) -> Self {
        Self { is_cut, ..self }
    }

    /// The other way round.
    pub(crate) fn reversed(mut self) -> Self {
        self.range.reverse();
        self
    }

    /// The value at the last end.
    pub(crate) fn end(&self) -> f64 {
        let last = self.range[1];
        if let Scale::Logarithmic = self.scale { 10_f64.powf(last) } else { last }
    }

    /// A value's place: 0 at the first end, 1 at the last; values beyond stand at the ends.
    pub(crate) fn place(&self, value: f64) -> f64 {
        let value = if let Scale::Logarithmic = self.scale { value.log10() } else { value };
        self.share(value).clamp(0.0, 1.0)
    }

    fn share(&self, position: f64) -> f64 {
        let [first, last] = self.range;
        (position - first) / (last - first)
    }

    /// Whether grid lines help.
    pub(crate) fn has_grid(&self) -> bool {
        !matches!(self.scale, Scale::Names(_))
    }

    /// Ticks on a horizontal axis of this length \[mm\]: places and texts, none touching the next.
    pub(crate) fn ticks_across(&self, length: f64) -> Vec<(f64, String)> {
        let apart = |[a, b]: [&(f64, String); 2]| {
            (b.0 - a.0).abs() * length >= 0.5 * (width(&a.1) + width(&b.1)) + 1.2
        };
        self.ticks(apart)
    }

    /// Ticks on a vertical axis of this length \[mm\].
    pub(crate) fn ticks_up(&self, length: f64) -> Vec<(f64, String)> {
        self.ticks(|[a, b]| (b.0 - a.0).abs() * length >= 3.4)
    }

    /// The densest ticks that are all apart; names are left out evenly.
    fn ticks(&self, apart: impl Fn([&(f64, String); 2]) -> bool) -> Vec<(f64, String)> {
        let placed = |ticks: Vec<(f64, String)>| -> Vec<(f64, String)> {
            ticks.into_iter().map(|(at, text)| (self.share(at), text)).collect()
        };
        let fits = |ticks: &Vec<(f64, String)>| ticks.windows(2).all(|w| apart([&w[0], &w[1]]));
        let (low, high) = (self.range[0].min(self.range[1]), self.range[0].max(self.range[1]));
        let choices: Vec<Vec<(f64, String)>> = match &self.scale {
            Scale::Names(names) => {
                let name = |(i, name): (usize, &String)| (i as f64, name.clone());
                let every = |k: usize| names.iter().enumerate().step_by(k).map(name).collect();
                (1..=names.len()).map(every).collect()
            }
            Scale::Linear => linear_ticks(low, high, i32::MIN),
            Scale::Whole => linear_ticks(low, high, 0),
            Scale::Logarithmic => logarithmic_ticks(low, high),
        };
        choices.into_iter().map(placed).find(fits).unwrap_or_default()
    }

    /// Places of unlabelled ticks: on a logarithmic axis of a few decades 2, 3, …, 9 times each power of ten.
    pub(crate) fn minor_ticks(&self) -> Vec<f64> {
        let (low, high) = (self.range[0].min(self.range[1]), self.range[0].max(self.range[1]));
        if !matches!(self.scale, Scale::Logarithmic) || high - low > MOST_DECADES {
            return Vec::new();
        }
        let all = (low.floor() as i32..=high.ceil() as i32)
            .flat_map(|e| (2..10).map(move |m| f64::from(m).log10() + f64::from(e)));
        all.filter(|at| (low..=high).contains(at)).map(|at| self.share(at)).collect()
    }
}

/// Steps of 1, 2 or 5 times a power of ten, `least` or above, the smallest first.
fn linear_ticks(low: f64, high: f64, least: i32) -> Vec<Vec<(f64, String)>> {
    let rough = (high - low) / MOST_INTERVALS;
    let largest = low.abs().max(high.abs());
    let exponent = if WRITTEN_OUT.contains(&largest) { 0 } else { largest.log10().floor() as i32 };
    let power = (rough.log10().floor() as i32).max(least);
    let steps = (power..power + 3).flat_map(|p| [1.0, 2.0, 5.0].map(|m| (m, p)));
    let steps = steps.filter(|(m, p)| m * 10_f64.powi(*p) >= rough);
    let ticks = steps.map(|(m, p)| {
        let step = m * 10_f64.powi(p);
        let first = (low / step - 1e-9).ceil() as i64;
        let last = (high / step + 1e-9).floor() as i64;
        let decimals = (exponent - p).max(0) as usize;
        let text = |i: i64| {
            let mantissa = number(i as f64 * m * 10_f64.powi(p - exponent), decimals);
            let is_plain = exponent == 0 || i == 0;
            if is_plain { mantissa } else { format!("{mantissa}·{}", power_of_ten(exponent)) }
        };
        (first..=last).map(|i| (i as f64 * step, text(i))).collect()
    });
    ticks.collect()
}

/// Ticks between two decimal logarithms, the densest first: less than a decade apart those of a linear axis.
fn logarithmic_ticks(low: f64, high: f64) -> Vec<Vec<(f64, String)>> {
    let decades = high - low;
    // Powers that are written out stand beside no others.
    let written_out = low > -3.1 && high < 4.1;
    if decades < 0.7 && written_out {
        let ticks = linear_ticks(10_f64.powf(low), 10_f64.powf(high), i32::MIN);
        let logarithms = |ticks: Vec<(f64, String)>| {
            ticks.into_iter().map(|(at, text)| (at.log10(), text)).collect()
        };
        return ticks.into_iter().map(logarithms).collect();
    }
    let mantissas: &[&[f64]] =
        if decades < 2.5 { &[&[1.0, 2.0, 5.0], &[1.0, 3.0], &[1.0]] } else { &[&[1.0]] };
    let every = ((decades / MOST_DECADES).ceil() as i32).max(1);
    let choices = mantissas.iter().filter(|_| every == 1).map(|m| (*m, 1));
    let choices = choices.chain((every.max(2)..12).map(|k| (&[1.0][..], k)));
    let ticks = choices.map(|(mantissas, every)| {
        let exponents = low.floor() as i32..=high.ceil() as i32;
        exponents
            .filter(|e| e % every == 0)
            .flat_map(|e| {
                mantissas.iter().map(move |&m| (m.log10() + f64::from(e), power(m, e, written_out)))
            })
            .filter(|(at, _)| (low - 1e-9..=high + 1e-9).contains(at))
            .collect()
    });
    ticks.collect()
}

fn width(text: &str) -> f64 {
    text_width(text, TEXT_PT)
}

/// A number with a true minus sign.
fn number(value: f64, decimals: usize) -> String {
    // No minus before a zero.
    let value = if value.abs() < 1e-12 { 0.0 } else { value };
    format!("{value:.decimals$}").replace('-', "−")
}

/// `mantissa · 10^exponent`.
fn power(mantissa: f64, exponent: i32, written_out: bool) -> String {
    if written_out {
        let value = mantissa * 10_f64.powi(exponent);
        let decimals =
            (-exponent).max(0) as usize + usize::from(mantissa.fract() != 0.0 && exponent < 1);
        return number(value, decimals);
    }
    let power = power_of_ten(exponent);
    if mantissa == 1.0 { power } else { format!("{mantissa}·{power}") }
}

fn power_of_ten(exponent: i32) -> String {
    format!("10{}", raised(&exponent.to_string().replace('-', "−")))
}

#[cfg(test)]
mod tests {
    use super::{Axis, raised, width};

    fn told(ticks: Vec<(f64, String)>) -> Vec<String> {
        ticks.into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn ticks_never_touch() {
        for decades in [0.1, 0.5, 1.0, 2.0, 4.0, 9.0, 20.0] {
            for length in [15.0, 30.0, 70.0, 160.0] {
                let high = 0.7 * 10_f64.powf(decades);
                for axis in
                    [Axis::logarithmic("", [0.7, high], 0.0), Axis::linear("", [0.7, high], 0.0)]
                {
                    let ticks = axis.ticks_across(length);
                    for pair in ticks.windows(2) {
                        let gap = (pair[1].0 - pair[0].0) * length;
                        assert!(gap > 0.5 * (width(&pair[0].1) + width(&pair[1].1)));
                    }
                    assert!(ticks.len() > 1 || length < 40.0, "{decades} {length} {ticks:?}");
                }
            }
        }
    }

    /// Beyond what a double can subtract, and beside what it can tell apart.
    #[test]
    fn axes_hold_any_numbers() {
        for ends in
            [[-1.7e308, 1.7e308], [1e20, 1e20], [0.0, 0.0], [1e-300, 1e-300], [1.0, 1.0 + 1e-15]]
        {
            let axis = Axis::linear("", ends, 0.04);
            assert!((0.0..=1.0).contains(&axis.place(ends[0])), "{ends:?}");
            assert!(axis.ticks_up(44.0).len() < 20, "{ends:?}");
        }
    }

    #[test]
    fn ticks_are_round() {
        let axis = Axis::linear("", [0.0, 7.8], 0.0);
        assert_eq!(told(axis.ticks_across(70.0)), ["0", "1", "2", "3", "4", "5", "6", "7"]);
        let axis = Axis::linear("", [0.0, 2.1e-12], 0.0);
        let power = format!("·10{}", raised("−12"));
        let told_up = told(axis.ticks_up(20.0));
        assert_eq!(
            told_up,
            ["0.0", "0.5", "1.0", "1.5", "2.0"].map(|m| match m {
                "0.0" => m.to_owned(),
                _ => format!("{m}{power}"),
            })
        );
        let axis = Axis::logarithmic("", [1.0, 2e5], 0.0);
        assert_eq!(
            told(axis.ticks_across(70.0)),
            [0, 1, 2, 3, 4, 5].map(|e| format!("10{}", raised(&e.to_string())))
        );
        let axis = Axis::logarithmic("", [1e-9, 1.0], 0.0);
        assert_eq!(
            told(axis.ticks_up(50.0)),
            ["−8", "−6", "−4", "−2", "0"].map(|e| format!("10{}", raised(e)))
        );
    }
}
