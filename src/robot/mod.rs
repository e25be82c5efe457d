//! A free base and the tree of links that it carries.

mod file;
mod identity;
mod link;
mod rigid;
mod tree;

pub use file::RobotFile;
pub(crate) use link::Turns;
pub use link::{Axis, Body, Joint, Link, Placement};
pub(crate) use rigid::Rigid;
pub(crate) use tree::{Gathered, Inherited};
pub use tree::{MovingJoint, Robot, RobotError, Tool};
