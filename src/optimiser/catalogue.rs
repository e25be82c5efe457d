//! Every optimiser by name, with its settings.

use std::fmt;

use schemars::{JsonSchema, schema_for};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::cma_es::CmaEs;
use super::de::De;
use super::hybrid;
use super::l_bfgs_b::LBfgsB;
use super::l_shade::LShade;
use super::method::Optimiser;
use super::nelder_mead::NelderMead;
use super::pso::Pso;
use super::random::RandomSearch;
use super::scp::Scp;
use super::slsqp::Slsqp;

/// From one line per optimiser: the choice of one with its settings, and what has to be known of each.
macro_rules! catalogue {
    ($($(#[$about:meta])* $name:literal: $settings:ident,)*) => {
        /// One optimiser and its settings, as an `[[optimiser]]` table says it.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        pub enum Settings {
            $($(#[$about])* #[serde(rename = $name)] $settings($settings),)*
        }

        impl Settings {
            /// Every optimiser with its default settings.
            pub fn all() -> Vec<Self> {
                vec![$(Self::$settings($settings::default())),*]
            }

            /// The optimiser's name.
            pub fn name(&self) -> &'static str {
                match self { $(Self::$settings(_) => $name,)* }
            }

            /// The optimiser itself.
            pub fn optimiser(&self) -> &(dyn Optimiser + 'static) {
                match self { $(Self::$settings(settings) => settings,)* }
            }

            /// The settings' JSON schema.
            fn schema(&self) -> schemars::Schema {
                match self { $(Self::$settings(_) => schema_for!($settings),)* }
            }
        }
    };
}

catalogue! {
    /// Evolution strategy with covariance matrix adaptation, restarted with a growing population.
    "cma-es": CmaEs,
    /// Differential evolution.
    "de": De,
    /// Another optimiser, then sequential convex programming from the best it found.
    "hybrid": Hybrid,
    /// Limited-memory BFGS within the box, from random starts.
    "l-bfgs-b": LBfgsB,
    /// Differential evolution that adapts its parameters and shrinks its population.
    "l-shade": LShade,
    /// The simplex method, from random starts.
    "nelder-mead": NelderMead,
    /// The paper's particle swarm.
    "pso": Pso,
    /// Random search.
    "random": RandomSearch,
    /// Sequential convex programming from random starts.
    "scp": Scp,
    /// Sequential least-squares quadratic programming from random starts.
    "slsqp": Slsqp,
}

/// A search by an optimiser of the catalogue that needs no derivatives, then one that uses them.
pub type Hybrid = hybrid::Hybrid<Settings>;

impl From<LShade> for Settings {
    fn from(settings: LShade) -> Self {
        Self::LShade(settings)
    }
}

impl AsRef<dyn Optimiser> for Settings {
    fn as_ref(&self) -> &(dyn Optimiser + 'static) {
        self.optimiser()
    }
}

/// The optimiser's name.
impl fmt::Display for Settings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A setting as `list` shows it.
#[derive(Debug, Clone, Serialize)]
pub struct Setting {
    /// Key in the file.
    pub name: String,
    /// Value when left out.
    pub default: String,
    /// What it means.
    pub meaning: String,
}

impl Settings {
    /// The optimiser of that name with its default settings.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::all().into_iter().find(|settings| settings.name() == name)
    }

    /// What to call it in tables: its name or, of a hybrid, those of its parts.
    pub fn title(&self) -> String {
        match self {
            Self::Hybrid(hybrid) => format!("{}+scp", hybrid.search.title()),
            plain => plain.name().to_owned(),
        }
    }

    /// The variables in which it searches, where it names them.
    pub fn formulation(&self) -> Option<&str> {
        self.optimiser().formulation()
    }

    /// The settings that differ from the default, as `name=value`; the formulation is left out.
    pub fn changed(&self) -> Vec<String> {
        let default = match self {
            // Beside the same search with its default settings.
            Self::Hybrid(hybrid) => Self::by_name(hybrid.search.name()).map(|search| {
                Self::Hybrid(Hybrid { search: Box::new(search), ..Hybrid::default() })
            }),
            plain => Self::by_name(plain.name()),
        };
        let values = |settings: &Self| serde_json::to_value(settings).unwrap_or_default();
        let mut changed = Vec::new();
        if let Some(default) = default {
            differences("", &values(self), &values(&default), &mut changed);
        }
        changed
    }

    /// Every setting with its default and its meaning, from the documentation of its field.
    pub fn describe(&self) -> Vec<Setting> {
        let schema = self.schema();
        let properties = schema.get("properties").and_then(|p| p.as_object());
        properties
            .into_iter()
            .flatten()
            .map(|(name, property)| Setting {
                name: name.clone(),
                default: property.get("default").map_or("none".to_owned(), toml_value),
                meaning: property
                    .get("description")
                    .and_then(|d| d.as_str())
                    .unwrap_or_default()
                    .replace('\n', " "),
            })
            .collect()
    }
}

/// Adds every value that another table does not have as `name=value`, with the innermost name only.
fn differences(name: &str, own: &Value, other: &Value, found: &mut Vec<String>) {
    match (own, other) {
        (Value::Object(own), _) => {
            for (name, value) in own.iter().filter(|(name, _)| *name != "formulation") {
                differences(name, value, other.get(name).unwrap_or(&Value::Null), found);
            }
        }
        _ if own != other => found.push(format!("{name}={}", toml_value(own))),
        _ => {}
    }
}

/// A JSON value as one writes it in TOML.
fn toml_value(value: &Value) -> String {
    match value {
        Value::Null => "none".to_owned(),
        Value::Object(map) => {
            let pairs: Vec<_> =
                map.iter().map(|(k, v)| format!("{k} = {}", toml_value(v))).collect();
            format!("{{ {} }}", pairs.join(", "))
        }
        other => other.to_string(),
    }
}
