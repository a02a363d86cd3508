//! Wood welded to one solid: nothing is wrong with its surface, all tips are there, it has the
//! volume of its stems, nothing hangs in the air; and what was joined is kept.

use sapwood::geom::glam::Vec3;
use sapwood::geom::{Envelope, Mesh, Solid, Sphere, UnionWork};
use sapwood::graph::{
    At, DrawList, Everything, Order, Prune, Remaining, Standing, WeldUnion, WeldedUnion,
};
use sapwood::rules::weber_penn::{Seed, Species, Tree, prune_handlers};
use sapwood::scene::{Budget, EnvelopeSlot, Scene, ViewError, ViewId};

use super::trees::*;
use super::wood::Wood;

fn welded(scene: &mut Scene, view: ViewId, weld: &mut WeldUnion) -> WeldedUnion {
    scene.traverse(view, Order::Pre, &Everything, &mut |at| weld.meet(at)).unwrap();
    let list = scene.draw_list(view, usize::MAX).unwrap();
    weld.join(&list, 10_000_000, &|_| true).unwrap()
}

/// What a list draws of the wood, all materials together.
fn surface(list: &DrawList) -> Mesh {
    let mut surface = Mesh::default();
    for (world, row) in list.placed_rows().filter(|(_, row)| row.instances.is_none()) {
        surface.append(&row.mesh, &world);
    }
    surface
}

/// Welds the wood of a tree and looks for whatever may be wrong with it.
fn check(species: &Species, seed: u64) {
    let mut tree = planted_in(Scene::new(), species, seed);
    let WeldedUnion { list, union, report } =
        welded(&mut tree.scene, tree.view, &mut WeldUnion::new());
    let name = &species.name;

    // What is drawn is the union: looked at by positions alone, so through the eyes of whoever
    // reads a file.
    let mesh = surface(&list);
    assert_eq!(mesh.fault(), None, "{name}");
    let solid = Solid::of_mesh(&mesh);
    let found = solid.check();
    assert!(found.is_sound(), "{name}: {found}");
    assert_eq!(solid.triangles.len(), union.solid.triangles.len());
    assert_eq!(report.n_triangles, solid.triangles.len() as u64);

    let wood = Wood::of(&mut tree.scene, tree.view);
    assert_eq!((wood.stems.len(), wood.n_uncovered()), (report.n_solids, 0), "{name}");
    let (lost, n_covered) = wood.lost_tips(&solid, 1e-3);
    assert!(lost.is_empty(), "{name}: {} of {} tips", lost.len(), wood.tips.len());
    assert!(10 * n_covered <= wood.tips.len(), "{name}: {n_covered} of {}", wood.tips.len());
    assert!(wood.afloat(&union).is_empty(), "{name}");
    let volume = wood.volume(200_000);
    let off = found.volume / volume - 1.0;
    assert!(off.abs() < 0.02, "{name}: {} m3, of {volume} by points", found.volume);
}

#[test]
fn the_wood_of_trees_becomes_one_solid() {
    // One with lobes, with splits on all levels, with stems that hardly taper, and with many
    // trunks.
    check(&built_in("palm"), 1);
    check(&sapling(), 1);
    check(&built_in("small_pine"), 1);
    check(&with(&built_in("japanese_maple"), &[("level.2.branches", 3.0)]), 1);
    check(&with(&built_in("bamboo"), &[("level.0.branches", 6.0)]), 1);
}

#[test]
fn what_a_cut_leaves_becomes_one_solid_closed_by_caps() {
    let mut aspen = grown(&built_in("quaking_aspen"), 1);
    let whole = welded(&mut aspen.scene, aspen.view, &mut WeldUnion::new()).report.checked;
    let ball = Sphere { center: Vec3::Y * 5.0, radius: 5.5 };
    let cuts = [
        ("lopped", Envelope::half_space(Vec3::Y, 6.0), 0.5..0.99),
        ("sphere", Envelope::sphere(ball), 0.5..0.999),
        ("notched", Envelope::half_space(Vec3::X, 0.4), 0.5..0.999),
    ];
    for (name, envelope, expected) in cuts {
        let prune = Prune::to(envelope);
        let list = aspen.scene.prune(aspen.view, &prune, &prune_handlers(), 1_000_000).unwrap();
        let mut weld = WeldUnion::new();
        let visit = &mut |remaining: &Remaining<'_>, at: &At<'_, Standing>| {
            weld.meet_remaining(remaining, at);
        };
        aspen.scene.traverse_pruned(aspen.view, &prune, &prune_handlers(), visit).unwrap();
        let joined = weld.join(&list, 10_000_000, &|_| true).unwrap();
        let mesh = surface(&joined.list);
        assert_eq!(mesh.fault(), None, "{name}");
        let found = Solid::of_mesh(&mesh).check();
        assert!(found.is_sound() && found.components == 1, "{name}: {found}");
        let off = found.volume / joined.report.checked.volume - 1.0;
        assert!(off.abs() < 1e-9, "{name}: {off}");
        let share = found.volume / whole.volume;
        assert!(expected.contains(&share), "{name}: {share}");
        // It reaches as far as what the cut leaves without a weld.
        let [solid, cut] = [mesh.bound().aabb, surface(&list).bound().aabb];
        let off = (solid.min - cut.min).abs().max((solid.max - cut.max).abs());
        assert!(off.max_element() < 2e-3, "{name}: {solid:?} {cut:?}");
        // Leaves are the cut's.
        let n_leaves = |list: &DrawList| -> usize {
            list.placed_rows().filter_map(|(_, row)| Some(row.instances.as_ref()?.len())).sum()
        };
        assert_eq!(n_leaves(&joined.list), n_leaves(&list), "{name}");
    }
}

