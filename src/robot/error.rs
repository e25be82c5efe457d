//! What keeps links from being a robot.

/// Why links make no robot.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RobotError {
    /// A parent that is not among the links before.
    #[error("link `{link}` has the parent number {parent}, which does not come before it")]
    Parent {
        /// Name of the link.
        link: String,
        /// Index of its parent.
        parent: usize,
    },
    /// A tool on a link that does not exist.
    #[error("the tool is on link number {0}, which does not exist")]
    Tool(usize),
    /// A pair whose shapes may touch with a link that does not exist.
    #[error("link number {0}, whose shapes are to be ignored, does not exist")]
    Ignored(usize),
    /// NaN, an infinite number, a negative mass or length, an inertia that is not symmetric or has a negative moment, or an empty
    /// range.
    #[error(
        "link `{0}` has a number that is not finite, a negative mass or length, an inertia that no body has or an empty range"
    )]
    Link(String),
    /// A base without mass, or with NaN, an infinite number or a negative length.
    #[error(
        "the base has a number that is not finite, a negative length, no mass or an inertia that no body has"
    )]
    Base,
    /// As many joints that follow others or none as there are joints.
    #[error("found {found} joints that follow others or none, expected {expected}")]
    Followers {
        /// How many are told of.
        found: usize,
        /// How many joints move.
        expected: usize,
    },
    /// A joint that follows one which does not exist or follows another one, or with a multiplier of zero or a number that is
    /// not finite.
    #[error(
        "joint `{0}` follows a joint that does not move on its own, or by a multiplier of zero or a number that is not finite"
    )]
    Follow(String),
    /// A joint and its leader that cannot both be within their ranges.
    #[error(
        "joint `{joint}` follows joint `{leader}`, and no motion keeps both within their ranges"
    )]
    NoCommonRange {
        /// The one that follows.
        joint: String,
        /// The other one.
        leader: String,
    },
    /// Nothing to move.
    #[error("no joint moves")]
    NoMovingJoint,
}
