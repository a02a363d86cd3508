//! Boards with images of a tree, which stand for it from afar: what they look like there, and when
//! they are made.

use std::ops::ControlFlow;
use std::sync::Arc;

use sapwood::geom::glam::{Affine3, UVec2, Vec2, Vec3};
use sapwood::geom::{Envelope, Image};
use sapwood::graph::{
    Alpha, Aspects, DrawList, DrawRow, Eye, Impostor, Lens, Light, LightShape, Prune,
};
use sapwood::picture::{
    Background, ImpostorLight, ImpostorOptions, Impostors, PictureOptions, PlacedCamera, Sky,
    Studio,
};
use sapwood::rules::weber_penn::Seed;
use sapwood::scene::{
    Group, HeldImpostor, LevelOfDetail, Scene, Style, StyleSlot, Transform, ViewId, Viewer,
    Viewpoint,
};

use super::trees::*;

/// How high a tree is in pictures that are compared, in rows: as its images, and as in a picture of
/// 1000 rows that shows 60 degrees, from 600 m.
const LARGE: u32 = 112;
const SMALL: u32 = 20;

fn level() -> ImpostorOptions {
    ImpostorOptions { upper_sides: 0, from_above: false, ..ImpostorOptions::default() }
}

fn few() -> ImpostorOptions {
    ImpostorOptions { sides: 4, rows: 32, samples: 4, ..level() }
}

/// Eight directions at level height. Not only those that images were taken from.
fn sides() -> Vec<Vec3> {
    let angle = |side: u8| (std::f32::consts::FRAC_PI_4 + 0.02) * f32::from(side);
    let level = |angle: f32| Vec3::new(angle.sin(), 0.0, angle.cos());
    (0..8).map(|side| level(angle(side))).collect()
}

fn impostor(impostors: &mut Impostors, scene: &mut Scene, view: ViewId) -> Arc<Impostor> {
    let mut supply = scene.supply(view).unwrap();
    impostors.of(&mut supply, &mut |_| ControlFlow::Continue(())).unwrap()
}

/// How many pixels are covered, summed up, and their mean colour as light.
fn covered(image: &Image) -> (f64, [f64; 3]) {
    let linear = |byte: u8| {
        let encoded = f64::from(byte) / 255.0;
        if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
    };
    let (mut n, mut light) = (0.0, [0.0; 3]);
    for [r, g, b, a] in &image.pixels {
        let share = f64::from(*a) / 255.0;
        n += share;
        light.iter_mut().zip([r, g, b]).for_each(|(sum, byte)| *sum += share * linear(*byte));
    }
    (n, light.map(|sum| sum / n))
}

/// How a tree is looked at.
#[derive(Clone, Copy)]
struct Look {
    target: Vec3,
    /// How much is so many rows high.
    metres: f32,
    rows: u32,
    light: ImpostorLight,
}

/// What a view shows from a place, through a telescope.
fn picture(scene: &mut Scene, view: ViewId, eye: Vec3, look: &Look) -> Image {
    let Look { target, metres, rows, light } = *look;
    let reach = 0.5 * metres * 8.0 / 7.0;
    let vertical_angle = 2.0 * Vec2::new(eye.distance(target), reach).to_angle();
    let camera = PlacedCamera::look_at(Lens::Perspective { vertical_angle }, eye, target).unwrap();
    let (sun, sky) = match light {
        ImpostorLight::Baked { sun, sky } => (sun, sky),
        ImpostorLight::Even => (None, Sky::even([1.0; 3])),
    };
    let options = PictureOptions {
        size: [rows * 8 / 7; 2],
        samples: if rows == SMALL { 128 } else { 6 },
        background: Background::Transparent,
        sun,
        sky,
        ..PictureOptions::default()
    };
    scene.set_moving::<Viewer>(view, Some(camera.eye())).unwrap();
    let mut supply = scene.supply(view).unwrap();
    let mut studio = Studio::new(&mut supply);
    studio.picture(&camera, &options, &mut |_| ControlFlow::Continue(())).unwrap().image
}

