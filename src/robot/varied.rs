//! Robots that differ a little from what their files say.

use nalgebra::Vector3;

use super::error::RobotError;
use super::link::{Body, Placement};
use super::outfit::moved;
use super::tree::Robot;

impl Robot {
    /// The bodies that have mass: the base as `None`, and links.
    pub(crate) fn heavy_bodies(&self) -> impl Iterator<Item = (Option<usize>, &str)> {
        let links = self.links().iter().enumerate();
        let links = links.filter(|(_, link)| link.body.mass > 0.0);
        std::iter::once((None, "base")).chain(links.map(|(i, link)| (Some(i), link.name.as_str())))
    }

    /// The same with masses and inertias times the factors of each body, an inertia by both factors, what the base carries shifted
    /// in base axes \[m\], and joints off by constant amounts \[rad or m\].
    pub(crate) fn varied(
        &self,
        factors: impl Fn(Option<usize>) -> [f64; 2],
        shift: Vector3<f64>,
        offsets: &[f64],
    ) -> Result<Self, RobotError> {
        let varied = |body: &Body, owner| {
            let [mass, inertia] = factors(owner);
            let (own, moments) = (body.mass * mass, body.inertia * (mass * inertia));
            Body { mass: own, inertia: moments, shapes: body.shapes.clone() }
        };
        let mut offset_of = vec![0.0; self.links().len()];
        let mut offsets = offsets.to_vec();
        self.drive_followers(&mut offsets);
        self.joints().zip(&offsets).for_each(|(joint, offset)| offset_of[joint.link] = *offset);
        let links = self.links().iter().enumerate().map(|(i, link)| {
            let mut link = link.clone();
            if offset_of[i] != 0.0 {
                link.placement = link.placement.then(&moved(&link.joint, offset_of[i]));
            }
            link.body = varied(&link.body, Some(i));
            if link.parent.is_none() && shift != Vector3::zeros() {
                let place = &link.placement;
                link.placement = Placement::new(place.translation() + shift, place.rotation());
            }
            link
        });
        let base = varied(self.base(), None);
        Self::new(self.name().to_owned(), base, links.collect(), self.tool().clone())?
            .ignoring(self.ignored_pairs().to_vec())?
            .following(self.follows().to_vec())
    }
}
