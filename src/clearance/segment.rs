//! Distances of segments from each other and from boxes, in any number of lanes at once.

use crate::scalar::Scalar;
use crate::vec3::Vec3;

/// The points `middle + s half`, `s` from −1 to 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment<T> {
    pub(super) middle: Vec3<T>,
    pub(super) half: Vec3<T>,
}

/// The closest points of two segments.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nearest<T> {
    pub(super) squared: T,
    /// Where they are, each from −1 to 1.
    pub(super) places: [T; 2],
}

/// The point of a segment that is closest to a box.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reached<T> {
    pub(super) squared: T,
    /// Where it is, from −1 to 1.
    pub(super) place: T,
    /// Which of the edges, where there are several segments.
    pub(super) edge: T,
}

/// Within `−limit` and `limit`; NaN becomes `−limit`.
#[inline(always)]
fn within<T: Scalar>(x: T, limit: T) -> T {
    x.larger(-limit).smaller(limit)
}

/// The point of a box about the origin, along the axes, that is closest to another one.
#[inline(always)]
pub(super) fn clamped<T: Scalar>(p: Vec3<T>, half: Vec3<T>) -> Vec3<T> {
    Vec3::new(within(p.x, half.x), within(p.y, half.y), within(p.z, half.z))
}

/// The components.
#[inline(always)]
pub(super) fn array<T>(v: Vec3<T>) -> [T; 3] {
    [v.x, v.y, v.z]
}

impl<T: Scalar> Segment<T> {
    #[inline(always)]
    pub(super) fn at(&self, place: T) -> Vec3<T> {
        self.half.mul_add(place, self.middle)
    }

    /// Where the point is that is closest to another one, given the inverse of the square of `half`. A segment of no length has
    /// one point at any place.
    #[inline(always)]
    fn foot(&self, per_square: T, point: Vec3<T>) -> T {
        within((point - self.middle).dot(self.half) * per_square, T::of(1.0))
    }

    /// The closest points of two segments: between the lines if they are on both segments, else at an end of either.
    ///
    /// Parallel lines give NaN, which becomes an end.
    #[inline(always)]
    pub(super) fn nearest(&self, other: &Self) -> Nearest<T> {
        let one = T::of(1.0);
        let ours = one / self.half.dot(self.half);
        let theirs = one / other.half.dot(other.half);
        let across = self.half.cross(other.half);
        let way = other.middle - self.middle;
        let first = way.cross(other.half).dot(across) / across.dot(across);
        // Each foot takes away what rounding does where lines are nearly parallel.
        let second = other.foot(theirs, self.at(within(first, one)));
        let first = self.foot(ours, other.at(second));
        let mut best = self.between(other, [first, second]);
        for end in [-one, one] {
            best = best.or(self.between(other, [end, other.foot(theirs, self.at(end))]));
            best = best.or(self.between(other, [self.foot(ours, other.at(end)), end]));
        }
        best
    }

    #[inline(always)]
    fn between(&self, other: &Self, places: [T; 2]) -> Nearest<T> {
        let way = other.at(places[1]) - self.at(places[0]);
        Nearest { squared: way.dot(way), places }
    }

    /// The point that is closest to a box about the origin, along the axes.
    ///
    /// Half the slope of the squared distance is monotone along the segment, and linear between the places where
    /// the segment crosses the planes of the faces. Between the last place where it is not positive and the first where it is not
    /// negative it is zero.
    #[inline(always)]
    pub(super) fn reached(&self, half: Vec3<f64>) -> Reached<T> {
        let (zero, one) = (T::of(0.0), T::of(1.0));
        let half = half.lift();
        let (m, u, h) = (array(self.middle), array(self.half), array(half));
        let (mut low, mut low_slope) = (-one, self.slope(half, -one).smaller(zero));
        let (mut high, mut high_slope) = (one, self.slope(half, one).larger(zero));
        for i in 0..3 {
            let inverse = one / u[i];
            for face in [-h[i], h[i]] {
                let place = within((face - m[i]) * inverse, one);
                let slope = self.slope(half, place);
                let is_low = slope.smaller(zero) - slope;
                let is_high = slope - slope.larger(zero);
                low = is_low.select_below(0.0, low, place.larger(low));
                low_slope = is_low.select_below(0.0, low_slope, slope.larger(low_slope));
                high = is_high.select_below(0.0, high, place.smaller(high));
                high_slope = is_high.select_below(0.0, high_slope, slope.smaller(high_slope));
            }
        }
        let rise = high_slope - low_slope;
        let share = (-rise).select_below(0.0, -low_slope / rise, T::of(0.5));
        let place = within((high - low).mul_add(share, low), one);
        let out = self.beyond(half, place);
        Reached { squared: out.dot(out), place, edge: zero }
    }

    /// From the box's closest point to the segment's point.
    #[inline(always)]
    fn beyond(&self, half: Vec3<T>, place: T) -> Vec3<T> {
        let p = self.at(place);
        p - clamped(p, half)
    }

