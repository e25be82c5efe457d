//! Boxes, and points within them.

/// Lower and upper bound of every variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Bounds(Vec<[f64; 2]>);

impl Bounds {
    /// From `[lower, upper]` pairs.
    pub fn new(pairs: Vec<[f64; 2]>) -> Self {
        Self(pairs)
    }

    /// The number of variables.
    #[expect(clippy::len_without_is_empty, reason = "a problem has variables")]
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
    values: Vec<f64>,
}

impl Points {
    /// `count` points at the origin.
    pub fn zeros(dimension: usize, count: usize) -> Self {
        Self { dimension, values: vec![0.0; dimension * count] }
    }

    /// The number of points.
    pub fn len(&self) -> usize {
        self.values.len() / self.dimension
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// The points, in order.
    pub fn iter(&self) -> std::slice::ChunksExact<'_, f64> {
        self.values.chunks_exact(self.dimension)
    }

    /// The points, in order, to write to.
    pub fn iter_mut(&mut self) -> std::slice::ChunksExactMut<'_, f64> {
        self.values.chunks_exact_mut(self.dimension)
    }

    /// The first `count` points.
    #[must_use]
    pub fn prefix(&self, count: usize) -> Self {
        let values = self.values[..self.dimension * count].to_vec();
        Self { dimension: self.dimension, values }
    }
}

impl<'a> IntoIterator for &'a Points {
    type Item = &'a [f64];
    type IntoIter = std::slice::ChunksExact<'a, f64>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl<'a> IntoIterator for &'a mut Points {
    type Item = &'a mut [f64];
    type IntoIter = std::slice::ChunksExactMut<'a, f64>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter_mut()
    }
}

impl std::ops::Index<usize> for Points {
    type Output = [f64];

    fn index(&self, i: usize) -> &[f64] {
        &self.values[i * self.dimension..(i + 1) * self.dimension]
    }
}

impl std::ops::IndexMut<usize> for Points {
    fn index_mut(&mut self, i: usize) -> &mut [f64] {
        &mut self.values[i * self.dimension..(i + 1) * self.dimension]
    }
}
