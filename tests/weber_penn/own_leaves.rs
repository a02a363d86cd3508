//! Leaves of somebody's own: meshes and images, from files and from programs, in every view.

use std::sync::Arc;

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::geom::{Image, Mesh, Shared};
use sapwood::graph::{Alpha, DrawList, DrawRow, Eye, Material, Poses, Wind};
use sapwood::rules::weber_penn::{
    FoliageSlot, LeafMesh, LeafShape, OwnLeafImage, Species, WrittenImage, WrittenMesh, leaf_mesh,
};
use sapwood::scene::{Time, Viewer, WindSlot};

use super::trees::*;

/// A pear that hangs along +z, three units long and half as wide.
fn pear() -> Mesh {
    let mut pear = Mesh::default();
    let size = Affine3::from_scale(Vec3::new(1.5, 1.5, 3.0));
    pear.append(&leaf_mesh(LeafShape::Sphere), &size);
    pear
}

fn yellow() -> Material {
    Material { roughness: 0.4, ..Material::matte("pear", 0.7, 0.6, 0.1) }
}

fn with_mesh(mesh: &Mesh, material: Option<Material>) -> Species {
    let mut species = sapling();
    let mesh = LeafMesh::new(mesh, material.map(Arc::new)).unwrap();
    species.leaves.mesh = Some(WrittenMesh { path: String::new(), mesh });
    species.leaves.scale_x = 1.0;
    species
}

/// A leaf that is there in the middle of its image, which is half as wide as it is high.
fn image() -> Image {
    Image::from_fn(16, 32, |x, _| [30, 120, 20, if (4..12).contains(&x) { 255 } else { 0 }])
}

fn with_image(image: Image) -> Species {
    let mut species = sapling();
    let image = OwnLeafImage::new(Shared::new(image));
    species.leaves.image = Some(WrittenImage { path: String::new(), image });
    species.leaves.scale_x = 1.0;
    species
}

fn leaf_rows(list: &DrawList) -> Vec<DrawRow> {
    let rows = list.placed_rows().filter(|(_, row)| row.instances.is_some());
    rows.map(|(_, row)| row.clone()).collect()
}

#[test]
fn a_mesh_stands_where_the_leaves_stood() {
    let species = with_mesh(&pear(), Some(yellow()));
    let (mut plain, mut own) = (grown(&sapling(), 1), grown(&species, 1));
    let (plain, list) = (leaf_rows(&plain.draw_list()), own.draw_list());
    let rows = leaf_rows(&list);
    assert_eq!(rows.len(), plain.len());
    for (row, plain) in rows.iter().zip(&plain) {
        assert_eq!(row.instances, plain.instances);
        assert!(row.mesh.is_same(&rows[0].mesh), "one mesh for all of them");
        assert_eq!(*row.material, yellow());
    }
    let bound = rows[0].mesh.bound().aabb;
    let petiole = species.leaves.stem_len * species.leaves.scale;
    assert!((bound.max.z - petiole - species.leaves.scale).abs() < 1e-6);
    let bound = own.scene.bounds(own.view).unwrap().aabb;
    assert_eq!(fault(&list, &bound), None);
    // Twice as large, and nothing moves.
    let mut large = species.clone();
    large.leaves.scale *= 2.0;
    own.set(&large);
    let kinds = ["attribute", "leaf_model", "leaf_surface"];
    assert!(own.compiled().iter().map(|(kind, _)| *kind).eq(kinds));
}

#[test]
fn meshes_without_a_material_have_the_color_of_the_leaves() {
    let mut species = with_mesh(&pear(), None);
    species.leaves.color = Some([0.3, 0.2, 0.1]);
    let rows = leaf_rows(&grown(&species, 1).draw_list());
    assert_eq!(rows[0].material.base_color, [0.3, 0.2, 0.1, 1.0]);
    let mut tree = grown(&species, 1);
    tree.scene.push::<FoliageSlot>(tree.family, Some(yellow())).unwrap();
    let rows = leaf_rows(&tree.draw_list());
    assert_eq!((&*rows[0].material, rows[0].mesh.n_triangles()), (&yellow(), pear().n_triangles()));
}

