//! Welded stems: their segments, brought together by what their vertices are, agree with the
//! surface that is swept at once; both are sound at every edge; and what was welded is kept.

use std::convert::Infallible;

use sapwood::geom::glam::Vec3;
use sapwood::geom::{Envelope, FixedSet, Mesh, Sphere, StreamPath, fixed_state};
use sapwood::graph::{
    At, DrawList, Everything, Order, PiecesReport, Prune, Remaining, Standing, WeldPieces,
};
use sapwood::rules::weber_penn::{
    Crown, Detail, Level, LevelDetail, Seed, Species, Stems, Target, Tree, TrunkForm, children,
    grow, prune_handlers, stem_segments, surface, trunks,
};
use sapwood::scene::{Action, EnvelopeSlot, Scene, ViewError, ViewId};

use super::trees::*;

fn free(_: usize) -> Result<(), Infallible> {
    Ok(())
}

/// The most stems of a level that are looked at; others are left out evenly.
const MOST: usize = 40;

/// Stems of all levels, a batch for each, [`MOST`] stems of a level and their clones.
fn grown_purely(species: &Species, seed: u64) -> Vec<Stems> {
    let (crown, levels) = (Crown::new(species), Level::all(species));
    let form = TrunkForm::new(species);
    let Ok(mut seeds) = trunks(&crown, &levels[0], StreamPath::new(seed), &mut free);
    let mut grown = Vec::new();
    for n in 0..species.levels as usize {
        let every = seeds.len().div_ceil(MOST).max(1);
        let some: Vec<_> = seeds.iter().copied().step_by(every).collect();
        let Ok(stems) = grow(&some, &crown, &levels[n], &Target::Up, &mut free);
        if n + 1 < species.levels as usize {
            let form = (n == 0).then_some(&form);
            let Ok(next) = children(&stems, &crown, form, &levels[n + 1], &mut free);
            seeds = next;
        }
        grown.push(stems);
    }
    grown
}

fn corners(mesh: &Mesh) -> impl Iterator<Item = [Vec3; 3]> + '_ {
    mesh.indices.chunks_exact(3).map(|t| [0, 1, 2].map(|i| mesh.positions[t[i] as usize]))
}

/// What is wrong with a surface, in words: a triangle that is degenerate, a normal more than 90
/// degrees off, an edge that has not two faces of opposite direction, unless it is a border; a
/// border that another corner lies on.
fn fault_of_surface(mesh: &Mesh) -> Option<String> {
    if let Some(fault) = mesh.fault() {
        return Some(fault);
    }
    for (triangle, [a, b, c]) in mesh.indices.chunks_exact(3).zip(corners(mesh)) {
        let face = (b - a).cross(c - a).normalize();
        for corner in triangle {
            let normal = mesh.normals[*corner as usize];
            if face.dot(normal) <= 0.0 {
                return Some(format!("normal {normal} on the face {face} of {a} {b} {c}"));
            }
        }
    }
    let key = |p: Vec3| (p + 0.0).to_array().map(f32::to_bits);
    let sides = || corners(mesh).flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)]);
    let mut edges = FixedSet::with_hasher(fixed_state());
    for (from, to) in sides() {
        if !edges.insert((key(from), key(to))) {
            return Some(format!("two faces go along the edge from {from} to {to}"));
        }
    }
    let is_border = |(from, to): &(Vec3, Vec3)| !edges.contains(&(key(*to), key(*from)));
    let borders: Vec<(Vec3, Vec3)> = sides().filter(is_border).collect();
    for (from, to) in &borders {
        for (corner, _) in &borders {
            let (along, arm) = (*to - *from, *corner - *from);
            let share = arm.dot(along) / along.length_squared();
            let off = (arm - along * share).length();
            if (0.001..0.999).contains(&share) && off < 1e-5 * along.length() {
                return Some(format!("{corner} lies on the border from {from} to {to}"));
            }
        }
    }
    None
}

