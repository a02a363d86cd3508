//! Cutting triangles: what of a mesh lies on one side of a border.

use sapwood_geom::glam::{Affine3, Vec2, Vec3};
use sapwood_geom::{Aabb, Envelope, FixedMap, Mesh, Side, Sphere, fixed_state};

use super::fate::Beyond;
use super::meter::Meter;

/// Times that a triangle is divided into four at most.
const MOST_DIVISIONS: u32 = 12;

/// Halvings of an edge that find where it leaves an envelope.
const HALVINGS: u32 = 24;

/// A place on a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    pub(super) position: Vec3,
    normal: Vec3,
    uv: Vec2,
}

impl Corner {
    fn of(mesh: &Mesh, index: u32) -> Self {
        let i = index as usize;
        Self { position: mesh.positions[i], normal: mesh.normals[i], uv: mesh.uvs[i] }
    }

    fn toward(&self, other: &Self, part: f32) -> Self {
        let normal = self.normal.lerp(other.normal, part);
        Self {
            position: self.position.lerp(other.position, part),
            normal: normal.normalize_or(self.normal),
            uv: self.uv.lerp(other.uv, part),
        }
    }
}

/// What is cut away from what.
pub(super) trait Border {
    /// Whether a point stays.
    fn keeps(&self, point: Vec3) -> bool;

    /// How all of a triangle stands, if that can be told at once.
    fn side_of(&self, triangle: &[Corner; 3]) -> Side;

    /// Where between a point that stays and one that goes the border is, from 0 to 1.
    fn between(&self, stays: Vec3, goes: Vec3) -> f32;

    /// How far from the border a straight cut may be, and how small pieces are not divided any
    /// further, in metres; nothing where each triangle is cut straight.
    fn precision(&self) -> Option<[f32; 2]>;
}

/// The surface of an envelope, seen from a frame.
pub(super) struct Surface<'a> {
    pub(super) envelope: &'a Envelope,
    /// To the root's frame.
    pub(super) world: Affine3,
    /// In metres in the root's frame.
    pub(super) tolerance: f32,
}

impl Surface<'_> {
    /// How much longer a metre may become in the root's frame.
    fn stretch(&self) -> f32 {
        let m = &self.world.matrix3;
        let squares = [m.x_axis, m.y_axis, m.z_axis].map(Vec3::length_squared);
        squares.into_iter().sum::<f32>().sqrt().max(f32::MIN_POSITIVE)
    }
}

impl Border for Surface<'_> {
    fn keeps(&self, point: Vec3) -> bool {
        self.envelope.contains(self.world.transform_point3(point))
    }

    fn side_of(&self, triangle: &[Corner; 3]) -> Side {
        let corners = triangle.map(|corner| self.world.transform_point3(corner.position));
        let aabb = Aabb::of_points(corners);
        let center = (corners[0] + corners[1] + corners[2]) / 3.0;
        let square = corners.iter().map(|corner| corner.distance_squared(center));
        let radius = square.fold(0.0, f32::max).sqrt();
        match self.envelope.side_of(&Sphere { center, radius }) {
            Side::Crossing => self.envelope.side_of_box(&aabb),
            certain => certain,
        }
    }

    fn between(&self, stays: Vec3, goes: Vec3) -> f32 {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.keeps(stays.lerp(goes, middle)) {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }

    fn precision(&self) -> Option<[f32; 2]> {
        let tolerance = self.tolerance / self.stretch();
        Some([tolerance, 8.0 * tolerance])
    }
}

/// A cut through a part.
pub(super) struct Through<'a> {
    pub(super) part: &'a dyn Beyond,
    /// To the frame of the plan that has the part.
    pub(super) to_plan: Affine3,
}

impl Through<'_> {
    fn beyond(&self, point: Vec3) -> f32 {
        self.part.beyond(self.to_plan.transform_point3(point))
    }
}

impl Border for Through<'_> {
    fn keeps(&self, point: Vec3) -> bool {
        self.beyond(point) <= 0.0
    }

    fn side_of(&self, triangle: &[Corner; 3]) -> Side {
        match triangle.map(|corner| self.keeps(corner.position)) {
            [true, true, true] => Side::Inside,
            [false, false, false] => Side::Outside,
            _ => Side::Crossing,
        }
    }

    fn between(&self, stays: Vec3, goes: Vec3) -> f32 {
        let (low, high) = (self.beyond(stays), self.beyond(goes));
        if high > low { (low / (low - high)).clamp(0.0, 1.0) } else { 0.0 }
    }

    fn precision(&self) -> Option<[f32; 2]> {
        None
    }
}

