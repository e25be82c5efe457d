//! A table of a report.

use std::borrow::Cow;

use polars::prelude::{Column, DataFrame, ParquetWriter};

/// A table of a report.
#[derive(Debug, Clone)]
pub struct Table {
    /// Name of its files.
    pub(crate) name: Cow<'static, str>,
    /// What it shows.
    pub(crate) caption: String,
    pub(crate) frame: DataFrame,
    /// Whether it is a curve's many points, which nobody reads.
    pub(crate) is_curve: bool,
}

impl Table {
    /// A table of these rows.
    pub(crate) fn of(
        name: impl Into<Cow<'static, str>>,
        caption: impl Into<String>,
        frame: DataFrame,
    ) -> Self {
        Self { name: name.into(), caption: caption.into(), frame, is_curve: false }
    }

    /// A table that is a curve's many points.
    pub(crate) fn curve(
        name: impl Into<Cow<'static, str>>,
        caption: impl Into<String>,
        frame: DataFrame,
    ) -> Self {
        Self { is_curve: true, ..Self::of(name, caption, frame) }
    }

    /// A table without columns. Its name is that of its files; what is neither a letter of ASCII, a digit nor
    /// `-` becomes `-`.
    pub fn new(name: &str, caption: impl Into<String>) -> Self {
        Self::of(file_name(name), caption, DataFrame::empty())
    }

    /// With another column of texts. A column that is not as long as the others, or whose name is
    /// taken, is left out.
    #[must_use]
    pub fn with_texts<S: AsRef<str>>(self, name: &str, values: &[S]) -> Self {
        let values: Vec<&str> = values.iter().map(AsRef::as_ref).collect();
        self.with(Column::new(name.into(), values))
    }

    /// With another column of numbers, on the terms of [`with_texts`](Self::with_texts).
    #[must_use]
    pub fn with_numbers(self, name: &str, values: &[f64]) -> Self {
        self.with(Column::new(name.into(), values))
    }

    /// Name of its files.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What it shows.
    pub fn caption(&self) -> &str {
        &self.caption
    }

    /// As a Parquet file; an error says why it could not be made.
    pub fn parquet(&self) -> Result<Vec<u8>, String> {
        let (mut bytes, mut frame) = (Vec::new(), self.frame.clone());
        let written = ParquetWriter::new(&mut bytes).finish(&mut frame);
        written.map(|_| bytes).map_err(|error| error.to_string())
    }

    fn with(mut self, column: Column) -> Self {
        let fits = self.frame.width() == 0 || column.len() == self.frame.height();
        if fits && self.frame.column(column.name()).is_err() {
            let mut columns = self.frame.columns().to_vec();
            let height = column.len();
            columns.push(column);
            if let Ok(frame) = DataFrame::new(height, columns) {
                self.frame = frame;
            }
        }
        self
    }
}

/// A name that is safe as a file's.
pub(super) fn file_name(name: &str) -> String {
    let safe = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
    name.chars().map(safe).collect()
}
