//! What trees look like: images of bark and leaves, and what users may put in their place.

use sapwood::geom::Mesh;
use sapwood::geom::glam::Vec3;
use sapwood::graph::{Alpha, DrawList, DrawRow, Eye, Material};
use sapwood::images::LeafOutline;
use sapwood::rules::weber_penn::{BarkSlot, FoliageSlot, LeafShape, leaf_card, leaf_mesh};
use sapwood::scene::{MaterialSlot, PushMode, Viewer};

use super::trees::*;

/// The material of each row with leaves, and of each row with stems.
fn materials(list: &DrawList) -> [Vec<&Material>; 2] {
    [true, false].map(|leaves| {
        let rows = list.placed_rows().filter(|(_, row)| row.instances.is_some() == leaves);
        rows.map(|(_, row)| &*row.material).collect()
    })
}

#[test]
fn trees_are_drawn_with_images_that_all_their_branches_share() {
    let mut aspen = grown(&built_in("quaking_aspen"), 1);
    let list = aspen.draw_list();
    let [leaves, stems] = materials(&list);
    assert_eq!((leaves.len(), stems.len()), (50, 101));
    for (materials, has_normals) in [(&leaves, false), (&stems[..1].to_vec(), true)] {
        let first = materials[0].images.base_color.as_ref().unwrap();
        let same = |material: &&Material| {
            material.images.base_color.as_ref().is_some_and(|image| image.is_same(first))
        };
        assert!(materials.iter().all(same));
        assert_eq!(materials[0].images.normal.is_some(), has_normals);
    }
    assert_eq!((leaves[0].alpha, leaves[0].double_sided), (Alpha::Mask(0.5), true));
    assert!(leaves[0].translucency > 0.3 && stems[0].translucency == 0.0);
    let image = leaves[0].images.base_color.as_ref().unwrap();
    assert!(image.pixels.iter().any(|pixel| pixel[3] == 0), "leaves have an outline");
    // Bark on trunk and limbs, another on twigs.
    let mut images: Vec<_> = stems
        .iter()
        .map(|material| material.images.base_color.as_ref().unwrap().digest())
        .collect();
    images.sort_unstable();
    images.dedup();
    assert_eq!(images.len(), 2);
}

#[test]
fn an_edit_of_a_look_compiles_what_wears_it() {
    let aspen = built_in("quaking_aspen");
    let mut tree = grown(&aspen, 1);
    let mut golden = aspen.clone();
    golden.leaves.color = Some([0.5, 0.35, 0.02]);
    tree.set(&golden);
    let compiled = tree.compiled();
    let expected =
        [("attribute", 1), ("leaf_image", 1), ("leaf_surface", 50), ("painted_material", 1)];
    assert_eq!(compiled, expected);
    golden.bark.color = Some([0.3, 0.2, 0.1]);
    tree.set(&golden);
    let compiled = tree.compiled();
    let expected =
        [("attribute", 1), ("bark_image", 1), ("painted_material", 1), ("stem_surface", 101)];
    assert_eq!(compiled, expected, "the twigs' bark stays");
    golden.leaves.scale *= 1.5;
    tree.set(&golden);
    assert_eq!(
        tree.compiled(),
        [("attribute", 1), ("leaf_model", 1), ("leaf_surface", 50)],
        "larger, and painted alike"
    );
}

