//! Picking: what a ray meets is what testing every triangle finds, what is compiled for it, and
//! how a hit leads back to what can be edited.

pub(crate) mod every_triangle;

use sapwood::geom::glam::{Affine3, Mat3, Vec3};
use sapwood::geom::{Bound, Ray, Shared, SharedMesh, content};
use sapwood::graph::{
    Anchor, Label, Material, Named, Part, PickOptions, PickedSides, Shown, Struck,
};
use sapwood::rules::weber_penn::{Leaf, Seed, Stem, Tree, leaf_mesh};
use sapwood::scene::{
    Component, Context, Group, HeldGeometry, NodeId, Rule, RuleError, RuleSet, Scene, Transform,
    ViewId,
};

use super::kinds::*;
use every_triangle::{Rays, check};

/// Repeats a leaf at the corners of a grid, each turned and scaled another way, some mirrored;
/// parts say which is which.
#[derive(Debug, Clone)]
struct Scatter {
    n: u32,
}
content!(Scatter { n });
impl Named for Scatter {
    const NAME: &'static str = "scatter";
}
impl Component for Scatter {}

#[derive(Debug, Clone)]
struct Speck {
    number: u32,
}
content!(Speck { number });
impl Named for Speck {
    const NAME: &'static str = "speck";
}
impl Part for Speck {}

struct ScatterRule;
impl Rule for ScatterRule {
    type Component = Scatter;
    type Data = ();
    const NAME: &'static str = "scatter";
    fn init(&self, scatter: &Scatter, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let place = |i: u32| {
            let at = Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32);
            let mirror = if i.is_multiple_of(3) { -1.0 } else { 1.0 };
            let scale = Mat3::from_diagonal(Vec3::new(mirror, 0.5 + (i % 7) as f32 / 7.0, 0.8));
            Affine3::from_mat3_translation(Mat3::from_rotation_x(i as f32) * scale, at)
        };
        let shape = sapwood::rules::weber_penn::LeafShape::Oval;
        let green = Material::matte("leaf", 0.0, 1.0, 0.0);
        let transforms = Shared::new((0..scatter.n).map(place).collect());
        cx.instances(SharedMesh::new(leaf_mesh(shape)), green.into(), transforms);
        cx.shows(Shown::each::<Speck>());
        cx.parts((0..scatter.n).map(|number| Speck { number }).collect::<Vec<_>>());
        Ok(())
    }
}

fn all_rules() -> RuleSet {
    RuleSet::new().with(ScatterRule).with(BeadsRule).with(SignRule).over(&sapwood::standard_rules())
}

/// Shared, scaled, mirrored, sheared, flattened and instanced geometry under one root.
fn workshop() -> (Scene, ViewId) {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let scatter = scene.add(Scatter { n: 300 });
    let plate =
        scene.add(HeldGeometry::new(triangle(3.0), Material::matte("plate", 0.5, 0.5, 0.5)));
    let shear = Mat3::from_cols(Vec3::X, Vec3::new(0.7, 1.0, 0.0), Vec3::new(0.0, 0.4, 1.0));
    let frames = [
        Mat3::IDENTITY,
        Mat3::from_rotation_y(0.6) * Mat3::from_diagonal(Vec3::new(-1.0, 2.0, 0.5)),
        Mat3::from_rotation_z(2.0) * shear,
        Mat3::from_rotation_x(1.0) * Mat3::from_diagonal(Vec3::new(1.0, 0.0, 1.0)),
        Mat3::from_rotation_x(0.3) * Mat3::from_diagonal(Vec3::splat(0.01)),
        Mat3::from_diagonal(Vec3::splat(30.0)),
    ];
    for (i, frame) in frames.into_iter().enumerate() {
        let at = Vec3::new(12.0 * i as f32, 0.0, -5.0);
        let place =
            scene.add_to(root, Transform(Affine3::from_mat3_translation(frame, at))).unwrap();
        let both = scene.add_to(place, Group).unwrap();
        scene.append(both, scatter).unwrap();
        scene.append(both, plate).unwrap();
    }
    let view = scene.open_view(root, &all_rules()).unwrap();
    (scene, view)
}

#[test]
fn picking_is_testing_every_triangle_of_every_occurrence() {
    let (mut scene, view) = workshop();
    let mut rays = Rays::new(scene.bounds(view).unwrap(), 1);
    let hits = check(&mut scene, view, &rays.take(3_000), &PickOptions::default());
    assert!(hits > 500, "{hits}");
    let drawn = PickOptions { sides: PickedSides::AsDrawn, ..PickOptions::default() };
    let fronts = check(&mut scene, view, &rays.take(1_000), &drawn);
    assert!(fronts > 50, "{fronts}");
}

