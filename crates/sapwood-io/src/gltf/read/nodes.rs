//! Nodes: a tree of places, checked as a whole before any node is read.

use sapwood_geom::glam::{Affine3, Mat3, Quat, Vec3};
use sapwood_geom::{FixedMap, Shared, fixed_state};

use super::ReadLimits;
use super::accessors::{Elements, QUATERNIONS, VECTORS};
use super::buffers::Buffers;
use super::document::{Document, List, below, invalid};
use super::model::ModelNode;
use super::schema;
use super::unfolding::{INSTANCE, Unfolding};
use super::warnings::Warnings;
use crate::{Error, ErrorKind};

/// "No node" among parents.
const NONE: u32 = u32::MAX;

/// Things of a list that nodes refer to, numbered in the order in which they were met.
pub(super) struct Used {
    /// Their numbers in the document.
    pub(super) indices: Vec<usize>,
    places: FixedMap<usize, usize>,
}

impl Used {
    fn place(&mut self, index: usize) -> usize {
        *self.places.entry(index).or_insert_with(|| {
            self.indices.push(index);
            self.indices.len() - 1
        })
    }
}

/// The nodes of the scene that is shown.
pub(super) struct Tree {
    /// Parents stand before their children.
    pub(super) nodes: Vec<ModelNode>,
    pub(super) roots: Vec<usize>,
    pub(super) meshes: Used,
    pub(super) lights: Used,
    pub(super) cameras: Used,
    /// Nodes with instances, by their place here, and what tells where those are.
    pub(super) instancing: Vec<(usize, String, schema::InstanceAttributes)>,
}

/// The nodes below the roots of the scene.
pub(super) fn tree(
    document: &Document<'_>,
    limits: &ReadLimits,
    warnings: &mut Warnings,
) -> Result<Tree, Error> {
    let n = document.len(List::Nodes);
    if n as u64 > limits.nodes {
        let (at, found, limit) = ("nodes".to_owned(), n as u64, limits.nodes);
        return Err(Error::new(ErrorKind::OverLimit { at, found, what: "nodes", limit }));
    }
    let parents = parents(document, n)?;
    let roots = roots(document, &parents, warnings)?;
    let used = || Used { indices: Vec::new(), places: FixedMap::with_hasher(fixed_state()) };
    let mut tree = Tree {
        nodes: Vec::new(),
        roots: Vec::new(),
        meshes: used(),
        lights: used(),
        cameras: used(),
        instancing: Vec::new(),
    };
    // Nodes still to be read, each with its parent's place and where that stands.
    let mut stack: Vec<(usize, Option<usize>, Affine3)> =
        roots.into_iter().rev().map(|root| (root, None, Affine3::IDENTITY)).collect();
    while let Some((index, parent, outside)) = stack.pop() {
        let at = List::Nodes.entry(index);
        let raw: schema::Node<'_> = document.get(List::Nodes, index, &at)?;
        let local = local(&raw, &at)?;
        let world = outside * local;
        if !world.is_finite() {
            return Err(invalid(at, "it is too large or too far away", "finite numbers"));
        }
        let place = tree.nodes.len();
        match parent {
            Some(parent) => tree.nodes[parent].children.push(place),
            None => tree.roots.push(place),
        }
        stack.extend(raw.children.0.iter().rev().map(|child| (*child, Some(place), world)));
        if raw.skin.is_some() {
            warnings.add(|| at.clone(), "skins are left out");
        }
        let is_there = |index: usize, list: List, field: &str| {
            let (n, name) = (document.len(list), list.name());
            match index < n {
                true => Ok(index),
                false => {
                    let found = format!("{} is not there", list.entry(index));
                    Err(invalid(format_args!("{at}.{field}"), found, below(n, name)))
                }
            }
        };
        let mesh = raw.mesh.map(|mesh| is_there(mesh, List::Meshes, "mesh")).transpose()?;
        let light = raw.extensions.light.map(|light| {
            is_there(light.light, List::Lights, "extensions.KHR_lights_punctual.light")
        });
        let camera = raw.camera.map(|camera| is_there(camera, List::Cameras, "camera"));
        if let (Some(instances), Some(_)) = (raw.extensions.instances, mesh) {
            let at = format!("{at}.extensions.EXT_mesh_gpu_instancing.attributes");
            tree.instancing.push((place, at, instances.attributes));
        }
        tree.nodes.push(ModelNode {
            name: raw.name.map(|name| name.0.into_owned()).unwrap_or_default(),
            transform: local,
            children: Vec::with_capacity(raw.children.0.len()),
            mesh: mesh.map(|mesh| tree.meshes.place(mesh)),
            instances: None,
            light: light.transpose()?.map(|light| tree.lights.place(light)),
            camera: camera.transpose()?.map(|camera| tree.cameras.place(camera)),
        });
    }
    Ok(tree)
}

