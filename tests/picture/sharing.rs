//! What is shared looks the same as if it were not, in whatever order it is met.

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::geom::{Polyline, Shared, SharedMesh, content};
use sapwood::graph::{Light, LightShape, Material, Named};
use sapwood::picture::{Ground, Picture, PictureOptions, PlacedCamera};
use sapwood::scene::{
    Component, Context, Group, HeldGeometry, NodeId, Rule, RuleError, Scene, Transform, ViewId,
};

use super::scenes::{LENS, ball, camera, cuboid, taken};

/// A rod, drawn as a line.
#[derive(Debug, Clone)]
struct Rod;
content!(Rod {});
impl Named for Rod {
    const NAME: &'static str = "rod";
}
impl Component for Rod {}

struct RodRule;
impl Rule for RodRule {
    type Component = Rod;
    type Data = ();
    const NAME: &'static str = "rod";
    fn init(&self, _: &Rod, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let points = vec![Vec3::ZERO, Vec3::Y * 3.0];
        cx.lines(Shared::new(vec![Polyline { points, radii: vec![0.1, 0.0] }]));
        Ok(())
    }
}

fn stone() -> Material {
    Material { double_sided: true, ..Material::matte("stone", 0.6, 0.5, 0.4) }
}

/// Twelve stones on a square metre.
fn heap(scene: &mut Scene) -> NodeId {
    let heap: NodeId = scene.add(Group).into();
    let mesh = SharedMesh::new(ball(6));
    for i in 0..12 {
        let place = Vec3::new((i % 4) as f32 * 0.3, 0.1, (i / 4) as f32 * 0.3);
        let scale = Affine3::from_scale(Vec3::splat(0.14));
        let place = scene.add_to(heap, Transform(Affine3::from_translation(place) * scale));
        let material = Some(stone().into());
        scene.add_to(place.unwrap(), HeldGeometry { mesh: mesh.clone(), material }).unwrap();
    }
    heap
}

fn lamp(scene: &mut Scene) -> NodeId {
    let lamp: NodeId = scene.add(Group).into();
    let shape = LightShape::Point { range: None };
    let light = Light { name: String::new(), color: [1.0, 0.8, 0.5], intensity: 2.0, shape };
    let above = scene.add_to(lamp, Transform(Affine3::from_translation(Vec3::Y * 1.2))).unwrap();
    scene.add_to(above, light).unwrap();
    scene.add_to(lamp, Rod).unwrap();
    lamp
}

#[derive(Clone, Copy)]
enum Which {
    /// The lamp by itself.
    Lamp,
    /// The heap with the lamp in it.
    Both,
}

/// The lamp once by itself, and a heap with the lamp in it twice, in this order.
fn scene(order: [Which; 3]) -> (Scene, ViewId) {
    let mut scene = Scene::new();
    let lamp = lamp(&mut scene);
    let both = heap(&mut scene);
    scene.append(both, lamp).unwrap();
    let root: NodeId = scene.add(Group).into();
    let mut x = [-2.0, 2.0].into_iter();
    for which in order {
        let (place, node) = match which {
            Which::Lamp => (Vec3::Z * -2.0, lamp),
            Which::Both => (Vec3::X * x.next().unwrap(), both),
        };
        let place = scene.add_to(root, Transform(Affine3::from_translation(place))).unwrap();
        scene.append(place, node).unwrap();
    }
    let rules = sapwood::standard_rules().with(RodRule);
    let view = scene.open_view(root, &rules).unwrap();
    (scene, view)
}

fn options() -> PictureOptions {
    let ground = Some(Ground::default());
    let sun = None;
    PictureOptions { size: [64, 48], samples: 2, ground, sun, ..PictureOptions::default() }
}

fn seen(order: [Which; 3], is_warm: bool) -> Picture {
    let (mut scene, view) = scene(order);
    let camera =
        PlacedCamera::look_at(LENS, Vec3::new(3.0, 6.0, 12.0), Vec3::new(0.0, 0.5, 0.0)).unwrap();
    if is_warm {
        scene.bounds(view).unwrap();
    }
    taken(&mut scene, view, &camera, &options())
}

#[test]
fn lamps_and_lines_are_there_at_every_place_whatever_comes_first() {
    use Which::{Both, Lamp};
    let first = seen([Lamp, Both, Both], false);
    // Three lamps shine on whatever is hit.
    assert!(first.rays.shadow > 2 * first.rays.primary, "{:?}", first.rays);
    for order in [[Lamp, Both, Both], [Both, Lamp, Both], [Both, Both, Lamp]] {
        for is_warm in [false, true] {
            let picture = seen(order, is_warm);
            assert_eq!(picture.rays, first.rays);
            assert!(picture.image == first.image);
        }
    }
}

#[test]
fn forty_levels_of_diamonds_are_drawn_in_no_time_even_if_they_hold_nothing() {
    for leaf in [None, Some(cuboid(Vec3::NEG_ONE, Vec3::ONE))] {
        let mut scene = Scene::new();
        let mut node: NodeId = scene.add(Group).into();
        let is_drawn = leaf.is_some();
        if let Some(mesh) = leaf {
            let material = Some(stone().into());
            let mesh = SharedMesh::new(mesh);
            scene.add_to(node, HeldGeometry { mesh, material }).unwrap();
        }
        for _ in 0..40 {
            let above: NodeId = scene.add(Group).into();
            scene.append(above, node).unwrap();
            scene.append(above, node).unwrap();
            node = above;
        }
        let view = scene.open_view(node, &sapwood::standard_rules()).unwrap();
        let camera = if is_drawn {
            camera(&mut scene, view, [8, 8])
        } else {
            PlacedCamera::look_at(LENS, Vec3::Z * 9.0, Vec3::ZERO).unwrap()
        };
        let options = PictureOptions { size: [8, 8], ..options() };
        let picture = taken(&mut scene, view, &camera, &options);
        assert_eq!(picture.rays.primary, 128);
    }
}
