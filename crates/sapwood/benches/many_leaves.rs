//! A hundred thousand trivial leaves: each a transform over one of 16 shared geometries, in
//! groups of ten.

mod clock;
mod cpu_time;

use std::time::Duration;

use clock::Moment;
use cpu_time::CpuTime;
use criterion::{Criterion, SamplingMode};
use sapwood::geom::Mesh;
use sapwood::geom::glam::Vec3;
use sapwood::graph::Material;
use sapwood::scene::{EditError, Group, Handle, HeldGeometry, NodeId, Scene, Transform, ViewId};

const N: usize = 100_000;
const N_GEOMETRIES: usize = 16;
const GROUP: usize = 10;

fn main() {
    clock::one_thread();
    let mut criterion = Criterion::default()
        .with_measurement(CpuTime)
        .configure_from_args()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(3));
    whole(&mut criterion);
    edits(&mut criterion);
    criterion.final_summary();
}

struct Forest {
    scene: Scene,
    view: ViewId,
    leaves: Vec<Handle<Transform>>,
    n_edits: usize,
}

fn triangle(size: f32) -> Mesh {
    Mesh {
        positions: vec![Vec3::ZERO, Vec3::X * size, Vec3::Y * size],
        normals: vec![Vec3::Z; 3],
        uvs: vec![Default::default(); 3],
        indices: vec![0, 1, 2],
    }
}

impl Forest {
    fn new() -> Result<Self, EditError> {
        let mut scene = Scene::new();
        let root = scene.add(Group);
        let mut groups: Vec<NodeId> = vec![root.id()];
        while groups.len() * GROUP < N {
            let mut below = Vec::with_capacity(groups.len() * GROUP);
            for group in groups {
                for _ in 0..GROUP {
                    below.push(scene.add_to(group, Group)?.id());
                }
            }
            groups = below;
        }
        let geometries: Vec<_> = (0..N_GEOMETRIES)
            .map(|i| {
                let mesh = triangle(0.1 + 0.01 * i as f32);
                scene.add(HeldGeometry::new(mesh, Material::matte("leaf", 0.1, 0.3, 0.05)))
            })
            .collect();
        let mut leaves = Vec::with_capacity(N);
        for i in 0..N {
            let (x, z) = ((i % 1000) as f32, (i / 1000) as f32);
            let leaf = scene.add_to(groups[i / GROUP], Transform::translation(x, 0.0, z))?;
            scene.append(leaf, geometries[i % N_GEOMETRIES])?;
            leaves.push(leaf);
        }
        let view = scene.open_view(root, &sapwood::standard_rules())?;
        Ok(Self { scene, view, leaves, n_edits: 0 })
    }

    fn built() -> Self {
        Self::new().expect("the graph has no cycle")
    }

    fn bounds(&mut self) {
        self.scene.bounds(self.view).expect("triangles keep to the budget");
    }

    /// Moves one leaf, another one each time.
    fn edit(&mut self) {
        self.n_edits += 1;
        let leaf = self.leaves[self.n_edits * 7919 % N];
        let moved = |leaf: &mut Transform| leaf.0.translation.y += 1.0;
        self.scene.edit(leaf, moved).expect("no leaf was removed");
    }
}

/// Sums up what `each` measures.
fn sum(n: u64, each: impl Fn() -> Duration) -> Duration {
    (0..n).fold(Duration::ZERO, |sum, _| sum + each())
}

fn whole(criterion: &mut Criterion<CpuTime>) {
    let mut group = criterion.benchmark_group("many_leaves");
    group.sampling_mode(SamplingMode::Flat).sample_size(10);
    group.bench_function("build", |bencher| {
        bencher.iter_custom(|n| {
            sum(n, || {
                let start = Moment::now();
                let forest = Forest::built();
                let elapsed = start.elapsed();
                drop(forest);
                elapsed
            })
        });
    });
    group.bench_function("compile", |bencher| {
        bencher.iter_custom(|n| {
            sum(n, || {
                let mut forest = Forest::built();
                let start = Moment::now();
                forest.bounds();
                start.elapsed()
            })
        });
    });
    group.bench_function("count_first", |bencher| {
        bencher.iter_custom(|n| {
            sum(n, || {
                let mut forest = Forest::built();
                forest.bounds();
                let start = Moment::now();
                forest.scene.count(forest.view).expect("triangles keep to the budget");
                start.elapsed()
            })
        });
    });
    group.bench_function("take_down", |bencher| {
        bencher.iter_custom(|n| {
            sum(n, || {
                let mut forest = Forest::built();
                forest.bounds();
                let start = Moment::now();
                drop(forest);
                start.elapsed()
            })
        });
    });
}

fn edits(criterion: &mut Criterion<CpuTime>) {
    let mut forest = Forest::built();
    forest.bounds();
    let mut group = criterion.benchmark_group("many_leaves");
    group.bench_function("nothing_changed", |bencher| bencher.iter(|| forest.bounds()));
    group.bench_function("edit_bounds", |bencher| {
        bencher.iter(|| {
            forest.edit();
            forest.bounds();
        });
    });
    let count = |forest: &mut Forest| {
        forest.scene.count(forest.view).expect("triangles keep to the budget");
    };
    count(&mut forest);
    group.bench_function("edit_count", |bencher| {
        bencher.iter(|| {
            forest.edit();
            count(&mut forest);
        });
    });
    group.sampling_mode(SamplingMode::Flat).sample_size(10);
    group.bench_function("draw_list", |bencher| {
        bencher.iter(|| forest.scene.draw_list(forest.view, 2 * N).expect("each leaf is one row"));
    });
}
