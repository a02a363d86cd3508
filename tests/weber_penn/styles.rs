//! The style and the material of trees.

use sapwood::graph::{DrawList, Material};
use sapwood::rules::weber_penn::{Seed, Tree};
use sapwood::scene::{
    Action, Attribute, Handle, MaterialSlot, PushMode, Scene, Style, StyleSlot, ViewId,
};

/// A wheat below its species, below an attribute without any slot.
fn wheat() -> (Scene, ViewId, Handle<Attribute>) {
    let species = sapwood::io::find_species("wheat").unwrap();
    let mut scene = Scene::new();
    let look = scene.add(Attribute::new());
    let family = scene.add_to(look, species.attribute()).unwrap();
    scene.add_to(family, Tree { seed: Seed::Explicit(3) }).unwrap();
    let view = scene.open_view(look, &sapwood::standard_rules()).unwrap();
    scene.set_check_mode(true);
    (scene, view, look)
}

/// Meshes, instance arrays and lines of a list.
fn drawn(list: &DrawList) -> (usize, usize, usize) {
    let rows: Vec<_> = list.placed_rows().collect();
    let n_instanced = rows.iter().filter(|(_, row)| row.instances.is_some()).count();
    let n_lines = list.placed_lines().map(|(_, row)| row.lines.len()).sum();
    (rows.len() - n_instanced, n_instanced, n_lines)
}

#[test]
fn each_style_draws_the_same_stems_in_its_own_way() {
    let (mut scene, view, look) = wheat();
    let (n_meshes, n_instanced, n_lines) = drawn(&scene.draw_list(view, 100_000).unwrap());
    assert!(n_meshes > 0 && n_instanced > 0 && n_lines == 0);
    let counted = scene.count(view).unwrap();

    scene.set_logging(true);
    scene.push::<StyleSlot>(look, Style::Wire).unwrap();
    let wire = drawn(&scene.draw_list(view, 100_000).unwrap());
    assert!(wire.0 == 0 && wire.1 == 0 && wire.2 > n_meshes, "{wire:?}");
    scene.push::<StyleSlot>(look, Style::Skeleton).unwrap();
    let skeleton = scene.draw_list(view, 100_000).unwrap();
    let n_stems = counted.parts_of("stem") as usize;
    assert_eq!(drawn(&skeleton), (0, 0, n_stems), "one line for each stem");

    // Nothing was grown anew.
    let mut compiled: Vec<&str> = scene
        .take_log()
        .iter()
        .filter(|event| event.action == Action::Compiled)
        .map(|event| event.kind.name())
        .collect();
    compiled.sort_unstable();
    compiled.dedup();
    assert_eq!(compiled, ["attribute", "leaf_model", "leaf_surface", "leaves", "stem_surface"]);

    // The skeleton rules draw the same lines, whatever the style.
    let second = scene.open_view(look, &sapwood::skeleton_rules()).unwrap();
    let lines = |list: &DrawList| {
        list.placed_lines().flat_map(|(_, row)| row.lines.to_vec()).collect::<Vec<_>>()
    };
    assert_eq!(lines(&scene.draw_list(second, 100_000).unwrap()), lines(&skeleton));
}

#[test]
fn one_view_shows_wires_and_clay_whatever_the_scene_asks_for() {
    let (mut scene, view, look) = wheat();
    scene.push::<StyleSlot>(look, Style::Solid).unwrap();
    let wires = scene.open_view(look, &sapwood::standard_rules()).unwrap();
    scene.force_held::<StyleSlot>(wires, Style::Wire).unwrap();
    assert_eq!(drawn(&scene.draw_list(wires, 100_000).unwrap()).0, 0);
    assert!(drawn(&scene.draw_list(view, 100_000).unwrap()).0 > 0);

    let clay = Material::matte("clay", 0.7, 0.7, 0.7);
    let names = |scene: &mut Scene, view| {
        let list = scene.draw_list(view, 100_000).unwrap();
        let mut names: Vec<String> =
            list.placed_rows().map(|(_, row)| row.material.name.clone()).collect();
        names.sort();
        names.dedup();
        names
    };
    scene.push::<MaterialSlot>(look, clay.clone()).unwrap();
    assert_eq!(names(&mut scene, view), ["bark", "leaf"], "trees have materials of their own");
    scene.edit(look, |look| look.set_as::<MaterialSlot>(PushMode::Force, clay)).unwrap();
    assert_eq!(names(&mut scene, view), ["clay"]);
}
