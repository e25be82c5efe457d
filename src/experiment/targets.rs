//! Costs that runs are asked to reach.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::subject::Instance;
use crate::input::{Document, Finite, InputError, nearest};

/// Targets as a file has them: the same for all instances, or by the instance's label.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum TargetTable {
    /// The same for all.
    All(Vec<Finite>),
    /// By label; an instance that is left out keeps what follows from its best known cost.
    Each(BTreeMap<String, Vec<Finite>>),
}

impl TargetTable {
    /// Those of the instances.
    pub(super) fn of(instances: &[Instance]) -> Self {
        let list = |instance: &Instance| instance.targets.iter().copied().map(Finite).collect();
        match instances {
            [first, others @ ..] if others.iter().any(|i| i.targets != first.targets) => {
                Self::Each(instances.iter().map(|i| (i.label.clone(), list(i))).collect())
            }
            _ => Self::All(instances.first().map_or_else(Vec::new, list)),
        }
    }

    /// Gives the instances what the file states for them.
    pub(super) fn give(
        targets: &Spanned<Self>,
        instances: &mut [Instance],
        document: &Document,
    ) -> Result<(), InputError> {
        if let Self::Each(each) = targets.get_ref() {
            let labels = || instances.iter().map(|instance| instance.label.as_str());
            if let Some(unknown) = each.keys().find(|key| !labels().any(|l| l == key.as_str())) {
                let message = format!("targets for `{unknown}`, which is no instance");
                let help = nearest(unknown, labels()).map(|l| format!("did you mean `{l}`?"));
                return Err(document.error_at(targets.span(), message, help));
            }
        }
        for instance in instances {
            let stated = match targets.get_ref() {
                Self::All(list) => Some(list),
                Self::Each(each) => each.get(&instance.label),
            };
            if let Some(stated) = stated {
                instance.targets = stated.iter().map(|target| target.0).collect();
            }
        }
        Ok(())
    }
}

impl<'de> Deserialize<'de> for TargetTable {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ListOrTable;
        impl<'de> Visitor<'de> for ListOrTable {
            type Value = TargetTable;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list of numbers, or a table of such lists by instance")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<TargetTable, A::Error> {
                let mut targets = Vec::new();
                while let Some(target) = list.next_element()? {
                    targets.push(target);
                }
                Ok(TargetTable::All(targets))
            }

            fn visit_map<A: MapAccess<'de>>(self, mut table: A) -> Result<TargetTable, A::Error> {
                let mut targets = BTreeMap::new();
                while let Some((label, list)) = table.next_entry()? {
                    targets.insert(label, list);
                }
                Ok(TargetTable::Each(targets))
            }
        }
        deserializer.deserialize_any(ListOrTable)
    }
}
