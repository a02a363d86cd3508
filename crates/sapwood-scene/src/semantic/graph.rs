//! The semantic graph itself: nodes, the edges between them, and every edit.

use std::any::Any;

use sapwood_graph::Kind;
use slotmap::SlotMap;

use super::edges::{Edges, Ends, NO_EDGE};
use super::fields::Fields;
use super::values::ValueGraphs;
use super::{ComponentRow, EditError, NodeId, Storage};
use crate::{Children, Component};

/// A component's place in the graph.
#[derive(Debug)]
pub(crate) struct Node {
    pub(crate) component: ComponentRow,
    pub(crate) ends: Ends,
    /// The key that the next child gets.
    next_key: u64,
    /// When the component or the list of its children was edited last.
    pub(crate) edited: u64,
    /// When something at or below the node was edited; set by marks, which stop at a node that
    /// was marked since the last pull, for then all above it is marked too.
    pub(crate) edited_below: u64,
}

/// The graph. Its revision grows with every edit.
pub(crate) struct Graph {
    pub(super) nodes: SlotMap<NodeId, Node>,
    pub(super) edges: Edges,
    pub(crate) storage: Storage,
    pub(crate) values: ValueGraphs,
    pub(crate) fields: Fields,
    pub(crate) revision: u64,
    /// The revision at which somebody last brought sites up to date; no site knows of a later
    /// one, so a mark younger than this stands for itself.
    pub(crate) pulled_at: u64,
    /// Nodes edited inside a bulk scope, marked when it ends.
    pub(super) bulk: Option<Vec<NodeId>>,
    #[cfg(feature = "planted-faults")]
    pub(crate) drops_marks: bool,
    #[cfg(feature = "planted-faults")]
    pub(crate) keeps_driven: bool,
    #[cfg(feature = "planted-faults")]
    pub(crate) skips_askers: bool,
}

impl Graph {
    pub(crate) fn new() -> Self {
        Self {
            nodes: SlotMap::with_key(),
            edges: Edges::new(),
            storage: Storage::new(),
            values: ValueGraphs::new(),
            fields: Fields::new(),
            revision: 1,
            pulled_at: 0,
            bulk: None,
            #[cfg(feature = "planted-faults")]
            drops_marks: false,
            #[cfg(feature = "planted-faults")]
            keeps_driven: false,
            #[cfg(feature = "planted-faults")]
            skips_askers: false,
        }
    }

    pub(crate) fn node(&self, id: NodeId) -> Result<&Node, EditError> {
        self.nodes.get(id).ok_or(EditError::Gone { node: id })
    }

    pub(crate) fn kind(&self, id: NodeId) -> Result<Kind, EditError> {
        Ok(self.storage.kind(self.node(id)?.component))
    }

