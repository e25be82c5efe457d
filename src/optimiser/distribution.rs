//! The normal distribution that [`CmaEs`](super::CmaEs) adapts; letters and equation numbers are those
//! of Hansen's tutorial (arXiv:1604.00772v2).

use nalgebra::{DMatrix, DVector};

use crate::search::Rng;

/// How often a draw outside the box is drawn again.
const REDRAWS: usize = 10;

/// What follows from the numbers of variables and of points: table 1.
pub(super) struct Constants {
    /// One for each point, the best first; the first `μ` are positive.
    w: Vec<f64>,
    mu: usize,
    mu_eff: f64,
    c_sigma: f64,
    d_sigma: f64,
    c_c: f64,
    c_1: f64,
    c_mu: f64,
    /// Expected length of a normal vector, `E‖N(0, I)‖`.
    chi: f64,
}

impl Constants {
    pub(super) fn new(variables: usize, count: usize) -> Self {
        let (n, mu) = (variables as f64, count / 2);
        // Eq. 49.
        let middle = f64::midpoint(count as f64, 1.0).ln();
        let raw: Vec<f64> = (1..=count).map(|i| middle - (i as f64).ln()).collect();
        let [(sum, mu_eff), (sum_minus, mu_eff_minus)] = [&raw[..mu], &raw[mu..]].map(|w| {
            let (sum, squares) = (w.iter().sum::<f64>(), w.iter().map(|w| w * w).sum::<f64>());
            (sum.abs(), sum * sum / squares)
        });
        // Eqs. 55 to 58.
        let c_sigma = (mu_eff + 2.0) / (n + mu_eff + 5.0);
        let d_sigma = 1.0 + 2.0 * (((mu_eff - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0) + c_sigma;
        let c_c = (4.0 + mu_eff / n) / (n + 4.0 + 2.0 * mu_eff / n);
        let c_1 = 2.0 / ((n + 1.3).powi(2) + mu_eff);
        let c_mu = 2.0 * (0.25 + mu_eff + 1.0 / mu_eff - 2.0) / ((n + 2.0).powi(2) + mu_eff);
        let c_mu = c_mu.min(1.0 - c_1);
        // Eqs. 50 to 53.
        let alpha = (1.0 + c_1 / c_mu)
            .min(1.0 + 2.0 * mu_eff_minus / (mu_eff + 2.0))
            .min((1.0 - c_1 - c_mu) / (n * c_mu));
        let weight = |&w: &f64| if w >= 0.0 { w / sum } else { alpha * w / sum_minus };
        let w = raw.iter().map(weight).collect();
        let chi = n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));
        Self { w, mu, mu_eff, c_sigma, d_sigma, c_c, c_1, c_mu, chi }
    }
}

/// `N(m, σ² C)` with `C = B D² Bᵀ`, and the paths along which it moved.
pub(super) struct Distribution {
    pub(super) mean: DVector<f64>,
    pub(super) sigma: f64,
    c: DMatrix<f64>,
    b: DMatrix<f64>,
    d: DVector<f64>,
    p_sigma: DVector<f64>,
    p_c: DVector<f64>,
    generation: i32,
}

impl Distribution {
    pub(super) fn around(mean: DVector<f64>, sigma: f64) -> Self {
        let n = mean.len();
        Self {
            mean,
            sigma,
            c: DMatrix::identity(n, n),
            b: DMatrix::identity(n, n),
            d: DVector::repeat(n, 1.0),
            p_sigma: DVector::zeros(n),
            p_c: DVector::zeros(n),
            generation: 0,
        }
    }

    /// A step that stays within the unit cube, unless some draws in a row all leave it.
    pub(super) fn step_within(&self, rng: &mut Rng) -> DVector<f64> {
        let inside = |y: &DVector<f64>| {
            (&self.mean + self.sigma * y).iter().all(|z| (0.0..=1.0).contains(z))
        };
        let mut y = self.step(rng);
        for _ in 0..REDRAWS {
            if inside(&y) {
                break;
            }
            y = self.step(rng);
        }
        y
    }