/// What remains of a mesh, in the making.
pub(super) struct Remains<'a> {
    meter: &'a Meter<'a>,
    /// Whether triangles stay however thin they are, lest there be gaps.
    is_closed: bool,
    mesh: Mesh,
    numbers: FixedMap<[u32; 8], u32>,
    /// Borders of what was cut since the last cap, with what remains on their left.
    rim: Vec<[Corner; 2]>,
}

/// What remains of a triangle.
enum Outcome {
    Whole,
    Gone,
    Pieces(Vec<[Corner; 3]>, Vec<[Corner; 2]>),
}

impl<'a> Remains<'a> {
    pub(super) fn new(meter: &'a Meter<'a>) -> Self {
        let (mesh, numbers) = (Mesh::default(), FixedMap::with_hasher(fixed_state()));
        Self { meter, is_closed: false, mesh, numbers, rim: Vec::new() }
    }

    /// What remains of a closed mesh, and is to be closed again.
    pub(super) fn closed(meter: &'a Meter<'a>) -> Self {
        Self { is_closed: true, ..Self::new(meter) }
    }

    pub(super) fn finish(self) -> Mesh {
        self.mesh
    }

    /// Adds a triangle of `mesh` as it is.
    pub(super) fn add(&mut self, mesh: &Mesh, triangle: usize) {
        self.meter.made(1);
        self.put(&corners(mesh, triangle));
    }

    /// Adds what `border` leaves of a triangle of `mesh`; tells whether that is all of it.
    pub(super) fn add_cut(&mut self, mesh: &Mesh, triangle: usize, border: &impl Border) -> bool {
        let corners = corners(mesh, triangle);
        match cut(&corners, border, 0, self.meter) {
            Outcome::Whole => {
                self.meter.made(1);
                self.put(&corners);
                true
            }
            Outcome::Gone => false,
            Outcome::Pieces(pieces, rim) => {
                pieces.iter().for_each(|piece| self.put(piece));
                self.rim.extend(rim);
                false
            }
        }
    }

    /// Closes what was cut open since the last cap by a fan about the middle of its rim.
    pub(super) fn cap(&mut self) {
        let rim = std::mem::take(&mut self.rim);
        if rim.len() < 3 {
            return;
        }
        let n = rim.len() as f32;
        let middle = rim.iter().map(|[from, _]| from.position).sum::<Vec3>() / n;
        let uv = rim.iter().map(|[from, _]| from.uv).sum::<Vec2>() / n;
        let out = rim.iter().map(|[from, to]| (to.position - middle).cross(from.position - middle));
        let normal = out.sum::<Vec3>().normalize_or_zero();
        if normal == Vec3::ZERO {
            return;
        }
        let center = Corner { position: middle, normal, uv };
        self.meter.made(rim.len());
        for [from, to] in rim {
            self.put(&[Corner { normal, ..to }, Corner { normal, ..from }, center]);
        }
    }

    /// Forgets what was cut open.
    pub(super) fn leave_open(&mut self) {
        self.rim.clear();
    }

    fn put(&mut self, corners: &[Corner; 3]) {
        let [a, b, c] = corners.map(|corner| corner.position);
        let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        // Too thin to have a normal.
        if !self.is_closed && (b - a).cross(c - a).length() <= 1e-6 * longest {
            return;
        }
        for corner in corners {
            let Corner { position: p, normal: n, uv } = corner;
            let key = [p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y].map(f32::to_bits);
            let mesh = &mut self.mesh;
            let index = *self.numbers.entry(key).or_insert_with(|| {
                mesh.positions.push(*p);
                mesh.normals.push(*n);
                mesh.uvs.push(*uv);
                mesh.positions.len() as u32 - 1
            });
            self.mesh.indices.push(index);
        }
    }
}

fn corners(mesh: &Mesh, triangle: usize) -> [Corner; 3] {
    [0, 1, 2].map(|i| Corner::of(mesh, mesh.indices[3 * triangle + i]))
}

