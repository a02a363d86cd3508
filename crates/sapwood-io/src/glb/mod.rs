//! Binary glTF 2.0: a draw list as one self-contained `.glb` file.
//!
//! Every body becomes one glTF mesh with one primitive for each material, and every occurrence
//! one node, so what several occurrences share is written once. Lines have no place in these
//! files and are left out.

mod buffer;
mod merge;
mod placement;

use std::borrow::Cow;
use std::io;
use std::path::Path;

use gltf::binary::{Glb, Header};
use gltf_json as json;
use json::Index;
use json::validation::Checked::Valid;
use sapwood_geom::glam::Affine3;
use sapwood_graph::{DrawList, Material};

use crate::{Error, ErrorKind, write_atomically};
use buffer::BufferBuilder;
use merge::Part;

/// The longest `.glb` file: its header counts bytes in 32 bits.
const LIMIT: u64 = u32::MAX as u64;

/// The bytes of a `.glb` file with everything in `list` that has triangles.
///
/// The same list gives the same bytes. A list without triangles gives a valid file without
/// scene and meshes.
///
/// # Errors
/// When a mesh, a material or a place holds a value that glTF does not allow (NaN, an index
/// without a vertex), or the file would be longer than 4 GiB; the size is found before any
/// geometry is copied.
pub fn glb_bytes(list: &DrawList) -> Result<Vec<u8>, Error> {
    let glb = assemble(list)?;
    let mut bytes = Vec::with_capacity(glb.header.length as usize);
    glb.to_writer(&mut bytes)
        .map_err(|error| Error::new(ErrorKind::Write { cause: to_io(error) }))?;
    Ok(bytes)
}

/// Writes what [`glb_bytes`] gives to the file at `path`, whole or not at all.
///
/// # Errors
/// Those of [`glb_bytes`] and of [`write_atomically`].
pub fn write_glb(path: impl AsRef<Path>, list: &DrawList) -> Result<(), Error> {
    let path = path.as_ref();
    let glb = assemble(list).map_err(|error| error.in_file(&path.display().to_string()))?;
    write_atomically(path, |out| glb.to_writer(out).map_err(to_io))
}

fn to_io(error: gltf::Error) -> io::Error {
    match error {
        gltf::Error::Io(cause) => cause,
        other => io::Error::other(other),
    }
}

fn assemble(list: &DrawList) -> Result<Glb<'static>, Error> {
    let bodies: Vec<Vec<Part<'_>>> = list.bodies.iter().map(merge::parts).collect();
    // Refused by the geometry alone before a byte of it is copied; the JSON is added below.
    let bytes = bodies.iter().flatten().map(buffer::byte_length).sum();
    check_size(bytes)?;

    let buffer = BufferBuilder::new(bytes);
    let mut writer = Assembly { buffer, ..Assembly::default() };
    let mut meshes = Vec::with_capacity(bodies.len());
    for (body, parts) in list.bodies.iter().zip(&bodies) {
        meshes.push(match parts.as_slice() {
            [] => None,
            parts => Some(writer.mesh(body.kind.name(), parts)?),
        });
    }
    for occurrence in &list.occurrences {
        let body = occurrence.body as usize;
        if let Some(mesh) = meshes[body] {
            writer.node(list.bodies[body].kind.name(), &occurrence.world, mesh)?;
        }
    }
    writer.finish()
}

fn check_size(bytes: u64) -> Result<(), Error> {
    if bytes > LIMIT {
        return Err(Error::new(ErrorKind::TooLarge { bytes, limit: LIMIT }));
    }
    Ok(())
}

/// The file while it is put together.
#[derive(Default)]
struct Assembly {
    root: json::Root,
    buffer: BufferBuilder,
    top: Vec<Index<json::Node>>,
    materials: Vec<(MaterialKey, Index<json::Material>)>,
}

/// What tells two materials apart.
type MaterialKey = (String, [u32; 6], bool);

