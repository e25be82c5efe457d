//! The page of an experiment: one HTML file with everything in it, which asks for no other and for no network.
//!
//! `Page` says what goes into it; `page.html` is its frame, `page.css` its look, and the scripts, one after the
//! other in one module, do what needs a reader's hand: sorting, filtering, downloads, the view of the motion.
//! The same results give the same page byte for byte.

mod chart_options;
mod drawing;
mod embedded;
mod error;
mod page;
mod provenance;
mod write;

pub use chart_options::{ChartOptions, PALETTES, palette};
pub use error::ReportError;
pub use page::motion_page;
pub use write::{Report, Target, tables, write, write_all};
