//! Trees that fade with the distance: by the walk, and by levels of detail that are compiled.

use sapwood::geom::Mesh;
use sapwood::geom::glam::Vec3;
use sapwood::graph::{DrawList, Eye, Poses, Wind};
use sapwood::rules::weber_penn::{FadingParams, FadingSlot, Seed, Tree, faded};
use sapwood::scene::{
    Action, Attribute, Group, LevelOfDetail, Scene, Time, Transform, ViewId, Viewer, Viewpoint,
    WindSlot,
};

use super::trees::*;

const RANGES: [f32; 7] = [5.0, 30.0, 60.0, 120.0, 240.0, 600.0, 1200.0];

fn look_from(scene: &mut Scene, view: ViewId, range: f32) -> DrawList {
    scene.set_moving::<Viewer>(view, Some(Eye::new(Vec3::X * range))).unwrap();
    scene.draw_list(view, 1_000_000).unwrap()
}

/// What is drawn: triangles of stems, lines, leaves as polygons, leaves as points.
fn drawn(list: &DrawList) -> [u64; 4] {
    let mut drawn = [0; 4];
    for (_, row) in list.placed_rows() {
        let sort = match (&row.instances, row.mesh.n_triangles()) {
            (None, _) => 0,
            (Some(_), 1) => 3,
            (Some(_), _) => 2,
        };
        drawn[sort] += if sort == 0 { row.n_triangles() } else { row.n_copies() as u64 };
    }
    drawn[1] = list.placed_lines().map(|(_, row)| row.drawn().len() as u64).sum();
    drawn
}

#[test]
fn a_fading_tree_grows_no_stem_again_and_loses_its_parts_without_compiling() {
    let mut aspen = grown(&built_in("quaking_aspen"), 1);
    let full = drawn(&aspen.draw_list());
    let view = aspen.scene.open_view(aspen.family, &sapwood::fading_rules()).unwrap();
    assert_eq!(compiled(&mut aspen.scene, view), [("leaf_surface", 50), ("stem_surface", 101)]);
    let list = aspen.scene.draw_list(view, 1_000_000).unwrap();
    assert_eq!((drawn(&list), full[1], full[3]), (full, 0, 0), "from nearby");

    let counts: Vec<_> =
        RANGES.iter().map(|range| drawn(&look_from(&mut aspen.scene, view, *range))).collect();
    assert_eq!(counts[0], full);
    let shares = |column: usize, of: u64| -> Vec<f64> {
        counts.iter().map(|row| (row[column] as f64 / of as f64 * 100.0).round() / 100.0).collect()
    };
    let leaves = full[2];
    // 4/3 - r / 150 from 50 m on, and none from 200 m on.
    assert_eq!(shares(2, leaves), [1.0, 1.0, 0.93, 0.53, 0.0, 0.0, 0.0]);
    // Points stand for what is no polygon; in the end for one leaf of each mass, of which each
    // batch has one that may be small.
    let both: Vec<u64> = counts.iter().map(|row| row[2] + row[3]).collect();
    assert!(both[..4].iter().all(|n| *n == leaves), "{both:?}");
    assert!((0.89..0.91).contains(&(both[4] as f64 / leaves as f64)), "{both:?}");
    assert!((leaves.div_ceil(4)..leaves.div_ceil(4) + 50).contains(&both[5]), "{both:?}");
    assert_eq!(both[5], both[6]);
    assert!(counts.windows(2).all(|rows| rows[1][0] <= rows[0][0]), "{counts:?}");
    assert_eq!((counts[6][0], counts[6][1] > 0), (0, true), "the trunk is lines: {counts:?}");
    assert_eq!(compiled(&mut aspen.scene, view), []);
    let report = aspen.scene.verify(view, 10).unwrap();
    assert!(report.is_clean(), "{report:?}");
}

