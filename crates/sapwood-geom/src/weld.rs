//! Welding: pieces whose vertices tell what they are become one mesh.
//!
//! Who made the pieces says which vertices are one and the same; here they are brought together.
//! Nothing is guessed from how near things lie.

use glam::{Vec2, Vec3};

use crate::{Content, Digester, FixedMap, Mesh, content, fixed_state};

/// Pieces of a surface, all in one mesh, with an identity for each vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pieces {
    /// The triangles of all pieces, each with vertices of its own.
    pub mesh: Mesh,
    /// What each vertex is.
    pub identities: Vec<VertexIdentity>,
    /// Where pieces end.
    pub rims: Vec<Rim>,
}

content!(Pieces { mesh, identities, rims });

/// An end of a piece: the plane of a ring that it shares with other pieces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rim {
    /// What it is an end at; rims of equal joints are one.
    pub joint: u32,
    /// The middle of the ring, in metres.
    pub center: Vec3,
    /// The unit normal of the ring's plane, the same way round for all rims of a joint.
    pub normal: Vec3,
    /// What the plane weighs when rims become one; 0 where the piece follows the others.
    pub weight: f32,
}

content!(Rim { joint, center, normal, weight });

/// What a vertex is, whichever piece it belongs to. Vertices that are equal in everything but
/// the rim, and whose rims have one joint, become one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VertexIdentity {
    /// The number of the rim that it lies on.
    pub rim: u32,
    /// Which point of the joint it is: a place around the ring, say.
    pub place: u32,
    /// The part of the surface that shares normals at the point: walls, a cap, and so on.
    pub crease: u32,
    /// Which way from a seam of the texture it lies; 0 where there is none. Seams do not divide
    /// positions nor normals.
    pub seam: u32,
}

impl Content for VertexIdentity {
    fn write(&self, digester: &mut Digester) {
        let Self { rim, place, crease, seam } = self;
        digester.add(rim).add(place).add(crease).add(seam);
    }
}

impl Pieces {
    /// One mesh of all pieces.
    ///
    /// - The rims of a joint become one: their middles and normals are averaged by weight, and
    ///   each rim is moved there and turned, without twist, into the common plane. Were positions
    ///   averaged as they stand, a ring would be drawn together at each bend, by the cosine of half
    ///   the angle.
    /// - Then positions and texture coordinates of equal vertices are averaged. Of vertices on the
    ///   two sides of a seam, that with `seam` 0 counts for the position.
    /// - A triangle of which two corners have become one point is left out.
    /// - Normals are the sum of those of the triangles around the point within the crease,
    ///   weighed by area. A triangle that would have a normal more than 90 degrees off its own
    ///   keeps its own.
    ///
    /// Vertices stand in the order in which triangles use them first. A vertex without an
    /// identity, or with a rim that is not there, is left out with its triangles.
    pub fn weld(&self) -> Mesh {
        self.weld_telling().0
    }

    /// As [`weld`](Self::weld); tells for each triangle which one of the pieces it was, in
    /// ascending order.
    pub fn weld_telling(&self) -> (Mesh, Vec<u32>) {
        let planes = self.joint_planes();
        let mut points = Points { numbers: FixedMap::with_hasher(fixed_state()), sums: Vec::new() };
        let point_of: Vec<Option<u32>> = (0..self.mesh.positions.len())
            .map(|vertex| {
                let identity = self.identities.get(vertex)?;
                let rim = self.rims.get(identity.rim as usize)?;
                let plane = planes.get(&rim.joint)?;
                let arm = plane.turned(rim, self.mesh.positions[vertex]);
                let counts = identity.seam == 0;
                Some(points.add((rim.joint, identity.place), plane.center, arm, counts))
            })
            .collect();
        let mut welded = Welded::new(points.finish(), self);
        let mut of = Vec::with_capacity(self.mesh.n_triangles());
        for (triangle, corners) in (0..).zip(self.mesh.indices.chunks_exact(3)) {
            let [a, b, c] = [corners[0], corners[1], corners[2]];
            let [Some(p), Some(q), Some(r)] = [a, b, c].map(|i| point_of[i as usize]) else {
                continue;
            };
            if p != q && q != r && r != p {
                welded.add([(a, p), (b, q), (c, r)]);
                of.push(triangle);
            }
        }
        (welded.finish(), of)
    }

    /// For each joint the plane in which its rims meet.
    fn joint_planes(&self) -> FixedMap<u32, Plane> {
        let mut planes: FixedMap<u32, Plane> = FixedMap::with_hasher(fixed_state());
        for rim in &self.rims {
            let weight = rim.weight.max(0.0);
            let plane = planes.entry(rim.joint).or_insert(Plane {
                center: Vec3::ZERO,
                normal: Vec3::ZERO,
                weight: 0.0,
                first: *rim,
            });
            // Against the first, lest large coordinates swallow small differences.
            plane.center += (rim.center - plane.first.center) * weight;
            plane.normal += rim.normal * weight;
            plane.weight += weight;
        }
        for plane in planes.values_mut() {
            plane.normal = plane.normal.normalize_or(plane.first.normal);
            let aside = if plane.weight > 0.0 { plane.center / plane.weight } else { Vec3::ZERO };
            plane.center = plane.first.center + aside;
        }
        planes
    }
}

