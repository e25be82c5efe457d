//! The `[functions]` table: test functions instead of the task.

use std::num::{NonZeroU64, NonZeroUsize};
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::analytic::{Analytic, TestFunction};
use crate::experiment::Instance;
use crate::input::{Document, InputError, count, count_from};

/// What a `[functions]` table leaves out is taken from here.
pub(crate) const DEFAULTS: &str = "[functions]\ndimension = [10]\ninstances = 1\n";

/// Targets where the file states none; the least value is zero.
const TARGETS: [f64; 3] = [1e-2, 1e-5, 1e-8];

/// The `[functions]` table: the instances are the cross product of its lists.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct FunctionTable {
    /// Which functions.
    pub name: Spanned<Vec<TestFunction>>,
    /// Numbers of variables.
    pub dimension: Spanned<Vec<Dimension>>,
    /// How many shifts and rotations of each function; they are instances 1, 2, …
    #[serde(deserialize_with = "count::<10_000, _, _>")]
    pub instances: NonZeroU64,
}

/// A number of variables, checked where it stands in a list.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Dimension(#[serde(deserialize_with = "count_from::<2, 1000, _, _>")] NonZeroUsize);

impl FunctionTable {
    /// The instances; those that differ in shift and rotation alone are one group.
    pub(crate) fn instances(&self, document: &Document) -> Result<Vec<Instance>, InputError> {
        let (names, dimensions) = (self.name.get_ref(), self.dimension.get_ref());
        for (span, empty) in
            [(self.name.span(), names.is_empty()), (self.dimension.span(), dimensions.is_empty())]
        {
            if empty {
                let message = "found an empty list, expected at least one entry";
                return Err(document.error_at(span, message, None));
            }
        }
        let mut instances = Vec::new();
        for function in names {
            for dimension in dimensions {
                instances.extend(
                    (1..=self.instances.get()).map(|i| instance(*function, dimension.0.get(), i)),
                );
            }
        }
        Ok(instances)
    }
}

fn instance(function: TestFunction, dimension: usize, number: u64) -> Instance {
    let name = function.name();
    let group = format!("{name} dimension={dimension}");
    let label = format!("{group} instance={number}");
    let problem = Arc::new(Analytic::new(function, dimension, number));
    let instance = Instance::other(&label, name, problem);
    Instance { group, targets: TARGETS.into(), ..instance }
}
