//! A robot as MJCF, the format of MuJoCo (<https://mujoco.readthedocs.io/en/stable/XMLreference.html>).

use std::fmt::Write as _;

use nalgebra::{Matrix3, Rotation3, SymmetricEigen, UnitQuaternion, Vector3};

use super::link::{Body, Joint, Link};
use super::shape::Shape;
use super::to_urdf::{escaped, free_name, spaced};
use super::tree::{Robot, TOOL};

/// The least mass \[kg\] and moment of inertia \[kg m²\] that are written: MuJoCo takes no bodies that move and have none.
const LEAST: f64 = 1e-12;

impl Robot {
    /// The robot as MJCF, floating: frames, joints, masses and inertias, and shapes that are seen but touch nothing. The base is a body with
    /// its origin at its centre of mass, and the tool a site. Joints have no ranges, which MuJoCo would hold by forces.
    ///
    /// MuJoCo refuses principal moments that no rigid body has, which some robots state. Such a body is written with three equal
    /// moments, and its own stand in a `numeric` called `inertia of` and the body's name, for the compiled model.
    pub fn to_mjcf(&self) -> String {
        let taken: Vec<&str> = self.links().iter().map(|link| link.name.as_str()).collect();
        let base = free_name("base", &taken);
        let (mut bodies, mut moments) = (String::new(), String::new());
        let _ = writeln!(bodies, "    <body name=\"{}\">\n      <freejoint/>", escaped(&base));
        body(&mut bodies, &mut moments, &base, self.base(), &Vector3::zeros());
        self.site(&mut bodies, None);
        self.carried(&mut bodies, &mut moments);
        bodies.push_str("    </body>\n");
        let custom = if moments.is_empty() {
            String::new()
        } else {
            format!("  <custom>\n{moments}  </custom>\n")
        };
        format!(
            "<mujoco model=\"{}\">\n  <compiler angle=\"radian\" inertiafromgeom=\"false\"/>\n  \
             <option gravity=\"0 0 0\" integrator=\"RK4\"/>\n  <default>\n    <geom contype=\"0\" conaffinity=\"0\"/>\n  \
             </default>\n{custom}  <worldbody>\n{bodies}  </worldbody>\n</mujoco>\n",
            escaped(self.name())
        )
    }

    /// The links, each within the one that carries it.
    fn carried(&self, text: &mut String, moments: &mut String) {
        let taken: Vec<&str> = self.links().iter().map(|link| link.name.as_str()).collect();
        // The name of what MuJoCo has everything in.
        let world = free_name("world_link", &taken);
        // The bodies that the text is in, and where to look for the next that each carries.
        let mut open: Vec<(Option<usize>, usize)> = vec![(None, 0)];
        while let Some((parent, next)) = open.pop() {
            let own = |link: &Link| link.parent == parent;
            let Some(at) = (next..self.links().len()).find(|i| own(&self.links()[*i])) else {
                if parent.is_some() {
                    text.push_str("    </body>\n");
                }
                continue;
            };
            open.extend([(parent, at + 1), (Some(at), at + 1)]);
            let Link { name, placement, joint, body: own, centre_of_mass, .. } = &self.links()[at];
            let name = if name == "world" { &world } else { name };
            let _ = writeln!(
                text,
                "    <body name=\"{}\" pos=\"{}\" quat=\"{}\">",
                escaped(name),
                spaced(placement.translation()),
                quaternion(&placement.rotation())
            );
            let kind = if matches!(joint, Joint::Prismatic(_)) { "slide" } else { "hinge" };
            if let Some(axis) = joint.axis() {
                let (name, direction) = (escaped(&axis.name), spaced(&axis.direction));
                let _ = writeln!(
                    text,
                    "      <joint name=\"{name}\" type=\"{kind}\" axis=\"{direction}\"/>"
                );
            }
            body(text, moments, name, own, centre_of_mass);
            self.site(text, Some(at));
        }
    }

    /// The tool, if the link, or the base, holds it.
    fn site(&self, text: &mut String, link: Option<usize>) {
        let placement = &self.tool().placement;
        if self.tool().link == link {
            let (at, turn) = (spaced(placement.translation()), quaternion(&placement.rotation()));
            let _ = writeln!(text, "      <site name=\"{TOOL}\" pos=\"{at}\" quat=\"{turn}\"/>");
        }
    }
}

/// What a body has: mass, inertia and shapes.
fn body(
    text: &mut String,
    moments: &mut String,
    name: &str,
    Body { mass, inertia, shapes }: &Body,
    centre: &Vector3<f64>,
) {
    let (principal, axes) = principal_moments(inertia);
    let at_least = principal.map(|moment| moment.max(LEAST));
    let is_sound = 2.0 * at_least.max() <= at_least.sum();
    let written = if is_sound { at_least } else { Vector3::repeat(at_least.mean()) };
    let _ = writeln!(
        text,
        "      <inertial mass=\"{}\" pos=\"{}\" quat=\"{}\" diaginertia=\"{}\"/>",
        mass.max(LEAST),
        spaced(centre),
        quaternion(&axes),
        spaced(&written)
    );
    if !is_sound {
        let _ = writeln!(
            moments,
            "    <numeric name=\"inertia of {}\" data=\"{}\"/>",
            escaped(name),
            spaced(&at_least)
        );
    }
    for shape in shapes {
        geom(text, shape);
    }
}

/// Principal moments, and the rotation that turns principal axes into those of the link.
fn principal_moments(inertia: &Matrix3<f64>) -> (Vector3<f64>, Rotation3<f64>) {
    // Of equal moments any axes will do, so those of the link stay where they can.
    if inertia.iter().enumerate().all(|(i, entry)| i % 4 == 0 || *entry == 0.0) {
        return (inertia.diagonal(), Rotation3::identity());
    }
    let SymmetricEigen { eigenvalues, mut eigenvectors } = inertia.symmetric_eigen();
    if eigenvectors.determinant() < 0.0 {
        eigenvectors.column_mut(0).neg_mut();
    }
    (eigenvalues, Rotation3::from_matrix_unchecked(eigenvectors))
}

fn geom(text: &mut String, shape: &Shape) {
    let _ = match shape {
        Shape::Capsule { ends: [from, to], radius } if from == to => {
            let at = spaced(from);
            let radius = radius.max(LEAST);
            writeln!(text, "      <geom type=\"sphere\" size=\"{radius}\" pos=\"{at}\"/>")
        }
        Shape::Capsule { ends: [from, to], radius } => {
            let (from, to) = (spaced(from), spaced(to));
            let radius = radius.max(LEAST);
            writeln!(
                text,
                "      <geom type=\"capsule\" size=\"{radius}\" fromto=\"{from} {to}\"/>"
            )
        }
        Shape::Cuboid { centre, half, rotation } => {
            // A sheet has a thickness there.
            let half = spaced(&half.map(|half| half.max(LEAST)));
            let (at, turn) = (spaced(centre), quaternion(rotation));
            writeln!(
                text,
                "      <geom type=\"box\" size=\"{half}\" pos=\"{at}\" quat=\"{turn}\"/>"
            )
        }
    };
}

fn quaternion(rotation: &Rotation3<f64>) -> String {
    let [x, y, z, w]: [f64; 4] = UnitQuaternion::from_rotation_matrix(rotation).coords.into();
    format!("{w} {x} {y} {z}")
}
