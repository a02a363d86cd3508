//! Lists that were merged, smoothed or simplified: the scene and its own lists never notice.

use sapwood::geom::{Digest, Simplify};
use sapwood::graph::{DrawList, Merge};
use sapwood::rules::weber_penn::{Seed, Tree};
use sapwood::scene::Scene;

/// Everything that a list draws, as one digest.
fn digest(list: &DrawList) -> Digest {
    let mut digests = Vec::new();
    for (world, row) in list.placed_rows() {
        let instances = row.instances.as_ref().map(|instances| instances.digest());
        digests.push((Digest::of(&world), Digest::of(&row.mesh)));
        digests.push((Digest::of(&row.material), Digest::of(&instances)));
    }
    Digest::of(&digests)
}

fn n_triangles(list: &DrawList) -> u64 {
    list.n_vertices_and_triangles().1
}

#[test]
fn what_is_made_of_a_list_leaves_the_scene_alone() {
    let species = sapwood::io::built_in("japanese_maple").unwrap();
    let mut scene = Scene::new();
    let family = scene.add(species.attribute());
    scene.add_to(family, Tree { seed: Seed::Explicit(1) }).unwrap();
    let view = scene.open_view(family, &sapwood::standard_rules()).unwrap();
    let list = scene.draw_list(view, 100_000).unwrap();
    let before = (digest(&list), scene.revision(), n_triangles(&list));

    let how = Simplify { ratio: 0.3, max_error: 0.05 };
    let made = |list: &DrawList| {
        let merged = list.merged_by_material(Merge::Bodies).unwrap();
        let all = list.merged_by_material(Merge::All { max_triangles: 1 << 20 }).unwrap();
        [merged.simplified(&how), list.with_smooth_normals(0.8), merged, all]
    };
    let [simple, smooth, merged, all] = made(&list);
    for list in [&simple, &smooth, &merged, &all] {
        for (_, row) in list.placed_rows() {
            assert_eq!(row.mesh.fault(), None);
        }
    }
    // What is merged comes first; the leaves are instances of something simple already.
    let wood = |list: &DrawList| {
        list.bodies[0].rows[..2].iter().map(|row| row.mesh.n_triangles()).sum::<usize>()
    };
    let (fine, coarse) = (wood(&merged), wood(&simple));
    assert!(coarse < fine * 4 / 5 && coarse > fine / 5, "{coarse} of {fine}");
    assert_eq!([&smooth, &merged, &all].map(n_triangles), [before.2; 3]);
    assert_eq!(all.bodies[0].rows.len(), 3, "bark, twigs and leaves");

    let again = made(&list);
    for (one, other) in [simple, smooth, merged, all].iter().zip(&again) {
        assert_eq!(digest(one), digest(other), "the same list gives the same bytes");
    }
    let after = scene.draw_list(view, 100_000).unwrap();
    assert_eq!((digest(&after), scene.revision(), n_triangles(&after)), before);
}
