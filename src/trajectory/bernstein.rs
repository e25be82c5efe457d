//! Polynomials on `[0, 1]` by their Bernstein coefficients, between the least and the largest of which every
//! value lies (Farouki 2012, doi:10.1016/j.cagd.2012.03.001).

/// The highest degree.
const MOST: usize = 5;

/// A polynomial of a moderate degree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bernstein {
    coefficients: [f64; MOST + 1],
    degree: usize,
}

impl Bernstein {
    /// Of a degree of five at most, from as many coefficients and one more.
    pub(super) fn new(coefficients: [f64; MOST + 1], degree: usize) -> Self {
        Self { coefficients, degree }
    }

    fn coefficients(&self) -> &[f64] {
        &self.coefficients[..=self.degree]
    }

    /// Its value, by de Casteljau's algorithm.
    pub(super) fn value(&self, t: f64) -> f64 {
        let mut points = self.coefficients;
        for count in (1..=self.degree).rev() {
            for i in 0..count {
                points[i] += t * (points[i + 1] - points[i]);
            }
        }
        points[0]
    }

    /// What no value exceeds in magnitude.
    pub(super) fn largest(&self) -> f64 {
        self.coefficients().iter().fold(0.0, |largest, c| f64::max(largest, c.abs()))
    }

    /// Between what all values lie.
    pub(super) fn hull(&self) -> [f64; 2] {
        let start = [self.coefficients[0]; 2];
        self.coefficients().iter().fold(start, |[least, most], &c| [c.min(least), c.max(most)])
    }

    pub(super) fn derivative(&self) -> Self {
        let mut coefficients = [0.0; MOST + 1];
        for (own, pair) in coefficients.iter_mut().zip(self.coefficients().windows(2)) {
            *own = (pair[1] - pair[0]) * self.degree as f64;
        }
        Self { coefficients, degree: self.degree.saturating_sub(1) }
    }

    /// Where it turns from rising to falling or back inside, in order.
    pub(super) fn turns(&self) -> Vec<f64> {
        self.derivative().roots()
    }

    /// Where it changes its sign inside, in order: at most once between two of its turns.
    fn roots(&self) -> Vec<f64> {
        let has = |wanted: fn(&f64) -> bool| self.coefficients().iter().any(wanted);
        if !(has(|c| *c > 0.0) && has(|c| *c < 0.0)) {
            return Vec::new();
        }
        let turns = self.turns();
        let starts = std::iter::once(0.0).chain(turns.iter().copied());
        let ends = turns.iter().copied().chain([1.0]);
        starts.zip(ends).filter_map(|(start, end)| self.root_between(start, end)).collect()
    }

    /// The change of sign in an interval without a turn, by regula falsi with halving where one end stays (Dowell and
    /// Jarratt 1971, doi:10.1007/BF01934364).
    fn root_between(&self, mut a: f64, mut b: f64) -> Option<f64> {
        let (mut at_a, mut at_b) = (self.value(a), self.value(b));
        if at_a * at_b >= 0.0 {
            return None;
        }
        let mut a_stayed = None;
        for _ in 0..200 {
            let c = (a * at_b - b * at_a) / (at_b - at_a);
            let at_c = self.value(c);
            if at_c == 0.0 || c <= a || c >= b {
                return Some(c.clamp(a, b));
            }
            if at_c * at_b < 0.0 {
                (a, at_a) = (c, at_c);
                if a_stayed == Some(false) {
                    at_b /= 2.0;
                }
                a_stayed = Some(false);
            } else {
                (b, at_b) = (c, at_c);
                if a_stayed == Some(true) {
                    at_a /= 2.0;
                }
                a_stayed = Some(true);
            }
        }
        Some(a.midpoint(b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `(t − ¼)(t − ½)(t − ¾)` and its integral: roots and turns where they stand, and nowhere else.
    #[test]
    fn roots_and_turns_are_found() {
        // In powers of t: −3/32 + 11/16 t − 3/2 t² + t³; Bernstein coefficients by blossoming.
        let cubic =
            Bernstein::new([-3.0 / 32.0, 13.0 / 96.0, -13.0 / 96.0, 3.0 / 32.0, 0.0, 0.0], 3);
        for (found, expected) in cubic.roots().iter().zip([0.25, 0.5, 0.75]) {
            assert!((found - expected).abs() < 1e-15, "{found}");
        }
        assert_eq!(cubic.roots().len(), 3);
        let half = 1.0 / 48.0_f64.sqrt();
        for (found, expected) in cubic.turns().iter().zip([0.5 - half, 0.5 + half]) {
            assert!((found - expected).abs() < 1e-14, "{found}");
        }
        for (t, expected) in [(0.0, -3.0 / 32.0), (0.5, 0.0), (1.0, 3.0 / 32.0)] {
            assert!((cubic.value(t) - expected).abs() < 1e-16);
        }
        let flat = Bernstein::new([2.0; 6], 5);
        assert!(flat.turns().is_empty() && flat.roots().is_empty());
    }
}
