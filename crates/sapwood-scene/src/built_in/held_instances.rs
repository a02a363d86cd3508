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

#[cfg(test)]
mod tests {
    use sapwood_geom::Mesh;
    use sapwood_geom::glam::{Vec2, Vec3};

    use super::*;
    use crate::{Attribute, Scene, built_in_rules};

    fn two(second: Vec3) -> HeldInstances {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: vec![Vec3::Z; 3],
            uvs: vec![Vec2::ZERO; 3],
            indices: vec![0, 1, 2],
        };
        let places = [Vec3::ZERO, second].map(Affine3::from_translation).to_vec();
        HeldInstances { mesh: SharedMesh::new(mesh), material: None, places: Shared::new(places) }
    }

    #[test]
    fn instances_are_one_row_and_as_wires_lines_at_each_place() {
        let mut scene = Scene::new();
        let style = scene.add(Attribute::new());
        let held = scene.add_to(style, two(5.0 * Vec3::X)).unwrap();
        let view = scene.open_view(style, &built_in_rules()).unwrap();
        let list = scene.draw_list(view, 10).unwrap();
        assert_eq!((list.bodies[0].rows.len(), list.n_vertices_and_triangles()), (1, (6, 2)));
        let all = scene.bounds(view).unwrap().aabb;
        assert_eq!((all.min, all.max), (Vec3::ZERO, Vec3::new(6.0, 1.0, 0.0)));

        scene.push::<StyleSlot>(style, Style::Wire).unwrap();
        let list = scene.draw_list(view, 10).unwrap();
        let lines: Vec<Vec3> = list.placed_lines().map(|(world, _)| world.translation).collect();
        assert_eq!(lines, [Vec3::ZERO, 5.0 * Vec3::X]);
        assert_eq!(scene.bounds(view).unwrap().aabb.max, Vec3::new(6.0, 1.0, 0.0));

        scene.edit(held, |held| *held = two(Vec3::NAN)).unwrap();
        let found = scene.diagnostics(view, 10).unwrap();
        assert!(found[0].1.message.starts_with("place 1 is not finite"), "{}", found[0].1.message);
    }
}
