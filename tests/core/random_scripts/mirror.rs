//! A second, plain book of what is in the scene, from which everything expected is computed.

use sapwood::geom::StreamPath;
use sapwood::geom::glam::Vec3;
use sapwood::graph::Eye;
use sapwood::scene::{
    ChildPath, EditError, Held, MaterialSlot, NodeId, Scene, Slot, Style, StyleSlot, Time, ViewId,
    Viewer, Viewpoint,
};

use super::kinds::*;
use super::what::{What, material};
use super::wires::{self, Drive};
use crate::core::kinds::{Placed, Size};

#[derive(Clone)]
pub(super) struct Node {
    pub(super) id: NodeId,
    pub(super) what: What,
    /// Children in order, each with its key.
    pub(super) children: Vec<(usize, u64)>,
    pub(super) next_key: u64,
    /// The top of the value sub-graph that the node asks.
    pub(super) asks: Option<usize>,
    pub(super) is_there: bool,
}

/// A field connection.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wire {
    pub(super) source: usize,
    pub(super) target: usize,
    pub(super) drive: Drive,
}

/// A view as the script set it.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    pub(super) id: ViewId,
    pub(super) root: usize,
    pub(super) variant: Variant,
    pub(super) values: RootValues,
    pub(super) time: f64,
    pub(super) eye: Option<Eye>,
}

/// The held slots above a view's root.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RootValues {
    pub(super) size: Option<RootValue<f32>>,
    pub(super) tag: Option<RootValue<u32>>,
    pub(super) path: Option<RootValue<StreamPath>>,
    pub(super) style: Option<RootValue<Style>>,
    pub(super) look: Option<RootValue<u8>>,
    pub(super) viewpoint: Option<RootValue<Option<Vec3>>>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct RootValue<T> {
    pub(super) value: T,
    pub(super) is_forced: bool,
}

impl View {
    /// Gives a view of any scene this view's values.
    pub(super) fn set_up(&self, scene: &mut Scene, id: ViewId) {
        for slot in 0..N_ROOT_SLOTS {
            self.set_root(scene, id, slot);
        }
        scene.set_moving::<Time>(id, self.time).unwrap();
        scene.set_moving::<Viewer>(id, self.eye).unwrap();
    }

    /// Sets, forces or clears one slot of a view of any scene.
    pub(super) fn set_root(&self, scene: &mut Scene, id: ViewId, slot: usize) {
        fn set<S: Slot<Rate = Held>>(
            scene: &mut Scene,
            id: ViewId,
            root: Option<RootValue<S::Value>>,
        ) {
            let outcome = match root {
                None => scene.clear_held::<S>(id),
                Some(RootValue { value, is_forced: false }) => scene.set_held::<S>(id, value),
                Some(RootValue { value, is_forced: true }) => scene.force_held::<S>(id, value),
            };
            outcome.unwrap();
        }
        let values = &self.values;
        match slot {
            0 => set::<Size>(scene, id, values.size),
            1 => set::<Tag>(scene, id, values.tag),
            2 => set::<ChildPath>(scene, id, values.path),
            3 => set::<StyleSlot>(scene, id, values.style),
            4 => {
                let look = values.look.map(|look| RootValue {
                    value: material(look.value),
                    is_forced: look.is_forced,
                });
                set::<MaterialSlot>(scene, id, look);
            }
            _ => set::<Viewpoint>(scene, id, values.viewpoint),
        }
    }
}

/// How many slots [`RootValues`] has.
pub(super) const N_ROOT_SLOTS: usize = 6;

#[derive(Clone, Default)]
pub(super) struct Mirror {
    pub(super) nodes: Vec<Node>,
    /// In the order in which they were made.
    pub(super) wires: Vec<Wire>,
}

impl Mirror {
    pub(super) fn add(&mut self, scene: &mut Scene, what: What) -> usize {
        let id = what.place(scene);
        self.add_placed(id, what)
    }

    /// Notes a node that is in the scene already.
    pub(super) fn add_placed(&mut self, id: NodeId, what: What) -> usize {
        let (children, next_key, asks) = (Vec::new(), 0, None);
        self.nodes.push(Node { id, what, children, next_key, asks, is_there: true });
        self.nodes.len() - 1
    }

    /// Numbers of the nodes that are there.
    pub(super) fn all(&self) -> Vec<usize> {
        (0..self.nodes.len()).filter(|i| self.nodes[*i].is_there).collect()
    }

    pub(super) fn id(&self, node: usize) -> NodeId {
        self.nodes[node].id
    }

    /// What a node holds: its children, then its value sub-graph.
    fn held_by(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        let node = &self.nodes[node];
        node.children.iter().map(|(child, _)| *child).chain(node.asks)
    }

    pub(super) fn reaches(&self, top: usize, bottom: usize) -> bool {
        let mut seen = vec![false; self.nodes.len()];
        let mut stack = vec![top];
        while let Some(at) = stack.pop() {
            if at == bottom {
                return true;
            }
            if !std::mem::replace(&mut seen[at], true) {
                stack.extend(self.held_by(at));
            }
        }
        false
    }