#[test]
fn a_material_of_the_users_wins_over_the_species() {
    let mut tree = grown(&built_in("quaking_aspen"), 1);
    // Whatever its size.
    let form = |mesh: &Mesh| (mesh.indices.clone(), mesh.uvs.clone());
    let leaf_form = |tree: &mut Grown| {
        let list = tree.draw_list();
        let leaves = list.placed_rows().find(|(_, row)| row.instances.is_some());
        leaves.map(|(_, row)| form(&row.mesh)).unwrap()
    };
    let card = leaf_card(LeafShape::Oval, LeafOutline::Orbicular);
    assert_eq!(leaf_form(&mut tree), form(&card));
    let [gold, pale] = ["gold", "pale"].map(|name| Material::matte(name, 0.6, 0.4, 0.0));
    tree.scene.push::<FoliageSlot>(tree.family, Some(gold.clone())).unwrap();
    tree.scene.push::<BarkSlot>(tree.family, Some(pale.clone())).unwrap();
    let list = tree.draw_list();
    let [leaves, stems] = materials(&list);
    assert!(leaves.iter().all(|material| **material == gold));
    assert!(stems.iter().all(|material| **material == pale));
    // Nothing is known of such a material's images: the mesh has the outline itself.
    assert_eq!(leaf_form(&mut tree), form(&leaf_mesh(LeafShape::Oval)));

    let clay = Material::matte("clay", 0.7, 0.7, 0.7);
    let forced = clay.clone();
    tree.scene
        .edit(tree.family, |family| family.set_as::<MaterialSlot>(PushMode::Force, forced))
        .unwrap();
    let list = tree.draw_list();
    assert!(list.placed_rows().all(|(_, row)| *row.material == clay));
}

#[test]
fn lines_need_no_images() {
    let aspen = built_in("quaking_aspen");
    let mut tree = planted(&aspen, 1);
    let skeleton = tree.scene.open_view(tree.family, &sapwood::skeleton_rules()).unwrap();
    tree.scene.bounds(skeleton).unwrap();
    let log = tree.scene.take_log();
    assert!(log.iter().all(|event| !event.kind.name().ends_with("image")));
    assert!(!log.is_empty());
}

#[test]
fn round_crowns_are_drawn_leaf_by_leaf_with_normals_of_their_own() {
    let round = with(&sapling(), &[("leaves.roundness", 0.8)]);
    let (mut plain, mut tree) = (grown(&sapling(), 2), grown(&round, 2));
    let (before, list) = (plain.draw_list(), tree.draw_list());
    let is_leaf = |row: &DrawRow| row.material.name == "leaf";
    let n_triangles = |list: &DrawList| -> u64 {
        let rows = list.placed_rows().filter(|(_, row)| is_leaf(row));
        rows.map(|(_, row)| row.n_triangles()).sum()
    };
    assert_eq!(n_triangles(&list), n_triangles(&before), "the same leaves");
    assert_eq!(tree.parts().leaves.len(), plain.parts().leaves.len());
    let (mut n, mut sum) = (0, 0.0);
    for (world, row) in list.placed_rows().filter(|(_, row)| is_leaf(row)) {
        assert!(row.instances.is_none() && row.mesh.fault().is_none());
        for (position, normal) in row.mesh.positions.iter().zip(&row.mesh.normals) {
            let place = world.transform_point3(*position);
            let outward = Vec3::new(place.x, 0.0, place.z).normalize_or_zero();
            sum += world.transform_vector3(*normal).dot(outward);
            n += 1;
        }
    }
    assert!(sum / n as f32 > 0.3, "normals lead outward: {}", sum / n as f32);
    let bound = tree.scene.bounds(tree.view).unwrap().aabb;
    assert_eq!(fault(&list, &bound), None);
    assert_eq!(tree.scene.verify(tree.view, 10).unwrap().findings, []);

    // Under the other rules too.
    let fading = tree.scene.open_view(tree.family, &sapwood::fading_rules()).unwrap();
    let [near, far] = [1.0, 150.0].map(|distance| {
        tree.scene.set_moving::<Viewer>(fading, Some(Eye::new(Vec3::X * distance))).unwrap();
        n_triangles(&tree.scene.draw_list(fading, 1_000_000).unwrap().as_drawn())
    });
    assert!(near == n_triangles(&list) && far > 0 && far < near, "{near} and {far}");
    assert_eq!(tree.scene.verify(fading, 10).unwrap().findings, []);
    let swaying = tree.scene.open_view(tree.family, &sapwood::swaying_rules()).unwrap();
    let swayed = tree.scene.draw_list(swaying, 1_000_000).unwrap();
    assert_eq!(digest(&swayed), digest(&list));
    assert!(swayed.placed_rows().all(|(_, row)| row.follows.is_some()));
}
