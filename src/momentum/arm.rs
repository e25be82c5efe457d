//! The base's angular velocity alone, the inner loop of everything: one inward sweep.

use super::RigidBody;
use crate::lanes::{Block, Lanes};
use crate::scalar::Scalar;
use crate::vec3::{Sym3, Vec3};
use nalgebra::{UnitQuaternion, Vector3};

/// A robot, made ready to give the base's angular velocity with few operations.
///
/// All that is outward of a joint moves as one body when that joint moves. So the sweep goes from the
/// tips inward and takes with it mass, first moment, inertia and momentum of what lies outward, about
/// the joint it has come to. Between two axes there is always a Denavit–Hartenberg step: the way
/// between the frames of two joints is a turn about `x`, a step along `x` and `z`, and a turn about `z`.
/// Whatever does not depend on positions is summed once: fixed links are part of those that carry them.
#[derive(Debug, Clone)]
pub struct Arm {
    /// Each directly before the first of its children; the children's own follow one after the other.
    pub(super) links: Vec<ArmLink>,
    /// Base, about the mount in the axes of the mount; its mass is that of the whole system.
    pub(super) base: RigidBody<f64>,
    /// What hangs on the base beside the first link.
    pub(super) branches: Vec<Branch>,
    /// How many branches there are.
    pub(super) branch_count: usize,
    /// Whether it is a chain of joints that turn, without any bend.
    pub(super) is_plain: bool,
    pub(super) mount: UnitQuaternion<f64>,
}

/// What of a link no configuration changes, in its joint's frame turned by the offset.
#[derive(Debug, Clone)]
pub struct ArmLink {
    /// Which of the joints that move carries it.
    pub(super) joint: usize,
    pub(super) motion: Motion,
    /// The way to the first child's joint.
    pub(super) way: Way,
    /// All children but the first.
    pub(super) branches: Vec<Branch>,
    /// The link itself and the mass of all outward of it, as if gathered at the next joints. Its mass is
    /// that of both.
    pub(super) body: RigidBody<f64>,
    /// Where a branch begins with this link, its place among branches.
    pub(super) branch: Option<usize>,
}

/// How a link moves, and the constant turn about its axis that the way to its first child needs.
#[derive(Debug, Clone, Copy)]
pub(super) enum Motion {
    /// The turn \[rad\] is part of the angle.
    Turn(f64),
    /// Sine and cosine of the turn.
    Slide((f64, f64)),
}

/// The constant way from a link's frame to the frame of a joint on it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way {
    /// Steps along `x` and `z` \[m\].
    pub(super) step: [f64; 2],
    /// Sine and cosine of a turn about `z` after the step, which only axes that are nearly parallel need.
    pub(super) bend: Option<(f64, f64)>,
    /// The last turn, about `x`.
    pub(super) twist: AxisTurn,
}

/// A child that is not its parent's first.
#[derive(Debug, Clone, Copy)]
pub(super) struct Branch {
    /// Its place among the branches.
    pub(super) place: usize,
    /// Sine and cosine of the turn about `z` from the parent's frame to where the way begins.
    pub(super) turn: (f64, f64),
    pub(super) way: Way,
}

/// A turn about `x`. Most arms have nothing but quarter turns, which take no products.
#[derive(Debug, Clone, Copy)]
pub(super) enum AxisTurn {
    None,
    Quarter,
    Half,
    ThreeQuarters,
    Any { sin: f64, cos: f64 },
}

