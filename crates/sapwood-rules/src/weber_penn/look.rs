//! What trees look like: bark and leaves as their images and materials are made of, from what a
//! species says and from what suits its shape where it says nothing.

use std::sync::Arc;

use glam::Vec2;
use sapwood_geom::{SharedMesh, content};
use sapwood_graph::{Alpha, Material};
use sapwood_images::{BarkImage, BarkKind, LeafImage, LeafOutline, Paint, PaintedMaterial};

use super::geometry::{half_width, spot};
use super::{Detail, LeafShape, LeavesSpec, OwnLeafImage, Species};

/// The bark of a species.
#[derive(Clone, Debug, PartialEq)]
pub struct BarkLook {
    /// How it is structured.
    pub kind: BarkKind,
    /// The linear colour of what lies outermost, each number in 0..=1.
    pub color: [f32; 3],
    /// The linear colour of furrows, marks and rings, each number in 0..=1.
    pub deep_color: [f32; 3],
    /// How deep the relief is, in metres.
    pub depth: f32,
    /// The width in metres of one repeat of the bark's images.
    pub width: f32,
    /// The linear colour of the twigs' smooth bark; none where they look as everything else does.
    pub twig_color: Option<[f32; 3]>,
    /// The level that counts as twigs, and all beyond it.
    pub first_twig_level: u8,
}

content!(BarkLook { kind, color, deep_color, depth, width, twig_color, first_twig_level });

impl BarkLook {
    /// The bark of a species; what it does not say follows from the shape of its leaves.
    pub fn new(species: &Species) -> Self {
        let bark = &species.bark;
        let kind = bark.kind.unwrap_or(match species.leaves.shape {
            LeafShape::Palm => BarkKind::Ringed,
            LeafShape::Linear => BarkKind::Plates,
            _ => BarkKind::Furrowed,
        });
        let [color, deep_color] = kind.colors();
        let width = bark.width.unwrap_or(0.5);
        Self {
            kind,
            color: bark.color.unwrap_or(color),
            deep_color: bark.deep_color.unwrap_or(deep_color),
            depth: bark.depth.unwrap_or(kind.depth() * width),
            width,
            twig_color: bark.twig_color,
            // The last level of stems, unless that is the trunk.
            first_twig_level: (species.levels.clamp(2, 255) - 1) as u8,
        }
    }

    /// The material of stems of a level.
    pub fn material(&self, level: u8, detail: &Detail) -> PaintedMaterial {
        let twig_color = self.twig_color.filter(|_| level >= self.first_twig_level);
        let bark = match twig_color {
            // A twig shows a few pixels of it.
            Some(color) => BarkImage {
                color,
                deep_color: color.map(|channel| 0.3 * channel),
                size: detail.image_size.div_ceil(2),
                ..BarkImage::new(BarkKind::Smooth)
            },
            None => BarkImage {
                kind: self.kind,
                color: self.color,
                deep_color: self.deep_color,
                depth: (self.depth / self.width).clamp(0.0, 0.5),
                size: detail.image_size,
                ..BarkImage::default()
            },
        };
        let roughness = bark.kind.roughness();
        let material = Material { roughness, ..Material::matte("bark", 1.0, 1.0, 1.0) };
        PaintedMaterial { material, paint: Paint::Bark(bark) }
    }
}

/// The leaves of a species.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafLook {
    /// Their outline.
    pub outline: LeafOutline,
    /// The linear colour between the veins, each number in 0..=1.
    pub color: [f32; 3],
    /// The linear colour of the veins, each number in 0..=1.
    pub vein_color: [f32; 3],
    /// The share of the light scattered in a leaf that leaves on its other side, 0 to 1.
    pub translucency: f32,
    /// How wide a leaf is against its length.
    pub width: f32,
    /// How far normals follow the crown instead of each leaf: 0 not at all, 1 fully. Above 0 leaves
    /// are written out one by one, instead of being instances of one mesh.
    pub roundness: f32,
    /// What leaves are drawn with instead, where they have a mesh or an image of somebody's own.
    pub own: Option<Arc<Material>>,
    /// The card, one long, on which an image is shown that has the leaf's outline.
    pub card: Option<SharedMesh>,
    /// Where on the texture something is shown that is not cut out.
    pub spot: Vec2,
}

content!(LeafLook { outline, color, vein_color, translucency, width, roundness, own, card, spot });

