//! The meshes of single leaves, one for each [`LeafShape`]; how large a leaf is and where it
//! sits is not decided here.

use glam::{Vec2, Vec3};
use sapwood_geom::Mesh;

use crate::weber_penn::LeafShape;

/// A point of an outline: distance from the midrib and height above the leaf's base.
type Point = (f32, f32);

/// The mesh of one leaf: base at the origin, tip at z = 1, x between -0.5 and 0.5.
///
/// Local y is the normal of the upper side. Flat shapes have that side only and are drawn from
/// both; the palm leaflet is folded along its midrib and hangs a little, the sphere stands
/// around (0, 0, 0.5). All but the narrow shapes are as wide as long: an ellipse is half as wide
/// and a needle an eighth. The texture lies over the unit square, its upper edge at the tip.
pub fn leaf_mesh(shape: LeafShape) -> Mesh {
    match shape {
        LeafShape::Oval => strip(&[(0.0, 0.0), (0.5, 0.36), (0.4, 0.7), (0.0, 1.0)]),
        LeafShape::Diamond => strip(&[(0.0, 0.0), (0.5, 0.45), (0.0, 1.0)]),
        LeafShape::Triangle => strip(&[(0.5, 0.0), (0.0, 1.0)]),
        LeafShape::Square => strip(&[(0.5, 0.0), (0.5, 1.0)]),
        LeafShape::Linear => strip(&[(0.03, 0.0), (0.0625, 0.2), (0.05, 0.8), (0.0, 1.0)]),
        LeafShape::Elliptic => disc(10, 0.25),
        LeafShape::Disc(points) => disc(points.clamp(3, 1000), 0.5),
        LeafShape::Heart => fan(&HEART),
        LeafShape::Maple3 => fan(&MAPLE3),
        LeafShape::Maple5 => fan(&MAPLE5),
        LeafShape::Oak3 => fan(&OAK3),
        LeafShape::Palmate => leaflets(&PALMATE_FOOT, &PALMATE),
        LeafShape::Leaflets3 => leaflets(&LEAFLETS3_FOOT, &LEAFLETS3),
        LeafShape::Palm => palm(),
        LeafShape::Sphere => sphere(),
    }
}

/// Right halves of outlines that see all their points from the first one, where the stalk ends.
const HEART: [Point; 6] =
    [(0.0, 0.15), (0.24, 0.0), (0.44, 0.1), (0.5, 0.32), (0.32, 0.7), (0.0, 1.0)];
const MAPLE3: [Point; 6] =
    [(0.0, 0.0), (0.26, 0.12), (0.5, 0.58), (0.19, 0.5), (0.2, 0.74), (0.0, 1.0)];
const MAPLE5: [Point; 8] = [
    (0.0, 0.12),
    (0.12, 0.02),
    (0.36, 0.0),
    (0.22, 0.24),
    (0.5, 0.56),
    (0.16, 0.5),
    (0.18, 0.76),
    (0.0, 1.0),
];

/// Two side lobes and one at the tip.
const OAK3: [Point; 9] = [
    (0.0, 0.0),
    (0.19, 0.18),
    (0.44, 0.48),
    (0.5, 0.62),
    (0.41, 0.72),
    (0.19, 0.63),
    (0.235, 0.86),
    (0.15, 0.96),
    (0.0, 1.0),
];

/// Where leaflets meet, and for each on the right half the one that points furthest down first:
/// its right corner, tip and left corner. The last lies on the midrib.
const PALMATE_FOOT: Point = (0.0, 0.24);
const PALMATE: [[Point; 3]; 3] = [
    [(0.23, 0.0), (0.44, 0.0), (0.3, 0.17)],
    [(0.33, 0.34), (0.5, 0.62), (0.22, 0.48)],
    [(0.13, 0.66), (0.0, 1.0), (-0.13, 0.66)],
];
const LEAFLETS3_FOOT: Point = (0.0, 0.16);
const LEAFLETS3: [[Point; 3]; 2] =
    [[(0.32, 0.0), (0.5, 0.36), (0.19, 0.41)], [(0.22, 0.64), (0.0, 1.0), (-0.22, 0.64)]];