/// The middle of what is covered, in pixels.
fn middle(image: &Image) -> Vec2 {
    let (mut n, mut sum) = (0.0f32, Vec2::ZERO);
    for (number, [.., a]) in (0..).zip(&image.pixels) {
        let place = UVec2::new(number % image.width, number / image.width);
        n += f32::from(*a);
        sum += f32::from(*a) * place.as_vec2();
    }
    sum / n
}

/// From 600 m, beside the tree itself: the impostor is the farthest of two levels of detail.
/// Covered pixels and each channel of the mean colour may differ by 5 %.
fn check_like_the_tree(name: &str, options: ImpostorOptions, from: &[Vec3], rows: u32) {
    // Check mode would compile all of it for each picture.
    let mut tree = planted_in(Scene::new(), &built_in(name), 1);
    let plain = tree.view;
    let aabb = tree.scene.bounds(plain).unwrap().aabb;
    let light = options.light;
    let made = impostor(&mut Impostors::new(options), &mut tree.scene, plain);
    let scene = &mut tree.scene;
    let species = scene.add(built_in(name).attribute());
    let levels = LevelOfDetail { hysteresis: 0.1, ..LevelOfDetail::new([300.0]) };
    let levels = scene.add_to(species, levels).unwrap();
    scene.append(levels, tree.tree).unwrap();
    scene.add_to(levels, HeldImpostor { impostor: made }).unwrap();
    let view = scene.open_view(species, &sapwood::standard_rules()).unwrap();

    let look = Look { target: aabb.center(), metres: aabb.size().max_element(), rows, light };
    let mut worst = (0.0f64, 0.0f64);
    for (side, from) in from.iter().enumerate() {
        let eye = *from * 600.0 + Vec3::Y * 1.7;
        scene.set_held::<Viewpoint>(view, Some(eye)).unwrap();
        let board = picture(scene, view, eye, &look);
        if side == 0 {
            let n_trees = scene.count(view).unwrap().components_of("tree");
            assert_eq!(n_trees, 0, "what is not shown is not compiled");
            assert_eq!(scene.draw_list(view, 100).unwrap().n_vertices_and_triangles().1, 2);
        }
        let full = picture(scene, plain, eye, &look);
        let apart = middle(&board).distance(middle(&full));
        assert!(
            apart < 2.0 * rows as f32 / LARGE as f32,
            "{name} from {from}: {apart} pixels aside"
        );
        let (board, full) = (covered(&board), covered(&full));
        let off = |a: f64, b: f64| (a / b - 1.0).abs();
        let colors = board.1.into_iter().zip(full.1).map(|(a, b)| off(a, b));
        worst.0 = worst.0.max(off(board.0, full.0));
        let color = colors.fold(0.0, f64::max);
        println!("{name} from {from}: {:.4}, {color:.4}", off(board.0, full.0));
        worst.1 = worst.1.max(color);
    }
    assert!(worst.0 < 0.05, "{name}: covered pixels differ by {}", worst.0);
    assert!(worst.1 < 0.05, "{name}: mean colours differ by {}", worst.1);
}

#[test]
fn from_afar_an_impostor_of_an_aspen_looks_like_it() {
    check_like_the_tree("quaking_aspen", level(), &sides(), LARGE);
}

#[test]
fn from_afar_an_impostor_of_a_palm_looks_like_it() {
    // It leans, and changes so fast from side to side that it is a little more between two of them.
    let taken_from = (0..8).map(|side| std::f32::consts::FRAC_PI_4 * side as f32);
    let from: Vec<Vec3> = taken_from.map(|a| Vec3::new(a.sin(), 0.0, a.cos())).collect();
    check_like_the_tree("palm", level(), &from, LARGE);
}

#[test]
fn in_even_light_an_impostor_taken_in_it_looks_like_its_tree() {
    let options = ImpostorOptions { light: ImpostorLight::Even, ..level() };
    check_like_the_tree("quaking_aspen", options, &sides(), LARGE);
}