fn aspen(scene: &mut Scene) -> ViewId {
    let species = sapwood::io::built_in("quaking_aspen").unwrap();
    let place = scene.add(Transform(Affine3::from_rotation_z(0.2)));
    let family = scene.add_to(place, species.attribute()).unwrap();
    scene.add_to(family, Tree { seed: Seed::Explicit(1) }).unwrap();
    scene.open_view(place, &sapwood::standard_rules()).unwrap()
}

#[test]
fn picking_a_tree_is_testing_every_triangle() {
    let mut scene = Scene::new();
    let view = aspen(&mut scene);
    let mut rays = Rays::new(scene.bounds(view).unwrap(), 3);
    let hits = check(&mut scene, view, &rays.take(1_500), &PickOptions::default());
    assert!(hits > 200, "{hits}");
}

#[test]
fn picks_while_the_scene_is_edited_are_picks_of_a_new_scene() {
    let (mut scene, view) = workshop();
    let mut rays = Rays::new(scene.bounds(view).unwrap(), 7);
    let root = scene.nodes().find(|node| scene.parents(*node).next().is_none()).unwrap();
    let places: Vec<_> = scene.children(root).collect();
    for round in 0..20 {
        // Picks compile what they need of it, so other sites stay unsettled for many rounds.
        let place = scene.handle::<Transform>(places[round % places.len()]).unwrap();
        scene.edit(place, |place| place.0.translation.y += 0.3).unwrap();
        if round % 4 == 3 {
            check(&mut scene, view, &rays.take(30), &PickOptions::default());
        } else {
            scene.pick(view, &rays.next(), &PickOptions::default()).unwrap();
        }
    }
}

#[test]
fn a_cold_pick_meets_what_a_warm_one_meets() {
    let (mut warm, warm_view) = workshop();
    let bound = warm.bounds(warm_view).unwrap();
    let mut rays = Rays::new(bound, 4);
    for _ in 0..30 {
        let ray = rays.next();
        let (mut cold, cold_view) = workshop();
        let options = PickOptions::default();
        assert_eq!(
            cold.pick(cold_view, &ray, &options).unwrap(),
            warm.pick(warm_view, &ray, &options).unwrap()
        );
    }
}

/// Plain components in a row along x, each with a bound told before.
#[derive(Debug, Clone)]
struct Beads;
content!(Beads {});
impl Named for Beads {
    const NAME: &'static str = "beads";
}
impl Component for Beads {}

struct BeadsRule;
impl Rule for BeadsRule {
    type Component = Beads;
    type Data = ();
    const NAME: &'static str = "beads";
    fn init(&self, _: &Beads, cx: &mut Context<'_>) -> Result<(), RuleError> {
        for i in 0..50u64 {
            let size = 1.0 + i as f32 / 16.0;
            let bound = Bound::of_points([Vec3::ZERO, Vec3::new(size, size, 0.0)]);
            // Leaning toward +x, so that a ray along x meets all of them.
            let at = Affine3::from_translation(Vec3::X * 10.0 * i as f32);
            let at = at * Affine3::from_rotation_y(1.0);
            cx.transform(at, |cx| cx.emit_keyed(i, Plain { size }, Some(bound)));
        }
        Ok(())
    }
}

#[test]
fn only_what_the_ray_may_meet_is_compiled() {
    let mut scene = checked_scene();
    let root = scene.add(Beads);
    let rules = all_rules().over(&rules());
    let view = scene.open_view(root, &rules).unwrap();
    let options = PickOptions::default();
    let down = |x: f32| Ray::new(Vec3::new(x, 0.2, 9.0), Vec3::NEG_Z);
    assert_eq!(scene.pick(view, &down(105.0), &options).unwrap(), None);
    assert_eq!(all_compiled(&mut scene), [("beads", 1)]);
    let hit = scene.pick(view, &down(100.1), &options).unwrap().unwrap();
    assert_eq!((hit.kind.name(), hit.path), ("plain", vec![0, 10]));
    assert_eq!(all_compiled(&mut scene), [("plain", 1)]);
    // What lies behind what is known and met stays uncompiled.
    let along = Ray::new(Vec3::new(55.0, 0.2, -0.1), Vec3::X);
    let hit = scene.pick(view, &along.between(0.0, 48.0), &options).unwrap().unwrap();
    assert_eq!(hit.path, [0, 6]);
    assert_eq!(all_compiled(&mut scene), [("plain", 4)]);
    assert_eq!(scene.pick(view, &along, &options).unwrap().unwrap().path, [0, 6]);
    assert_eq!(all_compiled(&mut scene), []);
}

