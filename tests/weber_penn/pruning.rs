//! Trees under envelopes: what stays inside, what stays the same, and what is compiled again.

use std::convert::Infallible;

use sapwood::geom::glam::{Affine3, Vec2, Vec3};
use sapwood::geom::{
    Aabb, ClosedMesh, Envelope, FixedMap, FixedSet, Mesh, Sphere, StreamPath, fixed_state,
};
use sapwood::rules::weber_penn::{
    Crown, Level, Limit, PruneRatioSlot, Segment, Species, Stem, StemSeed, Stems, Target,
    TrunkForm, children, fit, grow, trunks,
};
use sapwood::scene::{Budget, EnvelopeSlot};

use super::trees::*;

fn free(_: usize) -> Result<(), Infallible> {
    Ok(())
}

/// The stems of a tree, level by level, and which of them were shortened or grow on such.
struct Pruned {
    levels: Vec<Stems>,
    touched: FixedSet<StreamPath>,
    n_shortened: usize,
    n_given_up: usize,
}

/// Grows all levels, under limits.
fn pruned(species: &Species, seed: u64, limits: &[Limit]) -> Pruned {
    let (crown, levels) = (Crown::new(species), Level::all(species));
    let form = TrunkForm::new(species);
    let Ok(mut seeds) = trunks(&crown, &levels[0], StreamPath::new(seed), &mut free);
    let mut grown = Pruned {
        levels: Vec::new(),
        touched: FixedSet::with_hasher(fixed_state()),
        n_shortened: 0,
        n_given_up: 0,
    };
    for n in 0..species.levels as usize {
        let level = &levels[n.min(3)];
        if !limits.is_empty() {
            let Ok(shares) = fit(&seeds, &crown, level, &Target::Up, limits, &mut free);
            let both = seeds.iter().zip(shares);
            let fitted = both.filter_map(|(seed, share)| {
                let shorter = seed.shortened(share, &crown);
                if share < 1.0 {
                    grown.touched.insert(seed.path);
                    grown.n_shortened += 1;
                    grown.n_given_up += usize::from(shorter.is_none());
                }
                shorter
            });
            seeds = fitted.collect();
        }
        let Ok(stems) = grow(&seeds, &crown, level, &Target::Up, &mut free);
        // A clone is shortened with the stem that it split from.
        for stem in &stems.stems {
            if grown.touched.contains(&seeds[stem.seed_index as usize].path) {
                grown.touched.insert(stem.seed.path);
            }
        }
        if n + 1 < species.levels as usize {
            let form = (n == 0).then_some(&form);
            let Ok(next) = children(&stems, &crown, form, &levels[(n + 1).min(3)], &mut free);
            seeds = next;
            grown.touch_children(&stems, &seeds);
        }
        grown.levels.push(stems);
    }
    grown
}

impl Pruned {
    /// Touches what grows on something that was touched. Children come in the order of their
    /// parents, and their paths tell how many of them there were before, grown or not.
    fn touch_children(&mut self, stems: &Stems, children: &[StemSeed]) {
        let mut children = children.iter().peekable();
        for stem in &stems.stems {
            let mut key = 0;
            while let Some(child) = children.peek() {
                let of_this = |key: u64| stem.seed.path.child(key) == child.path;
                let Some(found) = (key..key + 200).find(|key| of_this(*key)) else { break };
                key = found + 1;
                if self.touched.contains(&stem.seed.path) {
                    self.touched.insert(child.path);
                }
                children.next();
            }
        }
        assert_eq!(children.next(), None);
    }

    /// The stems that nothing touched, with their segments as they count them from 0.
    fn untouched(&self) -> FixedMap<StreamPath, (Stem, Vec<Segment>)> {
        let mut rows = FixedMap::with_hasher(fixed_state());
        for stems in &self.levels {
            for (i, stem) in stems.stems.iter().enumerate() {
                if !self.touched.contains(&stem.seed.path) {
                    rows.insert(stem.seed.path, anywhere(*stem, stems.segments_of(i)));
                }
            }
        }
        rows
    }
}

