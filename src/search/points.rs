//! Boxes, and points within them.

use std::iter::FusedIterator;
use std::ops::{Index, IndexMut};

/// Lower and upper bound of every variable: finite, the lower one first. A variable whose bounds are equal
/// is fixed.
#[derive(Debug, Clone, PartialEq)]
pub struct Bounds(Vec<[f64; 2]>);

/// Bounds that are none.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BoundsError {
    /// A box has at least one variable.
    #[error("found no variables, expected at least one")]
    NoVariables,
    /// A bound is NaN or infinite, or their distance is infinite.
    #[error(
        "found bounds {lower} and {upper} of x[{variable}], expected finite bounds a finite distance apart"
    )]
    NotFinite {
        /// Index of the variable.
        variable: usize,
        /// The first bound.
        lower: f64,
        /// The second bound.
        upper: f64,
    },
    /// The lower bound is above the upper one.
    #[error("found bounds {lower} and {upper} of x[{variable}], expected the lower bound first")]
    Reversed {
        /// Index of the variable.
        variable: usize,
        /// The first bound.
        lower: f64,
        /// The second bound.
        upper: f64,
    },
}

impl Bounds {
    /// From `[lower, upper]` pairs, at least one.
    pub fn new(pairs: Vec<[f64; 2]>) -> Result<Self, BoundsError> {
        if pairs.is_empty() {
            return Err(BoundsError::NoVariables);
        }
        for (variable, &[lower, upper]) in pairs.iter().enumerate() {
            // NaN in either bound makes the difference NaN, an infinite one infinite or NaN.
            if !(upper - lower).is_finite() {
                return Err(BoundsError::NotFinite { variable, lower, upper });
            }
            if lower > upper {
                return Err(BoundsError::Reversed { variable, lower, upper });
            }
        }
        Ok(Self(pairs))
    }

    /// The same bounds for every variable.
    ///
    /// # Panics
    ///
    /// Panics where [`new`](Self::new) refuses them.
    pub fn cube(dimension: usize, [lower, upper]: [f64; 2]) -> Self {
        assert!(dimension > 0, "a box needs a variable");
        assert!(lower <= upper && (upper - lower).is_finite(), "{lower} to {upper} is no interval");
        Self(vec![[lower, upper]; dimension])
    }

    /// The number of variables.
    #[expect(clippy::len_without_is_empty, reason = "a box has variables")]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// The pairs, in the order of the variables.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = [f64; 2]> {
        self.0.iter().copied()
    }

    /// Whether every variable is within its bounds.
    pub fn contains(&self, x: &[f64]) -> bool {
        x.len() == self.len() && self.0.iter().zip(x).all(|([l, u], x)| (l..=u).contains(&x))
    }
}

/// Points of one dimension, one after the other.
#[derive(Debug, Clone)]
pub struct Points {
    dimension: usize,
    count: usize,
    /// Of length `dimension · count`.
    values: Vec<f64>,
}

impl Points {
    /// `count` points at the origin.
    pub fn zeros(dimension: usize, count: usize) -> Self {
        Self { dimension, count, values: vec![0.0; dimension * count] }
    }

    /// The number of variables of each point.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// The number of points.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The points, in order.
    pub fn iter(&self) -> PointsIter<'_> {
        PointsIter { dimension: self.dimension, left: self.count, values: &self.values }
    }

    /// The points, in order, to write to.
    pub fn iter_mut(&mut self) -> PointsIterMut<'_> {
        PointsIterMut { dimension: self.dimension, left: self.count, values: &mut self.values }
    }

    /// The first `count` points, or all where there are fewer.
    #[must_use]
    pub fn prefix(&self, count: usize) -> Self {
        let (dimension, count) = (self.dimension, count.min(self.count));
        Self { dimension, count, values: self.values[..dimension * count].to_vec() }
    }
}

/// Iterates over [`Points`].
#[derive(Debug, Clone)]
pub struct PointsIter<'a> {
    dimension: usize,
    left: usize,
    values: &'a [f64],
}

/// Iterates over [`Points`], to write to.
#[derive(Debug)]
pub struct PointsIterMut<'a> {
    dimension: usize,
    left: usize,
    values: &'a mut [f64],
}

impl<'a> Iterator for PointsIter<'a> {
    type Item = &'a [f64];

    fn next(&mut self) -> Option<&'a [f64]> {
        self.left = self.left.checked_sub(1)?;
        let (point, others) = self.values.split_at(self.dimension);
        self.values = others;
        Some(point)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.left, Some(self.left))
    }
}

impl<'a> Iterator for PointsIterMut<'a> {
    type Item = &'a mut [f64];

    fn next(&mut self) -> Option<&'a mut [f64]> {
        self.left = self.left.checked_sub(1)?;
        let (point, others) = std::mem::take(&mut self.values).split_at_mut(self.dimension);
        self.values = others;
        Some(point)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.left, Some(self.left))
    }
}

impl ExactSizeIterator for PointsIter<'_> {}
impl ExactSizeIterator for PointsIterMut<'_> {}
impl FusedIterator for PointsIter<'_> {}
impl FusedIterator for PointsIterMut<'_> {}

impl<'a> IntoIterator for &'a Points {
    type Item = &'a [f64];
    type IntoIter = PointsIter<'a>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl<'a> IntoIterator for &'a mut Points {
    type Item = &'a mut [f64];
    type IntoIter = PointsIterMut<'a>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter_mut()
    }
}

impl Index<usize> for Points {
    type Output = [f64];

    fn index(&self, i: usize) -> &[f64] {
        &self.values[i * self.dimension..(i + 1) * self.dimension]
    }
}

impl IndexMut<usize> for Points {
    fn index_mut(&mut self, i: usize) -> &mut [f64] {
        &mut self.values[i * self.dimension..(i + 1) * self.dimension]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_checked() {
        assert_eq!(Bounds::new(vec![]), Err(BoundsError::NoVariables));
        assert!(Bounds::new(vec![[1.0, 1.0], [-2.0, 3.0]]).is_ok());
        let told = |pair| Bounds::new(vec![[0.0, 1.0], pair]).map_err(|error| error.to_string());
        let expected = "expected finite bounds a finite distance apart";
        for (pair, found) in [
            ([f64::NAN, 1.0], "NaN and 1"),
            ([0.0, f64::INFINITY], "0 and inf"),
            ([f64::INFINITY, f64::INFINITY], "inf and inf"),
        ] {
            assert_eq!(told(pair), Err(format!("found bounds {found} of x[1], {expected}")));
        }
        assert!(matches!(
            Bounds::new(vec![[-1.5e308, 1.5e308]]),
            Err(BoundsError::NotFinite { variable: 0, .. })
        ));
        let reversed = "found bounds 2 and 1 of x[1], expected the lower bound first";
        assert_eq!(told([2.0, 1.0]), Err(reversed.to_owned()));
    }

    #[test]
    fn points_of_no_variables_are_counted() {
        let mut points = Points::zeros(0, 3);
        assert_eq!((points.len(), points.iter().count(), points.iter_mut().count()), (3, 3, 3));
        assert_eq!((points.prefix(2).len(), points.prefix(9).len()), (2, 3));
        assert!(points[2].is_empty());
    }

    #[test]
    fn points_are_one_after_the_other() {
        let mut points = Points::zeros(2, 3);
        for (x, i) in points.iter_mut().zip(0..) {
            x.fill(f64::from(i));
        }
        let rows: Vec<&[f64]> = points.iter().collect();
        assert_eq!(rows, [[0.0; 2], [1.0; 2], [2.0; 2]]);
        assert_eq!(points.prefix(1).iter().len(), 1);
    }
}