#[test]
fn an_impostor_looks_like_its_tree_from_above_too() {
    let (up, along) = ImpostorOptions::STEEPNESS.sin_cos();
    let halfway = |angle: f32| Vec3::new(angle.sin() * along, up, angle.cos() * along);
    let from = [Vec3::X, halfway(0.1), halfway(2.3), halfway(-1.5), Vec3::Y];
    let options = ImpostorOptions { sides: 4, ..ImpostorOptions::default() };
    // It leans, and has no two sides that are alike.
    check_like_the_tree("palm", options, &from, LARGE);
}

#[test]
fn from_afar_an_impostor_of_a_black_tupelo_looks_like_it() {
    check_like_the_tree("black_tupelo", level(), &sides(), LARGE);
}

#[test]
fn an_impostor_of_twenty_rows_looks_like_its_tree() {
    check_like_the_tree("black_tupelo", level(), &sides(), SMALL);
}

#[test]
fn an_impostor_is_made_again_only_when_its_tree_is_edited() {
    let mut tree = grown(&built_in("quaking_aspen"), 1);
    let mut impostors = Impostors::new(few());
    let first = impostor(&mut impostors, &mut tree.scene, tree.view);
    let same = impostor(&mut impostors, &mut tree.scene, tree.view);
    assert!(Arc::ptr_eq(&first, &same));
    assert_eq!(tree.compiled(), []);

    tree.scene.edit(tree.tree, |tree| tree.seed = Seed::Explicit(2)).unwrap();
    let other = impostor(&mut impostors, &mut tree.scene, tree.view);
    assert!(!Arc::ptr_eq(&first, &other) && other.material != first.material);
    tree.scene.edit(tree.tree, |tree| tree.seed = Seed::Explicit(1)).unwrap();
    let again = impostor(&mut impostors, &mut tree.scene, tree.view);
    assert!(Arc::ptr_eq(&first, &again));
    assert_eq!(impostors.n_kept(), 2);
    drop(other);
    impostors.forget_unused();
    assert_eq!(impostors.n_kept(), 1);

    // On any number of threads it is the same.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
    let anew = pool.install(|| {
        let mut tree = grown(&built_in("quaking_aspen"), 1);
        impostor(&mut Impostors::new(few()), &mut tree.scene, tree.view)
    });
    assert_eq!((&anew.mesh, &anew.material), (&first.mesh, &first.material));
    assert_eq!(anew.aspects, first.aspects);
}

#[test]
fn those_that_nobody_has_asked_for_are_dropped_where_many_take_more_than_they_may() {
    let mut tree = planted_in(Scene::new(), &sapling(), 1);
    let mut of_seed = |impostors: &mut Impostors, seed| {
        tree.scene.edit(tree.tree, |tree| tree.seed = Seed::Explicit(seed)).unwrap();
        impostor(impostors, &mut tree.scene, tree.view)
    };
    let mut impostors = Impostors::new(few());
    let first: Vec<_> = [1, 2, 3].map(|seed| of_seed(&mut impostors, seed)).into();
    let bytes = impostors.n_bytes();
    let pixels = |impostor: &Arc<Impostor>| {
        let image = impostor.material.images.base_color.as_ref().unwrap();
        4 * image.pixels.len() as u64
    };
    let images: u64 = first.iter().map(pixels).sum();
    assert!(images < bytes && bytes < images + 3 * 1024, "{images} of {bytes}");
    assert_eq!(impostors.n_kept(), 3);

    // Asked for again, the first is no longer the one that is dropped.
    let is_kept = |now: &Arc<Impostor>, seed: usize| Arc::ptr_eq(now, &first[seed - 1]);
    assert!(is_kept(&of_seed(&mut impostors, 1), 1));
    let mut impostors = impostors.with_budget(bytes - 1);
    assert!(impostors.n_kept() == 2 && impostors.n_bytes() < bytes);
    assert!(is_kept(&of_seed(&mut impostors, 1), 1));
    assert!(is_kept(&of_seed(&mut impostors, 3), 3));
    let again = of_seed(&mut impostors, 2);
    assert!(!is_kept(&again, 2) && again.material == first[1].material);
    assert!(is_kept(&of_seed(&mut impostors, 3), 3));
    assert!(!is_kept(&of_seed(&mut impostors, 1), 1), "the third was asked for later");
    // The last is kept whatever it takes.
    let mut impostors = impostors.with_budget(0);
    assert_eq!(impostors.n_kept(), 1);
    let last = of_seed(&mut impostors, 4);
    assert!(Arc::ptr_eq(&last, &of_seed(&mut impostors, 4)) && impostors.n_kept() == 1);
}