#[test]
fn levels_of_detail_compile_what_is_left_and_follow_with_hysteresis() {
    let mut scene = checked_scene();
    let family = scene.add(built_in("quaking_aspen").attribute());
    let levels = LevelOfDetail { hysteresis: 0.1, ..LevelOfDetail::new([40.0, 150.0]) };
    let levels = scene.add_to(family, levels).unwrap();
    let tree = scene.add(Tree { seed: Seed::Explicit(1) });
    let ranges = [5.0, 60.0, 240.0];
    for range in ranges {
        let params = FadingParams { fixed_range: Some(range), ..FadingParams::default() };
        let level = scene.add_to(levels, Attribute::new().with::<FadingSlot>(params)).unwrap();
        scene.append(level, tree).unwrap();
    }
    let view = scene.open_view(family, &sapwood::fading_rules()).unwrap();
    let mut look_from = |range: f32| {
        scene.set_held::<Viewpoint>(view, Some(Vec3::X * range)).unwrap();
        let list = scene.draw_list(view, 1_000_000).unwrap();
        (drawn(&list), compiled(&mut scene, view))
    };
    let (near, _) = look_from(10.0);
    let geometry =
        [("attribute", 1), ("leaf_surface", 50), ("level_of_detail", 1), ("stem_surface", 101)];
    let (middle, ran) = look_from(60.0);
    assert_eq!(ran, geometry);
    assert_eq!(look_from(38.0), (middle, vec![]), "within a tenth of 40 m");
    assert_eq!(look_from(35.0).0, near);
    assert_eq!(look_from(60.0), (middle, vec![]), "the plans of this level are still there");
    let (far, ran) = look_from(200.0);
    assert_eq!(ran, geometry);
    assert!(near[0] > middle[0] && middle[0] > far[0] && far[0] > 0, "{near:?} {middle:?} {far:?}");

    // What is compiled for a range is what the walk leaves there.
    let moving = grown(&built_in("quaking_aspen"), 1);
    let (mut scene, family) = (moving.scene, moving.family);
    let view = scene.open_view(family, &sapwood::fading_rules()).unwrap();
    for (range, left) in ranges.into_iter().zip([near, middle, far]) {
        scene.set_moving::<Viewer>(view, Some(Eye::new(Vec3::X * range))).unwrap();
        assert_eq!(drawn(&scene.draw_list(view, 1_000_000).unwrap()), left, "{range} m");
    }
}

#[test]
fn a_traversal_thins_trees_that_know_nothing_of_it() {
    let mut aspen = grown(&built_in("quaking_aspen"), 1);
    let full = drawn(&aspen.draw_list());
    let fading = aspen.scene.open_view(aspen.family, &sapwood::fading_rules()).unwrap();
    compiled(&mut aspen.scene, fading);
    let params = FadingParams::default();
    for range in RANGES {
        let eye = Eye::new(Vec3::X * range);
        let emitted = faded(&mut aspen.scene, aspen.view, &params, Some(&eye), 10_000).unwrap();
        let walked = drawn(&look_from(&mut aspen.scene, fading, range));
        // Both leave the same leaves; stems are cut into other items.
        let emitted = drawn(&emitted);
        assert_eq!(emitted[2..], walked[2..], "{range} m");
        let (by, of) = (emitted[0].abs_diff(walked[0]), full[0]);
        assert!(by * 20 <= of, "{range} m: {emitted:?} {walked:?}");
        // Under rules that have trees fade it leaves alone what does.
        aspen.scene.set_moving::<Viewer>(fading, None).unwrap();
        let both = faded(&mut aspen.scene, fading, &params, Some(&eye), 10_000).unwrap();
        assert_eq!(drawn(&both), walked, "{range} m");
    }
    assert_eq!(aspen.compiled(), []);
    assert_eq!(drawn(&aspen.draw_list()), full, "what it was made of stays");
}

/// A tree with levels of detail beside one without, seen by one traversal.
#[test]
fn both_ways_to_fade_serve_one_scene() {
    let mut scene = checked_scene();
    let family = scene.add(built_in("quaking_aspen").attribute());
    let row = scene.add_to(family, Group).unwrap();
    let tree = scene.add(Tree { seed: Seed::Explicit(1) });
    let levels = scene.add_to(row, LevelOfDetail::new([40.0])).unwrap();
    for range in [5.0, 60.0] {
        let params = FadingParams { fixed_range: Some(range), ..FadingParams::default() };
        let level = scene.add_to(levels, Attribute::new().with::<FadingSlot>(params)).unwrap();
        scene.append(level, tree).unwrap();
    }
    let beside = scene.add_to(row, Transform::translation(0.0, 0.0, 20.0)).unwrap();
    scene.append(beside, tree).unwrap();
    let view = scene.open_view(family, &sapwood::fading_rules()).unwrap();
    scene.set_held::<Viewpoint>(view, Some(Vec3::X * 60.0)).unwrap();
    let eye = Eye::new(Vec3::new(120.0, 0.0, 20.0));
    let list = faded(&mut scene, view, &FadingParams::default(), Some(&eye), 10_000).unwrap();
    let few = faded(&mut scene, view, &FadingParams::default(), Some(&eye), 20).unwrap_err();
    let told = "more than 20 rows would be drawn; leaf_surface occurs too often";
    assert_eq!(few.to_string(), told);
    let at = |range: f32| {
        let mut aspen = grown(&built_in("quaking_aspen"), 1);
        let view = aspen.scene.open_view(aspen.family, &sapwood::fading_rules()).unwrap();
        drawn(&look_from(&mut aspen.scene, view, range))
    };
    let (by_level, by_walk) = (at(60.0), at(120.0));
    let expected: Vec<u64> = by_level.iter().zip(by_walk).map(|(a, b)| a + b).collect();
    assert_eq!(drawn(&list)[..], expected[..]);
}

