//! Functions with a known minimum, to try optimisers on.
//!
//! With `f` one of [`TestFunction`], `o` its own minimiser and `f*` its minimum, the cost is
//!
//! ```text
//! F(x) = f(R (x − x*) + o) − f*,    x in [−5, 5]ⁿ,    F(x*) = 0
//! ```
//!
//! Instance 0 is the textbook's function: `R` the identity, `x* = o`. For every other instance shift
//! and rotation follow from Weyl's sequence `k² φ mod 1`, uniform in the unit interval, with `φ` the
//! golden ratio (Weyl 1916, doi:10.1007/BF01475864; whole numbers of 64 bits keep it exact; half a
//! step is added to miss ½):
//!
//! ```text
//! u_k  = (⌊(k² G mod 2⁶⁴) / 2¹²⌋ + ½) / 2⁵²,   G = 0x9E3779B97F4A7C15,   k = i (n + n²) + 1, …
//! x*_j = 8 u − 4                    the instance's first n numbers
//! R    = H_1 H_2 ⋯ H_n,             H = I − 2 v vᵀ / (vᵀ v),    v_j = 2 u − 1
//! ```
//!
//! where `i` is the instance and each `v` takes the next `n` numbers. In Python, with NumPy:
//!
//! ```text
//! k = np.arange(n + n * n, dtype=object) + i * (n + n * n) + 1
//! u = np.array([((j * j * 0x9E3779B97F4A7C15 % 2**64 >> 12) + 0.5) / 2**52 for j in k])
//! shift, vectors, R = 8 * u[:n] - 4, 2 * u[n:].reshape(n, n) - 1, np.eye(n)
//! for v in vectors:
//!     R = R @ (np.eye(n) - 2 * np.outer(v, v) / (v @ v))
//! ```

use std::iter::repeat_with;
use std::sync::OnceLock;

use argmin_testfunctions::{
    ackley, ackley_derivative, rastrigin, rastrigin_derivative, rosenbrock, rosenbrock_derivative,
    sphere, sphere_derivative, styblinski_tang, styblinski_tang_derivative,
};
use nalgebra::{DMatrix, DVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::search::{
    Bounds, Differentiable, Evaluation, Failure, Problem, Slopes, Subgradient, Watch,
};

/// A function of any number of variables with one known minimum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TestFunction {
    /// `Σ x_j²`: what every method should find.
    Sphere,
    /// `Σ 10^(6 (j−1)/(n−1)) x_j²`: one basin, axes of lengths a thousandfold apart.
    Ellipsoid,
    /// `Σ 100 (x_{j+1} − x_j²)² + (1 − x_j)²`, of two variables or more: a bent valley.
    Rosenbrock,
    /// `Σ 10 + x_j² − 10 cos 2πx_j`: a basin around every whole-numbered point.
    Rastrigin,
    /// `20 + e − 20 exp(−⅕ √(Σ x_j²/n)) − exp(Σ cos(2πx_j)/n)`: a funnel with a rough wall.
    Ackley,
    /// `½ Σ x_j⁴ − 16 x_j² + 5 x_j`: 2ⁿ basins, far apart, of unlike depth.
    StyblinskiTang,
}

impl TestFunction {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Sphere,
        Self::Ellipsoid,
        Self::Rosenbrock,
        Self::Rastrigin,
        Self::Ackley,
        Self::StyblinskiTang,
    ];

    /// The number that exports have for it; one that is added gets the next.
    pub fn number(self) -> u32 {
        match self {
            Self::Sphere => 1,
            Self::Ellipsoid => 2,
            Self::Rosenbrock => 3,
            Self::Rastrigin => 4,
            Self::Ackley => 5,
            Self::StyblinskiTang => 6,
        }
    }

    /// The name used in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
            Self::Ellipsoid => "ellipsoid",
            Self::Rosenbrock => "rosenbrock",
            Self::Rastrigin => "rastrigin",
            Self::Ackley => "ackley",
            Self::StyblinskiTang => "styblinski-tang",
        }
    }

    /// `f(z)`, as the variants' descriptions have it.
    pub fn value(self, z: &[f64]) -> f64 {
        match self {
            Self::Sphere => sphere(z),
            Self::Ellipsoid => ellipsoid(z),
            Self::Rosenbrock => rosenbrock(z),
            Self::Rastrigin => rastrigin(z),
            Self::Ackley => ackley(z),
            Self::StyblinskiTang => styblinski_tang(z),
        }
    }

    /// `∂f/∂z_j`; at the minimum of Ackley's function, which is a kink, zero.
    pub fn gradient(self, z: &[f64]) -> Vec<f64> {
        match self {
            Self::Sphere => sphere_derivative(z),
            Self::Ellipsoid => ellipsoid_gradient(z),
            Self::Rosenbrock => rosenbrock_derivative(z),
            Self::Rastrigin => rastrigin_derivative(z),
            Self::Ackley => ackley_derivative(z),
            Self::StyblinskiTang => styblinski_tang_derivative(z),
        }
    }

    /// Every component of `o`, where `f` is least.
    fn minimiser(self) -> f64 {
        match self {
            Self::Rosenbrock => 1.0,
            // The lowest root of 4z³ − 32z + 5.
            Self::StyblinskiTang => -2.903_534_027_771_177,
            _ => 0.0,
        }
    }
}

