//! The meshes of leaves whose outline is an image: coarse polygons around it, laid so that image
//! and mesh agree.

use glam::{Vec2, Vec3};
use sapwood_geom::Mesh;
use sapwood_images::LeafOutline;

use super::leaf_mesh;
use crate::weber_penn::LeafShape;

/// The mesh of one leaf of this shape under an image with this outline; base at the origin, tip
/// at z = 1, as [`leaf_mesh`] has it.
///
/// Flat shapes become the outline's [hull](LeafOutline::hull), as wide as the shape is. Folded
/// shapes stay as they are, and so does every shape under an image without an outline.
pub fn leaf_card(shape: LeafShape, outline: LeafOutline) -> Mesh {
    let is_solid = matches!(shape, LeafShape::Palm | LeafShape::Sphere);
    if is_solid || outline == LeafOutline::Whole {
        return leaf_mesh(shape);
    }
    let half_width = half_width(shape);
    let mut card = Mesh::default();
    for [across, along] in outline.hull() {
        for side in [1.0, -1.0] {
            let across = side * across;
            card.positions.push(Vec3::new(across * half_width, 0.0, *along));
            card.normals.push(Vec3::Y);
            // Seen from above with the tip up, x runs to the left.
            card.uvs.push(Vec2::new(0.5 - 0.5 * across, 1.0 - along));
        }
    }
    for row in 1..outline.hull().len() as u32 {
        let [right, left] = [2 * row, 2 * row + 1];
        card.indices.extend([left - 2, left, right - 2, left, right, right - 2]);
    }
    card
}

/// Half the width of a shape one unit long.
pub(crate) fn half_width(shape: LeafShape) -> f32 {
    match shape {
        LeafShape::Linear => 0.0625,
        LeafShape::Elliptic => 0.25,
        LeafShape::Oval
        | LeafShape::Diamond
        | LeafShape::Triangle
        | LeafShape::Heart
        | LeafShape::Maple3
        | LeafShape::Maple5
        | LeafShape::Palmate
        | LeafShape::Oak3
        | LeafShape::Leaflets3
        | LeafShape::Square
        | LeafShape::Palm
        | LeafShape::Sphere
        | LeafShape::Disc(_) => 0.5,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cards_face_up_and_agree_with_their_images() {
        for (_, shape) in LeafShape::NAMES {
            for (name, outline) in LeafOutline::NAMES {
                let card = leaf_card(shape, outline);
                assert_eq!(card.fault(), None, "{shape:?} {name}");
                let bound = card.bound().aabb;
                assert!(bound.min.z.abs() < 1e-6 && (bound.max.z - 1.0).abs() < 1e-6);
                let width = 2.0 * half_width(shape);
                assert!(bound.size().x <= width + 1e-6, "{shape:?} {name}");
                if card.positions.iter().all(|position| position.y == 0.0) {
                    for t in card.indices.chunks_exact(3) {
                        let [a, b, c] = [t[0], t[1], t[2]].map(|i| card.positions[i as usize]);
                        assert!((b - a).cross(c - a).y > 0.0, "{shape:?} {name}");
                    }
                }
                if outline != LeafOutline::Whole {
                    for (position, uv) in card.positions.iter().zip(&card.uvs) {
                        let x = (0.5 - uv.x) * width;
                        assert!(shape == LeafShape::Sphere || (position.x - x).abs() < 1e-6);
                    }
                }
            }
        }
    }

    #[test]
    fn cards_have_no_more_triangles_than_the_shapes_they_stand_for() {
        for (shape, outline) in [
            (LeafShape::Oval, LeafOutline::Orbicular),
            (LeafShape::Oval, LeafOutline::Deltoid),
            (LeafShape::Oval, LeafOutline::Ovate),
            (LeafShape::Oval, LeafOutline::Lanceolate),
            (LeafShape::Oval, LeafOutline::Oak),
            (LeafShape::Oval, LeafOutline::Elliptic),
            (LeafShape::Oval, LeafOutline::Trilobed),
            (LeafShape::Elliptic, LeafOutline::Ovate),
            (LeafShape::Heart, LeafOutline::Cordate),
            (LeafShape::Maple5, LeafOutline::Maple),
            (LeafShape::Palmate, LeafOutline::Palmate),
            (LeafShape::Leaflets3, LeafOutline::Leaflets),
            (LeafShape::Linear, LeafOutline::Needle),
            (LeafShape::Linear, LeafOutline::Needles),
            (LeafShape::Palm, LeafOutline::Blade),
        ] {
            let (card, mesh) = (leaf_card(shape, outline), leaf_mesh(shape));
            assert!(card.n_triangles() <= mesh.n_triangles(), "{shape:?} {outline:?}");
        }
    }
}
