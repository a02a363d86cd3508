//! Four views of one scene: full, skeleton, map and text, under rules of their own.

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::geom::{Mesh, Purpose, Shared, SharedMesh, Stream, StreamPath};
use sapwood::graph::{Camera, DrawList, Everything, Lens, Light, LightShape, Material, Order};
use sapwood::rules::weber_penn::{Leaf, Seed, Segment, Species, Stem, Tree};
use sapwood::scene::{
    Attribute, Group, Handle, HeldGeometry, HeldInstances, Rotor, Scene, Switch, Transform, ViewId,
};

use super::trees::*;

const MANY: usize = 100_000;

/// Three trees, two of one species; the second stands turned, larger, and beside the origin.
struct Grove {
    scene: Scene,
    root: Handle<Group>,
    trees: Vec<Handle<Tree>>,
}

fn grove() -> Grove {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let aspens = scene.add_to(root, sapling().attribute()).unwrap();
    let pair = scene.add_to(aspens, Group).unwrap();
    let mut trees = vec![scene.add_to(pair, Tree { seed: Seed::Explicit(1) }).unwrap()];
    let turned = Affine3::from_scale_rotation_translation(
        Vec3::splat(1.5),
        sapwood::geom::glam::Quat::from_rotation_y(1.0),
        Vec3::new(12.0, 0.5, 3.0),
    );
    let place = scene.add_to(pair, Transform(turned)).unwrap();
    trees.push(scene.add_to(place, Tree { seed: Seed::Explicit(2) }).unwrap());
    let wheat = scene.add_to(root, built_in("wheat").attribute()).unwrap();
    let place = scene.add_to(wheat, Transform::translation(5.0, 0.0, -4.0)).unwrap();
    trees.push(scene.add_to(place, Tree { seed: Seed::Explicit(3) }).unwrap());
    Grove { scene, root, trees }
}

impl Grove {
    fn views(&mut self) -> [ViewId; 4] {
        let all = [
            sapwood::standard_rules(),
            sapwood::skeleton_rules(),
            sapwood::map_rules(),
            sapwood::text_rules(),
        ];
        all.map(|rules| self.scene.open_view(self.root, &rules).unwrap())
    }
}

