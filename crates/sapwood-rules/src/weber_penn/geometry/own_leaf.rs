//! Leaves of somebody's own: a mesh instead of a built-in shape, and the card that an image is
//! shown on. Where they come from is left to others.

use std::fmt;
use std::sync::Arc;

use glam::{Affine3, Vec2, Vec3};
use sapwood_geom::{Image, Mesh, Shared, SharedMesh, content};
use sapwood_graph::{Alpha, Material};

use crate::weber_penn::look::BESIDE_MIDRIB;

/// A mesh that stands for one leaf, whatever it shows: a leaf, a flower, a fruit.
///
/// It is given in any unit, in the frame that glTF files have: the origin is where the stalk ends,
/// +z leads along the leaf, +y is its upper side. Its length is what lies beyond the origin along
/// +z, and is made 1; the other axes keep their proportions.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafMesh {
    unit: SharedMesh,
    material: Option<Arc<Material>>,
    has_uvs: bool,
    reach: Vec3,
}

content!(LeafMesh { unit, material, has_uvs, reach });

/// Why a mesh is no leaf.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LeafMeshFault {
    /// It has no triangles.
    Empty,
    /// It has more than [`LeafMesh::MOST_TRIANGLES`].
    TooMany {
        /// How many there are.
        found: usize,
    },
    /// It has numbers that are none, or triangles between vertices that are not there.
    Unsound(String),
    /// Nothing of it lies beyond the origin along +z.
    NoLength,
    /// It is so much thicker than long that it cannot be made one long.
    TooWide,
}

impl fmt::Display for LeafMeshFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let most = LeafMesh::MOST_TRIANGLES;
        match self {
            Self::Empty => f.write_str("a mesh without triangles (accepted: a leaf of some)"),
            Self::TooMany { found } => {
                write!(f, "a leaf of {found} triangles (accepted: at most {most})")
            }
            Self::Unsound(why) => write!(f, "{why} (accepted: a sound mesh)"),
            Self::NoLength => f.write_str(
                "nothing of the mesh lies beyond its origin along +z (accepted: leaves that begin at \
                 the origin and lead along +z, their upper side toward +y)",
            ),
            Self::TooWide => f.write_str(
                "the mesh is more than 1000 times as wide as it is long along +z (accepted: leaves \
                 that lead along +z)",
            ),
        }
    }
}

impl std::error::Error for LeafMeshFault {}

/// The most by which a leaf may be wider than long.
const WIDEST: f32 = 1000.0;

impl LeafMesh {
    /// The most triangles that one leaf may have.
    pub const MOST_TRIANGLES: usize = 1 << 16;

    /// The leaf that `mesh` stands for. It is drawn with `material`, or with what a species says of
    /// its leaves where there is none.
    ///
    /// # Errors
    /// Where the mesh is no leaf.
    pub fn new(mesh: &Mesh, material: Option<Arc<Material>>) -> Result<Self, LeafMeshFault> {
        if mesh.is_empty() {
            return Err(LeafMeshFault::Empty);
        }
        if mesh.n_triangles() > Self::MOST_TRIANGLES {
            return Err(LeafMeshFault::TooMany { found: mesh.n_triangles() });
        }
        if let Some(why) = mesh.unsound() {
            return Err(LeafMeshFault::Unsound(why));
        }
        // Vertices that no triangle uses have no say in how long it is.
        let used = mesh.part(0..mesh.n_triangles() as u32);
        let length = used.bound().aabb.max.z;
        let scale = length.recip();
        if !(length > 0.0 && scale.is_finite()) {
            return Err(LeafMeshFault::NoLength);
        }
        let mut unit = Mesh::default();
        unit.append(&used, &Affine3::from_scale(Vec3::splat(scale)));
        let bound = unit.bound().aabb;
        let mut reach = bound.min.abs().max(bound.max.abs());
        if reach.max_element() > WIDEST {
            return Err(LeafMeshFault::TooWide);
        }
        // What stands for it from afar may be wider.
        reach.x = reach.x.max(point_half_width(&unit, is_closed(&unit)));
        let has_uvs = unit.uvs.iter().any(|uv| *uv != unit.uvs[0]);
        Ok(Self { unit: SharedMesh::new(unit), material, has_uvs, reach })
    }

