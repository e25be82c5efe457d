//! What a report shows: findings, tables, charts and three-dimensional scenes, whoever made them.

mod chart;
mod finding;
mod scene;
mod table;
pub(crate) mod words;

pub use chart::Chart;
pub use finding::Finding;
pub use scene::Scene;
pub use table::Table;

/// What a subject shows of its own beside what every experiment shows.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Exhibits {
    /// What it says of an experiment in which a single optimiser went along a sweep, instead of a comparison.
    pub sweep: Option<Finding>,
    /// What it says of how good the best is; it stands before what is said of other subjects.
    pub quality: Option<Finding>,
    /// What else it says, at the end.
    pub findings: Vec<Finding>,
    /// Lines for a terminal, below the summary.
    pub lines: Vec<String>,
    /// Tables, behind that of the best runs.
    pub tables: Vec<Table>,
    /// Charts that stand before all others, since they are what a sweep asks.
    pub leading_charts: Vec<Chart>,
    /// Charts that stand behind all others.
    pub charts: Vec<Chart>,
    /// Tables that belong to those charts, behind all others.
    pub chart_tables: Vec<Table>,
    /// Scenes, by instance.
    pub scenes: Vec<Scene>,
    /// How many instances have a scene, shown or not.
    pub scenes_found: usize,
    /// All names that its tables may have: those that a report of other runs has left are removed.
    pub table_names: Vec<&'static str>,
    /// All names that its charts may have.
    pub chart_names: Vec<&'static str>,
}

impl Exhibits {
    /// Puts what another kind of subject shows behind this.
    pub(crate) fn extend(&mut self, other: Self) {
        self.sweep = self.sweep.take().or(other.sweep);
        self.quality = self.quality.take().or(other.quality);
        self.findings.extend(other.findings);
        self.lines.extend(other.lines);
        self.tables.extend(other.tables);
        self.leading_charts.extend(other.leading_charts);
        self.charts.extend(other.charts);
        self.chart_tables.extend(other.chart_tables);
        self.scenes.extend(other.scenes);
        self.scenes_found += other.scenes_found;
        self.table_names.extend(other.table_names);
        self.chart_names.extend(other.chart_names);
    }
}
