//! How each optimiser looks: the same in every chart, and its kind the same in every experiment.

use std::collections::HashMap;

use super::sheet::printable;
use super::style::{COLOURS, DASHES, INK, Marker, PAPER, Stroke, mix};
use crate::experiment::Entrant;
use crate::optimiser::Settings;
use crate::reorientation::Formulation;

/// The kinds of optimisers in the order of their colours and markers.
const KINDS: [&str; 8] =
    ["scp", "hybrid", "cma-es", "l-shade", "de", "pso", "nelder-mead", "random"];

/// Most optimisers in one panel.
const MOST_IN_A_PANEL: usize = 8;

/// How the optimisers of a field look, by label: colour tells the kind, dashes the formulation, the
/// marker the kind or, of a hybrid, what searches first. Of several that share all this, every other one
/// has hollow markers, and later ones lighter and darker colours.
#[derive(Debug, Clone)]
pub struct Looks {
    /// Label, kind and stroke in the field's order.
    field: Vec<(String, &'static str, Stroke)>,
}

fn place_of(kind: &str) -> usize {
    KINDS.iter().position(|name| *name == kind).unwrap_or(KINDS.len() - 1)
}

fn stroke(settings: &Settings, twins: usize) -> Stroke {
    let marked = match settings {
        Settings::Hybrid(hybrid) => hybrid.search.name(),
        plain => plain.name(),
    };
    let dashes = match settings.formulation() {
        Formulation::TimeFree => DASHES[0],
        Formulation::Scaled => DASHES[1],
        Formulation::Raw => DASHES[2],
    };
    let colour = COLOURS[place_of(settings.name())];
    let colour = match twins / 2 % 3 {
        0 => colour,
        1 => mix(colour, PAPER, 0.4),
        _ => mix(colour, INK, 0.5),
    };
    let plain = Stroke { dashes, hollow: twins % 2 == 1, ..Stroke::plain(colour, 0.32) };
    // Six of a kind have its own marker, the next six another.
    plain.with_marker(Marker::ALL[(place_of(marked) + twins / 6) % Marker::ALL.len()])
}

impl Looks {
    /// The looks of a field.
    pub fn of(field: &[Entrant]) -> Self {
        let mut seen = HashMap::new();
        let look = |entrant: &Entrant| {
            let settings = &entrant.settings;
            let search = match settings {
                Settings::Hybrid(hybrid) => hybrid.search.name(),
                _ => "",
            };
            let same = (settings.name(), search, settings.formulation().name());
            let twins = seen.entry(same).or_insert(0);
            let stroke = stroke(settings, *twins);
            *twins += 1;
            (printable(&entrant.label), settings.name(), stroke)
        };
        Self { field: field.iter().map(look).collect() }
    }

    /// Labels in the field's order.
    pub(super) fn labels(&self) -> impl Iterator<Item = &str> {
        self.field.iter().map(|(label, _, _)| label.as_str())
    }

    fn find(&self, label: &str) -> Option<(usize, &(String, &'static str, Stroke))> {
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
    pub(super) fn kind(&self, label: &str) -> &'static str {
        self.find(label).map_or("", |(_, (_, kind, _))| kind)
    }

    /// The kinds of the field, each once.
    pub(super) fn kinds(&self) -> Vec<&'static str> {
        let mut kinds: Vec<&'static str> = Vec::new();
        for (_, kind, _) in &self.field {
            if !kinds.contains(kind) {
                kinds.push(kind);
            }
        }
        kinds
    }
}
