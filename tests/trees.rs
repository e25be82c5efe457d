//! Trees of links with branches, joints that turn, slide and are fixed: against Pinocchio
//! (`reference/trees.json`, made by `reference/make_trees.py`), and one way of going through them against
//! another.

use crate::drawn::{self, Tree};
use driftless::kinematics::tool;
use driftless::momentum::{
    Arm, RateSlopes, base_map, base_twist, generalised_jacobian, total_momentum,
};
use driftless::robot::{Axis, Body, Joint, Link, Placement, Robot, Tool};
use nalgebra::{DMatrix, Matrix3, Rotation3, Unit, Vector3};
use proptest::prelude::*;
use serde::Deserialize;

#[derive(Deserialize)]
struct Case {
    #[serde(flatten)]
    tree: Tree,
    positions: Vec<f64>,
    rates: Vec<f64>,
    base_twist: [f64; 6],
    base_map: Vec<Vec<f64>>,
    generalised_jacobian: Vec<Vec<f64>>,
    tool_position: [f64; 3],
    tool_rotation: Vec<Vec<f64>>,
    /// One row per joint.
    rate_by_position: Vec<[f64; 3]>,
}

impl Case {
    fn robot(&self) -> Robot {
        self.tree.robot()
    }
}

fn reference() -> Vec<Case> {
    drawn::trees()
}

/// To 1e-12 of the largest of the values, or of one.
fn assert_same(what: &str, ours: &[f64], theirs: &[f64]) {
    assert_eq!(ours.len(), theirs.len(), "{what}");
    let size = theirs.iter().fold(1.0_f64, |size, value| size.max(value.abs()));
    for (a, b) in ours.iter().zip(theirs) {
        assert!((a - b).abs() < 1e-12 * size, "{what}: {a} {b}, of {size}");
    }
}

fn columns(rows: &[Vec<f64>]) -> Vec<f64> {
    DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j]).as_slice().to_vec()
}

#[test]
fn the_reference_has_trees_of_all_sorts() {
    let trees = reference();
    assert!(trees.len() >= 60);
    let robots: Vec<Robot> = trees.iter().map(Case::robot).collect();
    for count in 1..=14 {
        assert!(robots.iter().any(|robot| robot.joint_count() == count), "{count} joints");
    }
    let has = |sort: fn(usize, &Link) -> bool| {
        let sorts = |robot: &&Robot| robot.links().iter().enumerate().any(|(i, l)| sort(i, l));
        robots.iter().filter(sorts).count()
    };
    assert!(has(|_, link| link.joint == Joint::Fixed) > 20);
    assert!(has(|_, link| matches!(link.joint, Joint::Prismatic(_))) > 20);
    assert!(has(|i, link| link.parent != i.checked_sub(1)) > 20);
}

#[test]
fn kinematics_and_momentum_are_pinocchios() {
    for (i, tree) in reference().iter().enumerate() {
        let (robot, q, rates) = (tree.robot(), &tree.positions, &tree.rates);
        let pose = tool(&robot, q);
        assert_same("tool", &<[f64; 3]>::from(Vector3::from(pose.position)), &tree.tool_position);
        let rotation = Matrix3::from(pose.rotation);
        assert_same("tool's axes", rotation.as_slice(), &columns(&tree.tool_rotation));
        let map = base_map(&robot, q);
        assert_same(&format!("J_bm of {i}"), map.as_slice(), &columns(&tree.base_map));
        let jacobian = generalised_jacobian(&robot, q);
        assert_same("J_g", jacobian.as_slice(), &columns(&tree.generalised_jacobian));
        let twist = base_twist(&robot, q, rates);
        let [v, w] = [twist.linear, twist.angular].map(Vector3::from);
        assert_same("base twist", &[v.x, v.y, v.z, w.x, w.y, w.z], &tree.base_twist);
    }
}

