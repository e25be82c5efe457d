//! Trees of `reference/trees.json` as robots.

use driftless::robot::{Axis, Body, Joint, Link, Placement, Robot, Tool};
use nalgebra::{Matrix3, Quaternion, Unit, UnitQuaternion};
use serde::Deserialize;
use serde::de::DeserializeOwned;

#[derive(Deserialize)]
struct Reference<T> {
    trees: Vec<T>,
}

/// All trees of the file, and what else `T` takes of each.
pub(crate) fn trees<T: DeserializeOwned>() -> Vec<T> {
    let text = include_str!("../reference/trees.json");
    serde_json::from_str::<Reference<T>>(text).unwrap().trees
}

#[derive(Deserialize)]
pub(crate) struct Tree {
    base: BaseTable,
    links: Vec<LinkTable>,
    tool: Frame,
}

#[derive(Deserialize)]
struct BaseTable {
    mass: f64,
    inertia: [[f64; 3]; 3],
}

#[derive(Deserialize)]
struct Frame {
    translation: [f64; 3],
    rotation: [f64; 4],
}

#[derive(Deserialize)]
struct LinkTable {
    parent: Option<usize>,
    #[serde(flatten)]
    frame: Frame,
    joint: String,
    axis: [f64; 3],
    mass: f64,
    centre_of_mass: [f64; 3],
    inertia: [[f64; 3]; 3],
}

impl Frame {
    fn placement(&self) -> Placement {
        let [w, x, y, z] = self.rotation;
        let rotation = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
        Placement::new(self.translation.into(), rotation.to_rotation_matrix())
    }
}

fn body(mass: f64, inertia: [[f64; 3]; 3]) -> Body {
    Body::new(mass, Matrix3::from(inertia))
}

impl Tree {
    pub(crate) fn robot(&self) -> Robot {
        let links = self.links.iter().enumerate().map(|(i, link)| {
            let direction = Unit::new_normalize(link.axis.into());
            let axis = Axis::new(format!("joint{i}"), direction, [-4.0, 4.0]);
            Link {
                name: format!("joint{i}"),
                parent: link.parent,
                placement: link.frame.placement(),
                joint: match link.joint.as_str() {
                    "revolute" => Joint::Revolute(axis),
                    "prismatic" => Joint::Prismatic(axis),
                    _ => Joint::Fixed,
                },
                body: body(link.mass, link.inertia),
                centre_of_mass: link.centre_of_mass.into(),
            }
        });
        let tool = Tool { link: self.links.len().checked_sub(1), placement: self.tool.placement() };
        let base = body(self.base.mass, self.base.inertia);
        Robot::new("tree".to_owned(), base, links.collect(), tool).unwrap()
    }
}
