//! Interests: which children a traversal wants to go into, and the state it pushes on the way.

use sapwood_geom::glam::Affine3;
use sapwood_geom::{Aabb, Bound};

use crate::Kind;

/// What is known of a deferred child before going into it.
#[derive(Clone, Copy, Debug)]
pub struct Approach<'a> {
    /// From the child's frame to the root's.
    pub world: &'a Affine3,
    /// A bound in the child's frame, where one is known.
    pub bound: Option<&'a Bound>,
    /// The child's kind.
    pub kind: Kind,
    /// The link that leads to it.
    pub link: u32,
}

/// What a traversal wants to see. The same interest steers compiling and walking, so nothing is
/// compiled that the walk would pass over.
pub trait Interest {
    /// What is pushed from parents to children.
    type State: Clone;

    /// The state at the root.
    fn start(&self) -> Self::State;

    /// The state with which to go into a child, or nothing to pass over it.
    fn enter(&self, state: &Self::State, child: &Approach<'_>) -> Option<Self::State>;
}

/// The interest in everything there is.
#[derive(Clone, Copy, Debug, Default)]
pub struct Everything;

impl Interest for Everything {
    type State = ();

    fn start(&self) {}

    fn enter(&self, (): &(), _: &Approach<'_>) -> Option<()> {
        Some(())
    }
}

/// The interest in what may lie inside a box, given in the root's frame.
///
/// Children whose bound is unknown are gone into, so that their bound becomes known.
#[derive(Clone, Copy, Debug)]
pub struct Inside(pub Aabb);

impl Interest for Inside {
    type State = ();

    fn start(&self) {}

    fn enter(&self, (): &(), child: &Approach<'_>) -> Option<()> {
        let inside = |bound: &Bound| bound.transformed(child.world).aabb.intersects(&self.0);
        child.bound.is_none_or(inside).then_some(())
    }
}

/// The interest in one place and everything below it, given by the links that lead there.
#[derive(Clone, Debug)]
pub struct Under(pub Vec<u32>);

impl Interest for Under {
    /// How many links of the path are behind us.
    type State = usize;

    fn start(&self) -> usize {
        0
    }

    fn enter(&self, done: &usize, child: &Approach<'_>) -> Option<usize> {
        match self.0.get(*done) {
            None => Some(*done),
            Some(link) => (*link == child.link).then_some(done + 1),
        }
    }
}
