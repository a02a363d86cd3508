//! Built-in species: from a new scene to bounds, and after an edit of the leaves.

mod clock;
mod cpu_time;

use std::time::Duration;

use clock::Moment;
use cpu_time::CpuTime;
use criterion::{Criterion, SamplingMode};
use sapwood::rules::weber_penn::{LeafParams, LeavesSlot, Seed, Species, Tree};
use sapwood::scene::{Attribute, Handle, RuleSet, Scene, ViewId};

fn main() {
    clock::one_thread();
    let mut criterion = Criterion::default()
        .with_measurement(CpuTime)
        .configure_from_args()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    cold(&mut criterion);
    leaf_edit(&mut criterion);
    criterion.final_summary();
}

fn planted(species: &Species, rules: &RuleSet) -> (Scene, Handle<Attribute>, ViewId) {
    let mut scene = Scene::new();
    let family = scene.add(species.attribute());
    scene.add_to(family, Tree { seed: Seed::Explicit(1) }).expect("the family is empty");
    let view = scene.open_view(family, rules).expect("the family is there");
    (scene, family, view)
}

/// New scene, new cache; taking them down again is not counted.
fn cold(criterion: &mut Criterion<CpuTime>) {
    let mut group = criterion.benchmark_group("cold");
    group.sampling_mode(SamplingMode::Flat);
    for name in sapwood::io::built_in_names() {
        let species = sapwood::io::built_in(name).expect("the name comes from the list");
        let rules = sapwood::standard_rules();
        group.bench_function(name, |bencher| {
            bencher.iter_custom(|n| {
                (0..n).fold(Duration::ZERO, |sum, _| {
                    let start = Moment::now();
                    let (mut scene, _, view) = planted(&species, &rules);
                    scene.bounds(view).expect("species keep to the budget");
                    sum + start.elapsed()
                })
            });
        });
    }
}

/// Another size of leaf each time, so that nothing is found in the cache.
fn leaf_edit(criterion: &mut Criterion<CpuTime>) {
    let mut group = criterion.benchmark_group("leaf_edit");
    group.sampling_mode(SamplingMode::Flat);
    for name in ["quaking_aspen", "black_tupelo"] {
        let species = sapwood::io::built_in(name).expect("the name is built in");
        let (mut scene, family, view) = planted(&species, &sapwood::standard_rules());
        scene.bounds(view).expect("species keep to the budget");
        let mut leaves = LeafParams::new(&species);
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                leaves.scale *= 1.0001;
                scene.push::<LeavesSlot>(family, leaves.clone()).expect("the family is there");
                scene.bounds(view).expect("species keep to the budget")
            });
        });
    }
}
