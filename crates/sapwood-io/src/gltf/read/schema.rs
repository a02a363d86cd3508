//! What of glTF's JSON is read, entry by entry, as it stands there. What is not named is passed
//! over.

use std::borrow::Cow;

use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::value::RawValue;

use super::document::{Bounded, invalid};
use crate::Error;
use crate::spelling::shortened_to;

/// A text that is read where it stands, unless it has escapes.
#[derive(Debug, Deserialize)]
#[serde(transparent)]
pub(super) struct Text<'a>(#[serde(borrow)] pub(super) Cow<'a, str>);

impl Text<'_> {
    /// As messages show it.
    pub(super) fn quoted(&self) -> String {
        quoted(&self.0)
    }
}

/// A text of a file as messages show it: short, on one line, nothing that steers a terminal.
pub(super) fn quoted(text: &str) -> String {
    format!("{:?}", shortened_to(80, text))
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Asset<'a> {
    #[serde(borrow)]
    version: Text<'a>,
    #[serde(borrow)]
    min_version: Option<Text<'a>>,
}

impl Asset<'_> {
    pub(super) fn check(&self) -> Result<(), Error> {
        if !self.version.0.starts_with("2.") {
            return Err(invalid("asset.version", self.version.quoted(), "versions from 2.0 on"));
        }
        match &self.min_version {
            Some(version) if version.0 != "2.0" => {
                Err(invalid("asset.minVersion", version.quoted(), "version 2.0"))
            }
            _ => Ok(()),
        }
    }
}

#[derive(Deserialize)]
pub(super) struct RootExtensions<'a> {
    #[serde(borrow, rename = "KHR_lights_punctual")]
    pub(super) lights: Option<Lights<'a>>,
}

#[derive(Deserialize)]
pub(super) struct Lights<'a> {
    #[serde(borrow)]
    pub(super) lights: Bounded<&'a RawValue>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer<'a> {
    pub(super) byte_length: u64,
    #[serde(borrow)]
    pub(super) uri: Option<Text<'a>>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) byte_length: u64,
    pub(super) byte_stride: Option<u64>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor<'a> {
    pub(super) buffer_view: Option<usize>,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) component_type: u32,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) count: u64,
    #[serde(borrow, rename = "type")]
    pub(super) shape: Text<'a>,
    pub(super) sparse: Option<Sparse>,
}

#[derive(Deserialize)]
pub(super) struct Sparse {
    pub(super) count: u64,
    pub(super) indices: SparseIndices,
    pub(super) values: SparseValues,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseIndices {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) component_type: u32,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseValues {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) byte_offset: u64,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Image<'a> {
    #[serde(borrow)]
    pub(super) uri: Option<Text<'a>>,
    pub(super) buffer_view: Option<usize>,
}

#[derive(Deserialize)]
pub(super) struct Texture {
    pub(super) sampler: Option<usize>,
    pub(super) source: Option<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Sampler {
    pub(super) wrap_s: u32,
    pub(super) wrap_t: u32,
}

impl Sampler {
    pub(super) const REPEAT: u32 = 10497;
}

impl Default for Sampler {
    fn default() -> Self {
        Self { wrap_s: Self::REPEAT, wrap_t: Self::REPEAT }
    }
}

/// A use of a texture.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct TextureInfo {
    pub(super) index: usize,
    #[serde(default)]
    pub(super) tex_coord: usize,
    /// Of normals alone.
    pub(super) scale: Option<f32>,
    #[serde(default)]
    pub(super) extensions: TextureInfoExtensions,
}

#[derive(Default, Deserialize)]
pub(super) struct TextureInfoExtensions {
    #[serde(rename = "KHR_texture_transform")]
    pub(super) transform: Option<TextureTransform>,
}

#[derive(Clone, Copy, Deserialize, PartialEq)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct TextureTransform {
    pub(super) offset: [f32; 2],
    pub(super) rotation: f32,
    pub(super) scale: [f32; 2],
    pub(super) tex_coord: Option<usize>,
}

impl Default for TextureTransform {
    fn default() -> Self {
        Self { offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2], tex_coord: None }
    }
}

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Material<'a> {
    #[serde(borrow)]
    pub(super) name: Option<Text<'a>>,
    #[serde(borrow)]
    pub(super) alpha_mode: Option<Text<'a>>,
    pub(super) alpha_cutoff: Option<f32>,
    pub(super) double_sided: bool,
    pub(super) pbr_metallic_roughness: PbrMetallicRoughness,
    pub(super) normal_texture: Option<TextureInfo>,
    pub(super) occlusion_texture: Option<IgnoredAny>,
    pub(super) emissive_texture: Option<TextureInfo>,
    pub(super) emissive_factor: [f32; 3],
    pub(super) extensions: MaterialExtensions,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct PbrMetallicRoughness {
    pub(super) base_color_factor: [f32; 4],
    pub(super) base_color_texture: Option<TextureInfo>,
    pub(super) metallic_factor: f32,
    pub(super) roughness_factor: f32,
    pub(super) metallic_roughness_texture: Option<TextureInfo>,
}

