//! Links and joints that know each other by name, as a tree.

use std::collections::HashMap;
use std::ops::Range;

use toml::Spanned;

use super::links::{Kind, LinkJoint, LinkTable, MOST_LINKS};
use crate::input::{Document, InputError, nearest};

/// Links and joints before they are a tree.
#[derive(Default)]
pub(super) struct Graph {
    pub(super) links: Vec<LinkTable>,
    pub(super) joints: Vec<UrdfJoint>,
}

/// A joint between two links that are known by their names.
pub(super) struct UrdfJoint {
    pub(super) name: Spanned<String>,
    pub(super) parent: Spanned<String>,
    pub(super) child: Spanned<String>,
    pub(super) position: [f64; 3],
    pub(super) zyx_deg: [f64; 3],
    /// None where it is floating.
    pub(super) joint: Option<LinkJoint>,
}

fn error(document: &Document, place: Range<usize>, message: impl std::fmt::Display) -> InputError {
    document.error_at(place, message, None)
}

impl Graph {
    /// The links as a tree, each after its parent; `place` is where the robot stands.
    pub(super) fn ordered(
        mut self,
        place: Range<usize>,
        document: &Document,
    ) -> Result<Vec<LinkTable>, InputError> {
        if self.links.len() > MOST_LINKS {
            let message =
                format!("found {} links, expected at most {MOST_LINKS}", self.links.len());
            return Err(error(document, place, message));
        }
        let mut places: HashMap<String, usize> = HashMap::new();
        for (i, link) in self.links.iter().enumerate() {
            let name = link.name.get_ref();
            if places.insert(name.clone(), i).is_some() {
                let message = format!("found two links with the name `{name}`");
                return Err(error(document, link.name.span(), message));
            }
        }
        // For every link the joint that carries it, and the joints that it carries.
        let mut carriers: Vec<Option<usize>> = vec![None; self.links.len()];
        let mut carried: Vec<Vec<usize>> = vec![Vec::new(); self.links.len()];
        for (i, joint) in self.joints.iter().enumerate() {
            let [parent, child] = [&joint.parent, &joint.child].map(|name| {
                places.get(name.get_ref()).copied().ok_or_else(|| {
                    let known = self.links.iter().map(|link| link.name.get_ref().as_str());
                    let help = nearest(name.get_ref(), known)
                        .map(|known| format!("did you mean `{known}`?"));
                    let message = format!(
                        "joint `{}` joins link `{}`, which does not exist",
                        joint.name.get_ref(),
                        name.get_ref()
                    );
                    document.error_at(name.span(), message, help)
                })
            });
            let (parent, child) = (parent?, child?);
            if let Some(other) = carriers[child].replace(i) {
                let message = format!(
                    "link `{}` is carried by two joints, `{}` and `{}`; a loop of links is no tree",
                    joint.child.get_ref(),
                    self.joints[other].name.get_ref(),
                    joint.name.get_ref()
                );
                return Err(error(document, joint.child.span(), message));
            }
            carried[parent].push(i);
        }
        let root = self.root(&carriers, &carried, place, document)?;
        self.links[root].parent = None;
        let mut order = Vec::with_capacity(self.links.len());
        let mut waiting = vec![root];
        while let Some(link) = waiting.pop() {
            order.push(link);
            for &joint in carried[link].iter().rev() {
                let joint = &self.joints[joint];
                let child = places[joint.child.get_ref()];
                let Some(how) = &joint.joint else {
                    let message = format!(
                        "joint `{}` is floating; only the root floats",
                        joint.name.get_ref()
                    );
                    return Err(error(document, joint.name.span(), message));
                };
                let own = &mut self.links[child];
                own.parent = Some(joint.parent.clone());
                (own.position, own.zyx_deg) = (joint.position, joint.zyx_deg);
                if how.kind != Kind::Fixed {
                    own.joint = Some(Spanned::new(joint.name.span(), how.clone()));
                }
                waiting.push(child);
            }
        }
        let mut links: Vec<Option<LinkTable>> = self.links.into_iter().map(Some).collect();
        let tree = order.into_iter().filter_map(|link| links[link].take()).collect();
        // What is left hangs on itself, but for a world that the root floats in.
        let mut left = links.iter().zip(carriers).filter(|(_, carrier)| carrier.is_some());
        if let Some(lost) = left.find_map(|(link, _)| link.as_ref()) {
            let message = format!(
                "link `{}` is part of a loop of joints that no root carries",
                lost.name.get_ref()
            );
            return Err(error(document, lost.name.span(), message));
        }
        Ok(tree)
    }

    /// The only link that no joint carries, or what floats in it where it is a world without mass.
    fn root(
        &self,
        carriers: &[Option<usize>],
        carried: &[Vec<usize>],
        place: Range<usize>,
        document: &Document,
    ) -> Result<usize, InputError> {
        let mut roots = (0..self.links.len()).filter(|link| carriers[*link].is_none());
        let Some(root) = roots.next() else {
            let message = if self.links.is_empty() {
                "found no link, expected at least one"
            } else {
                "found no root: every link is carried by a joint, so they form a loop"
            };
            return Err(error(document, place, message));
        };
        if let Some(other) = roots.next() {
            let message = format!(
                "found two links that no joint carries, `{}` and `{}`, expected one root",
                self.links[root].name.get_ref(),
                self.links[other].name.get_ref()
            );
            return Err(error(document, self.links[other].name.span(), message));
        }
        match carried[root][..] {
            [only] if self.joints[only].joint.is_none() && self.links[root].mass == 0.0 => {
                let child = self.joints[only].child.get_ref();
                Ok(self.links.iter().position(|link| link.name.get_ref() == child).unwrap_or(root))
            }
            _ => Ok(root),
        }
    }
}
