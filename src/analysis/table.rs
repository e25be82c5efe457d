//! A table as text.

use comfy_table::{CellAlignment, ContentArrangement, Table, TableComponent, presets};
use polars::prelude::*;

/// Draws a table for a terminal; numbers to five significant digits.
///
/// A text column in which every cell is empty is left out.
pub fn render(frame: &DataFrame) -> PolarsResult<String> {
    let shown: Vec<&Column> = frame.columns().iter().filter(|column| !is_blank(column)).collect();
    let mut table = Table::new();
    table
        .load_preset(presets::NOTHING)
        .set_style(TableComponent::HeaderLines, '─')
        .set_style(TableComponent::MiddleHeaderIntersections, '─')
        .set_content_arrangement(ContentArrangement::Disabled)
        .set_header(shown.iter().map(|column| column.name().as_str()));
    for i in 0..frame.height() {
        let cells = shown.iter().map(|column| column.get(i).map(|value| cell(&value)));
        table.add_row(cells.collect::<PolarsResult<Vec<_>>>()?);
    }
    for (i, column) in shown.iter().enumerate() {
        if let (false, Some(column)) = (column.dtype().is_string(), table.column_mut(i)) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    Ok(table.to_string())
}

fn is_blank(column: &Column) -> bool {
    column.str().is_ok_and(|text| text.iter().all(|cell| cell.is_none_or(str::is_empty)))
}

fn cell(value: &AnyValue<'_>) -> String {
    match value {
        AnyValue::Float64(number) => significant(*number),
        AnyValue::String(text) => (*text).to_owned(),
        AnyValue::StringOwned(text) => text.to_string(),
        AnyValue::Null => "–".to_owned(),
        other => other.to_string(),
    }
}

/// Five significant digits, in plain notation where that is readable.
fn significant(number: f64) -> String {
    if number.is_infinite() || number.is_nan() {
        return "–".to_owned();
    }
    let magnitude = if number == 0.0 { 0.0 } else { number.abs().log10().floor() };
    if (-4.0..7.0).contains(&magnitude) {
        format!("{number:.*}", (4.0 - magnitude).max(0.0) as usize)
    } else {
        format!("{number:.3e}")
    }
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn keeps_five_significant_digits() {
        for (number, text) in [
            (0.0, "0.0000"),
            (0.781_849_4, "0.78185"),
            (13.290_71, "13.291"),
            (123_456.7, "123457"),
            (0.000_123_456, "0.00012346"),
            (1.5e-7, "1.500e-7"),
            (f64::NAN, "–"),
        ] {
            assert_eq!(significant(number), text);
        }
    }
}
