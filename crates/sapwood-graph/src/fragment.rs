//! Fragments: the flat arrays of render nodes that plans are made of.
//!
//! Nodes stand in pre-order; each carries the number of nodes to skip to pass over it and
//! everything under it. Node 0 is a group that holds the rest. The set of node kinds is closed:
//! match [`RenderNode`] without a `_` arm, so that a new kind shows every traversal that must
//! learn it.

use std::sync::Arc;

use sapwood_geom::glam::Affine3;
use sapwood_geom::{Bound, Content, Digester, Polyline, Shared, SharedMesh};
use smallvec::SmallVec;

use crate::{Kind, Material};

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

#[derive(Clone, Copy, Debug)]
enum Code {
    Group,
    Transform(u32),
    Live(u32),
    Mesh(u32),
    Instances(u32),
    Lines(u32),
    Deferred(u32),
}

#[derive(Clone, Copy, Debug)]
struct Packed {
    code: Code,
    /// Nodes from here to the next sibling, this one included.
    span: u32,
}

#[derive(Debug, Default)]
struct Drawn {
    meshes: Vec<(SharedMesh, Arc<Material>)>,
    instances: Vec<Instanced>,
    lines: Vec<Shared<Vec<Polyline>>>,
}

#[derive(Debug)]
struct Instanced {
    mesh: SharedMesh,
    material: Arc<Material>,
    transforms: Shared<Vec<Affine3>>,
    bound: Bound,
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
        let drawn = |i: u32| (self.drawn.as_deref().expect("drawn nodes have a table"), i as usize);
        match self.nodes[index as usize].code {
            Code::Group => RenderNode::Group,
            Code::Transform(i) => RenderNode::Transform(&self.transforms[i as usize]),
            Code::Live(i) => RenderNode::Live(i),
            Code::Mesh(i) => {
                let (drawn, i) = drawn(i);
                RenderNode::Mesh { mesh: &drawn.meshes[i].0, material: &drawn.meshes[i].1 }
            }
            Code::Instances(i) => {
                let (drawn, i) = drawn(i);
                let Instanced { mesh, material, transforms, .. } = &drawn.instances[i];
                RenderNode::Instances { mesh, material, transforms }
            }
            Code::Lines(i) => {
                let (drawn, i) = drawn(i);
                RenderNode::Lines(&drawn.lines[i])
            }
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
    /// that only hold or place others.
    pub fn drawn_bound(&self, index: u32) -> Option<Bound> {
        match (self.nodes[index as usize].code, self.drawn.as_deref()) {
            (Code::Mesh(i), Some(drawn)) => Some(*drawn.meshes[i as usize].0.bound()),
            (Code::Instances(i), Some(drawn)) => Some(drawn.instances[i as usize].bound),
            (Code::Lines(i), Some(drawn)) => {
                let lines = &drawn.lines[i as usize];
                let points = lines.iter().flat_map(|line| line.points.iter().copied());
                Some(Bound::of_points(points))
            }
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
                RenderNode::Lines(lines) => digester.add(&5u8).add(lines),
                RenderNode::Deferred(run) => {
                    digester.add(&6u8).add(&run.first).add(&run.count).add(run.kind.name());
                    match run.foreseen {
                        None => digester.add(&0u8),
                        Some(bound) => digester.add(&1u8).add(bound),
                    }
                }
            };
        }
    }
}

/// Builds a [`Fragment`] node by node; whoever opens a node closes it.
pub struct FragmentBuilder {
    fragment: Fragment,
    open: SmallVec<[u32; 8]>,
    /// The run at the end of the node that is open, which further children may lengthen.
    run: Option<u32>,
}

impl FragmentBuilder {
    /// A builder whose top group is open.
    pub fn new() -> Self {
        let top = Packed { code: Code::Group, span: 1 };
        Self {
            fragment: Fragment {
                nodes: smallvec::smallvec![top],
                transforms: SmallVec::new(),
                runs: SmallVec::new(),
                drawn: None,
                n_links: 0,
                n_live: 0,
            },
            open: smallvec::smallvec![0],
            run: None,
        }
    }

    fn push(&mut self, code: Code) {
        self.run = None;
        self.fragment.nodes.push(Packed { code, span: 1 });
    }

    fn open(&mut self, code: Code) {
        self.open.push(self.fragment.len());
        self.push(code);
    }

    fn drawn(&mut self) -> &mut Drawn {
        self.fragment.drawn.get_or_insert_default()
    }

    /// Opens a transform: what follows, up to the matching [`close`](Self::close), is placed
    /// by it.
    pub fn open_transform(&mut self, transform: Affine3) {
        let i = self.fragment.transforms.len() as u32;
        self.fragment.transforms.push(transform);
        self.open(Code::Transform(i));
    }