/// What is left of a triangle; nothing once the meter has ended the work. Recurses as deep as it is
/// divided, [`MOST_DIVISIONS`] times.
fn cut(
    triangle: &[Corner; 3],
    border: &impl Border,
    n_divisions: u32,
    meter: &Meter<'_>,
) -> Outcome {
    if !meter.goes_on() {
        return Outcome::Gone;
    }
    match border.side_of(triangle) {
        Side::Inside => return Outcome::Whole,
        Side::Outside => return Outcome::Gone,
        Side::Crossing => {}
    }
    let kept = triangle.map(|corner| border.keeps(corner.position));
    let precision = border.precision().filter(|[_, finest]| {
        let [a, b, c] = triangle.map(|corner| corner.position);
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        n_divisions < MOST_DIVISIONS && longest > *finest
    });
    let is_mixed = kept[0] != kept[1] || kept[1] != kept[2];
    match (is_mixed, precision) {
        (false, None) => return if kept[0] { Outcome::Whole } else { Outcome::Gone },
        (true, None) => {
            meter.made(2);
            return straight(triangle, kept, border);
        }
        (true, Some([tolerance, _])) => {
            let outcome = straight(triangle, kept, border);
            let follows = |rim: &[[Corner; 2]]| {
                rim.iter().all(|chord| is_near(chord, triangle, border, tolerance))
            };
            if matches!(&outcome, Outcome::Pieces(_, rim) if follows(rim)) {
                meter.made(2);
                return outcome;
            }
        }
        (false, Some(_)) => {}
    }
    let [a, b, c] = *triangle;
    let [ab, bc, ca] = [a.toward(&b, 0.5), b.toward(&c, 0.5), c.toward(&a, 0.5)];
    let quarters = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
    let outcomes = quarters.map(|quarter| cut(&quarter, border, n_divisions + 1, meter));
    if outcomes.iter().all(|outcome| matches!(outcome, Outcome::Whole)) {
        return Outcome::Whole;
    }
    if outcomes.iter().all(|outcome| matches!(outcome, Outcome::Gone)) {
        return Outcome::Gone;
    }
    let (mut pieces, mut rim) = (Vec::new(), Vec::new());
    for (quarter, outcome) in quarters.into_iter().zip(outcomes) {
        match outcome {
            Outcome::Whole => {
                meter.made(1);
                pieces.push(quarter);
            }
            Outcome::Gone => {}
            Outcome::Pieces(more, edges) => {
                pieces.extend(more);
                rim.extend(edges);
            }
        }
    }
    Outcome::Pieces(pieces, rim)
}

/// What is left of a triangle by one straight cut; some corners are kept, some not.
fn straight(triangle: &[Corner; 3], kept: [bool; 3], border: &impl Border) -> Outcome {
    let cut_at = |stays: usize, goes: usize| {
        let (stays, goes) = (&triangle[stays], &triangle[goes]);
        stays.toward(goes, border.between(stays.position, goes.position))
    };
    let is_single = kept.iter().filter(|kept| **kept).count() == 1;
    // The corner that is alone on its side, and those after it.
    let first = (0..3).find(|i| kept[*i] == is_single).unwrap_or(0);
    let [i, j, k] = [first, (first + 1) % 3, (first + 2) % 3];
    if is_single {
        let (to_next, to_last) = (cut_at(i, j), cut_at(i, k));
        return Outcome::Pieces(vec![[triangle[i], to_next, to_last]], vec![[to_next, to_last]]);
    }
    let (from_next, from_last) = (cut_at(j, i), cut_at(k, i));
    let pieces = vec![[from_next, triangle[j], triangle[k]], [from_next, triangle[k], from_last]];
    Outcome::Pieces(pieces, vec![[from_last, from_next]])
}

/// Whether the border passes within `tolerance` of the middle of a straight cut.
fn is_near(
    chord: &[Corner; 2],
    triangle: &[Corner; 3],
    border: &impl Border,
    tolerance: f32,
) -> bool {
    let [from, to] = chord.map(|corner| corner.position);
    let [a, b, c] = triangle.map(|corner| corner.position);
    let normal = (b - a).cross(c - a);
    // What remains lies to the left of the chord, seen from outside.
    let left = normal.cross(to - from).normalize_or_zero();
    let middle = (from + to) * 0.5;
    border.keeps(middle + left * tolerance) && !border.keeps(middle - left * tolerance)
}

#[cfg(test)]
mod tests {
    use super::super::PruneLimits;
    use super::*;

    fn square(size: f32) -> Mesh {
        let corner = |x: f32, y: f32| Vec3::new(x * size, y * size, 0.0);
        Mesh {
            positions: vec![
                corner(-1.0, -1.0),
                corner(1.0, -1.0),
                corner(1.0, 1.0),
                corner(-1.0, 1.0),
            ],
            normals: vec![Vec3::Z; 4],
            uvs: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
            indices: vec![0, 1, 2, 0, 2, 3],
        }
    }