    #[inline(always)]
    fn slope(&self, half: Vec3<T>, place: T) -> T {
        self.beyond(half, place).dot(self.half)
    }

    /// What planes along the faces of a box about the origin leave free between it and the segment: the most of the three.
    #[inline(always)]
    fn face_gap(&self, half: Vec3<f64>) -> T {
        let gap = self.gaps(half);
        gap.x.larger(gap.y).larger(gap.z)
    }

    #[inline(always)]
    fn gaps(&self, half: Vec3<f64>) -> Vec3<T> {
        let (m, u, h) = (self.middle.map(T::abs), self.half.map(T::abs), half.lift());
        m - u - h
    }

    /// No point of the segment is closer to a box about the origin than this, squared.
    #[inline(always)]
    pub(super) fn least_squared(&self, half: Vec3<f64>) -> T {
        let gap = self.gaps(half).map(|gap| gap.larger(T::of(0.0)));
        gap.dot(gap)
    }

    /// The same by a plane across a unit vector.
    #[inline(always)]
    pub(super) fn least_along(&self, normal: Vec3<T>, half: Vec3<f64>) -> T {
        let reach = normal.map(T::abs).dot(half.lift());
        let gap = normal.dot(self.middle) - normal.dot(self.half).abs() - reach;
        let gap = gap.larger(T::of(0.0));
        gap * gap
    }

    /// What planes along the segment and an edge of a box about the origin leave free.
    #[inline(always)]
    fn crossed_gaps(&self, half: Vec3<f64>) -> [Gap<T>; 3] {
        let (m, u, h) = (array(self.middle), array(self.half), array(half.lift()));
        let mut gaps = [Gap::nothing(); 3];
        for (i, gap) in gaps.iter_mut().enumerate() {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let along = u[k].mul_sub_from(m[j], u[j] * m[k]).abs();
            let reach = u[k].abs().mul_add(h[j], u[j].abs() * h[k]);
            *gap = Gap { scaled: along - reach, squared: u[j].mul_add(u[j], u[k] * u[k]) };
        }
        gaps
    }

    /// Clearance of the capsule of this radius from a box about the origin, along the axes. From `far` on a lower bound, which is not
    /// below `far`, may be told; which of both is told does not depend on the other lanes.
    #[inline(always)]
    pub(super) fn clearance(&self, radius: f64, half: Vec3<f64>, far: f64) -> T {
        let (face, radius) = (self.face_gap(half), T::of(radius));
        let near = T::of(far) - (face - radius);
        if near.all_below(0.0) {
            return face - radius;
        }
        let parted = parted(face, &self.crossed_gaps(half));
        if parted.all_below(0.0) {
            return parted - radius;
        }
        let apart = near.select_below(0.0, face, self.reached(half).squared.sqrt());
        parted.select_below(0.0, parted, apart) - radius
    }
}

/// What a plane leaves free between two bodies, negative where they overlap: as a multiple of the length of a normal, and that
/// length squared.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gap<T> {
    pub(super) scaled: T,
    pub(super) squared: T,
}

impl<T: Scalar> Gap<T> {
    #[inline(always)]
    pub(super) fn nothing() -> Self {
        Self { scaled: T::of(0.0), squared: T::of(0.0) }
    }

    /// Minus infinity where the normal has no length.
    #[inline(always)]
    pub(super) fn width(self) -> T {
        let width = self.scaled / self.squared.sqrt();
        self.squared.select_below(1e-200, T::of(f64::NEG_INFINITY), width)
    }
}

/// Positive where some plane parts both bodies, else the widest gap.
///
/// Signs need no roots nor quotients, which are slow, and most bodies are apart.
#[inline(always)]
pub(super) fn parted<T: Scalar, const N: usize>(face: T, crossed: &[Gap<T>; N]) -> T {
    let mut sign = face;
    for gap in crossed {
        sign = gap.scaled.larger(sign);
    }
    if (-sign).all_below(0.0) {
        return sign;
    }
    let mut widest = face;
    for gap in crossed {
        widest = gap.width().larger(widest);
    }
    widest
}

impl<T: Scalar> Nearest<T> {
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        let less = other.squared - self.squared;
        let choose = |a: T, b: T| less.select_below(0.0, b, a);
        Self {
            squared: choose(self.squared, other.squared),
            places: [
                choose(self.places[0], other.places[0]),
                choose(self.places[1], other.places[1]),
            ],
        }
    }
}

impl<T: Scalar> Reached<T> {
    #[inline(always)]
    pub(super) fn or(self, other: Self) -> Self {
        let less = other.squared - self.squared;
        let choose = |a: T, b: T| less.select_below(0.0, b, a);
        Self {
            squared: choose(self.squared, other.squared),
            place: choose(self.place, other.place),
            edge: choose(self.edge, other.edge),
        }
    }
}
