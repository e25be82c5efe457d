//! From a robot to the constants of the inward sweep.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::RigidBody;
use super::arm::{Arm, ArmLink, AxisTurn, Branch, Motion, Way};
use crate::robot::{Axis, Body, Joint, Rigid, Robot, Turns};
use crate::vec3::{Sym3, Vec3};

/// Where the sine of the angle between two axes is below this, their common normal is too far away to
/// step along it.
const NEARLY_PARALLEL: f64 = 0.1;

/// What a joint moves: its link, with the fixed links that it carries.
struct Mover<'a> {
    /// Index of the link.
    link: usize,
    /// Its mover; `None` for the base.
    parent: Option<usize>,
    joint: &'a Joint,
    step: Step,
    children: Vec<usize>,
}

/// The way between two axes, from a frame whose `z` is one to a frame whose `z` is the other.
#[derive(Debug, Clone, Copy)]
struct Step {
    /// A turn about the first axis, with which it begins \[rad\].
    begin: f64,
    way: Way,
    /// What it leaves over: a shift \[m\] and a turn \[rad\] along and about the second axis.
    rest: (f64, f64),
}

impl Step {
    fn none(begin: f64) -> Self {
        let way = Way { step: [0.0; 2], bend: None, twist: AxisTurn::None };
        Self { begin, way, rest: (0.0, 0.0) }
    }

    /// A Denavit–Hartenberg row, digit by digit.
    fn dh((sin, cos): (f64, f64), twist: (f64, f64), translation: &Vector3<f64>) -> Self {
        let begin = sin.atan2(cos);
        let step = about_z(begin).inverse() * translation;
        let way = Way { step: [step.x, step.z], bend: None, twist: AxisTurn::new(twist) };
        Self { begin, way, rest: (0.0, 0.0) }
    }

    /// Any transform. With the second axis `u` and its origin `t` in the first frame, the turn about `x`
    /// is that from `z` to `u`, about `z × u`.
    fn of(Rigid { translation: t, rotation }: &Rigid) -> Self {
        let u = rotation * Vector3::z();
        let (sin, cos) = (u.x.hypot(u.y), u.z);
        let along = t.y.atan2(t.x);
        let parallel = sin < 1e-15;
        // Parallel axes have many common normals, one of which goes through the origin.
        let normal = if parallel { along } else { u.x.atan2(-u.y) };
        let twist = Matrix3::new(1.0, 0.0, 0.0, 0.0, cos, -sin, 0.0, sin, cos);
        let left = (about_z(normal).matrix() * twist).transpose() * rotation.matrix();
        let turn = left[(1, 0)].atan2(left[(0, 0)]);
        let (begin, step, bend, shift) = if parallel {
            (along, [t.x.hypot(t.y), t.z], None, 0.0)
        } else if sin < NEARLY_PARALLEL {
            let bend = (normal - along).sin_cos();
            (along, [t.x.hypot(t.y), t.z], Some(bend), 0.0)
        } else {
            // t = a x + d z + s u, where u = cos z − sin y.
            let t = about_z(normal).inverse() * t;
            let shift = -t.y / sin;
            (normal, [t.x, t.z - shift * cos], None, shift)
        };
        let way = Way { step, bend, twist: AxisTurn::new((sin, cos)) };
        Self { begin, way, rest: (shift, turn) }
    }
}

fn about_z(angle: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector3::z_axis(), angle)
}

/// From a frame whose `z` is a joint's axis to the joint's own frame.
fn straightened(axis: &Axis) -> Rigid {
    if axis.is_z() {
        return Rigid::identity();
    }
    let z = Vector3::z();
    // Half a turn where the axis is −z.
    let rotation = Rotation3::rotation_between(&z, &axis.direction)
        .unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
    Rigid { translation: Vector3::zeros(), rotation: rotation.inverse() }
}

/// A robot taken apart: what moves as one, in frames whose `z` is the axis it is moved by.
struct Parts<'a> {
    robot: &'a Robot,
    movers: Vec<Mover<'a>>,
    /// For every link its mover, and its frame in that one's.
    carried: Vec<(Option<usize>, Rigid)>,
    /// The first joint's frame, in base axes.
    mount: Rigid,
    /// Movers that hang on the base.
    roots: Vec<usize>,
}