/// Where the rims of a joint meet.
struct Plane {
    center: Vec3,
    normal: Vec3,
    weight: f32,
    first: Rim,
}

impl Plane {
    /// The arm from a rim's middle to a point, turned into the plane by the shortest turn.
    fn turned(&self, rim: &Rim, position: Vec3) -> Vec3 {
        let arm = position - rim.center;
        let middle = rim.normal + self.normal;
        let square = middle.length_squared();
        if rim.normal == self.normal || square < 1e-8 {
            return arm;
        }
        // Two reflections, first along the rim's normal, then along the middle of both.
        let arm = arm - rim.normal * (2.0 * arm.dot(rim.normal));
        arm - middle * (2.0 * arm.dot(middle) / square)
    }
}

/// Points by joint and place, with the arms from the joint's middle that vertices propose.
struct Points {
    numbers: FixedMap<(u32, u32), u32>,
    sums: Vec<PointSum>,
}

#[derive(Clone, Copy)]
struct PointSum {
    center: Vec3,
    sum: Vec3,
    n: u32,
    /// Where nothing else counts.
    first: Vec3,
}

impl Points {
    fn add(&mut self, key: (u32, u32), center: Vec3, arm: Vec3, counts: bool) -> u32 {
        let next = self.sums.len() as u32;
        let number = *self.numbers.entry(key).or_insert(next);
        if number == next {
            self.sums.push(PointSum { center, sum: Vec3::ZERO, n: 0, first: arm });
        }
        if counts {
            let sums = &mut self.sums[number as usize];
            sums.sum += arm;
            sums.n += 1;
        }
        number
    }

    fn finish(self) -> Vec<Vec3> {
        let mean = |p: PointSum| p.center + if p.n == 0 { p.first } else { p.sum / p.n as f32 };
        self.sums.into_iter().map(mean).collect()
    }
}

/// The mesh as it grows.
struct Welded<'a> {
    positions: Vec<Vec3>,
    pieces: &'a Pieces,
    mesh: Mesh,
    /// By point, crease and seam.
    vertices: FixedMap<(u32, u32, u32), u32>,
    /// By point and crease.
    normals: FixedMap<(u32, u32), u32>,
    sums: Vec<Vec3>,
    /// For each vertex its place in `sums`, and how many vertices its coordinates are the sum of.
    normal_of: Vec<(u32, u32)>,
    /// Which vertices of the pieces have given their texture coordinates.
    has_given: Vec<bool>,
}

impl<'a> Welded<'a> {
    fn new(positions: Vec<Vec3>, pieces: &'a Pieces) -> Self {
        Self {
            positions,
            pieces,
            mesh: Mesh::default(),
            vertices: FixedMap::with_hasher(fixed_state()),
            normals: FixedMap::with_hasher(fixed_state()),
            sums: Vec::new(),
            normal_of: Vec::new(),
            has_given: vec![false; pieces.mesh.positions.len()],
        }
    }

    /// Adds a triangle; its corners are vertices of the pieces with their points.
    fn add(&mut self, corners: [(u32, u32); 3]) {
        let [p, q, r] = corners.map(|(_, point)| self.positions[point as usize]);
        let face = (q - p).cross(r - p);
        for (vertex, point) in corners {
            let number = self.vertex(vertex, point);
            self.mesh.indices.push(number);
            let (sum, _) = self.normal_of[number as usize];
            self.sums[sum as usize] += face;
        }
    }

    fn vertex(&mut self, vertex: u32, point: u32) -> u32 {
        let VertexIdentity { crease, seam, .. } = self.pieces.identities[vertex as usize];
        let next = self.mesh.positions.len() as u32;
        let number = *self.vertices.entry((point, crease, seam)).or_insert(next);
        if number == next {
            let next = self.sums.len() as u32;
            let sum = *self.normals.entry((point, crease)).or_insert(next);
            if sum == next {
                self.sums.push(Vec3::ZERO);
            }
            self.mesh.positions.push(self.positions[point as usize]);
            self.mesh.uvs.push(Vec2::ZERO);
            self.normal_of.push((sum, 0));
        }
        if !std::mem::replace(&mut self.has_given[vertex as usize], true) {
            self.mesh.uvs[number as usize] += self.pieces.mesh.uvs[vertex as usize];
            self.normal_of[number as usize].1 += 1;
        }
        number
    }

    fn finish(mut self) -> Mesh {
        for (uv, (_, n)) in self.mesh.uvs.iter_mut().zip(&self.normal_of) {
            *uv /= (*n).max(1) as f32;
        }
        let unit: Vec<Vec3> = self.sums.iter().map(|sum| sum.normalize_or(Vec3::Z)).collect();
        self.mesh.normals = self.normal_of.iter().map(|(sum, _)| unit[*sum as usize]).collect();
        self.mesh.keep_own_normals(0, |_| ());
        self.mesh
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cap, Ring, Section, Sweep, SweepOptions, Swept};

