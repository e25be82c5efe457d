//! Costs that are sums of convex functions of smooth pieces; the module's page has the mathematics.

use nalgebra::DVector;

use super::evaluation::Evaluation;
use super::failure::Failure;
use super::subgradient::Subgradient;

/// A convex function `φ` of the values `v` of a term's pieces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Shape {
    /// `‖v‖`, the Euclidean norm.
    Norm,
    /// The largest `v_i`.
    Max,
    /// `Σ_i max(0, v_i)`.
    Hinge,
}

impl Shape {
    /// `φ(v)`; zero without a value, and NaN where one is NaN.
    pub fn of(self, values: impl IntoIterator<Item = f64>) -> f64 {
        let mut values = values.into_iter();
        match self {
            Self::Norm => values.fold(0.0, |sum, v| sum + v * v).sqrt(),
            Self::Max => {
                let Some(first) = values.next() else { return 0.0 };
                values.fold(first, larger)
            }
            Self::Hinge => values.fold(0.0, |sum, v| sum + larger(v, 0.0)),
        }
    }
}

/// The larger of two numbers; NaN where one of them is.
fn larger(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

/// What tells a piece from the others of its term, the same at points that are near.
///
/// A maximum over a curve has one piece per local peak: its track says which curve it is on, its
/// place where. As the point moves, so does the peak, and others appear and vanish. A piece that is
/// there at every point has a track of its own. No two pieces of a term have the same id.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PieceId {
    /// Pieces on different tracks are different.
    pub track: u64,
    /// Where on its track the piece is; a track is about one long.
    pub place: f64,
}

impl PieceId {
    /// How far on its track a piece may move in a step.
    const SAME: f64 = 0.1;

    /// A piece that is alone on its track.
    pub fn alone(track: u64) -> Self {
        Self { track, place: 0.0 }
    }

    /// The piece that continues this one at another point: the nearest on its track, if it is near.
    pub fn continued<'a>(&self, there: &'a [Piece]) -> Option<&'a Piece> {
        let distance = |p: &&Piece| (p.id.place - self.place).abs();
        let same = there.iter().filter(|p| p.id.track == self.track);
        same.min_by(|a, b| distance(a).total_cmp(&distance(b))).filter(|p| distance(p) < Self::SAME)
    }
}

/// A smooth function, one of the `v_i`, at a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// What tells it from the others of its term.
    pub id: PieceId,
    /// Its value.
    pub value: f64,
    /// Its derivative by each variable, as many as the problem has.
    pub gradient: DVector<f64>,
}

impl Piece {
    /// A piece that is alone on its track.
    pub fn new(track: u64, value: f64, gradient: impl Into<Vec<f64>>) -> Self {
        Self { id: PieceId::alone(track), value, gradient: DVector::from_vec(gradient.into()) }
    }
}

/// `w φ(v)` at a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// `w`, finite and not negative.
    pub weight: f64,
    /// `φ`.
    pub shape: Shape,
    /// `v`. Of a maximum or a hinge, pieces that matter nowhere near may be left out.
    pub pieces: Vec<Piece>,
    /// What `φ(v)` is known never to fall below at any point, however low linearised pieces lie.
    pub floor: f64,
}

impl Term {
    /// `w ‖v‖`.
    pub fn norm(weight: f64, pieces: Vec<Piece>) -> Self {
        Self { weight, shape: Shape::Norm, pieces, floor: 0.0 }
    }

    /// `w max_i v_i`, without a floor.
    pub fn max(weight: f64, pieces: Vec<Piece>) -> Self {
        Self { weight, shape: Shape::Max, pieces, floor: f64::NEG_INFINITY }
    }

    /// `w Σ_i max(0, v_i)`.
    pub fn hinge(weight: f64, pieces: Vec<Piece>) -> Self {
        Self { weight, shape: Shape::Hinge, pieces, floor: 0.0 }
    }

    /// The term with this floor.
    #[must_use]
    pub fn at_least(self, floor: f64) -> Self {
        Self { floor, ..self }
    }

    /// `w φ(v)`.
    pub fn cost(&self) -> f64 {
        self.weight * self.value()
    }

