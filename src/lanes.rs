//! Vectors of the processor as [`Scalar`]s, and the choice among them at run time.
//!
//! All `unsafe` of this crate is here. A vector type is private; its numbers are made only in work that
//! [`Width::run`] begins, after the processor has been asked, and within the function that is compiled for
//! that processor's instructions. All that works with vectors has to be inlined into that function:
//! elsewhere an instruction would become a call. Hence `#[inline(always)]` on the whole chain.

#![expect(unsafe_code, reason = "the processor's vector instructions")]

use std::sync::LazyLock;

use crate::scalar::Scalar;

/// The most lanes of any type here. Tables that are loaded from are padded to a multiple of twice that.
pub const MOST: usize = 8;

/// Numbers for as many lanes as there can be. A table of these is loaded from without crossing the lines
/// of the processor's cache.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(align(64))]
pub struct Block(pub [f64; MOST]);

/// Several numbers.
pub trait Lanes: Scalar {
    /// How many: a divisor of [`MOST`].
    const COUNT: usize;

    /// The first numbers of a slice.
    ///
    /// # Panics
    ///
    /// Panics when there are fewer than lanes.
    fn load(from: &[f64]) -> Self;

    /// All numbers, followed by zeros.
    #[inline(always)]
    fn numbers(self) -> [f64; MOST] {
        let mut numbers = [0.0; MOST];
        self.store(&mut numbers);
        numbers
    }

    /// Writes the numbers to the begin of a slice.
    ///
    /// # Panics
    ///
    /// Panics when it is shorter than there are lanes.
    fn store(self, to: &mut [f64]);
}

impl Lanes for f64 {
    const COUNT: usize = 1;

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        from[0]
    }

    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[0] = self;
    }
}

/// Work that can be done with any number of lanes, with the same result.
pub trait LaneWork {
    /// What comes out.
    type Output;

    /// Does it. Has to be `#[inline(always)]`, like all that it calls with a `T`.
    fn run<T: Lanes>(self) -> Self::Output;
}

/// What of a processor is made use of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Width {
    /// One number at a time, on every machine.
    Scalar,
    /// Four lanes on `x86_64` with AVX2 and FMA.
    Avx2,
    /// Eight lanes on `x86_64` with AVX-512 (F).
    Avx512,
}

impl Width {
    /// All that this machine has, the narrowest first.
    pub fn available() -> impl Iterator<Item = Self> {
        [Self::Scalar, Self::Avx2, Self::Avx512].into_iter().filter(|width| width.is_available())
    }