#[test]
fn an_image_that_is_cut_out_is_shown_on_a_card_of_its_proportions() {
    let species = with_image(image());
    let mut tree = grown(&species, 1);
    let list = tree.draw_list();
    let rows = leaf_rows(&list);
    let size = rows[0].mesh.bound().aabb.size();
    assert!((size.x - 0.5 * size.z).abs() < 1e-6 && rows[0].mesh.n_triangles() == 2);
    assert_eq!((rows[0].material.alpha, rows[0].material.double_sided), (Alpha::Mask(0.5), true));
    assert_eq!(**rows[0].material.images.base_color.as_ref().unwrap(), image());
    // What is not cut out lies on the shape that the species has.
    let whole = Image::from_fn(8, 8, |x, _| [x as u8, 120, 20, 255]);
    let rows = leaf_rows(&grown(&with_image(whole), 1).draw_list());
    assert_eq!(rows[0].mesh.n_triangles(), leaf_mesh(sapling().leaves.shape).n_triangles());
    assert_eq!(rows[0].material.alpha, Alpha::Opaque);
}

#[test]
fn leaves_of_ones_own_fade_sway_and_are_told_of() {
    for species in [with_mesh(&pear(), Some(yellow())), with_image(image())] {
        let mut tree = grown(&species, 2);
        let near = tree.draw_list();
        let count = |rows: &[DrawRow]| -> usize {
            rows.iter().map(|row| row.instances.as_ref().unwrap().len()).sum()
        };
        let n_leaves = count(&leaf_rows(&near));

        let fading = tree.scene.open_view(tree.family, &sapwood::fading_rules()).unwrap();
        tree.scene.set_moving::<Viewer>(fading, Some(Eye::new(Vec3::X * 150.0))).unwrap();
        let far = tree.scene.draw_list(fading, 1_000_000).unwrap();
        let far = far.as_drawn();
        let (of_mesh, of_points): (Vec<_>, Vec<_>) =
            leaf_rows(&far).into_iter().partition(|row| row.mesh.n_triangles() > 1);
        let (whole, points) = (count(&of_mesh), count(&of_points));
        assert!(points > 0 && whole + points <= n_leaves, "{whole} and {points} of {n_leaves}");
        // A point shows what is there.
        for row in &of_points {
            assert_eq!(row.mesh.fault(), None);
            let uv = row.mesh.uvs[0];
            if let Some(image) = &row.material.images.base_color {
                let (x, y) = (uv.x * image.width as f32, uv.y * image.height as f32);
                let pixel = image.pixels[y as usize * image.width as usize + x as usize];
                assert_eq!(pixel[3], 255, "{uv}");
            }
        }

        let swaying = tree.scene.open_view(tree.family, &sapwood::swaying_rules()).unwrap();

        tree.scene.set_moving::<WindSlot>(swaying, Wind::new(9.0, 4.0)).unwrap();
        tree.scene.set_moving::<Time>(swaying, 2.5).unwrap();
        let list = tree.scene.draw_list(swaying, 1_000_000).unwrap();
        let mut poses = Poses::new(&list);
        tree.scene.sway(swaying, &mut poses).unwrap();
        let moved = leaf_rows(&poses.posed(&list));
        assert_eq!(count(&moved), n_leaves);
        assert_ne!(moved[0].instances, leaf_rows(&near)[0].instances);

        for rules in [sapwood::map_rules(), sapwood::text_rules()] {
            let view = tree.scene.open_view(tree.family, &rules).unwrap();
            assert_eq!(tree.scene.diagnostics(view, 10).unwrap().len(), 0);
        }
    }
}