/// What is wrong with swept stems, with their welded segments, or between the two.
fn fault_of_weld(stems: &Stems, form: &TrunkForm, detail: &Detail) -> Option<String> {
    let Ok(swept) = surface(stems, form, detail, 0.5, free);
    if let Some(fault) = fault_of_surface(&swept) {
        return Some(format!("swept: {fault}"));
    }
    let Ok(pieces) = stem_segments(stems, form, detail, 0.5, free);
    let welded = pieces.weld();
    if let Some(fault) = fault_of_surface(&welded) {
        return Some(format!("welded: {fault}"));
    }
    if welded.n_triangles() != swept.n_triangles() {
        return Some(format!("{} of {} triangles", welded.n_triangles(), swept.n_triangles()));
    }
    // Around few sides more corners need a normal of their own than there are ends to weld.
    if *detail == Detail::default() && welded.n_vertices() > pieces.mesh.n_vertices() {
        return Some(format!("{} vertices", welded.n_vertices()));
    }
    let both = corners(&welded).flatten().zip(corners(&swept).flatten());
    let mut apart = both.filter(|(one, other)| one.distance(*other) >= 1e-5);
    apart.next().map(|(one, other)| format!("{one} welded, {other} swept"))
}

#[test]
fn every_species_welds_to_its_swept_surface() {
    let (mut n_clones, mut faults) = (0, Vec::new());
    for name in sapwood::io::built_in_names() {
        let species = built_in(name);
        let form = TrunkForm::new(&species);
        for seed in 0..8 {
            for (level, stems) in grown_purely(&species, seed).iter().enumerate() {
                n_clones += stems.stems.iter().filter(|stem| stem.clone_of.is_some()).count();
                let of = || format!("{name}, seed {seed}, level {level}");
                let fault = fault_of_weld(stems, &form, &Detail::default());
                faults.extend(fault.map(|fault| format!("{}: {fault}", of())));
            }
        }
    }
    assert!(
        faults.is_empty(),
        "{} faults, the first {:#?}",
        faults.len(),
        &faults[..faults.len().min(20)]
    );
    assert!(n_clones > 1000, "{n_clones} clones");
}

#[test]
fn odd_sides_and_segments_stay_closed() {
    let mut n_forked = 0;
    for name in ["black_tupelo", "japanese_maple", "palm", "small_pine", "ca_black_oak"] {
        let species = built_in(name);
        let form = TrunkForm::new(&species);
        for (sides, segments) in [(3, 3), (5, 3), (7, 7), (13, 29)] {
            let mut detail = Detail::default();
            detail.levels.fill(LevelDetail { sides: Some(sides), segments: Some(segments) });
            for (level, stems) in grown_purely(&species, 3).iter().enumerate() {
                let fault = fault_of_weld(stems, &form, &detail);
                assert_eq!(fault, None, "{name}, level {level}, {sides} sides, {segments} pieces");
                n_forked += stems.stems.iter().filter(|stem| stem.clone_of.is_some()).count();
            }
        }
    }
    assert!(n_forked > 100, "{n_forked}");
}

fn welded(scene: &mut Scene, view: ViewId, weld: &mut WeldPieces) -> (DrawList, PiecesReport) {
    scene.traverse(view, Order::Pre, &Everything, &mut |at| weld.meet(at)).unwrap();
    let list = scene.draw_list(view, usize::MAX).unwrap();
    weld.welded(&list)
}

/// The greatest x of anything that is no leaf.
fn reach_of_wood(list: &DrawList) -> f32 {
    let wood = list.placed_rows().filter(|(_, row)| row.instances.is_none());
    let points = wood.flat_map(|(world, row)| {
        row.mesh.positions.iter().map(|p| world.transform_point3(*p).x).collect::<Vec<_>>()
    });
    points.fold(f32::MIN, f32::max)
}

