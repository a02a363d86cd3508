//! Switches, selectors, transforms, held geometry, lights, cameras and labels.

use sapwood::graph::{Anchor, Camera, Label, Lens, Light, LightShape, Named};
use sapwood::scene::{
    Component, Group, Handle, HeldGeometry, NodeId, Scene, Selector, Switch, Transform, ViewId,
};

use super::super::kinds::*;
use super::{errors, places, sizes};

const NAN: f32 = f32::NAN;

#[test]
fn a_selector_compiles_what_it_shows_and_keeps_the_rest() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let selector = scene.add(Selector { shown: None });
    for size in [1.0, 2.0] {
        scene.add_to(selector, Plain { size }).unwrap();
    }
    for x in [0, 5] {
        let moved = scene.add_to(root, at(x)).unwrap();
        scene.append(moved, selector).unwrap();
    }
    let view = scene.open_view(root, &rules()).unwrap();
    assert_eq!(sizes(&mut scene, view), [] as [f32; 0]);
    let mut check = |shown: Option<usize>, expected: &[f32], runs: usize| {
        scene.take_log();
        scene.edit(selector, |selector| selector.shown = shown).unwrap();
        assert_eq!(sizes(&mut scene, view), expected);
        let all = all_compiled(&mut scene);
        let plain = all.iter().find(|(kind, _)| *kind == "plain").map_or(0, |(_, n)| *n);
        assert_eq!(plain, runs, "{all:?}");
        assert!(all.iter().all(|(kind, _)| ["plain", "selector"].contains(kind)), "{all:?}");
    };
    check(Some(1), &[2.0, 2.0], 1);
    check(Some(0), &[1.0, 1.0], 1);
    check(Some(1), &[2.0, 2.0], 0);
    check(Some(7), &[], 0);
    check(None, &[], 0);
}

#[test]
fn a_switch_hides_at_all_its_places() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let switch = scene.add(Switch { on: false });
    scene.add_to(switch, Plain { size: 1.0 }).unwrap();
    for x in [0, 5] {
        let moved = scene.add_to(root, at(x)).unwrap();
        scene.append(moved, switch).unwrap();
    }
    let view = scene.open_view(root, &rules()).unwrap();
    assert_eq!(sizes(&mut scene, view), [] as [f32; 0]);
    assert_eq!(compiled(&mut scene, "plain"), 0);
    scene.edit(switch, |switch| switch.on = true).unwrap();
    assert_eq!(places(&mut scene, view), [[0.0; 3], [5.0, 0.0, 0.0]]);
    assert_eq!(all_compiled(&mut scene), [("plain", 1), ("switch", 1)]);
}

/// Checks that a component that is edited becomes an error of its own, or none.
struct Faults<C: Component> {
    scene: Scene,
    view: ViewId,
    handle: Handle<C>,
    sound: C,
}

impl<C: Component + Clone> Faults<C> {
    fn new(sound: C) -> Self {
        let mut scene = checked_scene();
        let root = scene.add(Group);
        let handle = scene.add_to(root, sound.clone()).unwrap();
        scene.add_to(root, Plain { size: 9.0 }).unwrap();
        let view = scene.open_view(root, &rules()).unwrap();
        let mut new = Self { scene, view, handle, sound };
        new.is_sound(|_| {});
        new
    }

    fn after(&mut self, change: impl FnOnce(&mut C)) -> Vec<(&'static str, String)> {
        let sound = self.sound.clone();
        self.scene.edit(self.handle, |component| *component = sound).unwrap();
        self.scene.edit(self.handle, change).unwrap();
        let drawn = sizes(&mut self.scene, self.view);
        assert_eq!(drawn.last(), Some(&9.0), "the neighbour is drawn");
        errors(&mut self.scene, self.view)
    }

    fn is_sound(&mut self, change: impl FnOnce(&mut C)) {
        assert_eq!(self.after(change), []);
    }

    fn is_faulty(&mut self, change: impl FnOnce(&mut C)) {
        let errors = self.after(change);
        assert_eq!(errors.len(), 1, "{errors:?}");
        assert_eq!(errors[0].0, <C as Named>::NAME);
    }
}

#[test]
fn faulty_lights_become_diagnostics() {
    let spot = LightShape::Spot { range: Some(10.0), inner: 0.1, outer: 0.5 };
    let sound = Light { name: "lamp".to_owned(), color: [1.0; 3], intensity: 2.0, shape: spot };
    let mut faults = Faults::new(sound);
    faults.is_faulty(|light| light.intensity = NAN);
    faults.is_faulty(|light| light.intensity = -1.0);
    faults.is_faulty(|light| light.color[1] = f32::INFINITY);
    faults.is_faulty(|light| light.shape = LightShape::Point { range: Some(0.0) });
    faults.is_faulty(|light| light.shape = LightShape::Point { range: Some(NAN) });
    let cone = |inner, outer| LightShape::Spot { range: None, inner, outer };
    faults.is_faulty(|light| light.shape = cone(NAN, 1.0));
    faults.is_faulty(|light| light.shape = cone(0.1, NAN));
    faults.is_faulty(|light| light.shape = cone(0.5, 0.1));
    faults.is_sound(|light| light.shape = LightShape::Directional);
    faults.is_sound(|light| light.intensity = 0.0);
}