    /// A tube through `rings` and the pieces between them, each ring a joint.
    fn tube_and_pieces(section: &Section, rings: &[Ring]) -> (Mesh, Pieces) {
        let (mut sweep, mut piece) = (Sweep::default(), Sweep::default());
        let options = SweepOptions { base: Cap::Flat, ..SweepOptions::default() };
        let (mut tube, mut pieces) = (Mesh::default(), Pieces::default());
        sweep.lay(section, rings, &options);
        sweep.write(section, &mut tube);
        for foot in 0..sweep.n_kept() - 1 {
            sweep.piece(section, foot..=foot + 1, &mut piece);
            let first = pieces.rims.len() as u32;
            pieces.rims.extend((foot as u32..).zip(piece.planes()).map(|(joint, plane)| Rim {
                joint,
                center: plane.center,
                normal: plane.tangent,
                weight: plane.weight,
            }));
            let sides = section.n_sides();
            pieces.identities.extend(piece.swept(section).into_iter().map(|swept| match swept {
                Swept::Wall { ring, place } => VertexIdentity {
                    rim: first + ring,
                    place: place % sides,
                    crease: 0,
                    seam: place / sides,
                },
                Swept::Point { ring, side, .. } => {
                    VertexIdentity { rim: first + ring, place: 0, crease: 1 + side, seam: 0 }
                }
                Swept::Disc { ring, place } => VertexIdentity {
                    rim: first + ring,
                    place: place.unwrap_or(sides),
                    crease: 1,
                    seam: 0,
                },
            }));
            piece.write(section, &mut pieces.mesh);
            assert_eq!(pieces.identities.len(), pieces.mesh.n_vertices());
        }
        (tube, pieces)
    }

    fn bent() -> Vec<Ring> {
        let points = [[0.0, 0.0, 0.0], [0.1, 0.0, 1.0], [0.8, 0.3, 1.4], [0.9, 1.2, 2.4]];
        let radii = [0.2, 0.15, 0.1, 0.05];
        points
            .into_iter()
            .zip(radii)
            .map(|(point, radius)| Ring { center: Vec3::from(point), radius })
            .collect()
    }

    #[test]
    fn welded_pieces_are_the_swept_tube() {
        let section = Section::lobed(20, 5, 0.2);
        for tip in [0.05, 0.0] {
            let mut rings = bent();
            rings[3].radius = tip;
            let (tube, pieces) = tube_and_pieces(&section, &rings);
            let welded = pieces.weld();
            assert_eq!(welded.fault(), None);
            assert_eq!(welded.n_open_edges(), 0);
            assert_eq!(
                (welded.n_triangles(), welded.n_vertices()),
                (tube.n_triangles(), tube.n_vertices())
            );
            for (one, other) in welded.indices.iter().zip(&tube.indices) {
                let [one, other] = [(&welded, one), (&tube, other)]
                    .map(|(mesh, i)| (mesh.positions[*i as usize], mesh.uvs[*i as usize]));
                assert!(one.0.distance(other.0) < 1e-6, "{} {}", one.0, other.0);
                assert!(one.1.distance(other.1) < 1e-6, "{} {}", one.1, other.1);
            }
        }
    }

    #[test]
    fn before_welding_pieces_have_gaps_and_rings_of_their_own() {
        let section = Section::round(12);
        let (_, pieces) = tube_and_pieces(&section, &bent());
        // Base, tip and four open rings.
        assert_eq!(pieces.mesh.n_open_edges(), 4 * 12);
        for (vertex, identity) in pieces.identities.iter().enumerate() {
            let rim = pieces.rims[identity.rim as usize];
            let arm = pieces.mesh.positions[vertex] - rim.center;
            assert!(arm.dot(rim.normal).abs() < 1e-6, "{arm} is not square to {}", rim.normal);
        }
    }

    #[test]
    fn a_ring_keeps_its_radius_at_a_bend() {
        let (_, pieces) = tube_and_pieces(&Section::round(12), &bent());
        let welded = pieces.weld();
        let ring = bent()[2];
        let on_ring = |p: &&Vec3| (p.distance(ring.center) - ring.radius).abs() < 1e-6;
        assert_eq!(welded.positions.iter().filter(on_ring).count(), 13);
    }

    #[test]
    fn welding_takes_no_notice_of_where_things_lie() {
        // Two triangles at one place with different identities stay two.
        let (_, pieces) = tube_and_pieces(&Section::round(4), &bent()[..2]);
        let mut twice = pieces.clone();
        let twin = pieces.mesh.clone();
        twice.mesh.append(&twin, &glam::Affine3::IDENTITY);
        let n_rims = pieces.rims.len() as u32;
        twice.rims.extend(pieces.rims.iter().map(|rim| Rim { joint: rim.joint + 10, ..*rim }));
        twice
            .identities
            .extend(pieces.identities.iter().map(|i| VertexIdentity { rim: i.rim + n_rims, ..*i }));
        assert_eq!(twice.weld().n_vertices(), 2 * pieces.weld().n_vertices());
        twice.identities.truncate(pieces.identities.len());
        assert_eq!(twice.weld(), pieces.weld());
    }
}
