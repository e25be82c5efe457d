//! Tables as text: for a terminal, and as CSV, Markdown and LaTeX.

use comfy_table::{CellAlignment, ContentArrangement, Table, TableComponent, presets};
use polars::prelude::*;

use crate::exhibit::words::significant;

/// Draws a table for a terminal; numbers to five significant digits.
///
/// A text column in which every cell is empty is left out.
pub fn render(frame: &DataFrame) -> PolarsResult<String> {
    let mut table = drawn(frame, cell)?;
    table
        .load_preset(presets::NOTHING)
        .set_style(TableComponent::HeaderLines, '─')
        .set_style(TableComponent::MiddleHeaderIntersections, '─');
    Ok(table.to_string())
}

/// A table in Markdown, with the cells of [`render`].
pub fn markdown(frame: &DataFrame) -> PolarsResult<String> {
    let mut table = drawn(frame, |value| cell(value).replace('|', "\\|"))?;
    table.load_preset(presets::ASCII_MARKDOWN);
    Ok(format!("{table}\n"))
}

fn drawn(frame: &DataFrame, text: fn(&AnyValue<'_>) -> String) -> PolarsResult<Table> {
    let shown = shown(frame);
    let mut table = Table::new();
    table
        .set_content_arrangement(ContentArrangement::Disabled)
        .set_header(shown.iter().map(|column| column.name().as_str()));
    for i in 0..frame.height() {
        table.add_row(cells(&shown, i, text)?);
    }
    for (i, column) in shown.iter().enumerate() {
        if let (false, Some(column)) = (column.dtype().is_string(), table.column_mut(i)) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    Ok(table)
}

/// A table as comma-separated values; numbers with all their digits, `inf` where they are infinite, and empty
/// where there are none.
pub fn csv(frame: &DataFrame) -> PolarsResult<Vec<u8>> {
    let columns: Vec<&Column> = frame.columns().iter().collect();
    let broken = |error: csv::Error| PolarsError::ComputeError(error.to_string().into());
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(columns.iter().map(|column| column.name().as_str())).map_err(broken)?;
    for i in 0..frame.height() {
        writer.write_record(cells(&columns, i, exact)?).map_err(broken)?;
    }
    writer.into_inner().map_err(|error| broken(error.into_error().into()))
}

pub(super) fn shown(frame: &DataFrame) -> Vec<&Column> {
    frame.columns().iter().filter(|column| !is_blank(column)).collect()
}

/// One row's cells.
pub(super) fn cells(
    columns: &[&Column],
    row: usize,
    text: fn(&AnyValue<'_>) -> String,
) -> PolarsResult<Vec<String>> {
    columns.iter().map(|column| Ok(text(&column.get(row)?))).collect()
}

fn exact(value: &AnyValue<'_>) -> String {
    match value {
        AnyValue::Float64(number) if number.is_nan() => String::new(),
        // With an exponent where the number is far from one.
        AnyValue::Float64(number) => format!("{number:?}"),
        AnyValue::Null => String::new(),
        other => cell(other),
    }
}

fn is_blank(column: &Column) -> bool {
    column.str().is_ok_and(|text| text.iter().all(|cell| cell.is_none_or(str::is_empty)))
}

pub(super) fn cell(value: &AnyValue<'_>) -> String {
    match value {
        AnyValue::Float64(number) => significant(*number, 5),
        AnyValue::String(text) => text.replace(char::is_control, " "),
        AnyValue::StringOwned(text) => text.replace(char::is_control, " "),
        AnyValue::Null => "–".to_owned(),
        other => other.to_string(),
    }
}
