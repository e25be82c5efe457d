//! The one numeric bound of the chain from joint angles to cost; sine, cosine and polynomials over it; two
//! numbers at once.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A real number, or one number per lane.
///
/// Kinematics, momentum and attitude are written once over this bound: `f64` evaluates one place of a
/// path, a vector of the processor one place per lane. Every operation is rounded as that of `f64` is, so
/// that vectors of any number of lanes give the same bits. They round a product and a sum at once; one `f64`
/// at a time does so only where the compiler knows that the processor can, and elsewhere differs in the last
/// place.
pub trait Scalar:
    Debug
    + Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + 'static
{
    /// The constant `value` in every lane.
    fn of(value: f64) -> Self;

    /// `self × factor + term`, rounded once where the processor can.
    #[must_use]
    fn mul_add(self, factor: Self, term: Self) -> Self;

    /// `term − self × factor`, rounded once where the processor can.
    #[must_use]
    fn mul_sub_from(self, factor: Self, term: Self) -> Self;

    /// Square root.
    #[must_use]
    fn sqrt(self) -> Self;

    /// Magnitude.
    #[must_use]
    fn abs(self) -> Self;

    /// The larger of two; `other` where either is not a number.
    #[must_use]
    fn larger(self, other: Self) -> Self;

    /// The smaller of two; `other` where either is not a number.
    #[must_use]
    fn smaller(self, other: Self) -> Self;

    /// Whether every lane is below `limit`.
    fn all_below(self, limit: f64) -> bool;

    /// `less` where this is below `limit`, else `otherwise`.
    #[must_use]
    fn select_below(self, limit: f64, less: Self, otherwise: Self) -> Self;

    /// Sine and cosine of `q` quarter turns more, where the lowest bits of `quarters` hold `q`.
    fn turn_quarters(quarters: Self, sin: Self, cos: Self) -> (Self, Self);

    /// Sine and cosine, to about a unit in the last place of the angle or of the result, whichever is
    /// larger.
    ///
    /// Without a branch: reduction by quarter turns in two parts (Cody and Waite 1980), then
    /// polynomials. An angle too large for that has no digits of its own after the point; what comes
    /// out then is at least within −1 to 1.
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let quarters = self.mul_add(Self::of(std::f64::consts::FRAC_2_PI), Self::of(ROUND));
        let whole = quarters - Self::of(ROUND);
        let r = whole.mul_sub_from(Self::of(QUARTER[0]), self);
        let r = whole.mul_sub_from(Self::of(QUARTER[1]), r);
        let r = Self::of(-EIGHTH).larger(r);
        let r = Self::of(EIGHTH).smaller(r);
        let z = r * r;
        let sin = (r * z).mul_add(polynomial(&SINE, z), r);
        let half = z * Self::of(0.5);
        let near = Self::of(1.0) - half;
        let rest = Self::of(1.0) - near - half;
        let cos = near + (z * z).mul_add(polynomial(&COSINE, z), rest);
        Self::turn_quarters(quarters, sin, cos)
    }
}

impl Scalar for f64 {
    #[inline(always)]
    fn of(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        if FUSED { self.mul_add(factor, term) } else { self * factor + term }
    }

    #[inline(always)]
    fn mul_sub_from(self, factor: Self, term: Self) -> Self {
        if FUSED { (-self).mul_add(factor, term) } else { term - self * factor }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn all_below(self, limit: f64) -> bool {
        self < limit
    }

    #[inline(always)]
    fn select_below(self, limit: f64, less: Self, otherwise: Self) -> Self {
        if self < limit { less } else { otherwise }
    }

    #[inline(always)]
    fn turn_quarters(quarters: Self, sin: Self, cos: Self) -> (Self, Self) {
        let q = quarters.to_bits();
        let (sin, cos) = if q & 1 == 0 { (sin, cos) } else { (cos, sin) };
        let sign = |odd: u64| (odd & 2) << 62;
        (
            Self::from_bits(sin.to_bits() ^ sign(q)),
            Self::from_bits(cos.to_bits() ^ sign(q.wrapping_add(1))),
        )
    }
}

/// Whether the machine that this is compiled for rounds a product and a sum at once in one instruction:
/// where it does not, the library function that does takes as long as a sine.
const FUSED: bool = cfg!(any(target_feature = "fma", target_arch = "aarch64"));

/// Two of the same at once, one operation of each after the other, so that a processor that waits for the
/// result of one can do the other meanwhile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair<T>(pub T, pub T);

macro_rules! pair {
    ($trait:ident, $method:ident) => {
        impl<T: Scalar> $trait for Pair<T> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0), self.1.$method(other.1))
            }
        }
    };
}

