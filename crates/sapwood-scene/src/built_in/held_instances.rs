//! Held instances: a finished mesh repeated at many places.

use std::sync::Arc;

use sapwood_geom::glam::Affine3;
use sapwood_geom::{Shared, SharedMesh, content};
use sapwood_graph::{Material, Named};

use crate::{Component, Context, MaterialSlot, Rule, RuleError, Style, StyleSlot};

/// A finished mesh at many places, with a material of its own or that of its surroundings.
///
/// For places that nobody edits one by one: a place takes the room of its transform and no more.
#[derive(Clone, Debug)]
pub struct HeldInstances {
    /// The triangles of one instance.
    pub mesh: SharedMesh,
    /// Their look; that of [`MaterialSlot`] if there is none.
    pub material: Option<Arc<Material>>,
    /// From an instance's frame to the component's.
    pub places: Shared<Vec<Affine3>>,
}

content!(HeldInstances { mesh, material, places });

impl Named for HeldInstances {
    const NAME: &'static str = "held_instances";
}

impl Component for HeldInstances {}

pub(super) struct HeldInstancesRule;

impl Rule for HeldInstancesRule {
    type Component = HeldInstances;
    type Data = ();
    const NAME: &'static str = "held_instances";

    fn init(&self, held: &HeldInstances, cx: &mut Context<'_>) -> Result<(), RuleError> {
        if let Some(why) = held.mesh.unsound() {
            return Err(RuleError::Failed(why.to_owned()));
        }
        if let Some(i) = held.places.iter().position(|place| !place.is_finite()) {
            return Err(RuleError::Failed(format!(
                "place {i} is not finite: {:?}",
                held.places[i]
            )));
        }
        match *cx.read::<StyleSlot>() {
            Style::Solid => {
                let material = match &held.material {
                    Some(own) => cx.own_or_forced::<MaterialSlot>(Arc::clone(own)),
                    None => cx.read::<MaterialSlot>(),
                };
                cx.instances(held.mesh.clone(), material, held.places.clone());
            }
            Style::Wire | Style::Skeleton => {
                let edges = Shared::new(held.mesh.edges());
                for place in held.places.iter() {
                    cx.transform(*place, |cx| cx.lines(edges.clone()));
                }
            }
        }
        Ok(())
    }
}
