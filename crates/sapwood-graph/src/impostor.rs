//! Impostors: boards with images of something, which stand for it from afar.

use std::sync::Arc;

use sapwood_geom::{SharedMesh, content};

use crate::{Aspects, Material};

/// Boards with images of something, each as it is seen from one direction, of which the one is
/// drawn whose direction is nearest to the eye's, or the two nearest, as they blend.
#[derive(Clone, Debug)]
pub struct Impostor {
    /// A board for each aspect, two triangles that are seen from their front.
    pub mesh: SharedMesh,
    /// One image with all aspects side by side, and nothing where nothing is.
    pub material: Arc<Material>,
    /// Where each is to be seen from.
    pub aspects: Aspects,
}

content!(Impostor { mesh, material, aspects });
