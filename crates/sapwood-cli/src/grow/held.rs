//! What was cut, as a scene of its own: pictures are taken of scenes, not of draw lists.

use sapwood::graph::{Body, DrawList};
use sapwood::scene::{
    Attribute, EditError, Group, Handle, HeldGeometry, HeldInstances, NodeId, Scene, Transform,
};

/// A scene that shows what a list draws with surfaces and lights.
pub(super) fn held(list: &DrawList) -> Result<(Scene, Handle<Attribute>), EditError> {
    let mut scene = Scene::new();
    let root = scene.add(Attribute::new());
    scene.bulk(|scene| {
        let all = scene.add_to(root, Group)?;
        let mut bodies = Vec::with_capacity(list.bodies.len());
        for body in &list.bodies {
            bodies.push(held_body(scene, body)?);
        }
        for occurrence in &list.occurrences {
            let place = scene.add_to(all, Transform(occurrence.world))?;
            scene.append(place, bodies[occurrence.body as usize])?;
        }
        Ok::<_, EditError>(())
    })?;
    Ok((scene, root))
}

fn held_body(scene: &mut Scene, body: &Body) -> Result<Handle<Group>, EditError> {
    let group = scene.add(Group);
    let put = |scene: &mut Scene, local, id: NodeId| {
        let place = scene.add_to(group, Transform(local))?;
        scene.append(place, id)
    };
    for row in &body.rows {
        let (mesh, material) = (row.mesh.clone(), Some(row.material.clone()));
        let id = match row.instances.clone() {
            None => scene.add(HeldGeometry { mesh, material }).id(),
            Some(places) => scene.add(HeldInstances { mesh, material, places }).id(),
        };
        put(scene, row.local, id)?;
    }
    for row in &body.lights {
        let id = scene.add(row.light.clone()).id();
        put(scene, row.local, id)?;
    }
    Ok(group)
}