/// A stem as it is wherever it stands in its batch.
fn anywhere(stem: Stem, segments: &[Segment]) -> (Stem, Vec<Segment>) {
    let clone_of = stem.clone_of.map(|_| 0);
    let segments = segments.iter().map(|segment| Segment { stem: 0, ..*segment }).collect();
    (Stem { seed_index: 0, first_segment: 0, clone_of, ..stem }, segments)
}

/// An icosahedron-like hull: a sphere of few triangles, stretched.
fn hull(center: Vec3, size: Vec3) -> Mesh {
    let mut mesh = Mesh::default();
    let (n_around, n_up) = (9u32, 5u32);
    for i in 0..=n_up {
        let up = std::f32::consts::PI * i as f32 / n_up as f32;
        for k in 0..n_around {
            let around = std::f32::consts::TAU * k as f32 / n_around as f32;
            let at = Vec3::new(up.sin() * around.cos(), up.sin() * around.sin(), -up.cos());
            mesh.positions.push(center + size * at);
            mesh.normals.push(at);
            mesh.uvs.push(Vec2::ZERO);
        }
    }
    for i in 0..n_up {
        for k in 0..n_around {
            let at = |i: u32, k: u32| i * n_around + k % n_around;
            let corners = [at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)];
            if i > 0 {
                mesh.indices.extend([corners[0], corners[1], corners[2]]);
            }
            if i + 1 < n_up {
                mesh.indices.extend([corners[0], corners[2], corners[3]]);
            }
        }
    }
    mesh
}

