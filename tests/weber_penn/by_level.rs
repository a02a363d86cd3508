//! What species say of single levels beyond the paper: leaves on others than the last, sides and
//! segments of the stems' surfaces.

use sapwood::graph::DrawList;
use sapwood::rules::weber_penn::{Detail, DetailSlot, Leaf, LevelDetail};

use super::trees::*;

/// Frames of leaves, by the level of the stem that they are on.
fn leaves_by_level(tree: &mut Grown) -> Vec<Vec<[f32; 3]>> {
    let mut found: Vec<Vec<[f32; 3]>> = vec![Vec::new(); 3];
    let mut level_above = sapwood::geom::FixedMap::with_hasher(sapwood::geom::fixed_state());
    let visit = &mut |at: &sapwood::graph::At<'_, ()>| {
        if !at.enters_plan() {
            return;
        }
        let plan = at.plan();
        let number = at.path().number();
        let stems = plan.parts.of::<sapwood::rules::weber_penn::Stem>();
        let above = level_above.get(&at.path().number_above()).copied().unwrap_or(0u8);
        let level = stems.first().map_or(above, |stem| stem.seed.level);
        level_above.insert(number, level);
        let leaves = plan.parts.of::<Leaf>();
        let origins = leaves.iter().map(|leaf| leaf.frame.origin.to_array());
        found[usize::from(level)].extend(origins);
    };
    let order = sapwood::graph::Order::Pre;
    tree.scene.traverse(tree.view, order, &sapwood::graph::Everything, visit).unwrap();
    found
}

#[test]
fn leaves_grow_on_the_levels_that_ask_for_them() {
    let plain = sapling();
    let leafy = with(&plain, &[("level.1.leaves", 14.0), ("level.0.leaves", -5.0)]);
    let mut before = grown(&plain, 3);
    let on_last = leaves_by_level(&mut before);
    assert!(on_last[0].is_empty() && on_last[1].is_empty());

    let mut tree = grown(&leafy, 3);
    let found = leaves_by_level(&mut tree);
    assert_eq!(found[2], on_last[2], "those on the last level stay");
    assert_eq!(found[0].len(), 5, "a fan at the trunk's tip");
    let parts = tree.parts();
    // As many as the formula has for leaves, of which a stem's share follows from its place.
    let expected: f32 = parts.stems[1]
        .iter()
        .filter(|stem| stem.clone_of.is_none())
        .map(|stem| 14.0 * (0.5 + 0.5 * stem.seed.offset / stem.seed.parent_length))
        .sum();
    let n = found[1].len() as f32;
    assert!((n - expected).abs() <= parts.stems[1].len() as f32, "{n} for {expected}");
    let bound = tree.scene.bounds(tree.view).unwrap().aabb;
    assert_eq!(fault(&tree.draw_list(), &bound), None);

    // Another number on one level moves nothing else.
    tree.set(&with(&leafy, &[("level.1.leaves", 20.0)]));
    let n_level_1 = parts.stems[1].iter().filter(|stem| stem.clone_of.is_none()).count();
    let compiled = tree.compiled();
    assert!(compiled.contains(&("leaves", n_level_1)), "{compiled:?}");
    assert!(compiled.iter().all(|(kind, _)| !["branch", "twigs"].contains(kind)), "{compiled:?}");
    assert_eq!(leaves_by_level(&mut tree)[2], on_last[2]);

    let text = tree.scene.open_view(tree.family, &sapwood::text_rules()).unwrap();
    let outline = tree.scene.outline(text, 100).unwrap();
    let n_leaves: usize = leaves_by_level(&mut tree).iter().map(Vec::len).sum();
    assert!(outline.contains(&format!("{n_leaves} leaves")), "{n_leaves}: {outline}");
}

#[test]
fn stems_that_get_leaves_do_not_grow_again() {
    let plain = sapling();
    let leafy = with(&plain, &[("level.1.leaves", 1.0)]);
    let mut tree = grown(&plain, 3);
    let n_stems = tree.parts().stems[1].iter().filter(|stem| stem.clone_of.is_none()).count();
    tree.set(&leafy);
    // Where children begin is looked at again, and they are the same; then there are the leaves.
    let once =
        [("attribute", 1), ("children", n_stems), ("leaf_surface", n_stems), ("leaves", n_stems)];
    let compiled = tree.compiled();
    assert_eq!(compiled.iter().filter(|(kind, _)| *kind != "leaf_surface").count(), 3);
    for (kind, n) in compiled {
        let most = once.iter().find(|(known, _)| *known == kind).map_or(0, |(_, most)| *most);
        assert!(n <= most && (kind == "leaf_surface" || n == most), "{n} {kind}");
    }
    assert!(!leaves_by_level(&mut tree)[1].is_empty());
    // Back: nothing is left to do but to look.
    tree.set(&plain);
    assert!(tree.compiled().iter().all(|(kind, _)| ["attribute", "children"].contains(kind)));
    assert!(leaves_by_level(&mut tree)[1].is_empty());
    // What sways carries them too.
    tree.set(&leafy);
    let swaying = sapwood::swaying_rules().over(&sapwood::standard_rules());
    let view = tree.scene.open_view(tree.family, &swaying).unwrap();
    let list = tree.scene.draw_list(view, 1_000_000).unwrap();
    assert_eq!(digest(&list), digest(&tree.draw_list()));
    assert!(list.placed_rows().all(|(_, row)| row.follows.is_some()));
}

/// Triangles of the wood.
fn wood(list: &DrawList) -> usize {
    let rows = list.placed_rows().filter(|(_, row)| row.instances.is_none());
    rows.map(|(_, row)| row.mesh.n_triangles()).sum()
}

#[test]
fn surfaces_have_the_sides_and_segments_that_species_ask_for() {
    let plain = sapling();
    let asked = |segments: f32| {
        let mut values = Vec::new();
        for name in ["level.0.sides", "level.1.sides", "level.2.sides"] {
            values.push((name, 5.0));
        }
        for name in ["level.0.segments", "level.1.segments", "level.2.segments"] {
            values.push((name, segments));
        }
        // A flared foot has rings of its own.
        values.push(("flare", 0.0));
        with(&plain, &values)
    };
    let mut tree = grown(&asked(3.0), 1);
    let parts = tree.parts();
    let n_stems: usize = parts.stems.iter().map(Vec::len).sum();
    assert!(parts.stems.iter().flatten().all(|stem| stem.clone_of.is_none()));
    // Three rings of five squares each, of which the last ends in a point: five triangles; and the
    // trunk's foot, a fan of five.
    assert_eq!(wood(&tree.draw_list()), 25 * n_stems + 5);
    tree.set(&asked(17.0));
    let kinds = ["attribute", "stem_surface"];
    assert!(tree.compiled().iter().map(|(kind, _)| *kind).eq(kinds), "no stem grows again");
    let n = wood(&tree.draw_list());
    assert!(n <= (16 * 10 + 5) * n_stems + 5 && n > 150 * n_stems, "{n} of {n_stems} stems");
    // What the view says goes first.
    let mut detail = Detail::default();
    detail.levels.fill(LevelDetail { sides: None, segments: Some(3) });
    tree.scene.set_held::<DetailSlot>(tree.view, detail).unwrap();
    assert_eq!(wood(&tree.draw_list()), 25 * n_stems + 5);
}
