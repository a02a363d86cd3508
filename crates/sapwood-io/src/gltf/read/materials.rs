//! Materials with their images, those of the scene alone.

use std::sync::Arc;

use sapwood_geom::glam::{Affine2, Mat2, Vec2};
use sapwood_geom::{FixedMap, Image, Shared, fixed_state};
use sapwood_graph::{Alpha, Material, MaterialImages};

use super::document::{Document, List, invalid};
use super::images::Images;
use super::primitives::UvUse;
use super::schema::{self, TextureInfo, TextureTransform};
use super::warnings::Warnings;
use crate::Error;

/// A material, and how the meshes that are drawn with it find their way in its images.
#[derive(Clone)]
pub(super) struct Look {
    pub(super) material: Arc<Material>,
    pub(super) uv_use: UvUse,
}

/// Which images a material has.
#[derive(Default)]
struct Uses {
    base_color: Option<usize>,
    metallic_roughness: Option<usize>,
    normal: Option<usize>,
    emissive: Option<usize>,
    uv_use: Option<UvUse>,
}

/// Reads all materials in `used`, with `None` for the standard's own, and with their users.
pub(super) fn read(
    document: &Document<'_>,
    used: &[(Option<usize>, String)],
    mut images: Images<'_, '_>,
    warnings: &mut Warnings,
) -> Result<FixedMap<Option<usize>, Look>, Error> {
    let mut found = Vec::with_capacity(used.len());
    for (index, user) in used {
        found.push(match index {
            Some(index) => {
                let at = List::Materials.entry(*index);
                let raw: schema::Material<'_> = document.get(List::Materials, *index, user)?;
                Reader { document, at, images: &mut images, warnings }.material(&raw)?
            }
            None => {
                let standard = schema::Material::default();
                let at = String::new();
                Reader { document, at, images: &mut images, warnings }.material(&standard)?
            }
        });
    }
    let images = images.decode()?;
    let mut looks = FixedMap::with_hasher(fixed_state());
    for ((index, _), (mut material, uses)) in used.iter().zip(found) {
        let image = |index: Option<usize>| -> Option<Shared<Image>> {
            index.and_then(|index| images.get(&index).cloned())
        };
        material.images = MaterialImages {
            base_color: image(uses.base_color),
            metallic_roughness: image(uses.metallic_roughness),
            normal: image(uses.normal),
            emissive: image(uses.emissive),
        };
        let uv_use = uses.uv_use.unwrap_or_default();
        looks.insert(*index, Look { material: Arc::new(material), uv_use });
    }
    Ok(looks)
}

struct Reader<'r, 'd, 'a, 'b> {
    document: &'r Document<'d>,
    /// The material, as messages name it.
    at: String,
    images: &'r mut Images<'a, 'b>,
    warnings: &'r mut Warnings,
}

impl Reader<'_, '_, '_, '_> {
    fn material(&mut self, raw: &schema::Material<'_>) -> Result<(Material, Uses), Error> {
        let pbr = &raw.pbr_metallic_roughness;
        let mut uses = Uses::default();
        uses.base_color = self.texture(
            &pbr.base_color_texture,
            "pbrMetallicRoughness.baseColorTexture",
            &mut uses.uv_use,
        )?;
        uses.metallic_roughness = self.texture(
            &pbr.metallic_roughness_texture,
            "pbrMetallicRoughness.metallicRoughnessTexture",
            &mut uses.uv_use,
        )?;
        uses.normal = self.texture(&raw.normal_texture, "normalTexture", &mut uses.uv_use)?;
        uses.emissive = self.texture(&raw.emissive_texture, "emissiveTexture", &mut uses.uv_use)?;
        if raw.occlusion_texture.is_some() {
            self.warn("occlusion images are left out");
        }
        let scale = raw.normal_texture.as_ref().and_then(|normal| normal.scale);
        if scale.is_some_and(|scale| scale != 1.0) {
            self.warn("normals of images are not scaled");
        }
        let strength = raw.extensions.emissive_strength.as_ref();
        let strength = strength.map_or(1.0, |strength| strength.emissive_strength);
        let mut emissive = [0.0; 3];
        for (channel, factor) in emissive.iter_mut().zip(raw.emissive_factor) {
            *channel = self.within(factor * strength, f32::MAX, "emissiveFactor")?;
        }
        let mut base_color = [0.0; 4];
        for (channel, factor) in base_color.iter_mut().zip(pbr.base_color_factor) {
            *channel = self.within(factor, 1.0, "pbrMetallicRoughness.baseColorFactor")?;
        }
        let material = Material {
            name: raw.name.as_ref().map(|name| name.0.to_string()).unwrap_or_default(),
            base_color,
            metallic: self.within(
                pbr.metallic_factor,
                1.0,
                "pbrMetallicRoughness.metallicFactor",
            )?,
            roughness: self.within(
                pbr.roughness_factor,
                1.0,
                "pbrMetallicRoughness.roughnessFactor",
            )?,
            emissive,
            translucency: self.translucency(raw)?,
            alpha: self.alpha(raw)?,
            double_sided: raw.double_sided,
            images: MaterialImages::default(),
        };
        Ok((material, uses))
    }

