//! A figure: a legend above panels, and the files it is written to.

use std::collections::HashSet;
use std::path::Path;

use plotters::style::RGBColor;
use resvg::{tiny_skia, usvg};
use svg2pdf::{ConversionOptions, PageOptions};

use super::error::FigureError;
use super::panel::{Frame, LINE, Panel};
use super::sheet::{Anchor, Sheet};
use super::style::{COLOURS, SHADES, Stroke, TEXT_PT, Width, mix};
use super::text::{fitted_apart, text_width};
use crate::output::{create_folder, write_file};

/// Panels in rows, under one legend.
#[derive(Debug, Clone)]
pub(crate) struct Figure {
    pub(crate) width: Width,
    /// Panels in a row.
    pub(crate) across: usize,
    /// Height of what is between a panel's axes \[mm\].
    pub(crate) height: f64,
    pub(crate) panels: Vec<Panel>,
}

/// An entry of the legend: its place \[mm\], what it says and, unless it is a note, the stroke that it explains.
type Entry = (f64, String, Option<Stroke>);

/// Resolution of PNG files \[dots per inch\].
const PNG_DPI: f32 = 300.0;
/// Resolution that SVG's absolute lengths stand for \[dots per inch\].
const SVG_DPI: f32 = 96.0;
/// Length of a line in the legend, room behind it, and room behind its text \[mm\].
const SAMPLE: f64 = 6.4;
const BEHIND_SAMPLE: f64 = 0.7;
const BEHIND_NAME: f64 = 2.4;

impl Figure {
    /// Panels one below the other, a column wide.
    pub(crate) fn column(panels: Vec<Panel>, height: f64) -> Self {
        Self { width: Width::Column, across: 1, height, panels }
    }

    /// One panel a column wide; more in rows over the page's width.
    pub(crate) fn grid(panels: Vec<Panel>) -> Self {
        match panels.len() {
            0 | 1 => Self::column(panels, 44.0),
            2 => Self { width: Width::Page, across: 2, height: 44.0, panels },
            3 | 5 | 6 | 9 => Self { width: Width::Page, across: 3, height: 36.0, panels },
            _ => Self { width: Width::Page, across: 4, height: 28.0, panels },
        }
    }

    /// The same with linear axes instead of logarithmic ones: horizontal ones, vertical ones.
    pub(crate) fn with_linear_axes(mut self, [across, up]: [bool; 2]) -> Self {
        for panel in &mut self.panels {
            if across {
                panel.x.make_linear();
            }
            if up {
                panel.y.make_linear();
            }
        }
        self
    }

    /// The same with other colours of lines, points and boxes, also where they are paler or darker.
    pub(crate) fn recoloured(mut self, of: impl Fn(RGBColor) -> RGBColor) -> Self {
        let other = |colour: RGBColor| {
            // Colours themselves before their shades: 55 % of black is the grey among them.
            let shaded = |&(to, share): &(RGBColor, f64)| {
                let own = COLOURS.iter().find(|own| mix(**own, to, share) == colour);
                own.map(|own| mix(of(*own), to, share))
            };
            SHADES.iter().find_map(shaded).unwrap_or(colour)
        };
        for mark in self.panels.iter_mut().flat_map(|panel| &mut panel.marks) {
            mark.recolour(other);
        }
        self
    }

    /// Writes `NAME.svg`, `NAME.png` and `NAME.pdf` into a folder, made if need be.
    pub(crate) fn save(&self, folder: &Path, name: &str) -> Result<(), FigureError> {
        create_folder(folder)?;
        let tree = self.tree()?;
        write_file(&folder.join(format!("{name}.svg")), svg(&tree).as_bytes())?;
        write_file(&folder.join(format!("{name}.png")), &png(&tree, PNG_DPI)?)?;
        write_file(&folder.join(format!("{name}.pdf")), &pdf(&tree)?)?;
        Ok(())
    }

    /// The figure as SVG.
    pub(crate) fn svg(&self) -> Result<String, FigureError> {
        Ok(svg(&self.tree()?))
    }

    pub(crate) fn tree(&self) -> Result<usvg::Tree, FigureError> {
        let legend = self.legend();
        let top = LINE * legend.len() as f64 + if legend.is_empty() { 0.0 } else { 0.8 };
        let (frames, height) = self.frames(top);
        let titles: Vec<String> = self.panels.iter().map(|panel| panel.title.clone()).collect();
        let titles =
            fitted_apart(&titles, frames.first().map_or(0.0, |frame| frame.right - frame.left));
        Sheet::drawn(self.width.mm(), height, |sheet| {
            draw_legend(sheet, &legend)?;
            let mut panels = self.panels.iter().zip(&frames).zip(&titles);
            panels.try_for_each(|((panel, frame), title)| panel.draw(sheet, frame, title))
        })
    }

