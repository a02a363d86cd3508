//! Fragments: the flat arrays of render nodes that plans are made of.
//!
//! Nodes stand in pre-order; each carries the number of nodes to skip to pass over it and
//! everything under it. Node 0 is a group that holds the rest. The set of node kinds is closed:
//! match [`RenderNode`] without a `_` arm, so that a new kind shows every traversal that must
//! learn it.

mod builder;
mod shown;

use std::sync::{Arc, OnceLock};

use sapwood_geom::glam::Affine3;
use sapwood_geom::{Bound, BoxTree, Content, Digester, Polyline, Shared, SharedMesh};
use smallvec::SmallVec;

pub use builder::FragmentBuilder;
pub use shown::Shown;

use crate::{Aspects, Camera, Facing, Fading, Kind, Label, Light, Limiter, Material, Rig};

/// A render node as traversals see it.
#[derive(Clone, Copy, Debug)]
pub enum RenderNode<'a> {
    /// Holds its children together.
    Group,
    /// Places its children: parent times child, on column vectors.
    Transform(&'a Affine3),
    /// Places its children by a value that the rule's `visit` keeps up to date: number `.0` of
    /// the site's live values.
    Live(u32),
    /// Turns its children to whoever looks, where that is known; else leaves them as they are.
    Facing(&'a Facing),
    /// Has what it holds drawn by parts, by the distance to whoever looks; without an eye as from
    /// nearby. What other plans supply below it is not its business, and of several such nodes
    /// above each other the lowest counts.
    Fading(&'a Fading),
    /// Has one aspect drawn of what it holds, or two that blend, by the direction of whoever looks;
    /// without an eye some of them. Counts among fading nodes as one of them.
    Aspects(&'a Aspects),
    /// Holds what sways: of the meshes and instances that it has below itself, each vertex and each
    /// instance follows a joint ([`Fragment::followed`]). They stand at rest in every walk;
    /// [`Poses`](crate::Poses) move what a draw list has. What other plans supply below it is not
    /// its business, and of several such nodes above each other the lowest counts.
    Swaying(&'a Shared<Rig>),
    /// A mesh with its material.
    Mesh {
        /// The triangles.
        mesh: &'a SharedMesh,
        /// Their look.
        material: &'a Arc<Material>,
    },
    /// A mesh repeated at many places.
    Instances {
        /// The triangles of one instance.
        mesh: &'a SharedMesh,
        /// Their look.
        material: &'a Arc<Material>,
        /// Where the instances stand, relative to the node.
        transforms: &'a Shared<Vec<Affine3>>,
    },
    /// Lines with radii.
    Lines(&'a Shared<Vec<Polyline>>),
    /// A light at the node's origin.
    Light(&'a Light),
    /// A camera at the node's origin.
    Camera(&'a Camera),
    /// A line of text.
    Label(&'a Label),
    /// Children that other plans supply.
    Deferred(Run<'a>),
}

/// A run of deferred children of one kind: links `first..first + count` of the plan.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// The first link.
    pub first: u32,
    /// How many links.
    pub count: u32,
    /// The kind of all of them.
    pub kind: Kind,
    /// What the rule can tell of their bounds without compiling them, together.
    pub foreseen: Option<&'a Bound>,
}

impl<'a> RenderNode<'a> {
    /// What the node limits by, if it does.
    pub fn limiter(&self) -> Option<Limiter<'a>> {
        match *self {
            Self::Fading(fading) => Some(Limiter::Fading(fading)),
            Self::Aspects(aspects) => Some(Limiter::Aspects(aspects)),
            Self::Group
            | Self::Transform(_)
            | Self::Live(_)
            | Self::Facing(_)
            | Self::Swaying(_)
            | Self::Mesh { .. }
            | Self::Instances { .. }
            | Self::Lines(_)
            | Self::Light(_)
            | Self::Camera(_)
            | Self::Label(_)
            | Self::Deferred(_) => None,
        }
    }
}

#[derive(Clone, Copy, Debug)]
enum Code {
    Group,
    Transform(u32),
    Live(u32),
    Facing(u32),
    Fading(u32),
    Aspects(u32),
    Swaying(u32),
    Mesh(u32),
    Instances(u32),
    Lines(u32),
    Light(u32),
    Camera(u32),
    Label(u32),
    Deferred(u32),
}

#[derive(Clone, Copy, Debug)]
struct Packed {
    code: Code,
    /// Nodes from here to the next sibling, this one included.
    span: u32,
}

/// What the less frequent kinds of nodes hold, one array for each kind.
#[derive(Debug, Default)]
struct Drawn {
    meshes: Vec<(SharedMesh, Arc<Material>)>,
    instances: Vec<Instanced>,
    lines: Vec<Lined>,
    facings: Vec<Facing>,
    fadings: Vec<Fading>,
    aspects: Vec<Aspects>,
    rigs: Vec<Shared<Rig>>,
    lights: Vec<Light>,
    cameras: Vec<Camera>,
    labels: Vec<Label>,
    /// By the number of the node, ascending.
    shown: Vec<(u32, Shown)>,
    /// By the number of the node, ascending.
    followed: Vec<(u32, Followed)>,
}

/// What a node follows, and a bound of it in any wind.
#[derive(Debug)]
struct Followed {
    joints: Shared<Vec<u32>>,
    bound: Bound,
}

#[derive(Debug)]
struct Lined {
    lines: Shared<Vec<Polyline>>,
    material: Option<Arc<Material>>,
}

#[derive(Debug)]
struct Instanced {
    mesh: SharedMesh,
    material: Arc<Material>,
    transforms: Shared<Vec<Affine3>>,
    /// Of one instance, however large it is drawn.
    each: Bound,
    bound: Bound,
    /// Made when a ray comes by for the first time.
    tree: OnceLock<BoxTree>,
}

#[derive(Debug)]
struct StoredRun {
    first: u32,
    count: u32,
    kind: Kind,
    foreseen: Option<Box<Bound>>,
}

impl StoredRun {
    fn as_run(&self) -> Run<'_> {
        let Self { first, count, kind, ref foreseen } = *self;
        Run { first, count, kind, foreseen: foreseen.as_deref() }
    }
}

/// What a rule made of a component: render nodes in pre-order. Immutable once built.
#[derive(Debug)]
pub struct Fragment {
    nodes: SmallVec<[Packed; 3]>,
    transforms: SmallVec<[Affine3; 1]>,
    runs: SmallVec<[StoredRun; 1]>,
    drawn: Option<Box<Drawn>>,
    n_links: u32,
    n_live: u32,
}

impl Fragment {
    /// The fragment that draws nothing and has no children.
    pub fn empty() -> Self {
        FragmentBuilder::new().finish()
    }

    /// Number of render nodes, the group at the top included.
    pub fn len(&self) -> u32 {
        self.nodes.len() as u32
    }

    /// Whether the fragment draws nothing and defers nothing.
    pub fn is_empty(&self) -> bool {
        self.nodes.len() == 1
    }

    /// Number of links to other plans.
    pub fn n_links(&self) -> u32 {
        self.n_links
    }

    /// Number of live values that `visit` keeps up to date.
    pub fn n_live(&self) -> u32 {
        self.n_live
    }

    /// The node at `index`, below [`len`](Self::len).
    pub fn node(&self, index: u32) -> RenderNode<'_> {
        let drawn = || self.drawn.as_deref().expect("drawn nodes have a table");
        match self.nodes[index as usize].code {
            Code::Group => RenderNode::Group,
            Code::Transform(i) => RenderNode::Transform(&self.transforms[i as usize]),
            Code::Live(i) => RenderNode::Live(i),
            Code::Facing(i) => RenderNode::Facing(&drawn().facings[i as usize]),
            Code::Fading(i) => RenderNode::Fading(&drawn().fadings[i as usize]),
            Code::Aspects(i) => RenderNode::Aspects(&drawn().aspects[i as usize]),
            Code::Swaying(i) => RenderNode::Swaying(&drawn().rigs[i as usize]),
            Code::Mesh(i) => {
                let (mesh, material) = &drawn().meshes[i as usize];
                RenderNode::Mesh { mesh, material }
            }
            Code::Instances(i) => {
                let Instanced { mesh, material, transforms, .. } = &drawn().instances[i as usize];
                RenderNode::Instances { mesh, material, transforms }
            }
            Code::Lines(i) => RenderNode::Lines(&drawn().lines[i as usize].lines),
            Code::Light(i) => RenderNode::Light(&drawn().lights[i as usize]),
            Code::Camera(i) => RenderNode::Camera(&drawn().cameras[i as usize]),
            Code::Label(i) => RenderNode::Label(&drawn().labels[i as usize]),
            Code::Deferred(i) => RenderNode::Deferred(self.runs[i as usize].as_run()),
        }
    }

    /// The run that a link below [`n_links`](Self::n_links) belongs to.
    pub fn run_of(&self, link: u32) -> Option<Run<'_>> {
        let behind = self.runs.partition_point(|run| run.first <= link);
        let run = self.runs.get(behind.checked_sub(1)?)?;
        (link - run.first < run.count).then(|| run.as_run())
    }

    /// The node after `index` and everything under it: its next sibling, if it has one.
    pub fn after(&self, index: u32) -> u32 {
        index + self.nodes[index as usize].span
    }

    /// The children of the node at `index`, in order; deferred children are not among them.
    pub fn children(&self, index: u32) -> impl Iterator<Item = u32> + '_ {
        let end = self.after(index);
        let mut next = index + 1;
        std::iter::from_fn(move || {
            let child = next;
            (child < end).then(|| {
                next = self.after(child);
                child
            })
        })
    }

    /// The bound of what the node at `index` draws itself, in its own frame; nothing for nodes
    /// that only hold or place others, and for lights and cameras. What sways stays inside in any
    /// wind.
    pub fn drawn_bound(&self, index: u32) -> Option<Bound> {
        if let Some(followed) = self.followed_by(index) {
            return Some(followed.bound);
        }
        let drawn = || self.drawn.as_deref().expect("drawn nodes have a table");
        match self.nodes[index as usize].code {
            Code::Mesh(i) => Some(*drawn().meshes[i as usize].0.bound()),
            Code::Instances(i) => Some(drawn().instances[i as usize].bound),
            Code::Lines(i) => {
                let lines = &drawn().lines[i as usize].lines;
                let points = lines.iter().flat_map(|line| line.points.iter().copied());
                Some(Bound::of_points(points))
            }
            Code::Label(i) => Some(drawn().labels[i as usize].bound()),
            Code::Group
            | Code::Transform(_)
            | Code::Live(_)
            | Code::Facing(_)
            | Code::Fading(_)
            | Code::Aspects(_)
            | Code::Swaying(_)
            | Code::Light(_)
            | Code::Camera(_)
            | Code::Deferred(_) => None,
        }
    }

    /// What limits what the node at `index` draws: the lowest such node above it. Costs the nodes
    /// before it where the fragment has any such node.
    pub fn limiter_of(&self, index: u32) -> Option<Limiter<'_>> {
        let limits = |drawn: &&Drawn| !(drawn.fadings.is_empty() && drawn.aspects.is_empty());
        self.drawn.as_deref().filter(limits)?;
        let mut limiters =
            (0..index).rev().filter_map(|above| Some((above, self.node(above).limiter()?)));
        limiters.find(|(above, _)| self.after(*above) > index).map(|(_, limiter)| limiter)
    }

    /// How many triangles of a single mesh, instances or lines the node at `index` draws; nothing
    /// for other nodes.
    pub fn n_drawn(&self, index: u32) -> Option<usize> {
        let drawn = || self.drawn.as_deref().expect("drawn nodes have a table");
        match self.nodes[index as usize].code {
            Code::Mesh(i) => Some(drawn().meshes[i as usize].0.n_triangles()),
            Code::Instances(i) => Some(drawn().instances[i as usize].transforms.len()),
            Code::Lines(i) => Some(drawn().lines[i as usize].lines.len()),
            Code::Group
            | Code::Transform(_)
            | Code::Live(_)
            | Code::Facing(_)
            | Code::Fading(_)
            | Code::Aspects(_)
            | Code::Swaying(_)
            | Code::Light(_)
            | Code::Camera(_)
            | Code::Label(_)
            | Code::Deferred(_) => None,
        }
    }

    /// The look of the lines that the node at `index` draws; nothing for other nodes, and where
    /// whoever draws them chooses.
    pub fn line_material(&self, index: u32) -> Option<&Arc<Material>> {
        match self.nodes[index as usize].code {
            Code::Lines(i) => self.drawn.as_deref()?.lines[i as usize].material.as_ref(),
            Code::Group
            | Code::Transform(_)
            | Code::Live(_)
            | Code::Facing(_)
            | Code::Fading(_)
            | Code::Aspects(_)
            | Code::Swaying(_)
            | Code::Mesh(_)
            | Code::Instances(_)
            | Code::Light(_)
            | Code::Camera(_)
            | Code::Label(_)
            | Code::Deferred(_) => None,
        }
    }

    /// Which parts the node at `index` shows, if that is known.
    pub fn shown(&self, index: u32) -> Option<&Shown> {
        let shown = &self.drawn.as_deref()?.shown;
        let row = shown.binary_search_by_key(&index, |(node, _)| *node).ok()?;
        Some(&shown[row].1)
    }

    /// For each vertex of the mesh, or each of the instances, that the node at `index` draws, the
    /// joint that it follows, of the rig of the lowest swaying node above it; nothing where it
    /// follows none.
    pub fn followed(&self, index: u32) -> Option<&Shared<Vec<u32>>> {
        self.followed_by(index).map(|followed| &followed.joints)
    }

    fn followed_by(&self, index: u32) -> Option<&Followed> {
        let followed = &self.drawn.as_deref()?.followed;
        let row = followed.binary_search_by_key(&index, |(node, _)| *node).ok()?;
        Some(&followed[row].1)
    }

    /// The tree over the boxes of the instances of the node at `index`, in the node's frame; the
    /// first call makes it. Nothing for nodes that repeat no mesh.
    pub fn instance_tree(&self, index: u32) -> Option<&BoxTree> {
        let (Code::Instances(i), Some(drawn)) =
            (self.nodes[index as usize].code, self.drawn.as_deref())
        else {
            return None;
        };
        let Instanced { each, transforms, tree, .. } = &drawn.instances[i as usize];
        let of_each = &each.aabb;
        Some(tree.get_or_init(|| BoxTree::new(transforms.iter().map(|t| of_each.transformed(t)))))
    }

    /// The bound of one instance of the node at `index`, however large it is drawn; nothing for
    /// nodes that repeat no mesh.
    fn instanced_bound(&self, index: u32) -> Option<Bound> {
        match self.nodes[index as usize].code {
            Code::Instances(i) => Some(self.drawn.as_deref()?.instances[i as usize].each),
            _ => None,
        }
    }

    /// Triangles that the fragment draws itself, every instance counted.
    pub fn n_triangles(&self) -> u64 {
        let Some(drawn) = self.drawn.as_deref() else { return 0 };
        let meshes = drawn.meshes.iter().map(|(mesh, _)| mesh.n_triangles() as u64);
        let instanced = drawn
            .instances
            .iter()
            .map(|each| each.mesh.n_triangles() as u64 * each.transforms.len() as u64);
        meshes.chain(instanced).sum()
    }
}

impl Content for Fragment {
    fn write(&self, digester: &mut Digester) {
        self.nodes.len().write(digester);
        for index in 0..self.len() {
            (self.nodes[index as usize].span).write(digester);
            match self.node(index) {
                RenderNode::Group => digester.add(&0u8),
                RenderNode::Transform(transform) => digester.add(&1u8).add(transform),
                RenderNode::Live(live) => digester.add(&2u8).add(&live),
                RenderNode::Mesh { mesh, material } => digester.add(&3u8).add(mesh).add(material),
                RenderNode::Instances { mesh, material, transforms } => {
                    digester.add(&4u8).add(mesh).add(material).add(transforms)
                }
                RenderNode::Lines(lines) => {
                    digester.add(&5u8).add(lines).add(&self.line_material(index))
                }
                RenderNode::Facing(facing) => digester.add(&7u8).add(facing),
                RenderNode::Fading(fading) => digester.add(&11u8).add(fading),
                RenderNode::Aspects(aspects) => digester.add(&13u8).add(aspects),
                RenderNode::Swaying(rig) => digester.add(&12u8).add(rig),
                RenderNode::Light(light) => digester.add(&8u8).add(light),
                RenderNode::Camera(camera) => digester.add(&9u8).add(camera),
                RenderNode::Label(label) => digester.add(&10u8).add(label),
                RenderNode::Deferred(run) => {
                    digester.add(&6u8).add(&run.first).add(&run.count).add(run.kind.name());
                    match run.foreseen {
                        None => digester.add(&0u8),
                        Some(bound) => digester.add(&1u8).add(bound),
                    }
                }
            };
        }
        for (index, shown) in self.drawn.iter().flat_map(|drawn| &drawn.shown) {
            digester.add(index).add(shown);
        }
        for (index, followed) in self.drawn.iter().flat_map(|drawn| &drawn.followed) {
            digester.add(index).add(&followed.joints);
        }
    }
}
