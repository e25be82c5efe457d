//! What a search is: a problem in a box, and the oracle through which alone it is asked.

mod composite;
mod failure;
mod oracle;
mod points;
mod problem;
mod rng;

pub use composite::{Composite, Linearisation, Multipliers, Piece};
pub use failure::Failure;
pub use oracle::{Best, Oracle, Stop, TracePoint, Watch};
pub use points::{Bounds, BoundsError, Points, PointsIter, PointsIterMut};
pub use problem::{Evaluation, Problem};
pub use rng::Rng;
