//! Values of arguments: what is accepted, and how that is told where something else is given.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// The `value` of an argument, if it has one and `is_accepted`; else what would have been.
pub(crate) fn accepted<T>(
    value: Option<T>,
    is_accepted: impl FnOnce(&T) -> bool,
    told: impl Display,
) -> Result<T, String> {
    value.filter(is_accepted).ok_or_else(|| format!("accepted: {told}"))
}

/// A whole number in a range.
pub(crate) fn whole<T: FromStr + PartialOrd + Display>(
    text: &str,
    range: RangeInclusive<T>,
) -> Result<T, String> {
    let told = format!("whole numbers from {} to {}", range.start(), range.end());
    accepted(text.parse().ok(), |number| range.contains(number), told)
}
