//! Sweeping rings along a curve into the surface of a tube: frames without twist, normals that
//! follow the taper, texture coordinates that close around and keep their proportions along.
//!
//! What the curve is and how thick it is where, the caller decides; here rings become triangles.

mod write;

use glam::{Vec2, Vec3};

use crate::Section;

/// A cross-section of a tube: where its middle is and how thick the tube is there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// The middle, in metres.
    pub center: Vec3,
    /// The radius in metres; a ring of next to no radius is a point.
    pub radius: f32,
}

/// How an end of a tube is shut; an end whose radius is next to nothing is a point anyway.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cap {
    /// Not at all.
    #[default]
    Open,
    /// With a flat disc.
    Flat,
    /// With half a sphere of the ring's radius, beyond the last ring.
    Round,
}

/// The ring that a tube starts with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepStart {
    /// Direction of the section's first point, made square to the tangent.
    pub x: Vec3,
    /// Unit normal of the first ring's plane; none takes the direction to the second ring.
    pub tangent: Option<Vec3>,
    /// Texture coordinate `v` of the first ring.
    pub v: f32,
}

impl SweepStart {
    /// A start of its own, whose section's first point lies toward `x`.
    pub fn toward(x: Vec3) -> Self {
        Self { x, tangent: None, v: 0.0 }
    }
}

/// How a tube is made of its rings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepOptions {
    /// The first ring's frame.
    pub start: SweepStart,
    /// How often the texture repeats around the tube.
    ///
    /// Along the tube it repeats as often as keeps its proportions, so more often where the tube
    /// is thin; `v` falls from the base to the tip, so that the image stands upright.
    pub repeats: u32,
    /// How the first ring is shut; a round cap there is drawn flat.
    pub base: Cap,
    /// How the last ring is shut.
    pub tip: Cap,
}

impl Default for SweepOptions {
    fn default() -> Self {
        Self { start: SweepStart::toward(Vec3::X), repeats: 1, base: Cap::Open, tip: Cap::Flat }
    }
}

/// A ring with all that its vertices share.
#[derive(Clone, Copy, Debug)]
struct Laid {
    center: Vec3,
    radius: f32,
    /// Metres below which `f32` cannot tell points here apart.
    blur: f32,
    /// Whether the ring is drawn as a point.
    is_point: bool,
    /// Unit vector and distance to the next ring.
    onward: Vec3,
    length: f32,
    tangent: Vec3,
    x: Vec3,
    v: f32,
    /// Normal of the stretch to the next ring, in the plane of outward (x) and tangent (y).
    slope: Vec2,
}

impl Laid {
    /// Whether triangles of the ring would be degenerate beside a stretch of this length.
    fn is_thin(&self, length: f32) -> bool {
        self.radius <= self.blur.max(4e-5 * length).max(1e-6)
    }
}

/// Turns rings into triangles; holds the working memory, so that sweeping many tubes with one of
/// these allocates nothing but the mesh.
///
/// A tube is laid first (frames, number of triangles) and written then, so that a caller can
/// refuse it in between.
#[derive(Clone, Debug, Default)]
pub struct Sweep {
    laid: Vec<Laid>,
    /// For each ring given, its row in `laid`.
    rows: Vec<u32>,
    repeats: u32,
    base: Cap,
    tip: Cap,
}

/// Metres that `f32` cannot tell apart, for each metre from the origin.
const BLUR: f32 = 2e-6;

/// Rings of half a sphere between its rim and its pole: sine and cosine of 30 and 60 degrees.
const DOME: [(f32, f32); 2] = [(0.5, 0.866_025_4), (0.866_025_4, 0.5)];

impl Sweep {
    /// Lays a tube through `rings` and returns the number of triangles it has for `section`.
    ///
    /// Rings turn from one to the next without twist, first toward the stretch between them, then
    /// into the next ring's plane, which lies between the planes square to the two stretches
    /// that it joins, nearer to the shorter one's. A ring that coincides with the one before is
    /// left out. Points are rings below 1e-6 m, or so thin against their distance from the origin
    /// or from the next ring that `f32` could not tell their vertices apart.
    pub fn lay(&mut self, section: &Section, rings: &[Ring], options: &SweepOptions) -> usize {
        self.repeats = options.repeats.max(1);
        self.base = options.base;
        self.tip = options.tip;
        self.laid.clear();
        self.rows.clear();
        let before_all = options.start.tangent.unwrap_or(Vec3::Z);
        for ring in rings {
            self.keep(ring, before_all);
            self.rows.push(self.laid.len() as u32 - 1);
        }
        if self.tip == Cap::Round {
            self.dome();
        }
        self.turn(&options.start);
        self.n_triangles(section.n_sides() as usize)
    }

    /// The frame of ring number `ring` of those last laid, to start a tube that continues there;
    /// nothing if there is no such ring.
    pub fn start_at(&self, ring: usize) -> Option<SweepStart> {
        let laid = self.laid.get(*self.rows.get(ring)? as usize)?;
        Some(SweepStart { x: laid.x, tangent: Some(laid.tangent), v: laid.v })
    }