impl Assembly {
    fn mesh(&mut self, name: &str, parts: &[Part<'_>]) -> Result<Index<json::Mesh>, Error> {
        let mut primitives = Vec::with_capacity(parts.len());
        for part in parts {
            let material = self.material(part.material, name)?;
            let accessors = self.buffer.add(&mut self.root, part).map_err(|reason| {
                Error::new(ErrorKind::Unwritable { component: name.to_owned(), reason })
            })?;
            primitives.push(json::mesh::Primitive {
                attributes: [
                    (Valid(json::mesh::Semantic::Positions), accessors.positions),
                    (Valid(json::mesh::Semantic::Normals), accessors.normals),
                    (Valid(json::mesh::Semantic::TexCoords(0)), accessors.uvs),
                ]
                .into(),
                indices: Some(accessors.indices),
                material: Some(material),
                mode: Valid(json::mesh::Mode::Triangles),
                targets: None,
                extensions: None,
                extras: None,
            });
        }
        Ok(self.root.push(json::Mesh {
            name: named(name),
            primitives,
            weights: None,
            extensions: None,
            extras: None,
        }))
    }

    fn material(
        &mut self,
        material: &Material,
        component: &str,
    ) -> Result<Index<json::Material>, Error> {
        let [r, g, b, a] = material.base_color;
        let factors = [r, g, b, a, material.metallic, material.roughness];
        let key = (material.name.clone(), factors.map(f32::to_bits), material.double_sided);
        if let Some((_, index)) = self.materials.iter().find(|(known, _)| *known == key) {
            return Ok(*index);
        }
        if let Some(bad) = factors.iter().find(|factor| !(0.0..=1.0).contains(*factor)) {
            let reason =
                format!("material '{}' has a factor of {bad} (accepted: 0 to 1)", material.name);
            let component = component.to_owned();
            return Err(Error::new(ErrorKind::Unwritable { component, reason }));
        }
        let see_through = a < 1.0;
        let index = self.root.push(json::Material {
            name: named(&material.name),
            alpha_mode: Valid(if see_through {
                json::material::AlphaMode::Blend
            } else {
                json::material::AlphaMode::Opaque
            }),
            double_sided: material.double_sided,
            pbr_metallic_roughness: json::material::PbrMetallicRoughness {
                base_color_factor: json::material::PbrBaseColorFactor(material.base_color),
                metallic_factor: json::material::StrengthFactor(material.metallic),
                roughness_factor: json::material::StrengthFactor(material.roughness),
                ..Default::default()
            },
            ..Default::default()
        });
        self.materials.push((key, index));
        Ok(index)
    }

    fn node(&mut self, name: &str, world: &Affine3, mesh: Index<json::Mesh>) -> Result<(), Error> {
        if !world.is_finite() {
            let component = name.to_owned();
            let reason = "its place is not finite".to_owned();
            return Err(Error::new(ErrorKind::Unwritable { component, reason }));
        }
        let placement = placement::of(world);
        let mut node = json::Node { mesh: Some(mesh), ..Default::default() };
        if let Some(rotation) = placement.inner {
            node.rotation = Some(json::scene::UnitQuaternion(rotation));
            let inner = self.root.push(node);
            node = json::Node { children: Some(vec![inner]), ..Default::default() };
        }
        node.name = named(name);
        node.translation = placement.translation;
        node.rotation = placement.rotation.map(json::scene::UnitQuaternion);
        node.scale = placement.scale;
        let index = self.root.push(node);
        self.top.push(index);
        Ok(())
    }

    fn finish(mut self) -> Result<Glb<'static>, Error> {
        self.root.asset.generator = Some(format!("Sapwood {}", env!("CARGO_PKG_VERSION")));
        // A scene without nodes is left out: readers differ about those.
        if !self.top.is_empty() {
            let scene = self.root.push(json::Scene {
                name: None,
                nodes: self.top,
                extensions: None,
                extras: None,
            });
            self.root.scene = Some(scene);
        }
        let bin = self.buffer.finish(&mut self.root);
        let text = self.root.to_vec().expect("a glTF document has string keys and finite numbers");
        let padded = |length: usize| length.next_multiple_of(4) as u64;
        let length =
            12 + 8 + padded(text.len()) + bin.as_ref().map_or(0, |bin| 8 + padded(bin.len()));
        check_size(length)?;
        Ok(Glb {
            header: Header { magic: *b"glTF", version: 2, length: length as u32 },
            json: Cow::Owned(text),
            bin: bin.map(Cow::Owned),
        })
    }
}

/// A name, or none where it is empty.
fn named(name: &str) -> Option<String> {
    (!name.is_empty()).then(|| name.to_owned())
}

#[cfg(test)]
mod tests;