    /// Where the panels are, below `top`, and the height of all \[mm\].
    fn frames(&self, top: f64) -> (Vec<Frame>, f64) {
        let (panels, across) = (&self.panels, self.across.max(1));
        // Without a panel below or to the left, or with one whose axis is another, it shows its own label.
        let x_label = |i: usize| {
            panels.get(i + across).is_none_or(|below| below.x.label != panels[i].x.label)
        };
        let y_label =
            |i: usize| i.is_multiple_of(across) || panels[i - 1].y.label != panels[i].y.label;
        let mut lefts = vec![0.0; across];
        for (i, panel) in panels.iter().enumerate() {
            lefts[i % across] = f64::max(lefts[i % across], panel.left(self.height, y_label(i)));
        }
        let free = self.width.mm() - lefts.iter().sum::<f64>();
        let mut width = (free / across as f64).max(1.0);
        let mut beside = 0.0;
        // Ticks depend on the width, and a little of the width on the last tick.
        for _ in 0..2 {
            beside = panels.iter().map(|panel| panel.beside(width)).fold(beside, f64::max);
            width = (free / across as f64 - beside).max(1.0);
        }
        let mut frames = Vec::new();
        let mut y = top;
        for (r, row) in panels.chunks(across).enumerate() {
            let above = row.iter().map(Panel::above).fold(0.0, f64::max);
            let mut x = 0.0;
            let mut below = 0.0;
            for (c, panel) in row.iter().enumerate() {
                let i = r * across + c;
                let left = x + lefts[c];
                let (top, bottom) = (y + above, y + above + self.height);
                let (x_label, y_label) = (x_label(i), y_label(i));
                frames.push(Frame { left, top, right: left + width, bottom, x_label, y_label });
                below = f64::max(below, panel.below(x_label));
                x = left + width + beside;
            }
            y += above + self.height + below;
        }
        (frames, y)
    }

    /// What the marks of all panels are called, each name once, in rows that fit the width, each with its
    /// place \[mm\].
    fn legend(&self) -> Vec<Vec<Entry>> {
        let width = self.width.mm();
        let mut rows: Vec<Vec<Entry>> = Vec::new();
        let mut x = f64::INFINITY;
        let mut seen = HashSet::new();
        let marks = self.panels.iter().flat_map(|panel| &panel.marks);
        let named: Vec<_> =
            marks.filter_map(|m| m.legend()).filter(|(name, _)| seen.insert(*name)).collect();
        let names: Vec<String> = named.iter().map(|(name, _)| (*name).to_owned()).collect();
        let names = fitted_apart(&names, width - SAMPLE - BEHIND_SAMPLE - 2.0);
        for (name, (_, stroke)) in names.into_iter().zip(named) {
            let sample = if stroke.is_some() { SAMPLE + BEHIND_SAMPLE } else { 0.0 };
            let needed = sample + text_width(&name, TEXT_PT);
            if x + needed > width {
                rows.push(Vec::new());
                x = 1.0;
            }
            if let Some(row) = rows.last_mut() {
                row.push((x, name, stroke.copied()));
            }
            x += needed + BEHIND_NAME;
        }
        rows
    }
}

fn draw_legend(sheet: &Sheet<'_>, rows: &[Vec<Entry>]) -> Result<(), FigureError> {
    for (i, row) in rows.iter().enumerate() {
        let y = LINE * (i as f64 + 0.6);
        for (x, name, stroke) in row {
            let Some(stroke) = stroke else {
                sheet.text(name, [*x, y], Anchor::Left)?;
                continue;
            };
            if stroke.width > 0.0 {
                sheet.line(&[[*x, y], [x + SAMPLE, y]], stroke)?;
            }
            sheet.marker([x + 0.5 * SAMPLE, y], stroke)?;
            sheet.text(name, [x + SAMPLE + BEHIND_SAMPLE, y], Anchor::Left)?;
        }
    }
    Ok(())
}

/// Text becomes outlines, so the SVG looks the same wherever it is opened.
fn svg(tree: &usvg::Tree) -> String {
    tree.to_string(&usvg::WriteOptions {
        coordinates_precision: 1,
        transforms_precision: 5,
        ..usvg::WriteOptions::default()
    })
}

pub(crate) fn png(tree: &usvg::Tree, dpi: f32) -> Result<Vec<u8>, FigureError> {
    let error = |reason: String| FigureError::Convert { format: "PNG", reason };
    let scale = dpi / SVG_DPI;
    let length = |length: f32| (length * scale).ceil() as u32;
    let (width, height) = (length(tree.size().width()), length(tree.size().height()));
    let mut pixels = tiny_skia::Pixmap::new(width, height)
        .ok_or_else(|| error("the figure is too large".to_owned()))?;
    // The last pixels are only in part within the drawing.
    pixels.fill(tiny_skia::Color::WHITE);
    resvg::render(tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixels.as_mut());
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_adaptive_filter(png::AdaptiveFilterType::Adaptive);
    let per_metre = (dpi / 0.0254).round() as u32;
    let unit = png::Unit::Meter;
    encoder.set_pixel_dims(Some(png::PixelDimensions { xppu: per_metre, yppu: per_metre, unit }));
    // The paper is opaque, so there is nothing to see through.
    let colours: Vec<u8> =
        pixels.data().chunks_exact(4).flat_map(|rgba| &rgba[..3]).copied().collect();
    encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(&colours))
        .map_err(|e| error(e.to_string()))?;
    Ok(bytes)
}

fn pdf(tree: &usvg::Tree) -> Result<Vec<u8>, FigureError> {
    svg2pdf::to_pdf(tree, ConversionOptions::default(), PageOptions { dpi: SVG_DPI })
        .map_err(|e| FigureError::Convert { format: "PDF", reason: e.to_string() })
}