#[test]
fn a_branch_that_is_cut_is_welded_again_and_no_other() {
    let mut scene = checked_scene();
    let family = scene.add(sapling().attribute());
    scene.add_to(family, Tree { seed: Seed::Explicit(1) }).unwrap();
    let view = scene.open_view(family, &sapwood::segment_rules()).unwrap();
    let mut weld = WeldPieces::new();
    let unpruned = scene.draw_list(view, usize::MAX).unwrap();
    let hold = |scene: &mut Scene, x: f32| {
        let wall = Envelope::half_space(Vec3::X, x);
        scene.edit(family, |attribute| attribute.set::<EnvelopeSlot>(Some(wall))).unwrap();
    };
    let reach = reach_of_wood(&unpruned);
    hold(&mut scene, reach + 0.05);
    let (list, first) = welded(&mut scene, view, &mut weld);
    let n_meshes = unpruned.placed_rows().filter(|(_, row)| row.instances.is_none()).count();
    assert_eq!((first.n_welded, first.n_kept), (n_meshes, 0));
    assert!(first.n_vertices < first.n_vertices_before, "{first:?}");
    for (_, row) in list.placed_rows().filter(|(_, row)| row.instances.is_none()) {
        assert_eq!(row.mesh.fault(), None);
    }

    // Nothing happened: nothing is welded.
    let (_, second) = welded(&mut scene, view, &mut weld);
    assert_eq!((second.n_welded, second.n_kept), (0, n_meshes));

    scene.take_log();
    hold(&mut scene, reach - 0.05);
    let (list, third) = welded(&mut scene, view, &mut weld);
    let log = scene.take_log();
    let surfaces = log
        .iter()
        .filter(|event| (event.action, event.kind.name()) == (Action::Compiled, "stem_surface"));
    let n_again = surfaces.count();
    assert!((1..=4).contains(&n_again), "{n_again} surfaces of {n_meshes}");
    assert_eq!(third.n_welded, n_again);
    assert!(third.n_kept + n_again <= n_meshes && third.n_kept >= n_meshes - 4, "{third:?}");
    let (fresh, _) = welded(&mut scene, view, &mut WeldPieces::new());
    assert_eq!(digest(&list), digest(&fresh));
}

/// All wood of a list.
fn wood(list: &DrawList) -> Mesh {
    let mut wood = Mesh::default();
    for (world, row) in list.placed_rows().filter(|(_, row)| row.instances.is_none()) {
        assert_eq!(row.mesh.fault(), None);
        wood.append(&row.mesh, &world);
    }
    wood
}

/// Meets what a cut leaves.
fn meet_cut(
    scene: &mut Scene,
    view: ViewId,
    prune: &Prune,
    weld: &mut WeldPieces,
) -> Result<(), ViewError> {
    let visit = &mut |remaining: &Remaining<'_>, at: &At<'_, Standing>| {
        weld.meet_remaining(remaining, at);
    };
    scene.traverse_pruned(view, prune, &prune_handlers(), visit)
}

