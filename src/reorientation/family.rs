//! Families of motions as files name them.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::input::{Document, InputError};

/// The name of a family.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum FamilyName {
    /// The paper's.
    SinePolynomial,
    /// Splines over equal pieces.
    Spline,
}

impl FamilyName {
    /// The name used in files and tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::SinePolynomial => "sine-polynomial",
            Self::Spline => "spline",
        }
    }

    /// The error for a key that is this family's alone, where the family is another.
    pub(super) fn alone(self, key: &str, span: Range<usize>, document: &Document) -> InputError {
        let message = format!("found `{key}`, which is for `family = \"{}\"` alone", self.name());
        document.error_at(span, message, None)
    }
}

/// A family between any two configurations: its name, and how many free coefficients it has for each joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(tag = "family", rename_all = "kebab-case")]
pub enum FamilySpec {
    /// The paper's.
    SinePolynomial {
        /// Free coefficients per joint.
        terms: usize,
    },
    /// Splines.
    Spline {
        /// Equal pieces.
        pieces: usize,
        /// 3, 4 or 5.
        degree: usize,
    },
}

impl FamilySpec {
    /// From what a file says; none where something is missing that the family needs.
    pub fn of(
        name: FamilyName,
        terms: Option<usize>,
        pieces: Option<usize>,
        degree: Option<usize>,
    ) -> Option<Self> {
        Some(match name {
            FamilyName::SinePolynomial => Self::SinePolynomial { terms: terms? },
            FamilyName::Spline => Self::Spline { pieces: pieces?, degree: degree? },
        })
    }

    /// The family's name.
    pub fn name(self) -> FamilyName {
        match self {
            Self::SinePolynomial { .. } => FamilyName::SinePolynomial,
            Self::Spline { .. } => FamilyName::Spline,
        }
    }

    /// Free coefficients per joint of a sine polynomial.
    pub fn terms(self) -> Option<usize> {
        match self {
            Self::SinePolynomial { terms } => Some(terms),
            Self::Spline { .. } => None,
        }
    }

    /// Pieces of a spline.
    pub fn pieces(self) -> Option<usize> {
        match self {
            Self::SinePolynomial { .. } => None,
            Self::Spline { pieces, .. } => Some(pieces),
        }
    }

    /// Degree of a spline.
    pub fn degree(self) -> Option<usize> {
        match self {
            Self::SinePolynomial { .. } => None,
            Self::Spline { degree, .. } => Some(degree),
        }
    }

    /// What keys of runs are made of.
    #[cfg(feature = "harness")]
    pub(super) fn identity(self) -> serde_json::Value {
        let name = self.name().name();
        match self {
            Self::SinePolynomial { terms } => serde_json::json!({ "name": name, "terms": terms }),
            Self::Spline { pieces, degree } => {
                serde_json::json!({ "name": name, "pieces": pieces, "degree": degree })
            }
        }
    }
}
