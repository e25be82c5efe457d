//! Facets into pixels: what is nearest is seen, and edges are smooth.

use super::facet::Facet;
use super::picture::{Picture, Size};

/// Samples across and down a pixel.
const SAMPLES: usize = 3;

const OF_A_PIXEL: usize = SAMPLES * SAMPLES;

/// Rows of pixels that are worked out together; their samples fit a processor's cache.
const ROWS: usize = 16;

/// The picture of facets on white.
pub(super) fn filled(facets: &[Facet], size: Size) -> Picture {
    let mut picture = Picture::white(size);
    let mut band = Band::new(size.width);
    for top in (0..size.height).step_by(ROWS) {
        let rows = ROWS.min(size.height - top);
        let [low, high] = [top as f64, (top + rows) as f64];
        let is_within = |facet: &&Facet| {
            let [least, most] = span(facet, 1);
            most > low && least < high
        };
        let own: Vec<&Facet> = facets.iter().filter(is_within).collect();
        let sides = own.iter().map(|facet| span(facet, 0));
        let sides = sides.fold([f64::INFINITY, f64::NEG_INFINITY], |[left, right], own| {
            [left.min(own[0]), right.max(own[1])]
        });
        let left = sides[0].floor().clamp(0.0, size.width as f64) as usize;
        let right = sides[1].ceil().clamp(0.0, size.width as f64) as usize;
        if left >= right {
            continue;
        }
        band.begin(top, left, right);
        for facet in own {
            band.fill(facet);
        }
        for row in 0..rows {
            for x in left..right {
                picture.pixels[(top + row) * size.width + x] = band.pixel(x, row);
            }
        }
    }
    picture
}

/// From where to where a facet goes along an axis \[pixels\].
fn span(facet: &Facet, axis: usize) -> [f64; 2] {
    let [a, b, c] = facet.corners.map(|corner| corner[axis]);
    [a.min(b).min(c), a.max(b).max(c)]
}

/// Some rows of samples.
struct Band {
    /// Samples in a row.
    across: usize,
    /// The first row of pixels.
    top: usize,
    /// The columns of samples that are in use.
    columns: [usize; 2],
    /// How near what each sample shows is; nothing is at no distance that counts.
    nearness: Vec<f32>,
    colours: Vec<[u8; 3]>,
}

impl Band {
    fn new(width: usize) -> Self {
        let across = width * SAMPLES;
        let count = across * ROWS * SAMPLES;
        Self {
            across,
            top: 0,
            columns: [0, 0],
            nearness: vec![0.0; count],
            colours: vec![[255; 3]; count],
        }
    }

    /// Wipes the columns of pixels from `left` to `right`.
    fn begin(&mut self, top: usize, left: usize, right: usize) {
        self.top = top;
        self.columns = [left * SAMPLES, right * SAMPLES];
        for row in 0..ROWS * SAMPLES {
            let used = row * self.across + self.columns[0]..row * self.across + self.columns[1];
            self.nearness[used.clone()].fill(0.0);
            self.colours[used].fill([255; 3]);
        }
    }

    fn fill(&mut self, facet: &Facet) {
        let scale = SAMPLES as f64;
        let first = (self.top * SAMPLES) as f64;
        let corners = facet.corners.map(|[x, y, near]| [x * scale, y * scale - first, near]);
        let [a, b, c] = corners;
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        if area.abs() < 1e-9 {
            return;
        }
        // Linear in the picture: value at the first corner, and slopes to the right and down.
        let plane = |[own, second, third]: [f64; 3]| {
            let [u, v] = [second - own, third - own];
            let right = (u * (c[1] - a[1]) - v * (b[1] - a[1])) / area;
            let down = (v * (b[0] - a[0]) - u * (c[0] - a[0])) / area;
            move |x: f64, y: f64| (own + right * (x - a[0]) + down * (y - a[1]), right)
        };
        let near = plane(corners.map(|corner| corner[2]));
        let shade = plane(facet.shades);
        let is_flat = facet.shades[1..].iter().all(|shade| *shade == facet.shades[0]);
        let plain = shaded(facet.colour, facet.shades[0]);
        let ys = corners.map(|corner| corner[1]);
        let rows = (ROWS * SAMPLES) as f64;
        let low = ys.iter().copied().fold(f64::INFINITY, f64::min).clamp(0.0, rows);
        let high = ys.iter().copied().fold(f64::NEG_INFINITY, f64::max).clamp(0.0, rows);
        for row in low.floor() as usize..high.ceil() as usize {
            let y = row as f64 + 0.5;
            let Some([left, right]) = crossed(&corners, y) else { continue };
            let [from, to] = self.columns.map(|column| column as f64);
            let left = (left - 0.5).ceil().clamp(from, to) as usize;
            let right = (right - 0.5).ceil().clamp(from, to) as usize;
            if left >= right {
                continue;
            }
            let (mut depth, depth_step) = near(left as f64 + 0.5, y);
            let (mut bright, bright_step) = shade(left as f64 + 0.5, y);
            let samples = row * self.across + left..row * self.across + right;
            let colours = &mut self.colours[samples.clone()];
            for (nearness, seen) in self.nearness[samples].iter_mut().zip(colours) {
                let own = depth as f32;
                if own > *nearness {
                    let colour = if is_flat { plain } else { shaded(facet.colour, bright) };
                    if facet.opacity < 1.0 {
                        *seen = mixed(*seen, colour, facet.opacity);
                    } else {
                        (*nearness, *seen) = (own, colour);
                    }
                }
                depth += depth_step;
                bright += bright_step;
            }
        }
    }

