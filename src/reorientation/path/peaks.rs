//! Local maxima of what is sampled along a path.

/// A sample that is no lower than those beside it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rise {
    /// Index of the sample.
    pub(super) at: usize,
    /// How high the parabola through it and those beside it rises above the sample.
    pub(super) above: f64,
}

/// Samples that differ by no more than this share of the highest are equal.
const SAME: f64 = 1e-9;

/// The rises of samples, the ends among them; of equal ones that none lower lies between, the highest.
pub(super) fn rises(samples: &[f64]) -> Vec<Rise> {
    let size = samples.iter().fold(0.0, |most: f64, sample| most.max(sample.abs()));
    let falls = |from: f64, to: f64| from - to > SAME * size;
    let mut found = Vec::new();
    // The highest sample since the last valley, and the lowest since the last rise.
    let (mut top, mut valley) = (Some(0), 0);
    for at in 1..samples.len() {
        if let Some(highest) = top {
            if samples[at] > samples[highest] {
                top = Some(at);
            } else if falls(samples[highest], samples[at]) {
                found.push(highest);
                (top, valley) = (None, at);
            }
        } else if falls(samples[at], samples[valley]) {
            top = Some(at);
        } else if samples[at] < samples[valley] {
            valley = at;
        }
    }
    found.extend(top);
    let rise = |at: usize| {
        let middle = at.clamp(1, samples.len().max(3) - 2);
        let above = parabola(samples, middle).map_or(0.0, |top| (top - samples[at]).max(0.0));
        Rise { at, above }
    };
    found.into_iter().map(rise).collect()
}

/// The top of the parabola through three samples, if it has one.
fn parabola(samples: &[f64], middle: usize) -> Option<f64> {
    let [before, here, after] = *samples.get(middle - 1..=middle + 1)? else { return None };
    let (slope, bend) = ((after - before) / 2.0, before + after - 2.0 * here);
    (bend < 0.0).then(|| here - slope * slope / (2.0 * bend))
}

/// Most evaluations of a climb.
const EVALUATIONS: usize = 60;

/// The golden section.
const GOLDEN: f64 = 0.381_966_011_250_105;

/// The largest value of a function between `lower` and `upper`, begun at `(x, value)` between them, with its place: to within
/// `tolerance` of where it is if there is one maximum (Brent 1973, Algorithms for Minimization without Derivatives, chapter 5).
pub(super) fn climb(
    [mut lower, mut upper]: [f64; 2],
    (mut x, mut fx): (f64, f64),
    tolerance: f64,
    mut height: impl FnMut(f64) -> f64,
) -> (f64, f64) {
    let (mut w, mut fw, mut v, mut fv) = (x, fx, x, fx);
    let [mut step, mut before] = [0.0_f64; 2];
    for _ in 0..EVALUATIONS {
        let middle = f64::midpoint(lower, upper);
        if (x - middle).abs() <= 2.0 * tolerance - (upper - lower) / 2.0 {
            break;
        }
        // The top of the parabola through the three best.
        let (r, q) = ((x - w) * (fx - fv), (x - v) * (fx - fw));
        let (mut p, mut d) = ((x - v) * q - (x - w) * r, 2.0 * (q - r));
        if d > 0.0 {
            p = -p;
        } else {
            d = -d;
        }
        let is_fit = d > 0.0
            && p.abs() < (0.5 * d * before).abs()
            && p > d * (lower - x)
            && p < d * (upper - x);
        if is_fit {
            (before, step) = (step, p / d);
            let u = x + step;
            if u - lower < 2.0 * tolerance || upper - u < 2.0 * tolerance {
                step = if x < middle { tolerance } else { -tolerance };
            }
        } else {
            before = if x < middle { upper - x } else { lower - x };
            step = GOLDEN * before;
        }
        let u = x + if step.abs() >= tolerance { step } else { tolerance.copysign(step) };
        let fu = height(u);
        if fu >= fx {
            if u < x {
                upper = x;
            } else {
                lower = x;
            }
            (v, fv, w, fw, x, fx) = (w, fw, x, fx, u, fu);
        } else {
            if u < x {
                lower = u;
            } else {
                upper = u;
            }
            if fu >= fw || w == x {
                (v, fv, w, fw) = (w, fw, u, fu);
            } else if fu >= fv || v == x || v == w {
                (v, fv) = (u, fu);
            }
        }
    }
    (x, fx)
}

