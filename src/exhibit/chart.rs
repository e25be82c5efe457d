//! A chart: a figure and what is said about it.

use std::borrow::Cow;

use crate::figure::Figure;

/// A figure with what goes with it in a report.
#[derive(Debug, Clone)]
pub struct Chart {
    /// Name of its files.
    pub name: String,
    /// What it shows, in a few words.
    pub title: String,
    /// How to read it.
    pub caption: String,
    /// Name of the table it was drawn from.
    pub table: Cow<'static, str>,
    /// The drawing.
    pub figure: Figure,
}