    pub(crate) fn nodes(&self) -> impl Iterator<Item = NodeId> + '_ {
        self.nodes.keys()
    }

    pub(crate) fn len(&self) -> usize {
        self.nodes.len()
    }

    pub(crate) fn component(&self, id: NodeId) -> Result<&(dyn Any + Send + Sync), EditError> {
        Ok(self.storage.get(self.node(id)?.component))
    }

    /// The children of a node in order, each with its key.
    pub(crate) fn children(&self, id: NodeId) -> impl Iterator<Item = (NodeId, u64)> + '_ {
        let ends = self.nodes.get(id).map_or(Ends::NONE, |node| node.ends);
        self.edges.children(ends).map(|edge| {
            let edge = self.edges.get(edge);
            (edge.child, edge.key)
        })
    }

    /// The parents of a node; one that holds it twice is told twice.
    pub(crate) fn parents(&self, id: NodeId) -> impl Iterator<Item = NodeId> + '_ {
        let ends = self.nodes.get(id).map_or(Ends::NONE, |node| node.ends);
        self.edges.parents(ends).map(|edge| self.edges.get(edge).parent)
    }

    pub(crate) fn add<C: Component>(&mut self, component: C) -> NodeId {
        let component = self.storage.insert(component);
        let revision = self.next_revision();
        self.nodes.insert(Node {
            component,
            ends: Ends::NONE,
            next_key: 0,
            edited: revision,
            edited_below: revision,
        })
    }

    /// Changes a component; nothing happens to it if it is of another kind.
    pub(crate) fn edit<C: Component, R>(
        &mut self,
        id: NodeId,
        change: impl FnOnce(&mut C) -> R,
    ) -> Result<R, EditError> {
        let component = self.node(id)?.component;
        if self.storage.get_mut::<C>(component).is_none() {
            return Err(EditError::Gone { node: id });
        }
        // Marked first: a change that panics half-way is seen all the same.
        self.touch(id);
        let component = self.storage.get_mut::<C>(component).ok_or(EditError::Gone { node: id })?;
        Ok(change(component))
    }

    /// Tells why a node can hold no further child, if it cannot.
    pub(crate) fn room_below(&self, parent: NodeId) -> Result<(), EditError> {
        let at = self.node(parent)?;
        let fits = match self.storage.children(at.component) {
            Children::None => false,
            Children::One => at.ends.n_children == 0,
            Children::Many => true,
        };
        let kind = self.storage.kind(at.component).name();
        if fits { Ok(()) } else { Err(EditError::Full { parent, kind }) }
    }

    /// Makes `child` a child of `parent` at `index`, or behind all others.
    pub(crate) fn insert(
        &mut self,
        parent: NodeId,
        index: Option<usize>,
        child: NodeId,
    ) -> Result<(), EditError> {
        self.node(child)?;
        let at = self.node(parent)?;
        let n = at.ends.n_children as usize;
        self.room_below(parent)?;
        let before = match index {
            None => NO_EDGE,
            Some(index) if index == n => NO_EDGE,
            Some(index) => self.edge_at(parent, index)?,
        };
        self.check_acyclic(parent, child)?;
        let key = self.nodes[parent].next_key;
        self.nodes[parent].next_key += 1;
        self.link(parent, before, child, key);
        self.touch(parent);
        Ok(())
    }

    fn link(&mut self, parent: NodeId, before: u32, child: NodeId, key: u64) {
        let mut ends = self.nodes[parent].ends;
        let mut ring = self.nodes[child].ends.ring;
        self.edges.link((parent, &mut ends), before, (child, &mut ring), key);
        self.nodes[parent].ends = ends;
        self.nodes[child].ends.ring = ring;
    }

    fn unlink(&mut self, edge: u32) {
        let (parent, child) = (self.edges.get(edge).parent, self.edges.get(edge).child);
        let mut ends = self.nodes[parent].ends;
        let mut ring = self.nodes[child].ends.ring;
        self.edges.unlink(edge, &mut ends, &mut ring);
        self.nodes[parent].ends = ends;
        self.nodes[child].ends.ring = ring;
    }

    fn edge_at(&self, parent: NodeId, index: usize) -> Result<u32, EditError> {
        let ends = &self.node(parent)?.ends;
        let len = ends.n_children as usize;
        let out_of_range = EditError::OutOfRange { parent, index, len };
        self.edges.children(*ends).nth(index).ok_or(out_of_range)
    }

    /// The first edge between the two. Searched from both ends in turns, so that it costs the
    /// shorter of the parent's list and the child's ring, unless the edge is there twice.
    fn edge_to(&self, parent: NodeId, child: NodeId) -> Result<u32, EditError> {
        let mut list = self.edges.children(self.node(parent)?.ends);
        let mut ring = self.edges.parents(self.node(child)?.ends);
        let mut in_ring = None;
        while let Some(edge) = list.next() {
            if self.edges.get(edge).child == child {
                return Ok(edge);
            }
            match ring.next() {
                Some(edge) if self.edges.get(edge).parent != parent => {}
                Some(edge) if in_ring.is_none() => in_ring = Some(edge),
                // A second one: only the list tells which is first.
                Some(_) => {
                    let mut rest = list.filter(|edge| self.edges.get(*edge).child == child);
                    return rest.next().ok_or(EditError::NotAChild { parent, child });
                }
                None => break,
            }
        }
        in_ring.ok_or(EditError::NotAChild { parent, child })
    }

    /// Takes the first edge between the two away; the child stays in the scene.
    pub(crate) fn detach(&mut self, parent: NodeId, child: NodeId) -> Result<(), EditError> {
        self.node(child)?;
        let edge = self.edge_to(parent, child)?;
        self.unlink(edge);
        self.touch(parent);
        Ok(())
    }

    /// Moves the child at `from` to the place `to` among its siblings; it keeps its key.
    pub(crate) fn reorder(
        &mut self,
        parent: NodeId,
        from: usize,
        to: usize,
    ) -> Result<(), EditError> {
        let edge = self.edge_at(parent, from)?;
        self.edge_at(parent, to)?;
        let (child, key) = (self.edges.get(edge).child, self.edges.get(edge).key);
        self.unlink(edge);
        let before = self.edge_at(parent, to).unwrap_or(NO_EDGE);
        self.link(parent, before, child, key);
        self.touch(parent);
        Ok(())
    }

    /// Takes a child from one parent and puts it behind the children of another.
    pub(crate) fn reparent(
        &mut self,
        child: NodeId,
        from: NodeId,
        to: NodeId,
    ) -> Result<(), EditError> {
        self.node(child)?;
        let edge = self.edge_to(from, child)?;
        if from == to {
            return self.reorder_to_end(from, edge);
        }
        self.insert(to, None, child)?;
        self.unlink(edge);
        self.touch(from);
        Ok(())
    }

    fn reorder_to_end(&mut self, parent: NodeId, edge: u32) -> Result<(), EditError> {
        let (child, key) = (self.edges.get(edge).child, self.edges.get(edge).key);
        self.unlink(edge);
        self.link(parent, NO_EDGE, child, key);
        self.touch(parent);
        Ok(())
    }

    /// Removes a node and everything below it that no other parent holds; tells what went.
    pub(crate) fn remove(&mut self, id: NodeId) -> Result<Vec<NodeId>, EditError> {
        let ends = self.node(id)?.ends;
        let to_it: Vec<u32> = self.edges.parents(ends).collect();
        for edge in to_it {
            let parent = self.edges.get(edge).parent;
            self.unlink(edge);
            self.touch(parent);
        }
        for asker in self.values.askers(id).to_vec() {
            self.stop_asking(asker);
            self.touch(asker);
        }
        let mut removed = Vec::new();
        let mut stack = vec![id];
        while let Some(id) = stack.pop() {
            self.disconnect_all(id);
            if let Some(top) = self.stop_asking(id).filter(|top| self.is_held_by_none(*top)) {
                stack.push(top);
            }
            while let Some(edge) = Some(self.nodes[id].ends.first).filter(|edge| *edge != NO_EDGE) {
                let child = self.edges.get(edge).child;
                self.unlink(edge);
                if self.is_held_by_none(child) {
                    stack.push(child);
                }
            }
            if let Some(node) = self.nodes.remove(id) {
                self.storage.remove(node.component);
            }
            removed.push(id);
        }
        self.next_revision();
        Ok(removed)
    }

    /// Whether a node is no child and no value sub-graph of any other.
    fn is_held_by_none(&self, id: NodeId) -> bool {
        self.nodes[id].ends.ring == NO_EDGE && self.values.askers(id).is_empty()
    }

    /// The first fault found in the links between nodes and edges, for tests and debug builds.
    pub(crate) fn fault(&self) -> Option<String> {
        let (mut n_listed, mut n_ringed) = (0, 0);
        for (id, node) in &self.nodes {
            let mut n_children = 0;
            for edge in self.edges.children(node.ends) {
                if self.edges.get(edge).parent != id {
                    return Some(format!("{id:?} lists a foreign edge"));
                }
                n_children += 1;
            }
            if n_children != node.ends.n_children {
                return Some(format!("{id:?} counts {} children", node.ends.n_children));
            }
            n_listed += n_children as usize;
            for edge in self.edges.parents(node.ends) {
                let edge = self.edges.get(edge);
                if edge.child != id || !self.nodes.contains_key(edge.parent) {
                    return Some(format!("{id:?} has a foreign edge in its ring"));
                }
                n_ringed += 1;
            }
            if node.edited_below < node.edited && node.edited_below <= self.pulled_at {
                return Some(format!("{id:?} was edited and not marked"));
            }
        }
        let n = self.edges.len();
        (n_listed != n || n_ringed != n)
            .then(|| format!("of {n} edges {n_listed} are listed and {n_ringed} lie in rings"))
    }
}
