//! What sweeps are held to: shape, counts, sharing and seams.

use std::collections::BTreeMap;
use std::f32::consts::{FRAC_PI_2, TAU};

use super::*;
use crate::Mesh;

fn rings(points: impl IntoIterator<Item = (Vec3, f32)>) -> Vec<Ring> {
    points.into_iter().map(|(center, radius)| Ring { center, radius }).collect()
}

/// A tube of 6 sides, closed at both ends.
fn closed(rings: &[Ring]) -> Mesh {
    swept(&Section::round(6), rings, &closed_options())
}

fn closed_options() -> SweepOptions {
    SweepOptions { base: Cap::Flat, tip: Cap::Flat, ..SweepOptions::default() }
}

fn swept(section: &Section, rings: &[Ring], options: &SweepOptions) -> Mesh {
    let mut mesh = Mesh::default();
    let mut sweep = Sweep::default();
    let n = sweep.lay(section, rings, options);
    sweep.write(section, &mut mesh);
    assert_eq!(mesh.n_triangles(), n, "the number told is the number written");
    check(&mesh);
    mesh
}

fn corners(mesh: &Mesh, triangle: &[u32]) -> [Vec3; 3] {
    [0, 1, 2].map(|i| mesh.positions[triangle[i] as usize])
}

/// No fault, and every normal lies on the outer side of the triangles around its vertex.
fn check(mesh: &Mesh) {
    assert_eq!(mesh.fault(), None);
    for triangle in mesh.indices.chunks_exact(3) {
        let [a, b, c] = corners(mesh, triangle);
        let face = (b - a).cross(c - a).normalize();
        for index in triangle {
            let normal = mesh.normals[*index as usize];
            assert!(face.dot(normal) > 0.0, "{face} {normal} at {a} {b} {c}");
        }
    }
}

/// The edges that have not exactly one triangle on either side, when vertices at equal
/// positions are one.
fn n_open_edges(mesh: &Mesh) -> usize {
    let key = |p: Vec3| p.to_array().map(|value| (value + 0.0).to_bits());
    let mut edges = BTreeMap::<_, (usize, usize)>::new();
    for triangle in mesh.indices.chunks_exact(3) {
        let corners = corners(mesh, triangle).map(key);
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            edges.entry((a, b)).or_default().0 += 1;
            edges.entry((b, a)).or_default().1 += 1;
        }
    }
    edges.values().filter(|counts| **counts != (1, 1)).count()
}

fn volume(mesh: &Mesh) -> f32 {
    let corners = mesh.indices.chunks_exact(3).map(|triangle| corners(mesh, triangle));
    corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

fn helix(turns: f32, n: usize) -> Vec<Ring> {
    rings((0..=n).map(|i| {
        let f = i as f32 / n as f32;
        let angle = TAU * turns * f;
        (Vec3::new(libm::cosf(angle), libm::sinf(angle), 3.0 * f), 0.2 * (1.0 - f))
    }))
}

#[test]
fn a_cylinder_is_closed_and_has_its_volume() {
    let mesh = closed(&rings([(Vec3::ZERO, 0.5), (Vec3::Z, 0.5), (Vec3::Z * 2.0, 0.5)]));
    assert_eq!((mesh.n_triangles(), n_open_edges(&mesh)), (36, 0));
    let hexagon = 6.0 * 0.5 * 0.25 * libm::sinf(TAU / 6.0);
    assert!((volume(&mesh) - 2.0 * hexagon).abs() < 1e-5);
    let side = mesh.normals.iter().filter(|n| n.z == 0.0).count();
    assert_eq!(side, 21);
}

#[test]
fn a_cone_ends_in_a_fan_whose_normals_lean_forward() {
    let mesh = closed(&rings([(Vec3::ZERO, 1.0), (Vec3::Z, 0.5), (Vec3::Z * 2.0, 0.0)]));
    assert_eq!((mesh.n_triangles(), n_open_edges(&mesh)), (6 + 12 + 6, 0));
    let expected = 1.0 / 5.0f32.sqrt();
    assert!(mesh.normals[7..].iter().all(|normal| (normal.z - expected).abs() < 1e-5));
    assert_eq!(mesh.bound().aabb.max.z, 2.0);
}

#[test]
fn a_tube_may_open_from_a_point_and_pinch_to_one() {
    let spheres = [0.0, 0.5, 0.0, 0.5, 0.0];
    let spheres = spheres.into_iter().enumerate();
    let mesh = closed(&rings(spheres.map(|(i, radius)| (Vec3::Z * i as f32, radius))));
    assert_eq!((mesh.n_triangles(), n_open_edges(&mesh)), (24, 0));
}

#[test]
fn a_ball_end_is_round() {
    let ball = (0..=10).map(|i| {
        let angle = FRAC_PI_2 * i as f32 / 10.0;
        (Vec3::Z * (1.0 + 0.3 * libm::sinf(angle)), 0.3 * libm::cosf(angle))
    });
    let tube = rings([(Vec3::ZERO, 0.3)].into_iter().chain(ball));
    let mesh = closed(&tube);
    assert_eq!(n_open_edges(&mesh), 0);
    for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
        if position.z > 1.05 {
            let outward = (*position - Vec3::Z).normalize();
            assert!(normal.dot(outward) > 0.9, "{position} {normal}");
        }
    }
}

