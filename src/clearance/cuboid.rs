//! Distances of boxes, in any number of lanes at once.

use super::segment::{Gap, Reached, Segment, array, clamped, parted};
use crate::scalar::Scalar;
use crate::vec3::{Mat3, Vec3};

/// A solid box; its half edges are the same in every lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cuboid<T> {
    pub(super) centre: Vec3<T>,
    /// Turns the box's axes into those that the centre is in.
    pub(super) axes: Mat3<T>,
    pub(super) half: Vec3<f64>,
}

/// The signs of the four edges along each axis.
const SIGNS: [[f64; 2]; 4] = [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]];

/// With room for rounding, also where bodies touch: so no edge is left out in one company of lanes and not in another that could
/// be the closest.
#[inline(always)]
fn roomy<T: Scalar>(squared: T) -> T {
    squared.mul_add(T::of(1.0 + 1e-9), T::of(1e-20))
}

impl<T: Scalar> Cuboid<T> {
    /// A segment in the box's axes.
    #[inline(always)]
    pub(super) fn inward(&self, segment: &Segment<T>) -> Segment<T> {
        Segment {
            middle: self.axes.tr_mul(segment.middle - self.centre),
            half: self.axes.tr_mul(segment.half),
        }
    }

    /// Another box in this one's axes.
    #[inline(always)]
    pub(super) fn relative(&self, other: &Self) -> Self {
        let [x, y, z] = other.axes.0;
        Self {
            centre: self.axes.tr_mul(other.centre - self.centre),
            axes: Mat3([self.axes.tr_mul(x), self.axes.tr_mul(y), self.axes.tr_mul(z)]),
            half: other.half,
        }
    }

    /// One of the twelve edges: four along each axis.
    #[inline(always)]
    pub(super) fn edge(&self, number: usize) -> Segment<T> {
        let (i, signs) = (number / 4, SIGNS[number % 4]);
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let ([x, y, z], half) = (self.axes.0, array(self.half));
        let edges = [x, y, z];
        let side = edges[j].times(signs[0] * half[j]) + edges[k].times(signs[1] * half[k]);
        Segment { middle: self.centre + side, half: edges[i].times(half[i]) }
    }

    /// The point of the box that is closest to another one.
    #[inline(always)]
    pub(super) fn closest(&self, point: Vec3<T>) -> Vec3<T> {
        let p = self.axes.tr_mul(point - self.centre);
        self.centre + self.axes * clamped(p, self.half.lift())
    }

    /// The closest of all edges to the other box: 0 to 11 are the other's, 12 to 23 this one's.
    ///
    /// Any two points of both bound the distance from above, and planes across the way between them and along the faces bound that
    /// of each edge from below. Edges that are too far are left out.
    #[inline(always)]
    pub(super) fn reached(&self, other: &Self) -> Reached<T> {
        let theirs = self.relative(other);
        let mut second = theirs.closest(Vec3::zero());
        let mut first = clamped(second, self.half.lift());
        for _ in 0..2 {
            second = theirs.closest(first);
            first = clamped(second, self.half.lift());
        }
        let way = second - first;
        let squared = way.dot(way);
        let normal = way * (T::of(1.0) / squared.sqrt());
        let mut most = roomy(squared);
        let nothing = T::of(f64::INFINITY);
        let mut best = Reached { squared: nothing, place: T::of(0.0), edge: T::of(0.0) };
        let sides = [
            (theirs, self.half, normal),
            (other.relative(self), other.half, -theirs.axes.tr_mul(normal)),
        ];
        for number in 0..24 {
            let (box_of_edges, half, normal) = &sides[number / 12];
            let edge = box_of_edges.edge(number % 12);
            let least = edge.least_squared(*half).larger(edge.least_along(*normal, *half));
            if (most - least).all_below(0.0) {
                continue;
            }
            let mut reached = edge.reached(*half);
            reached.edge = T::of(number as f64);
            best = best.or(reached);
            most = roomy(best.squared).smaller(most);
        }
        best
    }

    /// What planes along faces leave free: those of a box about the origin along the axes, then those of this one.
    #[inline(always)]
    pub(super) fn face_gaps(&self, half: Vec3<f64>) -> [T; 6] {
        let ([x, y, z], m) = (self.axes.0, array(self.centre));
        let (b, a) = (array::<T>(self.half.lift()), half.lift::<T>());
        let [p, q, r] = [x, y, z].map(|axis| axis.map(T::abs));
        let theirs = array(p * b[0] + q * b[1] + r * b[2]);
        let ours = [p.dot(a), q.dot(a), r.dot(a)];
        let middles = [x.dot(self.centre), y.dot(self.centre), z.dot(self.centre)];
        let a = array(a);
        let mut gaps = [T::of(0.0); 6];
        for i in 0..3 {
            gaps[i] = m[i].abs() - a[i] - theirs[i];
            gaps[3 + i] = middles[i].abs() - b[i] - ours[i];
        }
        gaps
    }

    /// What planes along two edges leave free between a box about the origin, along the axes, and this one: that box's first edge with each of
    /// this one's, and so on.
    #[inline(always)]
    pub(super) fn crossed_gaps(&self, half: Vec3<f64>) -> [Gap<T>; 9] {
        let [x, y, z] = self.axes.0;
        let (columns, m) = ([array(x), array(y), array(z)], array(self.centre));
        let (b, a) = (array::<T>(self.half.lift()), array::<T>(half.lift()));
        let mut gaps = [Gap::nothing(); 9];
        for i in 0..3 {
            let (p, q) = ((i + 1) % 3, (i + 2) % 3);
            for j in 0..3 {
                // Not by the third row of the matrix: of nearly parallel edges its entry has no digit in common with this.
                let c = &columns[j];
                let [r, s] = [&columns[(j + 1) % 3], &columns[(j + 2) % 3]];
                let along = c[q].mul_sub_from(m[p], c[p] * m[q]).abs();
                let along_r = c[q].mul_sub_from(r[p], c[p] * r[q]).abs();
                let along_s = c[q].mul_sub_from(s[p], c[p] * s[q]).abs();
                let reach = c[q].abs().mul_add(a[p], c[p].abs() * a[q])
                    + along_r.mul_add(b[(j + 1) % 3], along_s * b[(j + 2) % 3]);
                let squared = c[p].mul_add(c[p], c[q] * c[q]);
                gaps[3 * i + j] = Gap { scaled: along - reach, squared };
            }
        }
        gaps
    }

    /// Clearance of two boxes. From `far` on a lower bound, which is not below `far`, may be told, as for segments.
    #[inline(always)]
    pub(super) fn clearance(&self, other: &Self, far: f64) -> T {
        let relative = self.relative(other);
        let gaps = relative.face_gaps(self.half);
        let mut face = gaps[0];
        for gap in &gaps[1..] {
            face = gap.larger(face);
        }
        let near = T::of(far) - face;
        if near.all_below(0.0) {
            return face;
        }
        let parted = parted(face, &relative.crossed_gaps(self.half));
        if parted.all_below(0.0) {
            return parted;
        }
        let apart = near.select_below(0.0, face, self.reached(other).squared.sqrt());
        parted.select_below(0.0, parted, apart)
    }
}