#[test]
fn lights_of_a_view_shine_in_images_that_are_baked_alone() {
    let mut tree = planted_in(Scene::new(), &sapling(), 1);
    let even = ImpostorOptions { light: ImpostorLight::Even, ..few() };
    let [mut baked, mut even] = [few(), even].map(Impostors::new);
    let without = [&mut baked, &mut even].map(|i| impostor(i, &mut tree.scene, tree.view));
    let both = tree.scene.add(Group);
    tree.scene.append(both, tree.family).unwrap();
    let lamp = tree.scene.add_to(both, Transform(Affine3::from_translation(Vec3::Y * 9.0)));
    let shape = LightShape::Point { range: None };
    let light = Light { name: String::new(), color: [1.0, 0.2, 0.1], intensity: 60.0, shape };
    tree.scene.add_to(lamp.unwrap(), light).unwrap();
    let lit = tree.scene.open_view(both, &sapwood::standard_rules()).unwrap();
    let with = [&mut baked, &mut even].map(|i| impostor(i, &mut tree.scene, lit));
    assert_ne!(with[0].material, without[0].material);
    assert!(Arc::ptr_eq(&with[1], &without[1]), "in even light a lamp changes nothing");
}

#[test]
fn an_impostor_shows_the_side_that_is_looked_at_and_two_crossed_boards_to_nobody() {
    let mut tree = grown(&built_in("palm"), 1);
    let options = ImpostorOptions { sides: 8, ..few() };
    let made = impostor(&mut Impostors::new(options), &mut tree.scene, tree.view);
    let scene = &mut tree.scene;
    // Turned by a quarter about its foot: what stood at +z is at +x.
    let turn = Affine3::from_rotation_y(std::f32::consts::FRAC_PI_2);
    let place = scene.add(Transform(turn));
    scene.add_to(place, HeldImpostor { impostor: Arc::clone(&made) }).unwrap();
    let view = scene.open_view(place, &sapwood::standard_rules()).unwrap();
    let n_triangles =
        |scene: &mut Scene| scene.draw_list(view, 9).unwrap().n_vertices_and_triangles().1;
    assert_eq!(n_triangles(scene), 8, "both boards from both sides");
    let report = scene.verify(view, 9).unwrap();
    assert!(report.is_clean(), "{report:?}");
    let bound = scene.bounds(view).unwrap();
    scene.take_log();
    for (side, toward) in (0..).zip([Vec3::X, Vec3::NEG_Z, Vec3::NEG_X, Vec3::Z]) {
        let eye = Eye::new(toward * 300.0 + Vec3::Y * 40.0);
        scene.set_moving::<Viewer>(view, Some(eye)).unwrap();
        let list = scene.draw_list(view, 9).unwrap();
        let (world, row) = list.placed_rows().next().unwrap();
        let range = row.range.unwrap();
        assert_eq!((range.first, range.end), (2 * side, 2 * side + 2), "from {toward}");
        let normal = row.mesh.normals[4 * side as usize];
        assert!(world.transform_vector3(normal).distance(toward) < 1e-5);
        assert_eq!(n_triangles(scene), 2);
        let glb = sapwood::io::glb_bytes(&list).unwrap();
        assert!(glb.len() > 1000);
    }
    assert_eq!(compiled(scene, view), []);
    assert_eq!(scene.bounds(view).unwrap(), bound);

    // A cut and wires have no eye.
    let prune = Prune::to(Envelope::half_space(Vec3::X, 0.1));
    let cut = scene.prune(view, &prune, &sapwood::rules::weber_penn::prune_handlers(), 99).unwrap();
    let normals: Vec<Vec3> = cut
        .placed_rows()
        .flat_map(|(world, row)| row.mesh.normals.iter().map(move |n| world.transform_vector3(*n)))
        .collect();
    let is_of = |side: &Vec3| normals.iter().any(|normal| normal.distance(*side) < 1e-4);
    assert!([Vec3::Z, Vec3::NEG_Z].iter().all(is_of), "{normals:?}");
    let slanted = normals.iter().filter(|normal| normal.abs().max_element() < 0.999);
    assert_eq!(slanted.count(), 0, "boards that are not crossed");
    scene.set_held::<StyleSlot>(view, Style::Wire).unwrap();
    let list = scene.draw_list(view, 9).unwrap();
    let n_lines: usize = list.placed_lines().map(|(_, row)| row.drawn().len()).sum();
    // One around each of the crossed boards.
    assert_eq!((n_triangles(scene), n_lines), (0, 4));
}

