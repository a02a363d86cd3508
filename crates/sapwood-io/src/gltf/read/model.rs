//! Models: what a file holds as plain data, and how that gets into a scene.

use std::path::PathBuf;

use sapwood_geom::Shared;
use sapwood_geom::glam::Affine3;
use sapwood_graph::{Camera, Light};
use sapwood_scene::{Group, Handle, HeldGeometry, HeldInstances, NodeId, Scene, Transform};

/// What was read from a model file.
///
/// Nodes refer to children, meshes, lights and cameras by their places in the lists here. Parents
/// stand before their children, and no node has two.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// The nodes of the scene that the file shows.
    pub nodes: Vec<ModelNode>,
    /// The nodes without a parent.
    pub roots: Vec<usize>,
    /// Meshes, each a list of parts with a material of their own.
    pub meshes: Vec<Vec<HeldGeometry>>,
    /// Lights.
    pub lights: Vec<Light>,
    /// Cameras.
    pub cameras: Vec<Camera>,
    /// What the file has that is not drawn, or is drawn otherwise than it should be: a line for
    /// each kind, with the first place.
    pub warnings: Vec<String>,
    /// The files that were read: the model's own, then those that it refers to, each once and in
    /// the order of their paths. The paths are absolute, with no symbolic links in them.
    pub files: Vec<PathBuf>,
}

/// A place in a model and what is there.
#[derive(Clone, Debug, Default)]
pub struct ModelNode {
    /// Its name in the file; empty where it has none.
    pub name: String,
    /// From the node's frame to that of its parent.
    pub transform: Affine3,
    /// The nodes right below.
    pub children: Vec<usize>,
    /// A mesh.
    pub mesh: Option<usize>,
    /// Where the mesh is repeated, in the node's frame; nothing for a mesh that is there once.
    pub instances: Option<Shared<Vec<Affine3>>>,
    /// A light.
    pub light: Option<usize>,
    /// A camera.
    pub camera: Option<usize>,
}

impl Model {
    /// From the frame of each node to that of the model.
    pub fn worlds(&self) -> Vec<Affine3> {
        let mut worlds = vec![Affine3::IDENTITY; self.nodes.len()];
        for (place, node) in self.nodes.iter().enumerate() {
            let world = worlds[place] * node.transform;
            worlds[place] = world;
            for child in &node.children {
                worlds[*child] = world;
            }
        }
        worlds
    }

    /// Places the model in a scene, below nothing yet, as groups, transforms, held geometry, held
    /// instances, lights and cameras that may be edited like any others.
    ///
    /// What several nodes share is one component below several parents. A model may be placed as
    /// often as wanted; so may the group that this returns, which costs less. Nodes that show
    /// nothing are left out.
    pub fn add_to(&self, scene: &mut Scene) -> Handle<Group> {
        scene.bulk(|scene| {
            let mut placing = Placing {
                model: self,
                meshes: vec![None; self.meshes.len()],
                lights: vec![None; self.lights.len()],
                cameras: vec![None; self.cameras.len()],
                placed: vec![None; self.nodes.len()],
                scene,
            };
            // From the last to the first: children before their parents.
            for place in (0..self.nodes.len()).rev() {
                placing.placed[place] = placing.node(&self.nodes[place]);
            }
            let top = placing.scene.add(Group);
            for root in &self.roots {
                if let Some(root) = placing.placed.get(*root).copied().flatten() {
                    placing.append(top, root);
                }
            }
            top
        })
    }
}

/// A model on its way into a scene.
struct Placing<'a> {
    model: &'a Model,
    scene: &'a mut Scene,
    /// What was placed already.
    meshes: Vec<Option<NodeId>>,
    lights: Vec<Option<NodeId>>,
    cameras: Vec<Option<NodeId>>,
    placed: Vec<Option<NodeId>>,
}

impl Placing<'_> {
    /// Places what is in a node and below it; nothing where it shows nothing.
    fn node(&mut self, node: &ModelNode) -> Option<NodeId> {
        let mut parts = Vec::new();
        match (node.mesh, &node.instances) {
            (Some(mesh), None) => parts.extend(self.mesh(mesh)),
            (Some(mesh), Some(instances)) => {
                for part in self.model.meshes.get(mesh).into_iter().flatten() {
                    let HeldGeometry { mesh, material } = part.clone();
                    let places = instances.clone();
                    parts.push(self.scene.add(HeldInstances { mesh, material, places }).id());
                }
            }
            (None, _) => {}
        }
        parts.extend(node.light.and_then(|light| {
            let slot = self.lights.get_mut(light)?;
            Some(*slot.get_or_insert_with(|| self.scene.add(self.model.lights[light].clone()).id()))
        }));
        parts.extend(node.camera.and_then(|camera| {
            let slot = self.cameras.get_mut(camera)?;
            Some(
                *slot
                    .get_or_insert_with(|| self.scene.add(self.model.cameras[camera].clone()).id()),
            )
        }));
        parts.extend(node.children.iter().filter_map(|child| *self.placed.get(*child)?));
        let inside = self.together(&parts)?;
        if node.transform == Affine3::IDENTITY {
            return Some(inside);
        }
        let transform = self.scene.add(Transform(node.transform));
        self.append(transform, inside);
        Some(transform.id())
    }

    /// A mesh, placed once.
    fn mesh(&mut self, mesh: usize) -> Option<NodeId> {
        if let Some(placed) = *self.meshes.get(mesh)? {
            return Some(placed);
        }
        let parts = self.model.meshes[mesh].iter();
        let parts: Vec<NodeId> = parts.map(|part| self.scene.add(part.clone()).id()).collect();
        let placed = self.together(&parts)?;
        self.meshes[mesh] = Some(placed);
        Some(placed)
    }

    /// One component that stands for several.
    fn together(&mut self, parts: &[NodeId]) -> Option<NodeId> {
        match parts {
            [] => None,
            [part] => Some(*part),
            parts => {
                let group = self.scene.add(Group);
                parts.iter().for_each(|part| self.append(group, *part));
                Some(group.id())
            }
        }
    }

    fn append(&mut self, parent: impl Into<NodeId>, child: NodeId) {
        let appended = self.scene.append(parent, child);
        appended.expect("a new group or transform has room and is below nothing");
    }
}
