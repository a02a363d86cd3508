//! A thousand picks: in a grown tree, and among a hundred thousand trivial leaves.

mod clock;
mod cpu_time;

use std::time::Duration;

use clock::Moment;
use cpu_time::CpuTime;
use criterion::{Criterion, SamplingMode};
use sapwood::geom::glam::Vec3;
use sapwood::geom::{Mesh, Purpose, Ray, Stream, StreamPath};
use sapwood::graph::{Material, PickOptions};
use sapwood::rules::weber_penn::{Seed, Tree};
use sapwood::scene::{Group, HeldGeometry, NodeId, Scene, Transform, ViewId};

const N_PICKS: usize = 1000;

fn main() {
    clock::one_thread();
    let mut criterion = Criterion::default()
        .with_measurement(CpuTime)
        .configure_from_args()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2));
    bench(&mut criterion, "black_tupelo", tupelo);
    bench(&mut criterion, "many_leaves", many_leaves);
    criterion.final_summary();
}

fn tupelo() -> (Scene, ViewId) {
    let species = sapwood::io::built_in("black_tupelo").expect("the name is built in");
    let mut scene = Scene::new();
    let family = scene.add(species.attribute());
    scene.add_to(family, Tree { seed: Seed::Explicit(1) }).expect("the family is empty");
    let view = scene.open_view(family, &sapwood::standard_rules()).expect("the family is there");
    (scene, view)
}

/// Each leaf a transform over one of 16 shared triangles, a metre from the next, in groups of
/// ten.
fn many_leaves() -> (Scene, ViewId) {
    let n = 100_000;
    let mut scene = Scene::new();
    let root = scene.add(Group);
    let mut groups: Vec<NodeId> = vec![root.id()];
    while groups.len() * 10 < n {
        let above: Vec<NodeId> = groups.iter().flat_map(|group| [*group; 10]).collect();
        let below = above.iter().map(|group| scene.add_to(*group, Group).expect("no cycle").id());
        groups = below.collect();
    }
    let geometries: Vec<_> = (0..16)
        .map(|i| {
            let size = 0.5 + 0.01 * i as f32;
            let mesh = Mesh {
                positions: vec![Vec3::ZERO, Vec3::X * size, Vec3::Z * size],
                normals: vec![Vec3::NEG_Y; 3],
                uvs: vec![Default::default(); 3],
                indices: vec![0, 1, 2],
            };
            scene.add(HeldGeometry::new(mesh, Material::matte("leaf", 0.1, 0.3, 0.05)))
        })
        .collect();
    for i in 0..n {
        let (x, z) = ((i % 1000) as f32, (i / 1000) as f32);
        let place = Transform::translation(x, 0.0, z);
        let place = scene.add_to(groups[i / 10], place).expect("no cycle");
        scene.append(place, geometries[i % 16]).expect("no cycle");
    }
    let view = scene.open_view(root, &sapwood::standard_rules()).expect("the root is there");
    (scene, view)
}

/// Rays from all around toward points in the bound.
fn rays(scene: &mut Scene, view: ViewId) -> Vec<Ray> {
    let bound = scene.bounds(view).expect("the scene keeps to the budget");
    let mut stream = Stream::new(StreamPath::new(1), Purpose("rays"));
    let mut vector = |low, high| Vec3::from_array([(); 3].map(|()| stream.between(low, high)));
    let ray = |_| {
        let to = bound.aabb.min + bound.aabb.size() * vector(0.0, 1.0);
        let from = bound.sphere.center + vector(-1.0, 1.0).normalize() * 2.0 * bound.sphere.radius;
        Ray::new(from, to - from)
    };
    (0..N_PICKS).map(ray).collect()
}

fn pick(scene: &mut Scene, view: ViewId, rays: &[Ray]) -> usize {
    let options = PickOptions::default();
    let mut hit = |ray| scene.pick(view, ray, &options).expect("the scene keeps to the budget");
    rays.iter().filter(|ray| hit(ray).is_some()).count()
}

fn bench(criterion: &mut Criterion<CpuTime>, name: &str, build: fn() -> (Scene, ViewId)) {
    let mut group = criterion.benchmark_group(name);
    group.sampling_mode(SamplingMode::Flat);
    let (mut scene, view) = build();
    let rays = rays(&mut scene, view);
    println!("{name}: {} of {N_PICKS} rays meet something", pick(&mut scene, view, &rays));
    group.bench_function("picks", |bencher| bencher.iter(|| pick(&mut scene, view, &rays)));
    // Everything compiled, but no tree over triangles made yet.
    group.bench_function("first_picks", |bencher| {
        bencher.iter_custom(|n| {
            (0..n).fold(Duration::ZERO, |sum, _| {
                let (mut scene, view) = build();
                scene.bounds(view).expect("the scene keeps to the budget");
                let start = Moment::now();
                pick(&mut scene, view, &rays);
                sum + start.elapsed()
            })
        });
    });
    // Nothing compiled: one ray.
    group.bench_function("one_cold_pick", |bencher| {
        bencher.iter_custom(|n| {
            (0..n).fold(Duration::ZERO, |sum, _| {
                let (mut scene, view) = build();
                let start = Moment::now();
                pick(&mut scene, view, &rays[..1]);
                sum + start.elapsed()
            })
        });
    });
}
