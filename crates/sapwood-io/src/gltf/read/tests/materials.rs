//! Materials and their images, in files made by hand.

use sapwood_geom::glam::Vec2;
use sapwood_geom::{Image, Purpose, Stream, StreamPath};
use sapwood_graph::{Alpha, Material};

use super::*;

/// The triangle with texture coordinates and a material.
pub(super) fn painted(material: Value, images: &[Vec<u8>]) -> (Value, Vec<u8>) {
    let (mut document, mut bin) = triangle();
    let sets = [[0., 0., 1., 0., 0., 1.], [0.5, 0.5, 1., 0.5, 0.5, 1.]];
    for (number, set_of) in sets.iter().enumerate() {
        let uvs = add(&mut document, &mut bin, (5126, "VEC2", 3), &floats(set_of));
        let pointer = format!("/meshes/0/primitives/0/attributes/TEXCOORD_{number}");
        set(&mut document, &pointer, json!(uvs));
    }
    set(&mut document, "/meshes/0/primitives/0/material", json!(0));
    document["materials"] = json!([material]);
    document["images"] = json!([]);
    document["textures"] = json!([]);
    for (number, image) in images.iter().enumerate() {
        let view = add(&mut document, &mut bin, (5121, "SCALAR", image.len()), image);
        set(&mut document, "/images/-", json!({ "bufferView": view }));
        set(&mut document, "/textures/-", json!({ "source": number }));
    }
    (document, bin)
}

pub(super) fn material_of(model: &Model) -> &Material {
    model.meshes[0][0].material.as_ref().unwrap()
}

pub(super) fn dots(seed: u64) -> Image {
    let color = Stream::new(StreamPath::new(seed), Purpose("dots")).bits() as u8;
    Image::from_fn(3, 2, |x, y| [color, x as u8, y as u8, 200])
}

pub(super) fn png(image: &Image) -> Vec<u8> {
    crate::png::png_bytes(image, crate::png::Packing::Fast).unwrap()
}

#[test]
fn materials_have_all_that_ours_have() {
    let images: Vec<Vec<u8>> = (0..3).map(|seed| png(&dots(seed))).collect();
    let images = [&images[..], &[crate::raster::jpegs::BASELINE.to_vec()]].concat();
    let raw = json!({
        "name": "leaf",
        "alphaMode": "MASK",
        "alphaCutoff": 0.25,
        "doubleSided": true,
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 0.25, 0.125, 0.75],
            "baseColorTexture": { "index": 0 },
            "metallicFactor": 0.5,
            "roughnessFactor": 0.75,
            "metallicRoughnessTexture": { "index": 1 },
        },
        "normalTexture": { "index": 2 },
        "emissiveTexture": { "index": 3 },
        "emissiveFactor": [0.5, 1, 0],
        "extensions": {
            "KHR_materials_emissive_strength": { "emissiveStrength": 3 },
            "KHR_materials_diffuse_transmission": {
                "diffuseTransmissionFactor": 0.375,
                "diffuseTransmissionColorFactor": [0.5, 0.25, 0.125],
                "diffuseTransmissionColorTexture": { "index": 0 },
            },
        },
    });
    let (document, bin) = painted(raw, &images);
    let model = read_both(&document, &bin).unwrap();
    assert_eq!(model.warnings, [""; 0]);
    let leaf = material_of(&model);
    let plain = Material { images: Default::default(), ..leaf.clone() };
    let expected = Material {
        name: "leaf".into(),
        base_color: [0.5, 0.25, 0.125, 0.75],
        metallic: 0.5,
        roughness: 0.75,
        emissive: [1.5, 3.0, 0.0],
        translucency: 0.375,
        alpha: Alpha::Mask(0.25),
        double_sided: true,
        images: Default::default(),
    };
    assert_eq!(plain, expected);
    assert_eq!(**leaf.images.base_color.as_ref().unwrap(), dots(0));
    assert_eq!(**leaf.images.metallic_roughness.as_ref().unwrap(), dots(1));
    assert_eq!(**leaf.images.normal.as_ref().unwrap(), dots(2));
    let jpeg = leaf.images.emissive.as_ref().unwrap();
    assert_eq!((jpeg.width, jpeg.height), (16, 8));
    let blended = changed(&[
        ("/meshes/0/primitives/0/material", json!(0)),
        ("/materials", json!([{ "alphaMode": "BLEND" }])),
    ]);
    assert_eq!(material_of(&blended.unwrap()).alpha, Alpha::Blend);
}

