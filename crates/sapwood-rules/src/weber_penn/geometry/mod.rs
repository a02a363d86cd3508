//! From grown stems and leaves to meshes.

mod leaf_shape;
mod ring_places;
mod surface;

pub use leaf_shape::leaf_mesh;
pub use surface::{Detail, surface};
