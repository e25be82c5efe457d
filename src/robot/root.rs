//! The root of a tree as the base that floats.

use std::ops::Range;

use nalgebra::{Cholesky, Rotation3, Vector3};

use super::link::{Body, Link, Placement};
use super::rigid::{Placed, Rigid, merged};
use super::shape::Shape;
use super::tree::Tool;
use crate::input::{Document, InputError};

/// The only link that hangs on nothing, with all that is fixed to it, as the base. Fixed links stay, as frames without mass but with their shapes. Base axes
/// are the root's, with their origin at the centre of mass. `place` says where a link stands in its file.
pub(super) fn as_base<'a>(
    links: Vec<Link>,
    tool: Tool,
    place: impl Fn(usize) -> (&'a Document, Range<usize>),
) -> Result<(Body, Vec<Link>, Tool), InputError> {
    let mut roots = (0..links.len()).filter(|&i| links[i].parent.is_none());
    let error = |i: usize, message: String, help: Option<&str>| {
        let (document, span) = place(i);
        document.error_at(span, message, help.map(str::to_owned))
    };
    let root = roots.next().unwrap_or(0);
    if let Some(other) = roots.next() {
        let message = format!(
            "found two links without a parent, `{}` and `{}`, and no `[base]` that carries them",
            links[root].name, links[other].name
        );
        return Err(error(other, message, None));
    }
    if links[root].joint.axis().is_some() {
        let message = format!("link `{}` has a joint that moves, and no base", links[root].name);
        return Err(error(root, message, Some("`[base]` gives the robot a base")));
    }
    if links[root].placement != Placement::identity() {
        let message = format!(
            "link `{}` has a place, and no base to have it on: it is the base itself",
            links[root].name
        );
        return Err(error(root, message, Some("leave out `position` and `zyx_deg`")));
    }
    let rigid = fixed_frames(&links, root);
    let parts = links.iter().zip(&rigid).filter_map(|(link, frame)| {
        let frame = frame.as_ref()?;
        let turn = frame.rotation.matrix();
        Some(Placed {
            mass: link.body.mass,
            centre: frame.translation + frame.rotation * link.centre_of_mass,
            inertia: turn * link.body.inertia * turn.transpose(),
        })
    });
    let whole = merged(parts.collect());
    if whole.mass <= 0.0 {
        let message = format!(
            "link `{}`, the root of the robot, has no mass and cannot be the floating base",
            links[root].name
        );
        let help = "`[base]` gives the robot one, with `mass`, `inertia` and `mount`: in a task file as `[task.base]`";
        return Err(error(root, message, Some(help)));
    }
    if Cholesky::new(whole.inertia).is_none() {
        let message = format!(
            "the inertia of link `{}`, the base, with what is fixed to it, is not positive definite",
            links[root].name
        );
        return Err(error(root, message, None));
    }
    // Links stand after their parents, so the root is the first.
    let lifted = |parent: Option<usize>, placement: Placement| match parent {
        Some(parent) if parent != root => (Some(parent - 1), placement),
        _ => (None, shifted(&placement, &-whole.centre)),
    };
    let moved = |shape: &Shape| shape.moved(&-whole.centre, &Rotation3::identity());
    let shapes = links[root].body.shapes.iter().map(moved).collect();
    let mut carried = Vec::with_capacity(links.len());
    for (i, mut link) in links.into_iter().enumerate() {
        if i == root {
            continue;
        }
        if rigid[i].is_some() {
            link.body = Body { shapes: link.body.shapes, ..Body::massless() };
        }
        (link.parent, link.placement) = lifted(link.parent, link.placement);
        carried.push(link);
    }
    let (link, placement) = lifted(tool.link, tool.placement);
    let base = Body { shapes, ..Body::new(whole.mass, whole.inertia) };
    Ok((base, carried, Tool { link, placement }))
}

/// For every link that is fixed to the root its frame in the root's.
fn fixed_frames(links: &[Link], root: usize) -> Vec<Option<Rigid>> {
    let mut frames: Vec<Option<Rigid>> = Vec::with_capacity(links.len());
    for (i, link) in links.iter().enumerate() {
        let frame = if i == root {
            Some(Rigid::identity())
        } else if link.joint.axis().is_some() {
            None
        } else {
            let inner = link.parent.and_then(|parent| frames[parent]);
            inner.map(|inner| inner.then(&Rigid::of(&link.placement)))
        };
        frames.push(frame);
    }
    frames
}

fn shifted(placement: &Placement, by: &Vector3<f64>) -> Placement {
    Placement::new(placement.translation() + by, placement.rotation())
}
