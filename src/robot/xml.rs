//! Elements of URDF: their attributes and children, and what is wrong with them.

use std::ops::Range;

use roxmltree::{Attribute, Node};
use toml::Spanned;

use crate::input::{Document, InputError};
use crate::words::plural;

pub(super) struct Reader<'a> {
    pub(super) document: &'a Document,
}

pub(super) type Element<'a> = Node<'a, 'a>;

/// Whether an element is of the namespace that another one is of, and no extension.
pub(super) fn is_of(element: Element<'_>, other: Element<'_>) -> bool {
    element.tag_name().namespace() == other.tag_name().namespace()
}

impl Reader<'_> {
    pub(super) fn error(&self, place: Range<usize>, message: impl std::fmt::Display) -> InputError {
        self.document.error_at(place, message, None)
    }

    /// An attribute that has to be there.
    pub(super) fn text<'a>(
        &self,
        element: Element<'a>,
        name: &str,
    ) -> Result<Attribute<'a, 'a>, InputError> {
        element.attribute_node(name).ok_or_else(|| {
            let message = format!("`<{}>` has no `{name}`", element.tag_name().name());
            self.error(element.range(), message)
        })
    }

    pub(super) fn name(
        &self,
        element: Element<'_>,
        attribute: &str,
    ) -> Result<Spanned<String>, InputError> {
        let attribute = self.text(element, attribute)?;
        Ok(Spanned::new(attribute.range_value(), attribute.value().to_owned()))
    }

    pub(super) fn number(&self, attribute: Attribute<'_, '_>) -> Result<f64, InputError> {
        let [number] = self.numbers(attribute)?;
        Ok(number)
    }

    pub(super) fn numbers<const N: usize>(
        &self,
        attribute: Attribute<'_, '_>,
    ) -> Result<[f64; N], InputError> {
        let error = |found: String| {
            let expected = if N == 1 { "a number".to_owned() } else { format!("{N} numbers") };
            let message = format!("found {found} as `{}`, expected {expected}", attribute.name());
            self.error(attribute.range(), message)
        };
        let mut numbers = Vec::with_capacity(N);
        for word in attribute.value().split_whitespace() {
            match word.parse::<f64>() {
                Ok(number) if number.is_finite() => numbers.push(number),
                _ => return Err(error(format!("`{word}`"))),
            }
        }
        let found = numbers.len();
        <[f64; N]>::try_from(numbers).map_err(|_| match found {
            0 => error("nothing".to_owned()),
            _ => error(plural(found, "number")),
        })
    }

    pub(super) fn optional<const N: usize>(
        &self,
        element: Option<Element<'_>>,
        name: &str,
    ) -> Result<Option<[f64; N]>, InputError> {
        let attribute = element.and_then(|element| element.attribute_node(name));
        attribute.map(|attribute| self.numbers(attribute)).transpose()
    }

    /// The only child of a name, if there is one.
    pub(super) fn child<'a>(
        &self,
        element: Element<'a>,
        name: &str,
    ) -> Result<Option<Element<'a>>, InputError> {
        let is_meant =
            |child: &Element<'_>| child.tag_name().name() == name && is_of(*child, element);
        let mut children = element.children().filter(is_meant);
        let first = children.next();
        match children.next() {
            None => Ok(first),
            Some(second) => {
                let parent = element.tag_name().name();
                let message = format!("found a second `<{name}>` in a `<{parent}>`, expected one");
                Err(self.error(second.range(), message))
            }
        }
    }

    pub(super) fn needed<'a>(
        &self,
        element: Element<'a>,
        name: &str,
    ) -> Result<Element<'a>, InputError> {
        self.child(element, name)?.ok_or_else(|| {
            let message = format!("`<{}>` has no `<{name}>`", element.tag_name().name());
            self.error(element.range(), message)
        })
    }

    /// Origin \[m\] and yaw, pitch and roll \[°\].
    pub(super) fn origin(&self, element: Element<'_>) -> Result<([f64; 3], [f64; 3]), InputError> {
        let origin = self.child(element, "origin")?;
        let position = self.optional(origin, "xyz")?.unwrap_or_default();
        let [roll, pitch, yaw] = self.optional(origin, "rpy")?.unwrap_or_default();
        Ok((position, [yaw, pitch, roll].map(f64::to_degrees)))
    }
}
