//! Four lanes with AVX2 and FMA, eight with AVX-512: all `unsafe` of this crate.
//!
//! The vector types are private and named only in the two functions below that have asked the processor, so
//! whoever has one of them, or its functions, got it after that.

#![expect(unsafe_code, reason = "the processor's vector instructions")]

use std::arch::x86_64::{
    __m256d, __m512d, _CMP_LT_OQ, _mm256_add_epi64, _mm256_add_pd, _mm256_and_si256,
    _mm256_andnot_pd, _mm256_blendv_pd, _mm256_castpd_si256, _mm256_castsi256_pd, _mm256_cmp_pd,
    _mm256_div_pd, _mm256_fmadd_pd, _mm256_fnmadd_pd, _mm256_loadu_pd, _mm256_max_pd,
    _mm256_min_pd, _mm256_movemask_pd, _mm256_mul_pd, _mm256_set1_epi64x, _mm256_set1_pd,
    _mm256_slli_epi64, _mm256_sqrt_pd, _mm256_storeu_pd, _mm256_sub_pd, _mm256_xor_pd,
    _mm512_abs_pd, _mm512_add_epi64, _mm512_add_pd, _mm512_and_si512, _mm512_castpd_si512,
    _mm512_castsi512_pd, _mm512_cmp_pd_mask, _mm512_div_pd, _mm512_fmadd_pd, _mm512_fnmadd_pd,
    _mm512_loadu_pd, _mm512_mask_blend_pd, _mm512_max_pd, _mm512_min_pd, _mm512_mul_pd,
    _mm512_set1_epi64, _mm512_set1_pd, _mm512_slli_epi64, _mm512_sqrt_pd, _mm512_storeu_pd,
    _mm512_sub_pd, _mm512_test_epi64_mask, _mm512_xor_si512,
};
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use super::{LaneWork, Lanes};
use crate::scalar::Scalar;

/// Whether this processor has what [`avx2`] makes use of.
pub(super) fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
}

/// Whether this processor has what [`avx512`] makes use of; for the compiler that is AVX2 and FMA too.
pub(super) fn has_avx512() -> bool {
    has_avx2() && is_x86_feature_detected!("avx512f")
}

/// Does work with four lanes.
///
/// # Panics
///
/// Panics when the processor does not have them.
pub(super) fn avx2<W: LaneWork>(work: W) -> W::Output {
    #[target_feature(enable = "avx2,fma")]
    fn inner<W: LaneWork>(work: W) -> W::Output {
        work.run::<F64x4>()
    }
    assert!(has_avx2(), "four lanes");
    // SAFETY: the processor has just been asked.
    unsafe { inner(work) }
}

/// Does work with eight lanes.
///
/// # Panics
///
/// Panics when the processor does not have them.
pub(super) fn avx512<W: LaneWork>(work: W) -> W::Output {
    #[target_feature(enable = "avx512f")]
    fn inner<W: LaneWork>(work: W) -> W::Output {
        work.run::<F64x8>()
    }
    assert!(has_avx512(), "eight lanes");
    // SAFETY: the processor has just been asked.
    unsafe { inner(work) }
}

// SAFETY of every block below: as the page says, the processor was asked; pointers are those of slices
// just checked for their length.

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
        $set:ident, $load:ident, $store:ident, $mul_add:ident, $mul_sub_from:ident,
        { $($own:tt)* }
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
            fn larger(self, other: Self) -> Self {
                Self(unsafe { $max(self.0, other.0) })
            }

            #[inline(always)]
            fn smaller(self, other: Self) -> Self {
                Self(unsafe { $min(self.0, other.0) })
            }

            $($own)*
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
    _mm256_fnmadd_pd,
    {
        #[inline(always)]
        fn abs(self) -> Self {
            Self(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
        }

        #[inline(always)]
        fn all_below(self, limit: f64) -> bool {
            let below = unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, _mm256_set1_pd(limit)) };
            unsafe { _mm256_movemask_pd(below) == 0b1111 }
        }

        #[inline(always)]
        fn select_below(self, limit: f64, less: Self, otherwise: Self) -> Self {
            let below = unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, _mm256_set1_pd(limit)) };
            Self(unsafe { _mm256_blendv_pd(otherwise.0, less.0, below) })
        }

        #[inline(always)]
        fn turn_quarters(quarters: Self, sin: Self, cos: Self) -> (Self, Self) {
            unsafe {
                let q = _mm256_castpd_si256(quarters.0);
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
    _mm512_fnmadd_pd,
    {
        #[inline(always)]
        fn abs(self) -> Self {
            Self(unsafe { _mm512_abs_pd(self.0) })
        }

        #[inline(always)]
        fn all_below(self, limit: f64) -> bool {
            unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, _mm512_set1_pd(limit)) == 0xff }
        }

        #[inline(always)]
        fn select_below(self, limit: f64, less: Self, otherwise: Self) -> Self {
            unsafe {
                let below = _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, _mm512_set1_pd(limit));
                Self(_mm512_mask_blend_pd(below, otherwise.0, less.0))
            }
        }

        #[inline(always)]
        fn turn_quarters(quarters: Self, sin: Self, cos: Self) -> (Self, Self) {
            unsafe {
                let q = _mm512_castpd_si512(quarters.0);
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
);

impl Neg for F64x4 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(unsafe { _mm256_xor_pd(self.0, _mm256_set1_pd(-0.0)) })
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
