//! Edits of the semantic graph. A refused edit changes nothing.

use super::Scene;
use crate::{Attribute, Component, EditError, Handle, Held, NodeId, Slot};

/// Edits. A refused edit changes nothing.
impl Scene {
    /// Places a component in the scene, below nothing yet.
    pub fn add<C: Component>(&mut self, component: C) -> Handle<C> {
        Handle::new(self.graph.add(component))
    }

    /// Places a component behind the children of `parent`.
    ///
    /// # Errors
    /// When the parent is gone or can hold no more.
    pub fn add_to<C: Component>(
        &mut self,
        parent: impl Into<NodeId>,
        component: C,
    ) -> Result<Handle<C>, EditError> {
        let parent = parent.into();
        self.graph.room_below(parent)?;
        let handle = self.add(component);
        self.append(parent, handle)?;
        Ok(handle)
    }

    /// Makes `child` the last child of `parent`; a node may have many parents, and may be a
    /// child of one parent several times.
    ///
    /// # Errors
    /// When either is gone, the parent can hold no more, or the edge would close a cycle.
    pub fn append(
        &mut self,
        parent: impl Into<NodeId>,
        child: impl Into<NodeId>,
    ) -> Result<(), EditError> {
        self.graph.insert(parent.into(), None, child.into())
    }

    /// Makes `child` the child of `parent` at place `index`.
    ///
    /// # Errors
    /// As [`append`](Self::append), and when there is no such place.
    pub fn insert(
        &mut self,
        parent: impl Into<NodeId>,
        index: usize,
        child: impl Into<NodeId>,
    ) -> Result<(), EditError> {
        self.graph.insert(parent.into(), Some(index), child.into())
    }

    /// Takes `child` away from `parent`, once; it stays in the scene.
    ///
    /// # Errors
    /// When either is gone, or the one is no child of the other.
    pub fn detach(
        &mut self,
        parent: impl Into<NodeId>,
        child: impl Into<NodeId>,
    ) -> Result<(), EditError> {
        self.graph.detach(parent.into(), child.into())
    }

    /// Moves the child of `parent` at place `from` to place `to`; it keeps its key.
    ///
    /// # Errors
    /// When the parent is gone or has no such places.
    pub fn reorder(
        &mut self,
        parent: impl Into<NodeId>,
        from: usize,
        to: usize,
    ) -> Result<(), EditError> {
        self.graph.reorder(parent.into(), from, to)
    }

    /// Takes `child` away from parent `from` and puts it behind the children of `to`.
    ///
    /// # Errors
    /// When one is gone, `child` is no child of `from`, or it cannot be put below `to`.
    pub fn reparent(
        &mut self,
        child: impl Into<NodeId>,
        from: impl Into<NodeId>,
        to: impl Into<NodeId>,
    ) -> Result<(), EditError> {
        self.graph.reparent(child.into(), from.into(), to.into())
    }

    /// Removes a node and everything below it that nobody else holds; tells what went.
    ///
    /// # Errors
    /// When the node is gone already.
    pub fn remove(&mut self, node: impl Into<NodeId>) -> Result<Vec<NodeId>, EditError> {
        self.graph.remove(node.into())
    }

    /// Changes a component's parameters and tells what `change` returned.
    ///
    /// # Errors
    /// When the component is gone.
    pub fn edit<C: Component, R>(
        &mut self,
        handle: Handle<C>,
        change: impl FnOnce(&mut C) -> R,
    ) -> Result<R, EditError> {
        self.graph.edit(handle.id(), change)
    }

    /// Sets a slot for everything below an attribute.
    ///
    /// # Errors
    /// When the attribute is gone.
    pub fn push<S: Slot<Rate = Held>>(
        &mut self,
        attribute: Handle<Attribute>,
        value: S::Value,
    ) -> Result<(), EditError> {
        self.edit(attribute, |attribute| attribute.set::<S>(value))
    }

    /// Runs many edits as one: they share a revision, and what is above them is marked once.
    /// A traversal inside the scope sees all edits made before it; those behind it get a
    /// revision of their own.
    pub fn bulk<R>(&mut self, edits: impl FnOnce(&mut Self) -> R) -> R {
        /// Ends the scope even when an edit panics.
        struct Scope<'a>(&'a mut Scene, bool);
        impl Drop for Scope<'_> {
            fn drop(&mut self) {
                if self.1 {
                    self.0.graph.end_bulk();
                }
            }
        }
        let is_outermost = self.graph.begin_bulk();
        let scope = Scope(self, is_outermost);
        edits(scope.0)
    }
}

/// What components get from others.
impl Scene {
    /// Makes a node ask the value sub-graph below `top` for the values that it does not hold
    /// itself, or none any more. The sub-graph belongs to the node as its children do.
    ///
    /// A component in a sub-graph answers with what it holds. What it is told by a sub-graph of
    /// its own counts for what it shows, and is not passed on.
    ///
    /// # Errors
    /// When either is gone, or the edge would close a cycle.
    pub fn set_value_graph(
        &mut self,
        node: impl Into<NodeId>,
        top: Option<NodeId>,
    ) -> Result<(), EditError> {
        self.graph.set_value_graph(node.into(), top)
    }

    /// The top of the value sub-graph that a node asks.
    pub fn value_graph(&self, node: impl Into<NodeId>) -> Option<NodeId> {
        self.graph.values.asked_by(node.into())
    }

    /// Lets `source` drive an input of `target`: whoever looks at the target sees it as `drive`
    /// makes it of the fields that its user set. What drove that input before does so no longer.
    ///
    /// Nothing is computed before somebody looks, and nothing twice. A panic of `drive` fails
    /// the target, and what the target drives. Several inputs are driven in the order in which they
    /// were connected first; it is for the caller to give one field one name.
    ///
    /// # Errors
    /// When either is gone, or the target drives the source, by whatever detour.
    pub fn connect<A: Component, B: Component + Clone>(
        &mut self,
        source: Handle<A>,
        target: Handle<B>,
        input: &'static str,
        drive: impl Fn(&A, &mut B) + Send + Sync + 'static,
    ) -> Result<(), EditError> {
        self.graph.connect(source.id(), target.id(), input, drive)
    }

    /// Leaves an input to its user again, and tells whether anything drove it.
    ///
    /// # Errors
    /// When the target is gone.
    pub fn disconnect(
        &mut self,
        target: impl Into<NodeId>,
        input: &str,
    ) -> Result<bool, EditError> {
        self.graph.disconnect(target.into(), input)
    }

    /// What drives a component: sources and the inputs they drive, in the order in which they
    /// were connected.
    pub fn inputs(
        &self,
        target: impl Into<NodeId>,
    ) -> impl Iterator<Item = (NodeId, &'static str)> + '_ {
        self.graph.fields.inputs(target.into())
    }
}
