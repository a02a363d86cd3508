//! Components and the handles that users hold on them.

use std::fmt;
use std::hash::{Hash, Hasher};
use std::marker::PhantomData;

use sapwood_geom::Content;
use sapwood_graph::Named;

use super::Question;

slotmap::new_key_type! {
    /// A node of the semantic graph. Stays unique after the node is removed.
    pub struct NodeId;
}

/// Plain data that a rule can compile.
///
/// A component knows no rule. What tells two components of one kind apart is their
/// [`Content`], which [`content!`](sapwood_geom::content) writes for a struct.
pub trait Component: Named + Content + Send + Sync {
    /// How many children a component of this kind can hold when it is placed in a scene.
    const CHILDREN: Children = Children::None;

    /// Answers a question for the value of a slot where the component stands in a value
    /// sub-graph: offers what it has and says where the question goes on. It goes on to all
    /// children unless told otherwise. What it would ask a sub-graph of its own is not known here.
    fn answer(&self, question: &mut Question) {
        question.children();
    }
}

/// How many children a component can hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Children {
    /// None: a leaf of the semantic graph.
    None,
    /// At most one: an attribute.
    One,
    /// Any number: a group.
    Many,
}

/// A typed hold on a component that was placed in a scene.
pub struct Handle<C> {
    id: NodeId,
    kind: PhantomData<fn() -> C>,
}

impl<C> Handle<C> {
    pub(crate) fn new(id: NodeId) -> Self {
        Self { id, kind: PhantomData }
    }

    /// The node behind the handle.
    pub fn id(self) -> NodeId {
        self.id
    }
}

impl<C> Clone for Handle<C> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<C> Copy for Handle<C> {}

impl<C> PartialEq for Handle<C> {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

impl<C> Eq for Handle<C> {}

impl<C> Hash for Handle<C> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.id.hash(state);
    }
}

impl<C> fmt::Debug for Handle<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.id.fmt(f)
    }
}

impl<C> From<Handle<C>> for NodeId {
    fn from(handle: Handle<C>) -> Self {
        handle.id
    }
}