/// What each view gives, and which kinds were compiled how often for all of them together.
fn given(grove: &mut Grove, views: [ViewId; 4]) -> ([String; 4], Vec<(&'static str, usize)>) {
    let [full, skeleton, map, text] = views;
    let scene = &mut grove.scene;
    let given = [
        format!("{:?}", digest(&scene.draw_list(full, MANY).unwrap())),
        sapwood::io::svg(&scene.draw_list(skeleton, MANY).unwrap()).unwrap(),
        sapwood::io::svg_map(&scene.draw_list(map, MANY).unwrap()).unwrap(),
        scene.outline(text, MANY).unwrap(),
    ];
    (given, compiled(scene, full))
}

/// How often a kind was compiled.
fn times(compiled: &[(&'static str, usize)], kind: &str) -> usize {
    compiled.iter().find(|(name, _)| *name == kind).map_or(0, |(_, n)| *n)
}

#[test]
fn an_edit_of_one_tree_changes_all_views_and_grows_it_once() {
    let mut grove = grove();
    let views = grove.views();
    let (before, cold) = given(&mut grove, views);
    let (again, none) = given(&mut grove, views);
    assert_eq!((&again, none), (&before, vec![]));

    // What one tree takes by itself, in the full view alone.
    let mut alone = planted(&sapling(), 5);
    let grown = ["branch", "children", "twigs"];
    let needed = alone.compiled();
    let needed: Vec<usize> = grown.iter().map(|kind| times(&needed, kind)).collect();

    let edited = grove.trees[1];
    grove.scene.edit(edited, |tree| tree.seed = Seed::Explicit(5)).unwrap();
    let (after, compiled) = given(&mut grove, views);
    for (before, after) in before.iter().zip(&after) {
        assert_ne!(before, after);
    }
    // Each rule set compiles the tree; of its growth there is one.
    let found: Vec<usize> = grown.iter().map(|kind| times(&compiled, kind)).collect();
    assert_eq!(found, needed, "{compiled:?}");
    assert_eq!((times(&compiled, "tree"), times(&compiled, "tree_survey")), (2, 2));
    for (kind, n) in &compiled {
        let of_all = times(&cold, kind);
        assert!(*n < of_all || !grown.contains(kind), "{n} of {of_all} {kind} again");
    }

    // Whichever view asks first, the same is grown once.
    grove.scene.edit(edited, |tree| tree.seed = Seed::Explicit(6)).unwrap();
    grove.scene.outline(views[3], MANY).unwrap();
    let mut other = planted(&sapling(), 6);
    let needed = other.compiled();
    let (_, compiled) = given(&mut grove, views);
    for kind in grown {
        assert_eq!(times(&compiled, kind), times(&needed, kind), "{kind}");
    }
}

#[test]
fn a_tree_that_is_moved_is_not_surveyed_again() {
    let mut scene = checked_scene();
    let family = scene.add(sapling().attribute());
    let place = scene.add_to(family, Transform::translation(1.0, 0.0, 0.0)).unwrap();
    scene.add_to(place, Tree { seed: Seed::Explicit(1) }).unwrap();
    let map = scene.open_view(family, &sapwood::map_rules()).unwrap();
    scene.bounds(map).unwrap();
    scene.take_log();
    scene.edit(place, |place| *place = Transform::translation(7.0, 2.0, 0.0)).unwrap();
    assert_eq!(compiled(&mut scene, map), [("transform", 1)]);
    // Turned, it shows another side; nothing grows.
    let turn = Affine3::from_rotation_z(0.4);
    scene.edit(place, |place| *place = Transform(turn)).unwrap();
    assert_eq!(compiled(&mut scene, map), [("transform", 1), ("tree_survey", 1)]);
}

/// The crown disc of the only tree of a list: its middle, and how far its border is from there.
fn disc(list: &DrawList) -> (Vec3, f32) {
    let (world, row) = list
        .placed_rows()
        .find(|(_, row)| row.material.name == "crown_disc")
        .expect("a crown has a disc");
    let corners: Vec<Vec3> =
        row.mesh.positions.iter().map(|p| world.transform_point3(*p)).collect();
    let middle = corners.iter().sum::<Vec3>() / corners.len() as f32;
    (middle, corners.iter().map(|corner| corner.distance(middle)).fold(0.0, f32::max))
}

#[test]
fn a_crown_disc_is_as_wide_as_what_grew() {
    for (name, place) in [
        ("quaking_aspen", Affine3::IDENTITY),
        ("palm", Affine3::from_translation(Vec3::new(3.0, 1.0, -2.0))),
        ("weeping_willow", Affine3::from_rotation_y(2.0)),
        ("japanese_maple", Affine3::from_rotation_x(0.7) * Affine3::from_scale(Vec3::splat(0.3))),
    ] {
        let mut species = built_in(name);
        // Enough of it, and quick.
        species.leaves.quality *= 0.05;
        let mut scene = checked_scene();
        let family = scene.add(species.attribute());
        let place = scene.add_to(family, Transform(place)).unwrap();
        scene.add_to(place, Tree { seed: Seed::Explicit(4) }).unwrap();
        let full = scene.open_view(family, &sapwood::standard_rules()).unwrap();
        let mut points: Vec<Vec3> = Vec::new();
        let (mut feet, mut highest): (Vec<Vec3>, f32) = (Vec::new(), f32::MIN);
        scene
            .traverse(full, Order::Pre, &Everything, &mut |at| {
                if !at.enters_plan() {
                    return;
                }
                let (parts, world) = (&at.plan().parts, at.world());
                let is_trunk = parts.of::<Stem>().first().is_some_and(|stem| stem.seed.level == 0);
                for segment in parts.of::<Segment>() {
                    let ends = [segment.frame.origin, segment.end()];
                    let ends = ends.map(|end| world.transform_point3(end));
                    highest = highest.max(ends[1].y);
                    if is_trunk {
                        feet.push(ends[0]);
                    } else {
                        points.extend(ends);
                    }
                }
                for leaf in parts.of::<Leaf>() {
                    let tip = leaf.frame.origin + leaf.length * leaf.frame.axes.z_axis;
                    points.push(world.transform_point3(tip));
                }
            })
            .unwrap();
        let map = scene.open_view(family, &sapwood::map_rules()).unwrap();
        let list = scene.draw_list(map, MANY).unwrap();
        let (middle, radius) = disc(&list);
        let away = |point: &Vec3| (*point - middle).with_y(0.0).length();
        let farthest = points.iter().map(away).fold(0.0, f32::max);
        let is_as_wide = (radius * 0.999..=radius * 1.001).contains(&farthest);
        assert!(is_as_wide, "{name}: {farthest} in a disc of {radius}");
        // Flat on the ground, whichever way the tree leans.
        for (world, row) in list.placed_rows() {
            let heights = row.mesh.positions.iter().map(|p| world.transform_point3(*p).y);
            assert!(heights.into_iter().all(|y| (y - middle.y).abs() < 0.03), "{name}");
        }
        assert!((middle.y - feet[0].y).abs() < 0.01, "{name}: {middle}");
        // The label tells the height.
        highest = points.iter().fold(highest, |highest, point| highest.max(point.y)) - feet[0].y;
        let labels: Vec<String> =
            list.placed_labels().map(|(_, label)| label.text.clone()).collect();
        assert_eq!(labels[0], species.name);
        let told: f32 =
            labels[1].strip_suffix(" m high").and_then(|text| text.parse().ok()).unwrap();
        assert!((told - highest).abs() <= 0.06 + 0.01 * highest, "{name}: {told} of {highest}");
    }
}

/// A tree of the random grove.
#[derive(Clone)]
struct Planted {
    species: usize,
    seed: u64,
    place: Affine3,
}

/// A tree in a scene: its species, its place, and itself.
type Handles = (Handle<Attribute>, Handle<Transform>, Handle<Tree>);

fn plant(scene: &mut Scene, root: Handle<Group>, kinds: &[Species], tree: &Planted) -> Handles {
    let family = scene.add_to(root, kinds[tree.species].attribute()).unwrap();
    let place = scene.add_to(family, Transform(tree.place)).unwrap();
    (family, place, scene.add_to(place, Tree { seed: Seed::Explicit(tree.seed) }).unwrap())
}

#[test]
fn a_grove_that_was_edited_looks_as_if_planted_so() {
    let kinds = [
        sapling(),
        with(&sapling(), &[("levels", 2.0), ("level.1.length", 0.2)]),
        with(&sapling(), &[("attraction_up", -2.0), ("leaves.count", 0.0)]),
    ];
    let mut dice = Stream::new(StreamPath::new(11), Purpose("grove"));
    let mut below = |n: u64| dice.bits() % n;
    let mut any = move || {
        let [x, z, turn, lean] = [(); 4].map(|()| below(100) as f32 / 10.0);
        let lean = Affine3::from_rotation_x(if lean < 3.0 { lean / 10.0 } else { 0.0 });
        let at = Affine3::from_translation(Vec3::new(x, 0.0, z));
        let place = at * Affine3::from_rotation_y(turn) * lean;
        let (species, seed) = (below(3) as usize, below(5));
        (Planted { species, seed, place }, below(6), below(4) as usize)
    };
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let mut trees: Vec<Planted> = (0..4).map(|_| any().0).collect();
    let mut handles: Vec<Handles> =
        trees.iter().map(|tree| plant(&mut scene, root, &kinds, tree)).collect();
    let mut grove = Grove { scene, root, trees: Vec::new() };
    let views = grove.views();
    for _ in 0..60 {
        let (other, what, which) = any();
        let (family, place, tree) = handles[which];
        let Grove { scene, .. } = &mut grove;
        match what {
            0 => {
                scene.edit(family, |family| kinds[other.species].set(family)).unwrap();
                trees[which].species = other.species;
            }
            1 | 2 => {
                scene.edit(tree, |tree| tree.seed = Seed::Explicit(other.seed)).unwrap();
                trees[which].seed = other.seed;
            }
            3 => {
                scene.edit(place, |place| place.0 = other.place).unwrap();
                trees[which].place = other.place;
            }
            4 => {
                scene.remove(family).unwrap();
                handles.remove(which);
                trees.remove(which);
                handles.push(plant(scene, root, &kinds, &other));
                trees.push(other);
            }
            // One view alone looks at what has changed so far.
            _ => {
                scene.bounds(views[which]).unwrap();
                continue;
            }
        }
        let mut cold = Scene::new();
        let root = cold.add(Group);
        for tree in &trees {
            plant(&mut cold, root, &kinds, tree);
        }
        let mut cold = Grove { scene: cold, root, trees: Vec::new() };
        let cold_views = cold.views();
        assert_eq!(given(&mut grove, views).0, given(&mut cold, cold_views).0);
    }
}

fn cube() -> Mesh {
    let corner = |i: u32| {
        Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32) * 2.0 - Vec3::ONE
    };
    let faces: [[u32; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut mesh = Mesh::default();
    for face in faces {
        let [a, b, c, d] = face.map(corner);
        let normal = (b - a).cross(c - a).normalize();
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([a, b, c, d]);
        mesh.normals.extend([normal; 4]);
        mesh.uvs.extend([sapwood::geom::glam::Vec2::ZERO; 4]);
        mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
    }
    mesh
}

/// Something of every sort beside the trees.
fn garden() -> Grove {
    let mut grove = grove();
    let Grove { scene, root, .. } = &mut grove;
    let root = *root;
    let brick = Material::matte("brick", 0.4, 0.1, 0.05);
    let house = Affine3::from_scale_rotation_translation(
        Vec3::new(3.0, 2.0, 2.0),
        sapwood::geom::glam::Quat::from_rotation_y(0.5),
        Vec3::new(-6.0, 2.0, 1.0),
    );
    let place = scene.add_to(root, Transform(house)).unwrap();
    scene.add_to(place, HeldGeometry::new(cube(), brick)).unwrap();
    let stones = HeldInstances {
        mesh: SharedMesh::new(cube()),
        material: None,
        places: Shared::new(
            (0..4)
                .map(|i| {
                    Affine3::from_scale_rotation_translation(
                        Vec3::splat(0.2),
                        sapwood::geom::glam::Quat::from_rotation_y(i as f32),
                        Vec3::new(i as f32, 0.2, 5.0),
                    )
                })
                .collect(),
        ),
    };
    scene.add_to(root, stones).unwrap();
    let lamp = Light {
        name: "lamp".to_owned(),
        color: [1.0; 3],
        intensity: 60.0,
        shape: LightShape::Point { range: None },
    };
    let place = scene.add_to(root, Transform::translation(2.0, 3.0, 2.0)).unwrap();
    scene.add_to(place, lamp.clone()).unwrap();
    let sun = Light { name: "sun".to_owned(), shape: LightShape::Directional, ..lamp };
    scene.add_to(root, sun).unwrap();
    let camera = Camera {
        name: "gate".to_owned(),
        lens: Lens::Perspective { vertical_angle: 0.8 },
        near: 0.1,
        far: None,
    };
    let place = scene.add_to(root, Transform::translation(-2.0, 1.7, 7.0)).unwrap();
    scene.add_to(place, camera).unwrap();
    let rotor = scene.add_to(root, Rotor::new(Vec3::Y, 1.0)).unwrap();
    let sign = sapwood::graph::Label::new("to the \"grove\"", 0.3);
    scene.add_to(rotor, sign).unwrap();
    let hidden = scene.add_to(root, Switch { on: false }).unwrap();
    scene.add_to(hidden, Group).unwrap();
    let nowhere = scene.add_to(root, Transform(Affine3::from_scale(Vec3::NAN))).unwrap();
    scene.add_to(nowhere, Group).unwrap();
    grove
}

fn assert_snapshot(name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(concat!(env!("CARGO_MANIFEST_DIR"), "/../snapshots"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, text));
}

#[test]
fn a_garden_in_words() {
    let mut garden = garden();
    let view = garden.scene.open_view(garden.root, &sapwood::text_rules()).unwrap();
    let text = garden.scene.outline(view, MANY).unwrap();
    assert_snapshot("view_text", &text);
    let short = garden.scene.outline(view, 3).unwrap();
    assert!(text.starts_with(short.strip_suffix("... and more\n").unwrap()), "{short}");
    // Rules that draw are told by what they draw.
    let full = garden.scene.open_view(garden.root, &sapwood::standard_rules()).unwrap();
    let drawn = garden.scene.outline(full, MANY).unwrap();
    assert!(drawn.contains("tree: ") && drawn.contains(" triangles"), "{drawn}");
}

#[test]
fn a_garden_as_a_map() {
    let mut garden = garden();
    let view = garden.scene.open_view(garden.root, &sapwood::map_rules()).unwrap();
    let list = garden.scene.draw_list(view, MANY).unwrap();
    let map = sapwood::io::svg_map(&list).unwrap();
    assert_snapshot("view_map", &map);
    assert_eq!(sapwood::io::svg_map(&list).unwrap(), map);
    // The picture's coordinates are the world's.
    let line = map.lines().next().unwrap();
    let numbers = line.split_once("viewBox=\"").unwrap().1.trim_end_matches("\">");
    let [x, z, width, height]: [f32; 4] =
        numbers.split(' ').map(|n| n.parse().unwrap()).collect::<Vec<f32>>().try_into().unwrap();
    assert!(x < -8.0 && x + width > 12.0 && z < -4.0 && z + height > 7.0, "{line}");
    for text in ["lamp", "gate", "Quaking Aspen", "Wheat", "to the \"grove\"", "10 m", ">N<"] {
        assert!(map.contains(text), "{text}");
    }
    assert!(!map.contains("sun"), "the sun stands nowhere");
}

#[test]
fn species_in_words() {
    let mut text = String::new();
    for name in ["quaking_aspen", "palm", "wheat", "bamboo", "desert_bush", "small_pine"] {
        let mut tree = planted(&built_in(name), 1);
        tree.view = tree.scene.open_view(tree.family, &sapwood::text_rules()).unwrap();
        text.push_str(&tree.scene.outline(tree.view, MANY).unwrap());
        text.push('\n');
    }
    assert_snapshot("species_text", &text);
}
