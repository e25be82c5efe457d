//! What a search is: a problem in a box, and the oracle through which alone it is asked.

mod failure;
mod oracle;
mod points;
mod problem;
mod rng;
mod terms;

pub use failure::Failure;
pub use oracle::{Best, Oracle, Stop, TracePoint, Watch};
pub use points::{Bounds, BoundsError, Points, PointsIter, PointsIterMut};
pub use problem::{Composite, Evaluation, Problem};
pub use rng::Rng;
pub use terms::{Linearisation, Multipliers, Piece, PieceId, Shape, Term};