    /// `φ(v)`.
    pub fn value(&self) -> f64 {
        self.shape.of(self.pieces.iter().map(|piece| piece.value))
    }

    /// `φ` of other values of the pieces, such as linearised ones, and no less than the floor.
    pub fn value_at(&self, values: impl IntoIterator<Item = f64>) -> f64 {
        larger(self.shape.of(values), self.floor)
    }

    /// What the pieces' gradients are multiplied with in a subgradient of `w φ(v)`: at a kink that of the first of the
    /// largest pieces of a maximum, and none of a norm or of a hinge's piece that is zero.
    fn weights(&self) -> Vec<f64> {
        let values = self.pieces.iter().map(|piece| piece.value);
        let value = self.value();
        match self.shape {
            Shape::Norm if value == 0.0 => vec![0.0; self.pieces.len()],
            Shape::Norm => values.map(|v| self.weight * v / value).collect(),
            Shape::Max => {
                let first = self.pieces.iter().position(|piece| piece.value == value);
                let weight = |i| if Some(i) == first { self.weight } else { 0.0 };
                (0..self.pieces.len()).map(weight).collect()
            }
            Shape::Hinge => values.map(|v| if v > 0.0 { self.weight } else { 0.0 }).collect(),
        }
    }

    /// Adds a subgradient of `w φ(v)`.
    pub(super) fn add_slopes(&self, slopes: &mut DVector<f64>) {
        for (piece, weight) in self.pieces.iter().zip(self.weights()) {
            if weight != 0.0 {
                slopes.axpy(weight, &piece.gradient, 1.0);
            }
        }
    }

    /// By how much each piece changes over a step, to first order.
    pub fn changes(&self, step: &DVector<f64>) -> Vec<f64> {
        // Of the two orders in which the products can be summed the first is that of a matrix times a vector.
        if self.shape == Shape::Norm {
            let mut changes = vec![0.0; self.pieces.len()];
            for (j, d) in step.iter().enumerate() {
                for (change, piece) in changes.iter_mut().zip(&self.pieces) {
                    *change += piece.gradient[j] * d;
                }
            }
            changes
        } else {
            self.pieces.iter().map(|piece| piece.gradient.dot(step)).collect()
        }
    }
}

/// The terms of a cost at a point.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Linearisation {
    /// As many at every point, in the same order, with the same weights and shapes.
    pub terms: Vec<Term>,
    /// By how much the point breaks the problem's limits, as in [`Evaluation`].
    pub violation: f64,
}

impl Linearisation {
    /// At a point within all limits.
    pub fn new(terms: Vec<Term>) -> Self {
        Self { terms, violation: 0.0 }
    }

    /// The same at a point that breaks limits by so much.
    #[must_use]
    pub fn with_violation(self, violation: f64) -> Self {
        Self { violation, ..self }
    }

    /// Cost and violation.
    pub fn evaluation(&self) -> Evaluation {
        Evaluation::new(self.cost(), self.violation)
    }

    /// `J`.
    pub fn cost(&self) -> f64 {
        self.terms.iter().map(Term::cost).sum()
    }

    /// Cost and violation, and a subgradient of the cost in so many variables.
    pub fn subgradient(&self, variables: usize) -> Subgradient {
        let mut slopes = DVector::zeros(variables);
        self.terms.iter().for_each(|term| term.add_slopes(&mut slopes));
        Subgradient { evaluation: self.evaluation(), slopes }
    }

    /// The weight and shape of every term.
    pub(super) fn form(&self) -> impl Iterator<Item = (f64, Shape)> {
        self.terms.iter().map(|term| (term.weight, term.shape))
    }