impl<'a> Parts<'a> {
    fn of(robot: &'a Robot) -> Self {
        let mut parts = Self {
            robot,
            movers: Vec::new(),
            carried: Vec::new(),
            mount: Rigid::identity(),
            roots: Vec::new(),
        };
        for (i, link) in robot.links().iter().enumerate() {
            let (parent, inner) =
                link.parent.map_or((None, Rigid::identity()), |parent| parts.carried[parent]);
            let joint = inner.then(&Rigid::of(&link.placement));
            let Some(axis) = link.joint.axis() else {
                parts.carried.push((parent, joint));
                continue;
            };
            let own = straightened(axis);
            let frame = joint.then(&own.inverse());
            let this = parts.movers.len();
            let step = parts.step_to(i, parent, &frame, axis);
            match parent {
                None => parts.roots.push(this),
                Some(parent) => parts.movers[parent].children.push(this),
            }
            let joint = &link.joint;
            parts.movers.push(Mover { link: i, parent, joint, step, children: Vec::new() });
            parts.carried.push((Some(this), own));
        }
        parts
    }

    /// The way to a link's joint from its mover's axis, or from the mount.
    fn step_to(&mut self, link: usize, parent: Option<usize>, frame: &Rigid, axis: &Axis) -> Step {
        let placement = &self.robot.links()[link].placement;
        match parent {
            None if self.roots.is_empty() => {
                self.mount = *frame;
                Step::none(0.0)
            }
            None => Step::of(&self.mount.inverse().then(frame)),
            Some(parent) => {
                let mover = &self.movers[parent];
                let is_direct = self.robot.links()[link].parent == Some(mover.link);
                match placement.turns() {
                    Turns::Dh { offset, twist }
                        if is_direct && axis.is_z() && mover.turns_about_z() =>
                    {
                        Step::dh(*offset, *twist, placement.translation())
                    }
                    _ => Step::of(frame),
                }
            }
        }
    }

    /// All movers, each directly followed by its first child and that one's own.
    fn order(&self) -> Vec<usize> {
        let mut order = Vec::with_capacity(self.movers.len());
        let mut waiting: Vec<usize> = self.roots.iter().rev().copied().collect();
        while let Some(mover) = waiting.pop() {
            order.push(mover);
            waiting.extend(self.movers[mover].children.iter().rev());
        }
        order
    }

    /// Of every mover and all outward of it \[kg\].
    fn masses(&self) -> Vec<f64> {
        let mut masses = vec![0.0; self.movers.len()];
        for (link, (mover, _)) in self.robot.links().iter().zip(&self.carried) {
            if let Some(mover) = mover {
                masses[*mover] += link.body.mass;
            }
        }
        for mover in (0..masses.len()).rev() {
            if let Some(parent) = self.movers[mover].parent {
                masses[parent] += masses[mover];
            }
        }
        masses
    }

    /// The turn about a mover's axis to where the way to its first child begins; a tip's is the tool's,
    /// where a Denavit–Hartenberg row says so.
    fn begin(&self, mover: &Mover<'_>) -> f64 {
        if let Some(&first) = mover.children.first() {
            return self.movers[first].step.begin;
        }
        let tool = self.robot.tool();
        match tool.placement.turns() {
            Turns::Dh { offset: (sin, cos), .. }
                if tool.link == Some(mover.link) && mover.turns_about_z() =>
            {
                sin.atan2(*cos)
            }
            _ => 0.0,
        }
    }

    /// The links that a mover carries, or the base, about the origin of its frame: `frame` from that to
    /// the frame in which the links' own stand.
    fn carried_by(&self, mover: Option<usize>, frame: &Rigid) -> Option<RigidBody<f64>> {
        let own = self.robot.links().iter().zip(&self.carried).filter(|(_, c)| c.0 == mover);
        let bodies = own.map(|(link, (_, inner))| {
            let inner = frame.then(inner);
            let centre = inner.translation + inner.rotation * link.centre_of_mass;
            body(link.body.mass, centre, &link.body.inertia, &inner.rotation.inverse())
        });
        bodies.reduce(|mut sum, body| {
            sum += body;
            sum
        })
    }
}

