//! Envelopes against what they are known to be, and what they are sure of against points.

use glam::{Affine3, DVec3, Quat, Vec2, Vec3};

use super::triangle::Triangle;
use super::*;
use crate::shapes::{cube, sphere};
use crate::{Digest, Mesh, Purpose, Stream, StreamPath};

fn stream(seed: u64) -> Stream {
    Stream::new(StreamPath::new(seed), Purpose("envelope"))
}

fn point_in(aabb: &Aabb, stream: &mut Stream) -> Vec3 {
    Vec3::from_array([0, 1, 2].map(|axis| stream.between(aabb.min[axis], aabb.max[axis])))
}

/// A ring about the z axis.
fn torus(major: f32, minor: f32, n: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..n {
        for j in 0..n {
            let [u, v] = [i, j].map(|k| std::f32::consts::TAU * k as f32 / n as f32);
            let out = Vec3::new(u.cos(), u.sin(), 0.0);
            let normal = out * v.cos() + Vec3::Z * v.sin();
            mesh.positions.push(out * major + normal * minor);
            mesh.normals.push(normal);
            mesh.uvs.push(Vec2::ZERO);
            let at = |i: u32, j: u32| (i % n) * n + j % n;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            mesh.indices.extend([a, b, c, a, c, d]);
        }
    }
    mesh
}

/// Without the triangles whose middle `drop` names.
fn without(mut mesh: Mesh, drop: impl Fn(Vec3) -> bool) -> Mesh {
    let middle = |t: &[u32]| t.iter().map(|i| mesh.positions[*i as usize]).sum::<Vec3>() / 3.0;
    let kept = mesh.indices.chunks_exact(3).filter(|t| !drop(middle(t)));
    mesh.indices = kept.flatten().copied().collect();
    mesh
}

fn joined(meshes: &[(&Mesh, Vec3)]) -> Mesh {
    let mut all = Mesh::default();
    for (mesh, at) in meshes {
        all.append(mesh, &Affine3::from_translation(*at));
    }
    all
}

/// The same with three corners of its own for each triangle, moved by rounding.
fn soup(mesh: &Mesh) -> Mesh {
    let mut stream = stream(1);
    let mut moved = |i: &u32| {
        let jitter = Vec3::from_array([0; 3].map(|_| stream.between(-1e-6, 1e-6)));
        mesh.positions[*i as usize] + jitter
    };
    let positions: Vec<Vec3> = mesh.indices.iter().map(&mut moved).collect();
    let n = positions.len();
    let (normals, uvs) = (vec![Vec3::Z; n], vec![Vec2::ZERO; n]);
    Mesh { positions, normals, uvs, indices: (0..n as u32).collect() }
}

fn solid_meshes() -> Vec<(&'static str, Mesh)> {
    let ball = sphere(3);
    let mut inner = ball.clone();
    inner.positions.iter_mut().for_each(|position| *position *= 0.6);
    inner.indices.chunks_exact_mut(3).for_each(|t| t.swap(1, 2));
    vec![
        ("cube", cube()),
        ("sphere", ball.clone()),
        ("torus", torus(2.0, 0.7, 32)),
        ("sphere with a hole", without(sphere(4), |middle| middle.z > 0.96)),
        ("shells that overlap", joined(&[(&ball, Vec3::ZERO), (&ball, Vec3::X * 0.8)])),
        ("doubled shell", joined(&[(&ball, Vec3::ZERO), (&ball, Vec3::ZERO)])),
        ("hollow sphere", joined(&[(&ball, Vec3::ZERO), (&inner, Vec3::ZERO)])),
        ("loose triangles", soup(&ball)),
    ]
}

/// The winding number over all triangles, and the distance of the nearest one.
fn by_all_triangles(mesh: &Mesh, point: DVec3) -> (f64, f64) {
    let triangles = mesh.indices.chunks_exact(3).map(|t| {
        Triangle([t[0], t[1], t[2]].map(|index| mesh.positions[index as usize].as_dvec3()))
    });
    triangles.fold((0.0, f64::INFINITY), |(angle, square), triangle| {
        let square = square.min(triangle.distance_squared(point));
        (angle + triangle.solid_angle(point) / (4.0 * std::f64::consts::PI), square)
    })
}

#[test]
fn the_hierarchy_winds_as_all_triangles_do() {
    for (name, mesh) in solid_meshes() {
        let closed = ClosedMesh::new(&mesh).unwrap_or_else(|fault| panic!("{name}: {fault}"));
        let envelope = Envelope::mesh(closed.clone());
        let mut stream = stream(2);
        let Aabb { min, max } = mesh.bound().aabb;
        let around = Aabb { min: min - 0.3, max: max + 0.3 };
        let (mut worst, mut n_inside, mut n_told) = (0.0f64, 0, 0);
        for _ in 0..10_000 {
            let point = point_in(&around, &mut stream);
            let (number, square) = by_all_triangles(&mesh, point.as_dvec3());
            worst = worst.max((closed.winding_number(point) - number).abs());
            // In holes the border is where the number is a half.
            let is_near = square.sqrt() < 1e-3 || (number - 0.5).abs() < 0.02;
            let in_box = mesh.bound().aabb.contains(point);
            if !is_near {
                assert_eq!(envelope.contains(point), number > 0.5 && in_box, "{name}: {point}");
                n_inside += u32::from(number > 0.5);
                n_told += 1;
            }
        }
        // Half of what is allowed for where holes make numbers fractions.
        assert!(worst < 0.04, "{name}: {worst}");
        assert!(n_inside > 1000 && n_told > 9500, "{name}: {n_inside} of {n_told}");
    }
}

