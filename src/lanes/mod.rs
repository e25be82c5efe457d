//! Vectors of the processor as [`Scalar`]s, and the choice among them at run time.
//!
//! All that works with vectors has to be inlined into the one function that is compiled for their
//! instructions: elsewhere an instruction would become a call. Hence `#[inline(always)]` on the whole chain.

#[cfg(target_arch = "x86_64")]
mod x86;

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

    fn is_available(self) -> bool {
        match self {
            Self::Scalar => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => x86::has_avx2(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => x86::has_avx512(),
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
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
    ///
    /// Never inlined: what is compiled here for one kind of work then serves other crates, which would compile it anew.
    #[inline(never)]
    pub fn run<W: LaneWork>(self, work: W) -> W::Output {
        match self.min(Self::widest()) {
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => x86::avx2(work),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => x86::avx512(work),
            _ => work.run::<f64>(),
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
