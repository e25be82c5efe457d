//! Vectors and matrices of three, small enough to be inlined wherever they are used: lanes have to be.

use std::ops::{Add, AddAssign, Index, Mul, Neg, Sub, SubAssign};

use nalgebra::{Matrix3, Vector3};

use crate::lanes::{Lanes, MOST};
use crate::scalar::Scalar;

/// A vector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vec3<T> {
    /// First component.
    pub x: T,
    /// Second component.
    pub y: T,
    /// Third component.
    pub z: T,
}

/// Any matrix, by its columns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mat3<T>(pub [Vec3<T>; 3]);

/// A symmetric matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sym3<T> {
    /// On the diagonal.
    pub diagonal: Vec3<T>,
    /// Beside it: `yz`, `xz`, `xy`, each at the place of the axis it leaves out.
    pub beside: Vec3<T>,
}

impl<T: Scalar> Vec3<T> {
    /// From components.
    #[inline(always)]
    pub fn new(x: T, y: T, z: T) -> Self {
        Self { x, y, z }
    }

    /// The same vector in every lane.
    #[inline(always)]
    pub fn of(v: &Vector3<f64>) -> Self {
        Self::new(T::of(v.x), T::of(v.y), T::of(v.z))
    }

    /// The zero vector.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::new(T::of(0.0), T::of(0.0), T::of(0.0))
    }

    /// Something done to every component; what is large would not be inlined.
    #[inline(always)]
    pub fn map<U>(self, f: impl Fn(T) -> U) -> Vec3<U> {
        Vec3 { x: f(self.x), y: f(self.y), z: f(self.z) }
    }

    /// Inner product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> T {
        self.x.mul_add(other.x, self.y.mul_add(other.y, self.z * other.z))
    }

    /// Vector product.
    #[inline(always)]
    #[must_use]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.z.mul_sub_from(other.y, self.y * other.z),
            self.x.mul_sub_from(other.z, self.z * other.x),
            self.y.mul_sub_from(other.x, self.x * other.y),
        )
    }

    /// A multiple by a constant.
    #[inline(always)]
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        self * T::of(factor)
    }

    /// This times a factor, plus another vector.
    #[inline(always)]
    #[must_use]
    pub fn mul_add(self, factor: T, term: Self) -> Self {
        Self::new(
            self.x.mul_add(factor, term.x),
            self.y.mul_add(factor, term.y),
            self.z.mul_add(factor, term.z),
        )
    }
}

impl Vec3<f64> {
    /// The same vector in every lane.
    #[inline(always)]
    pub fn lift<T: Scalar>(self) -> Vec3<T> {
        Vec3::new(T::of(self.x), T::of(self.y), T::of(self.z))
    }
}

impl Sym3<f64> {
    /// The same matrix in every lane.
    #[inline(always)]
    pub fn lift<T: Scalar>(self) -> Sym3<T> {
        Sym3 { diagonal: self.diagonal.lift(), beside: self.beside.lift() }
    }
}

impl<T: Lanes> Vec3<T> {
    /// Every lane's vector, followed by zeros.
    #[inline(always)]
    pub fn lanes(self) -> [Vec3<f64>; MOST] {
        let Vec3 { x, y, z } = self.map(T::numbers);
        std::array::from_fn(|lane| Vec3::new(x[lane], y[lane], z[lane]))
    }
}

impl<T: Scalar> Add for Vec3<T> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<T: Scalar> Sub for Vec3<T> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl<T: Scalar> Neg for Vec3<T> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|component| -component)
    }
}

impl<T: Scalar> Mul<T> for Vec3<T> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        self.map(|component| component * factor)
    }
}

impl<T: Scalar> AddAssign for Vec3<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Scalar> SubAssign for Vec3<T> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<T> Index<usize> for Vec3<T> {
    type Output = T;

    fn index(&self, axis: usize) -> &T {
        [&self.x, &self.y, &self.z][axis]
    }
}

impl From<Vec3<f64>> for Vector3<f64> {
    fn from(v: Vec3<f64>) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

impl<T: Scalar> Mat3<T> {
    /// The same matrix in every lane.
    #[inline(always)]
    pub fn of(m: &Matrix3<f64>) -> Self {
        let column = |j| Vec3::new(T::of(m[(0, j)]), T::of(m[(1, j)]), T::of(m[(2, j)]));
        Self([column(0), column(1), column(2)])
    }

    /// A multiple of the identity.
    #[inline(always)]
    pub fn diagonal(value: T) -> Self {
        let zero = T::of(0.0);
        Self([
            Vec3::new(value, zero, zero),
            Vec3::new(zero, value, zero),
            Vec3::new(zero, zero, value),
        ])
    }

    /// The matrix of `v ×`.
    #[inline(always)]
    pub fn cross(v: Vec3<T>) -> Self {
        let zero = T::of(0.0);
        Self([Vec3::new(zero, v.z, -v.y), Vec3::new(-v.z, zero, v.x), Vec3::new(v.y, -v.x, zero)])
    }

    /// A multiple by a constant.
    #[inline(always)]
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        self * T::of(factor)
    }

    /// The transposed matrix times a vector.
    #[inline(always)]
    #[must_use]
    pub fn tr_mul(self, v: Vec3<T>) -> Vec3<T> {
        Vec3::new(self.0[0].dot(v), self.0[1].dot(v), self.0[2].dot(v))
    }

