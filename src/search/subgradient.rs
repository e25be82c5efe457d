//! A cost with one of its subgradients.

use nalgebra::DVector;

use super::evaluation::Evaluation;
use super::failure::Failure;

/// What one evaluation says, and how the cost changes from there.
#[derive(Debug, Clone, PartialEq)]
pub struct Subgradient {
    /// Cost and violation.
    pub evaluation: Evaluation,
    /// One slope per variable: the cost's gradient where it has one, and at a kink one of Clarke's generalised gradients
    /// (1983, doi:10.1137/1.9781611971309), such as the gradient of one of the largest pieces.
    pub slopes: DVector<f64>,
}

impl Subgradient {
    /// Whether there are slopes by so many variables.
    pub(super) fn check(&self, variables: usize) -> Result<(), Failure> {
        let found = self.slopes.len();
        if found == variables {
            return Ok(());
        }
        Err(format!("found a subgradient of {found} components, expected {variables}").into())
    }
}
