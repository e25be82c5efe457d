//! All tests of the library in one program, which is linked once. A new file needs a line here.

#[cfg(all(feature = "cli", feature = "film"))]
#[path = "animate.rs"]
mod animate;
#[path = "best_known.rs"]
mod best_known;
#[path = "book.rs"]
mod book;
#[path = "boxes.rs"]
mod boxes;
#[path = "coarser.rs"]
mod coarser;
#[path = "damage.rs"]
mod damage;
#[path = "derivatives.rs"]
mod derivatives;
mod drawn;
#[path = "drift.rs"]
mod drift;
#[path = "dynamics.rs"]
mod dynamics;
#[path = "examples.rs"]
mod examples;
#[path = "export.rs"]
mod export;
#[path = "floors.rs"]
mod floors;
#[path = "followers.rs"]
mod followers;
#[path = "limits_on_the_way.rs"]
mod limits_on_the_way;
#[path = "missions.rs"]
mod missions;
#[path = "optimisers.rs"]
mod optimisers;
#[path = "oracle.rs"]
mod oracle;
#[path = "physics.rs"]
mod physics;
#[path = "posture.rs"]
mod posture;
#[path = "reach.rs"]
mod reach;
#[path = "reference.rs"]
mod reference;
#[path = "relaxed.rs"]
mod relaxed;
#[path = "schema.rs"]
mod schema;
#[path = "scp.rs"]
mod scp;
#[path = "shapes.rs"]
mod shapes;
#[path = "shipped_robots.rs"]
mod shipped_robots;
#[path = "splines.rs"]
mod splines;
#[path = "subgradients.rs"]
mod subgradients;
#[path = "sweeps.rs"]
mod sweeps;
#[path = "terms.rs"]
mod terms;
#[path = "tool_goals.rs"]
mod tool_goals;
#[path = "trees.rs"]
mod trees;
#[path = "uncertainty.rs"]
mod uncertainty;
#[path = "urdf.rs"]
mod urdf;
