//! The document: what of a draw list goes where in a glTF file.

use std::borrow::Cow;
use std::collections::BTreeMap;

use gltf::binary::{Glb, Header};
use gltf_json as json;
use json::Index;
use json::accessor::Type;
use json::extras::RawValue;
use json::validation::Checked::Valid;
use sapwood_geom::glam::{Affine3, Mat4, Vec3};
use sapwood_graph::{Body, DrawList};

use super::buffer::{self, BufferBuilder};
use super::fixtures::{self, Fixtures};
use super::manifold::{self, Manifold};
use super::materials::Materials;
use super::placement;
use super::sway::{Skeleton, SwayAnimation, Swayed};
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
        Ok(Self::animated(list, None)?.0)
    }

    /// The document of a list, of which what sways does so as `animation` has it.
    pub(super) fn animated(
        list: &DrawList,
        animation: Option<&SwayAnimation>,
    ) -> Result<(Self, Swayed), Error> {
        let bodies: Vec<Vec<Part<'_>>> = list.bodies.iter().map(parts::parts).collect();
        let skeletons: Vec<Option<Skeleton<'_>>> = list
            .bodies
            .iter()
            .map(|body| animation.and_then(|animation| Skeleton::of(body, animation)))
            .collect();
        let times = animation.map_or_else(Vec::new, SwayAnimation::times);
        // What joints bend is a solid only at rest, and its vertices need their joints.
        let solid = |((body, parts), skeleton): ((&Body, &Vec<Part<'_>>), &Option<_>)| {
            let is_still = body.is_solid && skeleton.is_none();
            if is_still { Manifold::of(parts) } else { None }
        };
        let manifolds: Vec<_> =
            list.bodies.iter().zip(&bodies).zip(&skeletons).map(solid).collect();
        // Refused by the sizes alone before any geometry is copied; the JSON is added later.
        let length = |(parts, manifold): (&Vec<Part<'_>>, &Option<Manifold>)| match manifold {
            Some(manifold) => manifold.byte_length(),
            None => parts.iter().map(buffer::byte_length).sum(),
        };
        let mut geometry = bodies.iter().zip(&manifolds).map(length).sum();
        let mut swayed = Swayed::default();
        for (parts, skeleton) in bodies.iter().zip(&skeletons) {
            let Some(skeleton) = skeleton else { continue };
            let joints = parts.iter().map(|part| buffer::joints_length(part, skeleton));
            geometry += joints.sum::<u64>() + skeleton.byte_length(times.len());
            swayed.n_joints += skeleton.swayed.n_joints;
            swayed.n_rigid += skeleton.swayed.n_rigid;
        }
        if swayed.n_joints > 0 {
            geometry += 4 * times.len() as u64;
        }
        check_size(geometry)?;
        let mut assembly = Assembly { materials: Materials::new(geometry), ..Assembly::default() };
        let mut materials = Vec::with_capacity(bodies.len());
        for (body, parts) in list.bodies.iter().zip(&bodies) {
            materials.push(assembly.materials_of(body, parts)?);
        }
        check_size(assembly.materials.n_bytes())?;

        assembly.buffer = BufferBuilder::new(assembly.materials.n_bytes());
        if swayed.n_joints > 0 {
            assembly.animate(&times);
        }
        let mut drawn = Vec::with_capacity(bodies.len());
        let all = list.bodies.iter().zip(&bodies).zip(&materials).zip(&skeletons).zip(&manifolds);
        for ((((body, parts), materials), skeleton), manifold) in all {
            let mesh = match manifold {
                Some(manifold) => assembly.solid(body, parts, materials, manifold)?,
                None => assembly.mesh(body, parts, materials, skeleton.as_ref())?,
            };
            drawn.push(Drawn {
                mesh,
                skin: skeleton.as_ref().map(|skeleton| assembly.skin(skeleton, &times)),
                fixtures: Fixtures::of(body, &mut assembly.root, &mut assembly.lights)?,
            });
        }
        for occurrence in &list.occurrences {
            let body = occurrence.body as usize;
            let skeleton = skeletons[body].as_ref();
            assembly.occurrence(&list.bodies[body], &drawn[body], skeleton, &occurrence.world)?;
        }
        Ok((assembly.finish(), swayed))
    }

    /// The same, which says this about what it holds.
    pub(super) fn noting(mut self, notes: &[(String, String)]) -> Self {
        let text = |text: &String| json::serialize::to_string(text).expect("a text is JSON");
        let entries: Vec<String> =
            notes.iter().map(|(key, note)| format!("{}:{}", text(key), text(note))).collect();
        if !entries.is_empty() {
            let extras = RawValue::from_string(format!("{{{}}}", entries.join(",")));
            self.root.asset.extras = Some(extras.expect("texts below texts are JSON"));
        }
        self
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

/// Triangles with these accessors.
fn primitive(
    attributes: BTreeMap<json::validation::Checked<json::mesh::Semantic>, Index<json::Accessor>>,
    indices: Index<json::Accessor>,
    material: Index<json::Material>,
) -> json::mesh::Primitive {
    json::mesh::Primitive {
        attributes,
        indices: Some(indices),
        material: Some(material),
        mode: Valid(json::mesh::Mode::Triangles),
        targets: None,
        extensions: None,
        extras: None,
    }
}

/// What a body became.
struct Drawn {
    mesh: Option<Index<json::Mesh>>,
    skin: Option<DrawnSkin>,
    fixtures: Fixtures,
}

/// What all skins of a body share.
struct DrawnSkin {
    /// What undoes the places of its joints.
    inverse_bind_matrices: Index<json::Accessor>,
    /// How each of its joints turns, but for the one that holds them.
    samplers: Vec<Index<json::animation::Sampler>>,
}

/// The document while it is put together.
#[derive(Default)]
struct Assembly {
    root: json::Root,
    buffer: BufferBuilder,
    top: Vec<Index<json::Node>>,
    materials: Materials,
    lights: Vec<json::extensions::scene::khr_lights_punctual::Light>,
    animation: Option<Animating>,
}

/// The one animation in the making.
struct Animating {
    times: Index<json::Accessor>,
    samplers: Vec<json::animation::Sampler>,
    channels: Vec<json::animation::Channel>,
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
        skeleton: Option<&Skeleton<'_>>,
    ) -> Result<Option<Index<json::Mesh>>, Error> {
        if parts.is_empty() {
            return Ok(None);
        }
        let mut primitives = Vec::with_capacity(parts.len());
        for (part, material) in parts.iter().zip(materials) {
            let accessors = self.buffer.add(&mut self.root, part);
            let accessors = accessors.map_err(|reason| unwritable(body, reason))?;
            let mut attributes: BTreeMap<_, _> = [
                (Valid(json::mesh::Semantic::Positions), accessors.positions),
                (Valid(json::mesh::Semantic::Normals), accessors.normals),
                (Valid(json::mesh::Semantic::TexCoords(0)), accessors.uvs),
            ]
            .into();
            if let Some(skeleton) = skeleton {
                let (joints, weights) = self.buffer.add_joints(&mut self.root, part, skeleton);
                attributes.insert(Valid(json::mesh::Semantic::Joints(0)), joints);
                attributes.insert(Valid(json::mesh::Semantic::Weights(0)), weights);
            }
            primitives.push(primitive(attributes, accessors.indices, *material));
        }
        Ok(Some(self.push_mesh(body, primitives, None)))
    }

    /// The mesh of a body that is one closed surface, and is told to be.
    fn solid(
        &mut self,
        body: &Body,
        parts: &[Part<'_>],
        materials: &[Index<json::Material>],
        manifold: &Manifold,
    ) -> Result<Option<Index<json::Mesh>>, Error> {
        let written = self.buffer.add_manifold(&mut self.root, parts, manifold);
        let written = written.map_err(|reason| unwritable(body, reason))?;
        let [positions, normals, uvs] = written.attributes;
        let attributes: BTreeMap<_, _> = [
            (Valid(json::mesh::Semantic::Positions), positions),
            (Valid(json::mesh::Semantic::Normals), normals),
            (Valid(json::mesh::Semantic::TexCoords(0)), uvs),
        ]
        .into();
        let both = written.indices.iter().zip(materials);
        let primitives = both
            .map(|(indices, material)| primitive(attributes.clone(), *indices, *material))
            .collect();
        let mut others = serde_json::Map::new();
        others.insert(manifold::NAME.to_owned(), written.extension);
        if !self.root.extensions_used.iter().any(|used| used == manifold::NAME) {
            self.root.extensions_used.push(manifold::NAME.to_owned());
        }
        let extension = json::extensions::mesh::Mesh { others };
        Ok(Some(self.push_mesh(body, primitives, Some(extension))))
    }

    fn push_mesh(
        &mut self,
        body: &Body,
        primitives: Vec<json::mesh::Primitive>,
        extensions: Option<json::extensions::mesh::Mesh>,
    ) -> Index<json::Mesh> {
        let name = named(body.kind.name());
        self.root.push(json::Mesh { name, primitives, weights: None, extensions, extras: None })
    }

    /// Adds the times of the animation's keyframes.
    fn animate(&mut self, times: &[f32]) {
        let elements: Vec<[f32; 1]> = times.iter().map(|time| [*time]).collect();
        let index = self.buffer.add_floats(&mut self.root, Type::Scalar, &elements);
        let accessor = &mut self.root.accessors[index.value()];
        let ends = [times.first(), times.last()].map(|time| time.copied().unwrap_or(0.0));
        [accessor.min, accessor.max] = ends.map(|time| Some(json::Value::from(vec![time])));
        let (samplers, channels) = (Vec::new(), Vec::new());
        self.animation = Some(Animating { times: index, samplers, channels });
    }

    /// Adds what all skins of a body share.
    fn skin(&mut self, skeleton: &Skeleton<'_>, times: &[f32]) -> DrawnSkin {
        let origins = skeleton.joints.iter().map(|joint| joint.origin);
        let matrices: Vec<[f32; 16]> = std::iter::once(Vec3::ZERO)
            .chain(origins)
            .map(|origin| Mat4::from_translation(-origin).to_cols_array())
            .collect();
        let inverse_bind_matrices = self.buffer.add_floats(&mut self.root, Type::Mat4, &matrices);
        let mut samplers = Vec::with_capacity(skeleton.joints.len());
        if let Some(animation) = &mut self.animation {
            for joint in &skeleton.joints {
                let turns = joint.turns(times);
                let output = self.buffer.add_floats(&mut self.root, Type::Vec4, &turns);
                samplers.push(Index::new(animation.samplers.len() as u32));
                animation.samplers.push(json::animation::Sampler {
                    input: animation.times,
                    interpolation: Valid(json::animation::Interpolation::Linear),
                    output,
                    extensions: None,
                    extras: None,
                });
            }
        }
        DrawnSkin { inverse_bind_matrices, samplers }
    }

    /// Puts a body's joints and its skinned mesh somewhere in the world. The mesh is where its
    /// joints are, whatever node has it.
    fn skinned(
        &mut self,
        body: &Body,
        mesh: Index<json::Mesh>,
        (skin, skeleton): (&DrawnSkin, &Skeleton<'_>),
        world: &Affine3,
    ) -> Result<(), Error> {
        let first = self.root.nodes.len();
        // The joints first, in their order; the one that holds them behind, for it is placed.
        let node = |number: usize| Index::new((first + number - 1) as u32);
        let mut children: Vec<Vec<Index<json::Node>>> = vec![Vec::new(); skeleton.len()];
        for (number, joint) in (1..).zip(&skeleton.joints) {
            children[joint.parent].push(node(number));
        }
        let mut children = children.into_iter();
        let held = children.next();
        for (number, (joint, children)) in (1..).zip(skeleton.joints.iter().zip(children)) {
            self.root.push(json::Node {
                translation: Some(joint.offset.to_array()),
                children: (!children.is_empty()).then_some(children),
                name: Some(format!("joint {number}")),
                ..Default::default()
            });
        }
        let holder = json::Node { name: named("joints"), children: held, ..Default::default() };
        let holder = self.node(body, holder, world)?;
        let joints = (1..skeleton.len()).map(node);
        let joints: Vec<_> = std::iter::once(holder).chain(joints).collect();
        if let Some(animation) = &mut self.animation {
            for (sampler, joint) in skin.samplers.iter().zip(&joints[1..]) {
                animation.channels.push(json::animation::Channel {
                    sampler: *sampler,
                    target: json::animation::Target {
                        node: *joint,
                        path: Valid(json::animation::Property::Rotation),
                        extensions: None,
                        extras: None,
                    },
                    extensions: None,
                    extras: None,
                });
            }
        }
        let skin = self.root.push(json::Skin {
            inverse_bind_matrices: Some(skin.inverse_bind_matrices),
            joints,
            name: named(body.kind.name()),
            skeleton: Some(holder),
            extensions: None,
            extras: None,
        });
        let name = named(body.kind.name());
        let node = json::Node { name, mesh: Some(mesh), skin: Some(skin), ..Default::default() };
        let index = self.root.push(node);
        self.top.push(index);
        Ok(())
    }

    fn occurrence(
        &mut self,
        body: &Body,
        drawn: &Drawn,
        skeleton: Option<&Skeleton<'_>>,
        world: &Affine3,
    ) -> Result<(), Error> {
        if let (Some(mesh), Some(skin)) = (drawn.mesh, drawn.skin.as_ref().zip(skeleton)) {
            self.skinned(body, mesh, skin, world)?;
        } else if let Some(mesh) = drawn.mesh {
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

    /// Puts `node` somewhere in the world, and tells where it is: what holds it may be another.
    fn node(
        &mut self,
        body: &Body,
        mut node: json::Node,
        world: &Affine3,
    ) -> Result<Index<json::Node>, Error> {
        if !world.is_finite() {
            return Err(unwritable(body, "its place is not finite".to_owned()));
        }
        let placement = placement::of(world);
        let mut held = None;
        if let Some(rotation) = placement.inner {
            node.rotation = Some(json::scene::UnitQuaternion(rotation));
            let name = node.name.take();
            let inner = self.root.push(node);
            held = Some(inner);
            node = json::Node { name, children: Some(vec![inner]), ..Default::default() };
        }
        node.translation = placement.translation;
        node.rotation = placement.rotation.map(json::scene::UnitQuaternion);
        node.scale = placement.scale;
        let index = self.root.push(node);
        self.top.push(index);
        Ok(held.unwrap_or(index))
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
        if let Some(Animating { samplers, channels, .. }) = self.animation {
            self.root.push(json::Animation {
                channels,
                samplers,
                name: named("wind"),
                extensions: None,
                extras: None,
            });
        }
        self.materials.finish(&mut self.buffer);
        let bin = self.buffer.finish(&mut self.root);
        Document { root: self.root, bin }
    }
}
