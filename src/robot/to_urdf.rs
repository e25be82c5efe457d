//! A robot as URDF.

use std::fmt::Write as _;

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::follow::Follow;
use super::link::{Axis, Body, Joint, Placement};
use super::shape::Shape;
use super::tree::{Robot, TOOL};

impl Robot {
    /// The robot as URDF, for simulators and other planners: frames, joints with their limits, masses, inertias and
    /// shapes, and the tool as a link of its own. A capsule is a cylinder with two spheres, which this program reads as a capsule again. Pairs
    /// of links that may touch are left out. The root is the base, with its origin at the base's centre of mass.
    pub fn to_urdf(&self) -> String {
        let mut taken: Vec<&str> = self.links().iter().map(|link| link.name.as_str()).collect();
        let base = free_name("base", &taken);
        taken.push(&base);
        let tool = free_name(TOOL, &taken);
        let mut text = String::from("<?xml version=\"1.0\"?>\n");
        let _ = writeln!(text, "<robot name=\"{}\">", escaped(self.name()));
        link(&mut text, &base, self.base(), &Vector3::zeros());
        let called = |link: Option<usize>| match link {
            Some(link) => self.links()[link].name.as_str(),
            None => base.as_str(),
        };
        for own in self.links() {
            link(&mut text, &own.name, &own.body, &own.centre_of_mass);
            let parent = called(own.parent);
            joint(&mut text, &own.joint, [parent, &own.name], &own.placement, self);
        }
        let placement = &self.tool().placement;
        if *self.tool() != self.unstated_tool() {
            link(&mut text, &tool, &Body::massless(), &Vector3::zeros());
            joint(&mut text, &Joint::Fixed, [called(self.tool().link), &tool], placement, self);
        }
        text.push_str("</robot>\n");
        text
    }
}

/// The name, with a number behind it if it is taken.
pub(super) fn free_name(name: &str, taken: &[&str]) -> String {
    let numbered = (2..).map(|number| format!("{name}{number}"));
    let mut names = std::iter::once(name.to_owned()).chain(numbered);
    names.find(|name| !taken.contains(&name.as_str())).unwrap_or_default()
}

fn link(text: &mut String, name: &str, body: &Body, centre: &Vector3<f64>) {
    let name = escaped(name);
    let is_massless = body.mass == 0.0 && body.inertia == Matrix3::zeros();
    if is_massless && body.shapes.is_empty() {
        let _ = writeln!(text, "  <link name=\"{name}\"/>");
        return;
    }
    let _ = writeln!(text, "  <link name=\"{name}\">");
    if !is_massless {
        inertial(text, body, centre);
    }
    for shape in &body.shapes {
        collision(text, shape);
    }
    text.push_str("  </link>\n");
}

fn inertial(text: &mut String, Body { mass, inertia, .. }: &Body, centre: &Vector3<f64>) {
    let entry = |i, j| inertia[(i, j)];
    let _ = writeln!(
        text,
        "    <inertial>\n      <origin xyz=\"{}\" rpy=\"0 0 0\"/>\n      <mass value=\"{mass}\"/>\n      \
         <inertia ixx=\"{}\" ixy=\"{}\" ixz=\"{}\" iyy=\"{}\" iyz=\"{}\" izz=\"{}\"/>\n    </inertial>",
        spaced(centre),
        entry(0, 0),
        entry(0, 1),
        entry(0, 2),
        entry(1, 1),
        entry(1, 2),
        entry(2, 2),
    );
}

fn collision(text: &mut String, shape: &Shape) {
    let mut solid = |at: &Vector3<f64>, turn: &Vector3<f64>, geometry: &str| {
        let _ = writeln!(
            text,
            "    <collision>\n      <origin xyz=\"{}\" rpy=\"{}\"/>\n      <geometry>{geometry}</geometry>\n    </collision>",
            spaced(at),
            spaced(turn),
        );
    };
    match shape {
        Shape::Capsule { ends: [from, to], radius } => {
            let sphere = format!("<sphere radius=\"{radius}\"/>");
            if from != to {
                let axis = to - from;
                let pitch = axis.x.hypot(axis.y).atan2(axis.z);
                let turn = Vector3::new(0.0, pitch, axis.y.atan2(axis.x));
                let length = axis.norm();
                let cylinder = format!("<cylinder radius=\"{radius}\" length=\"{length}\"/>");
                solid(&(0.5 * (from + to)), &turn, &cylinder);
                solid(to, &Vector3::zeros(), &sphere);
            }
            solid(from, &Vector3::zeros(), &sphere);
        }
        Shape::Cuboid { centre, half, rotation } => {
            let size = spaced(&(2.0 * half));
            solid(centre, &roll_pitch_yaw(rotation), &format!("<box size=\"{size}\"/>"));
        }
    }
}

