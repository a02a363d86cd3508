//! The same plans, events and errors on any number of threads.

use rayon::ThreadPoolBuilder;
use sapwood::geom::Digest;
use sapwood::rules::weber_penn::{LeafParams, LeavesSlot, Seed, Tree};
use sapwood::scene::{Budget, Event, Group, Scene, ViewError};

/// Whatever a run could differ in.
type Outcome = (String, Digest, Vec<Event>, Option<ViewError>);

/// Three trees compiled, then again with larger leaves, by so many threads and within a budget.
fn compiled(n_threads: usize, name: &str, budget: Budget) -> Outcome {
    let run = || {
        let species = sapwood::io::built_in(name).unwrap();
        let mut scene = Scene::new();
        scene.set_logging(true);
        scene.set_check_mode(true);
        let family = scene.add(species.attribute());
        let grove = scene.add_to(family, Group).unwrap();
        for seed in [1, 2, 1] {
            scene.add_to(grove, Tree { seed: Seed::Explicit(seed) }).unwrap();
        }
        let view = scene.open_view(family, &sapwood::standard_rules()).unwrap();
        scene.set_budget(view, budget).unwrap();
        let first = scene.bounds(view).err();
        let mut leaves = LeafParams::new(&species);
        leaves.scale *= 1.5;
        scene.push::<LeavesSlot>(family, leaves).unwrap();
        let error = first.or(scene.bounds(view).err());
        let list = scene.draw_list(view, 100_000);
        let mut meshes = sapwood::geom::Digester::new();
        for (place, row) in list.iter().flat_map(|list| list.placed_rows()) {
            meshes.add(&place).add(&row.mesh).add(&row.instances);
        }
        let events = scene.take_log();
        let dump = if error.is_none() { scene.dump(view, 10_000).unwrap() } else { String::new() };
        (dump, meshes.finish(), events, error)
    };
    ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap().install(run)
}

fn check(name: &str, budget: Budget) {
    let one = compiled(1, name, budget);
    assert!(one.2.len() > 10);
    for n_threads in [2, 5] {
        let several = compiled(n_threads, name, budget);
        assert!(one == several, "{name} differs on {n_threads} threads");
    }
}

#[test]
fn any_number_of_threads_makes_the_same_of_the_same() {
    for name in ["quaking_aspen", "lombardy_poplar", "palm"] {
        check(name, Budget::default());
    }
}

#[test]
fn a_budget_runs_out_at_the_same_component_on_any_number_of_threads() {
    for triangles in [1_000, 20_000, 60_000, 150_000] {
        check("quaking_aspen", Budget { triangles, ..Budget::default() });
    }
    for parts in [500, 5_000, 30_000] {
        check("quaking_aspen", Budget { parts, ..Budget::default() });
    }
}