    fn remains(mesh: &Mesh, border: &impl Border) -> Mesh {
        let meter = Meter::new(&PruneLimits::NONE);
        let mut remains = Remains::new(&meter);
        for triangle in 0..mesh.n_triangles() {
            remains.add_cut(mesh, triangle, border);
        }
        remains.finish()
    }

    fn area(mesh: &Mesh) -> f64 {
        mesh.indices
            .chunks_exact(3)
            .map(|t| {
                let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize].as_dvec3());
                let doubled = (b - a).cross(c - a);
                assert!(doubled.z > 0.0, "triangles keep their front");
                doubled.z / 2.0
            })
            .sum()
    }

    #[test]
    fn planes_cut_exactly_and_carry_attributes() {
        let envelope = Envelope::half_space(Vec3::X, 0.25);
        let border = Surface { envelope: &envelope, world: Affine3::IDENTITY, tolerance: 1e-3 };
        let cut = remains(&square(1.0), &border);
        assert!((area(&cut) - 2.5).abs() < 1e-5, "{}", area(&cut));
        assert!(cut.n_triangles() <= 5 && cut.fault().is_none());
        for (position, uv) in cut.positions.iter().zip(&cut.uvs) {
            let expected = (position.truncate() + Vec2::ONE) / 2.0;
            assert!(uv.distance(expected) < 1e-6 && position.x < 0.25 + 1e-6);
        }
    }

    #[test]
    fn curved_cuts_follow_the_surface() {
        // A disc in the middle of a square that has no corner in it.
        let ball = Sphere { center: Vec3::ZERO, radius: 1.0 };
        let envelope = Envelope::sphere(ball);
        for (scale, tolerance) in [(1.0, 1e-3), (10.0, 1e-3)] {
            let world = Affine3::from_scale(Vec3::splat(1.0 / scale));
            let border = Surface { envelope: &envelope, world, tolerance };
            let cut = remains(&square(3.0 * scale), &border);
            let share = area(&cut) / f64::from(scale * scale) / std::f64::consts::PI;
            assert!((share - 1.0).abs() < 2e-3, "{share}");
            assert!(cut.fault().is_none() && cut.n_triangles() < 2000, "{}", cut.n_triangles());
        }
        let outside = envelope.complement();
        let border = Surface { envelope: &outside, world: Affine3::IDENTITY, tolerance: 1e-3 };
        let share = area(&remains(&square(3.0), &border)) / (36.0 - std::f64::consts::PI);
        assert!((share - 1.0).abs() < 2e-4, "{share}");
    }

    struct Above(f32);

    impl Beyond for Above {
        fn beyond(&self, point: Vec3) -> f32 {
            point.z - self.0
        }
    }

    #[test]
    fn a_tube_is_cut_and_capped() {
        let mut tube = Mesh::default();
        let n = 8;
        for i in 0..n {
            let angle = std::f32::consts::TAU * i as f32 / n as f32;
            let out = Vec3::new(libm::cosf(angle), libm::sinf(angle), 0.0);
            tube.positions.extend([out, out + Vec3::Z]);
            tube.normals.extend([out; 2]);
            tube.uvs.extend([Vec2::ZERO, Vec2::Y]);
            let [a, b] = [2 * i, 2 * ((i + 1) % n)];
            tube.indices.extend([a, b, b + 1, a, b + 1, a + 1]);
        }
        let meter = Meter::new(&PruneLimits::NONE);
        let mut remains = Remains::new(&meter);
        let part = Above(0.4);
        let border = Through { part: &part, to_plan: Affine3::IDENTITY };
        for triangle in 0..tube.n_triangles() {
            remains.add_cut(&tube, triangle, &border);
        }
        remains.cap();
        let cut = remains.finish();
        assert!(cut.fault().is_none(), "{:?}", cut.fault());
        // Open at the foot alone.
        assert_eq!((tube.n_open_edges(), cut.n_open_edges()), (16, 8));
        let up = cut.normals.iter().filter(|normal| normal.distance(Vec3::Z) < 1e-5).count();
        assert_eq!(up, 2 * 8 + 1, "the cap is flat");
        assert!(cut.positions.iter().all(|position| position.z <= 0.4 + 1e-6));
    }
}