/// Condition number 10⁶.
fn ellipsoid(z: &[f64]) -> f64 {
    ellipsoid_weights(z.len()).zip(z).map(|(weight, z)| weight * z * z).sum()
}

fn ellipsoid_gradient(z: &[f64]) -> Vec<f64> {
    ellipsoid_weights(z.len()).zip(z).map(|(weight, z)| 2.0 * weight * z).collect()
}

fn ellipsoid_weights(n: usize) -> impl Iterator<Item = f64> {
    let last = (n - 1).max(1) as f64;
    (0..n).map(move |j| 1e6_f64.powf(j as f64 / last))
}

/// A [`TestFunction`], shifted and rotated within `[−5, 5]ⁿ`.
#[derive(Debug, Clone)]
pub struct Analytic {
    function: TestFunction,
    instance: u64,
    bounds: Bounds,
    /// `x*`.
    optimum: DVector<f64>,
    /// `R`, once it is asked for: with a thousand variables it takes seconds to make.
    rotation: OnceLock<DMatrix<f64>>,
    /// `f*`.
    minimum: f64,
}

impl Analytic {
    /// The function of `dimension` variables, at least one, with the shift and the rotation of that
    /// instance; instance 0 has neither.
    pub fn new(function: TestFunction, dimension: usize, instance: u64) -> Self {
        let n = dimension;
        let own = vec![function.minimiser(); n];
        let optimum =
            if instance == 0 { DVector::from_column_slice(&own) } else { shift(n, instance) };
        Self {
            function,
            instance,
            bounds: Bounds::cube(n, [-5.0, 5.0]),
            optimum,
            rotation: OnceLock::new(),
            minimum: function.value(&own),
        }
    }

    /// Which function.
    pub fn function(&self) -> TestFunction {
        self.function
    }

    /// `x*`, where the cost is zero.
    pub fn optimum(&self) -> &[f64] {
        self.optimum.as_slice()
    }

    /// `R`, orthogonal, `n × n`.
    pub fn rotation(&self) -> &DMatrix<f64> {
        self.rotation.get_or_init(|| rotation(self.bounds.len(), self.instance))
    }

    /// `R (x − x*) + o`.
    fn placed(&self, x: &[f64]) -> DVector<f64> {
        let offset = DVector::from_column_slice(x) - &self.optimum;
        (self.rotation() * offset).add_scalar(self.function.minimiser())
    }
}

impl Problem for Analytic {
    fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    fn evaluate(&self, x: &[f64]) -> Result<Evaluation, Failure> {
        let cost = self.function.value(self.placed(x).as_slice()) - self.minimum;
        Ok(cost.into())
    }

    fn slopes(&self) -> Option<Slopes<'_>> {
        Some(Slopes::Own(self))
    }

    fn least_cost(&self) -> Option<f64> {
        Some(0.0)
    }

    fn prepare(&self, _: &Watch) {
        self.rotation();
    }
}

impl Differentiable for Analytic {
    fn subgradient(&self, x: &[f64]) -> Result<Subgradient, Failure> {
        let gradient = self.function.gradient(self.placed(x).as_slice());
        let slopes = self.rotation().tr_mul(&DVector::from_vec(gradient));
        Ok(Subgradient { evaluation: self.evaluate(x)?, slopes })
    }
}

/// The numbers `u_k` of an instance.
fn units(n: usize, instance: u64) -> impl Iterator<Item = f64> {
    let mut k = instance.wrapping_mul((n + n * n) as u64);
    repeat_with(move || {
        k = k.wrapping_add(1);
        weyl(k)
    })
}

