//! The document: what of a draw list goes where in a glTF file.

use std::borrow::Cow;

use gltf::binary::{Glb, Header};
use gltf_json as json;
use json::Index;
use json::validation::Checked::Valid;
use sapwood_geom::glam::Affine3;
use sapwood_graph::{Body, DrawList};

use super::buffer::{self, BufferBuilder};
use super::fixtures::{self, Fixtures};
use super::materials::Materials;
use super::placement;
use crate::parts::{self, Part};
use crate::{Error, ErrorKind};

/// The longest file: a `.glb` counts its bytes in 32 bits, and so do many readers of `.bin`.
const LIMIT: u64 = u32::MAX as u64;

/// A glTF document and the bytes of its only buffer, if it has one.
pub(super) struct Document {
    pub(super) root: json::Root,
    pub(super) bin: Option<Vec<u8>>,
}

impl Document {
    pub(super) fn of(list: &DrawList) -> Result<Self, Error> {
        let bodies: Vec<Vec<Part<'_>>> = list.bodies.iter().map(parts::parts).collect();
        // Refused by the sizes alone before any geometry is copied; the JSON is added later.
        let geometry = bodies.iter().flatten().map(buffer::byte_length).sum();
        check_size(geometry)?;
        let mut assembly = Assembly { materials: Materials::new(geometry), ..Assembly::default() };
        let mut materials = Vec::with_capacity(bodies.len());
        for (body, parts) in list.bodies.iter().zip(&bodies) {
            materials.push(assembly.materials_of(body, parts)?);
        }
        check_size(assembly.materials.n_bytes())?;

        assembly.buffer = BufferBuilder::new(assembly.materials.n_bytes());
        let mut drawn = Vec::with_capacity(bodies.len());
        for ((body, parts), materials) in list.bodies.iter().zip(&bodies).zip(&materials) {
            drawn.push(Drawn {
                mesh: assembly.mesh(body, parts, materials)?,
                fixtures: Fixtures::of(body, &mut assembly.root, &mut assembly.lights)?,
            });
        }
        for occurrence in &list.occurrences {
            let body = occurrence.body as usize;
            assembly.occurrence(&list.bodies[body], &drawn[body], &occurrence.world)?;
        }
        Ok(assembly.finish())
    }

    /// Both in one file.
    pub(super) fn into_glb(self) -> Result<Glb<'static>, Error> {
        let Self { root, bin } = self;
        let text = root.to_vec().expect("a glTF document has string keys and finite numbers");
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

fn check_size(bytes: u64) -> Result<(), Error> {
    if bytes > LIMIT {
        return Err(Error::new(ErrorKind::TooLarge { bytes, limit: LIMIT }));
    }
    Ok(())
}

/// An error about what a body draws.
pub(super) fn unwritable(body: &Body, reason: String) -> Error {
    Error::new(ErrorKind::Unwritable { component: body.kind.name().to_owned(), reason })
}

/// A name, or none where it is empty.
pub(super) fn named(name: &str) -> Option<String> {
    (!name.is_empty()).then(|| name.to_owned())
}

/// What a body became.
struct Drawn {
    mesh: Option<Index<json::Mesh>>,
    fixtures: Fixtures,
}

/// The document while it is put together.
#[derive(Default)]
struct Assembly {
    root: json::Root,
    buffer: BufferBuilder,
    top: Vec<Index<json::Node>>,
    materials: Materials,
    lights: Vec<json::extensions::scene::khr_lights_punctual::Light>,
}

impl Assembly {
    /// The materials of a body's parts.
    fn materials_of(
        &mut self,
        body: &Body,
        parts: &[Part<'_>],
    ) -> Result<Vec<Index<json::Material>>, Error> {
        let index = |part: &Part<'_>| {
            let index = self.materials.index(&mut self.root, part.material);
            index.map_err(|reason| {
                unwritable(body, format!("material '{}' has {reason}", part.material.name))
            })
        };
        parts.iter().map(index).collect()
    }

    fn mesh(
        &mut self,
        body: &Body,
        parts: &[Part<'_>],
        materials: &[Index<json::Material>],
    ) -> Result<Option<Index<json::Mesh>>, Error> {
        if parts.is_empty() {
            return Ok(None);
        }
        let mut primitives = Vec::with_capacity(parts.len());
        for (part, material) in parts.iter().zip(materials) {
            let accessors = self.buffer.add(&mut self.root, part);
            let accessors = accessors.map_err(|reason| unwritable(body, reason))?;
            primitives.push(json::mesh::Primitive {
                attributes: [
                    (Valid(json::mesh::Semantic::Positions), accessors.positions),
                    (Valid(json::mesh::Semantic::Normals), accessors.normals),
                    (Valid(json::mesh::Semantic::TexCoords(0)), accessors.uvs),
                ]
                .into(),
                indices: Some(accessors.indices),
                material: Some(*material),
                mode: Valid(json::mesh::Mode::Triangles),
                targets: None,
                extensions: None,
                extras: None,
            });
        }
        Ok(Some(self.root.push(json::Mesh {
            name: named(body.kind.name()),
            primitives,
            weights: None,
            extensions: None,
            extras: None,
        })))
    }

    fn occurrence(&mut self, body: &Body, drawn: &Drawn, world: &Affine3) -> Result<(), Error> {
        if let Some(mesh) = drawn.mesh {
            let node = json::Node {
                name: named(body.kind.name()),
                mesh: Some(mesh),
                ..Default::default()
            };
            self.node(body, node, world)?;
        }
        for (row, light) in body.lights.iter().zip(&drawn.fixtures.lights) {
            let node = fixtures::light_node(&row.light, *light);
            self.node(body, node, &placement::rigid(&(*world * row.local)))?;
        }
        for (row, camera) in body.cameras.iter().zip(&drawn.fixtures.cameras) {
            let node = fixtures::camera_node(&row.camera, *camera);
            self.node(body, node, &placement::rigid(&(*world * row.local)))?;
        }
        for row in &body.labels {
            self.node(body, fixtures::label_node(&row.label), &(*world * row.local))?;
        }
        Ok(())
    }

    /// Puts `node` somewhere in the world.
    fn node(&mut self, body: &Body, mut node: json::Node, world: &Affine3) -> Result<(), Error> {
        if !world.is_finite() {
            return Err(unwritable(body, "its place is not finite".to_owned()));
        }
        let placement = placement::of(world);
        if let Some(rotation) = placement.inner {
            node.rotation = Some(json::scene::UnitQuaternion(rotation));
            let name = node.name.take();
            let inner = self.root.push(node);
            node = json::Node { name, children: Some(vec![inner]), ..Default::default() };
        }
        node.translation = placement.translation;
        node.rotation = placement.rotation.map(json::scene::UnitQuaternion);
        node.scale = placement.scale;
        let index = self.root.push(node);
        self.top.push(index);
        Ok(())
    }

    fn finish(mut self) -> Document {
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
        if !self.lights.is_empty() {
            fixtures::declare_lights(&mut self.root, self.lights);
        }
        self.materials.finish(&mut self.buffer);
        let bin = self.buffer.finish(&mut self.root);
        Document { root: self.root, bin }
    }
}
