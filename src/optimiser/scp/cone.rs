//! The second-order cone of dimension four, as interior-point methods need it (Nesterov and Todd 1997,
//! doi:10.1287/moor.22.1.1).

use nalgebra::Vector4;

/// A point of a second-order cone of dimension four, and one of its dual.
#[derive(Clone, Copy)]
pub(super) struct Cone {
    pub(super) s: Vector4<f64>,
    pub(super) z: Vector4<f64>,
}

/// Nesterov and Todd's scaling `W`: `W z = W⁻¹ s = λ`.
pub(super) struct Scaling {
    eta: f64,
    w: Vector4<f64>,
    pub(super) lambda: Vector4<f64>,
}

/// `v_0² − ‖v_1…‖²`, positive inside.
fn determinant(v: &Vector4<f64>) -> f64 {
    let length = v.fixed_rows::<3>(1).norm();
    (v[0] - length) * (v[0] + length)
}

/// `a ∘ b`.
pub(super) fn product(a: &Vector4<f64>, b: &Vector4<f64>) -> Vector4<f64> {
    let mut c = b * a[0] + a * b[0];
    c[0] = a.dot(b);
    c
}

/// The `x` with `a ∘ x = b`.
pub(super) fn quotient(a: &Vector4<f64>, b: &Vector4<f64>) -> Vector4<f64> {
    let dot = a.dot(b) - a[0] * b[0];
    let first = (a[0] * b[0] - dot) / determinant(a);
    let mut x = (b - a * first) / a[0];
    x[0] = first;
    x
}

impl Cone {
    /// The scaling of both, unless rounding has put one on the boundary.
    pub(super) fn scaling(&self) -> Option<Scaling> {
        let (det_s, det_z) = (determinant(&self.s), determinant(&self.z));
        if !(det_s > 0.0 && det_z > 0.0) {
            return None;
        }
        let (s, mut z) = (self.s / det_s.sqrt(), self.z / det_z.sqrt());
        let gamma = f64::midpoint(1.0, s.dot(&z)).sqrt();
        z.fixed_rows_mut::<3>(1).neg_mut();
        let w = (s + z) / (2.0 * gamma);
        let eta = (det_s / det_z).powf(0.25);
        let scaling = Scaling { eta, w, lambda: Vector4::zeros() };
        Some(Scaling { lambda: scaling.times(&self.z), ..scaling })
    }

    /// How far `s + α ds` and `z + α dz` stay inside.
    pub(super) fn room(&self, ds: &Vector4<f64>, dz: &Vector4<f64>) -> f64 {
        room_in_cone(&self.s, ds).min(room_in_cone(&self.z, dz))
    }
}

/// How far `v + α d` stays inside.
fn room_in_cone(v: &Vector4<f64>, d: &Vector4<f64>) -> f64 {
    // det(v + α d) = c + 2 b α + a α²
    let (a, c) = (determinant(d), determinant(v));
    let b = 2.0 * v[0] * d[0] - v.dot(d);
    let mut least = f64::INFINITY;
    let discriminant = b * b - a * c;
    if discriminant >= 0.0 {
        let q = -(b + b.signum() * discriminant.sqrt());
        for root in [q / a, c / q] {
            if root > 0.0 {
                least = least.min(root);
            }
        }
    }
    if d[0] < 0.0 { least.min(-v[0] / d[0]) } else { least }
}

impl Scaling {
    /// `W v`.
    pub(super) fn times(&self, v: &Vector4<f64>) -> Vector4<f64> {
        let (w, dot) = (&self.w, self.w.dot(v) - self.w[0] * v[0]);
        let mut out = v + w * (v[0] + dot / (1.0 + w[0]));
        out[0] = w[0] * v[0] + dot;
        out * self.eta
    }

    /// `W⁻¹ v`.
    pub(super) fn inverse_times(&self, v: &Vector4<f64>) -> Vector4<f64> {
        let (w, dot) = (&self.w, self.w.dot(v) - self.w[0] * v[0]);
        let mut out = v + w * (dot / (1.0 + w[0]) - v[0]);
        out[0] = w[0] * v[0] - dot;
        out / self.eta
    }

    /// Entry of `W²`.
    pub(super) fn square(&self, i: usize, j: usize) -> f64 {
        let j_entry = if i != j {
            0.0
        } else if i == 0 {
            1.0
        } else {
            -1.0
        };
        self.eta * self.eta * (2.0 * self.w[i] * self.w[j] - j_entry)
    }
}
