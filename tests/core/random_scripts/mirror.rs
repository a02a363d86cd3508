//! A second, plain book of what is in the scene, from which everything expected is computed.

use sapwood::geom::SharedMesh;
use sapwood::geom::glam::Affine3;
use sapwood::scene::{
    Attribute, ChildPath, EditError, Group, NodeId, Scene, Switch, Transform, ViewId,
};

use super::kinds::*;
use crate::core::kinds::{Placed, Plain, Size, Sized};

/// What a node is, with its parameters.
#[derive(Clone, Copy, Debug)]
pub(super) enum What {
    Group,
    Transform(Affine3),
    Attribute { size: Option<f32>, tag: Option<u32>, seed: Option<u64> },
    Switch(bool),
    Porch(u32),
    Spinner(f32),
    Plain(f32),
    Placed,
    Sized,
    Tagged,
    Keyed,
    Gridded,
    Chooser,
    Nest(u32),
    Fragile(u32),
}

/// How many children a node may have.
pub(super) fn room(what: &What) -> usize {
    match what {
        What::Group | What::Porch(_) | What::Spinner(_) => usize::MAX,
        What::Transform(_) | What::Attribute { .. } | What::Switch(_) => 1,
        _ => 0,
    }
}

/// Components and draw rows that one occurrence stands for, its children left out.
fn weight(what: &What) -> u64 {
    match what {
        What::Nest(depth) => 6 + 5 * u64::from(*depth),
        What::Porch(_) => 3,
        _ => 1,
    }
}

#[derive(Clone)]
pub(super) struct Node {
    pub(super) id: NodeId,
    pub(super) what: What,
    /// Children in order, each with its key.
    pub(super) children: Vec<(usize, u64)>,
    pub(super) next_key: u64,
    pub(super) is_there: bool,
}

/// A view as the script set it.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    pub(super) id: ViewId,
    pub(super) root: usize,
    pub(super) variant: Variant,
    pub(super) size: f32,
    pub(super) tag: u32,
    pub(super) seed: u64,
    pub(super) time: f32,
}

impl View {
    /// Gives a view of any scene this view's values.
    pub(super) fn set_up(&self, scene: &mut Scene, id: ViewId) {
        scene.set_held::<Size>(id, self.size).unwrap();
        scene.set_held::<Tag>(id, self.tag).unwrap();
        scene.set_held::<ChildPath>(id, sapwood::geom::StreamPath::new(self.seed)).unwrap();
        scene.set_moving::<Time>(id, self.time).unwrap();
    }
}

#[derive(Clone, Default)]
pub(super) struct Mirror {
    pub(super) nodes: Vec<Node>,
}

impl Mirror {
    pub(super) fn add(&mut self, scene: &mut Scene, what: What) -> usize {
        let id = place(scene, &what);
        let (children, next_key) = (Vec::new(), 0);
        self.nodes.push(Node { id, what, children, next_key, is_there: true });
        self.nodes.len() - 1
    }

    /// Numbers of the nodes that are there.
    pub(super) fn all(&self) -> Vec<usize> {
        (0..self.nodes.len()).filter(|i| self.nodes[*i].is_there).collect()
    }

    pub(super) fn id(&self, node: usize) -> NodeId {
        self.nodes[node].id
    }

    pub(super) fn reaches(&self, top: usize, bottom: usize) -> bool {
        let mut seen = vec![false; self.nodes.len()];
        let mut stack = vec![top];
        while let Some(at) = stack.pop() {
            if at == bottom {
                return true;
            }
            if !std::mem::replace(&mut seen[at], true) {
                stack.extend(self.nodes[at].children.iter().map(|(child, _)| *child));
            }
        }
        false
    }

    /// Occurrences below any of the roots, weighed.
    pub(super) fn most_occurrences(&self, roots: &[usize]) -> u64 {
        let mut known: Vec<u64> = vec![0; self.nodes.len()];
        for at in self.below(roots) {
            let node = &self.nodes[at];
            let below = node.children.iter().map(|(child, _)| known[*child]);
            known[at] = below.fold(weight(&node.what), u64::saturating_add);
        }
        roots.iter().map(|root| known[*root]).max().unwrap_or(0)
    }

    /// Everything that can be reached, children before their parents.
    fn below(&self, roots: &[usize]) -> Vec<usize> {
        let mut order = Vec::new();
        let mut seen = vec![false; self.nodes.len()];
        let mut stack: Vec<(usize, bool)> = roots.iter().map(|root| (*root, false)).collect();
        while let Some((at, is_done)) = stack.pop() {
            if is_done {
                order.push(at);
            } else if !std::mem::replace(&mut seen[at], true) {
                stack.push((at, true));
                stack.extend(self.nodes[at].children.iter().map(|(child, _)| (*child, false)));
            }
        }
        order
    }

    /// Notes a new edge as the scene makes it.
    pub(super) fn link(&mut self, parent: usize, index: usize, child: usize) {
        let parent = &mut self.nodes[parent];
        parent.children.insert(index, (child, parent.next_key));
        parent.next_key += 1;
    }

