//! Boards with images of a tree, which stand for it from afar: what they look like there, and when
//! they are made.

use std::ops::ControlFlow;
use std::sync::Arc;

use sapwood::geom::glam::{Affine3, UVec2, Vec2, Vec3};
use sapwood::geom::{Envelope, Image};
use sapwood::graph::{Alpha, Eye, Impostor, Lens, Prune};
use sapwood::picture::{
    Background, ImpostorLight, ImpostorOptions, Impostors, PictureOptions, PlacedCamera, Studio,
};
use sapwood::rules::weber_penn::Seed;
use sapwood::scene::{
    HeldImpostor, LevelOfDetail, Scene, Style, StyleSlot, Transform, ViewId, Viewer, Viewpoint,
};

use super::trees::*;

/// Of the pictures that are compared, each way.
const PIXELS: u32 = 128;

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

/// What a view shows from a place, through a lens in which so many metres fill the picture.
fn picture(scene: &mut Scene, view: ViewId, eye: Vec3, target: Vec3, metres: f32) -> Image {
    let vertical_angle = 2.0 * Vec2::new(eye.distance(target), 0.5 * metres).to_angle();
    let camera = PlacedCamera::look_at(Lens::Perspective { vertical_angle }, eye, target).unwrap();
    let options = PictureOptions {
        size: [PIXELS, PIXELS],
        samples: 6,
        background: Background::Transparent,
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

/// From 600 m, through a telescope that shows the tree 112 pixels high, beside the tree itself: the
/// impostor is the farthest of two levels of detail. Covered pixels may differ by 5 %, each channel of the
/// mean colour by `most`.
fn check_like_the_tree(name: &str, options: ImpostorOptions, from: &[Vec3], most: f64) {
    // Check mode would compile all of it for each picture.
    let mut tree = planted_in(Scene::new(), &built_in(name), 1);
    let plain = tree.view;
    let aabb = tree.scene.bounds(plain).unwrap().aabb;
    let made = impostor(&mut Impostors::new(options), &mut tree.scene, plain);
    let scene = &mut tree.scene;
    let species = scene.add(built_in(name).attribute());
    let levels = LevelOfDetail { hysteresis: 0.1, ..LevelOfDetail::new([300.0]) };
    let levels = scene.add_to(species, levels).unwrap();
    scene.append(levels, tree.tree).unwrap();
    scene.add_to(levels, HeldImpostor { impostor: made }).unwrap();
    let view = scene.open_view(species, &sapwood::standard_rules()).unwrap();

    let (center, metres) = (aabb.center(), aabb.size().max_element() * 8.0 / 7.0);
    let mut worst = (0.0f64, 0.0f64);
    for (side, from) in from.iter().enumerate() {
        let eye = *from * 600.0 + Vec3::Y * 1.7;
        scene.set_held::<Viewpoint>(view, Some(eye)).unwrap();
        let board = picture(scene, view, eye, center, metres);
        if side == 0 {
            let n_trees = scene.count(view).unwrap().components_of("tree");
            assert_eq!(n_trees, 0, "what is not shown is not compiled");
            assert_eq!(scene.draw_list(view, 100).unwrap().n_vertices_and_triangles().1, 2);
        }
        let full = picture(scene, plain, eye, center, metres);
        let apart = middle(&board).distance(middle(&full));
        assert!(apart < 2.0, "{name} from {from}: {apart} pixels aside");
        let (board, full) = (covered(&board), covered(&full));
        let off = |a: f64, b: f64| (a / b - 1.0).abs();
        let colors = board.1.into_iter().zip(full.1).map(|(a, b)| off(a, b));
        worst.0 = worst.0.max(off(board.0, full.0));
        let color = colors.fold(0.0, f64::max);
        println!("{name} from {from}: {:.4}, {color:.4}", off(board.0, full.0));
        worst.1 = worst.1.max(color);
    }
    assert!(worst.0 < 0.05, "{name}: covered pixels differ by {}", worst.0);
    assert!(worst.1 < most, "{name}: mean colours differ by {}", worst.1);
}

#[test]
fn from_afar_an_impostor_of_an_aspen_looks_like_it() {
    check_like_the_tree("quaking_aspen", level(), &sides(), 0.05);
}

#[test]
fn an_impostor_looks_like_its_tree_from_above_too() {
    let (up, along) = ImpostorOptions::STEEPNESS.sin_cos();
    let halfway = |angle: f32| Vec3::new(angle.sin() * along, up, angle.cos() * along);
    let from = [Vec3::X, halfway(0.1), halfway(2.3), halfway(-1.5), Vec3::Y];
    let options = ImpostorOptions { sides: 4, ..ImpostorOptions::default() };
    // It leans, and has no two sides that are alike. Its fronds are so fine that in the shade their
    // colours come out a quarter darker.
    check_like_the_tree("palm", options, &from, 0.3);
}

#[test]
fn from_afar_an_impostor_of_a_black_tupelo_looks_like_it() {
    check_like_the_tree("black_tupelo", level(), &sides(), 0.05);
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