#[test]
fn images_come_from_data_and_from_files() {
    let folder = tempfile::tempdir().unwrap();
    let texture = json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } });
    let (mut document, bin) = painted(texture, &[png(&dots(0))]);
    std::fs::write(folder.path().join("a b.png"), png(&dots(7))).unwrap();
    std::fs::write(folder.path().join("a.bin"), &bin).unwrap();
    document["buffers"][0]["uri"] = json!("a.bin");
    let path = folder.path().join("a.gltf");
    let mut check = |uri: &str, seed: u64| {
        document["images"][0] = json!({ "uri": uri });
        std::fs::write(&path, document.to_string()).unwrap();
        let model = read_gltf(&path, &ReadLimits::default()).unwrap();
        assert_eq!(**material_of(&model).images.base_color.as_ref().unwrap(), dots(seed));
    };
    check("a%20b.png", 7);
    check(&format!("data:image/png;base64,{}", base64(&png(&dots(3)))), 3);
    check(&format!("data:application/octet-stream;base64,{}", base64(&png(&dots(4)))), 4);
    // Buffers as data, as many texts have them.
    let (mut document, bin) = triangle();
    document["buffers"][0]["uri"] =
        json!(format!("data:application/gltf-buffer;base64,{}", base64(&bin)));
    let text = format!("\u{feff}\n{document:#}");
    let model = read(text.as_bytes(), None, &ReadLimits::default()).unwrap();
    assert_eq!(only_mesh(&model).n_triangles(), 1);
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for three in bytes.chunks(3) {
        let bits = three.iter().fold(0u32, |bits, byte| bits << 8 | u32::from(*byte));
        let bits = bits << (8 * (3 - three.len()));
        for digit in 0..4 {
            let value = (bits >> (18 - 6 * digit)) as usize & 63;
            text.push(if digit <= three.len() { char::from(DIGITS[value]) } else { '=' });
        }
    }
    text
}

#[test]
fn texture_coordinates_are_those_that_the_material_asks_for() {
    let image = [png(&dots(0)), png(&dots(1))];
    let with = |info: Value| {
        let raw = json!({
            "pbrMetallicRoughness": { "baseColorTexture": info },
            "normalTexture": { "index": 1 },
        });
        let (document, bin) = painted(raw, &image);
        read_both(&document, &bin).unwrap()
    };
    let first = [Vec2::ZERO, Vec2::X, Vec2::Y];
    let second = [Vec2::splat(0.5), Vec2::new(1.0, 0.5), Vec2::new(0.5, 1.0)];
    assert_eq!(only_mesh(&with(json!({ "index": 0 }))).uvs, first);
    let other = with(json!({ "index": 0, "texCoord": 1 }));
    assert_eq!(only_mesh(&other).uvs, second);
    // The normals' image is laid out otherwise.
    assert!(material_of(&other).images.normal.is_none());
    let told = "materials[0].normalTexture: an image with other texture coordinates than the \
                material's first one is left out";
    assert_eq!(other.warnings, [told]);

    let transform = |transform: Value| {
        let extensions = json!({ "KHR_texture_transform": transform });
        with(json!({ "index": 0, "extensions": extensions }))
    };
    assert_eq!(only_mesh(&transform(json!({ "texCoord": 1 }))).uvs, second);
    assert_eq!(only_mesh(&transform(json!({}))).uvs, first);
    let moved = transform(json!({ "offset": [0.25, 0.5], "scale": [2, 3] }));
    let expected = [Vec2::new(0.25, 0.5), Vec2::new(2.25, 0.5), Vec2::new(0.25, 3.5)];
    assert_eq!(only_mesh(&moved).uvs, expected);
    let turned = transform(json!({ "rotation": std::f32::consts::FRAC_PI_2 }));
    // Counter-clockwise in an image whose v points down: from +u to -v.
    let [o, u, v] = [0, 1, 2].map(|i| only_mesh(&turned).uvs[i]);
    assert!(o == Vec2::ZERO && u.distance(Vec2::NEG_Y) < 1e-6 && v.distance(Vec2::X) < 1e-6);
}
