//! Trees that are cut: stems end where they leave the envelope, and nothing floats.

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::geom::{Aabb, Envelope, Sphere};
use sapwood::graph::{DrawList, Merge, Prune};
use sapwood::rules::weber_penn::{LeafParams, Seed, Tree, prune_handlers};
use sapwood::scene::{Group, Scene, Transform};

use super::trees::*;

fn pruned(tree: &mut Grown, envelope: Envelope) -> DrawList {
    let prune = Prune::to(envelope);
    tree.scene.prune(tree.view, &prune, &prune_handlers(), 1_000_000).unwrap()
}

fn aspen() -> Grown {
    grown(&sapwood::io::find_species("quaking_aspen").unwrap(), 1)
}

/// Around the trunk's foot, and smaller than the crown.
fn envelopes() -> Vec<(&'static str, Envelope)> {
    let cuboid = Aabb { min: Vec3::new(-1.2, -1.0, -1.0), max: Vec3::new(1.0, 8.0, 1.2) };
    vec![
        ("box", Envelope::aabb(cuboid)),
        ("sphere", Envelope::sphere(Sphere { center: Vec3::Y * 5.0, radius: 5.5 })),
        ("half-space", Envelope::half_space(Vec3::X, 0.5)),
        ("lopped", Envelope::half_space(Vec3::Y, 6.0)),
    ]
}

/// The corners of all bark, and the instances of all leaves.
fn bark_and_leaves(list: &DrawList) -> (Vec<Vec3>, Vec<Affine3>) {
    let (mut bark, mut leaves) = (Vec::new(), Vec::new());
    for (world, row) in list.placed_rows() {
        assert_eq!(row.mesh.fault(), None);
        match &row.instances {
            Some(instances) => leaves.extend(instances.iter().map(|at| world * *at)),
            None => bark.extend(row.mesh.positions.iter().map(|p| world.transform_point3(*p))),
        }
    }
    (bark, leaves)
}

#[test]
fn nothing_is_left_outside_and_nothing_floats() {
    let mut tree = aspen();
    let whole = bark_and_leaves(&tree.draw_list());
    let leaves = LeafParams::new(&built_in("quaking_aspen"));
    let along = leaves.petiole() + 0.5 * leaves.length();
    for (name, envelope) in envelopes() {
        let list = pruned(&mut tree, envelope.clone());
        let (bark, leaves) = bark_and_leaves(&list);
        let share = |n: usize, of: usize| n as f32 / of as f32;
        let shares = [share(bark.len(), whole.0.len()), share(leaves.len(), whole.1.len())];
        assert!(shares.iter().all(|share| (0.01..0.95).contains(share)), "{name}: {shares:?}");
        // Stems end where their middle leaves; a trunk is thicker than that.
        for point in &bark {
            let around = Sphere { center: *point, radius: 0.3 };
            let is_near = envelope.side_of(&around) != sapwood::geom::Side::Outside;
            assert!(is_near, "{name}: bark at {point}");
        }
        for leaf in &leaves {
            let middle = leaf.transform_point3(Vec3::Z * along);
            assert!(envelope.contains(middle), "{name}: a leaf at {middle}");
        }
        // Leaves hang on bark; so do those of the whole tree.
        let nearest = |leaf: &Affine3, bark: &[Vec3]| {
            let foot = leaf.translation;
            bark.iter().map(|p| p.distance_squared(foot)).fold(f32::INFINITY, f32::min).sqrt()
        };
        let some = |leaves: &[Affine3], bark: &[Vec3]| {
            let step = (leaves.len() / 200).max(1);
            leaves.iter().step_by(step).map(|leaf| nearest(leaf, bark)).fold(0.0, f32::max)
        };
        let (cut, uncut) = (some(&leaves, &bark), some(&whole.1, &whole.0));
        assert!(cut < 1.5 * uncut + 0.01, "{name}: {cut} m from bark, {uncut} on the whole tree");
    }
}

