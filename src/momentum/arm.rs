//! The base's angular velocity alone, the inner loop of everything: one inward sweep.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::RigidBody;
use crate::robot::{Joint, Robot};
use crate::scalar::Scalar;
use crate::vec3::{Sym3, Vec3};

/// A robot, made ready to give the base's angular velocity with few operations.
///
/// All that is outward of a joint moves as one body when that joint turns. So the sweep goes from the
/// tool inward and takes with it mass, first moment, inertia and momentum of what lies outward, about
/// the joint it has come to. It works in the frames that the DH rows turn: one way between two of them
/// is a turn about `x`, a step along `x` and `z`, and a turn about `z`. Whatever does not depend on
/// angles is summed here, once.
#[derive(Debug, Clone)]
pub struct Arm {
    links: Vec<ArmLink>,
    /// Base, about the mount in the axes of the mount; its mass is that of the whole system.
    base: RigidBody<f64>,
    mount: UnitQuaternion<f64>,
}

/// What of a link no configuration changes, in its proximal frame turned by the DH offset.
#[derive(Debug, Clone)]
pub struct ArmLink {
    /// The DH offset \[rad\].
    offset: f64,
    twist: AxisTurn,
    /// The DH steps along `x` and `z` to the next joint \[m\].
    step: [f64; 2],
    /// The link itself and the mass of all outward of it, as if gathered at the next joint.
    body: RigidBody<f64>,
}

/// The DH twist. Most arms have nothing but quarter turns, which take no products.
#[derive(Debug, Clone, Copy)]
enum AxisTurn {
    None,
    Quarter,
    Half,
    ThreeQuarters,
    Any { sin: f64, cos: f64 },
}

impl AxisTurn {
    fn new((sin, cos): (f64, f64)) -> Self {
        // What is left of a right angle's cosine.
        let is = |value: f64, whole: f64| (value - whole).abs() < 1e-15;
        match (sin, cos) {
            (s, c) if is(s, 0.0) && is(c, 1.0) => Self::None,
            (s, c) if is(s, 1.0) && is(c, 0.0) => Self::Quarter,
            (s, c) if is(s, 0.0) && is(c, -1.0) => Self::Half,
            (s, c) if is(s, -1.0) && is(c, 0.0) => Self::ThreeQuarters,
            (sin, cos) => Self::Any { sin, cos },
        }
    }
}

/// What lies outward of a joint the sweep has come to; of nothing at first.
///
/// Mass is left out: it is a constant, and what follows from it is in [`ArmLink`].
#[derive(Debug, Clone, Copy)]
pub struct Outer<T> {
    first_moment: Vec3<T>,
    inertia: Sym3<T>,
    linear: Vec3<T>,
    angular: Vec3<T>,
}

impl Arm {
    /// From a robot.
    pub fn new(robot: &Robot) -> Self {
        let mut outer_mass = 0.0;
        let mut links: Vec<_> = robot
            .joints
            .iter()
            .rev()
            .map(|joint| {
                let link = ArmLink::new(joint, outer_mass);
                outer_mass += joint.link.mass;
                link
            })
            .collect();
        links.reverse();
        let mount = robot.mount_rotation;
        let base =
            body(robot.base.mass, mount.inverse() * -robot.mount, &robot.base.inertia, &mount);
        let base = RigidBody { mass: base.mass + outer_mass, ..base };
        Self { links, base, mount: UnitQuaternion::from_rotation_matrix(&mount) }
    }

    /// Turns vectors along the mount's axes into base axes.
    pub fn mount(&self) -> UnitQuaternion<f64> {
        self.mount
    }

    /// The links, from the base outward; a sweep takes them the other way round.
    pub fn links(&self) -> &[ArmLink] {
        &self.links
    }