/// Trees that sway and trees that fade, by one set of rules: what is left sways, and neither the
/// eye nor the time has anything compiled.
#[test]
fn what_fades_sways_as_far_as_it_is_left() {
    let mut aspen = grown(&built_in("quaking_aspen"), 1);
    let rules = sapwood::rules::weber_penn::swaying().over(&sapwood::fading_rules());
    let scene = &mut aspen.scene;
    let both = scene.open_view(aspen.family, &rules).unwrap();
    let fading = scene.open_view(aspen.family, &sapwood::fading_rules()).unwrap();
    let swaying = scene.open_view(aspen.family, &sapwood::swaying_rules()).unwrap();
    for view in [both, fading, swaying] {
        scene.bounds(view).unwrap();
        scene.set_moving::<WindSlot>(view, Wind::new(6.0, 3.0)).unwrap();
    }
    scene.take_log();
    for range in RANGES {
        let list = look_from(scene, both, range);
        // As much is left as without wind, at the same places.
        let still = look_from(scene, fading, range);
        assert_eq!(drawn(&list), drawn(&still), "{range} m");
        let rows = || list.placed_rows().zip(still.placed_rows());
        assert!(rows().all(|((_, a), (_, b))| a.range == b.range), "{range} m");
        assert!(rows().all(|((_, a), (_, b))| Mesh::clone(&a.mesh) == Mesh::clone(&b.mesh)));
        assert!(list.placed_rows().all(|(_, row)| row.follows.is_some()), "{range} m");
        // It moves as the whole tree does.
        let whole = scene.draw_list(swaying, 10_000).unwrap();
        let (mut poses, mut of_whole) = (Poses::new(&list), Poses::new(&whole));
        for time in [0.0, 1.5] {
            for view in [both, swaying] {
                scene.set_moving::<Time>(view, time).unwrap();
            }
            scene.set_moving::<Viewer>(swaying, Some(Eye::new(Vec3::X * range))).unwrap();
            let moved = scene.sway(both, &mut poses).unwrap();
            assert_eq!(moved, scene.sway(swaying, &mut of_whole).unwrap(), "{range} m, {time} s");
            assert_eq!(drawn(&poses.posed(&list)), drawn(&still), "{range} m, {time} s");
        }
    }
    let log = scene.take_log();
    let ran: Vec<_> = log.iter().filter(|event| event.action == Action::Compiled).collect();
    assert!(ran.is_empty(), "{ran:?}");
    let report = scene.verify(both, 10).unwrap();
    assert!(report.is_clean(), "{report:?}");
}

/// From so far that its trunk is lines, an aspen is as bright as from where it is a tube.
#[test]
fn lines_that_stand_for_stems_have_the_colour_of_bark() {
    use sapwood::graph::Lens;
    use sapwood::picture::{Background, PictureOptions, PlacedCamera, Studio};
    let bare = with(&built_in("quaking_aspen"), &[("leaves.count", 0.0)]);
    let species = sapwood::rules::weber_penn::Species { levels: 1, ..bare };
    let mut scene = checked_scene();
    let family = scene.add(species.attribute());
    scene.add_to(family, Tree { seed: Seed::Explicit(1) }).unwrap();
    let view = scene.open_view(family, &sapwood::fading_rules()).unwrap();
    let foot = Vec3::Y * 2.0;
    let lens = Lens::Orthographic { height: 3.0 };
    let camera = PlacedCamera::look_at(lens, foot + Vec3::new(-0.3, 0.0, 1.0) * 40.0, foot);
    let options = PictureOptions {
        size: [96, 96],
        samples: 16,
        background: Background::Transparent,
        line_color: [0.0, 0.0, 5.0],
        ..PictureOptions::default()
    };
    let mut color = |range: f32| {
        let list = look_from(&mut scene, view, range);
        let (n_triangles, n_lines) = (drawn(&list)[0], drawn(&list)[1]);
        assert!(list.placed_lines().all(|(_, row)| row.material.is_some()));
        let mut supply = scene.supply(view).unwrap();
        let mut studio = Studio::new(&mut supply);
        let go_on = &mut |_: &_| std::ops::ControlFlow::Continue(());
        let image = studio.picture(camera.as_ref().unwrap(), &options, go_on).unwrap().image;
        let covered = image.pixels.iter().filter(|pixel| pixel[3] == 255);
        let (n, sum) = covered.fold((0, [0u64; 3]), |(n, sum), [r, g, b, _]| {
            (n + 1, [sum[0] + u64::from(*r), sum[1] + u64::from(*g), sum[2] + u64::from(*b)])
        });
        assert!(n > 400, "{n}");
        (n_triangles, n_lines, sum.map(|sum| sum as f64 / f64::from(n)))
    };
    let (near, far) = (color(5.0), color(1e6));
    assert!(near.0 > 0 && near.1 == 0 && far.0 == 0 && far.1 > 0, "{near:?} {far:?}");
    for (near, far) in near.2.into_iter().zip(far.2) {
        assert!((near / far - 1.0).abs() < 0.1, "{near:?} {far:?}");
    }
}