    /// The mesh, one long.
    pub fn unit(&self) -> &SharedMesh {
        &self.unit
    }

    /// What it is drawn with by itself.
    pub fn material(&self) -> Option<&Arc<Material>> {
        self.material.as_ref()
    }

    /// Whether an image can be laid on it.
    pub fn has_uvs(&self) -> bool {
        self.has_uvs
    }

    /// How far it reaches from the origin along each axis, as does what stands for it from afar.
    pub(crate) fn reach(&self) -> Vec3 {
        self.reach
    }
}

/// Coverage below this is cut out of an image.
const CUT_OUT: u8 = 128;

/// Whether parts of an image are cut out, so that the leaf's outline is in it.
pub(crate) fn is_cut_out(image: &Image) -> bool {
    image.pixels.iter().any(|pixel| pixel[3] < CUT_OUT)
}

/// How wide an image is against its height.
pub(crate) fn proportion(image: &Image) -> f32 {
    (image.width as f32 / image.height.max(1) as f32).clamp(1.0 / WIDEST, WIDEST)
}

/// The card that an image is shown on: one long, in the image's proportions, its upper edge at the
/// tip.
pub(crate) fn image_card(image: &Image) -> Mesh {
    let half = 0.5 * proportion(image);
    // Seen from above with the tip up, x runs to the left.
    Mesh {
        positions: [(half, 0.0), (-half, 0.0), (half, 1.0), (-half, 1.0)]
            .map(|(x, z)| Vec3::new(x, 0.0, z))
            .to_vec(),
        normals: vec![Vec3::Y; 4],
        uvs: [(0.0, 1.0), (1.0, 1.0), (0.0, 0.0), (1.0, 0.0)].map(Vec2::from).to_vec(),
        indices: vec![1, 3, 0, 3, 2, 0],
    }
}

/// The material of leaves that show an image as it is.
pub(crate) fn image_material(image: &Shared<Image>, roughness: f32, translucency: f32) -> Material {
    let mut material = Material {
        double_sided: true,
        roughness,
        translucency,
        alpha: if is_cut_out(image) { Alpha::Mask(0.5) } else { Alpha::Opaque },
        ..Material::matte("leaf", 1.0, 1.0, 1.0)
    };
    material.images.base_color = Some(image.clone());
    material
}

/// Where on the texture something lies that an image does not cut out, of the places that triangles
/// of a leaf show: the middle of the largest one for which that holds.
pub(crate) fn spot(mesh: &Mesh, image: Option<&Image>) -> Vec2 {
    let area_and_middle = |t: &[u32]| {
        let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize]);
        let uvs = [t[0], t[1], t[2]].map(|i| mesh.uvs[i as usize]);
        ((b - a).cross(c - a).length(), (uvs[0] + uvs[1] + uvs[2]) / 3.0)
    };
    let is_there = |uv: Vec2| image.is_none_or(|image| coverage(image, uv) >= CUT_OUT);
    let triangles = mesh.indices.chunks_exact(3).map(area_and_middle);
    let shown = triangles.filter(|(_, uv)| is_there(*uv));
    let largest = shown.max_by(|(a, _), (b, _)| a.total_cmp(b));
    largest.map_or(BESIDE_MIDRIB, |(_, uv)| uv)
}