#[test]
fn a_round_cap_adds_a_dome_and_a_flat_one_a_disc() {
    let tube = rings([(Vec3::ZERO, 0.5), (Vec3::Z, 0.4)]);
    let height = |tip| {
        let options = SweepOptions { tip, ..closed_options() };
        let mesh = swept(&Section::round(8), &tube, &options);
        assert_eq!(n_open_edges(&mesh), 0);
        mesh.bound().aabb.max.z
    };
    assert_eq!(height(Cap::Flat), 1.0);
    assert!((height(Cap::Round) - 1.4).abs() < 1e-6);
    let open = SweepOptions { tip: Cap::Open, ..SweepOptions::default() };
    let mesh = swept(&Section::round(8), &tube, &open);
    assert_eq!((mesh.n_triangles(), n_open_edges(&mesh)), (16, 2 * 2 * 8));
}

#[test]
fn sharp_bends_do_not_turn_the_tube_inside_out() {
    let corners = [Vec3::ZERO, Vec3::Z, Vec3::Z + Vec3::X, Vec3::new(1.0, 1.0, 1.0)];
    let mesh = closed(&rings(corners.map(|corner| (corner, 0.3))));
    assert_eq!(n_open_edges(&mesh), 0);
    assert!(volume(&mesh) > 0.0);
    // Straight back: no good tube exists, but the mesh stays whole.
    let back = rings([Vec3::ZERO, Vec3::Z, Vec3::ZERO].map(|corner| (corner, 0.1)));
    let (mut mesh, mut sweep) = (Mesh::default(), Sweep::default());
    sweep.lay(&Section::round(6), &back, &closed_options());
    sweep.write(&Section::round(6), &mut mesh);
    assert!(mesh.positions.iter().chain(&mesh.normals).all(|vector| vector.is_finite()));
}

#[test]
fn a_helix_is_closed() {
    let mesh = closed(&helix(4.0, 40));
    assert_eq!(n_open_edges(&mesh), 0);
}

#[test]
fn what_has_no_length_has_no_surface() {
    let at = |radii: &[f32]| rings(radii.iter().map(|radius| (Vec3::X, *radius)));
    for radii in [&[][..], &[1.0], &[1.0, 1.0, 1.0], &[0.0, 0.0]] {
        assert!(closed(&at(radii)).is_empty());
    }
    let line = rings([(Vec3::ZERO, 0.0), (Vec3::Z, 0.0)]);
    assert!(closed(&line).is_empty());
    // A step of the radius at one place is a flat annulus.
    let step = [(Vec3::ZERO, 1.0), (Vec3::Z, 1.0), (Vec3::Z, 0.5), (Vec3::Z * 2.0, 0.5)];
    assert_eq!(n_open_edges(&closed(&rings(step))), 0);
}

#[test]
fn coinciding_rings_are_left_out_and_keep_their_number() {
    let tube = rings([(Vec3::ZERO, 1.0), (Vec3::ZERO, 1.0), (Vec3::Z, 1.0), (Vec3::Y, 1.0)]);
    let mut sweep = Sweep::default();
    sweep.lay(&Section::round(6), &tube, &SweepOptions::default());
    assert_eq!(sweep.start_at(0), sweep.start_at(1));
    assert_ne!(sweep.start_at(1), sweep.start_at(2));
    assert!(sweep.start_at(3).is_some() && sweep.start_at(4).is_none());
}

#[test]
fn far_and_thin_tubes_are_not_degenerate() {
    for (far, thin) in [(13.0, 1e-5), (100.0, 1e-3), (0.0, 2e-6), (13.0, 0.3)] {
        let base = Vec3::splat(far);
        for length in [0.3, 0.01, 1e-4] {
            let way = Vec3::new(0.3, 0.5, 0.8).normalize() * length;
            let radii = [1.0, 0.7, 0.3, 0.1, 0.0].map(|factor| factor * thin);
            let tube = radii.into_iter().enumerate();
            let tube = rings(tube.map(|(i, radius)| (base + way * i as f32, radius)));
            let mesh = swept(&Section::round(8), &tube, &SweepOptions::default());
            assert_eq!(mesh.fault(), None);
        }
    }
}

#[test]
fn lobes_stand_where_the_first_ring_says() {
    let options = SweepOptions { start: SweepStart::toward(Vec3::Y), ..closed_options() };
    let tube = rings([(Vec3::ZERO, 1.0), (Vec3::Z, 0.8), (Vec3::Z * 2.0, 0.0)]);
    let mesh = swept(&Section::lobed(12, 3, 0.3), &tube, &options);
    assert_eq!(n_open_edges(&mesh), 0);
    let farthest = mesh.positions.iter().map(|p| p.truncate().length()).fold(0.0, f32::max);
    assert!((farthest - 1.3).abs() < 1e-5);
    // The first peak is a twelfth of a turn from the ring's x axis, here the y axis.
    let peak = Vec3::new(-0.5, 0.75f32.sqrt(), 0.0) * 1.3;
    assert!(mesh.positions.iter().any(|p| p.distance(peak) < 1e-5));
}

