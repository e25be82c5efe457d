//! Charts beside stored pictures; and no two texts that touch.
//!
//! `DRIFTLESS_ACCEPT_CHARTS=1` stores what is drawn now. What differs is left in `target/charts`.

use std::fs;
use std::path::Path;

use resvg::usvg;

use super::figure::{Figure, png};

/// Resolution of the stored pictures \[dots per inch\].
const DPI: f32 = 110.0;

fn decoded(bytes: &[u8]) -> (u32, Vec<u8>) {
    let mut reader = ::png::Decoder::new(bytes).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size()];
    let info = reader.next_frame(&mut pixels).unwrap();
    (info.width, pixels)
}

/// Whether charts look as they are stored in `tests/charts`, and no two texts of one touch.
pub(crate) fn check(charts: &[(&str, Figure)]) {
    look_as_stored(charts);
    touch_nothing(charts);
}

fn look_as_stored(charts: &[(&str, Figure)]) {
    let (stored, drawn) = (Path::new("tests/charts"), Path::new("target/charts"));
    let mut changed = Vec::new();
    for (name, figure) in charts {
        let bytes = png(&figure.tree().unwrap(), DPI).unwrap();
        let file = format!("{name}.png");
        if std::env::var_os("DRIFTLESS_ACCEPT_CHARTS").is_some() {
            fs::create_dir_all(stored).unwrap();
            fs::write(stored.join(&file), &bytes).unwrap();
        }
        let expected = fs::read(stored.join(&file)).ok().map(|bytes| decoded(&bytes));
        let (width, pixels) = decoded(&bytes);
        // Last digits of sines may differ, so an edge's pixel may be a little darker; no more.
        let is_same = expected.is_some_and(|(expected_width, expected)| {
            let far = expected.iter().zip(&pixels).filter(|(a, b)| a.abs_diff(**b) > 40).count();
            width == expected_width && pixels.len() == expected.len() && far * 5000 < pixels.len()
        });
        if !is_same {
            fs::create_dir_all(drawn).unwrap();
            fs::write(drawn.join(&file), &bytes).unwrap();
            changed.push(file);
        }
    }
    assert!(changed.is_empty(), "look at {changed:?} in {}", drawn.display());
}

/// The smallest size of a text in print, lowered and raised parts included \[pt\].
fn smallest_text(group: &usvg::Group) -> f32 {
    let of = |node: &usvg::Node| match node {
        usvg::Node::Group(group) => smallest_text(group),
        usvg::Node::Text(text) => {
            let spans = text.chunks().iter().flat_map(usvg::TextChunk::spans);
            let smallest = spans.map(|span| span.font_size().get()).fold(f32::INFINITY, f32::min);
            // SVG's lengths are of 96 to an inch, points of 72.
            smallest * text.abs_transform().get_scale().0 * 0.75
        }
        _ => f32::INFINITY,
    };
    group.children().iter().map(of).fold(f32::INFINITY, f32::min)
}

/// All texts, with the bounding boxes of what is seen of them.
pub(crate) fn texts(group: &usvg::Group) -> Vec<(String, usvg::Rect)> {
    let of = |node: &usvg::Node| match node {
        usvg::Node::Group(group) => texts(group),
        usvg::Node::Text(text) => {
            let chunks = text.chunks().iter().map(usvg::TextChunk::text);
            let seen = text.flattened().bounding_box().transform(text.abs_transform());
            vec![(chunks.collect(), seen.unwrap())]
        }
        _ => Vec::new(),
    };
    group.children().iter().flat_map(of).collect()
}

/// Whether no text touches another or the edge.
fn touch_nothing(charts: &[(&str, Figure)]) {
    for (name, figure) in charts {
        let tree = figure.tree().unwrap();
        let texts = texts(tree.root());
        assert!(!texts.is_empty(), "{name} has no text");
        // Drawing units are a fortieth of a millimetre.
        let smallest = smallest_text(tree.root());
        assert!(smallest > 5.95, "{name} has a text of {smallest} pt");
        for (i, (text, a)) in texts.iter().enumerate() {
            let size = tree.size();
            let is_within = a.left() >= 0.0
                && a.top() >= 0.0
                && a.right() <= size.width()
                && a.bottom() <= size.height();
            assert!(is_within, "{name}: {text:?} is cut off: {a:?} of {size:?}");
            for (other, b) in &texts[i + 1..] {
                let apart = a.right() <= b.left()
                    || b.right() <= a.left()
                    || a.bottom() <= b.top()
                    || b.bottom() <= a.top();
                assert!(apart, "{name}: {text:?} touches {other:?}");
            }
        }
    }
}
