//! Geometry in the order that thins evenly.
//!
//! What is grown lies in the order of creation, in which neighbours grow beside each other; taking
//! one of each mass first, then a second of each, keeps what is left all over the tree.

use glam::{Vec2, Vec3};
use sapwood_geom::{Mesh, Polyline};
use sapwood_graph::even_order;

use super::FadingItem;
use crate::weber_penn::geometry::{Band, point_half_width};
use crate::weber_penn::look::BESIDE_MIDRIB;
use crate::weber_penn::{LeafShape, leaf_mesh};

/// Bands in their new order.
pub(crate) struct OrderedBands {
    /// The surface with its triangles in that order.
    pub(crate) mesh: Mesh,
    /// For each band, the number behind its last triangle.
    pub(crate) ends: Vec<u32>,
    /// For each band, its stem.
    pub(crate) stems: Vec<u32>,
    /// For each band, its middle line.
    pub(crate) lines: Vec<Polyline>,
}

/// A surface with its bands in an order that thins evenly.
pub(crate) fn evenly_ordered_bands(
    mut mesh: Mesh,
    bands: &[Band],
    item: FadingItem,
) -> OrderedBands {
    let mut indices = Vec::with_capacity(mesh.indices.len());
    let (mut ends, mut stems, mut lines) = (Vec::new(), Vec::new(), Vec::new());
    for number in even_order(bands.len() as u32, item.mass()) {
        let number = number as usize;
        let start = number.checked_sub(1).map_or(0, |before| bands[before].end);
        let Band { stem, end, rings } = bands[number];
        indices.extend_from_slice(&mesh.indices[3 * start as usize..3 * end as usize]);
        ends.push(indices.len() as u32 / 3);
        stems.push(stem);
        let points = rings.map(|ring| ring.center).to_vec();
        lines.push(Polyline { points, radii: rings.map(|ring| ring.radius).to_vec() });
    }
    mesh.indices = indices;
    OrderedBands { mesh, ends, stems, lines }
}

/// Leaves, or what there is of each, in an order that thins evenly.
pub(crate) fn evenly_ordered_leaves<L: Copy>(leaves: &[L]) -> Vec<L> {
    let order = even_order(leaves.len() as u32, FadingItem::Leaves.mass());
    order.map(|number| leaves[number as usize]).collect()
}

/// What stands for one leaf from afar: a single triangle in the leaf's plane, from its base to its
/// tip, that covers as much from all sides together as the leaf's own shape.
///
/// A point proper would have no material, and no size in a file. All of it has the colour that the
/// leaf's image has beside its middle.
pub(crate) fn leaf_point(shape: LeafShape) -> Mesh {
    point_for(&leaf_mesh(shape), matches!(shape, LeafShape::Sphere), BESIDE_MIDRIB)
}

/// As [`leaf_point`], for a mesh one long that is a body or a sheet; all of it has the colour that the
/// texture has at `spot`.
pub(crate) fn point_for(mesh: &Mesh, is_closed: bool, spot: Vec2) -> Mesh {
    let half_width = point_half_width(mesh, is_closed);
    Mesh {
        positions: vec![Vec3::new(half_width, 0.0, 0.0), Vec3::new(-half_width, 0.0, 0.0), Vec3::Z],
        normals: vec![Vec3::Y; 3],
        uvs: vec![spot; 3],
        indices: vec![0, 1, 2],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    use sapwood_geom::StreamPath;

    use crate::weber_penn::geometry::{banded_surface, surface};
    use crate::weber_penn::{Crown, Detail, Level, Species, Target, TrunkForm, grow, trunks};

    #[test]
    fn points_face_up_and_cover_as_much_as_the_shape() {
        for (_, shape) in LeafShape::NAMES {
            let point = leaf_point(shape);
            assert_eq!(point.fault(), None, "{shape:?}");
            let [a, b, c] = [0, 1, 2].map(|i| point.positions[i]);
            let doubled = (b - a).cross(c - a);
            assert!(doubled.y > 0.1 && doubled.y < 4.0, "{shape:?} {doubled}");
        }
        let square = leaf_point(LeafShape::Square);
        assert!((square.positions[0].x - 1.0).abs() < 1e-6);
    }

    #[test]
    fn bands_are_the_whole_surface_in_another_order() {
        let mut species = Species { levels: 1, ..Species::default() };
        species.level[0].seg_splits = 1.0;
        species.level[0].curve_res = 12;
        let crown = Crown::new(&species);
        let level = Level::new(&species, 0);
        let free = |_: usize| Ok::<(), Infallible>(());
        let Ok(seeds) = trunks(&crown, &level, StreamPath::new(3), &mut |n| free(n));
        let Ok(stems) = grow(&seeds, &crown, &level, &Target::Up, &mut |n| free(n));
        let (form, detail) = (TrunkForm::new(&species), Detail::default());
        let Ok(plain) = surface(&stems, &form, &detail, 0.5, free);
        let Ok((mesh, bands)) = banded_surface(&stems, &form, &detail, 0.5, free, None);
        assert_eq!(mesh, plain);
        assert_eq!(bands.last().unwrap().end as usize, mesh.n_triangles());
        assert!(bands.len() > 24, "{}", bands.len());
        // Every vertex of a band lies on or between its rings.
        for (i, band) in bands.iter().enumerate() {
            let start = if i == 0 { 0 } else { bands[i - 1].end };
            assert!(start < band.end);
            let reach = band.rings[0].center.distance(band.rings[1].center)
                + band.rings[0].radius.max(band.rings[1].radius) * 1.5;
            for index in &mesh.indices[3 * start as usize..3 * band.end as usize] {
                let at = mesh.positions[*index as usize];
                assert!(at.distance(band.rings[0].center) <= reach, "band {i}");
            }
        }
        let ordered = evenly_ordered_bands(mesh, &bands, FadingItem::Level0);
        let triangles = |mesh: &Mesh| {
            let mut all: Vec<[u32; 3]> =
                mesh.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
            all.sort_unstable();
            all
        };
        assert_eq!(triangles(&ordered.mesh), triangles(&plain));
        assert_eq!(ordered.ends.last().copied(), Some(plain.n_triangles() as u32));
        assert_eq!((ordered.lines.len(), ordered.stems.len()), (bands.len(), bands.len()));
        assert_eq!(ordered.stems[1], bands[16].stem);
        assert_eq!(ordered.lines[1].points[0], bands[16].rings[0].center);
    }
}
