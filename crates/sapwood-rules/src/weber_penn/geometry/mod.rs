//! From grown stems and leaves to meshes.

mod closed_stem;
mod detail;
mod leaf_card;
mod leaf_shape;
mod own_image;
mod own_leaf;
mod ring_places;
mod rounded_leaves;
mod surface;

pub use closed_stem::closed_stems;
pub use detail::{Detail, LevelDetail};
pub(crate) use leaf_card::half_width;
pub use leaf_card::leaf_card;
pub use leaf_shape::leaf_mesh;
pub use own_image::OwnLeafImage;
pub(crate) use own_image::spot;
pub use own_leaf::{LeafMesh, LeafMeshFault};
pub(crate) use own_leaf::{is_closed, point_half_width};
pub(crate) use rounded_leaves::{Rounding, ends_of_leaves, for_vertices, rounded_leaves};
pub(crate) use surface::{Band, banded_surface, segmented_surface, segments_by_stem};
pub use surface::{segments, surface};