    /// Whether the terms have the form that they had at another point, weights are sound, pieces of a term have
    /// different ids, and every gradient has so many components.
    pub(super) fn check(&self, variables: usize, form: &[(f64, Shape)]) -> Result<(), Failure> {
        for (k, term) in self.terms.iter().enumerate() {
            let weight = term.weight;
            if !(weight.is_finite() && weight >= 0.0) {
                let expected = "expected a finite weight of zero or more";
                return Err(format!("found the weight {weight} of term {k}, {expected}").into());
            }
            let lengths = term.pieces.iter().map(|piece| piece.gradient.len());
            if let Some(found) = lengths.into_iter().find(|&found| found != variables) {
                let place = format!("in term {k}, expected {variables}");
                return Err(format!("found a gradient of {found} components {place}").into());
            }
            let mut ids: Vec<_> = term.pieces.iter().map(|piece| piece.id).collect();
            ids.sort_by(|a, b| a.track.cmp(&b.track).then(a.place.total_cmp(&b.place)));
            if let Some(twin) = ids.windows(2).find(|pair| pair[0] == pair[1]) {
                let PieceId { track, place } = twin[0];
                return Err(format!(
                    "found two pieces of term {k} on track {track} at {place}, expected different ids"
                )
                .into());
            }
        }
        if !self.form().eq(form.iter().copied()) {
            let reason = "found other weights or shapes of terms than at the point before";
            return Err(Failure::new(reason));
        }
        Ok(())
    }
}

/// What the pieces weigh in a Lagrangian `Σ_k Σ_i λ_ki v_ki`.
#[derive(Debug, Clone, PartialEq)]
pub struct Multipliers {
    /// For each term, in order, the pieces with multipliers other than zero. Those of a norm are of
    /// length `w` at most, those of a maximum add up to `w`, each of a hinge is between zero and `w`.
    pub terms: Vec<Vec<(PieceId, f64)>>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_have_their_values() {
        for (shape, value) in [(Shape::Norm, 5.0), (Shape::Max, 3.0), (Shape::Hinge, 3.0)] {
            assert_eq!(shape.of([3.0, -4.0]), value);
            assert_eq!(shape.of([]), 0.0);
            for values in [[f64::NAN, 1.0], [1.0, f64::NAN]] {
                assert!(shape.of(values).is_nan(), "{shape:?} {values:?}");
            }
        }
        assert_eq!(Shape::Max.of([-3.0, -4.0]), -3.0);
    }

    #[test]
    fn floors_bound_other_values_only() {
        let term = Term::max(2.0, vec![Piece::new(0, -3.0, [])]);
        assert_eq!(term.value_at([-5.0]), -5.0);
        let term = term.at_least(-4.0);
        assert_eq!([term.value(), term.value_at([-5.0]), term.value_at([1.0])], [-3.0, -4.0, 1.0]);
        assert!(term.value_at([f64::NAN]).is_nan());
    }

    #[test]
    fn pieces_are_continued_on_their_tracks() {
        let piece = |track, place| Piece { id: PieceId { track, place }, ..Piece::new(0, 0.0, []) };
        let there = [piece(1, 0.52), piece(2, 0.5), piece(1, 0.45), piece(1, 0.9)];
        let continued =
            |track, place| PieceId { track, place }.continued(&there).map(|p| p.id.place);
        assert_eq!(continued(1, 0.5), Some(0.52));
        assert_eq!(continued(2, 0.41), Some(0.5));
        assert_eq!([continued(1, 0.7), continued(3, 0.5)], [None; 2]);
    }

    #[test]
    fn misshapen_linearisations_are_refused() {
        let told = |term: Term| {
            let found = Linearisation::new(vec![term]);
            let form: Vec<_> = found.form().collect();
            found.check(2, &form).map_err(|f| f.to_string())
        };
        let piece = || Piece::new(0, 1.0, [1.0, 2.0]);
        assert_eq!(told(Term::max(1.0, vec![piece()])), Ok(()));
        let message = "found a gradient of 3 components in term 0, expected 2";
        let long = Piece::new(0, 1.0, [0.0; 3]);
        assert_eq!(told(Term::max(1.0, vec![piece(), long])), Err(message.to_owned()));
        let message = "found the weight -1 of term 0, expected a finite weight of zero or more";
        assert_eq!(told(Term::hinge(-1.0, vec![])), Err(message.to_owned()));
        let message = "found two pieces of term 0 on track 0 at 0, expected different ids";
        assert_eq!(told(Term::max(1.0, vec![piece(), piece()])), Err(message.to_owned()));
        let message = "found other weights or shapes of terms than at the point before";
        let found = Linearisation::new(vec![Term::max(1.0, vec![piece()])]).check(2, &[]);
        assert_eq!(found.map_err(|f| f.to_string()), Err(message.to_owned()));
    }
}
