//! A figure: a legend above panels, and the files it is written to.

use std::collections::HashSet;
use std::path::Path;
use std::sync::{Arc, LazyLock};

use plotters::coord::Shift;
use plotters::drawing::DrawingAreaErrorKind;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use resvg::{tiny_skia, usvg};
use svg2pdf::{ConversionOptions, PageOptions};

use super::panel::{Line, Panel};
use super::style::{COLUMN_MM, FONT, INK, text_size, text_width, units};
use crate::output::{FileError, create_folder, write_file};

/// Panels one below the other, under one legend; they share the horizontal axis.
#[derive(Debug, Clone)]
pub struct Figure {
    pub(super) panels: Vec<Panel>,
    /// Height of one panel \[mm\].
    pub(super) panel_height: f64,
}

/// A figure that could not be drawn or written.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    /// The drawing went wrong.
    #[error("cannot draw a figure: {0}")]
    Draw(String),
    /// The drawing could not be brought into a format.
    #[error("cannot make a {format}: {reason}")]
    Convert {
        /// The format.
        format: &'static str,
        /// Why not.
        reason: String,
    },
    /// The file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
}

impl<E: std::error::Error + Send + Sync> From<DrawingAreaErrorKind<E>> for PlotError {
    fn from(error: DrawingAreaErrorKind<E>) -> Self {
        Self::Draw(error.to_string())
    }
}

/// Resolution of PNG files \[dots per inch\].
const PNG_DPI: f32 = 300.0;

/// Resolution that SVG's absolute lengths stand for \[dots per inch\].
const SVG_DPI: f32 = 96.0;

/// Height of one line of the legend \[mm\].
const LEGEND_LINE: f64 = 3.8;

/// The embedded font, for plotters to measure text with and for usvg to draw it.
static FONTS: LazyLock<Arc<usvg::fontdb::Database>> = LazyLock::new(|| {
    // The bytes are a font, so this cannot fail; if it did, plotters would say so when drawing.
    let _ = plotters::style::register_font(FONT, FontStyle::Normal, notosans::REGULAR_TTF);
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(notosans::REGULAR_TTF.to_vec());
    Arc::new(fonts)
});

impl Figure {
    /// Writes `NAME.svg`, `NAME.png` and `NAME.pdf` into a folder, made if need be.
    pub fn save(&self, folder: &Path, name: &str) -> Result<(), PlotError> {
        create_folder(folder)?;
        let tree = self.tree()?;
        write_file(&folder.join(format!("{name}.svg")), svg(&tree).as_bytes())?;
        write_file(&folder.join(format!("{name}.png")), &png(&tree)?)?;
        write_file(&folder.join(format!("{name}.pdf")), &pdf(&tree)?)?;
        Ok(())
    }

    /// The figure as SVG.
    pub fn svg(&self) -> Result<String, PlotError> {
        Ok(svg(&self.tree()?))
    }

    fn tree(&self) -> Result<usvg::Tree, PlotError> {
        let options = usvg::Options { fontdb: FONTS.clone(), ..usvg::Options::default() };
        let drawing = self.draw()?;
        usvg::Tree::from_str(&drawing, &options)
            .map_err(|e| PlotError::Convert { format: "SVG", reason: e.to_string() })
    }

    /// The drawing as plotters makes it, sized in millimetres.
    fn draw(&self) -> Result<String, PlotError> {
        LazyLock::force(&FONTS);
        let legend = self.legend();
        let height =
            self.panel_height * self.panels.len() as f64 + LEGEND_LINE * legend.len() as f64 + 4.0;
        let size = (units(COLUMN_MM).unsigned_abs(), units(height).unsigned_abs());
        let mut drawing = String::new();
        {
            let area = SVGBackend::with_string(&mut drawing, size).into_drawing_area();
            area.fill(&WHITE)?;
            let (top, body) = area.split_vertically(units(LEGEND_LINE * legend.len() as f64));
            draw_legend(&top, &legend)?;
            let left = self.panels.iter().map(Panel::left).fold(0.0, f64::max);
            let mut rest = body;
            for (i, panel) in self.panels.iter().enumerate() {
                let last = i + 1 == self.panels.len();
                let extra = if last { 4.0 } else { 0.0 };
                let (here, below) = rest.split_vertically(units(self.panel_height + extra));
                panel.draw(&here, left, last)?;
                rest = below;
            }
            area.present()?;
        }
        let (w, h) = size;
        let in_units = format!("width=\"{w}\" height=\"{h}\"");
        let in_mm = format!("width=\"{COLUMN_MM}mm\" height=\"{height}mm\"");
        Ok(drawing.replacen(&in_units, &in_mm, 1))
    }

    /// The named lines of all panels, each name once, in rows that fit the width, each with its place
    /// \[units\].
    fn legend(&self) -> Vec<Vec<(i32, &Line)>> {
        LazyLock::force(&FONTS);
        let mut rows: Vec<Vec<(i32, &Line)>> = Vec::new();
        let mut x = i32::MAX;
        let mut named = HashSet::from([""]);
        for line in self.panels.iter().flat_map(|p| &p.lines).filter(|l| named.insert(&l.name)) {
            let width = units(4.6) + text_width(&line.name);
            if x.saturating_add(width) > units(COLUMN_MM) {
                rows.push(Vec::new());
                x = units(1.5);
            }
            if let Some(row) = rows.last_mut() {
                row.push((x, line));
            }
            x += width + units(1.6);
        }
        rows
    }
}

fn draw_legend(
    area: &DrawingArea<SVGBackend<'_>, Shift>,
    rows: &[Vec<(i32, &Line)>],
) -> Result<(), PlotError> {
    let text = (FONT, text_size()).into_font().color(&INK);
    let text = text.pos(Pos::new(HPos::Left, VPos::Center));
    for (i, row) in rows.iter().enumerate() {
        let y = units(LEGEND_LINE * (i as f64 + 0.6));
        for (x, line) in row {
            let sample = [(*x, y), (x + units(4.0), y)];
            match line.stroke.dash {
                None => area.draw(&PathElement::new(sample, line.stroke.shape()))?,
                Some((dash, gap)) => {
                    let style = line.stroke.shape();
                    area.draw(&DashedPathElement::new(sample, units(dash), units(gap), style))?;
                }
            }
            area.draw_text(&line.name, &text, (x + units(4.6), y))?;
        }
    }
    Ok(())
}

/// Text becomes outlines, so the SVG looks the same wherever it is opened.
fn svg(tree: &usvg::Tree) -> String {
    tree.to_string(&usvg::WriteOptions {
        coordinates_precision: 3,
        transforms_precision: 5,
        ..usvg::WriteOptions::default()
    })
}

fn png(tree: &usvg::Tree) -> Result<Vec<u8>, PlotError> {
    let error = |reason: String| PlotError::Convert { format: "PNG", reason };
    let scale = PNG_DPI / SVG_DPI;
    let pixels = |length: f32| (length * scale).ceil() as u32;
    let size = tree.size();
    let mut pixels = tiny_skia::Pixmap::new(pixels(size.width()), pixels(size.height()))
        .ok_or_else(|| error("the figure is too large".to_owned()))?;
    resvg::render(tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixels.as_mut());
    pixels.encode_png().map_err(|e| error(e.to_string()))
}

fn pdf(tree: &usvg::Tree) -> Result<Vec<u8>, PlotError> {
    svg2pdf::to_pdf(tree, ConversionOptions::default(), PageOptions { dpi: SVG_DPI })
        .map_err(|e| PlotError::Convert { format: "PDF", reason: e.to_string() })
}
