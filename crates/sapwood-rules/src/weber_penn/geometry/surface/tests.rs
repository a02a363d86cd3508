//! Surfaces of whole trees, and of stems made to measure.

use std::convert::Infallible;

use glam::Vec3;
use sapwood_geom::StreamPath;

use super::*;
use crate::weber_penn::{Crown, Level, Species, Target, children, grow, trunks};

fn free(_: usize) -> Result<(), Infallible> {
    Ok(())
}

/// The stems of levels 0 and up, one batch for each level.
fn grown(species: &Species) -> Vec<Stems> {
    let (crown, levels) = (Crown::new(species), Level::all(species));
    let form = TrunkForm::new(species);
    let Ok(mut seeds) = trunks(&crown, &levels[0], StreamPath::new(5), &mut free);
    let mut grown = Vec::new();
    for n in 0..species.levels as usize {
        let Ok(stems) = grow(&seeds, &crown, &levels[n], &Target::Up, &mut free);
        if n + 1 < species.levels as usize {
            let form = (n == 0).then_some(&form);
            let Ok(next) = children(&stems, &crown, form, &levels[n + 1], &mut free);
            seeds = next;
        }
        grown.push(stems);
    }
    grown
}

/// The surface of all levels' stems, checked for faults and for normals that do not agree
/// with the triangles beside them.
fn checked(species: &Species, detail: &Detail) -> Vec<Mesh> {
    let form = TrunkForm::new(species);
    let meshes = grown(species).into_iter().map(|stems| {
        let Ok(mesh) = surface(&stems, &form, detail, 0.5, free);
        assert_eq!(mesh.fault(), None);
        for t in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize]);
            let face = (b - a).cross(c - a).normalize();
            let agree = t.iter().all(|i| face.dot(mesh.normals[*i as usize]) > 0.0);
            assert!(agree, "{a} {b} {c}");
        }
        mesh
    });
    meshes.collect()
}

/// A trunk 8 m tall with a base radius of 0.4 m and four segments; no branches, no flare.
fn bare(taper: f32) -> Species {
    let mut species = Species { levels: 1, scale: 8.0, flare: 0.0, ..Species::default() };
    species.level[0].curve_res = 4;
    species.level[0].taper = taper;
    species
}

/// An aspen's three levels.
fn aspen() -> Species {
    let mut species = Species { levels: 3, scale: 13.0, ratio: 0.015, ..Species::default() };
    (species.ratio_power, species.base_size, species.flare) = (1.2, 0.4, 0.6);
    (species.lobes, species.lobe_depth) = (5, 0.07);
    let branching = [(60.0, 50, 0.3, 5, -40.0, 50.0), (45.0, 30, 0.6, 3, -40.0, 75.0)];
    for (level, (down_angle, branches, length, curve_res, curve, curve_v)) in
        species.level[1..].iter_mut().zip(branching)
    {
        (level.down_angle, level.rotate, level.branches) = (down_angle, 140.0, branches);
        (level.length, level.curve_res) = (length, curve_res);
        (level.curve, level.curve_v) = (curve, curve_v);
    }
    (species.level[0].curve_res, species.level[0].curve_v) = (3, 20.0);
    species
}

/// Every vertex of an upright trunk is as far from its axis as taper, flare and lobes say.
fn check_radii(species: &Species) -> Mesh {
    let stems = grown(species).remove(0);
    let form = TrunkForm::new(species);
    let mesh = checked(species, &Detail::default()).remove(0);
    let stem = &stems.stems[0];
    assert!((mesh.bound().aabb.max.z - stem.seed.length).abs() < 1e-4);
    for position in &mesh.positions {
        let around = position.truncate();
        if around.length() < 1e-6 {
            continue;
        }
        let z = position.z / stem.seed.length;
        let angle = libm::atan2f(around.y, around.x);
        let radius = stem.radius_at(z) * form.factor(z) * form.lobe_factor(angle);
        assert!((around.length() - radius).abs() < 2e-3, "{position}: {radius}");
    }
    mesh
}

/// Whether some vertex is at this height and this far from the axis.
fn has_vertex(mesh: &Mesh, height: f32, radius: f32) -> bool {
    mesh.positions
        .iter()
        .any(|p| (p.z - height).abs() < 1e-3 && (p.truncate().length() - radius).abs() < 1e-3)
}

