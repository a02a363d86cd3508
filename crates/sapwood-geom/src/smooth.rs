//! Smooth normals: what a surface's normals are when only its triangles are known.

use glam::{Vec2, Vec3};

use crate::{FixedMap, Mesh, fixed_state};

/// Beyond so many triangles at one point all of them share a normal, whatever the crease, for
/// each is compared with each.
const MOST_COMPARED: usize = 512;

impl Mesh {
    /// The same triangles with normals of their own making.
    ///
    /// At each corner the normals of all triangles that meet there are weighed by the angle they
    /// have there, of those that lean from the corner's own triangle by no more than `crease`
    /// radians. Corners meet where their positions are equal, whatever their normals and texture
    /// coordinates were; vertices are split where normals differ. The mesh must be sound;
    /// degenerate triangles keep the normals they had.
    pub fn with_smooth_normals(&self, crease: f32) -> Mesh {
        let faces: Vec<Vec3> = self.triangles().map(|[a, b, c]| face_normal(a, b, c)).collect();
        let (first, corners) = self.corners_by_position();
        let least = libm::cosf(crease.clamp(0.0, std::f32::consts::PI)) - 1e-6;
        let mut normals = vec![Vec3::ZERO; self.indices.len()];
        for ends in first.windows(2) {
            let here = &corners[ends[0] as usize..ends[1] as usize];
            let all_share = here.len() > MOST_COMPARED;
            let sum = |corner: Option<u32>| {
                let own = corner.map(|corner| faces[corner as usize / 3]);
                here.iter().fold(Vec3::ZERO, |sum, other| {
                    let face = faces[*other as usize / 3];
                    let is_near = own.is_none_or(|own| own.dot(face) >= least);
                    if is_near { sum + face * self.angle_at(*other) } else { sum }
                })
            };
            let of_all = if all_share { sum(None) } else { Vec3::ZERO };
            for corner in here {
                let sum = if all_share { of_all } else { sum(Some(*corner)) };
                let before = self.normals[self.indices[*corner as usize] as usize];
                let face = faces[*corner as usize / 3];
                let is_degenerate = face == Vec3::ZERO;
                let normal = if is_degenerate { before } else { sum.normalize_or(face) };
                normals[*corner as usize] = normal;
            }
        }
        self.with_corner_normals(&normals)
    }

    fn triangles(&self) -> impl Iterator<Item = [Vec3; 3]> + '_ {
        self.indices
            .chunks_exact(3)
            .map(|corners| [0, 1, 2].map(|i| self.positions[corners[i] as usize]))
    }

    /// All corners, those with equal positions side by side in their order, and where each such
    /// group begins; the last entry is the end.
    fn corners_by_position(&self) -> (Vec<u32>, Vec<u32>) {
        let mut groups: FixedMap<[u32; 3], u32> = FixedMap::with_hasher(fixed_state());
        let group_of: Vec<u32> = self
            .indices
            .iter()
            .map(|index| {
                // Adding zero makes the negative zero the positive one.
                let bits = (self.positions[*index as usize] + 0.0).to_array().map(f32::to_bits);
                let next = groups.len() as u32;
                *groups.entry(bits).or_insert(next)
            })
            .collect();
        let mut first = vec![0u32; groups.len() + 1];
        for group in &group_of {
            first[*group as usize + 1] += 1;
        }
        for i in 1..first.len() {
            first[i] += first[i - 1];
        }
        let mut next = first.clone();
        let mut corners = vec![0u32; self.indices.len()];
        for (corner, group) in group_of.iter().enumerate() {
            let place = &mut next[*group as usize];
            corners[*place as usize] = corner as u32;
            *place += 1;
        }
        (first, corners)
    }

    /// The angle that a triangle has at a corner, in radians.
    fn angle_at(&self, corner: u32) -> f32 {
        let first = corner - corner % 3;
        let at = |i: u32| self.positions[self.indices[(first + i % 3) as usize] as usize];
        let here = at(corner % 3);
        let (one, other) = (at(corner % 3 + 1) - here, at(corner % 3 + 2) - here);
        libm::atan2f(one.cross(other).length(), one.dot(other))
    }

    /// The same triangles with a normal for each corner; equal vertices become one.
    fn with_corner_normals(&self, normals: &[Vec3]) -> Mesh {
        type Key = ([u32; 3], [u32; 2], [u32; 3]);
        let bits = |v: Vec3| v.to_array().map(f32::to_bits);
        let mut known: FixedMap<Key, u32> = FixedMap::with_hasher(fixed_state());
        let mut mesh = Mesh::default();
        for (index, normal) in self.indices.iter().zip(normals) {
            let (position, uv) = (self.positions[*index as usize], self.uvs[*index as usize]);
            let key = (bits(position), Vec2::to_array(&uv).map(f32::to_bits), bits(*normal));
            let vertex = *known.entry(key).or_insert_with(|| {
                mesh.positions.push(position);
                mesh.normals.push(*normal);
                mesh.uvs.push(uv);
                mesh.positions.len() as u32 - 1
            });
            mesh.indices.push(vertex);
        }
        mesh
    }
}

/// The unit normal of a triangle; zero where it has none.
fn face_normal(a: Vec3, b: Vec3, c: Vec3) -> Vec3 {
    // In `f64`, so that small triangles far from the origin have one too.
    let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
    (b - a).cross(c - a).normalize_or_zero().as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{cube, sphere};

    #[test]
    fn a_cube_with_a_crease_keeps_its_faces() {
        let mesh = cube().with_smooth_normals(30.0f32.to_radians());
        assert_eq!(mesh.fault(), None);
        assert_eq!((mesh.n_vertices(), mesh.n_triangles()), (24, 12));
        for corners in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|i| mesh.positions[corners[i] as usize]);
            let face = face_normal(a, b, c);
            assert!(corners.iter().all(|i| mesh.normals[*i as usize].distance(face) < 1e-6));
        }
    }

    #[test]
    fn a_cube_without_a_crease_is_round_at_its_corners() {
        let mesh = cube().with_smooth_normals(std::f32::consts::PI);
        assert_eq!((mesh.n_vertices(), mesh.n_triangles()), (8, 12));
        for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
            // By angle, for two triangles of a face may meet where one of another does.
            assert!(normal.distance(position.normalize()) < 1e-5, "{position} {normal}");
        }
    }

    #[test]
    fn a_sphere_has_radial_normals() {
        let mut flat = sphere(4);
        flat.normals.fill(Vec3::X);
        let mesh = flat.with_smooth_normals(1.0);
        assert_eq!((mesh.fault(), mesh.n_vertices()), (None, flat.n_vertices()));
        for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
            assert!(normal.dot(position.normalize()) > 0.9995, "{position} {normal}");
        }
    }

    #[test]
    fn texture_seams_stay_and_do_not_show() {
        let mut mesh = sphere(3);
        // A vertex of every triangle of its own, each with another texture coordinate.
        let corners = mesh.indices.clone();
        mesh.positions = corners.iter().map(|i| mesh.positions[*i as usize]).collect();
        mesh.uvs = (0..corners.len()).map(|i| Vec2::new(i as f32, 0.0)).collect();
        mesh.normals = vec![Vec3::Y; corners.len()];
        mesh.indices = (0..corners.len() as u32).collect();
        let smooth = mesh.with_smooth_normals(1.0);
        assert_eq!(smooth.uvs, mesh.uvs);
        for (position, normal) in smooth.positions.iter().zip(&smooth.normals) {
            assert!(normal.dot(position.normalize()) > 0.999, "{position} {normal}");
        }
    }
}
