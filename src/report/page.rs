//! The page.

use minijinja::Environment;
use minijinja::value::Serde;
use polars::prelude::*;
use serde::Serialize;

use super::drawing::Drawing;
use super::embedded::Embedded;
use super::error::ReportError;
use super::provenance::Fact;
use crate::analysis::csv;
use crate::exhibit::{Chart, Finding, Scene, Table};

/// What a page is made of.
#[derive(Debug, Clone, Copy)]
pub(super) struct Page<'a> {
    /// The experiment's name.
    pub(super) name: &'a str,
    /// What is said first.
    pub(super) findings: &'a [Finding],
    /// The motions to be shown; none for problems that have none.
    pub(super) scenes: &'a [Scene],
    /// How many instances have a motion, shown or not.
    pub(super) motions_found: usize,
    /// The charts.
    pub(super) charts: &'a [Chart],
    /// The tables; curves are there to download.
    pub(super) tables: &'a [Table],
    /// Names and texts of the files that made the experiment.
    pub(super) files: &'a [(String, String)],
    /// How the runs were made.
    pub(super) facts: &'a [Fact],
}

const TEMPLATE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
/// One module, in this order.
const SCRIPTS: [&str; 10] = [
    include_str!("script/data.js"),
    include_str!("script/tables.js"),
    include_str!("script/figures.js"),
    include_str!("script/vectors.js"),
    include_str!("script/solids.js"),
    include_str!("script/camera.js"),
    include_str!("script/view.js"),
    include_str!("script/recorder.js"),
    include_str!("script/player.js"),
    include_str!("script/main.js"),
];

/// What the template is filled in with.
#[derive(Serialize)]
struct Content<'a> {
    name: &'a str,
    style: &'static str,
    script: String,
    findings: &'a [Finding],
    scenes: &'a [Scene],
    motions_found: usize,
    motions: Embedded,
    figures: Vec<FigureContent<'a>>,
    tables: Vec<TableContent<'a>>,
    files: &'a [(String, String)],
    facts: &'a [Fact],
}

#[derive(Serialize)]
struct FigureContent<'a> {
    name: &'a str,
    title: &'a str,
    caption: &'a str,
    drawing: Drawing,
    /// Name of its table, if that is on the page.
    table: Option<&'a str>,
}

#[derive(Serialize)]
struct TableContent<'a> {
    name: &'a str,
    title: String,
    caption: &'a str,
    /// Of each column: `text`, `count` or `real`.
    kinds: String,
    data: Embedded,
    is_curve: bool,
    /// Whether a chart offers it.
    is_drawn: bool,
}

/// A page that shows one motion and nothing else.
pub fn motion_page(name: &str, scene: Scene) -> Result<String, ReportError> {
    Page {
        name,
        findings: &[],
        scenes: &[scene],
        motions_found: 1,
        charts: &[],
        tables: &[],
        files: &[],
        facts: &[],
    }
    .html()
}

impl Page<'_> {
    /// The file.
    pub(super) fn html(&self) -> Result<String, ReportError> {
        let figures = self.charts.iter().map(|chart| self.figure(chart));
        let tables = self.tables.iter().map(|table| self.table(table));
        let content = Content {
            name: self.name,
            style: STYLE,
            script: SCRIPTS.join("\n"),
            findings: self.findings,
            scenes: self.scenes,
            motions_found: self.motions_found,
            motions: Embedded::new(&motions(self.scenes)?)?,
            figures: figures.collect::<Result<_, ReportError>>()?,
            tables: tables.collect::<Result<_, ReportError>>()?,
            files: self.files,
            facts: self.facts,
        };
        // The name's end has everything escaped that the template does not call safe.
        Ok(Environment::new().render_named_str("page.html", TEMPLATE, Serde(&content))?)
    }

    fn figure<'b>(&self, chart: &'b Chart) -> Result<FigureContent<'b>, ReportError> {
        let is_here = self.tables.iter().any(|table| table.name == chart.table);
        Ok(FigureContent {
            name: &chart.name,
            title: &chart.title,
            caption: &chart.caption,
            drawing: Drawing::of(chart)?,
            table: is_here.then_some(&*chart.table),
        })
    }

    fn table<'b>(&self, table: &'b Table) -> Result<TableContent<'b>, ReportError> {
        Ok(TableContent {
            name: &table.name,
            title: title(&table.name),
            caption: &table.caption,
            kinds: table.frame.columns().iter().map(kind).collect::<Vec<_>>().join(" "),
            data: Embedded::new(&String::from_utf8_lossy(&csv(&table.frame)?))?,
            is_curve: table.is_curve,
            is_drawn: self.charts.iter().any(|chart| chart.table == table.name),
        })
    }
}

/// A table's name as a heading.
fn title(name: &str) -> String {
    let mut letters = name.chars();
    let first = letters.next().map(|letter| letter.to_ascii_uppercase());
    first.into_iter().chain(letters).map(|c| if c == '-' { ' ' } else { c }).collect()
}

fn kind(column: &Column) -> &'static str {
    match column.dtype() {
        kind if kind.is_float() => "real",
        kind if kind.is_integer() => "count",
        _ => "text",
    }
}

/// The motions as JSON.
fn motions(scenes: &[Scene]) -> serde_json::Result<String> {
    let mut motions = serde_json::to_value(scenes)?;
    shorten(&mut motions);
    serde_json::to_string(&motions)
}

/// Six significant digits are more than a screen shows.
fn shorten(value: &mut serde_json::Value) {
    match value {
        serde_json::Value::Array(items) => items.iter_mut().for_each(shorten),
        serde_json::Value::Object(fields) => fields.values_mut().for_each(shorten),
        serde_json::Value::Number(number) if number.is_f64() => {
            let rounded = number.as_f64().and_then(|number| format!("{number:.5e}").parse().ok());
            if let Some(short) = rounded.and_then(serde_json::Number::from_f64) {
                *number = short;
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(name: &str, caption: &str) -> String {
        let frame = df!("optimiser" => ["a", "</script>"], "J" => [0.5, f64::INFINITY]).unwrap();
        let table = Table::of("first-feasible", caption, frame);
        let page = Page {
            name,
            findings: &[],
            scenes: &[],
            motions_found: 0,
            charts: &[],
            tables: &[table],
            files: &[("experiment.toml".to_owned(), "name = '<b>'".to_owned())],
            facts: &[],
        };
        page.html().unwrap()
    }

    #[test]
    fn what_comes_from_outside_is_text() {
        let page = page("<img src=x>", "a < b & c");
        assert!(page.contains("&lt;img src=x&gt;") && !page.contains("<img"));
        assert!(page.contains("a &lt; b &amp; c") && page.contains("&lt;b&gt;"));
        assert!(page.contains("optimiser,J\na,0.5\n&lt;/script>,inf\n"));
        assert!(page.contains("First feasible") && page.contains("data-kinds=\"text real\""));
    }

    #[test]
    fn the_same_gives_the_same_and_nothing_is_loaded() {
        let once = page("x", "");
        assert_eq!(once, page("x", ""));
        for address in ["src=\"http", "href=\"http", "url(http", "@import", "fetch("] {
            assert!(!once.contains(address), "{address}");
        }
    }

    #[test]
    fn numbers_keep_six_digits() {
        let mut value = serde_json::json!([1.234_567_89, -1.0e-12, 7, "x", { "a": 1e300 }]);
        shorten(&mut value);
        assert_eq!(value, serde_json::json!([1.234_57, -1.0e-12, 7, "x", { "a": 1e300 }]));
    }
}