    fn alpha(&mut self, raw: &schema::Material<'_>) -> Result<Alpha, Error> {
        let Some(mode) = &raw.alpha_mode else { return Ok(Alpha::Opaque) };
        match &*mode.0 {
            "OPAQUE" => Ok(Alpha::Opaque),
            "BLEND" => Ok(Alpha::Blend),
            "MASK" => {
                let least = raw.alpha_cutoff.unwrap_or(0.5);
                Ok(Alpha::Mask(self.within(least, 1.0, "alphaCutoff")?))
            }
            _ => {
                let at = format_args!("{}.alphaMode", self.at);
                Err(invalid(at, mode.quoted(), "\"OPAQUE\", \"MASK\" or \"BLEND\""))
            }
        }
    }

    fn translucency(&mut self, raw: &schema::Material<'_>) -> Result<f32, Error> {
        let Some(transmission) = &raw.extensions.diffuse_transmission else { return Ok(0.0) };
        if transmission.diffuse_transmission_texture.is_some() {
            self.warn("images of translucency are left out");
        }
        let pbr = &raw.pbr_metallic_roughness;
        let [red, green, blue, _] = pbr.base_color_factor;
        let texture = |info: &Option<TextureInfo>| info.as_ref().map(|info| info.index);
        let is_own_color = transmission.diffuse_transmission_color_factor == [red, green, blue]
            && texture(&transmission.diffuse_transmission_color_texture)
                == texture(&pbr.base_color_texture);
        if !is_own_color {
            self.warn("what comes through has the colour of the surface");
        }
        self.within(
            transmission.diffuse_transmission_factor,
            1.0,
            "extensions.KHR_materials_diffuse_transmission.diffuseTransmissionFactor",
        )
    }

    /// The image of a texture, if it can be drawn with the texture coordinates of the material.
    fn texture(
        &mut self,
        info: &Option<TextureInfo>,
        field: &str,
        uv_use: &mut Option<UvUse>,
    ) -> Result<Option<usize>, Error> {
        let Some(info) = info else { return Ok(None) };
        let at = format!("{}.{field}", self.at);
        let transform = info.extensions.transform.unwrap_or_default();
        let wanted = UvUse {
            set: transform.tex_coord.unwrap_or(info.tex_coord),
            transform: affine(&transform),
        };
        if !wanted.transform.is_finite() {
            let at = format_args!("{at}.extensions.KHR_texture_transform");
            return Err(invalid(at, "numbers out of range", "finite numbers"));
        }
        if *uv_use.get_or_insert(wanted) != wanted {
            let what = "an image with other texture coordinates than the material's first one is \
                        left out";
            self.warnings.add(|| at.clone(), what);
            return Ok(None);
        }
        let index = info.index;
        let texture: schema::Texture =
            self.document.get(List::Textures, index, format_args!("{at}.index"))?;
        let texture_at = List::Textures.entry(index);
        if let Some(sampler) = texture.sampler {
            let user = format_args!("{texture_at}.sampler");
            let sampler: schema::Sampler = self.document.get(List::Samplers, sampler, user)?;
            let repeat = schema::Sampler::REPEAT;
            if (sampler.wrap_s, sampler.wrap_t) != (repeat, repeat) {
                self.warnings.add(|| texture_at.clone(), "images repeat beyond their edges");
            }
        }
        let Some(image) = texture.source else {
            self.warnings.add(|| texture_at, "a texture without a PNG or JPEG image is left out");
            return Ok(None);
        };
        self.images.note(image, &format!("{texture_at}.source"))?;
        Ok(Some(image))
    }

    /// A number held to 0 up to `most`.
    fn within(&mut self, value: f32, most: f32, field: &str) -> Result<f32, Error> {
        if value.is_nan() || value == f32::INFINITY {
            let at = format_args!("{}.{field}", self.at);
            return Err(invalid(at, "a number out of range", "finite numbers"));
        }
        if !(0.0..=most).contains(&value) {
            let at = &self.at;
            self.warnings.add(|| format!("{at}.{field}"), "a number is held to its range");
        }
        // Adding zero makes a negative one positive.
        Ok(value.clamp(0.0, most) + 0.0)
    }

    fn warn(&mut self, what: &str) {
        let at = &self.at;
        self.warnings.add(|| at.clone(), what);
    }
}

/// Scales, then turns from `v` to `u`, which is counter-clockwise in the image, then moves.
fn affine(transform: &TextureTransform) -> Affine2 {
    let TextureTransform { offset, rotation, scale, .. } = *transform;
    let (sin, cos) = (libm::sinf(rotation), libm::cosf(rotation));
    let turn = Mat2::from_cols(Vec2::new(cos, -sin), Vec2::new(sin, cos));
    let matrix2 = turn * Mat2::from_diagonal(Vec2::from_array(scale));
    Affine2 { matrix2, translation: Vec2::from_array(offset) }
}
