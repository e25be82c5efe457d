//! Many tables below each other.

use polars::prelude::*;

/// So many tables become one: each appended table looks through all those before it.
const PARTS: usize = 100;

/// Tables with the same columns on their way into one.
#[derive(Debug, Default)]
pub(super) struct Stack {
    large: Vec<DataFrame>,
    small: Vec<DataFrame>,
}

impl Stack {
    /// Puts a table below the others.
    pub(super) fn push(&mut self, table: DataFrame) -> PolarsResult<()> {
        self.small.push(table);
        if self.small.len() == PARTS {
            self.large.push(joined(std::mem::take(&mut self.small))?);
        }
        Ok(())
    }

    /// All rows so far.
    pub(super) fn height(&self) -> usize {
        self.large.iter().chain(&self.small).map(DataFrame::height).sum()
    }

    /// The columns, once there is a table.
    pub(super) fn schema(&self) -> Option<&SchemaRef> {
        self.large.iter().chain(&self.small).next().map(DataFrame::schema)
    }

    /// One table, in one piece.
    pub(super) fn into_table(self) -> PolarsResult<DataFrame> {
        joined(self.large.into_iter().chain(self.small))
    }
}

fn joined(tables: impl IntoIterator<Item = DataFrame>) -> PolarsResult<DataFrame> {
    let mut all = DataFrame::empty();
    for table in tables {
        all.vstack_mut_owned(table)?;
    }
    all.rechunk_mut();
    Ok(all)
}