pair!(Add, add);
pair!(Sub, sub);
pair!(Mul, mul);
pair!(Div, div);

impl<T: Scalar> Neg for Pair<T> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl<T: Scalar> AddAssign for Pair<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Scalar> SubAssign for Pair<T> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<T: Scalar> Scalar for Pair<T> {
    #[inline(always)]
    fn of(value: f64) -> Self {
        Self(T::of(value), T::of(value))
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self(self.0.mul_add(factor.0, term.0), self.1.mul_add(factor.1, term.1))
    }

    #[inline(always)]
    fn mul_sub_from(self, factor: Self, term: Self) -> Self {
        Self(self.0.mul_sub_from(factor.0, term.0), self.1.mul_sub_from(factor.1, term.1))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt(), self.1.sqrt())
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs(), self.1.abs())
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        Self(self.0.larger(other.0), self.1.larger(other.1))
    }

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        Self(self.0.smaller(other.0), self.1.smaller(other.1))
    }

    #[inline(always)]
    fn all_below(self, limit: f64) -> bool {
        self.0.all_below(limit) && self.1.all_below(limit)
    }

    #[inline(always)]
    fn select_below(self, limit: f64, less: Self, otherwise: Self) -> Self {
        Self(
            self.0.select_below(limit, less.0, otherwise.0),
            self.1.select_below(limit, less.1, otherwise.1),
        )
    }

    #[inline(always)]
    fn turn_quarters(quarters: Self, sin: Self, cos: Self) -> (Self, Self) {
        let first = T::turn_quarters(quarters.0, sin.0, cos.0);
        let second = T::turn_quarters(quarters.1, sin.1, cos.1);
        (Self(first.0, second.0), Self(first.1, second.1))
    }
}

/// Added to a number below 2⁵¹ it rounds it to a whole one, which the lowest bits of the sum hold.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// π/2: its first 33 bits, and the rest.
const QUARTER: [f64; 2] = [1.570_796_326_734_125_6, 6.077_100_506_506_192e-11];

/// A little more than π/4.
const EIGHTH: f64 = 0.786;

/// Coefficients of the sine's polynomial on `|r| ≤ π/4`, least in the largest error (FreeBSD's msun, `k_sin.c`).
const SINE: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];

/// The same for the cosine (`k_cos.c`).
const COSINE: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// Horner's rule, lowest power first.
#[inline(always)]
pub(crate) fn polynomial<T: Scalar, const N: usize>(coefficients: &[f64; N], x: T) -> T {
    let mut sum = T::of(coefficients[N - 1]);
    for n in (0..N - 1).rev() {
        sum = sum.mul_add(x, T::of(coefficients[n]));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the platform's mathematics library.
    #[test]
    fn sine_and_cosine_are_right_to_the_last_place() {
        let check = |x: f64| {
            let (sin, cos) = Scalar::sin_cos(x);
            for (found, expected) in [(sin, x.sin()), (cos, x.cos())] {
                let unit = f64::EPSILON * expected.abs().max(1e-6 * x.abs());
                assert!((found - expected).abs() <= 1.01 * unit, "{x}: {found} {expected}");
            }
        };
        for i in -200_000..200_000 {
            check(f64::from(i) * 1.7e-4);
            check(f64::from(i) * 0.37);
            check(f64::from(i) * std::f64::consts::FRAC_PI_4 / 100.0);
        }
    }

    #[test]
    fn no_angle_is_too_large() {
        for x in [1e9, -1e15, 1e18, 1e300, f64::MAX] {
            let (sin, cos) = Scalar::sin_cos(x);
            assert!(sin.abs() <= 1.0 && cos.abs() <= 1.0, "{x}: {sin} {cos}");
        }
        for x in [f64::INFINITY, f64::NAN] {
            let (sin, cos) = Scalar::sin_cos(x);
            assert!(sin.is_nan() && cos.is_nan(), "{x}: {sin} {cos}");
        }
    }
}