impl LeafLook {
    /// The leaves of a species; what it does not say follows from their shape.
    pub fn new(species: &Species) -> Self {
        let leaves = &species.leaves;
        let color = leaves.color.unwrap_or([0.07, 0.17, 0.03]);
        // Paler and yellower, whatever the colour.
        let pale = [0.12, 0.12, 0.05];
        let vein_color = std::array::from_fn(|i| (0.6 * color[i] + pale[i]).min(1.0));
        let OwnLook { material: own, card, spot } = OwnLook::new(&species.leaves, color);
        Self {
            outline: leaves.outline.unwrap_or(outline_of(leaves.shape)),
            color,
            vein_color: leaves.vein_color.unwrap_or(vein_color),
            translucency: leaves.translucency.unwrap_or(TRANSLUCENCY),
            width: 2.0 * half_width(leaves.shape) * leaves.scale_x,
            roundness: leaves.roundness,
            own,
            card,
            spot,
        }
    }

    /// The outline that their image cuts out of the shape; none where it is somebody's own.
    pub(crate) fn outline_of_shape(&self) -> Option<LeafOutline> {
        self.own.is_none().then_some(self.outline)
    }

    /// The material of the leaves as they are painted, where nobody has a material of
    /// [their own](Self::own) for them.
    pub fn material(&self, detail: &Detail) -> PaintedMaterial {
        let leaf = LeafImage {
            outline: self.outline,
            color: self.color,
            vein_color: self.vein_color,
            width: self.width.clamp(0.01, 2.0),
            size: detail.image_size,
            ..LeafImage::default()
        };
        let is_whole = self.outline == LeafOutline::Whole;
        let material = Material {
            double_sided: true,
            roughness: leaf_roughness(self.roundness),
            translucency: self.translucency,
            alpha: if is_whole { Alpha::Opaque } else { Alpha::Mask(0.5) },
            ..Material::matte("leaf", 1.0, 1.0, 1.0)
        };
        PaintedMaterial { material, paint: Paint::Leaf(leaf) }
    }
}

/// The share of the light that goes through leaves, where nobody says another.
const TRANSLUCENCY: f32 = 0.35;
/// How rough leaves are. Normals that lie on no surface would shine at the crown's rim.
fn leaf_roughness(roundness: f32) -> f32 {
    0.6 + 0.4 * roundness
}

/// Beside the midrib of painted leaves.
pub(crate) const BESIDE_MIDRIB: Vec2 = Vec2::new(0.4, 0.5);

/// What a mesh or an image of somebody's own does to the look of leaves.
struct OwnLook {
    material: Option<Arc<Material>>,
    card: Option<SharedMesh>,
    spot: Vec2,
}

impl OwnLook {
    fn new(leaves: &LeavesSpec, color: [f32; 3]) -> Self {
        let translucency = leaves.translucency.unwrap_or(TRANSLUCENCY);
        let roughness = leaf_roughness(leaves.roundness);
        let image = leaves.image.as_ref().map(|own| &own.image);
        let shown = image.map(|image| Arc::new(image.material(roughness, translucency)));
        let Some(own) = &leaves.mesh else {
            let cut_out = image.filter(|image| image.is_cut_out());
            return Self {
                material: shown,
                card: cut_out.map(|image| SharedMesh::new(image.card())),
                spot: cut_out.map_or(BESIDE_MIDRIB, OwnLeafImage::spot),
            };
        };
        let [red, green, blue] = color;
        let plain = || {
            let matte = Material::matte("leaf", red, green, blue);
            Arc::new(Material { double_sided: true, roughness, translucency, ..matte })
        };
        let material = shown.or_else(|| own.mesh.material().cloned()).unwrap_or_else(plain);
        let image = material.images.base_color.as_deref();
        let cut = image.filter(|_| !matches!(material.alpha, Alpha::Opaque));
        Self { spot: spot(own.mesh.unit(), cut), material: Some(material), card: None }
    }
}