/// The parent of every node.
fn parents(document: &Document<'_>, n: usize) -> Result<Vec<u32>, Error> {
    let mut parents = vec![NONE; n];
    for index in 0..n {
        let at = List::Nodes.entry(index);
        let raw: schema::NodeChildren = document.get(List::Nodes, index, &at)?;
        for (number, child) in raw.children.0.into_iter().enumerate() {
            let at = format_args!("{at}.children[{number}]");
            let Some(parent) = parents.get_mut(child) else {
                let found = format!("nodes[{child}] is not there");
                return Err(invalid(at, found, below(n, "nodes")));
            };
            if *parent != NONE {
                let found = format!("nodes[{child}] is a child of nodes[{parent}] already");
                return Err(invalid(at, found, "nodes without another parent"));
            }
            *parent = index as u32;
        }
    }
    refuse_rings(&parents)?;
    Ok(parents)
}

/// Every way upwards must end.
fn refuse_rings(parents: &[u32]) -> Result<(), Error> {
    // From which node each was met first.
    let mut met = vec![NONE; parents.len()];
    for start in 0..parents.len() as u32 {
        let mut node = start;
        while node != NONE && met[node as usize] == NONE {
            met[node as usize] = start;
            node = parents[node as usize];
        }
        if node != NONE && met[node as usize] == start {
            const SHOWN: usize = 4;
            let mut ring = vec![node];
            let mut next = parents[node as usize];
            while next != node {
                ring.push(next);
                next = parents[next as usize];
            }
            let n = ring.len();
            // From parent to child.
            ring.push(node);
            ring.reverse();
            let mut names: Vec<String> =
                ring.iter().take(SHOWN).map(|node| format!("nodes[{node}]")).collect();
            if ring.len() > SHOWN {
                names.push("...".to_owned());
            }
            let found = format!("a ring of {n} nodes: {}", names.join(" > "));
            return Err(invalid("nodes", found, "trees"));
        }
    }
    Ok(())
}

/// The nodes that stand at the top of the scene that is shown.
fn roots(
    document: &Document<'_>,
    parents: &[u32],
    warnings: &mut Warnings,
) -> Result<Vec<usize>, Error> {
    if document.len(List::Scenes) == 0 {
        if !parents.is_empty() {
            warnings.add(String::new, "there is no scene; all nodes are shown");
        }
        let is_root = |(index, parent): (usize, &u32)| (*parent == NONE).then_some(index);
        return Ok(parents.iter().enumerate().filter_map(is_root).collect());
    }
    if document.scene.is_none() {
        warnings.add(String::new, "no scene is the one to show; the first one is shown");
    }
    let index = document.scene.unwrap_or(0);
    let scene: schema::Scene = document.get(List::Scenes, index, "scene")?;
    let at = List::Scenes.entry(index);
    let mut is_listed = vec![false; parents.len()];
    for (number, node) in scene.nodes.0.iter().enumerate() {
        let at = format_args!("{at}.nodes[{number}]");
        let Some(parent) = parents.get(*node) else {
            let found = format!("nodes[{node}] is not there");
            return Err(invalid(at, found, below(parents.len(), "nodes")));
        };
        if *parent != NONE {
            let found = format!("nodes[{node}] is a child of nodes[{parent}]");
            return Err(invalid(at, found, "nodes without a parent"));
        }
        if std::mem::replace(&mut is_listed[*node], true) {
            return Err(invalid(at, format!("nodes[{node}] is there twice"), "each node once"));
        }
    }
    Ok(scene.nodes.0)
}

/// From the node's frame to that of its parent.
fn local(raw: &schema::Node<'_>, at: &str) -> Result<Affine3, Error> {
    let transform = match raw.matrix {
        Some(m) => {
            if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
                let found = format!("its last row is {:?}", [m[3], m[7], m[11], m[15]]);
                return Err(invalid(format_args!("{at}.matrix"), found, "0, 0, 0, 1"));
            }
            let column = |i: usize| Vec3::new(m[i], m[i + 1], m[i + 2]);
            let matrix3 = Mat3::from_cols(column(0), column(4), column(8));
            Affine3 { matrix3, translation: column(12) }
        }
        None => {
            let [x, y, z, w] = raw.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
            let rotation = unit(Quat::from_xyzw(x, y, z, w)).ok_or_else(|| {
                let found = format!("{:?} is no rotation", raw.rotation.unwrap_or_default());
                invalid(format_args!("{at}.rotation"), found, "a quaternion of length 1")
            })?;
            let scale = raw.scale.map_or(Vec3::ONE, Vec3::from_array);
            let translation = raw.translation.map_or(Vec3::ZERO, Vec3::from_array);
            Affine3::from_scale_rotation_translation(scale, rotation, translation)
        }
    };
    match transform.is_finite() {
        true => Ok(transform),
        false => Err(invalid(at, "its place is not finite", "finite numbers")),
    }
}

