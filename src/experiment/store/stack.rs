//! Many tables below each other.

use polars::prelude::*;

use crate::experiment::schema::runs;

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

/// Tables below each other; a column that some lack is null there.
fn joined(tables: impl IntoIterator<Item = DataFrame>) -> PolarsResult<DataFrame> {
    let mut all = DataFrame::empty();
    for mut table in tables {
        if all.width() > 0 && all.schema() != table.schema() {
            complete(&mut all, table.schema())?;
            complete(&mut table, all.schema())?;
            table = table.select(all.get_column_names_owned())?;
        }
        all.vstack_mut_owned(table)?;
    }
    all.rechunk_mut();
    Ok(all)
}

/// Adds the columns that another table has beside, as nulls.
fn complete(table: &mut DataFrame, other: &Schema) -> PolarsResult<()> {
    let height = table.height();
    for (name, kind) in other.iter() {
        if table.column(name).is_err() {
            table.with_column(Column::full_null(name.clone(), height, kind))?;
        }
    }
    Ok(())
}

/// The rows of some runs.
pub(super) fn only(frame: &DataFrame, wanted: impl Fn(&str) -> bool) -> PolarsResult<DataFrame> {
    let keys = frame.column(runs::KEY)?.str()?;
    let mask: BooleanChunked = keys.iter().map(|key| Some(key.is_some_and(&wanted))).collect();
    frame.filter(&mask)
}
