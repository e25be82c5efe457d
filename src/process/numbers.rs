//! Points and costs as JSON has them; what is not finite is a text.

use std::fmt;

use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, Error as _, SeqAccess, Visitor};

use crate::search::{Failure, Points};
use crate::words::plural;

/// One point, or a list of points.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Coordinates {
    values: Vec<f64>,
    /// How many values each point has.
    lengths: Vec<usize>,
    /// Whether it is one point and no list.
    pub(super) is_single: bool,
}

impl Coordinates {
    /// How many points there are.
    pub(super) fn len(&self) -> usize {
        self.lengths.len()
    }

    /// The points, which must have so many variables.
    pub(super) fn points(&self, dimension: usize) -> Result<Points, Failure> {
        if let Some(found) = self.lengths.iter().find(|length| **length != dimension) {
            return Err(format!(
                "sent a point with {}, expected {dimension}",
                plural(*found, "variable")
            )
            .into());
        }
        let mut points = Points::zeros(dimension, self.len());
        for (i, x) in self.values.chunks_exact(dimension).enumerate() {
            points[i].copy_from_slice(x);
        }
        Ok(points)
    }

    /// The only point.
    pub(super) fn single(&self) -> Result<&[f64], Failure> {
        if self.is_single {
            Ok(&self.values)
        } else {
            Err("asked for derivatives at a list of points, expected one point".into())
        }
    }
}

/// One number, or a list of numbers.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Numbers(pub(super) Vec<f64>);

impl<'de> Deserialize<'de> for Numbers {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut values = Vec::new();
        if let Item::Number(value) = ItemSeed(&mut values).deserialize(deserializer)? {
            values.push(value);
        }
        Ok(Self(values))
    }
}

/// A number, or a list of so many.
enum Item {
    Number(f64),
    Point(usize),
}

/// Reads an item; the values of a point go straight to those of all points.
struct ItemSeed<'a>(&'a mut Vec<f64>);

impl<'de> DeserializeSeed<'de> for ItemSeed<'_> {
    type Value = Item;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Item, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for ItemSeed<'_> {
    type Value = Item;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, or a list of numbers")
    }

    fn visit_f64<E>(self, value: f64) -> Result<Item, E> {
        Ok(Item::Number(value))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Item, E> {
        Ok(Item::Number(value as f64))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Item, E> {
        Ok(Item::Number(value as f64))
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Item, E> {
        match text {
            "inf" => Ok(Item::Number(f64::INFINITY)),
            "-inf" => Ok(Item::Number(f64::NEG_INFINITY)),
            "nan" => Ok(Item::Number(f64::NAN)),
            _ => Err(E::invalid_value(serde::de::Unexpected::Str(text), &self)),
        }
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Item, A::Error> {
        let before = self.0.len();
        let mut deeper = Vec::new();
        while let Some(item) = items.next_element_seed(ItemSeed(&mut deeper))? {
            match item {
                Item::Number(value) => self.0.push(value),
                Item::Point(_) => return Err(A::Error::custom("found a list of lists of points")),
            }
        }
        Ok(Item::Point(self.0.len() - before))
    }
}

impl<'de> Deserialize<'de> for Coordinates {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Items;

        impl<'de> Visitor<'de> for Items {
            type Value = Coordinates;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a point or a list of points")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Coordinates, A::Error> {
                let mut found = Coordinates::default();
                let mut numbers = 0;
                while let Some(item) = items.next_element_seed(ItemSeed(&mut found.values))? {
                    match item {
                        Item::Number(value) => {
                            found.values.push(value);
                            numbers += 1;
                        }
                        Item::Point(length) => found.lengths.push(length),
                    }
                }
                match (numbers, found.lengths.len()) {
                    (0, _) => {}
                    (_, 0) => {
                        found.lengths.push(numbers);
                        found.is_single = true;
                    }
                    _ => return Err(A::Error::custom("found numbers beside points")),
                }
                Ok(found)
            }
        }

        deserializer.deserialize_seq(Items)
    }
}
