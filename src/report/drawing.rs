//! A chart's SVG within a page.

use serde::Serialize;

use super::embedded::Embedded;
use super::error::ReportError;
use crate::exhibit::Chart;
use crate::figure::FigureError;

/// Drawings wider than a column and a half of a journal take the width of the page \[px\].
const WIDE: f64 = 500.0;

/// A chart's SVG within a page.
#[derive(Debug, Serialize)]
pub(super) struct Drawing {
    svg: Embedded,
    is_wide: bool,
    /// Whether it is higher than a screen.
    is_tall: bool,
}

impl Drawing {
    pub(super) fn of(chart: &Chart) -> Result<Self, ReportError> {
        let (svg, [width, height]) =
            inline(&chart.figure.svg()?, &chart.name).ok_or_else(|| FigureError::Convert {
                format: "drawing of a page",
                reason: "its size is not where it should be".to_owned(),
            })?;
        Ok(Self { svg: Embedded::new(&svg)?, is_wide: width > WIDE, is_tall: height > 2.0 * width })
    }
}

/// Gives a drawing a view box, so that it fits any width, and an accessible name from the figure's title and caption,
/// and makes its identifiers its own; with its size \[px\].
fn inline(svg: &str, name: &str) -> Option<(String, [f64; 2])> {
    let rest = svg.split_once("<svg width=\"")?.1;
    let (width, rest) = rest.split_once("\" height=\"")?;
    let (height, rest) = rest.split_once('"')?;
    let rest = rest
        .replace(" id=\"", &format!(" id=\"{name}-"))
        .replace("url(#", &format!("url(#{name}-"))
        .replace("href=\"#", &format!("href=\"#{name}-"));
    let svg = format!(
        "<svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-labelledby=\"title-{name}\" \
         aria-describedby=\"caption-{name}\"{rest}"
    );
    Some((svg, [width.parse().ok()?, height.parse().ok()?]))
}

#[cfg(test)]
mod tests {
    use super::inline;

    #[test]
    fn two_drawings_share_no_identifier() {
        let svg = "<svg width=\"332.6\" height=\"700\" xmlns=\"http://www.w3.org/2000/svg\"><defs>\
                   <clipPath id=\"c1\"/></defs><g clip-path=\"url(#c1)\"/><use href=\"#c1\"/></svg>\n";
        let (drawing, size) = inline(svg, "ranks").unwrap();
        assert!(drawing.starts_with("<svg viewBox=\"0 0 332.6 700\" role=\"img\""));
        assert!(drawing.contains("id=\"ranks-c1\""));
        assert!(drawing.contains("url(#ranks-c1)") && drawing.contains("href=\"#ranks-c1\""));
        assert_eq!(size, [332.6, 700.0]);
    }
}
