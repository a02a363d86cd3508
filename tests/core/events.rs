//! Events: a ray finds an occurrence, its path a component, and the edit is seen by the next ray.

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::geom::{Mesh, Ray};
use sapwood::graph::{Hit, Material, PickOptions};
use sapwood::scene::{
    Action, Attribute, Group, HeldGeometry, Scene, Style, StyleSlot, Switch, Transform, ViewId,
    built_in_rules,
};

/// A square of two metres about the origin, facing +z.
fn plate() -> HeldGeometry {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let mesh = Mesh {
        positions: corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
        normals: vec![Vec3::Z; 4],
        uvs: vec![Default::default(); 4],
        indices: vec![0, 1, 2, 0, 2, 3],
    };
    HeldGeometry::new(mesh, Material::matte("plate", 0.5, 0.5, 0.5))
}

fn look_at(scene: &mut Scene, view: ViewId, x: f32, y: f32) -> Option<Hit> {
    let ray = Ray::new(Vec3::new(x, y, 10.0), -Vec3::Z);
    scene.pick(view, &ray, &PickOptions::default()).unwrap()
}

#[test]
fn a_pick_turns_the_lamp_of_the_right_wall_off_and_on() {
    // Two walls share their button; each has a lamp of its own above it, behind a switch.
    let mut scene = Scene::new();
    let house = scene.add(Group);
    let button = scene.add(plate());
    let mut lamps = Vec::new();
    for x in [-5.0, 5.0] {
        let place = scene.add_to(house, Transform::translation(x, 0.0, 0.0)).unwrap();
        let wall = scene.add_to(place, Group).unwrap();
        scene.append(wall, button).unwrap();
        let lamp = scene.add_to(wall, Switch { on: true }).unwrap();
        let above = scene.add_to(lamp, Transform::translation(0.0, 3.0, 0.0)).unwrap();
        scene.add_to(above, plate()).unwrap();
        lamps.push(lamp);
    }
    let view = scene.open_view(house, &built_in_rules()).unwrap();
    let press = |scene: &mut Scene, x: f32| {
        let hit = look_at(scene, view, x, 0.0).unwrap();
        assert_eq!(scene.component_at(view, &hit.path).unwrap(), Some(button.id()));
        let wall = scene.nearest::<Group>(view, &hit.path).unwrap().unwrap();
        let lamp = scene.children(wall).find_map(|child| scene.handle::<Switch>(child)).unwrap();
        scene.edit(lamp, |lamp| lamp.on = !lamp.on).unwrap();
        lamp
    };
    assert_eq!(press(&mut scene, 5.0), lamps[1]);
    assert!(look_at(&mut scene, view, 5.0, 3.0).is_none());
    assert!(look_at(&mut scene, view, -5.0, 3.0).is_some());
    assert_eq!(press(&mut scene, 5.0), lamps[1]);
    assert!(look_at(&mut scene, view, 5.0, 3.0).is_some());
    assert_eq!(press(&mut scene, -5.0), lamps[0]);
    assert!(look_at(&mut scene, view, -5.0, 3.0).is_none());
}

#[test]
fn a_drag_moves_what_was_picked_however_it_is_placed() {
    let mut scene = Scene::new();
    let outer = scene.add(Transform(
        Affine3::from_translation(Vec3::new(3.0, -2.0, 1.0)) * Affine3::from_rotation_z(0.7),
    ));
    let inner = scene.add_to(outer, Transform(Affine3::from_scale(Vec3::splat(0.5)))).unwrap();
    let knob = scene.add_to(inner, Transform::translation(0.0, 0.0, 0.0)).unwrap();
    scene.add_to(knob, plate()).unwrap();
    let view = scene.open_view(outer, &built_in_rules()).unwrap();

    let hit = look_at(&mut scene, view, 3.0, -2.0).unwrap();
    assert_eq!(scene.nearest::<Transform>(view, &hit.path).unwrap(), Some(knob));
    // Dragged by two metres to the right and one up, in the plane of the hit.
    let drag = Vec3::new(2.0, 1.0, 0.0);
    // The knob's own transform leads to the frame that the knob stands in.
    let frame = scene.frame_at(view, &hit.path[..hit.path.len() - 1]).unwrap().unwrap();
    let step = frame.inverse().transform_vector3(drag);
    scene.edit(knob, |knob| knob.0.translation += step).unwrap();

    assert!(look_at(&mut scene, view, 3.0, -2.0).is_none());
    let moved = look_at(&mut scene, view, 5.0, -1.0).unwrap();
    assert_eq!(moved.path, hit.path);
    let there = scene.frame_at(view, &moved.path).unwrap().unwrap().translation;
    assert!(there.distance(Vec3::new(5.0, -1.0, 1.0)) < 1e-5, "{there}");
    assert_eq!(scene.frame_at(view, &[9]).unwrap(), None);
}

#[test]
fn a_drag_that_edits_a_slot_compiles_what_reads_it_alone() {
    let mut scene = Scene::new();
    let top = scene.add(Group);
    let styled = scene.add_to(top, Attribute::new()).unwrap();
    scene.add_to(styled, plate()).unwrap();
    let aside = scene.add_to(top, Transform::translation(5.0, 0.0, 0.0)).unwrap();
    scene.add_to(aside, plate()).unwrap();
    let view = scene.open_view(top, &built_in_rules()).unwrap();
    scene.bounds(view).unwrap();
    let hit = look_at(&mut scene, view, 0.0, 0.0).unwrap();
    let along = scene.components_along(view, &hit.path).unwrap();
    assert_eq!(along[..2], [top.id(), styled.id()]);

    scene.set_logging(true);
    let picked = scene.nearest::<Attribute>(view, &hit.path).unwrap().unwrap();
    scene.push::<StyleSlot>(picked, Style::Wire).unwrap();
    assert!(look_at(&mut scene, view, 0.0, 0.0).is_none(), "wires let rays through");
    let log = scene.take_log();
    let compiled = log.iter().filter(|event| event.action == Action::Compiled);
    let compiled: Vec<_> = compiled.map(|event| event.kind.name()).collect();
    assert_eq!(compiled, ["attribute", "held_geometry"]);
}
