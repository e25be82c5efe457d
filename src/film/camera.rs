//! Where a film is seen from.

use std::fmt;
use std::str::FromStr;

use nalgebra::Vector3;

use super::picture::Size;

/// Distance of the eye from a picture of height one that it sees: a field of 29° from top to bottom.
const FOCAL: f64 = 1.9;

/// Shares of the picture left free at either side, at the top and at the bottom, where the text is.
const SIDE: f64 = 0.04;
const TOP: f64 = 0.05;
const BOTTOM: f64 = 0.12;

/// A direction to look from, in inertial axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// From the x axis towards the y axis \[°\].
    pub azimuth: f64,
    /// Above the plane of both \[°\].
    pub elevation: f64,
}

impl Default for View {
    fn default() -> Self {
        Self { azimuth: -58.0, elevation: 25.0 }
    }
}

impl fmt::Display for View {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{}", self.azimuth, self.elevation)
    }
}

/// `-58,25`.
impl FromStr for View {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let angle = |text: &str| text.trim().parse().ok().filter(|angle: &f64| angle.is_finite());
        let angles = text.split_once(',');
        match angles.and_then(|(a, e)| Some([angle(a)?, angle(e)?])) {
            Some([azimuth, elevation]) if elevation.abs() <= 90.0 => {
                Ok(Self { azimuth, elevation })
            }
            _ => {
                Err("expected azimuth and elevation in degrees, the latter from -90 to 90: -58,25"
                    .to_owned())
            }
        }
    }
}

/// A camera in perspective.
#[derive(Debug, Clone)]
pub struct Camera {
    right: Vector3<f64>,
    up: Vector3<f64>,
    towards: Vector3<f64>,
    /// What is in the middle \[m\].
    target: Vector3<f64>,
    /// How far the eye is from it \[m\].
    distance: f64,
    /// Pixels per unit of slope.
    focal: f64,
    /// The middle of what is free for the drawing \[pixels\].
    middle: [f64; 2],
}

impl Camera {
    /// Sees all places from a direction, as large as they fit the picture.
    pub fn around(places: &[Vector3<f64>], view: View, size: Size) -> Self {
        let [azimuth, elevation] = [view.azimuth, view.elevation].map(f64::to_radians);
        let right = Vector3::new(-azimuth.sin(), azimuth.cos(), 0.0);
        let towards = Vector3::new(
            azimuth.cos() * elevation.cos(),
            azimuth.sin() * elevation.cos(),
            elevation.sin(),
        );
        let (width, height) = (size.width as f64, size.height as f64);
        let half = [width * (0.5 - SIDE), height * (1.0 - TOP - BOTTOM) / 2.0];
        let mut camera = Self {
            right,
            up: towards.cross(&right),
            towards,
            target: Vector3::zeros(),
            distance: 1.0,
            focal: FOCAL * height.min(width),
            middle: [width / 2.0, height * TOP + half[1]],
        };
        let middle_of = |values: &mut dyn Iterator<Item = f64>| {
            let ends = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
                [low.min(value), high.max(value)]
            });
            0.5 * (ends[0] + ends[1])
        };
        if places.is_empty() {
            return camera;
        }
        let axes = [camera.right, camera.up, camera.towards];
        camera.target =
            axes.iter().map(|axis| axis * middle_of(&mut places.iter().map(|p| axis.dot(p)))).sum();
        // What is nearer looks larger, so the middle of the places is not that of their picture.
        for _ in 0..8 {
            camera.distance = camera.fitting_distance(places, half);
            let seen: Vec<[f64; 3]> = places.iter().map(|place| camera.project(place)).collect();
            let shift =
                [0, 1].map(|k| middle_of(&mut seen.iter().map(|at| at[k])) - camera.middle[k]);
            let scale = camera.distance / camera.focal;
            camera.target += camera.right * shift[0] * scale - camera.up * shift[1] * scale;
        }
        camera.distance = camera.fitting_distance(places, half);
        camera
    }

    /// The least distance from which all places are within half a width and half a height of the middle \[pixels\].
    fn fitting_distance(&self, places: &[Vector3<f64>], half: [f64; 2]) -> f64 {
        let needed = places.iter().map(|place| {
            let offset = place - self.target;
            let slope =
                |axis: &Vector3<f64>, half: f64| axis.dot(&offset).abs() * self.focal / half;
            let across = slope(&self.right, half[0]).max(slope(&self.up, half[1]));
            self.towards.dot(&offset) + across
        });
        needed.fold(1e-3, f64::max)
    }

    /// Where a place is in the picture: to the right and down \[pixels\], and the inverse of its depth \[1/m\].
    pub(super) fn project(&self, place: &Vector3<f64>) -> [f64; 3] {
        let offset = place - self.target;
        let nearness = (self.distance - self.towards.dot(&offset)).recip();
        let [x, y] = [self.right.dot(&offset), -self.up.dot(&offset)];
        let [middle_x, middle_y] = self.middle;
        [middle_x + self.focal * x * nearness, middle_y + self.focal * y * nearness, nearness]
    }

    /// The eye \[m\].
    pub(super) fn eye(&self) -> Vector3<f64> {
        self.target + self.towards * self.distance
    }

    /// Where light comes from: over the left shoulder.
    pub(super) fn light(&self) -> Vector3<f64> {
        (self.towards * 0.75 + self.up * 0.75 - self.right * 0.4).normalize()
    }

    /// The share of a nearness that a pixel at the middle's depth is wide.
    pub(super) fn pixel(&self) -> f64 {
        self.focal.recip()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seen along the x axis, `y = f Y / (d − X)` (any textbook): of a block of one metre depth the front face fills the free height of
    /// 5 % to 88 % of the picture, and inverse depths of both faces are a metre apart.
    #[test]
    fn what_is_nearest_fills_the_picture() {
        let corner = |x: f64, z: f64| Vector3::new(x, 0.0, z);
        let corners = [corner(0.5, 1.0), corner(0.5, -1.0), corner(-0.5, 1.0), corner(-0.5, -1.0)];
        let view = View { azimuth: 0.0, elevation: 0.0 };
        let camera = Camera::around(&corners, view, Size::FULL_HD);
        let [top, bottom, farther, _] = corners.map(|corner| camera.project(&corner));
        assert!((top[0] - 960.0).abs() < 1e-9, "{top:?}");
        assert!((top[1] - 0.05 * 1080.0).abs() < 1e-6, "{top:?}");
        assert!((bottom[1] - 0.88 * 1080.0).abs() < 1e-6, "{bottom:?}");
        assert!((farther[2].recip() - top[2].recip() - 1.0).abs() < 1e-9);
        let middle = f64::midpoint(top[1], bottom[1]);
        let [near, far] = [top, farther].map(|at| (at[1] - middle) / at[2]);
        assert!((near - far).abs() < 1e-6, "{near} {far}");
    }

    #[test]
    fn views_are_two_angles() {
        assert_eq!("30, -5".parse(), Ok(View { azimuth: 30.0, elevation: -5.0 }));
        for wrong in ["", "30", "30,95", "nan,0", "a,b"] {
            assert!(wrong.parse::<View>().is_err(), "{wrong}");
        }
    }
}