/// The outline that suits a shape; shapes that are outlines themselves keep theirs.
fn outline_of(shape: LeafShape) -> LeafOutline {
    match shape {
        LeafShape::Oval => LeafOutline::Ovate,
        LeafShape::Elliptic => LeafOutline::Elliptic,
        LeafShape::Heart => LeafOutline::Cordate,
        LeafShape::Maple3 => LeafOutline::Trilobed,
        LeafShape::Maple5 => LeafOutline::Maple,
        LeafShape::Palmate => LeafOutline::Palmate,
        LeafShape::Oak3 => LeafOutline::Oak,
        LeafShape::Leaflets3 => LeafOutline::Leaflets,
        LeafShape::Linear => LeafOutline::Needle,
        LeafShape::Palm => LeafOutline::Blade,
        LeafShape::Diamond
        | LeafShape::Triangle
        | LeafShape::Square
        | LeafShape::Sphere
        | LeafShape::Disc(_) => LeafOutline::Whole,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::weber_penn::BarkSpec;

    fn leaf(shape: LeafShape) -> LeafLook {
        let mut species = Species::default();
        species.leaves.shape = shape;
        LeafLook::new(&species)
    }

    #[test]
    fn species_that_say_nothing_look_as_their_leaves_suggest() {
        assert_eq!(BarkLook::new(&Species::default()).kind, BarkKind::Furrowed);
        let mut palm = Species::default();
        palm.leaves.shape = LeafShape::Palm;
        assert_eq!(BarkLook::new(&palm).kind, BarkKind::Ringed);
        assert_eq!(LeafLook::new(&palm).outline, LeafOutline::Blade);
        assert_eq!(leaf(LeafShape::Maple5).outline, LeafOutline::Maple);
        assert_eq!(leaf(LeafShape::Square).outline, LeafOutline::Whole);
    }

    #[test]
    fn species_look_as_they_say() {
        let mut species = Species::default();
        let [one, two, three] = [[0.1, 0.2, 0.3], [0.4, 0.5, 0.6], [0.7, 0.8, 0.9]];
        species.bark = BarkSpec {
            kind: Some(BarkKind::Culm),
            color: Some(one),
            deep_color: Some(two),
            depth: Some(0.02),
            width: Some(0.5),
            twig_color: Some(three),
        };
        let look = BarkLook::new(&species);
        let detail = Detail::default();
        let Paint::Bark(bark) = look.material(0, &detail).paint else { panic!("bark is bark") };
        assert_eq!((bark.kind, bark.color, bark.deep_color), (BarkKind::Culm, one, two));
        assert_eq!((bark.depth, bark.size, look.width), (0.04, 256, 0.5));
        let Paint::Bark(twig) = look.material(2, &detail).paint else { panic!("bark is bark") };
        assert_eq!((twig.color, twig.size), (three, 128));

        species.leaves.outline = Some(LeafOutline::Oak);
        (species.leaves.color, species.leaves.vein_color) = (Some(one), Some(two));
        (species.leaves.translucency, species.leaves.scale_x) = (Some(0.25), 0.6);
        let painted = LeafLook::new(&species).material(&detail);
        let Paint::Leaf(leaf) = painted.paint else { panic!("leaves are leaves") };
        assert_eq!((leaf.outline, leaf.color, leaf.vein_color), (LeafOutline::Oak, one, two));
        assert_eq!((leaf.width, painted.material.translucency), (0.6, 0.25));
    }

    #[test]
    fn everything_that_a_species_may_say_gives_sound_images() {
        for (_, shape) in LeafShape::NAMES {
            for scale_x in [1e-6, 1.0, 100.0] {
                let mut species = Species::default();
                (species.leaves.shape, species.leaves.scale_x) = (shape, scale_x);
                let painted = LeafLook::new(&species).material(&Detail::default());
                let Paint::Leaf(leaf) = painted.paint else { panic!("leaves are leaves") };
                assert_eq!(leaf.fault(), None);
            }
        }
        for (_, kind) in BarkKind::NAMES {
            let mut species = Species::default();
            species.bark.kind = Some(kind);
            (species.bark.depth, species.bark.width) = (Some(1.0), Some(0.01));
            for level in [0, 2] {
                let painted = BarkLook::new(&species).material(level, &Detail::draft());
                let Paint::Bark(bark) = painted.paint else { panic!("bark is bark") };
                assert_eq!(bark.fault(), None);
            }
        }
    }

    #[test]
    fn twigs_have_a_color_of_their_own_where_the_species_gives_one() {
        let mut species = Species { levels: 3, ..Species::default() };
        let kind = |species: &Species, level| match BarkLook::new(species)
            .material(level, &Detail::default())
            .paint
        {
            Paint::Bark(bark) => bark.kind,
            _ => panic!("bark is bark"),
        };
        assert_eq!(kind(&species, 2), BarkKind::Furrowed);
        species.bark.twig_color = Some([0.2, 0.2, 0.0]);
        let kinds = [BarkKind::Furrowed, BarkKind::Furrowed, BarkKind::Smooth];
        assert_eq!([0, 1, 2].map(|level| kind(&species, level)), kinds);
        species.levels = 1;
        assert_eq!(kind(&species, 0), BarkKind::Furrowed);
    }
}
