//! The `[[optimiser]]` tables: sweeps over settings spelt out, labels made.
//!
//! What a table may have beside its optimiser is told from it while the file is still TOML, so that
//! the place of every value survives for its error.

use std::collections::HashMap;
use std::num::NonZeroU64;
use std::ops::Range;

use serde::{Deserialize, Serialize};
use toml::Spanned;
use toml::de::{DeArray, DeString, DeTable, DeValue};

use super::budget::BudgetTable;
use super::entrant::{Entrant, Origin, OutsideTable};
use super::external::ExternalTable;
use super::subject::Instance;
use crate::input::{Document, InputError, nearest, optional_count};
use crate::optimiser::Settings;

/// One optimiser of the field: an `[[optimiser]]` table, or one combination of its `sweep`.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct EntrantTable {
    /// Optimiser and settings.
    #[serde(default)]
    settings: Option<Spanned<Settings>>,
    /// An optimiser of the program that made the results instead.
    #[serde(default)]
    outside: Option<Spanned<OutsideTable>>,
    /// A program instead.
    #[serde(default)]
    external: Option<Spanned<ExternalTable>>,
    /// What to call it instead of its name and formulation.
    #[serde(default)]
    label: Option<Spanned<String>>,
    /// Number of seeds, instead of the experiment's.
    #[serde(default, deserialize_with = "optional_count::<1, 1_000_000, _, _>")]
    seeds: Option<NonZeroU64>,
    /// What each of its runs may spend, instead of the experiment's budget.
    #[serde(default)]
    budget: Option<Spanned<BudgetTable>>,
}

/// The keys that stand beside an optimiser.
const BESIDE: [&str; 3] = ["label", "seeds", "budget"];

/// The key of an optimiser of the program that made the results.
const OUTSIDE: &str = "outside";

/// The key of a program, which stands where others have their name.
const EXTERNAL: &str = "external";

/// Most optimisers of a field; each takes some kilobytes, and a report compares every two.
const MOST_OPTIMISERS: u64 = 10_000;

/// The key of a sweep, which is gone when the field is spelt out.
const SWEEP: &str = "sweep";

/// An entrant and where its table, label and budget stand.
#[derive(Debug, Clone)]
pub(super) struct Entry {
    pub(super) entrant: Entrant,
    pub(super) place: Range<usize>,
    pub(super) label_place: Option<Range<usize>>,
    pub(super) budget_place: Option<Range<usize>>,
}

impl From<Entrant> for Entry {
    fn from(entrant: Entrant) -> Self {
        Self { entrant, place: 0..0, label_place: None, budget_place: None }
    }
}

impl EntrantTable {
    /// The entrant that the table asks for.
    pub(super) fn entry(self, document: &Document) -> Result<Entry, InputError> {
        let Self { settings, outside, external, label, seeds, budget } = self;
        let (entrant, place) = match (settings, external, outside) {
            (Some(_), _, Some(outside)) | (_, Some(_), Some(outside)) => {
                let message = "found an optimiser beside `outside`, expected one of them";
                return Err(document.error_at(outside.span(), message, None));
            }
            (Some(settings), _, None) => {
                let place = settings.span();
                (Entrant::from(settings.into_inner()), place)
            }
            (None, Some(external), None) => {
                let place = external.span();
                (Entrant::external(external.into_inner(), document)?, place)
            }
            (None, None, Some(outside)) => {
                let place = outside.span();
                (outside.into_inner().entrant(document)?, place)
            }
            (None, None, None) => return Err(no_optimiser(0..0, document)),
        };
        let label_place = label.as_ref().map(Spanned::span);
        let budget_place = budget.as_ref().map(Spanned::span);
        let entrant = match label {
            Some(label) => entrant.labelled(label.get_ref()),
            None => entrant,
        };
        let budget = budget.map(|budget| budget.get_ref().evaluations);
        Ok(Entry {
            entrant: Entrant { seeds, budget, ..entrant },
            place,
            label_place,
            budget_place,
        })
    }
}

/// An entrant as one writes it.
#[derive(Serialize)]
pub(super) struct WrittenEntrant<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    label: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    seeds: Option<NonZeroU64>,
    #[serde(flatten)]
    settings: Option<&'a Settings>,
    #[serde(skip_serializing_if = "Option::is_none")]
    outside: Option<OutsideTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    external: Option<&'a ExternalTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    budget: Option<BudgetTable>,
}

impl<'a> WrittenEntrant<'a> {
    pub(super) fn of(entrant: &'a Entrant) -> Self {
        let (settings, external, outside) = match &entrant.origin {
            Origin::Catalogue(settings) => (Some(settings), None, None),
            Origin::External { table, .. } => (None, Some(&**table), None),
            Origin::Outside => (None, None, Some(OutsideTable::of(entrant))),
        };
        Self {
            label: entrant.is_labelled.then_some(&*entrant.label),
            seeds: entrant.seeds,
            settings,
            outside,
            external,
            budget: entrant.budget.map(|evaluations| BudgetTable { evaluations }),
        }
    }
}

