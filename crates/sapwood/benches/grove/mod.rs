//! Groves: trees of one species in a scene, and what a second core does for them.

use std::time::{Duration, Instant};

use rayon::{ThreadPool, ThreadPoolBuilder};
use sapwood::rules::weber_penn::{Seed, Species, Tree};
use sapwood::scene::{Group, Scene, ViewId};

/// Distinct trees that two cores grow together.
const DISTINCT: u64 = 64;

/// How often.
const REPEATED: usize = 9;

pub(crate) fn pool(n_threads: usize) -> ThreadPool {
    ThreadPoolBuilder::new().num_threads(n_threads).build().expect("the system has threads")
}

pub(crate) fn species(name: &str) -> Species {
    sapwood::io::built_in(name).expect("the name is built in")
}

/// A scene with a tree of the species for each seed.
pub(crate) fn planted(species: &Species, seeds: impl Iterator<Item = u64>) -> (Scene, ViewId) {
    let mut scene = Scene::new();
    let family = scene.add(species.attribute());
    let grove = scene.add_to(family, Group).expect("the family is empty");
    for seed in seeds {
        scene.add_to(grove, Tree { seed: Seed::Explicit(seed) }).expect("a tree holds nothing");
    }
    let view = scene.open_view(family, &sapwood::standard_rules()).expect("the family is there");
    (scene, view)
}

pub(crate) fn bounds((mut scene, view): (Scene, ViewId)) -> Scene {
    scene.bounds(view).expect("the trees keep to the budget");
    scene
}

/// Distinct trees in one scene, with one thread and with two. Beside the ratio of wall times
/// stands that of the CPU times of the busier thread: what wall times would tell on cores that
/// nobody else uses, for the thread that asked does all that is not done side by side.
pub(crate) fn cores(name: &str) {
    let species = species(name);
    let (one, two) = (pool(1), pool(2));
    // The least wall time and CPU time of the busier thread, with one thread and with two.
    let mut best = [(Duration::MAX, Duration::MAX); 2];
    for _ in 0..REPEATED {
        for (pool, best) in [&one, &two].into_iter().zip(&mut best) {
            let trees = planted(&species, 1..=DISTINCT);
            let before = pool.broadcast(|_| of_thread());
            let start = Instant::now();
            let scene = pool.install(|| bounds(trees));
            let wall = start.elapsed();
            let spent = pool.broadcast(|_| of_thread()).into_iter().zip(before);
            let busiest = spent.map(|(after, before)| after - before).max().unwrap_or_default();
            drop(scene);
            *best = (best.0.min(wall), best.1.min(busiest));
        }
    }
    let [(wall_1, cpu_1), (wall_2, cpu_2)] = best;
    println!("{name}, {DISTINCT} distinct trees");
    let ratio = |one: Duration, two: Duration| one.as_secs_f64() / two.as_secs_f64();
    println!(
        "  wall time {wall_1:.3?}, with two threads {wall_2:.3?}: {:.2}",
        ratio(wall_1, wall_2)
    );
    println!("  busiest thread {cpu_1:.3?}, of two {cpu_2:.3?}: {:.2}", ratio(cpu_1, cpu_2));
}

/// The CPU time of the thread that asks; wall time where the system has no such clock.
fn of_thread() -> Duration {
    #[cfg(unix)]
    {
        use rustix::time::{ClockId, clock_gettime};
        let time = clock_gettime(ClockId::ThreadCPUTime);
        Duration::new(time.tv_sec.unsigned_abs(), time.tv_nsec as u32)
    }
    #[cfg(not(unix))]
    {
        static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
        START.get_or_init(Instant::now).elapsed()
    }
}