#[test]
fn a_picked_path_leads_back_to_the_component_and_edits_it() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    scene.add_to(root, Plain { size: 1.0 }).unwrap();
    let place = scene.add_to(root, at(5)).unwrap();
    let plain = scene.add_to(place, Plain { size: 1.0 }).unwrap();
    let view = scene.open_view(root, &rules()).unwrap();
    let ray = Ray::new(Vec3::new(6.5, 0.2, 3.0), Vec3::NEG_Z);
    let options = PickOptions::default();
    assert_eq!(scene.pick(view, &ray, &options).unwrap(), None);
    let nearer = Ray::new(Vec3::new(5.5, 0.2, 3.0), Vec3::NEG_Z);
    let hit = scene.pick(view, &nearer, &options).unwrap().unwrap();
    let component = scene.component_at(view, &hit.path).unwrap().unwrap();
    assert_eq!(component, plain.id());
    let handle = scene.handle::<Plain>(component).unwrap();
    scene.edit(handle, |plain| plain.size = 2.0).unwrap();
    let hit = scene.pick(view, &ray, &options).unwrap().unwrap();
    assert_eq!(scene.component_at(view, &hit.path).unwrap(), Some(plain.id()));
    assert_eq!(scene.component_at(view, &hit.path[..2]).unwrap(), Some(place.id()));
    assert_eq!(scene.component_at(view, &[]).unwrap(), None);
    assert_eq!(scene.component_at(view, &[0, 7]).unwrap(), None);
    scene.remove(place).unwrap();
    assert_eq!(scene.component_at(view, &hit.path).unwrap(), None);
    assert_eq!(scene.pick(view, &ray, &options).unwrap(), None);
}

#[test]
fn what_was_emitted_leads_to_the_component_that_the_user_placed() {
    let mut scene = Scene::new();
    let view = aspen(&mut scene);
    let bound = scene.bounds(view).unwrap();
    let mut rays = Rays::new(bound, 5);
    let tree = scene.nodes().find(|node| scene.handle::<Tree>(*node).is_some()).unwrap();
    let (mut n_stems, mut n_leaves) = (0, 0);
    for _ in 0..400 {
        let ray = rays.next();
        let Some(hit) = scene.pick(view, &ray, &PickOptions::default()).unwrap() else { continue };
        assert_eq!(scene.component_at(view, &hit.path).unwrap(), Some(tree));
        let part = hit.part.unwrap();
        let whole = every_triangle::plan_at(&mut scene, view, hit.part_path(), |plan, world| {
            let local = world.inverse().transform_point3(hit.point);
            let (leaves, stems) = (plan.parts.of::<Leaf>(), plan.parts.of::<Stem>());
            if part.kind.name() == "leaf" {
                let leaf = &leaves[part.row as usize];
                assert!(local.distance(leaf.frame.origin) <= 1.1 * leaf.length, "{hit:?}");
                (1, 0)
            } else {
                let stem = &stems[part.row as usize];
                let reach = stem.seed.length + 2.0 * stem.seed.radius;
                assert!(local.distance(stem.seed.frame.origin) <= 1.5 * reach, "{hit:?}");
                (0, 1)
            }
        });
        (n_leaves, n_stems) = (n_leaves + whole.0, n_stems + whole.1);
    }
    assert!(n_leaves > 20 && n_stems > 5, "{n_leaves} leaves, {n_stems} stems");
}

#[test]
fn instances_tell_their_parts() {
    let (mut scene, view) = workshop();
    let bound = scene.bounds(view).unwrap();
    let mut rays = Rays::new(bound, 6);
    let mut n = 0;
    for _ in 0..500 {
        let Some(hit) = scene.pick(view, &rays.next(), &PickOptions::default()).unwrap() else {
            continue;
        };
        if let Struck::Triangle { instance: Some(instance), .. } = hit.struck {
            let part = hit.part.unwrap();
            assert_eq!((part.kind.name(), part.row), ("speck", instance));
            assert_eq!(hit.part_path(), hit.path);
            n += 1;
        }
    }
    assert!(n > 20, "{n}");
}

/// A label and a line, crossing in the plane z = 0.
#[derive(Debug, Clone)]
struct Sign;
content!(Sign {});
impl Named for Sign {
    const NAME: &'static str = "sign";
}
impl Component for Sign {}