#[test]
fn boards_that_fade_into_each_other_cast_no_shadow_on_each_other() {
    let mut tree = planted_in(Scene::new(), &built_in("palm"), 1);
    let aabb = tree.scene.bounds(tree.view).unwrap().aabb;
    let options = ImpostorOptions { sides: 8, light: ImpostorLight::Even, ..few() };
    let made = impostor(&mut Impostors::new(options), &mut tree.scene, tree.view);
    let hard = Aspects { blends: false, ..made.aspects.clone() };
    let hard = Arc::new(Impostor { aspects: hard, ..Impostor::clone(&made) });
    let [blended, hard] = [made, hard].map(|impostor| {
        let board = tree.scene.add(HeldImpostor { impostor });
        tree.scene.open_view(board, &sapwood::standard_rules()).unwrap()
    });
    // Under a sun.
    let (target, metres) = (aabb.center(), aabb.size().max_element());
    let look = Look { target, metres, rows: 64, light: ImpostorOptions::default().light };
    let mut brightness = |view: ViewId, angle: f32| -> f64 {
        let eye = target + Vec3::new(angle.sin(), 0.0, angle.cos()) * 600.0;
        let (n, color) = covered(&picture(&mut tree.scene, view, eye, &look));
        assert!(n > 100.0);
        color.iter().sum()
    };
    for side in 0..8 {
        let halfway = (side as f32 + 0.5) * std::f32::consts::FRAC_PI_4;
        let alone = [-1e-3, 1e-3].map(|by| brightness(hard, halfway + by));
        let both = brightness(blended, halfway);
        let [least, most] = [alone[0].min(alone[1]), alone[0].max(alone[1])];
        assert!((0.97 * least..=1.03 * most).contains(&both), "{side}: {both}, {alone:?}");
    }
}

