//! Texts: how wide they are, and what is left of those that are too long.

use std::collections::{HashMap, HashSet};
use std::sync::{Arc, LazyLock};

use plotters::style::{FontStyle, IntoFont};
use resvg::usvg;

use super::style::TEXT_PT;

/// Drawing units a millimetre. Plotters draws on whole units; this many make curves smooth.
pub(super) const UNITS_PER_MM: f64 = 40.0;
/// Millimetres a point.
const MM_PER_PT: f64 = 25.4 / 72.0;
/// The family name of the embedded font.
pub(super) const FONT: &str = "Noto Sans";
/// Size of a lowered or raised text, as a share of the text's: journals want 6 points at least.
pub(super) const SMALL: f64 = 0.8;
const _: () = assert!(SMALL * TEXT_PT >= 6.0);
/// Most letters of a text that are drawn; more fit no figure.
const MOST_LETTERS: usize = 400;
/// The share of a text cut in the middle that is its end, where settings stand.
const END: f64 = 0.7;

/// The embedded font, for plotters to measure text with and for usvg to draw it.
static FONTS: LazyLock<Arc<usvg::fontdb::Database>> = LazyLock::new(|| {
    // The bytes are a font, so this cannot fail; if it did, plotters would say so when drawing.
    let _ = plotters::style::register_font(FONT, FontStyle::Normal, notosans::REGULAR_TTF);
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(notosans::REGULAR_TTF.to_vec());
    Arc::new(fonts)
});

/// The embedded font, made known to plotters.
pub(super) fn fonts() -> Arc<usvg::fontdb::Database> {
    FONTS.clone()
}

/// What begins and ends a lowered and a raised part of a text: characters that [`printable`] takes away.
pub(super) const LOWERED: char = '\u{E000}';
pub(super) const RAISED: char = '\u{E001}';
pub(super) const LEVEL: char = '\u{E002}';

/// A text of somebody else's, without characters that no drawing can have and those that lower and raise.
pub(crate) fn printable(text: &str) -> String {
    let level = |c: char| if matches!(c, LOWERED | RAISED | LEVEL) { '\u{FFFD}' } else { c };
    drawable(text).chars().map(level).collect()
}

/// A text without characters that no drawing can have.
pub(super) fn drawable(text: &str) -> String {
    let is_drawable = |c: char| !c.is_control() && !matches!(c, '\u{FFFE}' | '\u{FFFF}');
    text.chars().map(|c| if is_drawable(c) { c } else { '\u{FFFD}' }).collect()
}

/// A raised text.
pub(crate) fn raised(text: &str) -> String {
    format!("{RAISED}{text}{LEVEL}")
}

/// Text size in plotters' measure, which is 1.24 times the font size.
pub(super) fn text_size(points: f64) -> f64 {
    points * MM_PER_PT * UNITS_PER_MM * 1.24
}

/// Width of a text as drawn \[mm\]. Plotters measures at a font size that makes ascent and descent
/// together as high as its text size, 1.362 em for this font; it draws at the size divided by 1.24.
pub(crate) fn text_width(text: &str, points: f64) -> f64 {
    fonts();
    let measured = |text: &str| {
        let size = (FONT, text_size(points)).into_font().box_size(text);
        size.map_or(0.0, |(width, _)| f64::from(width)) * 1.362 / 1.24 / UNITS_PER_MM
    };
    let parts = text.split(LEVEL).map(|part| match part.split_once([LOWERED, RAISED]) {
        Some((level, small)) => measured(level) + SMALL * measured(small),
        None => measured(part),
    });
    parts.sum()
}

/// The text, or as much of its beginning as fits a width \[mm\], with an ellipsis.
pub(crate) fn fitted(text: &str, width: f64) -> String {
    cut(text, width, 0.0)
}

