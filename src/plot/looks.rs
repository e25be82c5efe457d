//! How each optimiser looks: the same in every chart, and its kind the same in every experiment.

use std::collections::HashMap;

use plotters::style::RGBColor;

use super::names::names;
use crate::experiment::{Entrant, Plan};
use crate::figure::style::{COLOURS, DASHES, INK, Marker, OUTSIDE_COLOURS, PAPER, Stroke, mix};
use crate::figure::text::printable;

/// The kinds of optimisers in the order of their colours and markers.
const KINDS: [&str; COLOURS.len()] = [
    "scp",
    "hybrid",
    "cma-es",
    "l-shade",
    "de",
    "pso",
    "nelder-mead",
    "random",
    "l-bfgs-b",
    "slsqp",
];

/// Most optimisers in one panel.
const MOST_IN_A_PANEL: usize = 8;

/// How the optimisers of a field look, by label: colour tells the kind, dashes the formulation, the
/// marker the kind or, of a hybrid, what searches first. Kinds of other programs have colours that none
/// of this program's has, and markers that are free. Of several that share all this, every other one has hollow markers, and later
/// ones lighter and darker colours; where the whole field is of one kind, colours and markers of their own.
#[derive(Debug, Clone)]
pub(super) struct Looks {
    /// Label, kind and stroke in the field's order.
    field: Vec<(String, String, Stroke)>,
    /// What charts call them, in the field's order.
    names: Vec<String>,
    /// What captions have to say of the names.
    note: String,
    /// Groups of instances as charts write them.
    titles: HashMap<String, String>,
}

