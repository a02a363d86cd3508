//! glTF 2.0 in: a `.glb` or `.gltf` file as a model, which is plain data that goes into a scene.
//!
//! Nothing in a file is believed. Every number is checked before it is used, what the file would
//! take is compared with limits before it is allocated, nothing outside the file's folder is
//! opened, and nothing recurses over what the file nests. What is wrong is told with its place;
//! what is left out is told as a warning.
//!
//! The crate that writes glTF is not used here: its reader believes what a validated file holds,
//! refuses extensions by name before anybody can say that they are known, and keeps the whole text
//! as values, which may take a hundred times its length.

mod accessors;
mod buffers;
mod container;
mod document;
mod fixtures;
mod folder;
mod images;
mod materials;
mod meshes;
mod model;
mod nodes;
mod primitives;
mod schema;
mod unfolding;
mod warnings;

use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

use sapwood_geom::glam::{Affine3, Vec3};

pub use self::model::{Model, ModelNode};

use self::buffers::Buffers;
use self::container::Container;
use self::document::{Document, List, invalid};
pub(crate) use self::folder::Folder;
use self::images::Images;
use self::nodes::Tree;
pub(crate) use self::primitives::flat;
use self::unfolding::Unfolding;
use self::warnings::Warnings;
use crate::{Error, ErrorKind};

/// Extensions that may be required of whoever reads a file.
const KNOWN: [&str; 7] = [
    "EXT_mesh_gpu_instancing",
    // What it says of triangles changes none of them.
    "EXT_mesh_manifold",
    "KHR_lights_punctual",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_emissive_strength",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Bytes that tell what a file is.
const HEAD: u64 = 256;
/// A buffer of more bytes than this is read only for a text that is sound.
const LARGE: u64 = 1 << 25;

/// How much of a model file is read; a file that holds more is refused before memory is taken for
/// it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadLimits {
    /// Bytes of the file and of all that it refers to together; 1 GiB by default.
    pub bytes: u64,
    /// Bytes of the file's JSON text; 128 MiB by default. All its lists together may have 2^22
    /// entries.
    pub text_bytes: u64,
    /// Nodes, and meshes' primitives; 2^20 of each by default.
    pub nodes: u64,
    /// Parts of meshes, counted at each node that shows them; 2^20 by default.
    pub shown: u64,
    /// Vertices of all meshes, each mesh counted once; 2^25 by default, which take 1 GiB.
    pub vertices: u64,
    /// Triangles of all meshes, each mesh counted once; 2^26 by default.
    pub triangles: u64,
    /// Instances of all nodes that repeat their mesh, counted for each of its parts; 2^24 by
    /// default.
    pub instances: u64,
    /// Bytes of memory that meshes and instances may take for each byte that was read, besides 64
    /// MiB that they may take anyhow; 32 by default. What a file stores seldom takes more than 16
    /// times its bytes, unless these are used again and again.
    pub unfolding: u64,
    /// Pixels of all images; 2^28 by default, which take 1 GiB.
    pub pixels: u64,
}

impl Default for ReadLimits {
    fn default() -> Self {
        Self {
            bytes: 1 << 30,
            text_bytes: 1 << 27,
            nodes: 1 << 20,
            shown: 1 << 20,
            vertices: 1 << 25,
            triangles: 1 << 26,
            instances: 1 << 24,
            unfolding: 32,
            pixels: 1 << 28,
        }
    }
}

/// Reads the glTF file at `path`, binary or a text with whatever it refers to.
///
/// What is read: the nodes of the scene that the file shows, meshes of triangles (lists, strips and
/// fans), instances, materials with PNG and JPEG images, lights and cameras, and the extensions
/// `EXT_mesh_gpu_instancing`, `KHR_lights_punctual`, `KHR_materials_diffuse_transmission`,
/// `KHR_materials_emissive_strength`, `KHR_mesh_quantization` and `KHR_texture_transform`; of
/// `EXT_mesh_manifold` the triangles, as of any file. Missing
/// normals become those of flat triangles. Everything else is left out with a warning, unless the
/// file says that it cannot be read without it.
///
/// Buffers and images are read from data URIs and from files in the folder of `path` or below it.
///
/// ```no_run
/// use sapwood_io::{ReadLimits, read_gltf};
/// use sapwood_scene::{Scene, built_in_rules};
///
/// let model = read_gltf("tree.glb", &ReadLimits::default())?;
/// let mut scene = Scene::new();
/// let tree = model.add_to(&mut scene);
/// let view = scene.open_view(tree, &built_in_rules())?;
/// println!("{:?}", scene.bounds(view)?.aabb.size());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When a file cannot be read, is not what the standard says, refers to something outside its
/// folder, needs an extension that is not known, or holds more than the limits allow. The error
/// names the file, the place in it, what was found and what is accepted.
pub fn read_gltf(path: impl AsRef<Path>, limits: &ReadLimits) -> Result<Model, Error> {
    let path = path.as_ref();
    let name = path.display().to_string();
    let bytes = read_file(path, limits).map_err(|error| error.in_file(&name))?;
    read(&bytes, Some(path), limits).map_err(|error| error.in_file(&name))
}