#[test]
fn loose_triangles_and_cracks_are_closed() {
    let watertight = |mesh: &Mesh| ClosedMesh::new(mesh).unwrap().is_watertight();
    assert!(watertight(&soup(&sphere(4))) && watertight(&torus(2.0, 0.5, 24)));
    assert!(!watertight(&without(sphere(4), |middle| middle.z > 0.96)));
}

#[test]
fn meshes_that_enclose_nothing_are_refused() {
    let refused = |mesh: &Mesh| ClosedMesh::new(mesh).unwrap_err();
    assert_eq!(refused(&Mesh::default()), NotClosed::Empty);
    let mut flat = cube();
    flat.positions.iter_mut().for_each(|position| *position = Vec3::X);
    assert_eq!(refused(&flat), NotClosed::Empty);
    let mut broken = cube();
    broken.positions[3] = Vec3::NAN;
    assert!(matches!(refused(&broken), NotClosed::Unsound(_)));
    let mut turned = sphere(3);
    turned.indices.chunks_exact_mut(3).for_each(|t| t.swap(1, 2));
    assert_eq!(refused(&turned), NotClosed::InsideOut { share: 1.0 });
    // However fine it is, a sheet encloses nothing; neither does one with two sides.
    let mut sheet = without(sphere(5), |middle| middle.z < 0.8);
    assert!(matches!(refused(&sheet), NotClosed::Open { share } if share < 0.1));
    let back: Vec<u32> = sheet.indices.chunks_exact(3).flat_map(|t| [t[0], t[2], t[1]]).collect();
    sheet.indices.extend(back);
    let fault = refused(&sheet);
    assert!(matches!(fault, NotClosed::Open { .. }) && fault.to_string().contains("far from"));
    // A box without its lid still encloses nearly all that it did.
    assert!(ClosedMesh::new(&without(cube(), |middle| middle.z > 0.9)).is_ok());
}

const PROFILE: Profile =
    Profile { base: -1.5, top: 2.0, width: 1.4, peak: 0.3, power_low: 0.5, power_high: 1.7 };

/// One of every kind, each with something inside and something outside in the box of ±3.
fn envelopes() -> Vec<(&'static str, Envelope)> {
    let ball = |x: f32, radius| Envelope::sphere(Sphere { center: Vec3::X * x, radius });
    let cuboid = Envelope::aabb(Aabb { min: Vec3::splat(-1.2), max: Vec3::new(0.5, 1.0, 2.0) });
    let half = Envelope::half_space(Vec3::new(1.0, 2.0, -0.5), 0.4);
    let crown = Envelope::revolution(PROFILE);
    let turn = Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 1.1);
    let mut shear = Affine3::from_scale_rotation_translation(
        Vec3::new(0.7, 1.3, -0.9),
        turn,
        Vec3::new(0.3, -0.4, 0.2),
    );
    shear.matrix3.y_axis += shear.matrix3.x_axis * 0.8;
    let mut all = vec![
        ("sphere", ball(0.5, 1.3)),
        ("box", cuboid.clone()),
        ("half-space", half.clone()),
        ("profile", crown.clone()),
        ("union", Envelope::union([ball(-1.0, 1.0), ball(1.0, 1.2), cuboid.clone()])),
        ("intersection", Envelope::intersection([ball(0.0, 1.5), half.clone(), crown.clone()])),
        ("complement", crown.clone().complement()),
        ("placed box", Envelope::placed(shear, cuboid)),
        ("placed sphere", Envelope::placed(shear, ball(0.0, 1.2))),
        ("placed profile", Envelope::placed(shear, crown.clone())),
        ("placed twice", Envelope::placed(shear, Envelope::placed(shear, crown).complement())),
    ];
    for (name, mesh) in solid_meshes() {
        let envelope = Envelope::mesh(ClosedMesh::new(&mesh).unwrap());
        all.push((name, envelope.clone()));
        all.push((name, Envelope::placed(shear, envelope)));
    }
    all
}

