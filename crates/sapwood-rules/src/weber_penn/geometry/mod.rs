//! From grown stems and leaves to meshes.

mod closed_stem;
mod leaf_card;
mod leaf_shape;
mod ring_places;
mod surface;

pub use closed_stem::closed_stems;
pub(crate) use leaf_card::half_width;
pub use leaf_card::leaf_card;
pub use leaf_shape::leaf_mesh;
pub(crate) use surface::{Band, banded_surface, segmented_surface};
pub use surface::{Detail, segments, surface};
