//! A thousand aspens of 16 individuals that sway, seen from 20 m: one picture of sixty a second.

mod clock;
mod cpu_time;

use std::time::Duration;

use clock::Moment;
use cpu_time::CpuTime;
use criterion::Criterion;
use sapwood::geom::glam::Vec3;
use sapwood::graph::{Eye, Poses, Wind};
use sapwood::rules::weber_penn::{Seed, Tree};
use sapwood::scene::{Group, Scene, Time, Transform, ViewId, Viewer, WindSlot};

const N_TREES: u16 = 1000;
const N_INDIVIDUALS: u64 = 16;

fn main() {
    clock::one_thread();
    let mut criterion = Criterion::default()
        .with_measurement(CpuTime)
        .configure_from_args()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(3));
    sway(&mut criterion);
    criterion.final_summary();
}

/// Aspens in a square whose front is 20 m away.
fn forest() -> Result<(Scene, ViewId), Box<dyn std::error::Error>> {
    let mut scene = Scene::new();
    let family = scene.add(sapwood::io::find_species("quaking_aspen")?.attribute());
    let all = scene.add_to(family, Group)?;
    let trees: Vec<_> =
        (0..N_INDIVIDUALS).map(|seed| scene.add(Tree { seed: Seed::Explicit(seed) })).collect();
    for i in 0..N_TREES {
        let (row, column) = (f32::from(i / 32), f32::from(i % 32));
        let place = Transform::translation(6.0 * (column - 16.0), 0.0, -20.0 - 6.0 * row);
        let place = scene.add_to(all, place)?;
        scene.append(place, trees[usize::from(i) % trees.len()])?;
    }
    let view = scene.open_view(family, &sapwood::swaying_rules())?;
    scene.set_moving::<Viewer>(view, Some(Eye::new(Vec3::Y * 1.7)))?;
    Ok((scene, view))
}

fn sway(criterion: &mut Criterion<CpuTime>) {
    let (mut scene, view) = forest().expect("the species is built in");
    let list = scene.draw_list(view, 1_000_000).expect("the view is open");
    let start = Moment::now();
    let mut poses = Poses::new(&list);
    println!("the first picture's excursions: {:?}", start.elapsed());
    let mut group = criterion.benchmark_group("wind");
    for wind in [Wind::new(0.2, 0.1), Wind::new(1.0, 0.5), Wind::new(5.0, 2.0)] {
        scene.set_moving::<WindSlot>(view, wind).expect("the view is open");
        let moved = scene.sway(view, &mut poses).expect("the view is open");
        println!("{wind:?}: {} joints of {} trees", moved.n_joints, moved.n_occurrences);
        let mut time = 0.0;
        group.bench_function(format!("a picture at {} m/s", wind.speed), |bencher| {
            bencher.iter(|| {
                time += 1.0 / 60.0;
                scene.set_moving::<Time>(view, time).expect("the view is open");
                scene.sway(view, &mut poses).expect("the view is open")
            });
        });
    }
    group.finish();
}
