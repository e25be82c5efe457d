//! What is seen at one time, and its picture.

use nalgebra::Vector3;

use super::camera::Camera;
use super::facet::Facet;
use super::picture::{Picture, Size};
use super::raster::filled;
use super::solid::{Edge, Solid};
use super::text;

/// How bright what is turned away from the light is.
const DARKEST: f64 = 0.45;

/// Line widths and letters are told at this height of a picture \[pixels\].
const HEIGHT: f64 = 1080.0;

/// Width of the edges of solids \[pixels\], and what is left of the solid's colour there.
const EDGE: f64 = 1.6;
const EDGE_SHADE: f64 = 0.45;

/// Letters \[pixels an em\].
const TEXT: f64 = 34.0;
const SMALLEST_TEXT: f64 = 10.0;

const INK: [u8; 3] = [38, 38, 38];

/// How many pixels nearer lines are than the surfaces that they lie on.
const LIFT: f64 = 2.5;

/// What is seen at one time, in metres.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    /// Bodies.
    pub solids: Vec<Solid>,
    /// Lines, which bodies hide.
    pub lines: Vec<Line>,
    /// Texts at places, whole or hidden.
    pub labels: Vec<Label>,
    /// Lines of text at the lower left.
    pub caption: Vec<String>,
}

/// A line through places.
#[derive(Debug, Clone)]
pub struct Line {
    /// The places.
    pub places: Vec<Vector3<f64>>,
    /// Red, green and blue.
    pub colour: [u8; 3],
    /// In a picture of 1080 rows \[pixels\].
    pub width: f64,
    /// Length of dashes and gaps in such a picture \[pixels\].
    pub dashes: Option<f64>,
}

/// A short text, its middle at a place.
#[derive(Debug, Clone)]
pub struct Label {
    /// The text.
    pub text: &'static str,
    /// The place.
    pub place: Vector3<f64>,
    /// Red, green and blue.
    pub colour: [u8; 3],
}

impl Scene {
    /// Its picture.
    pub fn picture(&self, camera: &Camera, size: Size) -> Picture {
        let scale = size.height.min(size.width * 9 / 16) as f64 / HEIGHT;
        let drawing = Drawing { camera, scale };
        let (clear, solid): (Vec<_>, Vec<_>) =
            self.solids.iter().partition(|solid| solid.opacity < 1.0);
        let mut facets = Vec::new();
        for solid in solid {
            drawing.solid(solid, &mut facets);
        }
        for line in &self.lines {
            drawing.line(line, &mut facets);
        }
        for solid in clear {
            drawing.solid(solid, &mut facets);
        }
        let mut picture = filled(&facets, size);
        let em = (TEXT * scale).max(SMALLEST_TEXT);
        for Label { text, place, colour } in &self.labels {
            let at @ [x, y, _] = camera.project(place);
            if facets.iter().any(|facet| facet.hides(at)) {
                continue;
            }
            let left = x - 0.5 * text::width(text, em);
            text::write(&mut picture, text, [left, y + 0.27 * em], em, *colour);
        }
        let margin = 1.1 * em;
        for (i, line) in self.caption.iter().rev().enumerate() {
            let base = size.height as f64 - margin - 1.3 * em * i as f64;
            text::write(&mut picture, line, [margin, base], em, INK);
        }
        picture
    }
}

/// How scenes become facets.
struct Drawing<'a> {
    camera: &'a Camera,
    /// Pixels of the picture for one of a picture of 1080 rows.
    scale: f64,
}

impl Drawing<'_> {
    fn solid(&self, solid: &Solid, facets: &mut Vec<Facet>) {
        let Solid { form, colour, opacity } = solid;
        let (eye, light) = (self.camera.eye(), self.camera.light());
        let seen = form.faces().into_iter().filter(|face| face.is_seen_from(&eye));
        facets.extend(seen.map(|face| {
            let shade = |normal: &Vector3<f64>| {
                DARKEST + (1.0 - DARKEST) * (0.5 + 0.5 * normal.dot(&light)).clamp(0.0, 1.0)
            };
            Facet {
                corners: face.corners.map(|corner| self.camera.project(&corner)),
                shades: face.normals.map(|normal| shade(&normal)),
                colour: *colour,
                opacity: *opacity,
            }
        }));
        let ink = colour.map(|part| (f64::from(part) * EDGE_SHADE) as u8);
        for Edge { ends, normals } in form.edges() {
            if normals.iter().any(|normal| normal.dot(&(eye - ends[0])) > 0.0) {
                let ends = ends.map(|end| self.lifted(&end));
                facets.extend(Facet::of_line(ends, EDGE * self.scale, ink, *opacity));
            }
        }
    }

    /// A place of a line on a surface.
    fn lifted(&self, place: &Vector3<f64>) -> [f64; 3] {
        let [x, y, nearness] = self.camera.project(place);
        [x, y, nearness * (1.0 + LIFT * self.camera.pixel())]
    }

    fn line(&self, line: &Line, facets: &mut Vec<Facet>) {
        let Line { places, colour, width, dashes } = line;
        let width = width * self.scale;
        let places: Vec<[f64; 3]> = places.iter().map(|place| self.lifted(place)).collect();
        let dash = dashes.map(|dash| dash * self.scale);
        let mut passed = 0.0;
        for ends in places.windows(2) {
            let length = (ends[1][0] - ends[0][0]).hypot(ends[1][1] - ends[0][1]);
            for [from, to] in drawn(dash, passed, length) {
                let at = |way: f64| -> [f64; 3] {
                    let share = if length > 0.0 { (way / length).clamp(0.0, 1.0) } else { 0.0 };
                    std::array::from_fn(|k| ends[0][k] + share * (ends[1][k] - ends[0][k]))
                };
                facets.extend(Facet::of_line([at(from), at(to)], width, *colour, 1.0));
            }
            passed += length;
        }
    }
}