/// Six envelopes for a tree of this size in metres, by name: all leave part of it outside.
fn envelopes(size: f32) -> [(&'static str, Envelope); 6] {
    let crown = Sphere { center: Vec3::Z * 0.6 * size, radius: 0.22 * size };
    let hull = hull(Vec3::new(0.05, 0.0, 0.5) * size, Vec3::new(0.2, 0.25, 0.5) * size);
    let small = Aabb { min: Vec3::splat(-0.15 * size), max: Vec3::splat(0.8 * size) };
    let notch = Sphere { center: Vec3::new(0.2, 0.0, 0.6) * size, radius: 0.15 * size };
    let turned = Affine3::from_rotation_x(0.7) * Affine3::from_rotation_y(0.4);
    let slab =
        Aabb { min: Vec3::new(-1.0, -0.1, -1.0) * size, max: Vec3::new(1.0, 0.1, 2.0) * size };
    [
        ("sphere", Envelope::sphere(crown)),
        ("box", Envelope::aabb(small)),
        ("half-space", Envelope::half_space(Vec3::new(1.0, 0.0, 0.2), 0.15 * size)),
        ("mesh", Envelope::mesh(ClosedMesh::new(&hull).unwrap())),
        (
            "box with a notch",
            Envelope::intersection([Envelope::aabb(small), Envelope::sphere(notch).complement()]),
        ),
        (
            "slab and sphere",
            Envelope::union([
                Envelope::placed(turned, Envelope::aabb(slab)),
                Envelope::sphere(crown),
            ]),
        ),
    ]
}

/// Whether every segment of level 1 and deeper ends inside, and the trunk ends where it leaves.
fn assert_inside(tree: &Pruned, envelope: &Envelope, what: &str) {
    for stems in &tree.levels[1..] {
        for segment in &stems.segments {
            assert!(envelope.contains(segment.end()), "{what}: {segment:?}");
        }
    }
    let trunks = &tree.levels[0];
    for (i, stem) in trunks.stems.iter().enumerate() {
        let foot = (stem.clone_of.is_none()).then_some(stem.seed.frame.origin);
        let ends = trunks.segments_of(i).iter().map(Segment::end);
        let inside: Vec<bool> =
            foot.into_iter().chain(ends).map(|p| envelope.contains(p)).collect();
        assert!(inside.is_sorted(), "{what}: trunk {i} {inside:?}");
    }
}

#[test]
fn no_segment_leaves_an_envelope_and_what_is_not_cut_stays_the_same() {
    for name in published() {
        let mut species = built_in(name);
        species.pruning.ratio = 0.0;
        let mut n_shortened = 0;
        for seed in 0..16 {
            let size = 0.8 * species.scale;
            let whole = pruned(&species, seed, &[]).untouched();
            for (shape, envelope) in envelopes(size) {
                let limit = Limit::new(envelope.clone(), 1.0);
                let tree = pruned(&species, seed, &[limit]);
                let what = format!("{name} {seed} in a {shape}");
                assert_inside(&tree, &envelope, &what);
                for (path, stem) in tree.untouched() {
                    assert_eq!(whole.get(&path), Some(&stem), "{what}");
                }
                n_shortened += tree.n_shortened;
            }
        }
        assert!(n_shortened > 96, "{name}: only {n_shortened} stems were cut");
    }
}

#[test]
fn what_one_envelope_shortens_does_not_leave_another() {
    // A stem may reach through the notch of the first one, and a wall then end it in the notch.
    let mut aspen = built_in("quaking_aspen");
    aspen.pruning.ratio = 0.0;
    let size = 0.8 * aspen.scale;
    let notch = Sphere { center: Vec3::new(0.16, 0.0, 0.55) * size, radius: 0.1 * size };
    let notched = Envelope::sphere(notch).complement();
    let wall = Envelope::half_space(Vec3::X, 0.17 * size);
    let limits = [&notched, &wall].map(|envelope| Limit::new(envelope.clone(), 1.0));
    let is_inside = |segment: &Segment| {
        [&notched, &wall].iter().all(|envelope| envelope.contains(segment.end()))
    };
    for seed in 0..16 {
        let tree = pruned(&aspen, seed, &limits);
        assert!(tree.n_shortened > 0);
        for segment in tree.levels[1..].iter().flat_map(|stems| &stems.segments) {
            assert!(is_inside(segment), "{seed}: {segment:?}");
        }
    }
}

#[test]
fn a_limit_that_gives_comes_before_one_that_does_not() {
    let aspen = built_in("quaking_aspen");
    let size = 0.8 * aspen.scale;
    let [(_, small), .., (_, _)] = envelopes(size);
    let wall = Envelope::half_space(Vec3::X, 0.1 * size);
    let (soft, firm) = (Limit::new(small, 0.5), Limit::new(wall.clone(), 1.0));
    let both = pruned(&aspen, 3, &[firm.clone(), soft.clone()]);
    assert_eq!(both.levels, pruned(&aspen, 3, &[soft, firm.clone()]).levels);
    assert_ne!(both.levels, pruned(&aspen, 3, &[firm]).levels);
    for segment in both.levels[1..].iter().flat_map(|stems| &stems.segments) {
        assert!(wall.contains(segment.end()), "{segment:?}");
    }
}

#[test]
fn stems_that_fit_stay_however_short_they_are() {
    let mut aspen = built_in("quaking_aspen");
    aspen.level[2].length = 0.002;
    let everything = Envelope::sphere(Sphere { center: Vec3::ZERO, radius: 1e3 });
    for ratio in [0.5, 1.0] {
        let limit = Limit::new(everything.clone(), ratio);
        let (whole, held) = (pruned(&aspen, 5, &[]), pruned(&aspen, 5, &[limit]));
        let is_short = |stem: &Stem| stem.seed.length < 0.001 * stem.seed.scale_tree;
        assert!(whole.levels[2].stems.iter().any(is_short));
        assert!(whole.levels == held.levels);
    }
}

#[test]
fn the_papers_envelope_holds_the_crown() {
    for name in published() {
        let mut species = built_in(name);
        species.pruning.ratio = 1.0;
        let crown = Crown::new(&species);
        for seed in 0..4 {
            let size = pruned(&species, seed, &[]).levels[0].stems[0].seed.scale_tree;
            let limit = Limit::of_species(&crown, size).unwrap();
            let tree = pruned(&species, seed, &[limit]);
            let whole = pruned(&species, seed, &[]);
            assert_eq!(tree.levels[0], whole.levels[0], "{name}: trunks are not held");
            for segment in tree.levels[1..].iter().flat_map(|stems| &stems.segments) {
                let end = segment.end();
                let across = end.truncate().length() / size;
                let ratio = (size - end.z) / (size * (1.0 - species.base_size));
                assert!((0.0..=1.000_01).contains(&ratio), "{name}: {segment:?}");
                // At the very bottom a rounding decides.
                let ratio = ratio.min(0.999_99);
                let pruning = &species.pruning;
                let peak = 1.0 - pruning.width_peak;
                let profile = if ratio < peak {
                    (ratio / peak).powf(pruning.power_high)
                } else {
                    ((1.0 - ratio) / (1.0 - peak)).powf(pruning.power_low)
                };
                assert!(across <= pruning.width * profile * 1.000_1, "{name}: {segment:?}");
            }
        }
    }
}

#[test]
fn a_ratio_between_takes_back_its_share_of_what_does_not_fit() {
    let aspen = built_in("quaking_aspen");
    let (crown, levels) = (Crown::new(&aspen), Level::all(&aspen));
    let Ok(trunk) = trunks(&crown, &levels[0], StreamPath::new(3), &mut free);
    let Ok(stems) = grow(&trunk, &crown, &levels[0], &Target::Up, &mut free);
    let form = TrunkForm::new(&aspen);
    let Ok(limbs) = children(&stems, &crown, Some(&form), &levels[1], &mut free);
    let [(_, envelope), ..] = envelopes(aspen.scale);
    let shares = |ratio| {
        let limit = Limit::new(envelope.clone(), ratio);
        let Ok(shares) = fit(&limbs, &crown, &levels[1], &Target::Up, &[limit], &mut free);
        shares
    };
    let (full, half, none) = (shares(1.0), shares(0.5), shares(0.0));
    assert!(full.iter().any(|share| (0.01..0.9).contains(share)), "{full:?}");
    for ((full, half), none) in full.iter().zip(half).zip(none) {
        assert_eq!((half, none), (1.0 - (1.0 - full) * 0.5, 1.0));
    }
    // What is shorter is thinner, by the paper's formula.
    for (limb, share) in limbs.iter().zip(&full) {
        let Some(shorter) = limb.shortened(*share, &crown) else { continue };
        let ratio = shorter.length / limb.parent_length;
        let free = trunk[0].radius * ratio.powf(aspen.ratio_power);
        let expected = free.min(limb.parent_radius);
        assert!((shorter.radius - expected).abs() <= 1e-4 * expected, "{shorter:?}");
    }
}

#[test]
fn stems_that_turn_to_a_point_are_held_too() {
    let mut aspen = built_in("quaking_aspen");
    aspen.attraction_up = 1.0;
    let (crown, levels) = (Crown::new(&aspen), Level::all(&aspen));
    let tree = pruned(&aspen, 2, &[]);
    let seeds: Vec<StemSeed> = tree.levels[2].stems.iter().map(|stem| stem.seed).collect();
    let target = Target::Point(Vec3::new(3.0, 0.0, 2.0));
    for (shape, envelope) in envelopes(aspen.scale) {
        let limit = Limit::new(envelope.clone(), 1.0);
        let Ok(shares) = fit(&seeds, &crown, &levels[2], &target, &[limit], &mut free);
        let fitted: Vec<StemSeed> = seeds
            .iter()
            .zip(&shares)
            .filter_map(|(s, share)| s.shortened(*share, &crown))
            .collect();
        assert!(fitted.len() > 20 && fitted.len() < seeds.len(), "{shape}");
        let Ok(stems) = grow(&fitted, &crown, &levels[2], &target, &mut free);
        for segment in &stems.segments {
            assert!(envelope.contains(segment.end()), "{shape}: {segment:?}");
        }
    }
}

/// An aspen of the tests under an envelope in the world, where y is up.
fn under(envelope: Envelope) -> Grown {
    let mut aspen = planted(&built_in("quaking_aspen"), 1);
    aspen.hold(envelope);
    aspen
}

impl Grown {
    fn hold(&mut self, envelope: Envelope) {
        self.scene
            .edit(self.family, |attribute| attribute.set::<EnvelopeSlot>(Some(envelope)))
            .unwrap();
    }
}

/// A sphere around the middle of the crown, moved aside.
fn crown_sphere(radius: f32, aside: f32) -> Envelope {
    Envelope::sphere(Sphere { center: Vec3::new(aside, 8.0, 0.0), radius })
}

#[test]
fn a_far_envelope_costs_nothing_and_changes_nothing() {
    let mut free = grown(&built_in("quaking_aspen"), 1);
    let mut held = under(crown_sphere(100.0, 0.0));
    let cold = planted(&built_in("quaking_aspen"), 1).compiled();
    assert_eq!(held.compiled(), cold);
    assert_eq!(digest(&held.draw_list()), digest(&free.draw_list()));
    held.hold(crown_sphere(100.0, 5.0));
    assert_eq!(held.compiled(), [("attribute", 1)]);
    assert_eq!(digest(&held.draw_list()), digest(&free.draw_list()));
}

#[test]
fn moving_an_envelope_grows_the_branches_again_that_it_answers_otherwise() {
    let wall = |x| Envelope::half_space(Vec3::X, x);
    let mut aspen = under(wall(1.5));
    aspen.compiled();
    let before = lengths(&mut aspen);
    aspen.hold(wall(1.4));
    let compiled = aspen.compiled();
    let after = lengths(&mut aspen);
    let mut paths: FixedSet<StreamPath> = FixedSet::with_hasher(fixed_state());
    paths.extend(before.keys().chain(after.keys()));
    let changed = paths.iter().filter(|path| before.get(path) != after.get(path)).count();
    let branches = compiled.iter().find(|(kind, _)| *kind == "branch").map_or(0, |(_, n)| *n);
    assert!(changed > 0 && branches == changed, "{changed} of {}, {compiled:?}", after.len());
    assert!(branches < after.len() / 2, "{branches} of {}", after.len());
    assert!(!compiled.iter().any(|(kind, _)| ["tree", "painted_material"].contains(kind)));
    let mut anew = under(wall(1.4));
    assert_eq!(digest(&aspen.draw_list()), digest(&anew.draw_list()));
}

/// The lengths of trunk and limbs, by path.
fn lengths(aspen: &mut Grown) -> FixedMap<StreamPath, f32> {
    let parts = aspen.parts();
    let stems = parts.stems[..2].iter().flatten();
    let own = stems.filter(|stem| stem.clone_of.is_none());
    let mut lengths = FixedMap::with_hasher(fixed_state());
    lengths.extend(own.map(|stem| (stem.seed.path, stem.seed.length)));
    lengths
}

#[test]
fn trials_keep_to_the_budget_of_the_view() {
    let mut aspen = under(crown_sphere(2.0, 0.0));
    let few = Budget { parts: 60, ..Budget::default() };
    aspen.scene.set_budget(aspen.view, few).unwrap();
    let error = aspen.scene.bounds(aspen.view).unwrap_err();
    assert!(error.to_string().contains("60 parts"), "{error}");
    // Nothing of that is remembered.
    aspen.scene.set_budget(aspen.view, Budget::default()).unwrap();
    let mut anew = under(crown_sphere(2.0, 0.0));
    assert_eq!(digest(&aspen.draw_list()), digest(&anew.draw_list()));
    assert_eq!(aspen.scene.diagnostics(aspen.view, 10).unwrap(), []);
}

#[test]
fn a_ratio_of_0_lets_go() {
    let mut free = grown(&built_in("quaking_aspen"), 1);
    let mut aspen = under(crown_sphere(3.5, 0.0));
    assert_ne!(digest(&aspen.draw_list()), digest(&free.draw_list()));
    aspen.scene.edit(aspen.family, |family| family.set::<PruneRatioSlot>(0.0)).unwrap();
    assert_eq!(digest(&aspen.draw_list()), digest(&free.draw_list()));
}
