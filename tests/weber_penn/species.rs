//! Every built-in species: sound geometry, and the same bytes whatever the cache went through.

use sapwood::graph::{Order, Under};
use sapwood::rules::weber_penn::{Seed, Species};
use sapwood::scene::Scene;

use super::trees::*;

/// All species by name; the willow with a tenth of its twigs, for the tests that grow it often.
pub(super) fn all() -> Vec<(&'static str, Species)> {
    let light = |name| match name {
        "weeping_willow" => with(&built_in(name), &[("level.3.branches", 30.0)]),
        _ => built_in(name),
    };
    sapwood::io::built_in_names().map(|name| (name, light(name))).collect()
}

#[test]
fn every_species_is_sound() {
    for name in sapwood::io::built_in_names() {
        // Out of check mode: the willow as it is.
        let mut tree = planted_in(Scene::new(), &built_in(name), 1);
        let bound = tree.scene.bounds(tree.view).unwrap();
        assert_eq!(tree.scene.diagnostics(tree.view, 10).unwrap(), [], "{name}");
        let list = tree.draw_list();
        assert_eq!(fault(&list, &bound.aabb), None, "{name}");
        let (vertices, triangles) = list.n_vertices_and_triangles();
        assert!(vertices > 1000 && triangles > 1000, "{name}: {vertices} {triangles}");
        // Nothing reaches far below the ground, but for what hangs.
        let size = bound.aabb.size();
        assert!(bound.aabb.min.y > -0.5 * size.y, "{name}: {bound:?}");
        for (_, row) in list.placed_rows() {
            assert!(row.instances.as_ref().is_none_or(|instances| !instances.is_empty()));
        }
    }
}

#[test]
fn two_scenes_grow_the_same_bytes_and_another_seed_others() {
    for (name, species) in all() {
        let [a, b, c] = [1, 1, 2].map(|seed| {
            let mut tree = planted_in(Scene::new(), &species, seed);
            digest(&tree.draw_list())
        });
        assert_eq!(a, b, "{name}");
        assert_ne!(a, c, "{name}");
    }
}

#[test]
fn files_of_two_scenes_are_equal() {
    for name in ["quaking_aspen", "palm", "bamboo"] {
        let [a, b] = [1, 1].map(|seed| {
            let mut tree = planted_in(Scene::new(), &built_in(name), seed);
            sapwood::io::glb_bytes(&tree.draw_list()).unwrap()
        });
        assert!(a == b, "{name}");
    }
}

/// Numbers for choices in tests.
struct Chances(u64);

impl Chances {
    fn below(&mut self, n: u64) -> u64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }
}

#[test]
fn the_cache_never_shows() {
    let mut chances = Chances(4);
    for (name, species) in all().into_iter().filter(|(name, _)| published().contains(name)) {
        let fresh = {
            let mut tree = planted_in(Scene::new(), &species, 5);
            digest(&tree.draw_list())
        };
        let mut tree = planted(&species, 5);
        for _ in 0..4 {
            for _ in 0..3 {
                match chances.below(6) {
                    0 => tree.scene.evict(),
                    1 => {
                        // A part of the tree only: some limb, and what grows on it.
                        let links = vec![0, 0, chances.below(2) as u32, chances.below(9) as u32];
                        let under = Under(links);
                        tree.scene.traverse(tree.view, Order::Pre, &under, &mut |_| ()).unwrap();
                    }
                    2 => {
                        let rules = sapwood::skeleton_rules();
                        let other = tree.scene.open_view(tree.family, &rules).unwrap();
                        tree.scene.bounds(other).unwrap();
                        tree.scene.close_view(other).unwrap();
                    }
                    3 => tree.set(&with(&species, &[("leaves.scale", 0.5)])),
                    4 => tree.set(&with(&species, &[("level.1.curve", 10.0)])),
                    _ => {
                        tree.scene.edit(tree.tree, |tree| tree.seed = Seed::Explicit(6)).unwrap();
                        if chances.below(2) == 0 {
                            tree.scene.bounds(tree.view).unwrap();
                        }
                    }
                }
            }
            tree.set(&species);
            tree.scene.edit(tree.tree, |tree| tree.seed = Seed::Explicit(5)).unwrap();
            assert_eq!(digest(&tree.draw_list()), fresh, "{name}");
        }
        assert_eq!(tree.scene.fault(), None);
    }
}
