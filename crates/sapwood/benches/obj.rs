//! A large tree written as OBJ, beside a plain write of the very bytes to the same disk.
//!
//! Wall time, for the disk is what it is about; each pair of runs stands side by side, so that
//! what disturbs the one disturbs the other.

use std::fs;
use std::time::Instant;

use sapwood::rules::weber_penn::{Seed, Tree};
use sapwood::scene::Scene;

fn main() {
    // The folder is on the disk that the build is on; a temporary one may be in memory.
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    let species = sapwood::io::find_species("weeping_willow").expect("the willow is built in");
    let mut scene = Scene::new();
    let family = scene.add(species.attribute());
    scene.add_to(family, Tree { seed: Seed::Explicit(1) }).expect("the family is empty");
    let view = scene.open_view(family, &sapwood::standard_rules()).expect("the family is there");
    let list = scene.draw_list(view, usize::MAX).expect("a willow is within the budget");

    let (obj, plain) = (folder.join("willow.obj"), folder.join("plain.obj"));
    for run in 1..=5 {
        let start = Instant::now();
        sapwood::io::write_obj(&obj, &list).expect("the disk has room");
        let ours = start.elapsed().as_secs_f64();
        let bytes = fs::read(&obj).expect("the file was just written");
        let start = Instant::now();
        sapwood::io::write_atomically(&plain, |out| out.write_all(&bytes))
            .expect("the disk has room");
        let plainly = start.elapsed().as_secs_f64();
        let rate = |seconds: f64| bytes.len() as f64 / 1e6 / seconds;
        println!(
            "run {run}: {:.0} MB, {:.0} MB/s as OBJ, {:.0} MB/s plainly, {:.2} of its speed",
            bytes.len() as f64 / 1e6,
            rate(ours),
            rate(plainly),
            plainly / ours
        );
    }
    for path in [obj.with_extension("mtl"), obj, plain] {
        let _ = fs::remove_file(path);
    }
}
