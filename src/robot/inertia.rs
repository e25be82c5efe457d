//! Inertias in files.

use nalgebra::{Cholesky, Matrix3};
use serde::{Deserialize, Serialize};

use crate::input::finite;

/// A symmetric matrix that is known to be positive definite.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(try_from = "InertiaTable", into = "InertiaTable")]
pub(super) struct Inertia(pub(super) Matrix3<f64>);

/// The entries of a symmetric matrix \[kg m²\].
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct InertiaTable {
    #[serde(deserialize_with = "finite")]
    pub(super) xx: f64,
    #[serde(deserialize_with = "finite")]
    pub(super) yy: f64,
    #[serde(deserialize_with = "finite")]
    pub(super) zz: f64,
    #[serde(default, deserialize_with = "finite")]
    pub(super) xy: f64,
    #[serde(default, deserialize_with = "finite")]
    pub(super) xz: f64,
    #[serde(default, deserialize_with = "finite")]
    pub(super) yz: f64,
}

impl InertiaTable {
    pub(super) fn matrix(&self) -> Matrix3<f64> {
        let Self { xx, yy, zz, xy, xz, yz } = *self;
        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }
}

impl TryFrom<InertiaTable> for Inertia {
    type Error = &'static str;

    fn try_from(table: InertiaTable) -> Result<Self, Self::Error> {
        let matrix = table.matrix();
        match Cholesky::new(matrix) {
            Some(_) => Ok(Self(matrix)),
            None => Err("the inertia is not positive definite"),
        }
    }
}

impl From<Matrix3<f64>> for InertiaTable {
    fn from(m: Matrix3<f64>) -> Self {
        Self {
            xx: m[(0, 0)],
            yy: m[(1, 1)],
            zz: m[(2, 2)],
            xy: m[(0, 1)],
            xz: m[(0, 2)],
            yz: m[(1, 2)],
        }
    }
}

impl From<Inertia> for InertiaTable {
    fn from(Inertia(matrix): Inertia) -> Self {
        matrix.into()
    }
}
