//! Shapes that tests know all about.

use glam::{Vec2, Vec3};

use crate::{FixedMap, Mesh, fixed_state};

fn indexed(positions: Vec<Vec3>, indices: Vec<u32>) -> Mesh {
    let normals = positions.iter().map(|position| position.normalize()).collect();
    Mesh { uvs: vec![Vec2::ZERO; positions.len()], normals, positions, indices }
}

/// A cube of edge length 2 about the origin, with eight vertices.
pub(crate) fn cube() -> Mesh {
    let corner = |i: u32| {
        let side = |bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        Vec3::new(side(0), side(1), side(2))
    };
    let faces: [[u32; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let indices = faces.into_iter().flat_map(|[a, b, c, d]| [a, b, c, a, c, d]).collect();
    indexed((0..8).map(corner).collect(), indices)
}

/// A sphere of radius 1: an octahedron whose triangles are quartered `n` times.
pub(crate) fn sphere(n: u32) -> Mesh {
    let mut positions = vec![Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    let mut indices: Vec<u32> = Vec::new();
    for (x, y, z) in [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4)] {
        indices.extend([x, y, z, y, x, 5]);
        debug_assert_eq!(z, 4);
    }
    for _ in 0..n {
        let mut between: FixedMap<(u32, u32), u32> = FixedMap::with_hasher(fixed_state());
        let mut finer = Vec::new();
        for corners in indices.chunks_exact(3) {
            let [a, b, c] = [corners[0], corners[1], corners[2]];
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(i, j)| {
                *between.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    positions.push((positions[i as usize] + positions[j as usize]).normalize());
                    positions.len() as u32 - 1
                })
            });
            finer.extend([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca]);
        }
        indices = finer;
    }
    indexed(positions, indices)
}