/// Labels the field: the label given, or optimiser and, on subjects with several formulations, formulation; with the
/// settings that differ from the default and a budget of its own where the field has these more than
/// once.
pub(super) fn labelled(field: &[Entry], instances: &[Instance]) -> Vec<Entrant> {
    let formulated = instances.iter().find(|instance| !instance.subject.spaces().is_empty());
    let plain = |entrant: &Entrant| match formulated {
        Some(instance) if !entrant.is_labelled => {
            format!("{}/{}", entrant.label, entrant.space(instance))
        }
        _ => entrant.label.clone(),
    };
    let mut count = HashMap::new();
    for entry in field {
        *count.entry(plain(&entry.entrant)).or_insert(0) += 1;
    }
    let label = |entry: &Entry| {
        let entrant = entry.entrant.clone();
        let mut label = plain(&entrant);
        if count[&label] > 1 {
            let changed = entrant.changed_settings();
            let own = entrant.budget.map(|evaluations| format!("budget={evaluations}"));
            for part in changed.into_iter().chain(own) {
                label += " ";
                label += &part;
            }
        }
        Entrant { label, ..entrant }
    };
    field.iter().map(label).collect()
}

fn no_optimiser(place: Range<usize>, document: &Document) -> InputError {
    let message = "found no optimiser, expected one with its settings, such as `pso = {}`";
    document.error_at(place, message, None)
}

/// Makes of every `[[optimiser]]` table one for each combination of its `sweep`, with the optimiser in
/// a table of its own, as [`EntrantTable`] reads it.
pub(super) fn spell_out(
    file: &mut DeTable<'_>,
    spaces: &[&str],
    document: &Document,
) -> Result<(), InputError> {
    let field = file.get_mut("optimiser").map(Spanned::get_mut);
    let Some(DeValue::Array(field)) = field else {
        return Ok(());
    };
    let (mut spelt_out, mut count) = (DeArray::new(), 0_u64);
    for entry in field.iter() {
        match entry.get_ref() {
            DeValue::Table(table) => {
                // Each combination is a table of its own, so they are counted before they are made.
                let sweep = table.get(SWEEP).map_or(1, |sweep| combination_count(sweep.get_ref()));
                count = count.saturating_add(sweep);
                if count > MOST_OPTIMISERS {
                    let message =
                        format!("found {count} optimisers, expected {MOST_OPTIMISERS} at most");
                    return Err(document.error_at(entry.span(), message, None));
                }
                let (beside, choices) = combinations(table.clone(), entry.span(), document)?;
                for choice in choices {
                    check_formulations(&choice, spaces, document)?;
                    spelt_out.push(entrant_table(beside.clone(), choice, entry.span()));
                }
            }
            _ => spelt_out.push(entry.clone()),
        }
    }
    *field = spelt_out;
    Ok(())
}

/// How many combinations the lists of a sweep have, at any depth.
fn combination_count(sweep: &DeValue<'_>) -> u64 {
    match sweep {
        DeValue::Table(table) => {
            let inner = table.iter().map(|(_, value)| combination_count(value.get_ref()));
            inner.fold(1, u64::saturating_mul)
        }
        DeValue::Array(values) => values.len() as u64,
        _ => 1,
    }
}

fn entrant_table<'i>(
    mut beside: DeTable<'i>,
    mut choice: DeTable<'i>,
    span: Range<usize>,
) -> Spanned<DeValue<'i>> {
    if let Some((key, external)) = choice.remove_entry(EXTERNAL) {
        beside.insert(key, external);
    } else if !choice.is_empty() {
        let choice = Spanned::new(span.clone(), DeValue::Table(choice));
        beside.insert(Spanned::new(span.clone(), "settings".into()), choice);
    }
    Spanned::new(span, DeValue::Table(beside))
}

/// What stands beside the optimiser, and the optimiser with every combination of the sweep.
fn combinations<'i>(
    mut table: DeTable<'i>,
    span: Range<usize>,
    document: &Document,
) -> Result<(DeTable<'i>, Vec<DeTable<'i>>), InputError> {
    let sweep = table.remove(SWEEP);
    let (mut beside, mut choice) = (DeTable::new(), DeTable::new());
    for (key, value) in table {
        let is_beside = BESIDE.contains(&key.get_ref().as_ref()) || *key.get_ref() == *OUTSIDE;
        (if is_beside { &mut beside } else { &mut choice }).insert(key, value);
    }
    if choice.is_empty() {
        if beside.contains_key(OUTSIDE) {
            return match sweep {
                None => Ok((beside, vec![choice])),
                Some(sweep) => {
                    let message = "found a sweep beside `outside`, expected none";
                    Err(document.error_at(sweep.span(), message, None))
                }
            };
        }
        return Err(no_optimiser(span, document));
    }
    check_choice(&choice, document)?;
    let mut choices = vec![choice];
    if let (Some(sweep), Some((name, _))) = (&sweep, choices[0].iter().next()) {
        let mut axes = Vec::new();
        collect_axes(sweep, &mut vec![name.clone()], &mut axes, document)?;
        for axis in &axes {
            choices = axis.cross(&choices, document)?;
        }
    }
    Ok((beside, choices))
}