    /// This matrix times a symmetric one, times this one's transpose.
    #[inline(always)]
    pub fn congruent(self, middle: Sym3<T>) -> Sym3<T> {
        let [x, y, z] = self.0;
        let Sym3 { diagonal: d, beside: b } = middle;
        // The columns of the product with the symmetric matrix.
        let p = self * Vec3::new(d.x, b.z, b.y);
        let q = self * Vec3::new(b.z, d.y, b.x);
        let r = self * Vec3::new(b.y, b.x, d.z);
        let [first, second, third] =
            [Vec3::new(p.x, q.x, r.x), Vec3::new(p.y, q.y, r.y), Vec3::new(p.z, q.z, r.z)];
        let rows = [Vec3::new(x.x, y.x, z.x), Vec3::new(x.y, y.y, z.y), Vec3::new(x.z, y.z, z.z)];
        Sym3 {
            diagonal: Vec3::new(first.dot(rows[0]), second.dot(rows[1]), third.dot(rows[2])),
            beside: Vec3::new(second.dot(rows[2]), first.dot(rows[2]), first.dot(rows[1])),
        }
    }
}

impl<T: Scalar> Mul<Vec3<T>> for Mat3<T> {
    type Output = Vec3<T>;

    #[inline(always)]
    fn mul(self, v: Vec3<T>) -> Vec3<T> {
        let Self([a, b, c]) = self;
        a.mul_add(v.x, b.mul_add(v.y, c * v.z))
    }
}

impl<T: Scalar> Mul<T> for Mat3<T> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        let [a, b, c] = self.0;
        Self([a * factor, b * factor, c * factor])
    }
}

impl<T: Scalar> Mul for Mat3<T> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let [a, b, c] = other.0;
        Self([self * a, self * b, self * c])
    }
}

impl<T: Scalar> Add for Mat3<T> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let ([a, b, c], [p, q, r]) = (self.0, other.0);
        Self([a + p, b + q, c + r])
    }
}

impl<T: Scalar> Sub for Mat3<T> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let ([a, b, c], [p, q, r]) = (self.0, other.0);
        Self([a - p, b - q, c - r])
    }
}

impl<T: Scalar> Neg for Mat3<T> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        let [a, b, c] = self.0;
        Self([-a, -b, -c])
    }
}

impl From<Mat3<f64>> for Matrix3<f64> {
    fn from(m: Mat3<f64>) -> Self {
        Self::from_columns(&m.0.map(Vector3::from))
    }
}

impl<T: Scalar> Sym3<T> {
    /// The same matrix in every lane, from its upper half.
    #[inline(always)]
    pub fn of(m: &Matrix3<f64>) -> Self {
        let entry = |i, j| T::of(m[(i, j)]);
        Self {
            diagonal: Vec3::new(entry(0, 0), entry(1, 1), entry(2, 2)),
            beside: Vec3::new(entry(1, 2), entry(0, 2), entry(0, 1)),
        }
    }

    /// The zero matrix.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { diagonal: Vec3::zero(), beside: Vec3::zero() }
    }

    /// Inertia about the origin of a point at `r`, `m` its mass: `m r·r E − r (m r)ᵀ` from `r` and
    /// `m r`.
    #[inline(always)]
    pub fn point(r: Vec3<T>, moment: Vec3<T>) -> Self {
        let (x, y, z) = (r.x * moment.x, r.y * moment.y, r.z * moment.z);
        Self {
            diagonal: Vec3::new(y + z, x + z, x + y),
            beside: -Vec3::new(r.y * moment.z, r.x * moment.z, r.x * moment.y),
        }
    }

    /// Adjugate and determinant, whose quotient is the inverse.
    #[inline(always)]
    pub fn adjugate(self) -> (Self, T) {
        let Self { diagonal: d, beside: b } = self;
        let diagonal = Vec3::new(
            b.x.mul_sub_from(b.x, d.y * d.z),
            b.y.mul_sub_from(b.y, d.x * d.z),
            b.z.mul_sub_from(b.z, d.x * d.y),
        );
        let beside = Vec3::new(
            b.x.mul_sub_from(d.x, b.y * b.z),
            b.y.mul_sub_from(d.y, b.x * b.z),
            b.z.mul_sub_from(d.z, b.x * b.y),
        );
        let row = Vec3::new(diagonal.x, beside.z, beside.y);
        let determinant = row.dot(Vec3::new(d.x, b.z, b.y));
        (Self { diagonal, beside }, determinant)
    }
}

impl<T: Scalar> Mul<Vec3<T>> for Sym3<T> {
    type Output = Vec3<T>;

    #[inline(always)]
    fn mul(self, v: Vec3<T>) -> Vec3<T> {
        let Self { diagonal: d, beside: b } = self;
        Vec3::new(
            Vec3::new(d.x, b.z, b.y).dot(v),
            Vec3::new(b.z, d.y, b.x).dot(v),
            Vec3::new(b.y, b.x, d.z).dot(v),
        )
    }
}

impl<T: Scalar> Mul<T> for Sym3<T> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        Self { diagonal: self.diagonal * factor, beside: self.beside * factor }
    }
}

impl<T: Scalar> AddAssign for Sym3<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.diagonal += other.diagonal;
        self.beside += other.beside;
    }
}

impl<T: Scalar> SubAssign for Sym3<T> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        self.diagonal -= other.diagonal;
        self.beside -= other.beside;
    }
}
