//! Reading a robot file, and the robots that come with the program.

use std::collections::HashSet;

use nalgebra::{Cholesky, Matrix3, Rotation3, Vector3};
use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::link::{Axis, Body, Joint, Link, Placement};
use super::tree::{Robot, Tool};
use crate::input::{Document, InputError, finite, finite_array, interval, positive};

/// The robots that come with the program: name and file.
const EMBEDDED: &[(&str, &str)] = &[("xiao2023", include_str!("xiao2023.toml"))];

impl Robot {
    /// The names of the robots that come with the program.
    pub fn embedded_names() -> impl Iterator<Item = &'static str> {
        EMBEDDED.iter().map(|(name, _)| *name)
    }

    /// The file of a robot that comes with the program.
    pub fn embedded(name: &str) -> Option<Document> {
        let (name, text) = EMBEDDED.iter().find(|(known, _)| *known == name)?;
        Some(Document::embedded(&format!("{name}.toml"), text))
    }

    /// Reads a robot.
    pub fn from_document(document: &Document) -> Result<Self, InputError> {
        RobotFile::read(document)?.build(document)
    }
}

/// A robot file. Lengths in metres, masses in kilograms, inertias in kg m².
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct RobotFile {
    name: String,
    base: BaseTable,
    joint: Spanned<Vec<JointTable>>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct BaseTable {
    #[serde(deserialize_with = "positive")]
    mass: f64,
    inertia: Inertia,
    #[serde(deserialize_with = "finite_array")]
    mount: [f64; 3],
    #[serde(default, deserialize_with = "finite_array")]
    mount_zyx_deg: [f64; 3],
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct JointTable {
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<Spanned<String>>,
    dh: DhTable,
    #[serde(deserialize_with = "interval")]
    range_deg: [f64; 2],
    #[serde(deserialize_with = "positive")]
    mass: f64,
    #[serde(deserialize_with = "finite_array")]
    centre_of_mass: [f64; 3],
    inertia: Inertia,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct DhTable {
    #[serde(default, deserialize_with = "finite")]
    offset_deg: f64,
    #[serde(deserialize_with = "finite")]
    d: f64,
    #[serde(deserialize_with = "finite")]
    a: f64,
    #[serde(deserialize_with = "finite")]
    alpha_deg: f64,
}

impl RobotFile {
    /// Reads a robot file.
    pub fn read(document: &Document) -> Result<Self, InputError> {
        let file: Self = document.parse()?;
        if file.joint.get_ref().is_empty() {
            let message = "found no joint, expected at least one";
            return Err(document.error_at(file.joint.span(), message, None));
        }
        file.check_names(document)?;
        Ok(file)
    }
}

impl RobotFile {
    /// Whether joints can be told apart by their names, which exports and tables have.
    fn check_names(&self, document: &Document) -> Result<(), InputError> {
        let mut taken = HashSet::new();
        for (i, joint) in self.joint.get_ref().iter().enumerate() {
            let span = joint.name.as_ref().map_or_else(|| self.joint.span(), Spanned::span);
            let name = joint.name(i);
            if name.trim().is_empty() || name.chars().any(char::is_control) {
                let message = "found a name without a letter, or with a control character";
                return Err(document.error_at(span, message, None));
            }
            if !taken.insert(name.clone()) {
                let message = format!("found two joints with the name `{name}`");
                return Err(document.error_at(span, message, None));
            }
        }
        Ok(())
    }
}

/// A symmetric matrix that is known to be positive definite.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(try_from = "InertiaTable", into = "InertiaTable")]
struct Inertia(Matrix3<f64>);

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct InertiaTable {
    #[serde(deserialize_with = "finite")]
    xx: f64,
    #[serde(deserialize_with = "finite")]
    yy: f64,
    #[serde(deserialize_with = "finite")]
    zz: f64,
    #[serde(default, deserialize_with = "finite")]
    xy: f64,
    #[serde(default, deserialize_with = "finite")]
    xz: f64,
    #[serde(default, deserialize_with = "finite")]
    yz: f64,
}

impl TryFrom<InertiaTable> for Inertia {
    type Error = &'static str;

    fn try_from(t: InertiaTable) -> Result<Self, Self::Error> {
        let matrix = Matrix3::new(t.xx, t.xy, t.xz, t.xy, t.yy, t.yz, t.xz, t.yz, t.zz);
        match Cholesky::new(matrix) {
            Some(_) => Ok(Self(matrix)),
            None => Err("the inertia is not positive definite"),
        }
    }
}

impl From<Inertia> for InertiaTable {
    fn from(Inertia(m): Inertia) -> Self {
        Self {
            xx: m[(0, 0)],
            yy: m[(1, 1)],
            zz: m[(2, 2)],
            xy: m[(0, 1)],
            xz: m[(0, 2)],
            yz: m[(1, 2)],
        }
    }
}

impl RobotFile {
    /// The chain of links that the rows describe. A row's step leads from its own link to the next joint,
    /// the last row's to the tool.
    pub fn build(self, document: &Document) -> Result<Robot, InputError> {
        let [yaw, pitch, roll] = self.base.mount_zyx_deg.map(f64::to_radians);
        let mount = Rotation3::from_euler_angles(roll, pitch, yaw);
        let span = self.joint.span();
        let mut placement = Placement::new(self.base.mount.into(), mount);
        let mut links = Vec::new();
        for (i, row) in self.joint.into_inner().into_iter().enumerate() {
            let step = row.dh.placement();
            links.push(row.link(i, std::mem::replace(&mut placement, step)));
        }
        let base = Body { mass: self.base.mass, inertia: self.base.inertia.0 };
        let tool = Tool { link: links.len().checked_sub(1), placement };
        Robot::new(self.name, base, links, tool)
            .map_err(|error| document.error_at(span, error.to_string(), None))
    }
}

impl DhTable {
    fn placement(&self) -> Placement {
        let [offset, twist] = [self.offset_deg, self.alpha_deg].map(f64::to_radians);
        Placement::dh(offset, self.d, self.a, twist)
    }
}

impl JointTable {
    fn name(&self, index: usize) -> String {
        let given = self.name.as_ref().map(|name| name.get_ref().clone());
        given.unwrap_or_else(|| format!("joint{}", index + 1))
    }

    fn link(self, index: usize, placement: Placement) -> Link {
        let range = self.range_deg.map(f64::to_radians);
        Link {
            name: self.name(index),
            parent: index.checked_sub(1),
            placement,
            joint: Joint::Revolute(Axis { direction: Vector3::z_axis(), range }),
            body: Body { mass: self.mass, inertia: self.inertia.0 },
            centre_of_mass: Vector3::from(self.centre_of_mass),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paper() -> Robot {
        Robot::from_document(&Robot::embedded("xiao2023").unwrap()).unwrap()
    }

    /// Table 2's `a_i + b_i` reproduces Table 1's rows; link 4 is the telling one.
    #[test]
    fn the_step_between_joints_is_a_plus_b() {
        let robot = paper();
        let step = robot.links()[4].placement.translation();
        assert!((step - Vector3::new(0.0, -0.425 - 0.45, 0.13 + 0.11)).norm() < 1e-15);
    }

    #[test]
    fn warns_of_links_three_and_four() {
        let warning = paper().warning().unwrap();
        assert!(warning.contains("joint3 and of the link of joint4 breaks"), "{warning}");
    }
}