/// Most dashes of a piece of a line; one that is longer leaves the picture.
const MOST_DASHES: usize = 2000;

/// The parts of a piece of a line that its dashes leave, where so much of the line lies before it \[pixels\].
fn drawn(dash: Option<f64>, passed: f64, length: f64) -> Vec<[f64; 2]> {
    let Some(dash) = dash else { return vec![[0.0, length]] };
    let first = (passed / (2.0 * dash)).floor() * 2.0 * dash - passed;
    (0..MOST_DASHES)
        .map(|k| first + 2.0 * dash * k as f64)
        .take_while(|start| *start < length)
        .map(|start| [start.max(0.0), (start + dash).min(length)])
        .filter(|[from, to]| from < to)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::camera::View;
    use super::super::solid::Form;
    use super::*;

    const SIZE: Size = Size { width: 320, height: 180 };

    fn cube(opacity: f64) -> Scene {
        let edges = [Vector3::x(), Vector3::y(), Vector3::z()];
        let form = Form::Cuboid { centre: Vector3::zeros(), edges };
        Scene { solids: vec![Solid { form, colour: [200; 3], opacity }], ..Scene::default() }
    }

    /// Seen along an axis, a cube's face is the square between its projected corners: no pixel within is white, and all without are.
    #[test]
    fn a_face_covers_what_its_projection_says() {
        let scene = cube(1.0);
        let corners = scene.solids[0].form.corners();
        let view = View { azimuth: 0.0, elevation: 0.0 };
        let camera = Camera::around(&corners, view, SIZE);
        let front =
            [[-1.0, 1.0], [1.0, -1.0]].map(|[y, z]| camera.project(&Vector3::new(1.0, y, z)));
        let [[left, top, _], [right, bottom, _]] = front;
        assert!((right - left - (bottom - top)).abs() < 1e-9 && right - left > 100.0);
        let picture = scene.picture(&camera, SIZE);
        for (i, pixel) in picture.pixels.iter().enumerate() {
            let (x, y) = ((i % SIZE.width) as f64, (i / SIZE.width) as f64);
            if x >= left && x + 1.0 <= right && y >= top && y + 1.0 <= bottom {
                assert_ne!(*pixel, [255; 3], "{x} {y}");
            }
            if x + 2.0 < left || x - 1.0 > right || y + 2.0 < top || y - 1.0 > bottom {
                assert_eq!(*pixel, [255; 3], "{x} {y}");
            }
        }
    }

    /// A line behind a solid is hidden, one on its surface is not, and neither is one seen through it.
    #[test]
    fn solids_hide_lines() {
        let view = View { azimuth: 0.0, elevation: 0.0 };
        let has_red = |opacity, depth| {
            let mut scene = cube(opacity);
            let camera = Camera::around(&scene.solids[0].form.corners(), view, SIZE);
            let ends = [-0.5, 0.5].map(|y| Vector3::new(depth, y, 0.0));
            let line =
                Line { places: ends.to_vec(), colour: [255, 0, 0], width: 24.0, dashes: None };
            scene.lines.push(line);
            let picture = scene.picture(&camera, SIZE);
            picture.pixels.iter().any(|[r, g, _]| u16::from(*r) > u16::from(*g) + 60)
        };
        let found = [(1.0, -1.5), (1.0, 1.0), (1.0, 1.5), (0.3, 0.0)].map(|(o, d)| has_red(o, d));
        assert_eq!(found, [false, true, true, true]);
    }

    #[test]
    fn a_label_behind_a_solid_is_left_out() {
        let view = View { azimuth: 0.0, elevation: 0.0 };
        let is_written = |x| {
            let mut scene = cube(1.0);
            let camera = Camera::around(&scene.solids[0].form.corners(), view, SIZE);
            let place = Vector3::new(x, 0.0, 0.0);
            scene.labels.push(Label { text: "x", place, colour: [255, 0, 0] });
            let picture = scene.picture(&camera, SIZE);
            picture.pixels.iter().any(|[r, g, _]| u16::from(*r) > u16::from(*g) + 60)
        };
        assert_eq!([2.0, -2.0].map(is_written), [true, false]);
    }

    #[test]
    fn dashes_go_on_from_piece_to_piece() {
        assert_eq!(drawn(Some(2.0), 0.0, 7.0), [[0.0, 2.0], [4.0, 6.0]]);
        assert_eq!(drawn(Some(2.0), 7.0, 4.0), [[1.0, 3.0]]);
        assert_eq!(drawn(None, 7.0, 4.0), [[0.0, 4.0]]);
    }

    #[test]
    fn captions_are_written_at_the_lower_left() {
        let camera = Camera::around(&[], View::default(), SIZE);
        let scene = Scene { caption: vec!["t = 1.00 s".to_owned()], ..Scene::default() };
        let picture = scene.picture(&camera, SIZE);
        let inked = picture.pixels.iter().enumerate().filter(|(_, pixel)| pixel[0] < 128);
        let places: Vec<[usize; 2]> =
            inked.map(|(i, _)| [i % SIZE.width, i / SIZE.width]).collect();
        assert!(places.len() > 40, "{places:?}");
        assert!(places.iter().all(|[x, y]| *x < 100 && *y > 150), "{places:?}");
    }
}