/// Gathers what a cut leaves.
fn meet_cut(
    scene: &mut Scene,
    view: ViewId,
    prune: &Prune,
    weld: &mut WeldUnion,
) -> Result<(), ViewError> {
    let visit = &mut |remaining: &Remaining<'_>, at: &At<'_, Standing>| {
        weld.meet_remaining(remaining, at);
    };
    scene.traverse_pruned(view, prune, &prune_handlers(), visit)
}

/// The least budget of triangles that `work` keeps to.
fn least_budget(
    tree: &mut Grown,
    mut work: impl FnMut(&mut Grown) -> Result<(), ViewError>,
) -> u64 {
    let (mut too_few, mut enough) = (0, 1_000_000);
    while enough - too_few > 1 {
        let triangles = (too_few + enough) / 2;
        tree.scene.set_budget(tree.view, Budget { triangles, ..Budget::default() }).unwrap();
        match work(tree) {
            Ok(()) => enough = triangles,
            Err(_) => too_few = triangles,
        }
    }
    enough
}

#[test]
fn what_a_cut_leaves_is_counted_once_though_a_solid_comes_in_its_place() {
    let mut tree = planted_in(Scene::new(), &sapling(), 1);
    tree.scene.bounds(tree.view).unwrap();
    let prune = Prune::to(Envelope::half_space(Vec3::NEG_X, 0.1));
    let drawn = least_budget(&mut tree, |tree| {
        let list = tree.scene.prune(tree.view, &prune, &prune_handlers(), 1_000_000);
        list.map(|_| ())
    });
    let gathered = least_budget(&mut tree, |tree| {
        meet_cut(&mut tree.scene, tree.view, &prune, &mut WeldUnion::new())
    });
    let at = |tree: &mut Grown, triangles: u64| {
        tree.scene.set_budget(tree.view, Budget { triangles, ..Budget::default() }).unwrap();
        let mut weld = WeldUnion::new();
        let met = meet_cut(&mut tree.scene, tree.view, &prune, &mut weld);
        (met.map(|()| weld.n_solids()), weld)
    };
    let (met, mut weld) = at(&mut tree, 1_000_000);
    assert!(weld.n_solids() > 10, "{}", weld.n_solids());
    let list = tree.scene.prune(tree.view, &prune, &prune_handlers(), 1_000_000).unwrap();
    let report = weld.join(&list, u64::MAX, &|_| true).unwrap().report;
    // Whole solids are not made by the cut: there are fewer triangles than all of them have. Were
    // both counted, as many again would be needed as are drawn.
    let most = drawn.max(report.n_triangles_before);
    assert!(gathered >= drawn && gathered <= most, "{drawn} drawn, {gathered} of {report:?}");
    assert!(10 * (gathered - drawn) < drawn, "{drawn} drawn, {gathered} gathered");
    // At the budget itself, and with one triangle less.
    assert_eq!(at(&mut tree, gathered).0.unwrap(), met.unwrap());
    let refused = at(&mut tree, gathered - 1).0.unwrap_err().to_string();
    assert!(refused.starts_with(&format!("more than {} triangles", gathered - 1)), "{refused}");
    // All that joining needs, and one triangle less.
    let needed = report.n_triangles.max(report.n_triangles_before);
    let (_, mut weld) = at(&mut tree, needed.max(gathered));
    assert_eq!(weld.join(&list, needed, &|_| true).unwrap().report.n_triangles, report.n_triangles);
    let (_, mut weld) = at(&mut tree, needed.max(gathered));
    assert!(weld.join(&list, needed - 1, &|_| true).is_err());
}