#[test]
fn faulty_cameras_become_diagnostics() {
    let lens = Lens::Perspective { vertical_angle: 1.0 };
    let mut faults = Faults::new(Camera { name: String::new(), lens, near: 0.1, far: Some(10.0) });
    faults.is_faulty(|camera| camera.near = NAN);
    faults.is_faulty(|camera| camera.near = 0.0);
    faults.is_faulty(|camera| camera.far = Some(NAN));
    faults.is_faulty(|camera| camera.far = Some(0.05));
    faults.is_faulty(|camera| camera.lens = Lens::Perspective { vertical_angle: NAN });
    faults.is_faulty(|camera| camera.lens = Lens::Perspective { vertical_angle: 4.0 });
    faults.is_faulty(|camera| camera.lens = Lens::Orthographic { height: NAN });
    faults.is_sound(|camera| camera.lens = Lens::Orthographic { height: 3.0 });
    faults.is_sound(|camera| camera.far = None);
}

#[test]
fn faulty_labels_become_diagnostics() {
    let mut faults = Faults::new(Label::new("text", 1.0));
    faults.is_faulty(|label| label.height = NAN);
    faults.is_faulty(|label| label.height = 0.0);
    faults.is_faulty(|label| label.height = f32::INFINITY);
    faults.is_faulty(|label| label.color[0] = NAN);
    faults.is_sound(|label| label.text.clear());
    faults.is_sound(|label| label.anchor = Anchor::End);
}

#[test]
fn faulty_transforms_become_diagnostics() {
    let mut faults = Faults::new(Transform::translation(1.0, 2.0, 3.0));
    faults.is_faulty(|transform| transform.0.translation.x = NAN);
    faults.is_faulty(|transform| transform.0.matrix3.y_axis.z = f32::INFINITY);
    faults.is_sound(|transform| transform.0.matrix3 = sapwood::geom::glam::Mat3::ZERO);
}

#[test]
fn faulty_geometry_becomes_a_diagnostic() {
    let mut faults = Faults::new(HeldGeometry::plain(triangle(1.0)));
    faults.is_faulty(|held| *held = HeldGeometry::plain(triangle(NAN)));
    faults.is_faulty(|held| *held = HeldGeometry::plain(triangle(f32::INFINITY)));
    faults.is_faulty(|held| {
        let mut mesh = triangle(1.0);
        mesh.indices[2] = 3;
        *held = HeldGeometry::plain(mesh);
    });
}

#[test]
fn lights_cameras_and_labels_are_listed_where_they_stand() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let shared = scene.add(Group);
    let light = Light {
        name: "lamp".to_owned(),
        color: [1.0, 0.5, 0.25],
        intensity: 2.0,
        shape: LightShape::Point { range: None },
    };
    let lens = Lens::Perspective { vertical_angle: 1.0 };
    scene.add_to(shared, light.clone()).unwrap();
    scene.add_to(shared, Camera { name: "c".to_owned(), lens, near: 0.1, far: None }).unwrap();
    let label = scene.add_to(shared, Label::new("here", 1.0)).unwrap();
    let mut moved: Vec<NodeId> = Vec::new();
    for x in [1, 5] {
        moved.push(scene.add_to(root, at(x)).unwrap().id());
        scene.append(moved[moved.len() - 1], shared).unwrap();
    }
    let view = scene.open_view(root, &rules()).unwrap();
    let list = scene.draw_list(view, 6).unwrap();
    let lights: Vec<_> =
        list.placed_lights().map(|(world, light)| (world.translation.x, light)).collect();
    assert_eq!(lights, [(1.0, &light), (5.0, &light)]);
    let cameras: Vec<_> =
        list.placed_cameras().map(|(world, camera)| (world.translation.x, &*camera.name)).collect();
    assert_eq!(cameras, [(1.0, "c"), (5.0, "c")]);
    let labels: Vec<_> =
        list.placed_labels().map(|(world, label)| (world.translation.x, &*label.text)).collect();
    assert_eq!(labels, [(1.0, "here"), (5.0, "here")]);
    assert!(scene.draw_list(view, 5).is_err(), "rows of all sorts count");
    scene.take_log();
    scene.edit(label, |label| label.text = "there".to_owned()).unwrap();
    scene.draw_list(view, 6).unwrap();
    assert_eq!(all_compiled(&mut scene), [("label", 1)]);
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 5.0 + 5.0);
}
