//! Materials with their images: each distinct one once.

use gltf_json as json;
use json::Index;
use json::extensions::material::{EmissiveStrength, EmissiveStrengthFactor};
use json::material::{
    AlphaCutoff, AlphaMode, EmissiveFactor, NormalTexture, PbrBaseColorFactor,
    PbrMetallicRoughness, StrengthFactor,
};
use json::texture::Info;
use json::validation::{Checked::Valid, USize64};
use sapwood_geom::{Digest, FixedMap, Image, Shared, fixed_state};
use sapwood_graph::{Alpha, Material};
use serde_json::json;

use super::buffer::BufferBuilder;
use super::document::named;
use crate::png::{Packing, png_bytes};

const EMISSIVE_STRENGTH: &str = "KHR_materials_emissive_strength";
const DIFFUSE_TRANSMISSION: &str = "KHR_materials_diffuse_transmission";

/// The materials of a document. The bytes of images lie in its buffer behind all geometry.
pub(super) struct Materials {
    /// Bytes in the buffer so far: those of all geometry and of the images found.
    n_bytes: u64,
    materials: FixedMap<Digest, Index<json::Material>>,
    textures: FixedMap<Digest, Index<json::Texture>>,
    images: Vec<Vec<u8>>,
}

impl Default for Materials {
    fn default() -> Self {
        Self::new(0)
    }
}

impl Materials {
    /// No materials, beside geometry of this many bytes.
    pub(super) fn new(geometry: u64) -> Self {
        Self {
            n_bytes: geometry,
            materials: FixedMap::with_hasher(fixed_state()),
            textures: FixedMap::with_hasher(fixed_state()),
            images: Vec::new(),
        }
    }

    /// Bytes of all geometry and of the images found so far.
    pub(super) fn n_bytes(&self) -> u64 {
        self.n_bytes
    }

    /// The number of a material in the document; the error says what glTF does not allow in it.
    pub(super) fn index(
        &mut self,
        root: &mut json::Root,
        material: &Material,
    ) -> Result<Index<json::Material>, String> {
        let digest = Digest::of(material);
        if let Some(index) = self.materials.get(&digest) {
            return Ok(*index);
        }
        let made = self.made(root, material)?;
        let index = root.push(made);
        self.materials.insert(digest, index);
        Ok(index)
    }

    fn made(
        &mut self,
        root: &mut json::Root,
        material: &Material,
    ) -> Result<json::Material, String> {
        let [r, g, b, a] = material.base_color;
        let factors = [r, g, b, a, material.metallic, material.roughness];
        if let Some(bad) = factors.iter().find(|factor| !(0.0..=1.0).contains(*factor)) {
            return Err(format!("a factor of {bad} (accepted: 0 to 1)"));
        }
        let (alpha_mode, alpha_cutoff) = match material.alpha {
            Alpha::Opaque => (AlphaMode::Opaque, None),
            Alpha::Blend => (AlphaMode::Blend, None),
            Alpha::Mask(least) if (0.0..=1.0).contains(&least) => {
                (AlphaMode::Mask, Some(AlphaCutoff(least)))
            }
            Alpha::Mask(least) => {
                return Err(format!("a least coverage of {least} (accepted: 0 to 1)"));
            }
        };
        if !(0.0..=1.0).contains(&material.translucency) {
            return Err(format!("a translucency of {} (accepted: 0 to 1)", material.translucency));
        }
        let (emissive, strength) = emission(material.emissive)?;
        let images = &material.images;
        let mut texture = |image: &Option<Shared<Image>>| {
            image.as_ref().map(|image| self.texture(root, image)).transpose()
        };
        let normal = texture(&images.normal)?;
        let base_color = texture(&images.base_color)?;
        let metallic_roughness = texture(&images.metallic_roughness)?;
        let emissive_image = texture(&images.emissive)?;
        Ok(json::Material {
            name: named(&material.name),
            alpha_mode: Valid(alpha_mode),
            alpha_cutoff,
            double_sided: material.double_sided,
            pbr_metallic_roughness: PbrMetallicRoughness {
                base_color_factor: PbrBaseColorFactor(material.base_color),
                base_color_texture: base_color.map(info),
                metallic_factor: StrengthFactor(material.metallic),
                roughness_factor: StrengthFactor(material.roughness),
                metallic_roughness_texture: metallic_roughness.map(info),
                ..Default::default()
            },
            normal_texture: normal.map(|index| NormalTexture {
                index,
                scale: 1.0,
                tex_coord: 0,
                extensions: None,
                extras: None,
            }),
            emissive_texture: emissive_image.map(info),
            emissive_factor: EmissiveFactor(emissive),
            extensions: extensions(root, material, base_color, strength),
            ..Default::default()
        })
    }