    /// Keeps a ring unless it coincides with the one kept last, and works out the stretch
    /// between the two; where they share their middle, the direction before goes on.
    fn keep(&mut self, ring: &Ring, before_all: Vec3) {
        let Ring { center, radius } = *ring;
        let radius = radius.max(0.0);
        let blur = BLUR * center.abs().max_element();
        let mut onward = before_all;
        let mut slope = Vec2::X;
        let before = self.laid.len().checked_sub(2).map(|row| self.laid[row].onward);
        if let Some(last) = self.laid.last_mut() {
            let (step, rise) = (center - last.center, radius - last.radius);
            let length_squared = step.length_squared();
            let apart = length_squared + rise * rise;
            let same = 1e-5 * radius.max(last.radius) + blur;
            if apart <= same * same {
                return;
            }
            last.length = length_squared.sqrt();
            last.onward = if length_squared > (blur * blur).max(1e-12 * rise * rise) {
                step * (1.0 / last.length)
            } else {
                before.unwrap_or(before_all)
            };
            last.slope = Vec2::new(last.length, -rise) * (1.0 / apart.sqrt());
            (onward, slope) = (last.onward, last.slope);
        }
        self.laid.push(Laid {
            center,
            radius,
            blur,
            is_point: false,
            onward,
            length: 0.0,
            tangent: onward,
            x: Vec3::ZERO,
            v: 0.0,
            slope,
        });
    }

    /// Adds the rings of a round cap.
    fn dome(&mut self) {
        let Some(rim) = self.laid.last().copied() else { return };
        if self.laid.len() < 2 || rim.radius <= 1e-6 {
            return;
        }
        for (sine, cosine) in DOME.into_iter().chain([(1.0, 0.0)]) {
            let center = rim.center + rim.onward * (rim.radius * sine);
            self.keep(&Ring { center, radius: rim.radius * cosine }, rim.onward);
        }
    }

    /// Works out which rings are points, all frames and the texture's way along the tube.
    fn turn(&mut self, start: &SweepStart) {
        let Some(first) = self.laid.first_mut() else { return };
        let mut tangent = start.tangent.unwrap_or(first.onward);
        let mut x = upright(start.x, tangent);
        let mut v = start.v;
        (first.tangent, first.x, first.v) = (tangent, x, v);
        first.is_point = first.is_thin(first.length);
        let mut before = *first;
        let last = self.laid.len() - 1;
        for (i, laid) in self.laid.iter_mut().enumerate().skip(1) {
            let next = if i == last {
                before.onward
            } else {
                // The shorter stretch weighs more: a ring must not reach past its neighbours.
                let halfway = before.onward * laid.length + laid.onward * before.length;
                halfway.normalize_or(laid.onward)
            };
            x = sharpen(carry(carry(x, tangent, before.onward), before.onward, next), next);
            tangent = next;
            let around = std::f32::consts::PI * (before.radius + laid.radius);
            v -= before.length * self.repeats as f32 / around.max(1e-6);
            (laid.tangent, laid.x, laid.v) = (tangent, x, v);
            laid.is_point = laid.is_thin(laid.length.max(before.length));
            before = *laid;
        }
    }

    fn n_triangles(&self, sides: usize) -> usize {
        let stretches = self.laid.windows(2);
        let walls: usize =
            stretches.map(|ends| 2 - ends.iter().filter(|laid| laid.is_point).count()).sum();
        let ends = [(self.base, self.laid.first()), (self.tip, self.laid.last())];
        let discs = ends
            .iter()
            .filter(|(cap, laid)| *cap != Cap::Open && laid.is_some_and(|laid| !laid.is_point));
        if walls == 0 { 0 } else { (walls + discs.count()) * sides }
    }
}

/// `vector`, turned as the shortest turn from unit vector `from` to unit vector `to` does; as it
/// is where they are opposite.
fn carry(vector: Vec3, from: Vec3, to: Vec3) -> Vec3 {
    if from == to {
        return vector;
    }
    // Reflecting first along `from` and then along the middle of both is that turn; `vector` is
    // square to `from`, which leaves the second reflection only.
    let middle = from + to;
    let square = middle.length_squared();
    if square < 1e-8 {
        return vector;
    }
    vector - middle * (2.0 * vector.dot(middle) / square)
}

/// `vector` itself if it is a unit vector square to unit vector `tangent`, so that a tube that
/// continues another starts with the same bits, or else the nearest that is.
fn upright(vector: Vec3, tangent: Vec3) -> Vec3 {
    let lean = vector.dot(tangent).abs().max((vector.length_squared() - 1.0).abs());
    if lean < 4e-6 { vector } else { square(vector, tangent) }
}

/// `vector`, nearly a unit vector and nearly square to unit vector `tangent`, made both; a step
/// of Newton's method does for the small errors of a turn.
fn sharpen(vector: Vec3, tangent: Vec3) -> Vec3 {
    let flat = vector - tangent * vector.dot(tangent);
    let length_squared = flat.length_squared();
    if (length_squared - 1.0).abs() > 1e-3 {
        return square(vector, tangent);
    }
    flat * (1.5 - 0.5 * length_squared)
}

/// The unit vector square to unit vector `tangent` that is nearest to `vector`.
fn square(vector: Vec3, tangent: Vec3) -> Vec3 {
    let flat = vector - tangent * vector.dot(tangent);
    flat.try_normalize().unwrap_or_else(|| tangent.any_orthonormal_vector())
}

#[cfg(test)]
mod tests {
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
        let options = SweepOptions { repeats: 3, tip: Cap::Open, ..SweepOptions::default() };
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
        let clone =
            rings([(tube[2].center, 0.3), (tube[2].center + Vec3::new(-0.5, 0.0, 1.0), 0.2)]);
        let n_before = mesh.n_vertices();
        sweep.lay(&section, &clone, &SweepOptions { start, ..SweepOptions::default() });
        sweep.write(&section, &mut mesh);
        assert_eq!(mesh.positions[n_before..n_before + 7], mesh.positions[14..21]);
        assert_eq!(mesh.uvs[n_before..n_before + 7], mesh.uvs[14..21]);
        check(&mesh);
    }
}