    #[cfg(target_arch = "x86_64")]
    fn is_available(self) -> bool {
        match self {
            Self::Scalar => true,
            Self::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            // For the compiler the one implies the other.
            Self::Avx512 => Self::Avx2.is_available() && is_x86_feature_detected!("avx512f"),
        }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn is_available(self) -> bool {
        self == Self::Scalar
    }

    /// The widest that this machine has.
    pub fn widest() -> Self {
        static WIDEST: LazyLock<Width> =
            LazyLock::new(|| Width::available().max().unwrap_or(Width::Scalar));
        *WIDEST
    }

    /// The number of lanes.
    pub fn lanes(self) -> usize {
        match self {
            Self::Scalar => 1,
            Self::Avx2 => 4,
            Self::Avx512 => 8,
        }
    }

    /// The name used in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Avx2 => "AVX2",
            Self::Avx512 => "AVX-512",
        }
    }

    /// Does work with so many lanes, or with fewer where this machine has not so many.
    pub fn run<W: LaneWork>(self, work: W) -> W::Output {
        match self.min(Self::widest()) {
            Self::Scalar => work.run::<f64>(),
            // SAFETY: the widest is among those available, so the processor has been asked; what has
            // AVX-512 has been asked for AVX2 and FMA too.
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => unsafe { x86::avx2(work) },
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => unsafe { x86::avx512(work) },
            #[cfg(not(target_arch = "x86_64"))]
            _ => work.run::<f64>(),
        }
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::{
        __m256d, __m512d, _CMP_LT_OQ, _mm256_add_epi64, _mm256_add_pd, _mm256_and_si256,
        _mm256_andnot_pd, _mm256_blendv_pd, _mm256_castpd_si256, _mm256_castsi256_pd,
        _mm256_cmp_pd, _mm256_div_pd, _mm256_fmadd_pd, _mm256_fnmadd_pd, _mm256_loadu_pd,
        _mm256_max_pd, _mm256_min_pd, _mm256_movemask_pd, _mm256_mul_pd, _mm256_set1_epi64x,
        _mm256_set1_pd, _mm256_slli_epi64, _mm256_sqrt_pd, _mm256_storeu_pd, _mm256_sub_pd,
        _mm256_xor_pd, _mm512_abs_pd, _mm512_add_epi64, _mm512_add_pd, _mm512_and_si512,
        _mm512_castpd_si512, _mm512_castsi512_pd, _mm512_cmp_pd_mask, _mm512_div_pd,
        _mm512_fmadd_pd, _mm512_fnmadd_pd, _mm512_loadu_pd, _mm512_mask_blend_pd, _mm512_max_pd,
        _mm512_min_pd, _mm512_mul_pd, _mm512_set1_epi64, _mm512_set1_pd, _mm512_slli_epi64,
        _mm512_sqrt_pd, _mm512_storeu_pd, _mm512_sub_pd, _mm512_test_epi64_mask, _mm512_xor_si512,
    };
    use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

    use super::{LaneWork, Lanes};
    use crate::scalar::Scalar;

    #[target_feature(enable = "avx2,fma")]
    pub(super) fn avx2<W: LaneWork>(work: W) -> W::Output {
        work.run::<F64x4>()
    }

    #[target_feature(enable = "avx512f")]
    pub(super) fn avx512<W: LaneWork>(work: W) -> W::Output {
        work.run::<F64x8>()
    }

    // SAFETY of every block below: these types are named in the two functions above alone, so whoever has
    // one of them, or its functions, got it after the processor was asked; pointers are those of slices just
    // checked for their length.

    macro_rules! operator {
        ($lanes:ident, $trait:ident, $method:ident, $instruction:ident) => {
            impl $trait for $lanes {
                type Output = Self;

                #[inline(always)]
                fn $method(self, other: Self) -> Self {
                    Self(unsafe { $instruction(self.0, other.0) })
                }
            }
        };
    }

    /// What is the same for both but for the names of instructions.
    macro_rules! lanes {
        (
            $lanes:ident, $vector:ident, $count:literal,
            $add:ident, $sub:ident, $mul:ident, $div:ident, $max:ident, $min:ident, $sqrt:ident,
            $set:ident, $load:ident, $store:ident, $mul_add:ident, $mul_sub_from:ident
        ) => {
            #[derive(Debug, Clone, Copy)]
            pub(super) struct $lanes($vector);

            operator!($lanes, Add, add, $add);
            operator!($lanes, Sub, sub, $sub);
            operator!($lanes, Mul, mul, $mul);
            operator!($lanes, Div, div, $div);

            impl AddAssign for $lanes {
                #[inline(always)]
                fn add_assign(&mut self, other: Self) {
                    *self = *self + other;
                }
            }

            impl SubAssign for $lanes {
                #[inline(always)]
                fn sub_assign(&mut self, other: Self) {
                    *self = *self - other;
                }
            }

            impl Lanes for $lanes {
                const COUNT: usize = $count;

                #[inline(always)]
                fn load(from: &[f64]) -> Self {
                    Self(unsafe { $load(from[..$count].as_ptr()) })
                }

                #[inline(always)]
                fn store(self, to: &mut [f64]) {
                    unsafe { $store(to[..$count].as_mut_ptr(), self.0) }
                }
            }

            impl Scalar for $lanes {
                #[inline(always)]
                fn of(value: f64) -> Self {
                    Self(unsafe { $set(value) })
                }

                #[inline(always)]
                fn mul_add(self, factor: Self, term: Self) -> Self {
                    Self(unsafe { $mul_add(self.0, factor.0, term.0) })
                }

                #[inline(always)]
                fn mul_sub_from(self, factor: Self, term: Self) -> Self {
                    Self(unsafe { $mul_sub_from(self.0, factor.0, term.0) })
                }

                #[inline(always)]
                fn sqrt(self) -> Self {
                    Self(unsafe { $sqrt(self.0) })
                }

                #[inline(always)]
                fn abs(self) -> Self {
                    self.magnitude()
                }

                #[inline(always)]
                fn larger(self, other: Self) -> Self {
                    Self(unsafe { $max(self.0, other.0) })
                }

                #[inline(always)]
                fn smaller(self, other: Self) -> Self {
                    Self(unsafe { $min(self.0, other.0) })
                }

                #[inline(always)]
                fn all_below(self, limit: f64) -> bool {
                    self.are_all_below(limit)
                }

                #[inline(always)]
                fn select_below(self, limit: f64, less: Self, otherwise: Self) -> Self {
                    self.pick_below(limit, less, otherwise)
                }

                #[inline(always)]
                fn turn_quarters(quarters: Self, sin: Self, cos: Self) -> (Self, Self) {
                    quarters.turn(sin, cos)
                }
            }
        };
    }

    lanes!(
        F64x4,
        __m256d,
        4,
        _mm256_add_pd,
        _mm256_sub_pd,
        _mm256_mul_pd,
        _mm256_div_pd,
        _mm256_max_pd,
        _mm256_min_pd,
        _mm256_sqrt_pd,
        _mm256_set1_pd,
        _mm256_loadu_pd,
        _mm256_storeu_pd,
        _mm256_fmadd_pd,
        _mm256_fnmadd_pd
    );
    lanes!(
        F64x8,
        __m512d,
        8,
        _mm512_add_pd,
        _mm512_sub_pd,
        _mm512_mul_pd,
        _mm512_div_pd,
        _mm512_max_pd,
        _mm512_min_pd,
        _mm512_sqrt_pd,
        _mm512_set1_pd,
        _mm512_loadu_pd,
        _mm512_storeu_pd,
        _mm512_fmadd_pd,
        _mm512_fnmadd_pd
    );

    impl Neg for F64x4 {
        type Output = Self;

        #[inline(always)]
        fn neg(self) -> Self {
            Self(unsafe { _mm256_xor_pd(self.0, _mm256_set1_pd(-0.0)) })
        }
    }

    impl F64x4 {
        #[inline(always)]
        fn magnitude(self) -> Self {
            Self(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
        }

        #[inline(always)]
        fn are_all_below(self, limit: f64) -> bool {
            let below = unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, _mm256_set1_pd(limit)) };
            unsafe { _mm256_movemask_pd(below) == 0b1111 }
        }

        #[inline(always)]
        fn pick_below(self, limit: f64, less: Self, otherwise: Self) -> Self {
            let below = unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, _mm256_set1_pd(limit)) };
            Self(unsafe { _mm256_blendv_pd(otherwise.0, less.0, below) })
        }

        #[inline(always)]
        fn turn(self, sin: Self, cos: Self) -> (Self, Self) {
            unsafe {
                let q = _mm256_castpd_si256(self.0);
                // A blend looks at the highest bit alone.
                let odd = _mm256_castsi256_pd(_mm256_slli_epi64::<63>(q));
                let two = _mm256_set1_epi64x(2);
                let next = _mm256_add_epi64(q, _mm256_set1_epi64x(1));
                let sign =
                    |q| _mm256_castsi256_pd(_mm256_slli_epi64::<62>(_mm256_and_si256(q, two)));
                (
                    Self(_mm256_xor_pd(_mm256_blendv_pd(sin.0, cos.0, odd), sign(q))),
                    Self(_mm256_xor_pd(_mm256_blendv_pd(cos.0, sin.0, odd), sign(next))),
                )
            }
        }
    }

    impl Neg for F64x8 {
        type Output = Self;

        #[inline(always)]
        fn neg(self) -> Self {
            unsafe {
                let sign = _mm512_castpd_si512(_mm512_set1_pd(-0.0));
                Self(_mm512_castsi512_pd(_mm512_xor_si512(_mm512_castpd_si512(self.0), sign)))
            }
        }
    }

    impl F64x8 {
        #[inline(always)]
        fn magnitude(self) -> Self {
            Self(unsafe { _mm512_abs_pd(self.0) })
        }

        #[inline(always)]
        fn are_all_below(self, limit: f64) -> bool {
            unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, _mm512_set1_pd(limit)) == 0xff }
        }

        #[inline(always)]
        fn pick_below(self, limit: f64, less: Self, otherwise: Self) -> Self {
            unsafe {
                let below = _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, _mm512_set1_pd(limit));
                Self(_mm512_mask_blend_pd(below, otherwise.0, less.0))
            }
        }

        #[inline(always)]
        fn turn(self, sin: Self, cos: Self) -> (Self, Self) {
            unsafe {
                let q = _mm512_castpd_si512(self.0);
                let odd = _mm512_test_epi64_mask(q, _mm512_set1_epi64(1));
                let two = _mm512_set1_epi64(2);
                let next = _mm512_add_epi64(q, _mm512_set1_epi64(1));
                let signed = |value, q| {
                    let sign = _mm512_slli_epi64::<62>(_mm512_and_si512(q, two));
                    Self(_mm512_castsi512_pd(_mm512_xor_si512(_mm512_castpd_si512(value), sign)))
                };
                (
                    signed(_mm512_mask_blend_pd(odd, sin.0, cos.0), q),
                    signed(_mm512_mask_blend_pd(odd, cos.0, sin.0), next),
                )
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Pair;

    /// What work makes of two rows of numbers, one operation after the other.
    struct Each<'a>(&'a [f64], &'a [f64]);

    impl LaneWork for Each<'_> {
        type Output = [Vec<f64>; 17];

        #[inline(always)]
        fn run<T: Lanes>(self) -> [Vec<f64>; 17] {
            let mut all = std::array::from_fn(|_| Vec::new());
            for (a, b) in self.0.chunks_exact(T::COUNT).zip(self.1.chunks_exact(T::COUNT)) {
                let (a, b) = (T::load(a), T::load(b));
                let (sin, cos) = a.sin_cos();
                let mut sum = a;
                sum += b;
                sum -= a;
                let results = [
                    a + b,
                    a - b,
                    a * b,
                    a / b,
                    -a,
                    a.sqrt(),
                    a.abs(),
                    a.larger(b),
                    a.smaller(b),
                    a.select_below(1.0, a, b),
                    sum,
                    T::of(0.1),
                    Pair(a, b).mul_add(Pair(b, a), Pair(a, a)).0,
                    a.mul_add(b, T::of(0.3)),
                    a.mul_sub_from(b, T::of(0.3)),
                    sin,
                    cos,
                ];
                for (k, result) in results.into_iter().enumerate() {
                    all[k].extend(&result.numbers()[..T::COUNT]);
                }
            }
            all
        }
    }

    fn numbers() -> [Vec<f64>; 2] {
        let special = [0.0, -0.0, 1.0, f64::NAN, f64::INFINITY, -1e300, 1e-310, 3.5];
        let plain = (0..4000).map(|i| f64::from(i - 2000) * 0.137);
        let a: Vec<f64> = special.into_iter().chain(plain).collect();
        let b = a.iter().rev().copied().collect();
        [a, b]
    }

    fn same(a: f64, b: f64) -> bool {
        a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
    }

    /// Operations that are rounded once give the bits that `f64` gives; the fused ones are those of the
    /// platform's library.
    #[test]
    fn lanes_give_the_bits_of_one_number() {
        let [a, b] = numbers();
        let one = Width::Scalar.run(Each(&a, &b));
        for width in Width::available().filter(|width| *width != Width::Scalar) {
            let found = width.run(Each(&a, &b));
            for i in 0..a.len() {
                for k in 0..12 {
                    assert!(same(found[k][i], one[k][i]), "{width:?}, operation {k}, {}", a[i]);
                }
                let fused =
                    [a[i].mul_add(b[i], a[i]), a[i].mul_add(b[i], 0.3), (-a[i]).mul_add(b[i], 0.3)];
                for (found, expected) in found[12..15].iter().zip(fused) {
                    assert!(same(found[i], expected), "{width:?}: {} {}", a[i], b[i]);
                }
            }
        }
    }

    /// Sine and cosine on numbers of moderate size; all vectors give the same bits.
    #[test]
    fn lanes_agree_on_sines() {
        let [a, b] = numbers();
        let vectors: Vec<_> = Width::available()
            .filter(|width| *width != Width::Scalar)
            .map(|width| width.run(Each(&a, &b)))
            .collect();
        for (i, x) in a.iter().enumerate() {
            for k in [15, 16] {
                for found in &vectors {
                    assert!(same(found[k][i], vectors[0][k][i]), "{x}");
                    let expected = if k == 15 { x.sin() } else { x.cos() };
                    let close = (found[k][i] - expected).abs() < 1.2 * f64::EPSILON;
                    assert!(close || x.abs() > 1e6 || x.is_nan(), "{x}: {}", found[k][i]);
                }
            }
        }
    }

    #[test]
    fn all_lanes_are_asked() {
        struct Below(usize);
        impl LaneWork for Below {
            type Output = bool;

            #[inline(always)]
            fn run<T: Lanes>(self) -> bool {
                let mut values = [0.5; MOST];
                values[self.0 % T::COUNT] = 1.0;
                T::load(&values).all_below(1.0) || !T::of(0.5).all_below(1.0)
            }
        }
        for width in Width::available() {
            assert!((0..MOST).all(|lane| !width.run(Below(lane))), "{width:?}");
        }
    }
}
