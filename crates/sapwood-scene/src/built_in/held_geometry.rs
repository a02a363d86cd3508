//! Held geometry: a finished mesh placed in the scene.

use std::sync::Arc;

use sapwood_geom::{Mesh, Shared, SharedMesh, content};
use sapwood_graph::{Material, Named};

use crate::{Component, Context, MaterialSlot, Rule, RuleError, Style, StyleSlot};

/// A finished mesh, with a material of its own or that of its surroundings.
#[derive(Clone, Debug)]
pub struct HeldGeometry {
    /// The triangles.
    pub mesh: SharedMesh,
    /// Their look; that of [`MaterialSlot`] if there is none.
    pub material: Option<Arc<Material>>,
}

content!(HeldGeometry { mesh, material });

impl HeldGeometry {
    /// Holds `mesh`, to be drawn with `material`.
    pub fn new(mesh: Mesh, material: Material) -> Self {
        Self { mesh: SharedMesh::new(mesh), material: Some(Arc::new(material)) }
    }

    /// Holds `mesh`, to be drawn with the material of its surroundings.
    pub fn plain(mesh: Mesh) -> Self {
        Self { mesh: SharedMesh::new(mesh), material: None }
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
        // Edges are made of the mesh before the context sees it.
        if let Some(why) = held.mesh.unsound() {
            return Err(RuleError::Failed(why.to_owned()));
        }
        match *cx.read::<StyleSlot>() {
            Style::Solid => {
                let material = match &held.material {
                    Some(own) => cx.own_or_forced::<MaterialSlot>(Arc::clone(own)),
                    None => cx.read::<MaterialSlot>(),
                };
                cx.mesh(held.mesh.clone(), material);
            }
            Style::Wire | Style::Skeleton => cx.lines(Shared::new(held.mesh.edges())),
        }
        Ok(())
    }
}