#[test]
fn the_texture_closes_around_and_keeps_its_proportions() {
    let tube = rings([(Vec3::ZERO, 1.0), (Vec3::Z, 1.0), (Vec3::Z * 2.0, 0.5)]);
    let options =
        SweepOptions { around: Around::Repeats(3), tip: Cap::Open, ..SweepOptions::default() };
    let mesh = swept(&Section::round(6), &tube, &options);
    for ring in 0..3 {
        let (first, last) = (ring * 7, ring * 7 + 6);
        assert_eq!(mesh.positions[first], mesh.positions[last]);
        assert_eq!(mesh.uvs[last] - mesh.uvs[first], Vec2::new(3.0, 0.0));
    }
    let tile = TAU / 3.0;
    assert!((mesh.uvs[7].y + 1.0 / tile).abs() < 1e-5);
    assert!((mesh.uvs[14].y - mesh.uvs[7].y + 1.0 / (0.75 * tile)).abs() < 1e-5);
}

#[test]
fn a_mirrored_texture_closes_around_and_keeps_its_size() {
    let tube = rings([(Vec3::ZERO, 0.02), (Vec3::Z, 0.02), (Vec3::Z * 2.0, 0.01)]);
    let start = SweepStart { u: 0.3, v: 5.0, ..SweepStart::toward(Vec3::X) };
    let around = Around::Mirrored { width: 0.5 };
    let options = SweepOptions { start, around, tip: Cap::Open, ..SweepOptions::default() };
    let mesh = swept(&Section::round(6), &tube, &options);
    for (ring, radius) in [0.02, 0.02, 0.01].into_iter().enumerate() {
        let uvs = &mesh.uvs[7 * ring..7 * ring + 7];
        assert_eq!(uvs[0], uvs[6]);
        assert_eq!(uvs[1], uvs[5]);
        let far = 0.3 + 0.5 * TAU * radius / 0.5;
        assert!((uvs[3].x - far).abs() < 1e-6 && uvs[0].x == 0.3, "{uvs:?}");
        assert!((uvs[0].y - (5.0 - 2.0 * ring as f32)).abs() < 1e-5, "{uvs:?}");
    }
    let mesh = swept(&Section::round(3), &tube, &options);
    let us: Vec<f32> = mesh.uvs[..4].iter().map(|uv| uv.x).collect();
    assert!(us[0] == us[3] && us[1] > us[2] && us[2] > us[0], "no side has one u: {us:?}");
}

#[test]
fn frames_do_not_twist() {
    // In a plane, what is square to the plane stays so.
    let arc = (0..=12).map(|i| {
        let angle = 0.4 * i as f32;
        (Vec3::new(0.0, libm::cosf(angle), libm::sinf(angle)), 0.1)
    });
    let mut sweep = Sweep::default();
    sweep.lay(&Section::round(6), &rings(arc), &SweepOptions::default());
    assert!((0..=12).all(|i| sweep.start_at(i).unwrap().x.dot(Vec3::X) > 1.0 - 1e-6));
    // In space, the shortest turn between tangents leaves no turn about the tangent.
    let helix = helix(2.0, 200);
    sweep.lay(&Section::round(6), &helix, &SweepOptions::default());
    for i in 0..200 {
        let [from, to] = [i, i + 1].map(|i| sweep.start_at(i).unwrap());
        let [before, after] = [from, to].map(|frame| frame.tangent.unwrap());
        let carried = carry(from.x, before, after);
        let twist = carried.cross(to.x).dot(after);
        assert!(twist.abs() < 1e-3, "{twist} at {i}");
    }
}

#[test]
fn a_tube_that_continues_another_begins_with_its_ring() {
    let tube = rings((0..5).map(|i| (Vec3::new(0.1 * (i * i) as f32, 0.0, i as f32), 0.3)));
    let section = Section::round(6);
    let (mut mesh, mut sweep) = (Mesh::default(), Sweep::default());
    let turned = SweepStart::toward(Vec3::new(1.0, 1.0, 0.0));
    sweep.lay(&section, &tube, &SweepOptions { start: turned, ..SweepOptions::default() });
    sweep.write(&section, &mut mesh);
    let start = sweep.start_at(2).unwrap();
    let clone = rings([(tube[2].center, 0.3), (tube[2].center + Vec3::new(-0.5, 0.0, 1.0), 0.2)]);
    let n_before = mesh.n_vertices();
    sweep.lay(&section, &clone, &SweepOptions { start, ..SweepOptions::default() });
    sweep.write(&section, &mut mesh);
    assert_eq!(mesh.positions[n_before..n_before + 7], mesh.positions[14..21]);
    assert_eq!(mesh.uvs[n_before..n_before + 7], mesh.uvs[14..21]);
    check(&mesh);
}
