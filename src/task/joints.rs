//! Values joint by joint, as files state them.

use std::fmt::{self, Write as _};
use std::ops::Range;

use serde::de::{Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use serde::ser::{SerializeMap, Serializer};
use serde::{Deserialize, Serialize};
use toml::Spanned;

use crate::input::{Document, Finite, InputError, Positive};
use crate::robot::{Robot, find_joint};
use crate::words::plural;

/// Values of joints: one for all, one each in the robot's order, or by name.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum JointValues<T> {
    All(T),
    Each(Vec<T>),
    Named(Vec<(Spanned<String>, T)>),
}

/// A position, which is no joint's in common with all others.
pub(super) type Positions = JointValues<Finite>;

/// A limit, which all joints may share.
pub(super) type Limit = JointValues<Positive>;

/// Where positions stand that may be stated under either key.
pub(super) fn span_of(either: [&Option<Spanned<Positions>>; 2]) -> Option<Range<usize>> {
    either.into_iter().flatten().map(Spanned::span).next()
}

/// A key, and what its numbers count.
#[derive(Debug, Clone, Copy)]
pub(super) struct Key {
    pub(super) name: &'static str,
    /// Degrees, whatever the joint; else degrees or metres by joint.
    pub(super) in_degrees: bool,
}

impl<T: Copy> JointValues<T> {
    /// The values of the joints that are free, where these are listed for all of some names.
    pub(super) fn freed(self, names: &[String], is_free: impl Fn(&str) -> bool) -> Self {
        match self {
            Self::Each(values) if values.len() == names.len() => {
                let own = names.iter().zip(values);
                Self::Each(own.filter(|(name, _)| is_free(name)).map(|(_, v)| v).collect())
            }
            other => other,
        }
    }

    /// The values in the robot's order, in units of files; none of joints that follow others and were left out.
    pub(super) fn listed(
        &self,
        robot: &Robot,
        span: Range<usize>,
        document: &Document,
    ) -> Result<Vec<Option<T>>, InputError> {
        let (all, leading) = (robot.joint_count(), robot.leading_count());
        match self {
            Self::All(value) => Ok(vec![Some(*value); all]),
            Self::Each(values) if values.len() == all => {
                Ok(values.iter().copied().map(Some).collect())
            }
            Self::Each(values) if values.len() == leading => {
                let mut listed = vec![None; all];
                robot.leading().zip(values).for_each(|(joint, value)| listed[joint] = Some(*value));
                Ok(listed)
            }
            Self::Each(values) => {
                let mut message = format!(
                    "found {}, expected {all}, one for each joint of robot `{}`",
                    plural(values.len(), "value"),
                    robot.name()
                );
                if leading < all {
                    let _ = write!(message, ", or {leading} without those that follow others");
                }
                Err(document.error_at(span, message, None))
            }
            Self::Named(values) => named(values, robot, span, document),
        }
    }
}

fn named<T: Copy>(
    values: &[(Spanned<String>, T)],
    robot: &Robot,
    span: Range<usize>,
    document: &Document,
) -> Result<Vec<Option<T>>, InputError> {
    for (name, _) in values {
        find_joint(robot, name, document)?;
    }
    let mut listed = Vec::with_capacity(robot.joint_count());
    for joint in robot.joints() {
        let found = values.iter().find(|(name, _)| name.get_ref() == joint.name);
        if found.is_none() && joint.follows.is_none() {
            let message = format!("found no value for joint `{}`", joint.name);
            return Err(document.error_at(span, message, None));
        }
        listed.push(found.map(|(_, value)| *value));
    }
    Ok(listed)
}

/// Values in the robot's order, in units of files: degrees of joints that turn, metres of joints that slide, and seconds; none of
/// joints that follow others and were left out.
pub(super) fn read<T: Copy>(
    values: &Spanned<JointValues<T>>,
    number: fn(T) -> f64,
    key: Key,
    robot: &Robot,
    document: &Document,
) -> Result<Vec<Option<f64>>, InputError> {
    if let Some(joint) = robot.sliding_joint() {
        let problem = if key.in_degrees {
            Some(format!("`{}` is in degrees, and joint `{}` slides", key.name, joint.name))
        } else if matches!(values.get_ref(), JointValues::All(_)) {
            Some(format!("one `{}` for all joints, and joint `{}` slides", key.name, joint.name))
        } else {
            None
        };
        if let Some(message) = problem {
            let stem = key.name.split("_deg").next().unwrap_or(key.name);
            let help = format!(
                "`{stem}` has one value for each joint, in metres where it slides and in degrees where it turns"
            );
            return Err(document.error_at(values.span(), message, Some(help)));
        }
    }
    let listed = values.get_ref().listed(robot, values.span(), document)?;
    Ok(listed.into_iter().map(|value| value.map(number)).collect())
}

impl<T: Serialize> Serialize for JointValues<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::All(value) => value.serialize(serializer),
            Self::Each(values) => values.serialize(serializer),
            Self::Named(values) => {
                let mut map = serializer.serialize_map(Some(values.len()))?;
                for (name, value) in values {
                    map.serialize_entry(name.get_ref(), value)?;
                }
                map.end()
            }
        }
    }
}

/// What a file may state for joints.
pub(super) trait Stated: for<'de> Deserialize<'de> {
    const EXPECTED: &'static str;
    /// One number for all joints, where that makes sense.
    fn all(value: f64) -> Result<Self, String>;
}

impl Stated for Finite {
    const EXPECTED: &'static str =
        "a list of one number for each joint, or a table of them by name";

    fn all(_: f64) -> Result<Self, String> {
        Err(format!("found a number, expected {}", Self::EXPECTED))
    }
}

impl Stated for Positive {
    const EXPECTED: &'static str = "a positive number, or a list of one for each joint";

    fn all(value: f64) -> Result<Self, String> {
        if value.is_finite() && value > 0.0 {
            return Ok(Self(value));
        }
        Err(format!("found {value}, expected a finite number above zero"))
    }
}

impl<'de, T: Stated> Deserialize<'de> for JointValues<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Values<T>(std::marker::PhantomData<T>);
        impl<'de, T: Stated> Visitor<'de> for Values<T> {
            type Value = JointValues<T>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(T::EXPECTED)
            }

            fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<Self::Value, E> {
                T::all(value).map(JointValues::All).map_err(E::custom)
            }

            fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<Self::Value, E> {
                self.visit_f64(value as f64)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
                let mut values = Vec::new();
                while let Some(value) = list.next_element()? {
                    values.push(value);
                }
                Ok(JointValues::Each(values))
            }

            fn visit_map<A: MapAccess<'de>>(self, mut table: A) -> Result<Self::Value, A::Error> {
                let mut values = Vec::new();
                while let Some(entry) = table.next_entry()? {
                    values.push(entry);
                }
                if values.is_empty() {
                    return Err(A::Error::custom("found an empty table, expected joints by name"));
                }
                Ok(JointValues::Named(values))
            }
        }
        deserializer.deserialize_any(Values(std::marker::PhantomData))
    }
}
