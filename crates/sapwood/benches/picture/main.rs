//! Pictures of the black tupelo: rays per second, hierarchies, a whole picture; and the same
//! mesh drawn by POV-Ray, where that is installed.
//!
//! CPU time of all threads together, and time by the clock on the wall, which lies where others
//! use the machine as well.

mod pov_ray;

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use sapwood::geom::{MeshBvh, SharedMesh};
use sapwood::graph::{DrawList, Lens};
use sapwood::picture::{Background, Picture, PictureOptions, PlacedCamera, RayCounts, Studio};
use sapwood::rules::weber_penn::{Seed, Tree};
use sapwood::scene::{Scene, ViewId};

const SIZE: u32 = 1024;

/// As much as POV-Ray is asked for too.
const SAMPLES: u32 = 4;

fn main() {
    let (mut scene, view) = tupelo();
    let bounds = scene.bounds(view).expect("the species keeps to the budget").aabb;
    let lens = Lens::Perspective { vertical_angle: 0.5 };
    let from = PlacedCamera::THREE_QUARTER;
    let camera = PlacedCamera::fit(&bounds, from, lens, [SIZE; 2], PlacedCamera::MARGIN)
        .expect("the tree has an extent");
    let list = scene.draw_list(view, usize::MAX).expect("there is no limit");
    hierarchies(&list);

    println!("\n{SIZE} x {SIZE}, {SAMPLES} samples; rays per second of CPU time");
    for n_threads in [1, 2] {
        println!("{n_threads} threads");
        let threads = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
        let threads = threads.build().expect("there are threads");
        threads.install(|| rays(&mut scene, view, &camera));
    }
    pov_ray::compare(&list, &camera, SIZE);
}

/// What rays of each sort take.
fn rays(scene: &mut Scene, view: ViewId, camera: &PlacedCamera) {
    let everything = options();
    let mut no_sky = everything.clone();
    no_sky.sky.occlusion_distance = 0.0;
    let mut no_light = no_sky.clone();
    no_light.sun = None;
    let mut supply = scene.supply(view).expect("the view is open");
    let mut studio = Studio::new(&mut supply);
    let mut take = |options: &PictureOptions| timed(|| taken(&mut studio, camera, options));
    let (found, _) = take(&PictureOptions { size: [16; 2], samples: 1, ..no_light.clone() });
    println!("  finding what is there  {found}");
    let rate = |n: u64, cpu: Duration| n as f64 / 1e6 / cpu.as_secs_f64();
    let (dark, primary) = take(&no_light);
    let first = rate(primary.rays.primary, dark.cpu);
    println!("  primary rays alone     {dark}, {first:.2} million a second");
    let (sunny, shadowed) = take(&no_sky);
    let shadow = rate(shadowed.rays.shadow, sunny.cpu.saturating_sub(dark.cpu));
    println!("  with shadows           {sunny}, {shadow:.2} million shadow rays a second");
    let (whole, picture) = take(&everything);
    let RayCounts { primary, shadow, sky, reflected } = picture.rays;
    let all = rate(primary + shadow + sky + reflected, whole.cpu);
    println!("  and sky                {whole}, {all:.2} million rays a second");
    println!("  {:?}", picture.rays);
}

fn tupelo() -> (Scene, ViewId) {
    let species = sapwood::io::built_in("black_tupelo").expect("the name is built in");
    let mut scene = Scene::new();
    let family = scene.add(species.attribute());
    scene.add_to(family, Tree { seed: Seed::Explicit(1) }).expect("the family is empty");
    let view = scene.open_view(family, &sapwood::standard_rules()).expect("the family is there");
    (scene, view)
}

fn options() -> PictureOptions {
    PictureOptions {
        size: [SIZE; 2],
        samples: SAMPLES,
        background: Background::Color([0.8; 3]),
        ..PictureOptions::default()
    }
}

fn taken(studio: &mut Studio<'_>, camera: &PlacedCamera, options: &PictureOptions) -> Picture {
    let picture = studio.picture(camera, options, &mut |_| ControlFlow::Continue(()));
    picture.expect("nothing stops it")
}

/// How long the trees over the triangles of all meshes take.
fn hierarchies(list: &DrawList) {
    let meshes: Vec<&SharedMesh> =
        list.bodies.iter().flat_map(|b| &b.rows).map(|r| &r.mesh).collect();
    let n: usize = meshes.iter().map(|mesh| mesh.n_triangles()).sum();
    let (time, _) = timed(|| {
        meshes.iter().for_each(|mesh| drop(std::hint::black_box(MeshBvh::new(mesh))));
    });
    let per_million = time.cpu.as_secs_f64() * 1e6 / n as f64;
    println!(
        "hierarchies of {} meshes, {n} triangles: {time}, {per_million:.2} s a million",
        meshes.len()
    );
    let largest =
        meshes.into_iter().max_by_key(|mesh| mesh.n_triangles()).expect("a tree has meshes");
    let (time, _) = timed(|| std::hint::black_box(MeshBvh::new(largest)));
    let n = largest.n_triangles();
    let per_million = time.cpu.as_secs_f64() * 1e6 / n as f64;
    println!("hierarchy of the largest, {n} triangles: {time}, {per_million:.2} s a million");
}

/// How long something took.
#[derive(Clone, Copy)]
struct Time {
    cpu: Duration,
    wall: Duration,
}

impl std::fmt::Display for Time {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:6.3} s CPU {:6.3} s wall", self.cpu.as_secs_f64(), self.wall.as_secs_f64())
    }
}

fn timed<R>(work: impl FnOnce() -> R) -> (Time, R) {
    let (wall, cpu) = (Instant::now(), cpu());
    let result = work();
    (Time { cpu: self::cpu() - cpu, wall: wall.elapsed() }, result)
}

/// The CPU time of all threads of this process; wall time where the system does not tell.
#[cfg(unix)]
fn cpu() -> Duration {
    use rustix::time::{ClockId, clock_gettime};
    let time = clock_gettime(ClockId::ProcessCPUTime);
    Duration::new(time.tv_sec.unsigned_abs(), time.tv_nsec as u32)
}

#[cfg(not(unix))]
fn cpu() -> Duration {
    static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    START.get_or_init(Instant::now).elapsed()
}
