//! An image of somebody's own on leaves: what its pixels tell, the card that it is shown on, and
//! its material. Where it comes from is left to others.

use glam::{Vec2, Vec3};
use sapwood_geom::{Image, Mesh, Shared};
use sapwood_graph::{Alpha, Material};

use super::own_leaf::WIDEST;
use crate::weber_penn::look::BESIDE_MIDRIB;

/// Coverage below this is cut out of an image.
const CUT_OUT: u8 = 128;

/// An image that stands for the painted one of leaves. Its upper edge is the leaf's tip; pixels
/// that are less than half covered are cut out.
///
/// All of its pixels are looked at when it is made, and never again: species are edited often.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnLeafImage {
    image: Shared<Image>,
    is_cut_out: bool,
    /// Where on it something is shown, as near beside its middle as can be.
    spot: Option<Vec2>,
}

impl OwnLeafImage {
    /// Looks at an image.
    pub fn new(image: Shared<Image>) -> Self {
        let (width, height) = (image.width, image.height);
        let place = |x: u32, y: u32| {
            Vec2::new((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32)
        };
        let places = (0..height).flat_map(|y| (0..width).map(move |x| place(x, y)));
        let (mut is_cut_out, mut nearest) = (false, None);
        for (place, pixel) in places.zip(&image.pixels) {
            if pixel[3] < CUT_OUT {
                is_cut_out = true;
                continue;
            }
            let away = place.distance_squared(BESIDE_MIDRIB);
            if nearest.is_none_or(|(least, _)| away < least) {
                nearest = Some((away, place));
            }
        }
        Self { image, is_cut_out, spot: nearest.map(|(_, place)| place) }
    }

    /// The image.
    pub fn image(&self) -> &Shared<Image> {
        &self.image
    }

    /// Whether parts of it are cut out, so that the leaf's outline is in it.
    pub fn is_cut_out(&self) -> bool {
        self.is_cut_out
    }

    /// Whether all of it is cut out.
    pub fn is_empty(&self) -> bool {
        self.spot.is_none()
    }

    /// How wide it is against its height.
    pub(crate) fn proportion(&self) -> f32 {
        let Image { width, height, .. } = *self.image;
        (width as f32 / height.max(1) as f32).clamp(1.0 / WIDEST, WIDEST)
    }

    /// Where on a card of its own it is not cut out: as near beside its middle as can be.
    pub(crate) fn spot(&self) -> Vec2 {
        self.spot.unwrap_or(BESIDE_MIDRIB)
    }

    /// The card that it is shown on: one long, in its proportions, its upper edge at the tip.
    pub(crate) fn card(&self) -> Mesh {
        let half = 0.5 * self.proportion();
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

    /// The material of leaves that show it as it is.
    pub(crate) fn material(&self, roughness: f32, translucency: f32) -> Material {
        let mut material = Material {
            double_sided: true,
            roughness,
            translucency,
            alpha: if self.is_cut_out { Alpha::Mask(0.5) } else { Alpha::Opaque },
            ..Material::matte("leaf", 1.0, 1.0, 1.0)
        };
        material.images.base_color = Some(self.image.clone());
        material
    }
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

fn coverage(image: &Image, uv: Vec2) -> u8 {
    let pixel = |share: f32, n: u32| ((share - share.floor()) * n as f32) as u32;
    let x = pixel(uv.x, image.width).min(image.width.saturating_sub(1));
    let y = pixel(uv.y, image.height).min(image.height.saturating_sub(1));
    let pixel = image.pixels.get(y as usize * image.width as usize + x as usize);
    pixel.map_or(u8::MAX, |pixel| pixel[3])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::weber_penn::LeafShape;
    use crate::weber_penn::geometry::leaf_mesh;

    fn own(image: Image) -> OwnLeafImage {
        OwnLeafImage::new(Shared::new(image))
    }

    #[test]
    fn cards_show_their_image_the_right_way_round() {
        let pixel = |x, y| [0, 0, 0, if (x, y) == (1, 0) { 255 } else { 0 }];
        let image = own(Image::from_fn(2, 4, pixel));
        let card = image.card();
        assert_eq!(card.fault(), None);
        for t in card.indices.chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| card.positions[i as usize]);
            assert!((b - a).cross(c - a).y > 0.0);
        }
        for (position, uv) in card.positions.iter().zip(&card.uvs) {
            assert_eq!((position.z, position.x), (1.0 - uv.y, 0.5 * (0.5 - uv.x)));
        }
        assert_eq!(image.spot(), Vec2::new(0.75, 0.125));
        assert!(image.is_cut_out() && !image.is_empty());
    }

    #[test]
    fn one_look_tells_what_of_an_image_is_there() {
        let told = |coverage: [u8; 4]| {
            let image = own(Image::from_fn(2, 2, |x, y| [9, 9, 9, coverage[(2 * y + x) as usize]]));
            (image.is_cut_out(), image.is_empty(), image.spot())
        };
        assert_eq!(told([255; 4]), (false, false, Vec2::splat(0.25)));
        assert_eq!(told([128, 128, 128, 127]), (true, false, Vec2::splat(0.25)));
        assert_eq!(told([127, 127, 127, 128]), (true, false, Vec2::splat(0.75)));
        assert_eq!(told([127; 4]), (true, true, BESIDE_MIDRIB));
        let nothing = own(Image::from_fn(0, 0, |_, _| [0; 4]));
        assert!(nothing.is_empty() && !nothing.is_cut_out());
    }

    #[test]
    fn what_stands_for_a_mesh_shows_what_is_not_cut_out() {
        // Only the upper half is there; the largest triangles of a strip lie in the middle.
        let image = Image::from_fn(1, 8, |_, y| [0, 0, 0, if y < 4 { 255 } else { 0 }]);
        let uv = spot(&leaf_mesh(LeafShape::Oval), Some(&image));
        assert!(uv.y < 0.5, "{uv}");
    }
}
