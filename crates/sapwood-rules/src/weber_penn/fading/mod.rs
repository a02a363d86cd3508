//! Trees that fade with the distance: how much of them is left at a range, and in which order their
//! geometry is stored so that what is left comes first. The rules that draw by it stand in
//! `rules/fading.rs`; [`faded`] does it to trees whose rules know nothing of it.

mod emit;
mod order;
mod range;

pub(crate) use emit::SelfFading;
pub use emit::faded;
pub(crate) use order::{evenly_ordered_bands, evenly_ordered_leaves, leaf_point, point_for};
pub use range::{FadingItem, FadingParams, Season};