#[test]
fn sides_are_certain() {
    let around = Aabb { min: Vec3::splat(-3.0), max: Vec3::splat(3.0) };
    for (name, envelope) in envelopes() {
        let mut stream = stream(3);
        let mut told = [0; 3];
        for _ in 0..600 {
            let center = point_in(&around, &mut stream);
            let radius = stream.between(0.0, 1.0) * stream.between(0.0, 1.0);
            let ball = Sphere { center, radius };
            let half = Vec3::from_array([0; 3].map(|_| radius * stream.unit()));
            let aabb = Aabb { min: center - half, max: center + half };
            let sides = [envelope.side_of(&ball), envelope.side_of_box(&aabb)];
            for side in sides {
                told[side as usize] += 1;
            }
            for _ in 0..20 {
                let unit = Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
                let away = point_in(&unit, &mut stream);
                // Many points lie on the very surface, where mistakes would be.
                let on_ball = away.normalize_or(Vec3::X) * away.abs().max_element().sqrt();
                let points = [center + on_ball * radius, center + away.signum() * half];
                for (side, point) in sides.into_iter().zip(points) {
                    let fits = match side {
                        Side::Inside => envelope.contains(point),
                        Side::Crossing => true,
                        Side::Outside => !envelope.contains(point),
                    };
                    assert!(fits, "{name}: {point} of {ball:?} or {aabb:?} is not {side:?}");
                }
            }
        }
        assert!(told.iter().all(|n| *n > 0), "{name}: {told:?}");
    }
}

#[test]
fn what_is_far_away_or_deep_inside_is_told() {
    for (name, envelope) in envelopes() {
        let Some(bound) = envelope.bound() else { continue };
        let away = bound.aabb.max + bound.aabb.size();
        let far = Sphere { center: away, radius: 0.5 };
        assert_eq!(envelope.side_of(&far), Side::Outside, "{name}");
        assert_eq!(envelope.side_of_bound(&Bound::of_box(bound.aabb)), Side::Crossing, "{name}");
        // Of places that are inside by a twenty-fifth of the whole, most are told; triangles within keep some from it.
        let mut stream = stream(4);
        let reach = 0.02 * bound.aabb.size().min_element();
        let (mut n_deep, mut n_told) = (0, 0);
        for _ in 0..2000 {
            let center = point_in(&bound.aabb, &mut stream);
            let shell = (0..60).all(|_| {
                let unit = Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
                let toward = point_in(&unit, &mut stream).normalize_or(Vec3::X);
                envelope.contains(center + toward * (2.0 * reach))
            });
            if shell && envelope.contains(center) {
                n_deep += 1;
                let ball = Sphere { center, radius: reach };
                n_told += u32::from(envelope.side_of(&ball) == Side::Inside);
            }
        }
        assert!(n_deep > 10 && n_told * 10 > n_deep * 6, "{name}: {n_told} of {n_deep}");
    }
}

#[test]
fn bounds_hold_what_is_inside() {
    let around = Aabb { min: Vec3::splat(-3.0), max: Vec3::splat(3.0) };
    for (name, envelope) in envelopes() {
        let Some(bound) = envelope.bound() else { continue };
        let mut stream = stream(5);
        for _ in 0..2000 {
            let point = point_in(&around, &mut stream);
            let is_held = bound.aabb.contains(point)
                && bound.sphere.center.distance(point) <= bound.sphere.radius;
            assert!(is_held || !envelope.contains(point), "{name}: {point}");
        }
    }
    let [ball, half] = [0, 2].map(|i| envelopes()[i].1.clone());
    assert_eq!(half.bound(), None);
    assert_eq!(
        Envelope::intersection([half.clone(), ball.clone()]).bound(),
        ball.bound().map(|b| Bound::of_box(b.aabb))
    );
    assert_eq!(Envelope::union([half, ball.clone()]).bound(), None);
    assert_eq!(ball.clone().complement().bound(), None);
    assert_eq!(ball.clone().complement().complement(), ball);
}

#[test]
fn envelopes_of_nothing() {
    let point = Sphere { center: Vec3::ZERO, radius: 0.0 };
    let flat = Affine3::from_scale(Vec3::new(1.0, 0.0, 1.0));
    let nothing = [
        Envelope::nothing(),
        Envelope::sphere(Sphere::EMPTY),
        Envelope::aabb(Aabb::EMPTY),
        Envelope::placed(flat, Envelope::everything()),
    ];
    for envelope in nothing {
        assert!(
            !envelope.contains(Vec3::ZERO) && envelope.clone().complement().contains(Vec3::ZERO)
        );
        assert_eq!(envelope.side_of(&point), Side::Outside);
        assert!(envelope.bound().is_some_and(|bound| bound.is_empty()));
        assert!(!envelope.complement().contains(Vec3::NAN));
    }
    assert_eq!(Envelope::everything().side_of(&Sphere::EMPTY), Side::Crossing);
}

#[test]
fn equal_content_is_equal() {
    let (one, other) = (envelopes(), envelopes());
    for (i, (_, a)) in one.iter().enumerate() {
        for (j, (_, b)) in other.iter().enumerate() {
            assert_eq!(a == b, i == j);
            assert_eq!(Digest::of(a) == Digest::of(b), i == j);
        }
    }
}
