//! Numbers that serde checks while it still knows where they stand.

use std::num::NonZeroU64;

use serde::de::{Deserializer, Error as _};
use serde::{Deserialize, Serialize};

/// A number that is neither infinite nor NaN.
pub fn finite<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let value = f64::deserialize(deserializer)?;
    check(value, value.is_finite(), "a finite number")
}

/// A finite number above zero.
pub fn positive<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let value = f64::deserialize(deserializer)?;
    check(value, value.is_finite() && value > 0.0, "a finite number above zero")
}

/// A finite number above zero, where there may be none.
pub fn optional_positive<'de, D: Deserializer<'de>>(d: D) -> Result<Option<f64>, D::Error> {
    positive(d).map(Some)
}

/// A finite number, zero or above.
pub fn non_negative<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let value = f64::deserialize(deserializer)?;
    check(value, value.is_finite() && value >= 0.0, "a finite number, zero or above")
}

/// A whole number from 1 to `MOST`.
pub fn count<'de, const MOST: u64, D, T>(deserializer: D) -> Result<T, D::Error>
where
    D: Deserializer<'de>,
    T: TryFrom<NonZeroU64>,
{
    count_from::<1, MOST, D, T>(deserializer)
}

/// A whole number from `LEAST` to `MOST`, where there may be none.
pub fn optional_count<'de, const LEAST: u64, const MOST: u64, D, T>(
    deserializer: D,
) -> Result<Option<T>, D::Error>
where
    D: Deserializer<'de>,
    T: TryFrom<NonZeroU64>,
{
    count_from::<LEAST, MOST, D, T>(deserializer).map(Some)
}

/// A whole number from `LEAST` to `MOST`.
pub fn count_from<'de, const LEAST: u64, const MOST: u64, D, T>(
    deserializer: D,
) -> Result<T, D::Error>
where
    D: Deserializer<'de>,
    T: TryFrom<NonZeroU64>,
{
    let value = i64::deserialize(deserializer)?;
    let within = u64::try_from(value).ok().filter(|n| (LEAST..=MOST).contains(n));
    let count = within.and_then(NonZeroU64::new);
    count.and_then(|count| T::try_from(count).ok()).ok_or_else(|| {
        D::Error::custom(format!("found {value}, expected a whole number from {LEAST} to {MOST}"))
    })
}

/// A list with at least one entry.
pub fn non_empty<'de, D: Deserializer<'de>, T: Deserialize<'de>>(d: D) -> Result<Vec<T>, D::Error> {
    let list = Vec::deserialize(d)?;
    let expected = "found an empty list, expected at least one entry";
    if list.is_empty() { Err(D::Error::custom(expected)) } else { Ok(list) }
}

/// A number from 0 to 1.
pub fn fraction<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let value = f64::deserialize(deserializer)?;
    check(value, (0.0..=1.0).contains(&value), "a number from 0 to 1")
}

/// A number above 0, 1 at most.
pub fn share<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let value = f64::deserialize(deserializer)?;
    check(value, value > 0.0 && value <= 1.0, "a number above 0, 1 at most")
}

/// A fixed number of finite numbers.
pub fn finite_array<'de, const N: usize, D>(deserializer: D) -> Result<[f64; N], D::Error>
where
    D: Deserializer<'de>,
    [Finite; N]: Deserialize<'de>,
{
    Ok(<[Finite; N]>::deserialize(deserializer)?.map(|f| f.0))
}

/// A finite number, checked where it stands in a list.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Finite(#[serde(deserialize_with = "finite")] pub f64);

/// A finite number above zero, checked where it stands in a list.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Positive(#[serde(deserialize_with = "positive")] pub f64);

/// A finite number, zero or above.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NonNegative(#[serde(deserialize_with = "non_negative")] pub f64);

/// A number from 0 to 1, checked where it stands in a list.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Fraction(#[serde(deserialize_with = "fraction")] pub f64);

/// A two-element `[lower, upper]` with `lower < upper`.
pub fn interval<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f64; 2], D::Error> {
    let [lower, upper] = finite_array::<2, D>(deserializer)?;
    if lower < upper {
        Ok([lower, upper])
    } else {
        Err(D::Error::custom(format!("empty range {lower} to {upper}, expected [lower, upper]")))
    }
}

/// A two-element `[lower, upper]` with `0 < lower < upper`.
pub fn positive_interval<'de, D: Deserializer<'de>>(d: D) -> Result<[f64; 2], D::Error> {
    let [lower, upper] = interval(d)?;
    check(lower, lower > 0.0, "a range above zero").map(|lower| [lower, upper])
}

fn check<E: serde::de::Error>(value: f64, good: bool, expected: &str) -> Result<f64, E> {
    if good { Ok(value) } else { Err(E::custom(format!("found {value}, expected {expected}"))) }
}