    /// The base's angular velocity \[rad/s\] **along the mount's axes** with zero total momentum, where
    /// the whole arm lies outward.
    #[inline(always)]
    pub fn base_rate<T: Scalar>(&self, arm: Outer<T>) -> Vec3<T> {
        let Outer { first_moment, inertia, linear, angular } = arm;
        let mut system = RigidBody { mass: self.base.mass, first_moment, inertia };
        system.first_moment += self.base.first_moment.lift();
        system.inertia += self.base.inertia.lift();
        let (centre, (adjugate, determinant)) = system.about_centre();
        (adjugate * (centre.cross(linear) - angular)) * (T::of(1.0) / determinant)
    }
}

impl ArmLink {
    /// The DH offset \[rad\].
    pub fn offset(&self) -> f64 {
        self.offset
    }

    /// The sweep's next: what lies outward of this link's joint, given what lies outward of the next one,
    /// sine and cosine of the joint's angle with its offset, and its rate \[rad/s\].
    #[inline(always)]
    pub fn inward<T: Scalar>(&self, outer: Outer<T>, (sin, cos): (T, T), rate: T) -> Outer<T> {
        let mut outer = outer.about_x(self.twist).stepped(self.step);
        outer.first_moment += self.body.first_moment.lift();
        outer.inertia += self.body.inertia.lift();
        outer.driven(rate).about_z(sin, cos)
    }

    fn new(joint: &Joint, outer_mass: f64) -> Self {
        let (sin, cos) = joint.dh.offset;
        let offset = sin.atan2(cos);
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), offset);
        let step = turn.inverse() * joint.dh.step;
        let mut link = body(
            joint.link.mass,
            turn.inverse() * joint.centre_of_mass,
            &joint.link.inertia,
            &turn,
        );
        let next = Vec3::of(&Vector3::new(step.x, 0.0, step.z));
        link.first_moment += next * outer_mass;
        link.inertia += Sym3::point(next, next * outer_mass);
        Self { offset, twist: AxisTurn::new(joint.dh.twist), step: [step.x, step.z], body: link }
    }
}

/// A body about the origin of a frame, given its centre of mass in that frame and its inertia about
/// it in axes that `turn` turns the frame's into.
fn body(
    mass: f64,
    centre: Vector3<f64>,
    inertia: &Matrix3<f64>,
    turn: &Rotation3<f64>,
) -> RigidBody<f64> {
    let centre = Vec3::of(&centre);
    let first_moment = centre * mass;
    let own = turn.matrix().transpose() * inertia * turn.matrix();
    let mut inertia = Sym3::of(&own);
    inertia += Sym3::point(centre, first_moment);
    RigidBody { mass, first_moment, inertia }
}

impl<T: Scalar> Outer<T> {
    /// Nothing.
    #[inline(always)]
    pub fn nothing() -> Self {
        let zero = Vec3::zero();
        Self { first_moment: zero, inertia: Sym3::zero(), linear: zero, angular: zero }
    }

    /// From axes that are turned about `x` into those they are turned from.
    #[inline(always)]
    fn about_x(self, twist: AxisTurn) -> Self {
        match twist {
            AxisTurn::None => self,
            AxisTurn::Quarter => self.quarter_about_x(),
            AxisTurn::Half => self.quarter_about_x().quarter_about_x(),
            AxisTurn::ThreeQuarters => self.quarter_about_x().quarter_about_x().quarter_about_x(),
            AxisTurn::Any { sin, cos } => self.any_about_x(T::of(sin), T::of(cos)),
        }
    }

    #[inline(always)]
    fn quarter_about_x(self) -> Self {
        let turn = |v: Vec3<T>| Vec3::new(v.x, -v.z, v.y);
        let Sym3 { diagonal: d, beside: b } = self.inertia;
        Self {
            first_moment: turn(self.first_moment),
            inertia: Sym3 {
                diagonal: Vec3::new(d.x, d.z, d.y),
                beside: Vec3::new(-b.x, b.z, -b.y),
            },
            linear: turn(self.linear),
            angular: turn(self.angular),
        }
    }

