//! The stored tables: every column, named once.

/// Version of the stored tables; raised when a column changes its name or its meaning.
pub const FORMAT: u64 = 6;

/// What the cells of a column are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cell {
    /// A text.
    Text,
    /// A whole number.
    Count,
    /// A number.
    Real,
    /// A list of numbers.
    Reals,
    /// Columns that the subject names; they stand here.
    OfSubject,
}

/// A column of a stored table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Column {
    /// Its name.
    pub name: &'static str,
    /// What its cells are.
    pub cell: Cell,
    /// What it means.
    pub meaning: &'static str,
}

/// Names every column of a table by a constant, and lists them in order.
macro_rules! table {
    ($(#[$about:meta])* $module:ident: $($constant:ident = $name:literal, $cell:ident, $meaning:expr;)*) => {
        $(#[$about])*
        pub mod $module {
            use super::{Cell, Column};

            $(
                #[doc = $meaning]
                pub const $constant: &str = $name;
            )*

            /// All of them, in order.
            pub const COLUMNS: &[Column] = &[
                $(Column { name: $name, cell: Cell::$cell, meaning: $meaning },)*
            ];
        }
    };
}

table! {
    /// One row per run.
    runs:
    FORMAT = "format", Count, "version of these columns";
    KEY = "key", Text, "the run's key, the hash of `recipe`";
    RECIPE = "recipe", Text, "everything that determines the result, as JSON";
    EXPERIMENT = "experiment", Text, "name of the experiment that made it";
    PROBLEM = "problem", Text, "name of the subject: `reorientation`, a test function's, or that given by the program that made it";
    INSTANCE = "instance", Text, "what told the instance from the others when the run was made; empty where there was but one";
    GROUP = "group", Text, "what the instance had in common with those it was summarised with: all but pose, or shift and rotation";
    OPTIMISER = "optimiser", Text, "label of the optimiser when the run was made";
    FORMULATION = "formulation", Text, "formulation that it searched; null where the subject has but one";
    SETTINGS = "settings", Text, "all settings as JSON";
    FACTS = "facts of the subject", OfSubject, "what there is to know of the subject: see below";
    TARGETS = "targets", Reals, "costs that the run was asked to reach";
    SEED = "seed", Count, "seed";
    BUDGET = "budget", Count, "evaluations allowed";
    COST = "j", Real, "best cost as the search evaluated it";
    VIOLATION = "violation", Real, "the sum of its relative excesses over the limits";
    POINT = "x", Reals, "where that was found, in the variables of `formulation`";
    CERTIFIED_COST = "certified_j", Real, "cost of the same point, evaluated finely; `j` where the subject has no finer evaluation";
    MEASURES = "measures of the subject", OfSubject, "what else is known of that point: see below";
    EVALUATIONS = "evaluations", Count, "evaluations made, one that panicked or failed among them";
    FIRST_FEASIBLE = "first_feasible", Count, "the first evaluation within all limits; null where there was none";
    LINEARISATIONS = "linearisations", Count, "first derivatives made, each with an evaluation that is counted too";
    CURVATURES = "curvatures", Count, "second derivatives made";
    CONIC_SOLVES = "conic_solves", Count, "conic subproblems solved or given up";
    CONIC_FAILURES = "conic_failures", Count, "conic subproblems given up";
    SECONDS = "seconds", Real, "wall time in seconds";
    SECONDS_IN_PROBLEM = "seconds_in_problem", Real, "the part of it inside the problem";
    STATUS = "status", Text, "`finished`, `budget-spent`, `no-derivatives`, `failed` or `panicked`; `imported` for runs of other programs";
    MESSAGE = "message", Text, "why the run failed, or what the panic said and where";
    VERSION = "version", Text, "version of the program";
    COMMIT = "commit", Text, "its commit";
    CPU = "cpu", Text, "the processor";
    DATE = "date", Text, "when the run ended, UTC";
}

table! {
    /// One row per run that the experiment has, stored or not, with the labels that it gives them now.
    plan:
    KEY = "key", Text, "the run's key";
    PROBLEM = "problem", Text, "name of the subject";
    INSTANCE = "instance", Text, "what tells the instance from the others; empty where there is but one";
    GROUP = "group", Text, "what the instance has in common with those it is summarised with";
    OPTIMISER = "optimiser", Text, "label of the optimiser, which no other has";
    FORMULATION = "formulation", Text, "formulation that it searches; null where the subject has but one";
    SEED = "seed", Count, "seed";
    BUDGET = "budget", Count, "evaluations allowed";
}

table! {
    /// Improvements of the best cost, and the last evaluation of each run.
    traces:
    KEY = "key", Text, "the run's key";
    EVALUATION = "evaluation", Count, "which evaluation, counted from one";
    COST = "j", Real, "best cost so far";
    VIOLATION = "violation", Real, "violation of that best";
}

table! {
    /// When each row of a trace was reached.
    clocks:
    KEY = "key", Text, "the run's key";
    EVALUATION = "evaluation", Count, "which evaluation, counted from one";
    SECONDS = "seconds", Real, "wall time since the run began, in seconds";
    THREADS = "threads", Count, "how many runs were made at a time";
}