/// Whether every formulation asked for, at any depth, is one that the subjects have.
fn check_formulations(
    table: &DeTable<'_>,
    spaces: &[&str],
    document: &Document,
) -> Result<(), InputError> {
    for (key, value) in table {
        match value.get_ref() {
            DeValue::Table(inner) => check_formulations(inner, spaces, document)?,
            DeValue::String(found)
                if *key.get_ref() == *"formulation"
                    && !spaces.is_empty()
                    && !spaces.contains(&found.as_ref()) =>
            {
                let known = spaces.iter().map(|space| format!("`{space}`"));
                let known = known.collect::<Vec<_>>().join(", ");
                let message = format!("unknown formulation `{found}`, expected one of {known}");
                let help = nearest(found, spaces.iter().copied());
                let help = help.map(|near| format!("did you mean `{near}`?"));
                return Err(document.error_at(value.span(), message, help));
            }
            _ => {}
        }
    }
    Ok(())
}

/// Whether a table has but one optimiser.
fn check_choice(choice: &DeTable<'_>, document: &Document) -> Result<(), InputError> {
    let known: Vec<&str> = Settings::all().iter().map(Settings::name).chain([EXTERNAL]).collect();
    let is_known = |key: &Spanned<DeString<'_>>| known.contains(&key.get_ref().as_ref());
    let unknown = choice.keys().find(|key| !is_known(key));
    let Some(key) = unknown.or_else(|| choice.keys().nth(1)).filter(|_| choice.len() > 1) else {
        return Ok(());
    };
    let name = key.get_ref();
    let (message, help) = if is_known(key) {
        (format!("found a second optimiser, `{name}`, in the same `[[optimiser]]`"), None)
    } else {
        let expected = BESIDE.iter().chain([&SWEEP]);
        let message = format!(
            "unknown key `{name}` beside an optimiser, expected one of {}",
            expected.clone().map(|key| format!("`{key}`")).collect::<Vec<_>>().join(", ")
        );
        let near = nearest(name, expected.copied());
        (message, near.map(|near| format!("did you mean `{near}`?")))
    };
    Err(document.error_at(key.span(), message, help))
}

/// A key as TOML has it.
type Key<'i> = Spanned<DeString<'i>>;

/// A setting and the values it takes.
struct Axis<'i> {
    /// From the optimiser's name inward.
    path: Vec<Key<'i>>,
    values: DeArray<'i>,
}

/// Collects the lists of a sweep, at any depth.
fn collect_axes<'i>(
    sweep: &Spanned<DeValue<'i>>,
    path: &mut Vec<Key<'i>>,
    axes: &mut Vec<Axis<'i>>,
    document: &Document,
) -> Result<(), InputError> {
    let message = match sweep.get_ref() {
        DeValue::Table(table) => {
            for (key, value) in table {
                path.push(key.clone());
                collect_axes(value, path, axes, document)?;
                path.pop();
            }
            return Ok(());
        }
        // What stands right below the optimiser's name are settings.
        _ if path.len() == 1 => "found no table, expected one of lists by setting",
        DeValue::Array(values) if values.is_empty() => {
            "found an empty list, expected at least one value"
        }
        DeValue::Array(values) => {
            axes.push(Axis { path: path.clone(), values: values.clone() });
            return Ok(());
        }
        _ => "found a single value, expected a list of the values to try",
    };
    Err(document.error_at(sweep.span(), message, None))
}

impl<'i> Axis<'i> {
    /// Every choice with every value.
    fn cross(
        &self,
        choices: &[DeTable<'i>],
        document: &Document,
    ) -> Result<Vec<DeTable<'i>>, InputError> {
        let mut crossed = Vec::new();
        for choice in choices {
            for value in &self.values {
                let mut choice = choice.clone();
                if let Some(key) = set(&mut choice, &self.path, value) {
                    let message = format!(
                        "`{}` has a value beside its sweep, expected one of them",
                        key.get_ref()
                    );
                    return Err(document.error_at(key.span(), message, None));
                }
                crossed.push(choice);
            }
        }
        Ok(crossed)
    }
}

/// Puts a value where a path leads; gives the key where another value stands in the way.
fn set<'a, 'i>(
    table: &mut DeTable<'i>,
    path: &'a [Key<'i>],
    value: &Spanned<DeValue<'i>>,
) -> Option<&'a Key<'i>> {
    let (key, rest) = path.split_first()?;
    let name: &str = key.get_ref().as_ref();
    if rest.is_empty() {
        let free = !table.contains_key(name);
        return if free {
            table.insert(key.clone(), value.clone());
            None
        } else {
            Some(key)
        };
    }
    if !table.contains_key(name) {
        table.insert(key.clone(), Spanned::new(key.span(), DeValue::Table(DeTable::new())));
    }
    match table.get_mut(name).map(Spanned::get_mut) {
        Some(DeValue::Table(inner)) => set(inner, rest, value),
        _ => Some(key),
    }
}
