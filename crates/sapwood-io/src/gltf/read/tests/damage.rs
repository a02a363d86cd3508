//! Files with random damage are read or refused, never more than they could hold.

use sapwood_geom::{Image, Mesh, Purpose, Shared, SharedMesh, Stream, StreamPath};
use sapwood_graph::{
    Alpha, Body, Camera, CameraRow, DrawList, DrawRow, Kind, Lens, Light, LightRow, LightShape,
    Material, Occurrence,
};
use sapwood_scene::{Group, Scene, built_in_rules};

use super::*;

/// What our own writer writes: meshes, shared and sheared, with an image, a light and a camera.
pub(super) fn written() -> DrawList {
    let mesh = Mesh {
        positions: vec![Vec3::new(-0.0, 0.1, 0.0), Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
        normals: vec![Vec3::Z; 4],
        uvs: [[0.0, 0.25], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Into::into).to_vec(),
        indices: vec![0, 1, 2, 0, 2, 3],
    };
    let mut leaf = Material {
        alpha: Alpha::Mask(0.5),
        double_sided: true,
        emissive: [0.0, 0.5, 2.0],
        translucency: 0.3,
        ..Material::matte("leaf", 0.25, 1.0, 0.5)
    };
    let image = Image::from_fn(4, 3, |x, y| [10 * x as u8, 10 * y as u8, 0, 60 * x as u8]);
    leaf.images.base_color = Some(Shared::new(image));
    let row = |material: Material, instances: Option<Vec<Affine3>>| DrawRow {
        instances: instances.map(Shared::new),
        ..DrawRow::new(Affine3::IDENTITY, SharedMesh::new(mesh.clone()), material.into())
    };
    let at = |x: f32| Affine3::from_translation(Vec3::new(x, 0.5, 0.0));
    let tree = Body {
        rows: vec![
            row(Material::matte("bark", 0.5, 0.25, 0.125), None),
            row(leaf, Some(vec![at(1.0), at(2.0) * Affine3::from_rotation_x(1.0)])),
        ],
        ..Body::new(Kind::of::<Group>())
    };
    let light = Light {
        name: "lamp".into(),
        color: [1.0, 0.5, 0.25],
        intensity: 7.0,
        shape: LightShape::Spot { range: Some(9.0), inner: 0.25, outer: 0.5 },
    };
    let camera = Camera {
        name: "eye".into(),
        lens: Lens::Perspective { vertical_angle: 0.75 },
        near: 0.5,
        far: Some(10.0),
    };
    let stage = Body {
        lights: vec![LightRow { local: at(3.0) * Affine3::from_rotation_y(1.0), light }],
        cameras: vec![CameraRow { local: at(4.0), camera }],
        ..Body::new(Kind::of::<Group>())
    };
    let shear = Affine3::from_scale(Vec3::new(2.0, 1.0, 1.0)) * Affine3::from_rotation_z(0.5);
    let places = [Affine3::IDENTITY, at(10.0) * Affine3::from_rotation_y(2.0), shear];
    let mut occurrences: Vec<Occurrence> = places.map(|world| Occurrence { body: 0, world }).into();
    occurrences.push(Occurrence { body: 1, world: at(0.0) });
    DrawList { bodies: vec![tree, stage], occurrences }
}

/// Reads damaged bytes, and looks at what comes of it.
fn look(bytes: &[u8]) -> bool {
    match read(bytes, None, &ReadLimits::default()) {
        Ok(model) => {
            let parts = || model.meshes.iter().flatten();
            for part in parts() {
                assert_eq!(part.mesh.unsound(), None);
                assert_eq!(part.material.as_ref().unwrap().fault(), None);
            }
            let n_vertices: usize = parts().map(|part| part.mesh.n_vertices()).sum();
            let n_triangles: usize = parts().map(|part| part.mesh.n_triangles()).sum();
            assert!(n_vertices < 10_000 && n_triangles < 10_000);
            let mut scene = Scene::new();
            let top = model.add_to(&mut scene);
            let view = scene.open_view(top, &built_in_rules()).unwrap();
            assert!(scene.diagnostics(view, 10).unwrap().is_empty());
            true
        }
        Err(error) => {
            let line = error.to_string();
            assert!(line.len() < 600 && !line.contains('\n'), "{line}");
            false
        }
    }
}

/// Damages `whole` at random, `n` times; tells how often it could still be read.
fn damage(whole: &[u8], n: usize, from: std::ops::Range<usize>, seed: u64) -> usize {
    let mut stream = Stream::new(StreamPath::new(seed), Purpose("damage"));
    let mut pick = |n: usize| (stream.bits() % n as u64) as usize;
    let mut n_read = 0;
    for _ in 0..n {
        let mut bytes = whole.to_vec();
        for _ in 0..=pick(3) {
            let at = from.start + pick(from.len().min(bytes.len() - from.start));
            let end = (at + pick(20)).min(bytes.len());
            match pick(6) {
                0 => bytes[at] = pick(256) as u8,
                1 => bytes[at] ^= 1 << pick(8),
                2 => bytes[at] = b"0123456789-.e,:[]{}\" "[pick(21)],
                3 => drop(bytes.drain(at..end)),
                4 => bytes.splice(at..at, bytes[at..end].to_vec()).for_each(drop),
                _ => {
                    // Another number in the stead of one.
                    let is_digit = |byte: &u8| byte.is_ascii_digit();
                    if let Some(start) = bytes[at..].iter().position(is_digit) {
                        let start = at + start;
                        let n = bytes[start..].iter().take_while(|byte| is_digit(byte)).count();
                        let numbers = ["0", "1", "65536", "4294967295", "18446744073709551615"];
                        let other = numbers[pick(5)].bytes();
                        bytes.splice(start..start + n, other).for_each(drop);
                    }
                }
            }
        }
        n_read += usize::from(look(&bytes));
    }
    n_read
}

/// The length of the JSON of a binary file.
fn text_length(bytes: &[u8]) -> usize {
    u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize
}

#[test]
fn damaged_binary_files_are_read_or_refused() {
    let whole = crate::glb_bytes(&written()).unwrap();
    let text = text_length(&whole);
    for n in 0..whole.len() {
        look(&whole[..n]);
    }
    assert!(damage(&whole, 3000, 0..whole.len(), 1) > 10);
    // Damage to the buffer alone leaves most files readable.
    assert!(damage(&whole, 2000, 20 + text + 8..whole.len(), 2) > 100);
}

#[test]
fn damaged_texts_are_read_or_refused() {
    let whole = crate::glb_bytes(&written()).unwrap();
    let text = text_length(&whole);
    // The binary chunk as data, so that the text is the whole file.
    let mut document: Value = serde_json::from_slice(&whole[20..20 + text]).unwrap();
    let bytes: String = whole[28 + text..].iter().map(|byte| format!("%{byte:02x}")).collect();
    document["buffers"][0]["uri"] = json!(format!("data:,{bytes}"));
    let text = document.to_string();
    assert!(look(text.as_bytes()));
    let buffers = text.find("\"buffers\"").unwrap();
    let structure = text.len() - buffers;
    assert!(structure > 0);
    // All but the long run of data.
    let data = text.find("data:,").unwrap();
    assert!(damage(text.as_bytes(), 1500, 0..data, 3) > 10);
    let rest = data + 6 + bytes.len();
    assert!(damage(text.as_bytes(), 4000, rest..text.len(), 4) > 100);
}
