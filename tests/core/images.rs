//! Images as plans: made when somebody asks, once for all who ask, and told where they cannot be.

use sapwood::geom::{Mesh, Shared, glam};
use sapwood::graph::Material;
use sapwood::images::{
    BarkImage, LeafImage, NoiseImage, Over, Paint, Painted, PaintedMaterial, RampImage, Stop,
};
use sapwood::scene::{Group, Handle, HeldGeometry, Scene, ViewId};

use glam::{Vec2, Vec3};

fn noise() -> NoiseImage {
    NoiseImage { size: [32; 2], ..NoiseImage::default() }
}

fn ramp(colors: [[f32; 3]; 2]) -> RampImage {
    let stops = [0.0, 1.0].into_iter().zip(colors).map(|(at, color)| Stop { at, color });
    RampImage { over: Over::Noise(noise()), stops: stops.collect() }
}

fn square() -> Mesh {
    let corners = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    Mesh {
        positions: corners.iter().map(|corner| corner.extend(0.0)).collect(),
        normals: vec![Vec3::Z; 4],
        uvs: corners.iter().map(|corner| Vec2::new(corner.x, 1.0 - corner.y)).collect(),
        indices: vec![0, 1, 2, 0, 2, 3],
    }
}

/// A square below each of the attributes.
fn squares(paints: Vec<Painted>) -> (Scene, ViewId, Vec<Handle<Painted>>) {
    let mut scene = Scene::new();
    scene.set_check_mode(true);
    scene.set_logging(true);
    let root = scene.add(Group);
    let square = scene.add(HeldGeometry::plain(square()));
    let handles: Vec<Handle<Painted>> = paints
        .into_iter()
        .map(|paint| {
            let painted = scene.add_to(root, paint).unwrap();
            scene.append(painted, square).unwrap();
            painted
        })
        .collect();
    let view = scene.open_view(root, &sapwood::standard_rules()).unwrap();
    (scene, view, handles)
}

fn materials(scene: &mut Scene, view: ViewId) -> Vec<Material> {
    let list = scene.draw_list(view, 100).unwrap();
    list.placed_rows().map(|(_, row)| (*row.material).clone()).collect()
}

/// How often each kind of image was compiled since the log was taken last.
fn compiled(scene: &mut Scene) -> Vec<(&'static str, usize)> {
    let mut counts: Vec<(&'static str, usize)> = Vec::new();
    for event in scene.take_log() {
        let name = event.kind.name();
        if event.action != sapwood::scene::Action::Compiled || !name.ends_with("image") {
            continue;
        }
        match counts.iter_mut().find(|(known, _)| *known == name) {
            Some((_, n)) => *n += 1,
            None => counts.push((name, 1)),
        }
    }
    counts.sort_unstable();
    counts
}

#[test]
fn noise_on_a_mesh_reaches_the_gltf_file() {
    let (mut scene, view, _) = squares(vec![Painted::with(Paint::Noise(noise()))]);
    let list = scene.draw_list(view, 100).unwrap();
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("noise.glb");
    sapwood::io::write_glb(&path, &list).unwrap();
    let model = sapwood::io::read_gltf(&path, &sapwood::io::ReadLimits::default()).unwrap();
    let material = model.meshes[0][0].material.as_ref().unwrap();
    let read = material.images.base_color.as_ref().unwrap();
    assert_eq!(read.pixels, noise().image().pixels);
}

#[test]
fn images_are_made_once_and_made_again_only_when_edited() {
    let ramps = [[[0.0; 3], [1.0; 3]], [[0.1; 3], [0.9, 0.0, 0.0]]].map(ramp);
    let paints = ramps.clone().into_iter().chain([ramps[0].clone()]).map(Paint::Ramp);
    let (mut scene, view, handles) = squares(paints.map(Painted::with).collect());
    assert_eq!(compiled(&mut scene), [], "nobody has asked");

    let found = materials(&mut scene, view);
    let images: Vec<Shared<_>> =
        found.iter().map(|material| material.images.base_color.clone().unwrap()).collect();
    assert!(images[0].is_same(&images[2]) && images[0] != images[1]);
    assert_eq!(compiled(&mut scene), [("noise_image", 1), ("ramp_image", 2)]);

    // Another gloss, the same image.
    scene.edit(handles[0], |painted| painted.0.material.roughness = 0.2).unwrap();
    assert_eq!(materials(&mut scene, view)[0].roughness, 0.2);
    assert_eq!(compiled(&mut scene), []);

    let green = ramp([[0.0; 3], [0.0, 1.0, 0.0]]);
    scene.edit(handles[1], |painted| painted.0.paint = Paint::Ramp(green)).unwrap();
    materials(&mut scene, view);
    assert_eq!(compiled(&mut scene), [("ramp_image", 1)], "over the noise that was there");
}

#[test]
fn bark_and_leaves_paint_with_all_their_images() {
    let bark = BarkImage { size: 32, ..BarkImage::default() };
    let leaf = LeafImage { size: 32, ..LeafImage::default() };
    let white = Material::matte("white", 1.0, 1.0, 1.0);
    let mut own = white.clone();
    own.images.emissive = Some(noise().image());
    let leaf = PaintedMaterial { material: own, paint: Paint::Leaf(leaf) };
    let (mut scene, view, _) = squares(vec![Painted::with(Paint::Bark(bark)), Painted(leaf)]);
    let found = materials(&mut scene, view);
    assert!(found[0].images.normal.is_some() && found[0].images.base_color.is_some());
    assert!(found[1].images.normal.is_none() && found[1].images.base_color.is_some());
    assert!(found[1].images.emissive.is_some(), "what the paint lacks stays");
}

#[test]
fn images_that_cannot_be_are_told_and_the_rest_is_drawn() {
    let (mut scene, view, _) = squares(vec![
        Painted::with(Paint::Noise(NoiseImage { size: [0, 32], ..NoiseImage::default() })),
        Painted::with(Paint::Bark(BarkImage { size: 1 << 20, ..BarkImage::default() })),
        Painted::with(Paint::Leaf(LeafImage { width: f32::NAN, ..LeafImage::default() })),
        Painted::with(Paint::Noise(noise())),
    ]);
    let found = scene.diagnostics(view, 10).unwrap();
    let messages: Vec<&str> = found.iter().map(|(_, found)| &*found.message).collect();
    let pixels = "accepted: a whole number of pixels from 1 to 4096";
    let through = "ingredient painted_material: ingredient";
    assert_eq!(
        messages,
        [
            format!("{through} noise_image: width is 0; {pixels}"),
            format!("{through} bark_image: size is 1048576; {pixels}"),
            format!(
                "{through} leaf_image: width is NaN; accepted: a number at least 0.01 and at most 2"
            ),
        ]
    );
    assert_eq!(materials(&mut scene, view).len(), 1);
}
