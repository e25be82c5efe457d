//! Numbers that carry a derivative with them.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use crate::scalar::Scalar;

/// A number and its derivative in some direction, in each lane another one: what is written over [`Scalar`] is
/// differentiated to rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Dual<T> {
    pub(super) value: T,
    pub(super) slope: T,
}

impl<T: Scalar> Add for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl<T: Scalar> Sub for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl<T: Scalar> Mul for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            slope: self.slope.mul_add(other.value, self.value * other.slope),
        }
    }
}

impl<T: Scalar> Div for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, slope: value.mul_sub_from(other.slope, self.slope) / other.value }
    }
}

impl<T: Scalar> Neg for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }
}

impl<T: Scalar> AddAssign for Dual<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Scalar> SubAssign for Dual<T> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<T: Scalar> Scalar for Dual<T> {
    #[inline(always)]
    fn of(value: f64) -> Self {
        Self { value: T::of(value), slope: T::of(0.0) }
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self {
            value: self.value.mul_add(factor.value, term.value),
            slope: self.slope.mul_add(factor.value, self.value.mul_add(factor.slope, term.slope)),
        }
    }

    #[inline(always)]
    fn mul_sub_from(self, factor: Self, term: Self) -> Self {
        let slope = self.value.mul_sub_from(factor.slope, term.slope);
        Self {
            value: self.value.mul_sub_from(factor.value, term.value),
            slope: self.slope.mul_sub_from(factor.value, slope),
        }
    }

    /// With slope zero at zero, a subgradient of the norms that end with this.
    #[inline(always)]
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        let slope = self.slope / (value + value);
        Self { value, slope: value.select_below(f64::MIN_POSITIVE, T::of(0.0), slope) }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.select_below(0.0, -self, self)
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        let slope = (other.value - self.value).select_below(0.0, self.slope, other.slope);
        Self { value: self.value.larger(other.value), slope }
    }

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        let slope = (self.value - other.value).select_below(0.0, self.slope, other.slope);
        Self { value: self.value.smaller(other.value), slope }
    }

    #[inline(always)]
    fn all_below(self, limit: f64) -> bool {
        self.value.all_below(limit)
    }

    #[inline(always)]
    fn select_below(self, limit: f64, less: Self, otherwise: Self) -> Self {
        Self {
            value: self.value.select_below(limit, less.value, otherwise.value),
            slope: self.value.select_below(limit, less.slope, otherwise.slope),
        }
    }

    #[inline(always)]
    fn turn_quarters(quarters: Self, sin: Self, cos: Self) -> (Self, Self) {
        let values = T::turn_quarters(quarters.value, sin.value, cos.value);
        let slopes = T::turn_quarters(quarters.value, sin.slope, cos.slope);
        (Self { value: values.0, slope: slopes.0 }, Self { value: values.1, slope: slopes.1 })
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (
            Self { value: sin, slope: cos * self.slope },
            Self { value: cos, slope: -sin * self.slope },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dual(value: f64, slope: f64) -> Dual<f64> {
        Dual { value, slope }
    }

    /// Against the rules of differentiation, by hand.
    #[test]
    fn slopes_follow_the_rules() {
        let (a, b, c) = (dual(0.7, 2.0), dual(-1.5, 3.0), dual(4.0, -1.0));
        let (sin, cos) = a.sin_cos();
        let pairs = [
            (a + b, -0.8, 5.0),
            (a - b, 2.2, -1.0),
            (a * b, -1.05, -0.9),
            (a / b, 0.7 / -1.5, -5.1 / 2.25),
            (-a, -0.7, -2.0),
            (a.mul_add(b, c), 2.95, -1.9),
            (a.mul_sub_from(b, c), 5.05, -0.1),
            (Scalar::sqrt(c), 2.0, -0.25),
            (Scalar::abs(a), 0.7, 2.0),
            (Scalar::abs(b), 1.5, -3.0),
            (a.larger(b), 0.7, 2.0),
            (b.larger(a), 0.7, 2.0),
            (a.smaller(b), -1.5, 3.0),
            (b.smaller(a), -1.5, 3.0),
            (a.select_below(0.0, b, c), 4.0, -1.0),
            (b.select_below(0.0, a, c), 0.7, 2.0),
            (Dual::of(3.0), 3.0, 0.0),
            (sin, 0.7_f64.sin(), 2.0 * 0.7_f64.cos()),
            (cos, 0.7_f64.cos(), -2.0 * 0.7_f64.sin()),
        ];
        for (i, (found, value, slope)) in pairs.into_iter().enumerate() {
            assert!((found.value - value).abs() < 1e-15, "{i}: {found:?}");
            assert!((found.slope - slope).abs() < 1e-15, "{i}: {found:?}");
        }
        assert_eq!(Scalar::sqrt(dual(0.0, 1.0)), dual(0.0, 0.0));
    }
}
