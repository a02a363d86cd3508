//! The same picture on any number of threads, whatever was compiled before, taken again or not.

use std::ops::ControlFlow;

use sapwood::picture::{Ground, PictureOptions, Studio};
use sapwood::rules::weber_penn::{Seed, Tree};
use sapwood::scene::{Scene, ViewId};

use super::scenes::{camera, taken};

fn maple() -> (Scene, ViewId) {
    let species = sapwood::io::built_in("japanese_maple").unwrap();
    let mut scene = Scene::new();
    let family = scene.add(species.attribute());
    scene.add_to(family, Tree { seed: Seed::Explicit(4) }).unwrap();
    let view = scene.open_view(family, &sapwood::standard_rules()).unwrap();
    (scene, view)
}

fn options() -> PictureOptions {
    let ground = Some(Ground::default());
    PictureOptions { size: [90, 70], samples: 4, ground, ..PictureOptions::default() }
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let (mut scene, view) = maple();
    let camera = camera(&mut scene, view, options().size);
    let pictures: Vec<_> = [1, 2, 3, 8]
        .map(|n| {
            // A scene of its own, so that compiling is on that many threads too.
            let threads = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
            let (mut scene, view) = maple();
            threads.install(|| taken(&mut scene, view, &camera, &options()).image)
        })
        .into();
    assert!(pictures.iter().all(|picture| *picture == pictures[0]));
}

#[test]
fn what_was_compiled_before_changes_nothing() {
    let (mut warm, warm_view) = maple();
    let camera = camera(&mut warm, warm_view, options().size);
    let (mut cold, cold_view) = maple();
    let cold = taken(&mut cold, cold_view, &camera, &options());
    let warm = taken(&mut warm, warm_view, &camera, &options());
    assert!(warm.image == cold.image);
    assert_eq!(warm.rays.primary, 4 * 90 * 70);
    assert!(warm.rays.shadow > 0 && warm.rays.sky > 0);
}

#[test]
fn a_studio_takes_the_same_picture_again() {
    let (mut scene, view) = maple();
    let camera = camera(&mut scene, view, options().size);
    let mut supply = scene.supply(view).unwrap();
    let mut studio = Studio::new(&mut supply);
    let mut take = |options: &PictureOptions| {
        let mut heard = Vec::new();
        let picture = studio.picture(&camera, options, &mut |progress| {
            heard.push((progress.n_done, progress.n_pixels));
            ControlFlow::Continue(())
        });
        assert!(heard.is_sorted() && heard.len() > 1);
        assert_eq!(heard.last(), Some(&(90 * 70, 90 * 70)));
        picture.unwrap()
    };
    let first = take(&options());
    let second = take(&options());
    assert!(first.image == second.image);
    assert_eq!(second.n_filled, 0);
    let other = take(&PictureOptions { seed: 1, ..options() });
    assert!(other.image != first.image, "another seed, the same noise");
}