    /// The texture of an image; its bytes are encoded when it is met first.
    fn texture(
        &mut self,
        root: &mut json::Root,
        image: &Shared<Image>,
    ) -> Result<Index<json::Texture>, String> {
        let digest = image.digest();
        if let Some(index) = self.textures.get(&digest) {
            return Ok(*index);
        }
        let bytes = png_bytes(image, Packing::Fast)?;
        let buffer_view = root.push(json::buffer::View {
            buffer: Index::new(0),
            byte_length: USize64::from(bytes.len()),
            byte_offset: (self.n_bytes > 0).then_some(USize64(self.n_bytes)),
            byte_stride: None,
            name: None,
            target: None,
            extensions: None,
            extras: None,
        });
        self.n_bytes += bytes.len().next_multiple_of(4) as u64;
        self.images.push(bytes);
        let source = root.push(json::Image {
            buffer_view: Some(buffer_view),
            mime_type: Some(json::image::MimeType("image/png".to_owned())),
            name: None,
            uri: None,
            extensions: None,
            extras: None,
        });
        let index = root.push(json::Texture {
            name: None,
            sampler: None,
            source,
            extensions: None,
            extras: None,
        });
        self.textures.insert(digest, index);
        Ok(index)
    }

    /// Adds the bytes of all images to the buffer, which holds all geometry.
    pub(super) fn finish(self, buffer: &mut BufferBuilder) {
        for image in &self.images {
            buffer.add_image(image);
        }
    }
}

/// What glTF itself has no place for; nothing where the material has nothing of the kind.
fn extensions(
    root: &mut json::Root,
    material: &Material,
    base_color: Option<Index<json::Texture>>,
    strength: Option<f32>,
) -> Option<json::extensions::material::Material> {
    let mut extensions = json::extensions::material::Material::default();
    if let Some(strength) = strength {
        declare(root, EMISSIVE_STRENGTH);
        let emissive_strength = EmissiveStrengthFactor(strength);
        extensions.emissive_strength = Some(EmissiveStrength { emissive_strength });
    }
    if material.translucency > 0.0 {
        declare(root, DIFFUSE_TRANSMISSION);
        let extension = transmission(material, base_color);
        extensions.others.insert(DIFFUSE_TRANSMISSION.to_owned(), extension);
    }
    (strength.is_some() || material.translucency > 0.0).then_some(extensions)
}

fn declare(root: &mut json::Root, extension: &str) {
    if root.extensions_used.iter().all(|known| known != extension) {
        root.extensions_used.push(extension.to_owned());
    }
}

/// The extension's colour tints what comes through in the base colour's stead, so it is the base
/// colour once more.
fn transmission(material: &Material, base_color: Option<Index<json::Texture>>) -> json::Value {
    let [red, green, blue, _] = material.base_color;
    let mut extension = json!({
        "diffuseTransmissionFactor": material.translucency,
        "diffuseTransmissionColorFactor": [red, green, blue],
    });
    if let Some(texture) = base_color {
        extension["diffuseTransmissionColorTexture"] = json!({ "index": texture.value() });
    }
    extension
}

fn info(index: Index<json::Texture>) -> Info {
    Info { index, tex_coord: 0, extensions: None, extras: None }
}

/// Emission as a colour of channels up to 1 and, where it is brighter, its strength.
fn emission(emissive: [f32; 3]) -> Result<([f32; 3], Option<f32>), String> {
    if let Some(bad) = emissive.iter().find(|channel| !(channel.is_finite() && **channel >= 0.0)) {
        return Err(format!("an emission of {bad} (accepted: 0 or more)"));
    }
    let strength = emissive.into_iter().fold(1.0, f32::max);
    if strength > 1.0 {
        Ok((emissive.map(|channel| (channel / strength).min(1.0)), Some(strength)))
    } else {
        Ok((emissive, None))
    }
}