/// A mesh of flat pieces, all facing +y.
struct Flat(Mesh);

impl Flat {
    fn new() -> Self {
        Self(Mesh::default())
    }

    fn vertex(&mut self, (x, z): Point) -> u32 {
        let mesh = &mut self.0;
        mesh.positions.push(Vec3::new(x, 0.0, z));
        mesh.normals.push(Vec3::Y);
        mesh.uvs.push(texture(x, z));
        mesh.positions.len() as u32 - 1
    }

    /// A vertex for the point and one for its image left of the midrib, the same if it lies on
    /// the midrib.
    fn mirrored(&mut self, (x, z): Point) -> (u32, u32) {
        let right = self.vertex((x, z));
        if x == 0.0 { (right, right) } else { (right, self.vertex((-x, z))) }
    }

    fn triangle(&mut self, corners: [u32; 3]) {
        self.0.indices.extend(corners);
    }
}

/// Seen from above with the tip up, x runs to the left.
fn texture(x: f32, z: f32) -> Vec2 {
    Vec2::new(0.5 - x, 1.0 - z)
}

/// The outline whose right half is `half`, with heights that only grow: a strip of trapezes.
fn strip(half: &[Point]) -> Mesh {
    let mut flat = Flat::new();
    let mut below: Option<(u32, u32)> = None;
    for point in half {
        let (right, left) = flat.mirrored(*point);
        if let Some((right_below, left_below)) = below {
            if right_below != left_below {
                flat.triangle([left_below, left, right_below]);
            }
            if right != left {
                flat.triangle([left, right, right_below]);
            }
        }
        below = Some((right, left));
    }
    flat.0
}

/// The outline whose right half is `half`: a fan about its first point, which lies on the
/// midrib like its last.
fn fan(half: &[Point]) -> Mesh {
    let mut flat = Flat::new();
    let pivot = flat.vertex(half[0]);
    let mut before: Option<(u32, u32)> = None;
    for point in &half[1..] {
        let (right, left) = flat.mirrored(*point);
        if let Some((right_before, left_before)) = before {
            flat.triangle([pivot, right, right_before]);
            flat.triangle([pivot, left_before, left]);
        }
        before = Some((right, left));
    }
    flat.0
}

/// An ellipse of `n` points, one of them at the tip, stretched to end at z = 0 and 1 and at
/// `half_width` from the midrib.
fn disc(n: u32, half_width: f32) -> Mesh {
    let angle = |k: u32| std::f32::consts::TAU * (k as f32 / n as f32);
    let points = (0..=n / 2).rev().map(|k| {
        let across = if 2 * k == n || k == 0 { 0.0 } else { libm::sinf(angle(k)) };
        (across, libm::cosf(angle(k)))
    });
    let mut half: Vec<Point> = points.collect();
    let widest = half.iter().map(|(x, _)| *x).fold(0.0, f32::max);
    let lowest = half[0].1;
    for (x, z) in &mut half {
        *x *= half_width / widest;
        *z = (*z - lowest) / (1.0 - lowest);
    }
    strip(&half)
}

/// Kites of two triangles from one foot, the last on the midrib, the others on both sides.
fn leaflets(foot: &Point, right_half: &[[Point; 3]]) -> Mesh {
    let mut flat = Flat::new();
    let foot = flat.vertex(*foot);
    for (number, kite) in right_half.iter().enumerate() {
        let on_midrib = number + 1 == right_half.len();
        let [a, b, c] = kite.map(|point| flat.vertex(point));
        flat.triangle([foot, b, a]);
        flat.triangle([foot, c, b]);
        if !on_midrib {
            let [a, b, c] = kite.map(|(x, z)| flat.vertex((-x, z)));
            flat.triangle([foot, a, b]);
            flat.triangle([foot, b, c]);
        }
    }
    flat.0
}