#[test]
fn a_walk_that_was_interrupted_leaves_nothing_behind_once_it_is_cleared() {
    let mut tree = planted_in(Scene::new(), &sapling(), 1);
    let prune = Prune::to(Envelope::half_space(Vec3::NEG_X, 0.1));
    let mut fresh = WeldUnion::new();
    meet_cut(&mut tree.scene, tree.view, &prune, &mut fresh).unwrap();
    let list = tree.scene.prune(tree.view, &prune, &prune_handlers(), 1_000_000).unwrap();
    let n_solids = fresh.n_solids();
    let fresh = fresh.join(&list, u64::MAX, &|_| true).unwrap();

    let mut weld = WeldUnion::new();
    let budget = |tree: &mut Grown, triangles| {
        tree.scene.set_budget(tree.view, Budget { triangles, ..Budget::default() }).unwrap();
    };
    let enough = least_budget(&mut tree, |tree| {
        meet_cut(&mut tree.scene, tree.view, &prune, &mut WeldUnion::new())
    });
    budget(&mut tree, 4 * enough / 5);
    meet_cut(&mut tree.scene, tree.view, &prune, &mut weld).unwrap_err();
    let n_left = weld.n_solids();
    assert!((1..n_solids).contains(&n_left), "{n_left} of {n_solids}");
    weld.clear();
    assert_eq!(weld.n_solids(), 0);
    budget(&mut tree, 1_000_000);
    meet_cut(&mut tree.scene, tree.view, &prune, &mut weld).unwrap();
    assert_eq!(weld.n_solids(), n_solids);
    let joined = weld.join(&list, u64::MAX, &|_| true).unwrap();
    assert_eq!(joined.union.solid, fresh.union.solid);
    assert_eq!(digest(&joined.list), digest(&fresh.list));

    // An interrupted join forgets what it was to join, and keeps what was joined before.
    meet_cut(&mut tree.scene, tree.view, &prune, &mut weld).unwrap();
    weld.join(&list, 10, &|_| true).unwrap_err();
    assert_eq!(weld.n_solids(), 0);
    meet_cut(&mut tree.scene, tree.view, &prune, &mut weld).unwrap();
    let again = weld.join(&list, u64::MAX, &|_| true).unwrap().report.work;
    assert_eq!((again.n_joined, again.n_kept), (0, 1));
}

#[test]
fn a_branch_that_is_cut_is_joined_again_with_what_it_grows_on() {
    let mut scene = checked_scene();
    let family = scene.add(sapling().attribute());
    scene.add_to(family, Tree { seed: Seed::Explicit(1) }).unwrap();
    let view = scene.open_view(family, &sapwood::standard_rules()).unwrap();
    let mut weld = WeldUnion::new();
    let hold = |scene: &mut Scene, x: f32| {
        let wall = Envelope::half_space(Vec3::X, x);
        scene.edit(family, |attribute| attribute.set::<EnvelopeSlot>(Some(wall))).unwrap();
    };
    let reach = {
        let list = scene.draw_list(view, usize::MAX).unwrap();
        surface(&list).bound().aabb.max.x
    };
    hold(&mut scene, reach + 0.05);
    let first = welded(&mut scene, view, &mut weld);
    let work = first.report.work;
    // Every branch with its twigs, and the trunk with the branches.
    assert!(work.n_joined > 5 && work.n_kept == 0, "{work:?}");
    // Each group but the last is a member of another.
    assert_eq!(work.n_members, first.report.n_solids + work.n_joined - 1);

    // Nothing happened: nothing is joined.
    let second = welded(&mut scene, view, &mut weld);
    assert_eq!(second.report.work, UnionWork { n_joined: 0, n_members: 0, n_kept: 1 });
    assert_eq!(second.union.solid, first.union.solid);

    hold(&mut scene, reach - 0.05);
    let third = welded(&mut scene, view, &mut weld);
    let again = third.report.work;
    // The branch, and what lies between it and the whole tree.
    assert!((2..=6).contains(&again.n_joined) && again.n_kept > 2, "{again:?} {work:?}");
    assert!(3 * again.n_members < work.n_members, "{again:?} {work:?}");
    let fresh = welded(&mut scene, view, &mut WeldUnion::new());
    assert_eq!(fresh.union.solid, third.union.solid);
    assert_eq!(digest(&fresh.list), digest(&third.list));
    assert_ne!(digest(&first.list), digest(&third.list));
}