    /// Opens a transform whose value `visit` keeps up to date, and tells its number.
    pub fn open_live(&mut self) -> u32 {
        let live = self.fragment.n_live;
        self.fragment.n_live += 1;
        self.open(Code::Live(live));
        live
    }

    /// Closes what was opened last.
    ///
    /// # Panics
    /// When nothing is open.
    pub fn close(&mut self) {
        assert!(self.open.len() > 1, "a node is closed that was never opened");
        self.run = None;
        let index = self.open.pop().expect("the top group is open") as usize;
        self.fragment.nodes[index].span = (self.fragment.nodes.len() - index) as u32;
    }

    /// Adds a mesh.
    pub fn mesh(&mut self, mesh: SharedMesh, material: Arc<Material>) {
        let drawn = self.drawn();
        drawn.meshes.push((mesh, material));
        let i = drawn.meshes.len() as u32 - 1;
        self.push(Code::Mesh(i));
    }

    /// Adds a mesh repeated at each of `transforms`; costs one pass over them.
    pub fn instances(
        &mut self,
        mesh: SharedMesh,
        material: Arc<Material>,
        transforms: Shared<Vec<Affine3>>,
    ) {
        let bound = mesh.bound().repeated(&transforms);
        let drawn = self.drawn();
        drawn.instances.push(Instanced { mesh, material, transforms, bound });
        let i = drawn.instances.len() as u32 - 1;
        self.push(Code::Instances(i));
    }

    /// Adds lines.
    pub fn lines(&mut self, lines: Shared<Vec<Polyline>>) {
        let drawn = self.drawn();
        drawn.lines.push(lines);
        let i = drawn.lines.len() as u32 - 1;
        self.push(Code::Lines(i));
    }

    /// Adds a deferred child and tells its link. Children of one kind that follow each other
    /// under one parent, without a foreseen bound, become one run.
    pub fn deferred(&mut self, kind: Kind, foreseen: Option<Bound>) -> u32 {
        let link = self.fragment.n_links;
        self.fragment.n_links += 1;
        if let (Some(i), None) = (self.run, foreseen) {
            let run = &mut self.fragment.runs[i as usize];
            if run.kind == kind {
                run.count += 1;
                return link;
            }
        }
        let i = self.fragment.runs.len() as u32;
        let foreseen = foreseen.map(Box::new);
        let can_grow = foreseen.is_none();
        self.fragment.runs.push(StoredRun { first: link, count: 1, kind, foreseen });
        self.push(Code::Deferred(i));
        self.run = can_grow.then_some(i);
        link
    }

    /// The finished fragment; whatever is still open is closed.
    pub fn finish(mut self) -> Fragment {
        while self.open.len() > 1 {
            self.close();
        }
        self.fragment.nodes[0].span = self.fragment.len();
        self.fragment
    }
}

impl Default for FragmentBuilder {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Named;
    use sapwood_geom::Digest;

    struct Stone;
    impl Named for Stone {
        const NAME: &'static str = "stone";
    }

    #[test]
    fn spans_lead_from_sibling_to_sibling() {
        let mut builder = FragmentBuilder::new();
        builder.open_transform(Affine3::IDENTITY);
        assert_eq!(builder.deferred(Kind::of::<Stone>(), None), 0);
        assert_eq!(builder.deferred(Kind::of::<Stone>(), None), 1);
        builder.close();
        assert_eq!(builder.deferred(Kind::of::<Stone>(), None), 2);
        let fragment = builder.finish();
        assert_eq!(fragment.len(), 4);
        assert_eq!(fragment.children(0).collect::<Vec<_>>(), [1, 3]);
        assert_eq!(fragment.children(1).collect::<Vec<_>>(), [2]);
        assert!(matches!(fragment.node(2), RenderNode::Deferred(run) if run.count == 2));
        assert!(matches!(fragment.node(3), RenderNode::Deferred(run) if run.first == 2));
        let firsts = [0, 1, 2, 3].map(|link| fragment.run_of(link).map(|run| run.first));
        assert_eq!(firsts, [Some(0), Some(0), Some(2), None]);
    }

    #[test]
    fn structure_counts_in_the_digest() {
        let digest = |close_early: bool| {
            let mut builder = FragmentBuilder::new();
            builder.open_transform(Affine3::IDENTITY);
            if close_early {
                builder.close();
            }
            builder.lines(Shared::new(vec![Polyline::default()]));
            Digest::of(&builder.finish())
        };
        assert_ne!(digest(true), digest(false));
    }

    #[test]
    #[should_panic(expected = "never opened")]
    fn closing_too_much_is_a_programmer_error() {
        FragmentBuilder::new().close();
    }
}