/// The quaternion with length 1, if it has a direction.
fn unit(rotation: Quat) -> Option<Quat> {
    let squared = rotation.length_squared();
    if (squared - 1.0).abs() <= 1e-6 {
        return Some(rotation);
    }
    let length = rotation.as_dquat().length();
    (length.is_finite() && length > 1e-12).then(|| (rotation.as_dquat() * (1.0 / length)).as_quat())
}

/// Counts the parts that nodes show; `n_parts` tells how many each mesh has.
pub(super) fn check_shown(tree: &Tree, n_parts: &[u64], limits: &ReadLimits) -> Result<(), Error> {
    let shown = tree.nodes.iter().filter_map(|node| node.mesh).map(|mesh| n_parts[mesh]);
    let (found, limit) = (shown.fold(0, u64::saturating_add), limits.shown);
    if found <= limit {
        return Ok(());
    }
    let (at, what) = ("nodes".to_owned(), "parts of meshes at all nodes of the scene");
    Err(Error::new(ErrorKind::OverLimit { at, found, what, limit }))
}

/// Reads where the instances of nodes are; what several nodes refer to is read once.
pub(super) fn read_instances(
    tree: &mut Tree,
    n_parts: &[u64],
    buffers: &Buffers<'_>,
    limits: &ReadLimits,
    unfolding: &mut Unfolding,
) -> Result<(), Error> {
    let mut n_all = 0u64;
    let mut known: FixedMap<_, Shared<Vec<Affine3>>> = FixedMap::with_hasher(fixed_state());
    for (place, at, attributes) in std::mem::take(&mut tree.instancing) {
        let elements = |index: Option<usize>, name: &str, wanted| {
            let user = format!("{at}.{name}");
            index.map(|index| Elements::of(buffers, index, &user, wanted)).transpose()
        };
        let translations = elements(attributes.translations, "TRANSLATION", &VECTORS)?;
        let rotations = elements(attributes.rotations, "ROTATION", &QUATERNIONS)?;
        let scales = elements(attributes.scales, "SCALE", &VECTORS)?;
        let all = [&translations, &rotations, &scales];
        let mut lengths = all.into_iter().flatten().map(Elements::len);
        let Some(n) = lengths.next() else { continue };
        if let Some(other) = lengths.find(|other| *other != n) {
            let found = format!("{n} and {other} instances");
            return Err(invalid(at, found, "as many of each attribute"));
        }
        let n_parts = tree.nodes[place].mesh.map_or(0, |mesh| n_parts[mesh]).max(1);
        n_all = n_all.saturating_add(n_parts.saturating_mul(n as u64));
        if n_all > limits.instances {
            let (found, limit) = (n_all, limits.instances);
            let what = "instances in the nodes of the scene";
            return Err(Error::new(ErrorKind::OverLimit { at, found, what, limit }));
        }
        let key = (attributes.translations, attributes.rotations, attributes.scales);
        if let Some(instances) = known.get(&key) {
            tree.nodes[place].instances = Some(instances.clone());
            continue;
        }
        unfolding.take(n as u64, INSTANCE, &at)?;
        let translations = read(&translations, n, [0.0; 3])?;
        let rotations = read(&rotations, n, [0.0, 0.0, 0.0, 1.0])?;
        let scales = read(&scales, n, [1.0; 3])?;
        let mut instances = Vec::with_capacity(n);
        for (i, ((at_point, turn), scale)) in
            translations.into_iter().zip(rotations).zip(scales).enumerate()
        {
            let instance = unit(Quat::from_array(turn)).map(|turn| {
                let (scale, at_point) = (Vec3::from_array(scale), Vec3::from_array(at_point));
                Affine3::from_scale_rotation_translation(scale, turn, at_point)
            });
            match instance.filter(Affine3::is_finite) {
                Some(instance) => instances.push(instance),
                None => {
                    let found = format!("instance {i} has no finite place");
                    return Err(invalid(at, found, "finite numbers and rotations of length 1"));
                }
            }
        }
        let instances = Shared::new(instances);
        known.insert(key, instances.clone());
        tree.nodes[place].instances = Some(instances);
    }
    Ok(())
}

fn read<const N: usize>(
    elements: &Option<Elements<'_>>,
    n: usize,
    otherwise: [f32; N],
) -> Result<Vec<[f32; N]>, Error> {
    match elements {
        Some(elements) => elements.floats(None),
        None => Ok(vec![otherwise; n]),
    }
}