/// A peak where a function that is smooth on either side changes its slope at once: where lines through two points on each
/// side, `step` and twice that from where it was found, meet. To the second order of `step` it then is right.
pub(super) fn sharpened((x, fx): (f64, f64), step: f64, height: impl Fn(f64) -> f64) -> (f64, f64) {
    if !(2.0 * step..=1.0 - 2.0 * step).contains(&x) {
        return (x, fx);
    }
    let [far_before, before, after, far_after] =
        [-2.0, -1.0, 1.0, 2.0].map(|steps| height(x + steps * step));
    let (rise, fall) = ((before - far_before) / step, (far_after - after) / step);
    let more = (after - before - (rise + fall) * step) / (rise - fall);
    if rise > 0.0 && fall < 0.0 && more.abs() <= step {
        (x + more, before + rise * (more + step))
    } else {
        (x, fx)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rises_are_found_with_their_tops() {
        let samples = [3.0, 1.0, 2.0, 2.0, 0.0, 1.0];
        let found = rises(&samples);
        assert_eq!(found.iter().map(|rise| rise.at).collect::<Vec<_>>(), [0, 2, 5]);
        // Through (−1, 1), (0, 2) and (1, 2): 2 + x/2 − x²/2, whose top is 2.125.
        assert!((found[1].above - 0.125).abs() < 1e-15, "{found:?}");
        assert_eq!(found[0].above, 0.0);
        let level = [1.0, 1.0 - 1e-15, 1.0, 1.0 + 1e-15, 1.0];
        assert_eq!(rises(&level).len(), 1);
        assert_eq!(rises(&[0.5]), [Rise { at: 0, above: 0.0 }]);
    }

    /// Smooth maxima, a kink, and one at an end.
    #[test]
    fn tops_are_climbed() {
        let climbed = |ends, x: f64, f: &dyn Fn(f64) -> f64| climb(ends, (x, f(x)), 1e-9, f);
        let (x, top) = climbed([0.0, 2.0], 1.0, &|x: f64| (x - 0.3).cos());
        assert!((x - 0.3).abs() < 1e-7 && (top - 1.0).abs() < 1e-15, "{x} {top}");
        let (x, top) = climbed([0.0, 1.0], 0.5, &|x: f64| f64::min(3.0 * x, 1.0 - x));
        assert!((x - 0.25).abs() < 1e-8 && (top - 0.75).abs() < 3e-8, "{x} {top}");
        let (x, top) = climbed([0.0, 1.0], 1.0, &|x| x);
        assert_eq!((x, top), (1.0, 1.0));
    }

    #[test]
    fn tops_of_kinks_are_sharpened() {
        let kink = |x: f64| f64::min(3.0 * x + x * x, 1.0 - x);
        // 3 x + x² = 1 − x
        let expected = 5.0_f64.sqrt() - 2.0;
        let begun = expected + 4e-7;
        let (x, top) = sharpened((begun, kink(begun)), 1e-6, kink);
        assert!((x - expected).abs() < 1e-11, "{x}");
        assert!((top - (1.0 - expected)).abs() < 1e-11, "{top}");
        let smooth = |x: f64| (x - 0.3).cos();
        let (x, top) = sharpened((0.3, 1.0), 1e-6, smooth);
        assert!((x - 0.3).abs() < 1e-9 && (top - 1.0).abs() < 2e-12, "{x} {top}");
        assert_eq!(sharpened((1.0, 1.0), 1e-6, |x| x), (1.0, 1.0));
    }
}
