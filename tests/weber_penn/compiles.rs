//! What is compiled: cold, for a second view, and after an edit of each kind of parameter.

use sapwood::graph::Material;
use sapwood::rules::weber_penn::{BarkSlot, Detail, DetailSlot, FoliageSlot, Seed};

use super::trees::*;

/// What is painted for any tree with a bark of its own for twigs.
const PAINTED: [(&str, usize); 3] = [("bark_image", 2), ("leaf_image", 1), ("painted_material", 3)];

/// What an aspen of 50 limbs compiles to, leaving out what is above the tree.
const ASPEN: [(&str, usize); 7] = [
    ("branch", 51),
    ("children", 51),
    ("leaf_surface", 50),
    ("leaves", 50),
    ("stem_surface", 101),
    ("tree", 1),
    ("twigs", 50),
];

/// The same with images, by name.
fn with_images(compiled: &[(&'static str, usize)]) -> Vec<(&'static str, usize)> {
    let mut all: Vec<_> = compiled.iter().copied().chain(PAINTED).collect();
    all.sort_unstable();
    all
}

#[test]
fn an_aspen_is_compiled_branch_by_branch() {
    let mut aspen = planted(&built_in("quaking_aspen"), 1);
    let mut expected = vec![("attribute", 1)];
    expected.extend(ASPEN);
    let mut ran = with_images(&expected);
    ran.push(("leaf_model", 1));
    ran.sort_unstable();
    assert_eq!(aspen.compiled(), ran);
    let counts = aspen.scene.count(aspen.view).unwrap();
    for (kind, n) in expected {
        assert_eq!(counts.components_of(kind), n as u64, "{kind}");
    }
    assert_eq!(aspen.compiled(), []);
}

#[test]
fn a_skeleton_of_a_grown_tree_compiles_geometry_only() {
    let mut aspen = grown(&built_in("quaking_aspen"), 1);
    let skeleton = aspen.scene.open_view(aspen.family, &sapwood::skeleton_rules()).unwrap();
    assert_eq!(compiled(&mut aspen.scene, skeleton), [("leaves", 50), ("stem_surface", 101)]);
    let lines = aspen.scene.draw_list(skeleton, 1_000_000).unwrap();
    let n_lines: usize = lines.placed_lines().map(|(_, row)| row.lines.len()).sum();
    let stems: usize = aspen.parts().stems.iter().map(Vec::len).sum();
    assert_eq!((n_lines, lines.placed_rows().count()), (stems, 0));
    let second = aspen.scene.open_view(aspen.family, &sapwood::skeleton_rules()).unwrap();
    assert_eq!(compiled(&mut aspen.scene, second), []);
}

#[test]
fn a_draft_of_a_grown_tree_compiles_geometry_only() {
    // There are fewer leaves, and they are larger.
    let painted = with_images(&[
        ("leaf_model", 1),
        ("leaf_surface", 50),
        ("leaves", 50),
        ("stem_surface", 101),
    ]);
    let mut aspen = grown(&built_in("quaking_aspen"), 1);
    let full = digest(&aspen.draw_list());
    // The view that grew it is switched.
    aspen.scene.set_held::<DetailSlot>(aspen.view, Detail::draft()).unwrap();
    assert_eq!(aspen.compiled(), painted, "with smaller images");
    let draft = digest(&aspen.draw_list());
    assert_ne!(draft, full);
    // Another view opens on what is there.
    let second = aspen.scene.open_view(aspen.family, &sapwood::standard_rules()).unwrap();
    aspen.scene.set_held::<DetailSlot>(second, Detail::draft()).unwrap();
    assert_eq!(compiled(&mut aspen.scene, second), []);
    assert_eq!(digest(&aspen.scene.draw_list(second, 1_000_000).unwrap()), draft);

    // Opened beside the full one, it compiles no stem either.
    let mut aspen = grown(&built_in("quaking_aspen"), 1);
    let second = aspen.scene.open_view(aspen.family, &sapwood::standard_rules()).unwrap();
    aspen.scene.set_held::<DetailSlot>(second, Detail::draft()).unwrap();
    assert_eq!(compiled(&mut aspen.scene, second), painted);
    assert_eq!(digest(&aspen.draw_list()), full);
    assert_eq!(digest(&aspen.scene.draw_list(second, 1_000_000).unwrap()), draft);
}

#[test]
fn a_second_view_of_a_grown_tree_compiles_nothing() {
    let mut aspen = grown(&built_in("quaking_aspen"), 1);
    let first = digest(&aspen.draw_list());
    let second = aspen.scene.open_view(aspen.family, &sapwood::standard_rules()).unwrap();
    assert_eq!(compiled(&mut aspen.scene, second), []);
    assert_eq!(digest(&aspen.scene.draw_list(second, 1_000_000).unwrap()), first);
}

#[test]
fn an_edit_of_level_2_leaves_trunk_and_limbs_alone() {
    let aspen = built_in("quaking_aspen");
    for (key, value) in [("level.2.curve", -10.0), ("level.2.length", 0.5), ("level.2.taper", 1.5)]
    {
        let mut tree = grown(&aspen, 1);
        let before = tree.parts();
        tree.set(&with(&aspen, &[(key, value)]));
        let expected = [
            ("attribute", 1),
            ("children", 50),
            ("leaf_surface", 50),
            ("leaves", 50),
            ("stem_surface", 50),
            ("twigs", 50),
        ];
        assert_eq!(tree.compiled(), expected, "{key}");
        let after = tree.parts();
        assert!(before.stems[..2] == after.stems[..2], "{key}");
        assert!(before.segments[..2] == after.segments[..2], "{key}");
        assert!(before.segments[2] != after.segments[2], "{key}");
        tree.set(&aspen);
        assert_eq!(tree.compiled(), [("attribute", 1)], "the plans of before are still there");
    }
}

#[test]
fn an_edit_of_level_2_leaves_the_limbs_of_a_deep_tree_alone() {
    let tupelo = built_in("black_tupelo");
    let mut tree = grown(&tupelo, 3);
    let before = tree.parts();
    tree.set(&with(&tupelo, &[("level.2.curve_v", 90.0)]));
    let compiled = tree.compiled();
    let count = |kind| compiled.iter().find(|(name, _)| *name == kind).map_or(0, |(_, n)| *n);
    let n_limbs = count("twigs") / 2;
    assert_eq!(n_limbs, before.stems[1].iter().filter(|stem| stem.clone_of.is_none()).count());
    assert_eq!((count("tree"), count("branch")), (0, 0));
    // On each limb its own children in one batch, and theirs in another, with the leaves.
    assert_eq!((count("children"), count("leaves")), (2 * n_limbs, n_limbs));
    assert_eq!((count("leaf_surface"), count("leaf_model")), (n_limbs, 0));
    assert_eq!(count("stem_surface"), 2 * n_limbs);
    let after = tree.parts();
    assert!(before.stems[..2] == after.stems[..2] && before.segments[..2] == after.segments[..2]);
    assert!(before.segments[2] != after.segments[2] && before.segments[3] != after.segments[3]);
}

#[test]
fn an_edit_of_the_leaves_compiles_leaves_only() {
    let aspen = built_in("quaking_aspen");
    let (grown_again, drawn_again) = (("leaves", 50), ("leaf_surface", 50));
    for (key, value) in [
        ("leaves.count", 10.0),
        ("leaves.bend", 0.9),
        ("level.3.down_angle", 80.0),
        ("level.3.rotate_v", 10.0),
    ] {
        let mut tree = grown(&aspen, 1);
        tree.set(&with(&aspen, &[(key, value)]));
        assert_eq!(tree.compiled(), [("attribute", 1), drawn_again, grown_again], "{key}");
    }
    // What is only larger stays where it grew.
    let sized = [("attribute", 1), ("leaf_model", 1), drawn_again];
    for key in ["leaves.scale", "leaves.stem_len"] {
        let mut tree = grown(&aspen, 1);
        tree.set(&with(&aspen, &[(key, 0.2)]));
        assert_eq!(tree.compiled(), sized, "{key}");
    }
    // A narrow leaf has another image.
    let mut tree = grown(&aspen, 1);
    tree.set(&with(&aspen, &[("leaves.scale_x", 0.2)]));
    let [attribute, model, drawn] = sized;
    let painted = [attribute, ("leaf_image", 1), model, drawn, ("painted_material", 1)];
    assert_eq!(tree.compiled(), painted);
    let mut tree = grown(&aspen, 1);
    tree.set(&with(&aspen, &[("leaves.quality", 0.5)]));
    assert_eq!(tree.compiled(), [sized[0], sized[1], drawn_again, grown_again]);
}

#[test]
fn what_nothing_reads_compiles_nothing() {
    let aspen = built_in("quaking_aspen");
    let mut tree = grown(&aspen, 1);
    for (key, value) in [("smooth", 0.9), ("level.3.curve", 30.0), ("level.3.branches", 99.0)] {
        tree.set(&with(&aspen, &[(key, value)]));
        assert_eq!(tree.compiled(), [("attribute", 1)], "{key}");
    }
}

#[test]
fn an_edit_of_the_flare_compiles_the_trunks_surface_only() {
    let aspen = built_in("quaking_aspen");
    let mut tree = grown(&aspen, 1);
    tree.set(&with(&aspen, &[("flare", 0.3), ("lobe_depth", 0.2)]));
    // The children of the trunk are no thicker than the trunk, so they are asked again; the flare
    // ends below the first of them, and all of them stay.
    assert_eq!(tree.compiled(), [("attribute", 1), ("children", 1), ("stem_surface", 1)]);
}

#[test]
fn an_edit_of_the_bark_compiles_surfaces_only() {
    let mut tree = grown(&built_in("quaking_aspen"), 1);
    tree.scene.push::<BarkSlot>(tree.family, Some(Material::matte("pale", 0.7, 0.7, 0.6))).unwrap();
    assert_eq!(tree.compiled(), [("attribute", 1), ("stem_surface", 101)]);
    tree.scene
        .push::<FoliageSlot>(tree.family, Some(Material::matte("gold", 0.6, 0.4, 0.0)))
        .unwrap();
    // Whole leaves instead of those that an image cuts out.
    assert_eq!(tree.compiled(), [("attribute", 1), ("leaf_model", 1), ("leaf_surface", 50)]);
    let detail = Detail { ..Detail::default() };
    tree.scene.push::<DetailSlot>(tree.family, detail).unwrap();
    assert_eq!(tree.compiled(), [("attribute", 1)], "the detail is what it was by default");
}

#[test]
fn another_seed_grows_another_tree_and_the_first_comes_back_from_the_cache() {
    let mut tree = grown(&sapling(), 1);
    let first = digest(&tree.draw_list());
    tree.scene.edit(tree.tree, |tree| tree.seed = Seed::Explicit(2)).unwrap();
    let n_compiled: usize = tree.compiled().iter().map(|(_, n)| n).sum();
    assert!(n_compiled > 20, "{n_compiled}");
    assert_ne!(digest(&tree.draw_list()), first);
    tree.scene.edit(tree.tree, |tree| tree.seed = Seed::Explicit(1)).unwrap();
    assert_eq!(tree.compiled(), [("tree", 1)]);
    assert_eq!(digest(&tree.draw_list()), first);
}