/// A strip in three pieces, its halves folded down from the midrib and its tip hanging.
fn palm() -> Mesh {
    const HALF: [Point; 4] = [(0.18, 0.0), (0.5, 0.3), (0.36, 0.7), (0.0, 1.0)];
    let mut mesh = Mesh::default();
    let hang = |z: f32| -0.12 * z * z;
    for side in [1.0, -1.0] {
        let first = mesh.positions.len() as u32;
        for (x, z) in HALF {
            // Down by half of what it is across: the halves are at 53 degrees to each other's
            // continuation.
            let slope = Vec3::new(side * 0.5, 1.0, 0.24 * z).normalize();
            for x in [0.0, x].into_iter().take(if x == 0.0 { 1 } else { 2 }) {
                mesh.positions.push(Vec3::new(side * x, hang(z) - 0.5 * x, z));
                mesh.normals.push(slope);
                mesh.uvs.push(texture(side * x, z));
            }
        }
        let triangles = [[0, 2, 1], [1, 2, 3], [2, 4, 3], [3, 4, 5], [4, 6, 5]];
        for [a, b, c] in triangles {
            let corners = if side > 0.0 { [a, b, c] } else { [a, c, b] };
            mesh.indices.extend(corners.map(|corner| first + corner));
        }
    }
    mesh
}