impl Mover<'_> {
    fn turns_about_z(&self) -> bool {
        self.joint.axis().is_some_and(Axis::is_z)
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

/// The sweep's links, while they are being made.
struct Assembly<'a> {
    parts: &'a Parts<'a>,
    /// Of every mover and all outward of it \[kg\].
    masses: Vec<f64>,
    /// For every mover that is not its parent's first child, its place among branches.
    branches: Vec<Option<usize>>,
}

impl<'a> Assembly<'a> {
    fn new(parts: &'a Parts<'a>) -> Self {
        let mut count = 0;
        let mut branches = vec![None; parts.movers.len()];
        let children = parts.movers.iter().map(|mover| &mover.children);
        for others in std::iter::once(&parts.roots).chain(children) {
            for &child in others.iter().skip(1) {
                branches[child] = Some(count);
                count += 1;
            }
        }
        Self { parts, masses: parts.masses(), branches }
    }

    /// A mover's link.
    fn link(&self, mover: usize) -> ArmLink {
        let parts = self.parts;
        let own = &parts.movers[mover];
        let (shift, rest) = own.step.rest;
        let begin = parts.begin(own);
        let turn = about_z(begin);
        // From the sweep's frame back to the one whose `z` is the axis.
        let frame = Rigid {
            translation: turn.inverse() * Vector3::new(0.0, 0.0, shift),
            rotation: turn.inverse(),
        };
        let mut body = parts.carried_by(Some(mover), &frame).unwrap_or_else(RigidBody::none);
        let mut way = Step::none(0.0).way;
        let mut branches = Vec::new();
        for &child in &own.children {
            let mut step = parts.movers[child].step;
            step.begin -= begin;
            step.way.step[1] += shift;
            gather(&mut body, &step, self.masses[child]);
            match self.branch(child, &step) {
                None => way = step.way,
                Some(branch) => branches.push(branch),
            }
        }
        body.mass = self.masses[mover];
        let offset = rest + begin;
        let motion = match own.joint {
            Joint::Prismatic(_) => Motion::Slide(offset.sin_cos()),
            _ => Motion::Turn(offset),
        };
        ArmLink { joint: mover, motion, way, branches, body, branch: self.branches[mover] }
    }

    fn branch(&self, mover: usize, step: &Step) -> Option<Branch> {
        let branch = |place| Branch { place, turn: step.begin.sin_cos(), way: step.way };
        self.branches[mover].map(branch)
    }
}

/// Adds a mass at the end of a way.
fn gather(body: &mut RigidBody<f64>, Step { begin, way, .. }: &Step, mass: f64) {
    let ([x, z], (sin, cos)) = (way.step, begin.sin_cos());
    let end = Vec3::of(&Vector3::new(x * cos, x * sin, z));
    body.first_moment += end * mass;
    body.inertia += Sym3::point(end, end * mass);
}

impl Arm {
    /// From a robot.
    pub fn new(robot: &Robot) -> Self {
        let parts = Parts::of(robot);
        let assembly = Assembly::new(&parts);
        let back = parts.mount.inverse();
        let Body { mass, inertia, .. } = robot.base();
        let mut base = body(*mass, back.translation, inertia, &parts.mount.rotation);
        if let Some(fixed) = parts.carried_by(None, &back) {
            base += fixed;
        }
        let mut branches = Vec::new();
        for &root in &parts.roots {
            let step = parts.movers[root].step;
            if let Some(branch) = assembly.branch(root, &step) {
                gather(&mut base, &step, assembly.masses[root]);
                branches.push(branch);
            }
        }
        base.mass += parts.roots.iter().map(|root| assembly.masses[*root]).sum::<f64>();
        let links: Vec<_> = parts.order().into_iter().map(|mover| assembly.link(mover)).collect();
        let branch_count = assembly.branches.iter().flatten().count();
        let turns =
            |link: &ArmLink| matches!(link.motion, Motion::Turn(_)) && link.way.bend.is_none();
        Self {
            is_plain: branch_count == 0 && links.iter().all(turns),
            links,
            base,
            branches,
            branch_count,
            mount: UnitQuaternion::from_rotation_matrix(&parts.mount.rotation),
        }
    }
}
