//! What is filled: triangles in the picture.

/// A triangle in the picture.
#[derive(Debug, Clone)]
pub(super) struct Facet {
    /// To the right and down \[pixels\], and the inverse of the depth.
    pub(super) corners: [[f64; 3]; 3],
    /// How bright each corner is, from 0 to 1.
    pub(super) shades: [f64; 3],
    pub(super) colour: [u8; 3],
    /// Facets that are seen through come after all others and hide nothing.
    pub(super) opacity: f64,
}

impl Facet {
    /// Whether it lies between the eye and a place.
    pub(super) fn hides(&self, [x, y, nearness]: [f64; 3]) -> bool {
        let [a, b, c] = self.corners;
        let cross = |[ux, uy, _]: [f64; 3], [vx, vy, _]: [f64; 3]| {
            (ux - x) * (vy - y) - (uy - y) * (vx - x)
        };
        let parts = [cross(b, c), cross(c, a), cross(a, b)];
        let area: f64 = parts.iter().sum();
        let is_within = parts.iter().all(|part| part * area > 0.0);
        let own = (parts[0] * a[2] + parts[1] * b[2] + parts[2] * c[2]) / area;
        self.opacity >= 1.0 && is_within && own > nearness
    }

    /// A piece of a line of some width \[pixels\].
    pub(super) fn of_line(
        ends: [[f64; 3]; 2],
        width: f64,
        colour: [u8; 3],
        opacity: f64,
    ) -> [Self; 2] {
        let [from, to] = ends;
        let [x, y] = [to[0] - from[0], to[1] - from[1]];
        let length = x.hypot(y);
        let [x, y] = if length > 0.0 { [x / length, y / length] } else { [1.0, 0.0] };
        let half = 0.5 * width;
        // A little longer than it is, so that pieces join around bends.
        let corner = |at: [f64; 3], out: f64, aside: f64| {
            let (out, aside) = (0.5 * half * out, half * aside);
            [at[0] + out * x - aside * y, at[1] + out * y + aside * x, at[2]]
        };
        let corners = [
            corner(from, -1.0, -1.0),
            corner(to, 1.0, -1.0),
            corner(to, 1.0, 1.0),
            corner(from, -1.0, 1.0),
        ];
        [[0, 1, 2], [0, 2, 3]].map(|at| Self {
            corners: at.map(|i: usize| corners[i]),
            shades: [1.0; 3],
            colour,
            opacity,
        })
    }
}