impl Default for PbrMetallicRoughness {
    fn default() -> Self {
        Self {
            base_color_factor: [1.0; 4],
            base_color_texture: None,
            metallic_factor: 1.0,
            roughness_factor: 1.0,
            metallic_roughness_texture: None,
        }
    }
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_emissive_strength")]
    pub(super) emissive_strength: Option<EmissiveStrength>,
    #[serde(rename = "KHR_materials_diffuse_transmission")]
    pub(super) diffuse_transmission: Option<DiffuseTransmission>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct EmissiveStrength {
    pub(super) emissive_strength: f32,
}

impl Default for EmissiveStrength {
    fn default() -> Self {
        Self { emissive_strength: 1.0 }
    }
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct DiffuseTransmission {
    pub(super) diffuse_transmission_factor: f32,
    pub(super) diffuse_transmission_texture: Option<TextureInfo>,
    pub(super) diffuse_transmission_color_factor: [f32; 3],
    pub(super) diffuse_transmission_color_texture: Option<TextureInfo>,
}

impl Default for DiffuseTransmission {
    fn default() -> Self {
        Self {
            diffuse_transmission_factor: 0.0,
            diffuse_transmission_texture: None,
            diffuse_transmission_color_factor: [1.0; 3],
            diffuse_transmission_color_texture: None,
        }
    }
}

#[derive(Deserialize)]
pub(super) struct Mesh<'a> {
    #[serde(borrow)]
    pub(super) primitives: Bounded<&'a RawValue>,
}

#[derive(Deserialize)]
pub(super) struct Primitive {
    pub(super) attributes: Attributes,
    pub(super) indices: Option<usize>,
    pub(super) material: Option<usize>,
    pub(super) mode: Option<u32>,
    pub(super) targets: Option<IgnoredAny>,
    #[serde(default)]
    pub(super) extensions: PrimitiveExtensions,
}

#[derive(Default, Deserialize)]
pub(super) struct PrimitiveExtensions {
    #[serde(rename = "KHR_draco_mesh_compression")]
    pub(super) draco: Option<IgnoredAny>,
}

#[derive(Clone, PartialEq, Eq, Hash, Deserialize)]
pub(super) struct Attributes {
    #[serde(rename = "POSITION")]
    pub(super) positions: Option<usize>,
    #[serde(rename = "NORMAL")]
    pub(super) normals: Option<usize>,
    #[serde(rename = "TEXCOORD_0")]
    uvs_0: Option<usize>,
    #[serde(rename = "TEXCOORD_1")]
    uvs_1: Option<usize>,
    #[serde(rename = "TEXCOORD_2")]
    uvs_2: Option<usize>,
    #[serde(rename = "TEXCOORD_3")]
    uvs_3: Option<usize>,
    #[serde(rename = "COLOR_0")]
    pub(super) colors: Option<usize>,
}

impl Attributes {
    /// A set of texture coordinates.
    pub(super) fn uvs(&self, set: usize) -> Option<usize> {
        *[self.uvs_0, self.uvs_1, self.uvs_2, self.uvs_3].get(set)?
    }
}

#[derive(Deserialize)]
pub(super) struct Scene {
    #[serde(default)]
    pub(super) nodes: Bounded<usize>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Node<'a> {
    #[serde(borrow)]
    pub(super) name: Option<Text<'a>>,
    pub(super) children: Bounded<usize>,
    pub(super) mesh: Option<usize>,
    pub(super) camera: Option<usize>,
    pub(super) skin: Option<usize>,
    pub(super) matrix: Option<[f32; 16]>,
    pub(super) translation: Option<[f32; 3]>,
    pub(super) rotation: Option<[f32; 4]>,
    pub(super) scale: Option<[f32; 3]>,
    pub(super) extensions: NodeExtensions,
}

/// A node as far as the tree goes.
#[derive(Deserialize)]
pub(super) struct NodeChildren {
    #[serde(default)]
    pub(super) children: Bounded<usize>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct NodeExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub(super) light: Option<NodeLight>,
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub(super) instances: Option<Instancing>,
}

#[derive(Deserialize)]
pub(super) struct NodeLight {
    pub(super) light: usize,
}

#[derive(Deserialize)]
pub(super) struct Instancing {
    pub(super) attributes: InstanceAttributes,
}

#[derive(Deserialize)]
pub(super) struct InstanceAttributes {
    #[serde(rename = "TRANSLATION")]
    pub(super) translations: Option<usize>,
    #[serde(rename = "ROTATION")]
    pub(super) rotations: Option<usize>,
    #[serde(rename = "SCALE")]
    pub(super) scales: Option<usize>,
}

#[derive(Deserialize)]
pub(super) struct Camera<'a> {
    #[serde(borrow)]
    pub(super) name: Option<Text<'a>>,
    #[serde(borrow, rename = "type")]
    pub(super) kind: Text<'a>,
    pub(super) perspective: Option<Perspective>,
    pub(super) orthographic: Option<Orthographic>,
}

#[derive(Deserialize)]
pub(super) struct Perspective {
    pub(super) yfov: f32,
    pub(super) znear: f32,
    pub(super) zfar: Option<f32>,
}

#[derive(Deserialize)]
pub(super) struct Orthographic {
    pub(super) ymag: f32,
    pub(super) znear: f32,
    pub(super) zfar: f32,
}

#[derive(Deserialize)]
pub(super) struct Light<'a> {
    #[serde(borrow)]
    pub(super) name: Option<Text<'a>>,
    #[serde(borrow, rename = "type")]
    pub(super) kind: Text<'a>,
    pub(super) color: Option<[f32; 3]>,
    pub(super) intensity: Option<f32>,
    pub(super) range: Option<f32>,
    pub(super) spot: Option<Spot>,
}

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Spot {
    pub(super) inner_cone_angle: Option<f32>,
    pub(super) outer_cone_angle: Option<f32>,
}
