//! Clearances of robots that come with the program, with shapes made for these tests.

use nalgebra::{Rotation3, UnitQuaternion, Vector3};

use super::Random;
use crate::clearance::{Anchor, Bodies, Overlap, Owner, Solid};
use crate::kinematics::Outward;
use crate::lanes::{LaneWork, Lanes, Width};
use crate::robot::{Robot, Shape};
use crate::so3::{Quat, exp};
use crate::vec3::Vec3;

fn capsule(a: [f64; 3], b: [f64; 3], radius: f64) -> Shape {
    Shape::Capsule { ends: [a.into(), b.into()], radius }
}

fn cuboid(centre: [f64; 3], half: [f64; 3], turn: [f64; 3]) -> Shape {
    let rotation = Rotation3::from_scaled_axis(turn.into());
    Shape::Cuboid { centre: centre.into(), half: half.into(), rotation }
}

/// A bus and a panel on the base, and capsules and boxes along the links.
fn clad(name: &str) -> Robot {
    let bare = Robot::from_document(&Robot::embedded(name).unwrap()).unwrap();
    let mut base = bare.base().clone();
    base.shapes = vec![
        cuboid([0.0; 3], [0.4, 0.4, 0.35], [0.0; 3]),
        cuboid([0.0, 1.6, 0.1], [0.5, 1.0, 0.01], [0.1, 0.3, 0.0]),
    ];
    let mut links = bare.links().to_vec();
    for i in 0..links.len() {
        let next = links.iter().find(|link| link.parent == Some(i));
        let end = next.map_or(2.0 * links[i].centre_of_mass, |next| *next.placement.translation());
        links[i].body.shapes = if i % 3 == 2 {
            let half = (end / 2.0).abs().add_scalar(0.04);
            vec![Shape::Cuboid { centre: end / 2.0, half, rotation: Rotation3::identity() }]
        } else {
            vec![Shape::Capsule { ends: [Vector3::zeros(), end], radius: 0.05 }]
        };
    }
    Robot::new(name.to_owned(), base, links, bare.tool().clone()).unwrap()
}

fn solids() -> Vec<Solid> {
    let solid = |name: &str, shape, anchor| Solid { name: name.to_owned(), shape, anchor };
    vec![
        solid("antenna", capsule([0.3, -0.3, 0.4], [0.5, -0.5, 1.2], 0.05), Anchor::Base),
        solid(
            "target",
            cuboid([0.4, 0.3, 1.7], [0.3, 0.5, 0.3], [0.2, 0.5, 1.0]),
            Anchor::Inertial,
        ),
        solid("boom", capsule([-1.0, -0.4, 1.2], [0.5, -0.9, 0.8], 0.03), Anchor::Inertial),
    ]
}

fn all() -> [Bodies; 2] {
    ["xiao2023", "dual_arm"].map(|name| Bodies::new(&clad(name), solids(), &[]))
}

fn positions(robot: &Robot, random: &mut Random) -> Vec<f64> {
    let mut place = |[lower, upper]: [f64; 2]| {
        f64::midpoint(lower, upper) + random.within(0.5) * (upper - lower)
    };
    robot.joints().map(|joint| place(joint.range)).collect()
}

fn attitude(random: &mut Random) -> Quat<f64> {
    exp(Vec3::of(&random.vector(2.0)))
}