    /// Whether `source` drives `target`, by whatever detour, or is the same.
    pub(super) fn drives(&self, source: usize, target: usize) -> bool {
        let mut seen = vec![false; self.nodes.len()];
        let mut stack = vec![source];
        while let Some(at) = stack.pop() {
            if at == target {
                return true;
            }
            if !std::mem::replace(&mut seen[at], true) {
                let driven = self.wires.iter().filter(|wire| wire.source == at);
                stack.extend(driven.map(|wire| wire.target));
            }
        }
        false
    }

    /// Every node as its inputs make it; nothing where they cannot.
    pub(super) fn effective(&self) -> Vec<Option<What>> {
        let mut found: Vec<Option<Option<What>>> = vec![None; self.nodes.len()];
        (0..self.nodes.len()).map(|node| self.effective_node(node, &mut found)).collect()
    }

    fn effective_node(&self, node: usize, found: &mut [Option<Option<What>>]) -> Option<What> {
        if let Some(known) = found[node] {
            return known;
        }
        let mut what = Some(self.nodes[node].what);
        for wire in self.wires.iter().filter(|wire| wire.target == node) {
            let source = self.effective_node(wire.source, found);
            let number = source.and_then(|source| wire.drive.of(wires::number(&source)?));
            what = what.zip(number).map(|(mut what, number)| {
                wires::drive(&mut what, wire.drive.input, number);
                what
            });
        }
        found[node] = Some(what);
        what
    }

    /// Occurrences below any of the roots, weighed.
    pub(super) fn most_occurrences(&self, roots: &[usize]) -> u64 {
        let mut known: Vec<u64> = vec![0; self.nodes.len()];
        for at in self.below(roots) {
            let node = &self.nodes[at];
            let below = node.children.iter().map(|(child, _)| known[*child]);
            known[at] = below.fold(node.what.weight(), u64::saturating_add);
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
                stack.extend(self.held_by(at).map(|below| (below, false)));
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
        if row.children.len() >= row.what.room() {
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
            other.asks = other.asks.filter(|top| *top != node);
        }
        let mut n_holders = vec![0; self.nodes.len()];
        for held in self.all().into_iter().flat_map(|node| self.held_by(node)) {
            n_holders[held] += 1;
        }
        let mut stack = vec![node];
        while let Some(at) = stack.pop() {
            let held: Vec<usize> = self.held_by(at).collect();
            self.nodes[at].is_there = false;
            self.nodes[at].children.clear();
            self.nodes[at].asks = None;
            self.wires.retain(|wire| wire.source != at && wire.target != at);
            for held in held {
                n_holders[held] -= 1;
                if n_holders[held] == 0 {
                    stack.push(held);
                }
            }
        }
    }

    /// Everything that what is below a node may depend on.
    fn needed(&self, root: usize) -> Vec<usize> {
        let mut seen = vec![false; self.nodes.len()];
        let mut stack = vec![root];
        while let Some(at) = stack.pop() {
            if !std::mem::replace(&mut seen[at], true) {
                stack.extend(self.held_by(at));
                let inputs = self.wires.iter().filter(|wire| wire.target == at);
                stack.extend(inputs.map(|wire| wire.source));
            }
        }
        (0..seen.len()).filter(|node| seen[*node]).collect()
    }

    /// A new scene with everything below a view's root, and the same view of it: nothing is
    /// shared with the scene of the script but the keys of children.
    pub(super) fn rebuilt(&self, view: &View) -> (Scene, ViewId) {
        let mut scene = Scene::new();
        let mut ids: Vec<Option<NodeId>> = vec![None; self.nodes.len()];
        let stand_in = scene.add(Placed);
        let needed = self.needed(view.root);
        for at in needed.iter().copied() {
            ids[at] = Some(self.nodes[at].what.place(&mut scene));
        }
        let id_of = |node: usize| ids[node].unwrap();
        for at in needed {
            let (node, id) = (&self.nodes[at], id_of(at));
            // Keys are given out in the order of appending, those of children that went too.
            let mut order: Vec<usize> = Vec::new();
            for key in 0..node.next_key {
                let Some(index) = node.children.iter().position(|(_, k)| *k == key) else {
                    if order.is_empty() || node.what.room() > 1 {
                        scene.append(id, stand_in).unwrap();
                        scene.detach(id, stand_in).unwrap();
                    }
                    continue;
                };
                let before = order.iter().filter(|earlier| **earlier < index).count();
                scene.insert(id, before, id_of(node.children[index].0)).unwrap();
                order.push(index);
            }
            scene.set_value_graph(id, node.asks.map(id_of)).unwrap();
        }
        for Wire { source, target, drive } in self.wires.iter().copied() {
            if let (Some(from), Some(to)) = (ids[source], ids[target]) {
                let [source, target] = [source, target].map(|node| &self.nodes[node].what);
                wires::connect(&mut scene, (from, source), (to, target), drive).unwrap();
            }
        }
        let id = scene.open_view(id_of(view.root), &view.variant.rules()).unwrap();
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
