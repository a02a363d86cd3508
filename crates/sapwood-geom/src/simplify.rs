//! Fewer triangles for the same shape, by the library meshoptimizer.

use crate::Mesh;

/// How far a mesh is simplified: until one of the two is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Simplify {
    /// The share of its triangles that a mesh should keep, from 0 to 1.
    pub ratio: f32,
    /// How many metres the surface may move; without end if it is infinite.
    pub max_error: f32,
}

impl Mesh {
    /// The mesh with fewer triangles, and how many metres its surface moved, as the library
    /// estimates it. Vertices stay where they are, and those that are left keep their normals
    /// and texture coordinates.
    ///
    /// A mesh that is not [sound](Self::unsound) stays as it is, and so does every mesh where one
    /// of the limits is no number: that allows nothing.
    pub fn simplified(&self, how: &Simplify) -> (Mesh, f32) {
        let n = self.n_triangles();
        let wanted = (f64::from(how.ratio.clamp(0.0, 1.0)) * n as f64) as usize;
        // No number allows nothing.
        let allows = !how.ratio.is_nan() && how.max_error > 0.0;
        if wanted >= n || !allows || self.unsound().is_some() {
            return (self.clone(), 0.0);
        }
        let positions: Vec<[f32; 3]> = self.positions.iter().map(|p| p.to_array()).collect();
        let mut error = 0.0;
        let indices = meshopt::simplify_decoder(
            &self.indices,
            &positions,
            3 * wanted,
            how.max_error.min(f32::MAX),
            meshopt::SimplifyOptions::ErrorAbsolute,
            Some(&mut error),
        );
        (self.with_triangles(&indices), error)
    }

    /// The given triangles of this mesh, without the degenerate ones and without vertices that
    /// none of them uses; vertices stay in the order in which triangles come by them.
    fn with_triangles(&self, indices: &[u32]) -> Mesh {
        const UNUSED: u32 = u32::MAX;
        let mut numbers = vec![UNUSED; self.n_vertices()];
        let mut mesh = Mesh::default();
        for corners in indices.chunks_exact(3) {
            if self.is_degenerate([corners[0], corners[1], corners[2]]) {
                continue;
            }
            for index in corners {
                let number = &mut numbers[*index as usize];
                if *number == UNUSED {
                    *number = mesh.positions.len() as u32;
                    mesh.positions.push(self.positions[*index as usize]);
                    mesh.normals.push(self.normals[*index as usize]);
                    mesh.uvs.push(self.uvs[*index as usize]);
                }
                mesh.indices.push(*number);
            }
        }
        mesh
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::sphere;
    use crate::{MeshBvh, Purpose, Ray, Sides, Stream, StreamPath};
    use glam::Vec3;

    /// The largest distance from a unit sphere, at many points of the surface.
    fn distance_from_sphere(mesh: &Mesh) -> f32 {
        let bvh = MeshBvh::new(mesh);
        let mut stream = Stream::new(StreamPath::new(1), Purpose("directions"));
        let mut largest = 0.0f32;
        for _ in 0..20_000 {
            let direction = Vec3::from_array([(); 3].map(|()| stream.between(-1.0, 1.0)));
            let ray = Ray::new(Vec3::ZERO, direction);
            if ray.is_sound() {
                let hit = bvh.closest(mesh, &ray, f64::INFINITY, Sides::Both);
                largest =
                    largest.max((hit.expect("the sphere is closed").distance as f32 - 1.0).abs());
            }
        }
        largest
    }

    #[test]
    fn a_quarter_of_a_sphere_keeps_within_its_error() {
        let fine = sphere(5);
        let before = distance_from_sphere(&fine);
        let (coarse, error) = fine.simplified(&Simplify { ratio: 0.25, max_error: 0.05 });
        assert_eq!(coarse.fault(), None);
        assert!(coarse.n_triangles() <= fine.n_triangles() / 4, "{}", coarse.n_triangles());
        assert!(coarse.n_triangles() > fine.n_triangles() / 5, "{}", coarse.n_triangles());
        assert!(0.0 < error && error <= 0.05, "{error}");
        let moved = distance_from_sphere(&coarse);
        assert!(moved <= before + 2.0 * error, "moved {moved}, told {error}, before {before}");
    }

    #[test]
    fn the_error_ends_the_work_too() {
        let fine = sphere(5);
        let (coarse, error) = fine.simplified(&Simplify { ratio: 0.0, max_error: 0.01 });
        assert!(coarse.n_triangles() > 100 && error <= 0.01, "{} {error}", coarse.n_triangles());
        assert!(distance_from_sphere(&coarse) <= 0.03);
        let (same, error) = fine.simplified(&Simplify { ratio: 1.0, max_error: 0.01 });
        assert_eq!((same, error), (fine, 0.0));
    }

    #[test]
    fn a_limit_that_is_no_number_allows_nothing() {
        let fine = sphere(3);
        for (ratio, max_error) in [(f32::NAN, 1.0), (0.1, f32::NAN)] {
            assert_eq!(fine.simplified(&Simplify { ratio, max_error }), (fine.clone(), 0.0));
        }
    }

    #[test]
    fn what_is_not_sound_stays_as_it_is() {
        let mut mesh = sphere(2);
        mesh.indices[5] = 4_000;
        let all = Simplify { ratio: 0.1, max_error: 1.0 };
        assert_eq!(mesh.simplified(&all).0, mesh);
        let mut mesh = sphere(2);
        mesh.positions[5].y = f32::INFINITY;
        assert_eq!(mesh.simplified(&all).0, mesh);
        let (empty, _) = Mesh::default().simplified(&all);
        assert!(empty.is_empty());
    }
}