    #[inline(always)]
    fn any_about_x(self, sin: T, cos: T) -> Self {
        let turn =
            |v: Vec3<T>| Vec3::new(v.x, across(v.y, v.z, sin, cos), along(v.y, v.z, sin, cos));
        let Sym3 { diagonal: d, beside: b } = self.inertia;
        let [yy, zz, yz] = turned([d.y, d.z, b.x], sin, cos);
        Self {
            first_moment: turn(self.first_moment),
            inertia: Sym3 {
                diagonal: Vec3::new(d.x, yy, zz),
                beside: Vec3::new(yz, along(b.z, b.y, sin, cos), across(b.z, b.y, sin, cos)),
            },
            linear: turn(self.linear),
            angular: turn(self.angular),
        }
    }

    /// The same about `z`.
    #[inline(always)]
    fn about_z(self, sin: T, cos: T) -> Self {
        let turn =
            |v: Vec3<T>| Vec3::new(across(v.x, v.y, sin, cos), along(v.x, v.y, sin, cos), v.z);
        let Sym3 { diagonal: d, beside: b } = self.inertia;
        let [xx, yy, xy] = turned([d.x, d.y, b.z], sin, cos);
        Self {
            first_moment: turn(self.first_moment),
            inertia: Sym3 {
                diagonal: Vec3::new(xx, yy, d.z),
                beside: Vec3::new(along(b.y, b.x, sin, cos), across(b.y, b.x, sin, cos), xy),
            },
            linear: turn(self.linear),
            angular: turn(self.angular),
        }
    }

    /// About an origin from which this one is steps along `x` and `z` away; what the steps make of the
    /// mass alone is a constant of the link.
    #[inline(always)]
    fn stepped(self, [x, z]: [f64; 2]) -> Self {
        let (x, z) = (T::of(x), T::of(z));
        let (h, p) = (self.first_moment, self.linear);
        let (twice_x, twice_z) = (x + x, z + z);
        let Sym3 { diagonal: d, beside: b } = self.inertia;
        let inertia = Sym3 {
            diagonal: Vec3::new(
                twice_z.mul_add(h.z, d.x),
                twice_x.mul_add(h.x, twice_z.mul_add(h.z, d.y)),
                twice_x.mul_add(h.x, d.z),
            ),
            beside: Vec3::new(
                z.mul_sub_from(h.y, b.x),
                x.mul_sub_from(h.z, z.mul_sub_from(h.x, b.y)),
                x.mul_sub_from(h.y, b.z),
            ),
        };
        let l = self.angular;
        let angular = Vec3::new(
            z.mul_sub_from(p.y, l.x),
            x.mul_sub_from(p.z, z.mul_add(p.x, l.y)),
            x.mul_add(p.y, l.z),
        );
        Self { inertia, angular, ..self }
    }

    /// With the momentum of a rate about `z`.
    #[inline(always)]
    fn driven(self, rate: T) -> Self {
        let (h, Sym3 { diagonal: d, beside: b }) = (self.first_moment, self.inertia);
        let p = self.linear;
        Self {
            linear: Vec3::new(h.y.mul_sub_from(rate, p.x), h.x.mul_add(rate, p.y), p.z),
            angular: Vec3::new(b.y, b.x, d.z).mul_add(rate, self.angular),
            ..self
        }
    }
}

/// Three entries `[aa, bb, ab]` of a symmetric matrix after a turn from `a` to `b`.
#[inline(always)]
fn turned<T: Scalar>([aa, bb, ab]: [T; 3], sin: T, cos: T) -> [T; 3] {
    let shift = along(aa - bb, ab + ab, sin, cos);
    [sin.mul_sub_from(shift, aa), sin.mul_add(shift, bb), cos.mul_add(shift, -ab)]
}

/// The first component of a turned vector.
#[inline(always)]
fn across<T: Scalar>(a: T, b: T, sin: T, cos: T) -> T {
    sin.mul_sub_from(b, cos * a)
}

/// The second.
#[inline(always)]
fn along<T: Scalar>(a: T, b: T, sin: T, cos: T) -> T {
    sin.mul_add(a, cos * b)
}