/// `x*` of an instance but 0.
fn shift(n: usize, instance: u64) -> DVector<f64> {
    DVector::from_iterator(n, units(n, instance).take(n).map(|unit| 8.0 * unit - 4.0))
}

/// `R` of an instance.
fn rotation(n: usize, instance: u64) -> DMatrix<f64> {
    let mut rotation = DMatrix::identity(n, n);
    if instance == 0 {
        return rotation;
    }
    let mut units = units(n, instance).skip(n);
    for _ in 0..n {
        let v = DVector::from_iterator(n, units.by_ref().take(n).map(|unit| 2.0 * unit - 1.0));
        let reflected = &rotation * &v * (2.0 / v.norm_squared());
        rotation -= reflected * v.transpose();
    }
    rotation
}

/// `u_k`: within `(0, 1)` and never ½, so that no reflection's vector vanishes.
fn weyl(k: u64) -> f64 {
    let steps = k.wrapping_mul(k).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 12;
    (steps as f64 + 0.5) / (1_u64 << 52) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Scale of the functions around their minimum, to judge rounding by.
    fn scale(function: TestFunction) -> f64 {
        match function {
            TestFunction::Ellipsoid => 1e6,
            _ => 1e2,
        }
    }

    #[test]
    fn zero_at_the_optimum_and_nowhere_near_it_less() {
        for function in TestFunction::ALL {
            for (n, instance) in [(2, 0), (2, 1), (3, 7), (10, 0), (10, 3), (10, u64::MAX)] {
                let problem = Analytic::new(function, n, instance);
                let at_optimum = problem.evaluate(problem.optimum()).unwrap().cost;
                assert!(at_optimum.abs() < 1e-15 * scale(function) * n as f64, "{at_optimum}");
                assert!(problem.bounds().contains(problem.optimum()));
                for j in 0..n {
                    for step in [-0.3, -1e-3, 1e-3, 0.3] {
                        let mut x = problem.optimum().to_vec();
                        x[j] += step;
                        assert!(
                            problem.evaluate(&x).unwrap().cost > 0.0,
                            "{function:?} {n} {instance}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn rotations_are_orthogonal() {
        for (n, instance) in [(1, 1), (2, 1), (3, 2), (10, 1), (40, 12), (10, u64::MAX)] {
            let problem = Analytic::new(TestFunction::Sphere, n, instance);
            let r = problem.rotation();
            let error = (r * r.transpose() - DMatrix::identity(n, n)).amax();
            assert!(error < 1e-14, "{n} variables, instance {instance}: {error}");
        }
    }

    /// Textbook functions: SciPy's `rosen`, and closed forms.
    #[test]
    fn instance_zero_is_the_textbooks() {
        let value =
            |function, x: &[f64]| Analytic::new(function, x.len(), 0).evaluate(x).unwrap().cost;
        let near = |found: f64, expected: f64| {
            assert!((found - expected).abs() < 1e-13 * expected, "{found} is not {expected}");
        };
        near(value(TestFunction::Sphere, &[1.0, 2.0, 3.0]), 14.0);
        near(value(TestFunction::Ellipsoid, &[1.0, -1.0, 2.0]), 4_001_001.0);
        near(value(TestFunction::Rosenbrock, &[0.5, -1.5, 2.0, 0.25]), 1726.25);
        near(value(TestFunction::Rastrigin, &[1.0, 2.0, -0.5]), 1.0 + 4.0 + 0.25 + 20.0);
        near(value(TestFunction::Ackley, &[1.0, -1.0]), 20.0 * (1.0 - (-0.2_f64).exp()));
        near(value(TestFunction::StyblinskiTang, &[0.0, 0.0]), 78.332_331_407_542_83);
    }

    /// The module's Python, with SciPy's `rosen` and NumPy, at one point of instance 2.
    #[test]
    fn other_instances_are_as_documented() {
        let expected = [
            26.754_987_820_169_923,
            24_979_854.036_293_767,
            8_341.650_810_304_282,
            54.221_493_985_983_54,
            10.623_940_667_892_613,
            1_491.177_591_002_3,
        ];
        for (function, expected) in TestFunction::ALL.into_iter().zip(expected) {
            let problem = Analytic::new(function, 3, 2);
            let found = problem.evaluate(&[1.0, -2.0, 0.5]).unwrap().cost;
            assert!((found - expected).abs() < 1e-13 * expected, "{function:?}: {found}");
            assert_eq!(problem.optimum()[0], -1.830_056_250_525_76);
        }
    }
}