struct SignRule;
impl Rule for SignRule {
    type Component = Sign;
    type Data = ();
    const NAME: &'static str = "sign";
    fn init(&self, _: &Sign, cx: &mut Context<'_>) -> Result<(), RuleError> {
        cx.label(Label { anchor: Anchor::Middle, ..Label::new("inn", 1.0) });
        let points = vec![Vec3::new(-9.0, 0.0, 1.0), Vec3::new(9.0, 0.0, 1.0)];
        let line = sapwood::geom::Polyline { points, radii: vec![0.0; 2] };
        cx.lines(Shared::new(vec![line]));
        Ok(())
    }
}

#[test]
fn labels_are_met_by_their_rectangle_and_lines_by_a_radius() {
    let mut scene = Scene::new();
    let place = scene.add(Transform(Affine3::from_scale(Vec3::splat(2.0))));
    scene.add_to(place, Sign).unwrap();
    let view = scene.open_view(place, &all_rules()).unwrap();
    let mut struck = |x: f32, y: f32, options: &PickOptions| {
        let ray = Ray::new(Vec3::new(x, y, 10.0), Vec3::NEG_Z);
        let hit = scene.pick(view, &ray, options).unwrap();
        hit.map(|hit| {
            assert!((hit.normal - Vec3::Z).length() < 0.3, "{hit:?}");
            (hit.struck, hit.distance)
        })
    };
    let by_default = PickOptions::default();
    assert_eq!(struck(0.0, 1.0, &by_default), Some((Struck::Label, 10.0)));
    assert_eq!(struck(5.0, 1.0, &by_default), None);
    assert_eq!(struck(0.0, 1.0, &PickOptions { labels: false, ..by_default }), None);
    let with_lines = PickOptions { line_radius: Some(0.1), ..by_default };
    let line = |along| Some((Struck::Line { line: 0, stretch: 0, along }, 8.0));
    assert_eq!(struck(0.0, 0.09, &with_lines), line(0.5));
    assert_eq!(struck(9.0, 0.0, &with_lines), line(0.75));
    assert_eq!(struck(0.0, 0.11, &with_lines), Some((Struck::Label, 10.0)));
    assert_eq!(struck(18.05, 0.0, &with_lines), line(1.0));
    assert_eq!(struck(18.2, 0.0, &with_lines), None);
}

#[test]
fn of_things_as_near_the_first_in_pre_order_is_met() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let far = scene.add_to(root, at(0)).unwrap();
    scene.add_to(far, Plain { size: 4.0 }).unwrap();
    scene.add_to(root, Plain { size: 1.0 }).unwrap();
    let view = scene.open_view(root, &rules()).unwrap();
    let ray = Ray::new(Vec3::new(0.2, 0.2, 3.0), Vec3::NEG_Z);
    let hit = scene.pick(view, &ray, &PickOptions::default()).unwrap().unwrap();
    assert_eq!(hit.path, [0, 0, 0]);
    scene.reorder(root, 0, 1).unwrap();
    let hit = scene.pick(view, &ray, &PickOptions::default()).unwrap().unwrap();
    assert_eq!(hit.path, [0, 0]);
}

#[test]
fn a_hit_tells_all_about_the_surface() {
    let mut scene = Scene::new();
    let mut mesh = triangle(1.0);
    mesh.normals = vec![Vec3::new(0.6, 0.0, 0.8), Vec3::Z, Vec3::Z];
    mesh.uvs = vec![[0.0, 0.0].into(), [1.0, 0.0].into(), [0.0, 1.0].into()];
    let squashed = Affine3::from_scale(Vec3::new(-2.0, 2.0, 0.5));
    let place = scene.add(Transform(squashed));
    scene.add_to(place, HeldGeometry::new(mesh, Material::matte("m", 1.0, 1.0, 1.0))).unwrap();
    let view = scene.open_view(place, &sapwood::standard_rules()).unwrap();
    let mut hit = |z: f32| {
        let ray = Ray::new(Vec3::new(-0.5, 0.5, z), Vec3::new(0.0, 0.0, -7.0 * z));
        scene.pick(view, &ray, &PickOptions::default()).unwrap().unwrap()
    };
    let front = hit(4.0);
    assert_eq!((front.distance, front.normal, front.node), (4.0, Vec3::Z, 1));
    assert!(front.point.distance(Vec3::new(-0.5, 0.5, 0.0)) < 1e-6);
    let Struck::Triangle { weights, shading_normal, uv, is_front, .. } = front.struck else {
        panic!("{front:?}");
    };
    assert_eq!((weights, is_front), ([0.5, 0.25, 0.25], true));
    assert!(uv.distance([0.25, 0.25].into()) < 1e-6, "{uv}");
    // Half of (0.6, 0, 0.8) and half of z, after the inverse transpose.
    let expected = Vec3::new(-0.3 / 2.0, 0.0, 0.9 / 0.5).normalize();
    assert!(shading_normal.distance(expected) < 1e-6, "{shading_normal}");
    let back = hit(-4.0);
    assert_eq!(back.normal, Vec3::NEG_Z);
    assert!(matches!(back.struck, Struck::Triangle { is_front: false, .. }));
}

