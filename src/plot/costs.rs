//! How costs are drawn, whatever their sign and their scale.

use crate::figure::axis::Axis;
use crate::figure::marks::{Line, Mark};
use crate::figure::panel::{MARGIN, range};

/// How far below the largest cost a logarithmic axis goes, as a share: the digits of a double.
const DEEPEST: f64 = 1e-16;

/// How the costs of a panel are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CostScale {
    /// The least and the largest cost, of a logarithmic axis those that it shows.
    pub(super) range: [f64; 2],
    pub(super) is_logarithmic: bool,
    /// Whether some costs are below the axis.
    pub(super) is_cut: bool,
}

impl CostScale {
    /// Logarithmic, unless costs are negative or all zero. A logarithmic axis has no place for zero and shows sixteen decades
    /// at most; what is below stands at its lower end.
    pub(super) fn of(costs: impl Iterator<Item = f64> + Clone) -> Self {
        let [low, high] = range(costs.clone(), f64::NEG_INFINITY);
        if low < 0.0 || high <= 0.0 || costs.clone().all(|cost| !cost.is_finite()) {
            return Self { range: [low, high], is_logarithmic: false, is_cut: false };
        }
        let deepest = (DEEPEST * high).max(f64::MIN_POSITIVE);
        let positive = costs.filter(|&cost| cost > 0.0);
        let [least, _] = range(positive, deepest);
        // Zero is below the least of the others.
        let lowest = if low == 0.0 { (0.1 * least).max(deepest) } else { least };
        Self { range: [lowest, high], is_logarithmic: true, is_cut: low < lowest }
    }

    /// Where a cost is drawn.
    pub(super) fn drawn(&self, cost: f64) -> f64 {
        if self.is_logarithmic { cost.max(self.range[0]) } else { cost }
    }

    /// An axis over the costs.
    pub(super) fn axis(&self, label: &str) -> Axis {
        if self.is_logarithmic {
            Axis::logarithmic(label, self.range, MARGIN).cut(self.is_cut)
        } else {
            Axis::linear(label, self.range, MARGIN)
        }
    }

    /// What the legend says of the line at which costs are cut.
    fn told(&self) -> String {
        format!("zero or below {:.1e}: drawn on this line", self.range[0])
    }

    /// A line at the lower end of a vertical axis where costs are cut, between two abscissae.
    pub(super) fn cut(&self, ends: [f64; 2]) -> Option<Mark> {
        self.is_cut.then(|| Mark::Line(Line::level(&self.told(), self.range[0], ends)))
    }

    /// The same of a horizontal axis, between two ordinates.
    pub(super) fn cut_across(&self, ends: [f64; 2]) -> Option<Mark> {
        let at = self.range[0];
        self.is_cut.then(|| {
            let line = Line::level(&self.told(), at, ends);
            Mark::Line(Line { points: ends.map(|end| [at, end]).to_vec(), ..line })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(costs: &[f64]) -> CostScale {
        CostScale::of(costs.iter().copied())
    }

    #[test]
    fn positive_costs_are_drawn_where_they_are() {
        let scale = scale(&[1e-16, 1e-3, f64::INFINITY, 0.5]);
        assert!(scale.is_logarithmic && !scale.is_cut);
        assert_eq!(scale.drawn(1e-16), 1e-16);
    }

    #[test]
    fn zero_stands_below_the_least_and_is_said_to_be_cut() {
        let scale = scale(&[0.0, 1e-3, 0.5]);
        assert!(scale.is_logarithmic && scale.is_cut);
        assert_eq!(scale.range, [1e-4, 0.5]);
        assert_eq!(scale.drawn(0.0), 1e-4);
    }

    #[test]
    fn an_axis_has_no_more_decades_than_a_double_has_digits() {
        let scale = scale(&[1e-200, 1e-3, 1.0]);
        assert!(scale.is_cut);
        assert_eq!(scale.range, [1e-16, 1.0]);
    }

    #[test]
    fn negative_costs_have_a_linear_axis() {
        let scale = scale(&[-100.0, f64::INFINITY, -99.0, 20.0]);
        assert_eq!(
            scale,
            CostScale { range: [-100.0, 20.0], is_logarithmic: false, is_cut: false }
        );
        assert_eq!(scale.drawn(-100.0), -100.0);
    }
}