fn read_file(path: &Path, limits: &ReadLimits) -> Result<Vec<u8>, Error> {
    let failed = |cause: io::Error| Error::new(ErrorKind::Read { cause });
    let file = File::open(path).map_err(failed)?;
    let metadata = file.metadata().map_err(failed)?;
    let too_long = |bytes| Error::new(ErrorKind::TooLong { bytes, limit: limits.bytes });
    let length = metadata.is_file().then_some(metadata.len());
    if let Some(length) = length.filter(|length| *length > limits.bytes) {
        return Err(too_long(length));
    }
    let mut bytes = Vec::new();
    let read_up_to = |bytes: &mut Vec<u8>, end: u64| {
        let more = end.saturating_sub(bytes.len() as u64);
        (&file).take(more).read_to_end(bytes).map_err(failed)
    };
    read_up_to(&mut bytes, HEAD)?;
    let rest = limits.bytes.saturating_add(1);
    match container::n_text(&bytes, limits.text_bytes)? {
        // A large buffer is not read for a text that is none.
        Some(end) if length.is_none_or(|length| length > end.saturating_add(LARGE)) => {
            read_up_to(&mut bytes, end.min(rest))?;
            let text = &bytes[..bytes.len().min(end as usize)];
            container::look_at_text(text, limits.text_bytes)?;
            bytes.reserve_exact(length.unwrap_or_default().saturating_sub(end) as usize);
            read_up_to(&mut bytes, rest)?;
        }
        Some(_) => {
            bytes.reserve_exact(length.unwrap_or_default() as usize);
            read_up_to(&mut bytes, rest)?;
        }
        None => {
            if let Some(length) = length {
                container::check_text(length, limits.text_bytes)?;
                bytes.reserve_exact(length as usize);
            }
            read_up_to(&mut bytes, rest.min(limits.text_bytes.saturating_add(1)))?;
        }
    }
    match bytes.len() as u64 > limits.bytes {
        true => Err(too_long(bytes.len() as u64)),
        false => Ok(bytes),
    }
}

/// Reads a file's bytes; without the path that they came from, they may refer to no other file.
fn read(bytes: &[u8], path: Option<&Path>, limits: &ReadLimits) -> Result<Model, Error> {
    let mut warnings = Warnings::default();
    let container = Container::of(bytes, limits.text_bytes)?;
    if container.n_behind > 0 {
        warnings.add(String::new, "bytes behind the end that the header tells of are left out");
    }
    let document = Document::of(&container)?;
    look_at_extensions(&document, &mut warnings)?;
    let mut tree = nodes::tree(&document, limits, &mut warnings)?;

    let mut folder = Folder::of(path, bytes.len() as u64, limits.bytes);
    let buffers = Buffers::of(&document, container.bin, &mut folder)?;
    let mut materials = Vec::new();
    let mut unfolding = Unfolding::new(limits, folder.n_read());
    // Counts what is known to be needed, before images are read; the exact count comes later.
    let counted = unfolding.clone();
    let used = &tree.meshes.indices;
    let n_parts = meshes::look_at(&buffers, used, limits, counted, &mut materials, &mut warnings)?;
    nodes::check_shown(&tree, &n_parts, limits)?;
    nodes::read_instances(&mut tree, &n_parts, &buffers, limits, &mut unfolding)?;

    let images = Images::new(&buffers, &mut folder, limits);
    let looks = materials::read(&document, &materials, images, &mut warnings)?;
    let meshes =
        meshes::read(&buffers, &tree.meshes.indices, &looks, &mut unfolding, &mut warnings)?;
    let lights = fixtures::lights(&document, &tree.lights.indices)?;
    let cameras = fixtures::cameras(&document, &tree.cameras.indices)?;
    let Tree { nodes, roots, .. } = tree;
    let own = path.and_then(|path| path.canonicalize().ok());
    let files = own.into_iter().chain(folder.into_files()).collect();
    let warnings = warnings.into_lines();
    let model = Model { nodes, roots, meshes, lights, cameras, warnings, files };
    refuse_infinity(&model)?;
    Ok(model)
}

fn look_at_extensions(document: &Document<'_>, warnings: &mut Warnings) -> Result<(), Error> {
    let is_known = |name: &schema::Text<'_>| KNOWN.contains(&&*name.0);
    if let Some(unknown) = document.extensions_required.iter().find(|name| !is_known(name)) {
        let name = crate::spelling::shortened_to(80, &unknown.0);
        return Err(Error::new(ErrorKind::UnknownExtension { name }));
    }
    for unknown in document.extensions_used.iter().filter(|name| !is_known(name)) {
        let name = crate::spelling::shortened_to(80, &unknown.0);
        warnings.add(String::new, &format!("the extension {name} is left out"));
    }
    if document.len(List::Animations) > 0 {
        warnings.add(String::new, "animations are left out");
    }
    Ok(())
}

/// Refuses models of which something stands so far away, or is so large, that its place in the
/// world is no number any more.
fn refuse_infinity(model: &Model) -> Result<(), Error> {
    for (node, world) in model.nodes.iter().zip(model.worlds()) {
        let Some(parts) = node.mesh.map(|mesh| &model.meshes[mesh]) else { continue };
        let mut bound = sapwood_geom::Aabb::EMPTY;
        for part in parts {
            let aabb = &part.mesh.bound().aabb;
            bound = bound.with_point(aabb.min).with_point(aabb.max);
        }
        let corners: Vec<Vec3> = (0..8)
            .map(|i| {
                let end = |bit: u32, low: f32, high: f32| if i & bit == 0 { low } else { high };
                Vec3::new(
                    end(1, bound.min.x, bound.max.x),
                    end(2, bound.min.y, bound.max.y),
                    end(4, bound.min.z, bound.max.z),
                )
            })
            .collect();
        let reaches = |place: &Affine3| {
            corners.iter().all(|corner| (world * *place).transform_point3(*corner).is_finite())
        };
        let is_finite = parts.is_empty()
            || match &node.instances {
                None => reaches(&Affine3::IDENTITY),
                Some(instances) => instances.iter().all(reaches),
            };
        if !is_finite {
            let at = format!("the node {}", schema::quoted(&node.name));
            return Err(invalid(at, "its mesh is too large or too far away", "finite numbers"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
