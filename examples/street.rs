//! A street by night: a lamp made once as a kit, placed many times, each as high as asked for.
//!
//! `cargo run --example street [FOLDER]` writes `street.glb`, with lights and an image.

use std::error::Error;
use std::path::PathBuf;

use sapwood::geom::glam::{Affine3, Vec2, Vec3};
use sapwood::geom::{Cap, Image, Mesh, Ring, Section, Shared, Sweep, SweepOptions, content};
use sapwood::graph::{Light, LightShape, Material, MaterialImages, Named};
use sapwood::scene::{Group, HeldGeometry, KitRule, KitTemplate, RuleSet, Scene, Transform};

/// What there is to say about a lamp.
struct Lamp {
    height: f32,
    candela: f32,
}
content!(Lamp { height, candela });
impl Named for Lamp {
    const NAME: &'static str = "lamp";
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).unwrap_or("target/examples-out".into());
    let folder = PathBuf::from(folder);
    std::fs::create_dir_all(&folder)?;

    let lamp = lamp();
    let mut scene = Scene::new();
    let street = scene.add(Group);
    for i in 0..5u8 {
        let place = Transform::translation(2.5, 0.0, -4.0 * f32::from(i));
        let place = scene.add_to(street, place)?;
        let height = 3.0 + 0.4 * f32::from(i);
        let lamp = scene.add_kit(&lamp, Lamp { height, candela: 40.0 })?;
        scene.append(place, lamp)?;
    }
    // Twelve by thirty metres of ground, two metres of it for each repeat of the image.
    let corners = [(-6.0, 8.0), (6.0, 8.0), (6.0, -22.0), (-6.0, -22.0)];
    let ground = Mesh {
        positions: corners.map(|(x, z)| Vec3::new(x, 0.0, z)).to_vec(),
        normals: vec![Vec3::Y; 4],
        uvs: corners.map(|(x, z)| Vec2::new(x, z) / 2.0).to_vec(),
        indices: vec![0, 1, 2, 0, 2, 3],
    };
    scene.add_to(street, HeldGeometry::new(ground, cobbles()))?;

    let rules = RuleSet::new().with(KitRule::<Lamp>::new()).over(&sapwood::standard_rules());
    let view = scene.open_view(street, &rules)?;
    let list = scene.draw_list(view, 1_000)?;
    let path = folder.join("street.glb");
    sapwood::io::write_glb(&path, &list)?;
    println!("{} lamps: {}", list.placed_lights().count(), path.display());
    Ok(())
}

/// The parts of a lamp, and what its parameters do to them.
fn lamp() -> KitTemplate<Lamp> {
    let iron = Material::matte("iron", 0.05, 0.05, 0.06);
    let glass = Material { emissive: [1.0, 0.8, 0.5], ..Material::matte("glass", 0.9, 0.9, 0.8) };
    let bulb = LightShape::Point { range: None };
    let bulb = Light { name: "bulb".into(), color: [1.0, 0.8, 0.5], intensity: 0.0, shape: bulb };
    KitTemplate::<Lamp>::new()
        .part("post", Transform(Affine3::IDENTITY))
        .part_under("post", "iron", HeldGeometry::new(tube(0.06, 1.0), iron))
        .part("top", Transform(Affine3::IDENTITY))
        .part_under("top", "head", Group)
        .part_under("head", "globe", HeldGeometry::new(tube(0.2, 0.3), glass))
        .part_under("head", "bulb", bulb)
        .expose("post", "height", |lamp: &Lamp, post: &mut Transform| {
            post.0 = Affine3::from_scale(Vec3::new(1.0, lamp.height, 1.0));
        })
        .expose("top", "height", |lamp: &Lamp, top: &mut Transform| {
            top.0 = Affine3::from_translation(Vec3::Y * lamp.height);
        })
        .expose("bulb", "candela", |lamp: &Lamp, bulb: &mut Light| bulb.intensity = lamp.candela)
}

/// An upright tube with flat ends.
fn tube(radius: f32, height: f32) -> Mesh {
    let rings = [Vec3::ZERO, Vec3::Y * height].map(|center| Ring { center, radius });
    let options = SweepOptions { base: Cap::Flat, tip: Cap::Flat, ..SweepOptions::default() };
    let (section, mut sweep, mut mesh) = (Section::round(12), Sweep::default(), Mesh::default());
    sweep.lay(&section, &rings, &options);
    sweep.write(&section, &mut mesh);
    mesh
}

/// Grey stones with dark joints.
fn cobbles() -> Material {
    let image = Image::from_fn(128, 128, |x, y| {
        let is_joint = (x + y / 32 % 2 * 16) % 32 < 3 || y % 32 < 3;
        let grey = if is_joint { 70 } else { 150 + (x / 32 * 37 + y / 32 * 53) as u8 % 40 };
        [grey, grey, grey, 255]
    });
    let images = MaterialImages { base_color: Some(Shared::new(image)), ..Default::default() };
    Material { images, ..Material::matte("cobbles", 1.0, 1.0, 1.0) }
}
