//! Test functions as subjects of experiments: the `[functions]` table.

use std::num::{NonZeroU64, NonZeroUsize};
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::analytic::{Analytic, TestFunction};
use crate::experiment::{Identity, Instance, Kind, Number, Numbers, Source, Subject};
use crate::input::{Document, InputError, count, count_from};
use crate::search::{Failure, Problem};

/// What a `[functions]` table leaves out is taken from here.
const DEFAULTS: &str = "[functions]\ndimension = [10]\ninstances = 1\n";

/// Targets where the file states none; the least value is zero.
const TARGETS: [f64; 3] = [1e-2, 1e-5, 1e-8];

/// The `[functions]` table: the instances are the cross product of its lists.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct FunctionTable {
    /// Which functions.
    name: Spanned<Vec<TestFunction>>,
    /// Numbers of variables.
    dimension: Spanned<Vec<Dimension>>,
    /// How many shifts and rotations of each function; they are instances 1, 2, …
    #[serde(deserialize_with = "count::<10_000, _, _>")]
    instances: NonZeroU64,
}

/// A number of variables, checked where it stands in a list.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Dimension(#[serde(deserialize_with = "count_from::<2, 1000, _, _>")] NonZeroUsize);

impl FunctionTable {
    /// The instances; those that differ in shift and rotation alone are one group.
    fn spelt_out(&self, document: &Document) -> Result<Vec<Instance>, InputError> {
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
    let group = format!("{} dimension={dimension}", function.name());
    let label = format!("{group} instance={number}");
    let problem = Arc::new(Analytic::new(function, dimension, number));
    let mut instance = Instance::new(label, Arc::new(Function { problem, dimension, number }));
    instance.title.clone_from(&group);
    function.name().clone_into(&mut instance.series);
    instance.group = group;
    instance.with_targets(TARGETS)
}

/// The name of the kind.
const KIND: &str = "function";

/// The test functions.
#[derive(Debug, Clone, Copy, Default)]
pub struct Functions;

/// A file's `functions` key.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct FunctionsFile {
    functions: FunctionTable,
}

impl Kind for Functions {
    fn name(&self) -> &'static str {
        KIND
    }

    fn keys(&self) -> &'static [&'static str] {
        &["functions"]
    }

    fn read(&self, document: &Document) -> Result<Arc<dyn Source>, InputError> {
        let file: FunctionsFile = document.parse_keys(self.keys(), &[DEFAULTS])?;
        Ok(Arc::new(file))
    }
}

impl Source for FunctionsFile {
    fn instances(&self, document: &Document) -> Result<Vec<Instance>, InputError> {
        self.functions.spelt_out(document)
    }

    fn count(&self) -> u64 {
        let FunctionTable { name, dimension, instances } = &self.functions;
        let groups = (name.get_ref().len() as u64).saturating_mul(dimension.get_ref().len() as u64);
        groups.saturating_mul(instances.get())
    }

    fn written(&self) -> Result<String, String> {
        toml::to_string(self).map_err(|error| error.to_string())
    }
}

/// One instance of a test function.
struct Function {
    problem: Arc<Analytic>,
    dimension: usize,
    number: u64,
}

impl Subject for Function {
    fn kind(&self) -> &'static str {
        KIND
    }

    fn name(&self) -> &str {
        self.problem.function().name()
    }

    fn identity(&self) -> Identity {
        Identity::new().with("dimension", self.dimension).with("instance", self.number)
    }

    fn problem(&self, _: &str) -> Result<Arc<dyn Problem>, Failure> {
        Ok(self.problem.clone())
    }

    fn numbers(&self) -> Option<Numbers> {
        let instance = u32::try_from(self.number).ok()?;
        let function = Number::Known(self.problem.function().number());
        Some(Numbers { function, instance: Number::Known(instance) })
    }

    fn dependence(&self, instances: &[&Instance]) -> Option<&'static str> {
        let mut names: Vec<&str> = instances.iter().map(|i| i.subject.name()).collect();
        names.sort_unstable();
        names.windows(2).any(|pair| pair[0] == pair[1]).then_some(
            "Shifts and dimensions of one function are not independent functions, so p-values are smaller than they \
             should be.",
        )
    }
}