impl AxisTurn {
    pub(super) fn new((sin, cos): (f64, f64)) -> Self {
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

/// What the sweep has to know of a joint, one configuration per lane.
#[derive(Debug, Clone, Copy, Default)]
pub struct JointState([Block; 3]);

impl JointState {
    #[inline(always)]
    fn load<T: Lanes>(&self) -> [T; 3] {
        let [a, b, c] = &self.0;
        [T::load(&a.0), T::load(&b.0), T::load(&c.0)]
    }

    /// Takes over what [`ArmLink::state`] gives.
    #[inline(always)]
    pub fn store<T: Lanes>(&mut self, [x, y, z]: [T; 3]) {
        let [a, b, c] = &mut self.0;
        x.store(&mut a.0);
        y.store(&mut b.0);
        z.store(&mut c.0);
    }
}

/// What lies outward of a joint the sweep has come to; of nothing at first.
///
/// Mass is left out: it is a constant, and what follows from it is in [`ArmLink`].
#[derive(Debug, Clone, Copy)]
struct Outer<T> {
    first_moment: Vec3<T>,
    inertia: Sym3<T>,
    linear: Vec3<T>,
    angular: Vec3<T>,
}

impl Arm {
    /// Turns vectors along the mount's axes into base axes.
    pub fn mount(&self) -> UnitQuaternion<f64> {
        self.mount
    }

    /// The links that joints move, in the order of the sweep's states.
    pub fn links(&self) -> &[ArmLink] {
        &self.links
    }

    /// Whether it is a chain of joints that turn, which [`base_rate`](Self::base_rate) goes through with
    /// fewer operations.
    pub fn is_plain(&self) -> bool {
        self.is_plain
    }

    /// The base's angular velocity \[rad/s\] **along the mount's axes** with zero total momentum, from
    /// the states of all links. `PLAIN` only if the arm [is](Self::is_plain).
    #[inline(always)]
    pub fn base_rate<T: Lanes, const PLAIN: bool>(&self, states: &[JointState]) -> Vec3<T> {
        let outer = if PLAIN { self.chain(states) } else { self.tree(states) };
        let Outer { first_moment, inertia, linear, angular } = outer;
        let mut system = RigidBody { mass: self.base.mass, first_moment, inertia };
        system.first_moment += self.base.first_moment.lift();
        system.inertia += self.base.inertia.lift();
        let (centre, inertia) = system.about_centre();
        let (adjugate, determinant) = inertia.adjugate();
        (adjugate * (centre.cross(linear) - angular)) * (T::of(1.0) / determinant)
    }

    /// All that is outward of the base, of a chain of joints that turn.
    #[inline(always)]
    fn chain<T: Lanes>(&self, states: &[JointState]) -> Outer<T> {
        let mut outer = Outer::nothing();
        for (link, state) in self.links.iter().zip(states).rev() {
            let [sin, cos, rate] = state.load();
            outer = outer.about_x(link.way.twist).stepped(link.way.step);
            outer = outer.with(&link.body).driven(rate).about_z(sin, cos);
        }
        outer
    }

    /// The same of any tree.
    #[inline(always)]
    fn tree<T: Lanes>(&self, states: &[JointState]) -> Outer<T> {
        let mut branches = vec![Outer::nothing(); self.branch_count];
        let mut outer = Outer::nothing();
        for (link, state) in self.links.iter().zip(states).rev() {
            outer = link.inward(outer, state.load(), &branches);
            if let Some(place) = link.branch {
                branches[place] = outer;
                outer = Outer::nothing();
            }
        }
        for branch in &self.branches {
            outer.add(branch.gathered(&branches));
        }
        outer
    }

    /// The base's angular velocity \[rad/s\] in base axes with zero total momentum, at joint positions
    /// \[rad or m\] and rates \[rad/s or m/s\].
    ///
    /// # Panics
    ///
    /// Panics when there are fewer positions or rates than joints that move.
    pub fn base_rate_at(&self, positions: &[f64], rates: &[f64]) -> Vector3<f64> {
        let states = self.links.iter().map(|link| {
            let mut state = JointState::default();
            state.store(link.state(positions[link.joint], rates[link.joint]));
            state
        });
        let states: Vec<_> = states.collect();
        self.mount * Vector3::from(self.base_rate::<f64, false>(&states))
    }
}

impl ArmLink {
    /// Which of the joints that move carries the link.
    pub fn joint(&self) -> usize {
        self.joint
    }

    /// What the sweep has to know of the link's joint at a position \[rad or m\] and a rate: sine and
    /// cosine of an angle with its offset, or a distance; and the rate.
    #[inline(always)]
    pub fn state<T: Scalar>(&self, position: T, rate: T) -> [T; 3] {
        match self.motion {
            Motion::Turn(offset) => {
                let (sin, cos) = (position + T::of(offset)).sin_cos();
                [sin, cos, rate]
            }
            Motion::Slide(_) => [position, T::of(0.0), rate],
        }
    }

    /// The sweep's next: what lies outward of this link's joint, given what lies outward of its first
    /// child's, and the joint's state.
    #[inline(always)]
    fn inward<T: Scalar>(
        &self,
        outer: Outer<T>,
        [first, second, rate]: [T; 3],
        branches: &[Outer<T>],
    ) -> Outer<T> {
        let mut outer = outer.along(&self.way);
        for branch in &self.branches {
            outer.add(branch.gathered(branches));
        }
        let outer = outer.with(&self.body);
        match self.motion {
            Motion::Turn(_) => outer.driven(rate).about_z(first, second),
            Motion::Slide((sin, cos)) => {
                let outer = outer.pushed(rate, self.body.mass).about_z(T::of(sin), T::of(cos));
                outer.slid(first, self.body.mass)
            }
        }
    }
}

impl Branch {
    /// What lies outward of the branch, in the parent's frame.
    #[inline(always)]
    fn gathered<T: Scalar>(&self, branches: &[Outer<T>]) -> Outer<T> {
        let (sin, cos) = self.turn;
        branches[self.place].along(&self.way).about_z(T::of(sin), T::of(cos))
    }
}

impl<T: Scalar> Outer<T> {
    /// Nothing.
    #[inline(always)]
    fn nothing() -> Self {
        let zero = Vec3::zero();
        Self { first_moment: zero, inertia: Sym3::zero(), linear: zero, angular: zero }
    }

    #[inline(always)]
    fn add(&mut self, other: Self) {
        self.first_moment += other.first_moment;
        self.inertia += other.inertia;
        self.linear += other.linear;
        self.angular += other.angular;
    }

    /// With a body that does not move against what it is added to.
    #[inline(always)]
    fn with(mut self, body: &RigidBody<f64>) -> Self {
        self.first_moment += body.first_moment.lift();
        self.inertia += body.inertia.lift();
        self
    }

    /// From a joint's frame back along the way to it.
    #[inline(always)]
    fn along(self, way: &Way) -> Self {
        let turned = self.about_x(way.twist);
        let turned = match way.bend {
            None => turned,
            Some((sin, cos)) => turned.about_z(T::of(sin), T::of(cos)),
        };
        turned.stepped(way.step)
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

impl<T: Scalar> Outer<T> {
    /// With the momentum of a rate along `z` of all that lies outward, whose mass this is.
    #[inline(always)]
    fn pushed(self, rate: T, mass: f64) -> Self {
        let (h, p, l) = (self.first_moment, self.linear, self.angular);
        Self {
            linear: Vec3::new(p.x, p.y, rate.mul_add(T::of(mass), p.z)),
            angular: Vec3::new(h.y.mul_add(rate, l.x), h.x.mul_sub_from(rate, l.y), l.z),
            ..self
        }
    }

    /// About an origin from which this one is a distance along `z` away.
    #[inline(always)]
    fn slid(self, z: T, mass: f64) -> Self {
        let (h, p, l) = (self.first_moment, self.linear, self.angular);
        let moment = z * T::of(mass);
        let both = z * (h.z + h.z + moment);
        let Sym3 { diagonal: d, beside: b } = self.inertia;
        Self {
            first_moment: Vec3::new(h.x, h.y, h.z + moment),
            inertia: Sym3 {
                diagonal: Vec3::new(d.x + both, d.y + both, d.z),
                beside: Vec3::new(z.mul_sub_from(h.y, b.x), z.mul_sub_from(h.x, b.y), b.z),
            },
            linear: p,
            angular: Vec3::new(z.mul_sub_from(p.y, l.x), z.mul_add(p.x, l.y), l.z),
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