    /// The mean of a pixel's samples.
    fn pixel(&self, x: usize, row: usize) -> [u8; 3] {
        let mut sums = [0_usize; 3];
        for down in 0..SAMPLES {
            let start = (row * SAMPLES + down) * self.across + x * SAMPLES;
            for sample in &self.colours[start..start + SAMPLES] {
                for (sum, part) in sums.iter_mut().zip(sample) {
                    *sum += usize::from(*part);
                }
            }
        }
        sums.map(|sum| ((sum + OF_A_PIXEL / 2) / OF_A_PIXEL) as u8)
    }
}

/// From where to where a row lies within a triangle.
fn crossed(corners: &[[f64; 3]; 3], y: f64) -> Option<[f64; 2]> {
    let mut found = [f64::INFINITY, f64::NEG_INFINITY];
    for k in 0..3 {
        let (one, other) = (corners[k], corners[(k + 1) % 3]);
        // From the upper end, so that neighbours agree on their common edge.
        let (upper, lower) = if one[1] <= other[1] { (one, other) } else { (other, one) };
        if upper[1] <= y && y < lower[1] {
            let share = (y - upper[1]) / (lower[1] - upper[1]);
            let x = upper[0] + share * (lower[0] - upper[0]);
            found = [found[0].min(x), found[1].max(x)];
        }
    }
    (found[0] < found[1]).then_some(found)
}

fn shaded(colour: [u8; 3], shade: f64) -> [u8; 3] {
    colour.map(|part| (f64::from(part) * shade + 0.5) as u8)
}

fn mixed(under: [u8; 3], over: [u8; 3], share: f64) -> [u8; 3] {
    let part = |k: usize| {
        let (under, over) = (f64::from(under[k]), f64::from(over[k]));
        (under + share * (over - under) + 0.5) as u8
    };
    [part(0), part(1), part(2)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facet(corners: [[f64; 3]; 3], colour: [u8; 3], opacity: f64) -> Facet {
        Facet { corners, shades: [1.0; 3], colour, opacity }
    }

    /// A right triangle with legs of 20 and 30 pixels covers 300 of them, and a rectangle of two triangles has no seam.
    #[test]
    fn areas_are_right() {
        let size = Size { width: 64, height: 64 };
        let black = |picture: &Picture| -> f64 {
            picture.pixels.iter().map(|[r, ..]| 1.0 - f64::from(*r) / 255.0).sum()
        };
        let corner = |x, y| [x, y, 1.0];
        let own = facet([corner(10.0, 10.0), corner(30.0, 10.0), corner(10.0, 40.0)], [0; 3], 1.0);
        assert!((black(&filled(&[own], size)) - 300.0).abs() < 3.0);
        let square = [corner(3.3, 5.1), corner(50.2, 9.0), corner(47.0, 60.0), corner(1.0, 58.0)];
        let halves =
            [[0, 1, 2], [0, 2, 3]].map(|at| facet(at.map(|i: usize| square[i]), [0; 3], 0.5));
        let picture = filled(&halves, size);
        let inner = (12..55).flat_map(|y| (6..45).map(move |x| y * 64 + x));
        for at in inner {
            assert_eq!(picture.pixels[at], [128; 3]);
        }
    }

    /// What is nearer hides what is farther, in any order, also where two triangles cross.
    #[test]
    fn the_nearest_is_seen() {
        let size = Size { width: 64, height: 64 };
        let all = |near: [f64; 3]| {
            let [a, b, c] = near;
            [[-80.0, 0.0, a], [160.0, 0.0, b], [32.0, 200.0, c]]
        };
        let red = facet(all([1.0; 3]), [255, 0, 0], 1.0);
        let far = facet(all([0.5; 3]), [0, 0, 255], 1.0);
        for both in [[red.clone(), far.clone()], [far, red.clone()]] {
            assert!(filled(&both, size).pixels.iter().all(|pixel| *pixel == [255, 0, 0]));
        }
        // Nearness goes from 0.5 to 1.5 across 240 pixels: it is 1 at x = 40.
        let tilted = facet(
            [[-80.0, 0.0, 0.5], [160.0, 0.0, 1.5], [32.0, 200.0, 0.5 + 112.0 / 240.0]],
            [0, 255, 0],
            1.0,
        );
        let picture = filled(&[red, tilted], size);
        for (x, colour) in [(38, [255, 0, 0]), (42, [0, 255, 0])] {
            assert_eq!(picture.pixels[30 * 64 + x], colour);
        }
    }
}
