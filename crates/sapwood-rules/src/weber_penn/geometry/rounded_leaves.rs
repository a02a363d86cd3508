//! Leaves whose normals follow the crown instead of each leaf, so that it looks soft: instances share
//! the normals of their mesh, so such leaves are written out, each with its own.

use glam::{Affine3, Vec3};
use sapwood_geom::{Mesh, content};

use crate::weber_penn::{Crown, Level};

/// How normals of leaves are rounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rounding {
    /// 0 the leaf's own, 1 the crown's alone.
    share: f32,
    /// The middle of the crown, in tree space.
    center: Vec3,
    /// Its inverse half axes, squared.
    falloff: Vec3,
}

content!(Rounding { share, center, falloff });

/// The least that a crown is wide against its height, and high against its width.
const NARROWEST: f32 = 0.2;

impl Rounding {
    /// Rounds by `share` toward the ellipsoid that the crown of a tree of this size about fills: from
    /// its bare trunk to its top, as wide as the first branches reach.
    pub(crate) fn new(share: f32, scale_tree: f32, crown: &Crown, levels: [&Level; 2]) -> Self {
        let [trunk, branches] = levels;
        let top = (trunk.length * scale_tree).max(1e-3);
        let foot = (crown.base_size * scale_tree).min(0.9 * top);
        let half_height = 0.5 * (top - foot);
        let half_width = if crown.levels > 1 {
            branches.length * top * libm::sinf(branches.down_angle).abs()
        } else {
            half_height
        };
        let half_width = half_width.max(NARROWEST * half_height);
        let half_height = half_height.max(NARROWEST * half_width);
        let half_axes = Vec3::new(half_width, half_width, half_height);
        let falloff = (half_axes * half_axes).recip();
        Self { share: share.clamp(0.0, 1.0), center: Vec3::Z * (0.5 * (foot + top)), falloff }
    }

    /// Away from the crown, at a place in it.
    fn outward(&self, place: Vec3) -> Vec3 {
        ((place - self.center) * self.falloff).normalize_or(Vec3::Z)
    }
}

/// A leaf's mesh at all its places, with rounded normals. Sheets that may turn have the side outward
/// that points there anyway, for whoever draws both sides turns the normals of the back.
pub(crate) fn rounded_leaves(
    leaf: &Mesh,
    turns: bool,
    places: &[Affine3],
    rounding: &Rounding,
) -> Mesh {
    let n_vertices = leaf.n_vertices() * places.len();
    let mut mesh = Mesh {
        positions: Vec::with_capacity(n_vertices),
        normals: Vec::with_capacity(n_vertices),
        uvs: Vec::with_capacity(n_vertices),
        indices: Vec::with_capacity(leaf.indices.len() * places.len()),
    };
    for place in places {
        let outward = rounding.outward(place.translation);
        let is_turned = turns && place.matrix3.y_axis.dot(outward) < 0.0;
        let (first, first_index) = (mesh.positions.len(), mesh.indices.len());
        mesh.append(leaf, place);
        let positions = &mesh.positions[first..];
        for (normal, position) in mesh.normals[first..].iter_mut().zip(positions) {
            let own = if is_turned { -*normal } else { *normal };
            let round = rounding.outward(*position);
            *normal = own.lerp(round, rounding.share).normalize_or(round);
        }
        if is_turned {
            mesh.indices[first_index..].chunks_exact_mut(3).for_each(|t| t.swap(1, 2));
        }
    }
    mesh
}

/// The number behind the last triangle of each leaf.
pub(crate) fn ends_of_leaves(leaf: &Mesh, n: usize) -> Vec<u32> {
    (1..=n as u32).map(|number| number * leaf.n_triangles() as u32).collect()
}

/// What belongs to each leaf, for each of its vertices.
pub(crate) fn for_vertices(leaf: &Mesh, of_leaves: &[u32]) -> Vec<u32> {
    let each = |value: &u32| std::iter::repeat_n(*value, leaf.n_vertices());
    of_leaves.iter().flat_map(each).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::weber_penn::geometry::leaf_mesh;
    use crate::weber_penn::{LeafShape, Species};

    fn rounding(share: f32) -> Rounding {
        let species = Species::default();
        let levels = [0, 1].map(|n| Level::new(&species, n));
        Rounding::new(share, 10.0, &Crown::new(&species), levels.each_ref())
    }

    #[test]
    fn normals_go_from_the_leafs_own_to_the_crowns() {
        let leaf = leaf_mesh(LeafShape::Oval);
        let places: Vec<Affine3> = (0..40)
            .map(|i| {
                let angle = i as f32;
                let place =
                    Vec3::new(2.0 * libm::cosf(angle), 2.0 * libm::sinf(angle), 0.25 * angle);
                Affine3::from_rotation_translation(glam::Quat::from_rotation_x(angle), place)
            })
            .collect();
        let none = rounded_leaves(&leaf, true, &places, &rounding(0.0));
        let mut n_turned = 0;
        for (number, place) in places.iter().enumerate() {
            let outward = rounding(0.0).outward(place.translation);
            let normal = none.normals[number * leaf.n_vertices()];
            assert!(normal.dot(outward) >= 0.0);
            n_turned += u32::from(place.matrix3.y_axis.dot(outward) < 0.0);
            assert!((normal.dot(place.matrix3.y_axis).abs() - 1.0).abs() < 1e-5);
        }
        assert!((5..35).contains(&n_turned), "{n_turned}");
        for share in [0.4, 1.0] {
            let mesh = rounded_leaves(&leaf, true, &places, &rounding(share));
            assert_eq!(mesh.fault(), None);
            assert_eq!((&mesh.positions, &mesh.indices), (&none.positions, &none.indices));
            for (normal, position) in mesh.normals.iter().zip(&mesh.positions) {
                let outward = rounding(share).outward(*position);
                assert!(share < 1.0 || normal.dot(outward) > 0.9999, "{normal}");
            }
        }
    }

    #[test]
    fn bodies_keep_their_outside() {
        let ball = leaf_mesh(LeafShape::Sphere);
        let places = [Affine3::from_rotation_x(3.0)];
        let mesh = rounded_leaves(&ball, false, &places, &rounding(0.5));
        assert_eq!(mesh.indices, ball.indices);
        assert_eq!(ends_of_leaves(&ball, 3), [20, 40, 60]);
        assert_eq!(for_vertices(&leaf_mesh(LeafShape::Triangle), &[4, 9]), [4, 4, 4, 9, 9, 9]);
    }
}
