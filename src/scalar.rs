//! The one numeric bound of the chain from joint angles to base attitude.

use nalgebra::SimdRealField;

/// A real number, or a vector of lanes of real numbers.
///
/// Kinematics, momentum and attitude are written once over this bound. `f64` evaluates one motion,
/// a SIMD type such as [`simba::simd::WideF64x4`] evaluates one motion a lane.
pub trait Scalar: SimdRealField<Element: SimdRealField> + Copy {
    /// The constant `value`, the same in every lane.
    #[inline]
    fn of(value: f64) -> Self {
        nalgebra::convert(value)
    }
}

impl<T: SimdRealField<Element: SimdRealField> + Copy> Scalar for T {}