fn joint(
    text: &mut String,
    joint: &Joint,
    [parent, child]: [&str; 2],
    placement: &Placement,
    robot: &Robot,
) {
    let (kind, name, axis) = match joint {
        Joint::Revolute(axis) => ("revolute", axis.name.clone(), Some(axis)),
        Joint::Prismatic(axis) => ("prismatic", axis.name.clone(), Some(axis)),
        Joint::Fixed => {
            let taken: Vec<&str> = robot.joints().map(|joint| joint.name).collect();
            ("fixed", free_name(&format!("{child}_fixed"), &taken), None)
        }
    };
    let _ = writeln!(
        text,
        "  <joint name=\"{}\" type=\"{kind}\">\n    <parent link=\"{}\"/>\n    <child link=\"{}\"/>\n    \
         <origin xyz=\"{}\" rpy=\"{}\"/>",
        escaped(&name),
        escaped(parent),
        escaped(child),
        spaced(placement.translation()),
        spaced(&roll_pitch_yaw(&placement.rotation())),
    );
    if let Some(Axis { name, direction, range: [lower, upper], rate, effort }) = axis {
        // Readers expect both; zero stands for what is not known.
        let [rate, effort] = [rate, effort].map(|limit| limit.unwrap_or(0.0));
        let _ = writeln!(
            text,
            "    <axis xyz=\"{}\"/>\n    <limit lower=\"{lower}\" upper=\"{upper}\" velocity=\"{rate}\" effort=\"{effort}\"/>",
            spaced(direction),
        );
        mimic(text, name, robot);
    }
    text.push_str("  </joint>\n");
}

fn mimic(text: &mut String, name: &str, robot: &Robot) {
    let own = robot.joints().find(|joint| joint.name == name);
    let Some(Follow { leader, multiplier, offset }) = own.and_then(|own| own.follows) else {
        return;
    };
    let leader = robot.joints().nth(leader).map_or("", |joint| joint.name);
    let _ = writeln!(
        text,
        "    <mimic joint=\"{}\" multiplier=\"{multiplier}\" offset=\"{offset}\"/>",
        escaped(leader),
    );
}

/// Good to all digits for every pitch: where it is a quarter turn the yaw is whatever rounding leaves, and the roll goes with it.
fn roll_pitch_yaw(rotation: &Rotation3<f64>) -> Vector3<f64> {
    let m = rotation.matrix();
    let pitch = (-m[(2, 0)]).atan2(m[(2, 1)].hypot(m[(2, 2)]));
    let yaw = m[(1, 0)].atan2(m[(0, 0)]);
    let (sin, cos) = yaw.sin_cos();
    // The second row of what is left when the yaw is taken away: 0, cos roll, −sin roll.
    let [y, z] = [1, 2].map(|k| cos * m[(1, k)] - sin * m[(0, k)]);
    Vector3::new((-z).atan2(y), pitch, yaw)
}

pub(super) fn spaced(vector: &Vector3<f64>) -> String {
    // No negative zero.
    let [x, y, z] = vector.map(|entry| entry + 0.0).into();
    format!("{x} {y} {z}")
}

pub(super) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            _ => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    /// Products of turns whose pitch is a quarter turn or near it, by nalgebra's own composition.
    #[test]
    fn angles_give_the_rotation_again() {
        for offset in [0.0, 1e-16, 1e-12, 1e-8, 1e-4, 0.3] {
            for sign in [-1.0, 1.0] {
                let rotation = Rotation3::from_euler_angles(0.4, 0.0, -0.8)
                    * Rotation3::from_euler_angles(0.0, sign * (FRAC_PI_2 - offset), 0.0)
                    * Rotation3::from_euler_angles(-1.1, 0.0, 0.0);
                let rotation = Rotation3::from_euler_angles(0.0, 0.0, 0.7) * rotation;
                let found = roll_pitch_yaw(&rotation);
                let again = Rotation3::from_euler_angles(found.x, found.y, found.z);
                let miss = (again.matrix() - rotation.matrix()).norm();
                assert!(miss < 1e-14, "{offset:e} {sign}: {miss:e}");
            }
        }
    }
}