#[test]
fn radii_follow_taper_flare_and_lobes() {
    for taper in [0.0, 0.5, 1.0, 1.03, 1.5, 2.0, 2.1, 2.9] {
        check_radii(&bare(taper));
        check_radii(&Species { flare: 0.6, lobes: 5, lobe_depth: 0.2, ..bare(taper) });
    }
}

#[test]
fn the_flared_foot_has_its_radius() {
    let mesh = check_radii(&Species { flare: 0.6, ..bare(1.0) });
    assert!(has_vertex(&mesh, 0.0, 0.4 * 1.594));
    assert!(has_vertex(&mesh, 1.0, 0.4 * 0.875));
}

#[test]
fn bumps_have_rings_at_pinches_and_widest_places() {
    let mesh = check_radii(&bare(2.1));
    for bump in 1..9 {
        let pinch = 8.0 - 0.8 * bump as f32;
        assert!(has_vertex(&mesh, pinch, 0.4 * 0.9), "{bump}");
        assert!(has_vertex(&mesh, pinch - 0.4, 0.4), "{bump}");
    }
}

#[test]
fn a_ball_end_has_rings_on_its_quarter_circle() {
    let mesh = check_radii(&bare(2.0));
    assert!(has_vertex(&mesh, 7.6, 0.4));
    assert!(has_vertex(&mesh, 7.8, 0.4 * 0.75f32.sqrt()));
}

#[test]
fn too_many_bumps_get_even_steps() {
    let n = |ratio| checked(&Species { ratio, ..bare(2.2) }, &Detail::default())[0].n_triangles();
    assert!(n(1e-4) < 2 * n(0.01), "{} {}", n(1e-4), n(0.01));
}

#[test]
fn whole_trees_are_sound_at_every_detail() {
    let mut aspen = aspen();
    let mut n = Vec::new();
    for sides in [0.1, 1.0, 2.5] {
        let detail = Detail { sides, rings: sides, ..Detail::default() };
        n.push(checked(&aspen, &detail).iter().map(Mesh::n_triangles).sum::<usize>());
    }
    assert!(n[0] < n[1] && n[1] < n[2], "{n:?}");
    assert!((20_000..40_000).contains(&n[1]), "{n:?}");
    let draft: usize = checked(&aspen, &Detail::draft()).iter().map(Mesh::n_triangles).sum();
    assert!(3 * draft < n[1], "{draft} {n:?}");
    // Splitting, winding branches with ball ends.
    for level in &mut aspen.level {
        (level.seg_splits, level.split_angle, level.taper) = (0.4, 30.0, 1.1);
    }
    (aspen.trunk.base_splits, aspen.level[2].curve_v) = (2, -30.0);
    for detail in [Detail::default(), Detail::draft(), Detail { ends: 0.4, ..Detail::default() }] {
        checked(&aspen, &detail);
    }
}

#[test]
fn rings_are_left_out_evenly_from_level_2_on() {
    let kept = |ends, level| {
        let detail = Detail { ends, ..Detail::default() };
        (0..6).filter(|i| detail.has_ring(level, *i, 6)).collect::<Vec<_>>()
    };
    assert_eq!(kept(1.0, 2), [0, 1, 2, 3, 4, 5]);
    assert_eq!(kept(0.5, 2), [1, 3, 5]);
    assert_eq!(kept(0.0, 3), [5]);
    assert_eq!(kept(0.0, 1), [0, 1, 2, 3, 4, 5]);
}

#[test]
fn a_helix_winds_round_its_axis() {
    let mut species = Species { ratio: 0.005, ..bare(0.0) };
    species.level[0].curve_v = -30.0;
    let stems = grown(&species).remove(0);
    let mesh = checked(&species, &Detail::default()).remove(0);
    let helix = stems.stems[0].helix_radius;
    assert!(helix > 0.1);
    // Half a turn up the first segment the centre line is two radii from where it began.
    let across = -2.0 * helix * stems.segments[0].frame.axes.x_axis;
    let opposite = stems.segments[0].frame.point(Vec3::Z) + across;
    assert!(mesh.positions.iter().any(|p| (p.distance(opposite) - 0.04).abs() < 2e-3));
}

