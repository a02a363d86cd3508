//! The same plans, events and errors on any number of threads, in many batches.

use sapwood::scene::{Attribute, Budget, Group};

use super::ingredients::{Cloth, dyed_by};
use super::kinds::*;

#[test]
fn many_askers_make_the_same_on_any_number_of_threads() {
    // Many batches; sizes are pushed below, the last fails, and dye is shown as well as asked for.
    let outcome = |n_threads: usize, budget: Budget| {
        let run = || {
            let mut scene = checked_scene();
            let root = scene.add(Group);
            let mut attributes = Vec::new();
            // The same cloth below every attribute, before others that ask for the same dye.
            let shared = scene.add(Group);
            for n in 0..40 {
                scene.add_to(shared, Cloth { n, shows_dye: n % 3 == 0 }).unwrap();
            }
            for size in 0..12 {
                let attribute = Attribute::new().with::<Size>(size as f32 * 8.5);
                attributes.push(scene.add_to(root, attribute).unwrap());
                let group = scene.add_to(attributes[size], Group).unwrap();
                scene.append(group, shared).unwrap();
                for i in 0..150 {
                    let n = (size as u32 * 7 + i * i) % 40;
                    scene.add_to(group, Cloth { n, shows_dye: i % 5 == 0 }).unwrap();
                }
            }
            let view = scene.open_view(root, &dyed_by(1.0)).unwrap();
            scene.set_budget(view, budget).unwrap();
            let error = scene.bounds(view).err();
            scene.push::<Size>(attributes[3], 28.0).unwrap();
            let again = scene.bounds(view).map_err(|error| error.to_string());
            let dump =
                if error.is_none() { scene.dump(view, 10_000).unwrap() } else { String::new() };
            (error, again, dump, scene.take_log())
        };
        rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap().install(run)
    };
    for triangles in [u64::MAX, 700, 90] {
        let budget = Budget { triangles, ..Budget::default() };
        let one = outcome(1, budget);
        assert_eq!(one.0.is_some(), triangles < u64::MAX, "{:?}", one.0);
        for n_threads in [2, 5] {
            assert!(
                one == outcome(n_threads, budget),
                "{n_threads} threads, {triangles} triangles"
            );
        }
    }
}
