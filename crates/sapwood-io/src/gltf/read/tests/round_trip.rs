//! What is written and read back draws the same.

use sapwood_geom::{Image, Mesh, Shared};
use sapwood_graph::{Camera, DrawList, Light, Material, MaterialImages};
use sapwood_rules::weber_penn::{self, Seed, Tree};
use sapwood_scene::{Scene, built_in_rules};

use super::damage::written;
use super::*;

/// Everything that a list draws: each material's triangles in the world, lights and cameras.
#[derive(Debug, Default)]
struct Drawn {
    materials: Vec<(Material, Mesh)>,
    lights: Vec<(Affine3, Light)>,
    cameras: Vec<(Affine3, Camera)>,
}

fn drawn(list: &DrawList) -> Drawn {
    let mut drawn = Drawn::default();
    for (world, row) in list.placed_rows() {
        let place = drawn.materials.iter().position(|(material, _)| *material == *row.material);
        let place = place.unwrap_or_else(|| {
            drawn.materials.push(((*row.material).clone(), Mesh::default()));
            drawn.materials.len() - 1
        });
        let mesh = &mut drawn.materials[place].1;
        match &row.instances {
            None => mesh.append(&row.mesh, &world),
            Some(all) => all.iter().for_each(|one| mesh.append(&row.mesh, &(world * *one))),
        }
    }
    drawn.lights = list.placed_lights().map(|(at, light)| (at, light.clone())).collect();
    drawn.cameras = list.placed_cameras().map(|(at, camera)| (at, camera.clone())).collect();
    drawn
}

/// The list that a scene with the model draws.
fn list_of(model: &Model) -> DrawList {
    let mut scene = Scene::new();
    let top = model.add_to(&mut scene);
    let view = scene.open_view(top, &built_in_rules()).unwrap();
    scene.draw_list(view, 10_000).unwrap()
}

/// The material with images that are told apart by their pixels, not by what they were made of.
fn by_pixels(material: &Material) -> Material {
    let of = |image: &Option<Shared<Image>>| {
        image.as_ref().map(|image| Shared::new(Image::clone(image)))
    };
    let MaterialImages { base_color, metallic_roughness, normal, emissive } = &material.images;
    let images = MaterialImages {
        base_color: of(base_color),
        metallic_roughness: of(metallic_roughness),
        normal: of(normal),
        emissive: of(emissive),
    };
    Material { images, ..material.clone() }
}

fn check_equal(before: &Drawn, after: &Drawn) {
    assert_eq!(before.materials.len(), after.materials.len());
    for ((material, mesh), (material_after, after)) in before.materials.iter().zip(&after.materials)
    {
        assert_eq!(by_pixels(material), by_pixels(material_after));
        assert_eq!((&mesh.indices, &mesh.uvs), (&after.indices, &after.uvs));
        let near =
            |a: &[Vec3], b: &[Vec3]| a.iter().zip(b).all(|(a, b)| a.distance(*b) < 2e-6 * 16.0);
        assert_eq!(mesh.n_vertices(), after.n_vertices());
        assert!(near(&mesh.positions, &after.positions), "{}", material.name);
        assert!(near(&mesh.normals, &after.normals), "{}", material.name);
    }
    let near = |a: &Affine3, b: &Affine3| a.abs_diff_eq(*b, 1e-6);
    assert_eq!(before.lights.len(), after.lights.len());
    for ((at, light), (at_after, after)) in before.lights.iter().zip(&after.lights) {
        assert!(light == after && near(at, at_after), "{light:?} {after:?}");
    }
    assert_eq!(before.cameras.len(), after.cameras.len());
    for ((at, camera), (at_after, after)) in before.cameras.iter().zip(&after.cameras) {
        assert!(camera == after && near(at, at_after), "{camera:?} {after:?}");
    }
}

#[test]
fn both_forms_draw_what_was_written() {
    let list = written();
    let folder = tempfile::tempdir().unwrap();
    for name in ["tree.glb", "a tree.gltf"] {
        let path = folder.path().join(name);
        match name.ends_with(".glb") {
            true => crate::write_glb(&path, &list).unwrap(),
            false => crate::write_gltf(&path, &list).unwrap(),
        }
        let model = read_gltf(&path, &ReadLimits::default()).unwrap();
        assert_eq!(model.warnings, [""; 0]);
        check_equal(&drawn(&list), &drawn(&list_of(&model)));
    }
}

#[test]
fn meshes_come_back_bit_for_bit() {
    let list = written();
    let bytes = crate::glb_bytes(&list).unwrap();
    let model = read(&bytes, None, &ReadLimits::default()).unwrap();
    let bark = &model.meshes[0][0];
    let bits = |points: &[Vec3]| -> Vec<[u32; 3]> {
        points.iter().map(|point| point.to_array().map(f32::to_bits)).collect()
    };
    let before = &list.bodies[0].rows[0].mesh;
    assert_eq!(bits(&bark.mesh.positions), bits(&before.positions));
    assert_eq!(bits(&bark.mesh.normals), bits(&before.normals));
    assert_eq!((&bark.mesh.uvs, &bark.mesh.indices), (&before.uvs, &before.indices));
    // What is read is written with the same meshes, materials and images once more.
    let again = crate::glb_bytes(&list_of(&model)).unwrap();
    let second = read(&again, None, &ReadLimits::default()).unwrap();
    let parts = |model: &Model| -> Vec<_> {
        let parts = model.meshes.iter().flatten();
        parts.map(|part| (part.mesh.clone(), part.material.clone())).collect()
    };
    assert_eq!(parts(&model), parts(&second));
}

#[test]
fn trees_are_read_as_they_were_written() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["quaking_aspen", "palm", "wheat"] {
        let mut scene = Scene::new();
        let top = scene.add(crate::built_in(name).unwrap().attribute());
        scene.add_to(top, Tree { seed: Seed::Explicit(3) }).unwrap();
        let rules = sapwood_images::rules().over(&built_in_rules());
        let view = scene.open_view(top, &weber_penn::full().over(&rules)).unwrap();
        let list = scene.draw_list(view, 10_000).unwrap();
        let before = drawn(&list);
        assert!(before.materials.len() >= 2 || name == "palm", "{}", before.materials.len());
        for ending in ["glb", "gltf"] {
            let path = folder.path().join(name).with_extension(ending);
            match ending {
                "glb" => crate::write_glb(&path, &list).unwrap(),
                _ => crate::write_gltf(&path, &list).unwrap(),
            }
            let model = read_gltf(&path, &ReadLimits::default()).unwrap();
            assert_eq!(model.warnings, [""; 0]);
            check_equal(&before, &drawn(&list_of(&model)));
        }
    }
}