#[test]
fn clones_share_the_ring_they_split_from_and_do_not_twist() {
    let mut species = Species { lobes: 3, lobe_depth: 0.2, ..bare(0.5) };
    (species.trunk.base_splits, species.level[0].split_angle) = (2, 20.0);
    (species.level[0].seg_splits, species.level[0].curve_v) = (1.0, 30.0);
    let stems = grown(&species).remove(0);
    let mut n_triangles = Vec::new();
    let charge = |n| {
        n_triangles.push(n);
        Ok::<(), Infallible>(())
    };
    let Ok(mesh) = surface(&stems, &TrunkForm::new(&species), &Detail::default(), 0.5, charge);
    assert_eq!(mesh.fault(), None);
    assert_eq!(n_triangles.iter().sum::<usize>(), mesh.n_triangles());
    assert!(stems.stems.len() > 6);
    // Every trunk is closed, its clones with it.
    assert_eq!(mesh.n_open_edges(), 0);
    let (mut first_index, mut earlier) = (0, 0);
    for (stem, n) in stems.stems.iter().zip(&n_triangles) {
        let indices = &mesh.indices[first_index..first_index + 3 * n];
        first_index += 3 * n;
        if stem.clone_of.is_some() {
            let ring = 12;
            let foot: Vec<u32> = indices.iter().copied().filter(|i| *i < earlier).collect();
            assert!(foot.len() >= 9, "{foot:?}");
            // The ring's sides that the clone keeps, from each foot to the place above it.
            let onward = stems.segments[stem.first_segment as usize].frame.axes.z_axis;
            for side in indices[..6 * ring].chunks_exact(3).filter(|t| t[1] < earlier) {
                let [a, _, up] = [side[0], side[1], side[2]].map(|i| mesh.positions[i as usize]);
                if side[0] < earlier {
                    // Without twist a seam leans less than the split's angle and the bend allow.
                    assert!((up - a).normalize().dot(onward) > 0.9, "{a} {up}");
                }
            }
        }
        earlier = earlier.max(indices.iter().max().map_or(0, |last| last + 1));
    }
}

#[test]
fn a_refused_stem_ends_the_work() {
    let aspen = aspen();
    let stems = &grown(&aspen)[1];
    let mut asked = 0;
    let result = surface(stems, &TrunkForm::new(&aspen), &Detail::default(), 0.5, |n| {
        asked += n;
        if asked > 500 { Err(asked) } else { Ok(()) }
    });
    assert!(result.is_err_and(|asked| asked > 500 && asked < 600));
}

#[test]
fn bark_keeps_its_size_on_thick_and_thin_stems() {
    let aspen = aspen();
    let stems = grown(&aspen);
    let mut n_mirrored = 0;
    for batch in &stems {
        let form = TrunkForm::new(&Species::default());
        let Ok(mesh) = surface(batch, &form, &Detail::default(), 0.5, free);
        for t in mesh.indices.chunks_exact(3) {
            // Along a side, where the texture's v runs, unless the stem tapers to a point.
            let [a, b] = [t[0] as usize, t[2] as usize];
            let metres = mesh.positions[a].distance(mesh.positions[b]);
            let texture = (mesh.uvs[a] - mesh.uvs[b]).abs();
            if texture.x < 1e-6 && texture.y > 0.0 && batch.stems[0].seed.level > 1 {
                n_mirrored += 1;
                let width = metres / texture.y;
                assert!((0.45..0.55).contains(&width), "{width} m on level 2");
            }
        }
    }
    assert!(n_mirrored > 1000, "{n_mirrored}");
    let [one, two] = [Vec3::X, Vec3::new(1.0, 0.01, 0.0)].map(place_on_bark);
    assert!(one != two && one == place_on_bark(Vec3::X));
}

#[test]
fn the_foot_is_closed_on_request() {
    let n = |closed_foot| {
        let detail = Detail { closed_foot, ..Detail::default() };
        checked(&bare(1.0), &detail)[0].n_triangles()
    };
    assert_eq!(n(true) - n(false), 12);
}