#[test]
fn slopes_agree_with_differences() {
    let mut random = Random::new(7);
    let (mut compared, mut bent) = (0, 0);
    for bodies in all() {
        for _ in 0..60 {
            let (at, turn) = (positions(&bodies.robot, &mut random), attitude(&mut random));
            let scene = bodies.at(&at, turn);
            let n = at.len();
            let along = |pair: usize, way: usize, step: f64| {
                let mut there = at.clone();
                let mut rotation = [0.0; 3];
                if way < n {
                    there[way] += step;
                } else {
                    rotation[way - n] = step;
                }
                let turned = turn.then(exp(Vec3::of(&rotation.into())));
                bodies.at(&there, turned).distance(pair)
            };
            for pair in 0..bodies.pairs().len() {
                let clearance = scene.clearance(pair);
                assert_eq!(clearance.distance, scene.distance(pair));
                let slopes = scene.slopes(&clearance);
                let rotation = slopes.rotation;
                let slopes = [slopes.positions, vec![rotation.x, rotation.y, rotation.z]].concat();
                for (way, slope) in slopes.into_iter().enumerate() {
                    let h = 1e-6;
                    let (up, down) = (along(pair, way, h), along(pair, way, -h));
                    // Where the closest points jump, slopes on both sides differ.
                    if (up + down - 2.0 * clearance.distance).abs() > 1e-10 {
                        bent += 1;
                        continue;
                    }
                    let difference = (up - down) / (2.0 * h);
                    let names = bodies.names(pair);
                    assert!(
                        (difference - slope).abs() < 2e-6,
                        "{names:?} by {way}: {difference} {slope} {clearance:?}"
                    );
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 50_000 && bent * 100 < compared, "{compared} {bent}");
}

/// What of several times is worked out in lanes.
struct Scan<'a> {
    bodies: &'a Bodies,
    positions: &'a [Vec<f64>],
    attitudes: &'a [Quat<f64>],
    far: f64,
}

impl LaneWork for Scan<'_> {
    type Output = Vec<Vec<f64>>;

    #[inline(always)]
    fn run<T: Lanes>(self) -> Self::Output {
        let mut found = Vec::new();
        let mut distances = vec![T::of(0.0); self.bodies.pairs().len()];
        for (at, turns) in
            self.positions.chunks_exact(T::COUNT).zip(self.attitudes.chunks_exact(T::COUNT))
        {
            let mut joints = vec![T::of(0.0); at[0].len()];
            for (i, joint) in joints.iter_mut().enumerate() {
                let mut numbers = [0.0; crate::lanes::MOST];
                for (number, at) in numbers.iter_mut().zip(at) {
                    *number = at[i];
                }
                *joint = T::load(&numbers);
            }
            self.bodies.scan_within(self.far, &joints, Quat::gather(turns), &mut distances);
            for lane in 0..T::COUNT {
                found.push(distances.iter().map(|d| d.numbers()[lane]).collect());
            }
        }
        found
    }
}

#[test]
fn lanes_agree() {
    let mut random = Random::new(8);
    for bodies in all() {
        let positions: Vec<_> = (0..48).map(|_| positions(&bodies.robot, &mut random)).collect();
        let attitudes: Vec<_> = (0..48).map(|_| attitude(&mut random)).collect();
        let mut vectors = Vec::new();
        for width in Width::available() {
            let (positions, attitudes) = (positions.as_slice(), attitudes.as_slice());
            let scan = |far| Scan { bodies: &bodies, positions, attitudes, far };
            let (found, within) = (width.run(scan(f64::INFINITY)), width.run(scan(0.2)));
            assert_eq!(found.len(), 48);
            for (found, within) in found.iter().flatten().zip(within.iter().flatten()) {
                let is_bound = (0.2..=found + 1e-12).contains(within);
                assert!(found == within || is_bound, "{width:?}: {found} {within}");
            }
            for ((found, at), turn) in found.iter().zip(positions).zip(attitudes) {
                for (a, b) in found.iter().zip(bodies.at(at, *turn).distances()) {
                    assert!((a - b).abs() < 1e-12, "{width:?}: {a} {b}");
                }
            }
            if width != Width::Scalar {
                vectors.push((found, within));
            }
        }
        // To the last bit, whatever is in the other lanes.
        assert!(vectors.windows(2).all(|two| two[0] == two[1]));
    }
}

/// Spheres about the links' origins and one in inertial axes, whose origin is the centre of mass.
#[test]
fn solids_in_inertial_axes_stay() {
    let bare = Robot::from_document(&Robot::embedded("xiao2023").unwrap()).unwrap();
    let mut links = bare.links().to_vec();
    links[3].body.shapes = vec![Shape::sphere(Vector3::new(0.1, 0.2, 0.3), 0.1)];
    let robot = Robot::new("one".to_owned(), bare.base().clone(), links, bare.tool().clone());
    let robot = robot.unwrap();
    let place = Vector3::new(0.5, 3.0, -1.0);
    let shape = Shape::sphere(place, 0.25);
    let solid = Solid { name: "ball".to_owned(), shape, anchor: Anchor::Inertial };
    let bodies = Bodies::new(&robot, vec![solid], &[]);
    assert!(bodies.needs_attitude());
    assert_eq!(bodies.pairs().len(), 1);
    let mut random = Random::new(4);
    for _ in 0..20 {
        let (at, turn) = (positions(&robot, &mut random), attitude(&mut random));
        let links: Vec<_> = Outward::<_>::new(&robot, &at).collect();
        let moment: Vector3<f64> =
            links.iter().map(|l| Vector3::from(l.centre_of_mass) * l.link.body.mass).sum();
        let frame = links[3].frame;
        let own = Vector3::from(frame.position + frame.rotation * Vec3::new(0.1, 0.2, 0.3));
        let turned = UnitQuaternion::from(turn) * (own - moment / robot.total_mass());
        let expected = (turned - place).norm() - 0.35;
        let found = bodies.least(&at, turn).unwrap();
        assert!((found.distance - expected).abs() < 1e-12, "{} {expected}", found.distance);
        assert_eq!(found.owners, [Owner::Link(3), Owner::Solid(0)]);
    }
}

/// The first three links of the paper's arm and the base, each with a small sphere far from the others', and one more on link 2 that
/// holds the origin of link 0.
#[test]
fn what_joints_connect_is_not_watched_nor_what_always_overlaps() {
    let bare = Robot::from_document(&Robot::embedded("xiao2023").unwrap()).unwrap();
    let mut links = bare.links().to_vec();
    let small = |x: f64| Shape::sphere(Vector3::new(x, 0.0, 0.0), 0.01);
    let mut base = bare.base().clone();
    base.shapes = vec![small(-9.0)];
    links[0].body.shapes = vec![small(5.0)];
    links[1].body.shapes = vec![small(-5.0)];
    links[2].body.shapes = vec![small(7.0), Shape::sphere(Vector3::zeros(), 20.0)];
    let robot = Robot::new("few".to_owned(), base, links, bare.tool().clone()).unwrap();
    let antenna = Solid { anchor: Anchor::Base, ..solids().remove(0) };
    let (base, link) = (Owner::Base, Owner::Link);
    let owners = |bodies: &Bodies| -> Vec<[Owner; 2]> {
        bodies.pairs().iter().map(|pair| pair.owners).collect()
    };
    let bodies = Bodies::new(&robot, vec![antenna.clone()], &[]);
    let solid = Owner::Solid(0);
    let expected = [
        [base, link(1)],
        [base, link(2)],
        [link(0), link(2)],
        [link(0), solid],
        [link(1), solid],
        [link(2), solid],
    ];
    assert_eq!(owners(&bodies), expected);
    assert!(!bodies.needs_attitude());
    let over = |owner| Overlap { owners: [owner, link(2)], shapes: [0, 1] };
    assert_eq!(bodies.overlaps(), [over(base), over(link(0))]);
    let names = robot.links().iter().map(|link| link.name.as_str()).collect::<Vec<_>>();
    assert_eq!(bodies.names(0), ["base", names[1]]);
    assert_eq!(bodies.names(3), [names[0], "antenna"]);

    let ignored = [[link(2), base], [solid, link(1)], [link(0), link(2)]];
    let bodies = Bodies::new(&robot, vec![antenna], &ignored);
    let expected = [[base, link(1)], [link(0), solid], [link(2), solid]];
    assert_eq!(owners(&bodies), expected);
    assert!(bodies.overlaps().is_empty());
}

/// The first links of both arms are fixed to the base.
#[test]
fn fixed_joints_make_one_body() {
    let bodies = &all()[1];
    let fixed = bodies.robot.links().iter().position(|link| link.name == "left_iiwa_link_0");
    let fixed = Owner::Link(fixed.unwrap());
    let of_base = |pair: usize| bodies.names(pair).contains(&"base");
    assert!(bodies.pairs().iter().all(|pair| !pair.owners.contains(&fixed)));
    assert!((0..bodies.pairs().len()).any(of_base));
    let seen = (0..200).any(|seed| {
        let mut random = Random::new(seed);
        let at = positions(&bodies.robot, &mut random);
        let scene = bodies.at(&at, Quat::identity());
        (0..bodies.pairs().len()).any(|pair| scene.clearance(pair).owners.contains(&fixed))
    });
    assert!(seen, "the fixed link is never the closest of the base");
}