/// Where on a card of its own an image is not cut out: as near beside its middle as can be.
pub(crate) fn spot_of_card(image: &Image) -> Vec2 {
    let wanted = BESIDE_MIDRIB;
    let (width, height) = (image.width, image.height);
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let place = |(x, y): (u32, u32)| {
        Vec2::new((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32)
    };
    let there = places.zip(&image.pixels).filter(|(_, pixel)| pixel[3] >= CUT_OUT);
    let places = there.map(|(at, _)| place(at));
    let nearest =
        places.min_by(|a, b| a.distance_squared(wanted).total_cmp(&b.distance_squared(wanted)));
    nearest.unwrap_or(wanted)
}

fn coverage(image: &Image, uv: Vec2) -> u8 {
    let pixel = |share: f32, n: u32| ((share - share.floor()) * n as f32) as u32;
    let x = pixel(uv.x, image.width).min(image.width.saturating_sub(1));
    let y = pixel(uv.y, image.height).min(image.height.saturating_sub(1));
    let pixel = image.pixels.get(y as usize * image.width as usize + x as usize);
    pixel.map_or(u8::MAX, |pixel| pixel[3])
}

/// Whether a leaf is a body and no sheet.
pub(crate) fn is_closed(mesh: &Mesh) -> bool {
    mesh.n_open_edges() == 0
}

/// Half the width of a triangle one long that covers as much as a mesh from all sides together:
/// whoever looks at a closed body sees a quarter of its surface, and half of a sheet's.
pub(crate) fn point_half_width(mesh: &Mesh, is_closed: bool) -> f32 {
    let area: f32 = mesh
        .indices
        .chunks_exact(3)
        .map(|t| {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize]);
            0.5 * (b - a).cross(c - a).length()
        })
        .sum();
    if is_closed { 0.5 * area } else { area }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::weber_penn::LeafShape;
    use crate::weber_penn::geometry::leaf_mesh;

    fn scaled(mesh: &Mesh, scale: Vec3, by: Vec3) -> Mesh {
        let mut scaled = Mesh::default();
        scaled.append(
            mesh,
            &Affine3::from_scale_rotation_translation(scale, glam::Quat::IDENTITY, by),
        );
        scaled
    }

    #[test]
    fn leaves_are_made_one_long_in_their_proportions() {
        let maple = leaf_mesh(LeafShape::Maple5);
        let large = scaled(&maple, Vec3::new(14.0, 7.0, 7.0), Vec3::ZERO);
        let leaf = LeafMesh::new(&large, None).unwrap();
        let bound = leaf.unit().bound().aabb;
        assert!((bound.max.z - 1.0).abs() < 1e-6 && (bound.size().x - 2.0).abs() < 1e-5);
        assert!(leaf.has_uvs() && leaf.reach().x >= 1.0 && leaf.reach().z >= 1.0);
        assert_eq!(leaf.unit().fault(), None);
    }

    #[test]
    fn what_is_no_leaf_is_told() {
        let oval = leaf_mesh(LeafShape::Oval);
        let told = |mesh: &Mesh| LeafMesh::new(mesh, None).unwrap_err().to_string();
        assert!(told(&Mesh::default()).contains("without triangles"));
        let behind = scaled(&oval, Vec3::ONE, -2.0 * Vec3::Z);
        assert!(told(&behind).contains("beyond its origin along +z"));
        let wide = scaled(&oval, Vec3::new(5000.0, 1.0, 1.0), Vec3::ZERO);
        assert!(told(&wide).contains("1000 times"));
        let mut broken = oval.clone();
        broken.positions[1].x = f32::NAN;
        assert!(told(&broken).contains("the position of vertex 1"));
        let mut many = Mesh::default();
        while many.n_triangles() <= LeafMesh::MOST_TRIANGLES {
            let more = if many.is_empty() { oval.clone() } else { many.clone() };
            many.append(&more, &Affine3::IDENTITY);
        }
        assert!(told(&many).contains("at most 65536"), "{}", told(&many));
    }

    #[test]
    fn cards_show_their_image_the_right_way_round() {
        let image = Image::from_fn(2, 4, |x, y| [0, 0, 0, if (x, y) == (1, 0) { 255 } else { 0 }]);
        let card = image_card(&image);
        assert_eq!(card.fault(), None);
        for t in card.indices.chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| card.positions[i as usize]);
            assert!((b - a).cross(c - a).y > 0.0);
        }
        for (position, uv) in card.positions.iter().zip(&card.uvs) {
            assert_eq!((position.z, position.x), (1.0 - uv.y, 0.5 * (0.5 - uv.x)));
        }
        assert_eq!(spot_of_card(&image), Vec2::new(0.75, 0.125));
        assert!(is_cut_out(&image));
    }

    #[test]
    fn what_stands_for_a_mesh_shows_what_is_not_cut_out() {
        // Only the upper half is there; the largest triangles of a strip lie in the middle.
        let image = Image::from_fn(1, 8, |_, y| [0, 0, 0, if y < 4 { 255 } else { 0 }]);
        let uv = spot(&leaf_mesh(LeafShape::Oval), Some(&image));
        assert!(uv.y < 0.5, "{uv}");
    }
}