/// The kinds of a field that are not of this program, in its order.
fn outsiders(field: &[Entrant]) -> Vec<&str> {
    let mut kinds: Vec<&str> = Vec::new();
    for kind in field.iter().map(|entrant| entrant.kind.as_str()) {
        if !KINDS.contains(&kind) && !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    kinds
}

/// Places among the markers that no kind of a field has; all, if none is free.
fn free_markers(field: &[Entrant]) -> Vec<usize> {
    let is_taken = |kind: &&str| {
        let own = |entrant: &Entrant| entrant.search.as_ref().unwrap_or(&entrant.kind) == kind;
        field.iter().any(own)
    };
    let free = KINDS.iter().enumerate().filter(|(_, kind)| !is_taken(kind));
    let free: Vec<usize> = free.map(|(place, _)| place).collect();
    if free.is_empty() { (0..KINDS.len()).collect() } else { free }
}

/// A kind's place among the markers, and its colour.
fn kind_of(kind: &str, outsiders: &[&str], free: &[usize]) -> (usize, RGBColor) {
    if let Some(place) = KINDS.iter().position(|name| *name == kind) {
        return (place, COLOURS[place]);
    }
    let place = outsiders.iter().position(|name| *name == kind).unwrap_or_default();
    (free[place % free.len()], OUTSIDE_COLOURS[place % OUTSIDE_COLOURS.len()])
}

impl Looks {
    /// The looks of a field.
    #[cfg(test)]
    pub(super) fn of(field: &[Entrant]) -> Self {
        Self::new(field, &[], &[])
    }

    /// The looks of a plan's field, and the titles of its groups. `colours` are those of the optimisers in their order; they repeat
    /// where they are too few.
    pub(super) fn of_plan(plan: &Plan, colours: &[[u8; 3]]) -> Self {
        let spaces = plan.instances.iter().map(|instance| instance.subject.spaces());
        let spaces = spaces.max_by_key(Vec::len).unwrap_or_default();
        let titles = plan.instances.iter().map(|i| (printable(&i.group), i.title.clone()));
        Self { titles: titles.collect(), ..Self::new(&plan.optimisers, &spaces, colours) }
    }

    pub(super) fn new(field: &[Entrant], spaces: &[String], colours: &[[u8; 3]]) -> Self {
        let (outsiders, free) = (outsiders(field), free_markers(field));
        let is_alone = field.windows(2).all(|pair| pair[0].kind == pair[1].kind);
        let mut seen = HashMap::new();
        let asked = |i: usize| {
            let &[red, green, blue] = colours.get(i % colours.len().max(1))?;
            Some(RGBColor(red, green, blue))
        };
        let look = |(i, entrant): (usize, &Entrant)| {
            let formulation = entrant.formulation.as_ref();
            let space = formulation.and_then(|own| spaces.iter().position(|space| space == own));
            let space = space.unwrap_or(0);
            let alike = (entrant.kind.clone(), entrant.search.clone(), space);
            let twins = seen.entry(alike).or_insert(0);
            let (kind, colour) = kind_of(&entrant.kind, &outsiders, &free);
            let colour = asked(i).unwrap_or_else(|| match *twins / 2 % 3 {
                _ if is_alone => COLOURS[(kind + *twins) % COLOURS.len()],
                0 => colour,
                1 => mix(colour, PAPER, 0.4),
                _ => mix(colour, INK, 0.5),
            });
            let dashes = DASHES[space % DASHES.len()];
            let plain = Stroke { dashes, hollow: *twins % 2 == 1, ..Stroke::plain(colour, 0.32) };
            let (place, _) =
                kind_of(entrant.search.as_ref().unwrap_or(&entrant.kind), &outsiders, &free);
            // Six of a kind have its own marker, the next six another.
            let further = if is_alone { *twins } else { *twins / 6 };
            let stroke = plain.with_marker(Marker::ALL[(place + further) % Marker::ALL.len()]);
            *twins += 1;
            (printable(&entrant.label), printable(&entrant.kind), stroke)
        };
        let field: Vec<(String, String, Stroke)> = field.iter().enumerate().map(look).collect();
        let labels: Vec<&str> = field.iter().map(|(label, _, _)| label.as_str()).collect();
        let names = names(&labels);
        Self { field, names: names.names, note: names.note, titles: HashMap::new() }
    }

    /// A group of instances as charts write it; other texts as they are.
    pub(super) fn title(&self, group: &str) -> String {
        self.titles.get(group).map_or_else(|| group.to_owned(), Clone::clone)
    }

    /// What charts call an optimiser: its label without the settings that all of its kind share.
    pub(super) fn name<'a>(&'a self, label: &'a str) -> &'a str {
        self.find(label).map_or(label, |(i, _)| &self.names[i])
    }

    /// What captions have to say of the names, with a space before; mostly nothing.
    pub(super) fn note(&self) -> &str {
        &self.note
    }

    /// Labels in the field's order.
    pub(super) fn labels(&self) -> impl Iterator<Item = &str> {
        self.field.iter().map(|(label, _, _)| label.as_str())
    }

    fn find(&self, label: &str) -> Option<(usize, &(String, String, Stroke))> {
        self.field.iter().enumerate().find(|(_, (name, _, _))| name == label)
    }

    /// How an optimiser looks.
    pub(super) fn stroke(&self, label: &str) -> Stroke {
        self.find(label).map_or(Stroke::plain(INK, 0.32), |(_, (_, _, stroke))| *stroke)
    }

    /// A share of one, another for every optimiser, for marks that would lie on each other.
    pub(super) fn stagger(&self, label: &str) -> f64 {
        self.find(label).map_or(0.0, |(i, _)| (i as f64 * 0.382).fract())
    }

    /// Whether the field is too large for one panel.
    pub(super) fn is_crowd(&self) -> bool {
        self.field.len() > MOST_IN_A_PANEL
    }

    /// The optimiser's kind.
    pub(super) fn kind(&self, label: &str) -> &str {
        self.find(label).map_or("", |(_, (_, kind, _))| kind)
    }

    /// The kinds of the field, each once.
    pub(super) fn kinds(&self) -> Vec<&str> {
        let mut kinds: Vec<&str> = Vec::new();
        for (_, kind, _) in &self.field {
            if !kinds.contains(&kind.as_str()) {
                kinds.push(kind);
            }
        }
        kinds
    }
}