#[test]
fn boards_fade_into_each_other_between_two_sides() {
    let mut tree = planted_in(Scene::new(), &built_in("palm"), 1);
    let aabb = tree.scene.bounds(tree.view).unwrap().aabb;
    let options = ImpostorOptions { sides: 8, ..few() };
    let made = impostor(&mut Impostors::new(options), &mut tree.scene, tree.view);
    let hard = Aspects { blends: false, ..made.aspects.clone() };
    let hard = Arc::new(Impostor { aspects: hard, ..Impostor::clone(&made) });
    let light = few().light;
    let look = Look { target: aabb.center(), metres: aabb.size().max_element(), rows: 64, light };
    let eye = |angle: f32| aabb.center() + Vec3::new(angle.sin(), 0.0, angle.cos()) * 600.0;
    let quarter = std::f32::consts::FRAC_PI_4;
    let switched: Vec<f64> = [Arc::clone(&made), hard]
        .map(|impostor| {
            let board = tree.scene.add(HeldImpostor { impostor });
            let scene = &mut tree.scene;
            let view = scene.open_view(board, &sapwood::standard_rules()).unwrap();
            let [before, after] = [-1e-3, 1e-3].map(|by| {
                let image = picture(scene, view, eye(0.5 * quarter + by), &look);
                image.pixels.iter().map(|[.., a]| *a).collect::<Vec<u8>>()
            });
            let sum = |of: &dyn Fn(u8, u8) -> u8| -> f64 {
                before.iter().zip(&after).map(|(a, b)| f64::from(of(*a, *b))).sum()
            };
            sum(&|a, b| a.abs_diff(b)) / sum(&|a, b| a.max(b))
        })
        .into();
    assert!(switched[0] < 0.01 && switched[1] > 0.3, "{switched:?}");

    let scene = &mut tree.scene;
    let board = scene.add(HeldImpostor { impostor: made });
    let view = scene.open_view(board, &sapwood::standard_rules()).unwrap();
    let mut list_at = |place: f32| {
        scene.set_moving::<Viewer>(view, Some(Eye::new(eye(place * quarter)))).unwrap();
        scene.draw_list(view, 9).unwrap()
    };
    let rows = |list: &DrawList| -> Vec<(u32, f32)> {
        let row = |row: &DrawRow| {
            (row.range.unwrap().first / 2, row.cross_fade.map_or(1.0, |fade| fade.share()))
        };
        list.placed_rows().map(|(_, each)| row(each)).collect()
    };
    // Next to the front is the side that has come fifth, behind the four crossed ones.
    assert_eq!(rows(&list_at(0.0)), [(0, 1.0)]);
    assert_eq!(rows(&list_at(1.0)), [(4, 1.0)]);
    assert_eq!(rows(&list_at(0.5)), [(0, 0.5), (4, 0.5)]);
    for (place, foremost) in [(0.3, 0), (0.7, 4)] {
        let list = list_at(place);
        let rows = rows(&list);
        assert_eq!((rows.len(), rows[0].1 + rows[1].1), (2, 1.0));
        assert_eq!(list.n_vertices_and_triangles().1, 4);
        // Files and the like have the foremost.
        let drawn = list.as_drawn();
        let normal = drawn.placed_rows().next().unwrap().1.mesh.normals[0];
        let angle = quarter * if foremost == 0 { 0.0 } else { 1.0 };
        assert!(normal.distance(Vec3::new(angle.sin(), 0.0, angle.cos())) < 1e-5, "{normal}");
        assert_eq!(drawn.n_vertices_and_triangles().1, 2);
    }
}

#[test]
fn an_impostor_shines_as_it_was_taken_or_is_lit_again() {
    let mut tree = grown(&built_in("quaking_aspen"), 1);
    let baked = impostor(&mut Impostors::new(few()), &mut tree.scene, tree.view);
    assert_eq!((baked.material.emissive, baked.material.alpha), ([1.0; 3], Alpha::Mask(0.5)));
    assert_eq!(baked.material.images.emissive, baked.material.images.base_color);
    let even = ImpostorOptions { light: ImpostorLight::Even, ..few() };
    let even = impostor(&mut Impostors::new(even), &mut tree.scene, tree.view);
    assert_eq!(even.material.emissive, [0.0; 3]);
    assert!(even.material.images.emissive.is_none());
    assert_eq!(even.material.base_color, [1.0; 4]);
    // Its leaves are green, and darker than if none stood in another's light.
    let image = even.material.images.base_color.as_ref().unwrap();
    let (n_covered, [red, green, blue]) = covered(image);
    assert!(n_covered > 500.0 && green > red && red > blue, "{red} {green} {blue}");
    assert_eq!((baked.material.fault(), even.material.fault()), (None, None));
}

#[test]
fn there_is_no_impostor_of_nothing() {
    let mut scene = Scene::new();
    let nothing = scene.add(Transform(Affine3::IDENTITY));
    let view = scene.open_view(nothing, &sapwood::standard_rules()).unwrap();
    let mut supply = scene.supply(view).unwrap();
    let none = Impostors::new(few()).of(&mut supply, &mut |_| ControlFlow::Continue(()));
    assert!(none.unwrap_err().to_string().contains("nothing to see"));
    let odd = ImpostorOptions { sides: 5, ..few() };
    let mut tree = grown(&built_in("palm"), 1);
    let mut supply = tree.scene.supply(tree.view).unwrap();
    let none = Impostors::new(odd).of(&mut supply, &mut |_| ControlFlow::Continue(()));
    assert!(none.unwrap_err().to_string().contains("sides of an impostor: 5"));
    let stopped = Impostors::new(few()).of(&mut supply, &mut |_| ControlFlow::Break(()));
    assert!(stopped.is_err());
}