#[test]
fn cut_stems_are_closed() {
    let open_edges = |list: &DrawList| -> usize {
        let rows = list.placed_rows().filter(|(_, row)| row.instances.is_none());
        rows.map(|(_, row)| row.mesh.n_open_edges()).sum()
    };
    let mut tree = aspen();
    let whole = open_edges(&tree.draw_list());
    for (name, envelope) in envelopes() {
        let list = pruned(&mut tree, envelope);
        let (n, whole) = (open_edges(&list), whole);
        assert!(n < whole, "{name}: {n} open edges, {whole} before");
    }
    // The trunk alone is closed everywhere.
    let mut species = sapwood::io::find_species("quaking_aspen").unwrap();
    species.levels = 1;
    let mut trunk = grown(&species, 1);
    assert_eq!(open_edges(&trunk.draw_list()), 0);
    let cut = pruned(&mut trunk, Envelope::half_space(Vec3::Y, 3.0));
    assert_eq!(open_edges(&cut), 0);
    let top = cut.placed_rows().next().map(|(world, row)| row.mesh.bound().transformed(&world));
    assert!(top.is_some_and(|top| (top.aabb.max.y - 3.0).abs() < 0.1), "{top:?}");
}

#[test]
fn a_far_envelope_leaves_everything_shared_and_a_near_one_nothing() {
    let mut tree = aspen();
    let whole = tree.draw_list();
    let far = Sphere { center: Vec3::ZERO, radius: 100.0 };
    let list = pruned(&mut tree, Envelope::sphere(far));
    assert_eq!(list.bodies.len(), whole.bodies.len());
    for (kept, row) in list.bodies[0].rows.iter().zip(&whole.bodies[0].rows) {
        assert!(kept.mesh.is_same(&row.mesh));
    }
    // Beside the trunk, around some branches: these stand on what is gone.
    let beside = Sphere { center: Vec3::new(2.0, 6.0, 0.0), radius: 1.0 };
    assert!(pruned(&mut tree, Envelope::sphere(beside)).occurrences.is_empty());
    // The tree itself was not touched.
    assert_eq!(tree.draw_list().n_vertices_and_triangles(), whole.n_vertices_and_triangles());
    assert!(tree.compiled().is_empty());
}

#[test]
fn a_trunk_that_enters_later_keeps_its_foot() {
    let mut tree = aspen();
    let list = pruned(&mut tree, Envelope::sphere(Sphere { center: Vec3::Y * 6.0, radius: 3.0 }));
    let (bark, _) = bark_and_leaves(&list);
    let lowest = bark.iter().map(|point| point.y).fold(f32::INFINITY, f32::min);
    let highest = bark.iter().map(|point| point.y).fold(0.0, f32::max);
    assert!(lowest < 0.1 && (8.5..9.2).contains(&highest), "{lowest} to {highest}");
}

#[test]
fn trees_are_cut_where_they_stand() {
    // The same tree twice, the second one where it is cut.
    let species = sapwood::io::find_species("quaking_aspen").unwrap();
    let mut scene = Scene::new();
    let family = scene.add(species.attribute());
    let all = scene.add_to(family, Group).unwrap();
    let tree = scene.add_to(all, Tree { seed: Seed::Explicit(1) }).unwrap();
    let place = scene.add_to(all, Transform::translation(30.0, 0.0, 0.0)).unwrap();
    scene.append(place, tree).unwrap();
    let view = scene.open_view(family, &sapwood::standard_rules()).unwrap();
    let moved = Aabb { min: Vec3::new(29.0, -1.0, -1.0), max: Vec3::new(31.0, 7.0, 1.0) };
    let prune = Prune::to(Envelope::aabb(moved));
    let list = scene.prune(view, &prune, &prune_handlers(), 1_000_000).unwrap();
    let here = Aabb { min: moved.min - Vec3::X * 30.0, max: moved.max - Vec3::X * 30.0 };
    let same = pruned(&mut aspen(), Envelope::aabb(here));
    let n = |list: &DrawList| list.n_vertices_and_triangles().1 as f64;
    assert!((n(&list) / n(&same) - 1.0).abs() < 0.01, "{} and {}", n(&list), n(&same));
    let merged = list.merged_by_material(Merge::All { max_triangles: 10_000_000 }).unwrap();
    assert!(merged.placed_rows().all(|(_, row)| row.mesh.bound().aabb.min.x > 28.0));
}