#[test]
fn rays_that_are_none_meet_nothing() {
    let (mut scene, view) = workshop();
    let options = PickOptions::default();
    for bad in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
        assert_eq!(scene.pick(view, &Ray::new(Vec3::ZERO, bad), &options).unwrap(), None);
        let ray = Ray::new(bad, bad);
        assert_eq!(scene.pick(view, &ray, &options).unwrap(), None);
    }
    let ray = Ray::new(Vec3::ZERO, Vec3::X);
    for (min, max) in [(f32::NAN, 1.0), (0.0, f32::NAN), (2.0, 1.0)] {
        assert_eq!(scene.pick(view, &ray.between(min, max), &options).unwrap(), None);
    }
    assert_eq!(all_compiled(&mut scene), []);
}

/// Groups that each hold the next one twice, the second time so many metres away; one triangle
/// at the bottom. The top one.
fn diamonds(scene: &mut Scene, n_levels: i32, away: fn(i32) -> f32) -> NodeId {
    let mut below: NodeId = scene.add(Plain { size: 0.5 }).id();
    for level in 0..n_levels {
        let both = scene.add(Group);
        for x in [0.0, away(level)] {
            let place = scene.add(Transform(Affine3::from_translation(Vec3::X * x)));
            scene.append(place, below).unwrap();
            scene.append(both, place).unwrap();
        }
        below = both.id();
    }
    below
}

#[test]
fn picking_below_forty_shared_levels_comes_by_each_once() {
    for away in [|_| 0.0, |level| (1u32 << level.min(20)) as f32, |_| 1.0] as [fn(i32) -> f32; 3] {
        let mut scene = Scene::new();
        let top = diamonds(&mut scene, 40, away);
        let view = scene.open_view(top, &rules()).unwrap();
        let options = PickOptions { most_occurrences: 20_000, ..PickOptions::default() };
        let ray = Ray::new(Vec3::new(0.125, 0.125, 3.0), Vec3::NEG_Z);
        let hit = scene.pick(view, &ray, &options).unwrap().unwrap();
        assert_eq!(hit.path, vec![0; 81]);
        assert_eq!(scene.pick(view, &ray, &options).unwrap(), Some(hit));
    }
}

#[test]
fn a_pick_that_comes_by_too_many_places_ends_as_an_error() {
    let mut scene = Scene::new();
    let top = diamonds(&mut scene, 40, |_| 0.0);
    let view = scene.open_view(top, &rules()).unwrap();
    let options = PickOptions { most_occurrences: 20, ..PickOptions::default() };
    let ray = Ray::new(Vec3::new(0.125, 0.125, 3.0), Vec3::NEG_Z);
    let error = scene.pick(view, &ray, &options).unwrap_err();
    assert!(error.to_string().contains("more than 20 occurrences"), "{error}");
}

#[test]
fn a_shared_thing_is_met_at_its_first_place_though_a_later_one_is_come_by_before() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let shared = scene.add(Plain { size: 1.0 });
    // The second group reaches nearer to the ray's origin, so it is gone into first.
    for reach in [None, Some(1.0)] {
        let both = scene.add_to(root, Group).unwrap();
        scene.append(both, shared).unwrap();
        if let Some(z) = reach {
            let aside = Affine3::from_translation(Vec3::new(-4.0, -4.0, z));
            let place = scene.add_to(both, Transform(aside)).unwrap();
            scene.add_to(place, Plain { size: 2.0 }).unwrap();
        }
    }
    let view = scene.open_view(root, &rules()).unwrap();
    scene.bounds(view).unwrap();
    let ray = Ray::new(Vec3::new(0.2, 0.2, 3.0), Vec3::NEG_Z);
    let hit = scene.pick(view, &ray, &PickOptions::default()).unwrap().unwrap();
    assert_eq!(hit.path, [0, 0, 0]);
}