    /// A draw from `N(0, C)`, eqs. 38 and 39.
    fn step(&self, rng: &mut Rng) -> DVector<f64> {
        let z = DVector::from_fn(self.d.len(), |_, _| rng.normal());
        &self.b * self.d.component_mul(&z)
    }

    /// Whether it can go on: appendix B.3, `ConditionCov`, `TolX` and `TolXUp`.
    pub(super) fn is_sound(&self, initial: f64) -> bool {
        let (shortest, longest) = (self.d.min(), self.d.max());
        let reach = self.sigma * longest / initial;
        shortest > 1e-7 * longest && reach > 1e-12 && reach < 1e4
    }

    /// Learns from the steps of a generation, the best first: eqs. 41 to 47.
    pub(super) fn adapt(&mut self, k: &Constants, y: &[&DVector<f64>]) {
        let n = self.mean.len() as f64;
        let weighted = k.w[..k.mu].iter().zip(y);
        let y_w = weighted.fold(DVector::zeros(self.mean.len()), |sum, (&w, &y)| sum + w * y);
        self.mean += self.sigma * &y_w;

        let whitened = &self.b * self.whiten(&y_w);
        self.p_sigma *= 1.0 - k.c_sigma;
        self.p_sigma += (k.c_sigma * (2.0 - k.c_sigma) * k.mu_eff).sqrt() * whitened;
        let length = self.p_sigma.norm() / k.chi;
        self.sigma *= (k.c_sigma / k.d_sigma * (length - 1.0)).exp();

        self.generation = self.generation.saturating_add(1);
        let so_far = 1.0 - (1.0 - k.c_sigma).powi(self.generation.saturating_mul(2));
        let h_sigma = if length / so_far.sqrt() < 1.4 + 2.0 / (n + 1.0) { 1.0 } else { 0.0 };
        self.p_c *= 1.0 - k.c_c;
        self.p_c += h_sigma * (k.c_c * (2.0 - k.c_c) * k.mu_eff).sqrt() * &y_w;

        let missed = (1.0 - h_sigma) * k.c_c * (2.0 - k.c_c);
        let kept = 1.0 + k.c_1 * missed - k.c_1 - k.c_mu * k.w.iter().sum::<f64>();
        let mut c = kept * &self.c;
        c.ger(k.c_1, &self.p_c, &self.p_c, 1.0);
        for (&w, &y) in k.w.iter().zip(y) {
            let w = if w < 0.0 { w * n / self.whiten(y).norm_squared() } else { w };
            c.ger(k.c_mu * w, y, y, 1.0);
        }
        self.c = c;
        self.decompose();
    }

    /// `D⁻¹ Bᵀ y`, as long as `C^(−1/2) y`.
    fn whiten(&self, y: &DVector<f64>) -> DVector<f64> {
        self.b.tr_mul(y).component_div(&self.d)
    }

    /// `B` and `D`; without a real one, a `D` of zeros, which is not sound.
    fn decompose(&mut self) {
        if self.c.iter().all(|entry| entry.is_finite()) {
            let eigen = self.c.clone().symmetric_eigen();
            self.d = eigen.eigenvalues.map(|value| value.max(0.0).sqrt());
            self.b = eigen.eigenvectors;
        } else {
            self.d.fill(0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Weights and rates of pycma 4.5, the first and the last two of the weights.
    #[test]
    fn constants_agree_with_pycma() {
        let near = |found: f64, expected: f64| {
            assert!((found - expected).abs() < 1e-14, "{found} is not {expected}");
        };
        let k = Constants::new(10, 10);
        near(k.mu_eff, 3.167_299_281_410_702);
        near(k.c_1, 0.015_283_824_524_751_714);
        near(k.c_mu, 0.023_551_776_650_417_47);
        near(k.c_c, 0.294_990_383_035_622_25);
        near(k.chi, 3.084_726_565_169_012_3);
        near(k.w[0], 0.456_272_646_903_405_97);
        near(k.w[8], -0.452_864_086_378_421_96);
        near(k.w[9], -0.549_749_917_697_385_3);
        let k = Constants::new(12, 40);
        near(k.c_mu, 0.093_077_300_377_506_39);
        near(k.w[0], 0.167_124_701_498_080_1);
        near(k.w[39], -0.070_799_156_250_569_37);
    }
}