    /// Takes back what [`link`](Self::link) did.
    pub(super) fn unlink(&mut self, parent: usize, index: usize) {
        self.nodes[parent].children.remove(index);
        self.nodes[parent].next_key -= 1;
    }

    /// Why the scene will refuse the edge; nothing where it will not.
    pub(super) fn refusal(&self, parent: usize, index: usize, child: usize) -> Option<Refusal> {
        let row = &self.nodes[parent];
        if row.children.len() >= room(&row.what) {
            Some(Refusal::Full)
        } else if index > row.children.len() {
            Some(Refusal::OutOfRange)
        } else if self.reaches(child, parent) {
            Some(Refusal::Cycle)
        } else {
            None
        }
    }

    /// Forgets what goes when a node is removed, as the scene does it.
    pub(super) fn remove(&mut self, node: usize) {
        for other in &mut self.nodes {
            other.children.retain(|(child, _)| *child != node);
        }
        let mut n_parents = vec![0; self.nodes.len()];
        for (child, _) in self.nodes.iter().flat_map(|node| &node.children) {
            n_parents[*child] += 1;
        }
        let mut stack = vec![node];
        while let Some(at) = stack.pop() {
            self.nodes[at].is_there = false;
            for (child, _) in std::mem::take(&mut self.nodes[at].children) {
                n_parents[child] -= 1;
                if n_parents[child] == 0 {
                    stack.push(child);
                }
            }
        }
    }

    /// A new scene with everything below a view's root, and the same view of it: nothing is
    /// shared with the scene of the script but the keys of children.
    pub(super) fn rebuilt(&self, view: &View) -> (Scene, ViewId) {
        let mut scene = Scene::new();
        let mut ids: Vec<Option<NodeId>> = vec![None; self.nodes.len()];
        let stand_in = scene.add(Placed);
        for at in self.below(&[view.root]) {
            let node = &self.nodes[at];
            let id = place(&mut scene, &node.what);
            // Keys are given out in the order of appending, those of children that went too.
            let mut order: Vec<usize> = Vec::new();
            for key in 0..node.next_key {
                let Some(index) = node.children.iter().position(|(_, k)| *k == key) else {
                    if order.is_empty() || room(&node.what) > 1 {
                        scene.append(id, stand_in).unwrap();
                        scene.detach(id, stand_in).unwrap();
                    }
                    continue;
                };
                let before = order.iter().filter(|earlier| **earlier < index).count();
                let child = ids[node.children[index].0].unwrap();
                scene.insert(id, before, child).unwrap();
                order.push(index);
            }
            ids[at] = Some(id);
        }
        let id = scene.open_view(ids[view.root].unwrap(), &view.variant.rules()).unwrap();
        view.set_up(&mut scene, id);
        (scene, id)
    }
}

/// Why an edge is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Refusal {
    Full,
    OutOfRange,
    Cycle,
    NotAChild,
}

impl Refusal {
    pub(super) fn of(result: &Result<(), EditError>) -> Option<Self> {
        match result {
            Ok(()) => None,
            Err(EditError::Full { .. }) => Some(Self::Full),
            Err(EditError::OutOfRange { .. }) => Some(Self::OutOfRange),
            Err(EditError::Cycle { .. }) => Some(Self::Cycle),
            Err(EditError::NotAChild { .. }) => Some(Self::NotAChild),
            Err(other) => panic!("{other}"),
        }
    }
}

pub(super) fn attribute(size: Option<f32>, tag: Option<u32>, seed: Option<u64>) -> Attribute {
    let mut attribute = Attribute::new();
    if let Some(size) = size {
        attribute.set::<Size>(size);
    }
    if let Some(tag) = tag {
        attribute.set::<Tag>(tag);
    }
    if let Some(seed) = seed {
        attribute.set::<ChildPath>(sapwood::geom::StreamPath::new(seed));
    }
    attribute
}

fn place(scene: &mut Scene, what: &What) -> NodeId {
    match *what {
        What::Group => scene.add(Group).id(),
        What::Transform(transform) => scene.add(Transform(transform)).id(),
        What::Attribute { size, tag, seed } => scene.add(attribute(size, tag, seed)).id(),
        What::Switch(on) => scene.add(Switch { on }).id(),
        What::Porch(tag) => scene.add(Porch { tag }).id(),
        What::Spinner(speed) => scene.add(Spinner { speed }).id(),
        What::Plain(size) => scene.add(Plain { size }).id(),
        What::Placed => scene.add(Placed).id(),
        What::Sized => scene.add(Sized).id(),
        What::Tagged => scene.add(Tagged {}).id(),
        What::Keyed => scene.add(Keyed {}).id(),
        What::Gridded => scene.add(Gridded {}).id(),
        What::Chooser => scene.add(Chooser {}).id(),
        What::Nest(depth) => scene.add(Nest { depth }).id(),
        What::Fragile(value) => scene.add(Fragile { value }).id(),
    }
}

/// The edge length that tells the tests' triangles apart.
pub(super) fn size_of(mesh: &SharedMesh) -> f32 {
    mesh.positions[1].x
}
