//! Held geometry: a finished mesh placed in the scene.

use std::sync::Arc;

use sapwood_geom::{Mesh, SharedMesh, content};
use sapwood_graph::{Material, Named};

use crate::{Component, Context, Rule, RuleError};

/// A finished mesh with its material.
#[derive(Clone, Debug)]
pub struct HeldGeometry {
    /// The triangles.
    pub mesh: SharedMesh,
    /// Their look.
    pub material: Arc<Material>,
}

content!(HeldGeometry { mesh, material });

impl HeldGeometry {
    /// Holds `mesh`, to be drawn with `material`.
    pub fn new(mesh: Mesh, material: Material) -> Self {
        Self { mesh: SharedMesh::new(mesh), material: Arc::new(material) }
    }
}

impl Named for HeldGeometry {
    const NAME: &'static str = "held_geometry";
}

impl Component for HeldGeometry {}

pub(super) struct HeldGeometryRule;

impl Rule for HeldGeometryRule {
    type Component = HeldGeometry;
    type Data = ();
    const NAME: &'static str = "held_geometry";

    fn init(&self, held: &HeldGeometry, cx: &mut Context<'_>) -> Result<(), RuleError> {
        cx.mesh(held.mesh.clone(), Arc::clone(&held.material));
        Ok(())
    }
}
