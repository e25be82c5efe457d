//! What a process is told.

use serde::{Serialize, Serializer};
use serde_json::Value;

use crate::search::{Bounds, Evaluation, Linearisation, Shape, Subgradient};

/// The version of the protocol.
pub(super) const VERSION: u32 = 1;

/// The first line that an optimiser is told.
#[derive(Debug, Serialize)]
pub(super) struct Opening<'a> {
    driftless: u32,
    role: &'static str,
    problem: ProblemTold,
    seed: u64,
    budget: u64,
    settings: &'a Value,
}

#[derive(Debug, Serialize)]
struct ProblemTold {
    dimension: usize,
    lower: Vec<f64>,
    upper: Vec<f64>,
    has: Vec<&'static str>,
}

impl<'a> Opening<'a> {
    /// For a search in a box; `has` names what can be asked beside costs.
    pub(super) fn new(
        bounds: &Bounds,
        has: Vec<&'static str>,
        (seed, budget): (u64, u64),
        settings: &'a Value,
    ) -> Self {
        let side = |k: usize| bounds.iter().map(|pair| pair[k]).collect();
        Self {
            driftless: VERSION,
            role: "optimiser",
            problem: ProblemTold { dimension: bounds.len(), lower: side(0), upper: side(1), has },
            seed,
            budget,
            settings,
        }
    }
}

/// The answer to a request.
#[derive(Debug, Serialize)]
pub(super) struct Answer<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    id: Option<&'a Value>,
    cost: Told,
    violation: Told,
    /// Evaluations left.
    left: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    subgradient: Option<Vec<Number>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    terms: Option<Vec<TermTold>>,
}

impl<'a> Answer<'a> {
    /// What evaluations say: one for one point, a list for a list.
    pub(super) fn costs(
        id: Option<&'a Value>,
        found: &[Evaluation],
        is_single: bool,
        left: u64,
    ) -> Self {
        let told = |value: fn(&Evaluation) -> f64| match found {
            [found] if is_single => Told::One(Number(value(found))),
            found => Told::Many(found.iter().map(|found| Number(value(found))).collect()),
        };
        Self {
            id,
            cost: told(|found| found.cost),
            violation: told(|found| found.violation),
            left,
            subgradient: None,
            terms: None,
        }
    }

    /// The same with a subgradient.
    pub(super) fn slopes(id: Option<&'a Value>, found: &Subgradient, left: u64) -> Self {
        let slopes = found.slopes.iter().copied().map(Number).collect();
        Self { subgradient: Some(slopes), ..Self::costs(id, &[found.evaluation], true, left) }
    }

    /// The same with the terms of the cost.
    pub(super) fn terms(id: Option<&'a Value>, found: &Linearisation, left: u64) -> Self {
        let terms = found.terms.iter().map(|term| TermTold {
            weight: term.weight,
            shape: match term.shape {
                Shape::Norm => "norm",
                Shape::Max => "max",
                Shape::Hinge => "hinge",
            },
            pieces: term
                .pieces
                .iter()
                .map(|piece| PieceTold {
                    track: piece.id.track,
                    place: piece.id.place,
                    value: Number(piece.value),
                    gradient: piece.gradient.iter().copied().map(Number).collect(),
                })
                .collect(),
        });
        let terms = Some(terms.collect());
        Self { terms, ..Self::costs(id, &[found.evaluation()], true, left) }
    }
}

#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Told {
    One(Number),
    Many(Vec<Number>),
}

#[derive(Debug, Serialize)]
struct TermTold {
    weight: f64,
    shape: &'static str,
    pieces: Vec<PieceTold>,
}

#[derive(Debug, Serialize)]
struct PieceTold {
    track: u64,
    place: f64,
    value: Number,
    gradient: Vec<Number>,
}

/// A number that JSON may not have.
#[derive(Debug)]
struct Number(f64);

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            value if value.is_finite() => serializer.serialize_f64(value),
            value if value.is_nan() => serializer.serialize_str("nan"),
            value if value > 0.0 => serializer.serialize_str("inf"),
            _ => serializer.serialize_str("-inf"),
        }
    }
}

/// A line of the protocol.
pub(super) fn line(message: &impl Serialize) -> String {
    let mut text = serde_json::to_string(message).unwrap_or_default();
    text.push('\n');
    text
}