/// In units of what the links alone have.
#[test]
fn momentum_is_zero() {
    for tree in reference() {
        let (robot, q, rates) = (tree.robot(), &tree.positions, &tree.rates);
        let twist = base_twist(&robot, q, rates);
        let size = 1.0 + robot.total_mass();
        let (linear, angular) = total_momentum(&robot, q, rates, &twist);
        for part in [linear, angular].map(Vector3::from) {
            assert!(part.norm() < 1e-12 * size, "{part} of {size}");
        }
    }
}

#[test]
fn the_fast_sweep_is_pinocchios() {
    for (i, tree) in reference().iter().enumerate() {
        let rate = Arm::new(&tree.robot()).base_rate_at(&tree.positions, &tree.rates);
        assert_same(&format!("rate of {i}"), rate.as_slice(), &tree.base_twist[3..]);
    }
}

#[test]
fn slopes_are_those_of_many_digits() {
    for tree in reference() {
        let robot = tree.robot();
        let mut slopes = RateSlopes::new(&robot);
        slopes.evaluate(&robot, &tree.positions, &tree.rates);
        assert_same("rate", Vector3::from(slopes.angular).as_slice(), &tree.base_twist[3..]);
        let flat = |rows: &[driftless::vec3::Vec3<f64>]| -> Vec<f64> {
            rows.iter().flat_map(|row| [row.x, row.y, row.z]).collect()
        };
        assert_same("by position", &flat(&slopes.by_position), &tree.rate_by_position.concat());
        let angular: Vec<Vec<f64>> = tree.base_map[3..].to_vec();
        assert_same("by rate", &flat(&slopes.by_rate), &columns(&angular));
    }
}

/// Thirteen numbers from −1 to 1 per link.
fn rows() -> impl Strategy<Value = Vec<[f64; 13]>> {
    prop::collection::vec(prop::array::uniform13(-1.0..1.0), 1..16)
}

/// A tree of any shape. Axes and placements are general, parallel, nearly parallel or at right angles.
fn tree(rows: &[[f64; 13]]) -> Robot {
    let links = rows.iter().enumerate().map(|(i, r)| {
        let turn = Vector3::new(r[0], r[1], r[2]);
        let turn = match (r[3] * 4.0) as i32 {
            0 => Vector3::zeros(),
            1 => Vector3::x() * std::f64::consts::FRAC_PI_2,
            2 => turn * 1e-7,
            3 => turn * 0.05,
            _ => turn * 3.0,
        };
        let direction = if r[4] > 0.0 {
            Vector3::z_axis()
        } else {
            Unit::new_normalize(Vector3::new(r[5], r[6], r[7] + 1.5 * r[7].signum()))
        };
        let axis = Axis::new(format!("joint{i}"), direction, [-4.0, 4.0]);
        let mass = 6.0 + 5.0 * r[8];
        Link {
            name: String::new(),
            parent: if r[9] > 0.3 { (i as f64 * (r[9] - 0.3)) as usize } else { i }.checked_sub(1),
            placement: Placement::new(
                Vector3::new(r[10], r[11], r[12]),
                Rotation3::from_scaled_axis(turn),
            ),
            joint: match ((r[8] + 1.0) * 50.0) as i32 % 5 {
                0 if i > 0 => Joint::Fixed,
                1 => Joint::Prismatic(axis),
                _ => Joint::Revolute(axis),
            },
            body: Body::new(mass, Matrix3::from_diagonal_element(0.2 * mass)),
            centre_of_mass: Vector3::new(r[5], r[6], r[7]) * 0.3,
        }
    });
    let base = Body::new(80.0, Matrix3::new(9.0, 0.3, -0.2, 0.3, 11.0, 0.4, -0.2, 0.4, 7.0));
    let tool = Tool { link: None, placement: Placement::identity() };
    Robot::new("drawn".to_owned(), base, links.collect(), tool).unwrap()
}

fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(cases(400))]

    /// The inward sweep of the fitness against the outward one.
    #[test]
    fn both_sweeps_give_the_same_rate(
        rows in rows(),
        positions in prop::collection::vec(-2.0..2.0, 16),
        rates in prop::collection::vec(-2.0..2.0, 16),
    ) {
        let robot = tree(&rows);
        let n = robot.joint_count();
        let inward = Arm::new(&robot).base_rate_at(&positions[..n], &rates[..n]);
        let outward = Vector3::from(base_twist(&robot, &positions[..n], &rates[..n]).angular);
        let miss = (inward - outward).norm();
        prop_assert!(miss < 1e-12 * (1.0 + outward.norm()), "{miss:e}");
    }

    /// A Denavit–Hartenberg chain, and the same robot with a fixed link behind every joint that carries
    /// half of the link's mass and the rest of the row.
    #[test]
    fn fixed_links_make_no_difference(
        rows in prop::collection::vec(prop::array::uniform6(-1.0..1.0), 1..9),
        angles in prop::collection::vec(-3.0..3.0, 8),
        rates in prop::collection::vec(-2.0..2.0, 8),
    ) {
        let inertia = Matrix3::from_diagonal(&Vector3::new(0.5, 0.6, 0.4));
        let axis = Axis::new(String::new(), Vector3::z_axis(), [-3.0, 3.0]);
        let (mut chain, mut split) = (Vec::new(), Vec::new());
        let mut place = Placement::new(Vector3::new(0.4, -0.2, 0.3), Rotation3::from_euler_angles(0.3, -0.9, 1.2));
        for (i, [a, d, alpha, offset, x, y]) in rows.iter().enumerate() {
            let body = Body::new(5.0 + 4.0 * x, inertia);
            let half = Body::new(body.mass / 2.0, inertia / 2.0);
            let centre = Vector3::new(*x, *y, 0.1);
            let link = |parent, placement, joint, body, centre_of_mass| Link {
                name: String::new(), parent, placement, joint, body, centre_of_mass,
            };
            let joint = Joint::Revolute(axis.clone());
            chain.push(link(i.checked_sub(1), place.clone(), joint.clone(), body, centre));
            split.push(link((2 * i).checked_sub(1), if i == 0 { place.clone() } else { Placement::identity() }, joint, half.clone(), centre));
            place = Placement::dh(3.0 * offset, *d, *a, 3.0 * alpha);
            let back = place.isometry().inverse() * nalgebra::Point3::from(centre);
            let turn = place.rotation();
            let turned = turn.inverse().matrix() * half.inertia * turn.matrix();
            let half = Body { inertia: turned, ..half };
            split.push(link(Some(2 * i), place.clone(), Joint::Fixed, half, back.coords));
        }
        let base = Body::new(80.0, Matrix3::from_diagonal_element(9.0));
        let n = rows.len();
        let build = |links: Vec<Link>, placement| {
            let tool = Tool { link: links.len().checked_sub(1), placement };
            Robot::new("arm".to_owned(), base.clone(), links, tool).unwrap()
        };
        let (chain, split) = (build(chain, place), build(split, Placement::identity()));
        let (angles, rates) = (&angles[..n], &rates[..n]);
        let jacobians = [&chain, &split].map(|robot| generalised_jacobian(robot, angles));
        prop_assert!((&jacobians[0] - &jacobians[1]).amax() < 1e-12 * (1.0 + jacobians[0].amax()));
        let [a, b] = [&chain, &split].map(|robot| Arm::new(robot).base_rate_at(angles, rates));
        prop_assert!((a - b).norm() < 1e-12 * (1.0 + a.norm()), "{a} {b}");
        let [a, b] = [&chain, &split].map(|robot| tool(robot, angles));
        prop_assert!((Vector3::from(a.position) - Vector3::from(b.position)).norm() < 1e-13 * n as f64);
    }
}
