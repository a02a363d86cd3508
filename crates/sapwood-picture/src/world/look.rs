//! Materials made ready for many hits.

use std::sync::Arc;

use sapwood_geom::glam::{Vec2, Vec3, Vec4};
use sapwood_geom::{Image, Shared};
use sapwood_graph::{Alpha, Material};

use crate::texture::{Meaning, Texture, Textures};

/// A material made ready.
pub(crate) struct Look {
    material: Arc<Material>,
    base_color: Option<Arc<Texture>>,
    metallic_roughness: Option<Arc<Texture>>,
    normal: Option<Arc<Texture>>,
    emissive: Option<Arc<Texture>>,
    /// Whether there is anywhere that it may not cover.
    pub(crate) has_holes: bool,
}

/// What a material is like at a point. Colours are linear.
pub(crate) struct Matter {
    pub(crate) color: Vec3,
    pub(crate) metallic: f32,
    pub(crate) roughness: f32,
    pub(crate) emissive: Vec3,
    pub(crate) translucency: f32,
    /// In the surface's tangent frame, where an image tells.
    pub(crate) normal: Option<Vec3>,
}

impl Look {
    pub(super) fn new(material: &Arc<Material>, textures: &mut Textures) -> Self {
        let mut texture = |image: &Option<Shared<Image>>, meaning| {
            let image = image.as_ref().filter(|image| image.fault().is_none());
            image.map(|image| textures.texture(image, meaning))
        };
        let images = &material.images;
        let is_covered = material.base_color[3] >= 1.0 && images.base_color.is_none();
        Self {
            material: Arc::clone(material),
            base_color: texture(&images.base_color, Meaning::Color),
            metallic_roughness: texture(&images.metallic_roughness, Meaning::Number),
            normal: texture(&images.normal, Meaning::Number),
            emissive: texture(&images.emissive, Meaning::Color),
            has_holes: material.alpha != Alpha::Opaque && !is_covered,
        }
    }

    pub(crate) fn is_double_sided(&self) -> bool {
        self.material.double_sided
    }

    /// Whether the surface is there; `chance`, from 0 to 1, decides where it is so by halves.
    pub(crate) fn is_there(&self, uv: Vec2, chance: f32) -> bool {
        let least = match self.material.alpha {
            Alpha::Opaque => return true,
            Alpha::Mask(least) => least,
            // So that what has no coverage at all is never there.
            Alpha::Blend => chance.max(f32::MIN_POSITIVE),
        };
        let image = self.base_color.as_ref().map_or(1.0, |image| image.coverage(uv));
        self.material.base_color[3] * image >= least
    }

    /// What the material is like on the whole, as of something too thin to show its images.
    pub(crate) fn mean(&self) -> Matter {
        Matter { normal: None, ..self.at(Vec2::splat(0.5), 1.0) }
    }

    /// What the material is like where `texture_size` is the share of an image's width that one
    /// pixel sees.
    pub(crate) fn at(&self, uv: Vec2, texture_size: f32) -> Matter {
        let Material { base_color, metallic, roughness, emissive, translucency, .. } =
            *self.material;
        let read = |texture: &Option<Arc<Texture>>| {
            let texture = texture.as_ref()?;
            Some(texture.at(uv, texture_size * libm::sqrtf(texture.n_pixels())))
        };
        let color = read(&self.base_color).unwrap_or(Vec4::ONE) * Vec4::from(base_color);
        let rough = read(&self.metallic_roughness).unwrap_or(Vec4::ONE);
        let glow = read(&self.emissive).unwrap_or(Vec4::ONE);
        let normal = read(&self.normal).map(|value| value.truncate() * (255.0 / 127.5) - 1.0);
        Matter {
            color: color.truncate(),
            metallic: metallic * rough.z,
            roughness: roughness * rough.y,
            emissive: Vec3::from(emissive) * glow.truncate(),
            translucency,
            normal,
        }
    }
}