#[test]
fn what_a_cut_leaves_of_welded_stems_is_what_it_leaves_of_swept_ones() {
    // One with splits on all levels, whose weld leaves triangles out, and one with a flared foot.
    let maple = with(&built_in("japanese_maple"), &[("level.2.branches", 3.0)]);
    for (species, n_cut) in [(maple, 40), (sapling(), 5)] {
        let mut scene = Scene::new();
        let family = scene.add(species.attribute());
        scene.add_to(family, Tree { seed: Seed::Explicit(1) }).unwrap();
        let view = scene.open_view(family, &sapwood::segment_rules()).unwrap();
        let swept = scene.open_view(family, &sapwood::standard_rules()).unwrap();
        let size = scene.bounds(swept).unwrap().aabb.size();
        let ball = Sphere { center: 0.4 * size.y * Vec3::Y, radius: 0.42 * size.y };
        let envelopes = [
            Envelope::half_space(Vec3::Y, 0.5 * size.y),
            Envelope::half_space(Vec3::X, 0.1 * size.x),
            Envelope::sphere(ball),
            Envelope::sphere(Sphere { center: Vec3::ZERO, radius: 1e4 }),
        ];
        let mut weld = WeldPieces::new();
        let (mut n_welded, mut n_open, mut n_pieces) = (0, 0, 0);
        for envelope in envelopes {
            let prune = Prune::to(envelope);
            meet_cut(&mut scene, view, &prune, &mut weld).unwrap();
            let cut = |scene: &mut Scene, view| {
                scene.prune(view, &prune, &prune_handlers(), 1_000_000).unwrap()
            };
            let pieces = cut(&mut scene, view);
            let (list, report) = weld.welded(&pieces);
            n_welded += report.n_welded;
            let (welded, expected) = (wood(&list), wood(&cut(&mut scene, swept)));
            // The same up to what rounding makes of triangles as thin as hairs.
            let off = welded.n_triangles().abs_diff(expected.n_triangles());
            assert!(1000 * off <= expected.n_triangles(), "{off} of {}", expected.n_triangles());
            let area = |mesh: &Mesh| -> f64 {
                let doubled = |[a, b, c]: [Vec3; 3]| f64::from((b - a).cross(c - a).length());
                corners(mesh).map(doubled).sum()
            };
            let share = area(&welded) / area(&expected);
            assert!((share - 1.0).abs() < 1e-5, "{share}");
            let [one, other] = [welded.bound().aabb, expected.bound().aabb];
            let apart = (one.min - other.min).abs().max((one.max - other.max).abs());
            assert!(apart.max_element() < 1e-3, "{one:?} {other:?}");
            n_open += welded.n_open_edges().abs_diff(expected.n_open_edges());
            n_pieces += wood(&pieces).n_open_edges() - welded.n_open_edges();
            let leaves = |list: &DrawList| {
                list.placed_rows().filter(|(_, row)| row.instances.is_some()).count()
            };
            assert_eq!(leaves(&list), leaves(&pieces));
        }
        assert!(n_open <= 4, "{n_open} edges open on one and closed on the other");
        assert!(n_pieces > 1000, "pieces are open at both ends");
        assert!(n_welded >= n_cut, "{n_welded} of {n_cut}");
        // All that was met in the last walk is there: nothing is welded again.
        let everything = Prune::to(Envelope::sphere(Sphere { center: Vec3::ZERO, radius: 1e4 }));
        meet_cut(&mut scene, view, &everything, &mut weld).unwrap();
        let list = scene.draw_list(view, usize::MAX).unwrap();
        let (whole, report) = weld.welded(&list);
        assert_eq!(report.n_welded, 0);
        let (fresh, _) = welded(&mut scene, view, &mut WeldPieces::new());
        assert_eq!(digest(&whole), digest(&fresh));
    }
}

#[test]
fn a_walk_that_was_interrupted_leaves_nothing_behind_once_it_is_cleared() {
    let mut tree = planted_in(Scene::new(), &sapling(), 1);
    let rules = sapwood::segment_rules();
    tree.view = tree.scene.open_view(tree.family, &rules).unwrap();
    let Grown { scene, view, .. } = &mut tree;
    let (fresh, all) = welded(scene, *view, &mut WeldPieces::new());
    let mut weld = WeldPieces::new();
    let half_walk = |scene: &mut Scene, weld: &mut WeldPieces| {
        let mut n = 0;
        let visit = &mut |at: &At<'_, ()>| n += usize::from(at.enters_plan());
        scene.traverse(*view, Order::Pre, &Everything, visit).unwrap();
        let mut left = n / 2;
        let visit = &mut |at: &At<'_, ()>| {
            left = left.saturating_sub(usize::from(at.enters_plan()));
            if left > 0 {
                weld.meet(at);
            }
        };
        scene.traverse(*view, Order::Pre, &Everything, visit).unwrap();
    };
    half_walk(scene, &mut weld);
    assert!(!format!("{weld:?}").starts_with("0 meshes"), "{weld:?}");
    weld.clear();
    assert_eq!(format!("{weld:?}"), "0 meshes to be welded, 0 kept");
    let (list, report) = welded(scene, *view, &mut weld);
    assert_eq!((digest(&list), report), (digest(&fresh), all));
    // What was welded before the walk is kept.
    half_walk(scene, &mut weld);
    weld.clear();
    let (_, report) = welded(scene, *view, &mut weld);
    assert_eq!((report.n_welded, report.n_kept), (0, all.n_welded));
}

#[test]
fn what_offers_no_pieces_is_left_alone() {
    let mut tree = planted_in(Scene::new(), &sapling(), 1);
    let list = tree.draw_list();
    let (same, report) = welded(&mut tree.scene, tree.view, &mut WeldPieces::new());
    assert_eq!(report, PiecesReport::default());
    assert_eq!(digest(&same), digest(&list));
}
