//! How many operations a rollout and its samples take, counted, and how many the processor can do.

use std::cell::Cell;
use std::hint::black_box;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
use std::time::Instant;

use driftless::attitude::Rollout;
use driftless::lanes::{LaneWork, Lanes, Width};
use driftless::momentum::Arm;
use driftless::reorientation::Reorientation;
use driftless::scalar::Scalar;
use driftless::trajectory::Sampler;

/// Operations on one number.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Operations {
    /// Products, alone or with a sum.
    pub(crate) products: u64,
    /// Sums, differences and comparisons.
    pub(crate) sums: u64,
    /// Signs, magnitudes, choices.
    pub(crate) bits: u64,
    /// Quotients and roots.
    pub(crate) quotients: u64,
}

thread_local! {
    static COUNTED: Cell<Operations> = const { Cell::new(Operations { products: 0, sums: 0, bits: 0, quotients: 0 }) };
}

fn count(change: impl Fn(&mut Operations)) {
    let mut counted = COUNTED.get();
    change(&mut counted);
    COUNTED.set(counted);
}

/// A number whose every operation is counted.
#[derive(Debug, Clone, Copy)]
struct Counted(f64);

macro_rules! operator {
    ($trait:ident, $method:ident, $kind:ident) => {
        impl $trait for Counted {
            type Output = Self;

            fn $method(self, other: Self) -> Self {
                count(|counted| counted.$kind += 1);
                Self(self.0.$method(other.0))
            }
        }
    };
}

operator!(Add, add, sums);
operator!(Sub, sub, sums);
operator!(Mul, mul, products);
operator!(Div, div, quotients);

impl Neg for Counted {
    type Output = Self;

    fn neg(self) -> Self {
        count(|counted| counted.bits += 1);
        Self(-self.0)
    }
}

impl AddAssign for Counted {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Counted {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl Scalar for Counted {
    fn of(value: f64) -> Self {
        Self(value)
    }

    fn mul_add(self, factor: Self, term: Self) -> Self {
        count(|counted| counted.products += 1);
        Self(Scalar::mul_add(self.0, factor.0, term.0))
    }

    fn mul_sub_from(self, factor: Self, term: Self) -> Self {
        count(|counted| counted.products += 1);
        Self(self.0.mul_sub_from(factor.0, term.0))
    }

    fn sqrt(self) -> Self {
        count(|counted| counted.quotients += 1);
        Self(self.0.sqrt())
    }

    fn abs(self) -> Self {
        count(|counted| counted.bits += 1);
        Self(self.0.abs())
    }

    fn larger(self, other: Self) -> Self {
        count(|counted| counted.sums += 1);
        Self(self.0.larger(other.0))
    }

    fn smaller(self, other: Self) -> Self {
        count(|counted| counted.sums += 1);
        Self(self.0.smaller(other.0))
    }

    fn all_below(self, limit: f64) -> bool {
        count(|counted| counted.sums += 1);
        self.0.all_below(limit)
    }

    fn select_below(self, limit: f64, less: Self, otherwise: Self) -> Self {
        count(|counted| (counted.sums, counted.bits) = (counted.sums + 1, counted.bits + 1));
        Self(self.0.select_below(limit, less.0, otherwise.0))
    }

    fn turn_quarters(quarters: Self, sin: Self, cos: Self) -> (Self, Self) {
        // With AVX-512: a test, an addition, two blends, and a shift and a logical operation for each.
        count(|counted| counted.bits += 8);
        let (sin, cos) = f64::turn_quarters(quarters.0, sin.0, cos.0);
        (Self(sin), Self(cos))
    }
}

impl Lanes for Counted {
    const COUNT: usize = 1;

    fn load(from: &[f64]) -> Self {
        Self(from[0])
    }

    fn store(self, to: &mut [f64]) {
        to[0] = self.0;
    }
}

/// The operations of work.
fn counted(work: impl FnOnce()) -> Operations {
    COUNTED.set(Operations::default());
    work();
    COUNTED.get()
}

/// What an evaluation at the search's accuracy consists of: the rollout, and the samples.
pub(crate) fn of_an_evaluation(problem: &Reorientation) -> [(&'static str, Operations); 2] {
    let (family, accuracy) = (problem.family(), problem.accuracy());
    let coefficients: Vec<f64> = (0..family.dimension()).map(|i| 0.03 * i as f64 - 0.2).collect();
    let arm = Arm::new(&problem.task().robot);
    let rollout = Rollout::new(family, accuracy.attitude_steps);
    let sampler = Sampler::new(family, accuracy.peak_intervals);
    let rolled = counted(|| {
        black_box(rollout.net_rotation::<Counted>(&arm, family, &coefficients, &mut Vec::new()));
    });
    let mut samples = sampler.samples(family.joints());
    let sampled = counted(|| sampler.sample::<Counted>(family, &coefficients, &mut samples));
    [("rollout of the attitude", rolled), ("samples of rate, acceleration and jerk", sampled)]
}

/// Operations on one number that the processor does in a nanosecond where nothing waits.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Peak {
    /// Fused products alone.
    products: f64,
    /// As many fused products as sums.
    both: f64,
}

impl Peak {
    /// With vectors of this width.
    pub(crate) fn of(width: Width) -> Self {
        let best = |sums| (0..5).map(|_| width.run(Busy { sums })).fold(0.0, f64::max);
        Self { products: best(false), both: best(true) }
    }

    /// Nanoseconds that operations take at least.
    pub(crate) fn bound(self, operations: Operations) -> f64 {
        let all = operations.products + operations.sums + operations.bits;
        f64::max(operations.products as f64 / self.products, all as f64 / self.both)
    }
}

/// Products that wait for none of their neighbours, and as many sums if wanted.
struct Busy {
    sums: bool,
}

impl LaneWork for Busy {
    type Output = f64;

    #[inline(always)]
    fn run<T: Lanes>(self) -> f64 {
        const TIMES: usize = 1_000_000;
        const EACH: usize = 8;
        let (factor, term) = (T::of(black_box(0.999)), T::of(black_box(1e-3)));
        let mut products = [T::of(1.0); EACH];
        let mut sums = [T::of(1.0); EACH];
        let clock = Instant::now();
        if self.sums {
            for _ in 0..TIMES {
                for (product, sum) in products.iter_mut().zip(&mut sums) {
                    *product = product.mul_add(factor, term);
                    *sum += term;
                }
            }
        } else {
            for _ in 0..TIMES {
                for product in &mut products {
                    *product = product.mul_add(factor, term);
                }
            }
        }
        let nanoseconds = clock.elapsed().as_secs_f64() * 1e9;
        for (product, sum) in products.into_iter().zip(sums) {
            black_box((product + sum).numbers());
        }
        let operations = TIMES * T::COUNT * EACH * (1 + usize::from(self.sums));
        operations as f64 / nanoseconds
    }
}