/// Texts that fit a width \[mm\]: cut at their ends; where that leaves different ones the same, in the middle; and
/// numbered where even that does.
pub(crate) fn fitted_apart(texts: &[String], width: f64) -> Vec<String> {
    let mut cut_down: Vec<String> = texts.iter().map(|text| fitted(text, width)).collect();
    for i in alike(texts, &cut_down) {
        cut_down[i] = cut(&texts[i], width, END);
    }
    for i in alike(texts, &cut_down) {
        let number = format!(" ({})", i + 1);
        cut_down[i] = fitted(&texts[i], width - text_width(&number, TEXT_PT)) + &number;
    }
    cut_down
}

/// The places of different texts that look the same when cut.
fn alike(texts: &[String], cut_down: &[String]) -> Vec<usize> {
    let mut first: HashMap<&str, &str> = HashMap::new();
    let mut shared: HashSet<&str> = HashSet::new();
    for (text, short) in texts.iter().zip(cut_down) {
        if *first.entry(short).or_insert(text) != text {
            shared.insert(short);
        }
    }
    (0..texts.len()).filter(|&i| shared.contains(cut_down[i].as_str())).collect()
}

/// The text, or as much of its beginning and its end as fits a width \[mm\], with an ellipsis between; `end` is the share
/// of the end.
fn cut(text: &str, width: f64, end: f64) -> String {
    let letters: Vec<char> = text.chars().collect();
    if letters.len() <= MOST_LETTERS && text_width(text, TEXT_PT) <= width {
        return text.to_owned();
    }
    let short = |kept: usize| {
        let behind = (end * kept as f64).round() as usize;
        let before: String = letters[..kept - behind].iter().collect();
        let behind: String = letters[letters.len() - behind..].iter().collect();
        levelled(&format!("{}…{}", before.trim_end(), behind.trim_start()))
    };
    let (mut fits, mut over) = (0, letters.len().min(MOST_LETTERS));
    while over - fits > 1 {
        let middle = usize::midpoint(fits, over);
        if text_width(&short(middle), TEXT_PT) <= width {
            fits = middle;
        } else {
            over = middle;
        }
    }
    short(fits)
}

/// A cut text whose lowered and raised parts end where it does, and begin where they end.
fn levelled(text: &str) -> String {
    let mut is_level = true;
    let mut levelled = String::new();
    for letter in text.chars() {
        let is_end = letter == LEVEL;
        if !(is_end && is_level) {
            levelled.push(letter);
        }
        is_level = is_end || (is_level && !matches!(letter, LOWERED | RAISED));
    }
    if !is_level {
        levelled.push(LEVEL);
    }
    levelled
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where the ends tell, they are kept; where nothing that fits does, numbers tell.
    #[test]
    fn texts_that_differ_look_different_when_cut() {
        let long = |end: &str| format!("{} {end}", "a label that is long ".repeat(8));
        let ends = ["cognitive=1.5", "cognitive=2.5", "cognitive=1.5"].map(long);
        let cut = fitted_apart(&ends, 40.0);
        assert!(cut[0].ends_with("cognitive=1.5") && cut[1].ends_with("cognitive=2.5"), "{cut:?}");
        assert_eq!(cut[0], cut[2]);
        let middles = ["b", "c"].map(|middle| long(middle) + &long(""));
        let cut = fitted_apart(&middles, 40.0);
        assert!(cut[0].ends_with("… (1)") && cut[1].ends_with("… (2)"), "{cut:?}");
        assert!(cut.iter().all(|text| text_width(text, TEXT_PT) <= 40.0));
    }

    #[test]
    fn a_very_long_text_is_cut_at_once() {
        let text = "a".repeat(1_000_000);
        assert!(fitted(&text, 50.0).chars().count() < 60);
    }

    /// A lowered part that is cut ends with the text.
    #[test]
    fn what_is_cut_stays_balanced() {
        let text = "K\u{E000}base and more of it\u{E002} and more";
        for width in 3..30 {
            for cut in [fitted(text, f64::from(width)), super::cut(text, f64::from(width), 0.7)] {
                let count = |c: char| cut.chars().filter(|&letter| letter == c).count();
                assert_eq!(count('\u{E000}'), count('\u{E002}'), "{cut:?}");
            }
        }
    }
}