/// An icosahedron with corners at z = 0 and 1.
fn sphere() -> Mesh {
    let mut mesh = Mesh::default();
    let height = 1.0 / 5.0f32.sqrt();
    let mut corner = |across: f32, angle: f32, up: f32| {
        let normal = Vec3::new(across * libm::cosf(angle), across * libm::sinf(angle), up);
        mesh.normals.push(normal);
        mesh.positions.push(normal * 0.5 + Vec3::new(0.0, 0.0, 0.5));
        mesh.uvs.push(texture(normal.x * 0.5, normal.z * 0.5 + 0.5));
    };
    corner(0.0, 0.0, -1.0);
    let fifth = std::f32::consts::TAU / 5.0;
    (0..5).for_each(|k| corner(2.0 * height, fifth * k as f32, -height));
    (0..5).for_each(|k| corner(2.0 * height, fifth * (k as f32 + 0.5), height));
    corner(0.0, 0.0, 1.0);
    for k in 0..5 {
        let (a, b) = (1 + k, 1 + (k + 1) % 5);
        let (c, d) = (6 + k, 6 + (k + 1) % 5);
        mesh.indices.extend([0, b, a, a, b, c, b, d, c, c, d, 11]);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat_shapes() -> Vec<LeafShape> {
        let named = LeafShape::NAMES.iter().map(|(_, shape)| *shape);
        let folded = |shape: &LeafShape| matches!(shape, LeafShape::Palm | LeafShape::Sphere);
        let discs = [3, 4, 5, 6, 7, 12, 1000].map(LeafShape::Disc);
        named.filter(|shape| !folded(shape)).chain(discs).collect()
    }

    /// Twice the area that each triangle has, seen from above.
    fn doubled_areas(mesh: &Mesh) -> Vec<f32> {
        let triangles = mesh.indices.chunks_exact(3);
        let corners = triangles.map(|t| [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize]));
        corners.map(|[a, b, c]| (b - a).cross(c - a).y).collect()
    }

    /// Twice the area inside the mesh's outer edges: an edge walked both ways cancels out, and
    /// what is left is the outline.
    fn doubled_outline(mesh: &Mesh) -> f32 {
        let mut edges: Vec<(u32, u32)> = Vec::new();
        for t in mesh.indices.chunks_exact(3) {
            for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                match edges.iter().position(|edge| *edge == (b, a)) {
                    Some(opposite) => drop(edges.swap_remove(opposite)),
                    None => edges.push((a, b)),
                }
            }
        }
        let corner = |i: u32| mesh.positions[i as usize];
        edges.iter().map(|(a, b)| corner(*a).cross(corner(*b)).y).sum()
    }

    fn covers(mesh: &Mesh, x: f32, z: f32) -> usize {
        let point = Vec3::new(x, 0.0, z);
        let triangles = mesh.indices.chunks_exact(3);
        let inside = triangles.filter(|t| {
            let corners = [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize]);
            (0..3).all(|i| {
                let (a, b) = (corners[i], corners[(i + 1) % 3]);
                (b - a).cross(point - a).y > 0.0
            })
        });
        inside.count()
    }

    #[test]
    fn flat_leaves_face_up_and_fill_their_outline() {
        for shape in flat_shapes() {
            let mesh = leaf_mesh(shape);
            assert!(mesh.normals.iter().all(|normal| *normal == Vec3::Y));
            let areas = doubled_areas(&mesh);
            assert!(areas.iter().all(|area| *area > 0.0), "{shape:?}: {areas:?}");
            let (area, outline) = (areas.iter().sum::<f32>(), doubled_outline(&mesh));
            assert!((area - outline).abs() < 1e-5, "{shape:?}: {area} {outline}");
        }
    }

    #[test]
    fn no_point_of_a_flat_leaf_is_covered_twice() {
        for shape in flat_shapes() {
            let mesh = leaf_mesh(shape);
            for i in 0..60 * 60 {
                let (x, z) = ((i % 60) as f32 + 0.517, (i / 60) as f32 + 0.493);
                assert!(covers(&mesh, x / 60.0 - 0.5, z / 60.0) <= 1, "{shape:?}");
            }
        }
    }

    #[test]
    fn outlines_have_the_area_they_were_drawn_with() {
        let shoelace = |half: &[Point]| -> f32 {
            let pairs = half.windows(2);
            pairs.map(|ends| ends[0].0 * ends[1].1 - ends[1].0 * ends[0].1).sum::<f32>() * 2.0
        };
        for (shape, half) in [
            (LeafShape::Heart, &HEART[..]),
            (LeafShape::Maple3, &MAPLE3),
            (LeafShape::Maple5, &MAPLE5),
            (LeafShape::Oak3, &OAK3),
        ] {
            let area: f32 = doubled_areas(&leaf_mesh(shape)).iter().sum();
            assert!((area - shoelace(half)).abs() < 1e-5, "{shape:?}: {area}");
        }
        // The regular polygon's area, stretched as the outline is.
        let area: f32 = doubled_areas(&leaf_mesh(LeafShape::Disc(1000))).iter().sum();
        assert!((area - std::f32::consts::FRAC_PI_2).abs() < 1e-4);
    }

    #[test]
    fn every_leaf_is_one_unit_long_and_sound() {
        for shape in flat_shapes().into_iter().chain([LeafShape::Palm, LeafShape::Sphere]) {
            let mesh = leaf_mesh(shape);
            assert_eq!(mesh.fault(), None, "{shape:?}");
            let bound = mesh.bound().aabb;
            assert!(bound.min.z.abs() < 1e-6 && (bound.max.z - 1.0).abs() < 1e-6, "{shape:?}");
            assert!(bound.min.x >= -0.5 && bound.max.x <= 0.5, "{shape:?}");
            assert!((bound.min.x + bound.max.x).abs() < 0.05, "{shape:?}: {bound:?}");
            let inside = |uv: &Vec2| uv.min_element() >= 0.0 && uv.max_element() <= 1.0;
            assert!(mesh.uvs.iter().all(inside), "{shape:?}");
        }
    }

    #[test]
    fn leaves_have_few_triangles() {
        let n = |shape| leaf_mesh(shape).n_triangles();
        assert_eq!([n(LeafShape::Oval), n(LeafShape::Diamond), n(LeafShape::Square)], [4, 2, 2]);
        assert_eq!([n(LeafShape::Disc(3)), n(LeafShape::Disc(9))], [1, 7]);
        assert_eq!([n(LeafShape::Palmate), n(LeafShape::Leaflets3)], [10, 6]);
        assert_eq!([n(LeafShape::Palm), n(LeafShape::Sphere)], [10, 20]);
        assert!(flat_shapes()[..12].iter().all(|shape| n(*shape) <= 14));
    }

    #[test]
    fn normals_of_folded_leaves_agree_with_their_faces() {
        for shape in [LeafShape::Palm, LeafShape::Sphere] {
            let mesh = leaf_mesh(shape);
            for t in mesh.indices.chunks_exact(3) {
                let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize]);
                let face = (b - a).cross(c - a).normalize();
                let agree = t.iter().all(|i| face.dot(mesh.normals[*i as usize]) > 0.7);
                assert!(agree, "{shape:?}");
            }
        }
    }
}
