//! Edges: for each child a ring of the edges that lead to it, for each parent a list in order.
//!
//! Both are linked through the edges themselves, so that an edge is taken out in O(1) however
//! many parents a child has and however many children a parent has.

use crate::NodeId;
use crate::column::Column;

/// "No edge" in the links below.
pub(crate) const NO_EDGE: u32 = u32::MAX;

/// An edge from a parent to a child.
#[derive(Debug)]
pub(crate) struct Edge {
    pub(crate) parent: NodeId,
    pub(crate) child: NodeId,
    /// The child's key within its parent: never used twice, kept when the order changes.
    pub(crate) key: u64,
    /// The ring of edges to the same child.
    ring_next: u32,
    ring_previous: u32,
    /// The list of edges from the same parent.
    list_next: u32,
    list_previous: u32,
}

/// The ends of a node's list of children, and one edge of its ring of parents.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ends {
    pub(crate) first: u32,
    pub(crate) last: u32,
    pub(crate) n_children: u32,
    pub(crate) ring: u32,
}

impl Ends {
    pub(crate) const NONE: Self =
        Self { first: NO_EDGE, last: NO_EDGE, n_children: 0, ring: NO_EDGE };
}

/// All edges of a scene.
#[derive(Debug)]
pub(crate) struct Edges(Column<Edge>);

impl Edges {
    pub(crate) fn new() -> Self {
        Self(Column::new())
    }

    pub(crate) fn get(&self, edge: u32) -> &Edge {
        &self.0[edge]
    }

    /// How many edges there are.
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    /// Puts a new edge before `before` in the parent's list, or at its end.
    pub(crate) fn link(
        &mut self,
        (parent, parent_ends): (NodeId, &mut Ends),
        before: u32,
        (child, ring): (NodeId, &mut u32),
        key: u64,
    ) -> u32 {
        let previous =
            if before == NO_EDGE { parent_ends.last } else { self.0[before].list_previous };
        let edge = self.0.insert(Edge {
            parent,
            child,
            key,
            ring_next: NO_EDGE,
            ring_previous: NO_EDGE,
            list_next: before,
            list_previous: previous,
        });
        match previous {
            NO_EDGE => parent_ends.first = edge,
            previous => self.0[previous].list_next = edge,
        }
        match before {
            NO_EDGE => parent_ends.last = edge,
            before => self.0[before].list_previous = edge,
        }
        parent_ends.n_children += 1;
        if *ring == NO_EDGE {
            self.0[edge].ring_next = edge;
            self.0[edge].ring_previous = edge;
            *ring = edge;
        } else {
            let next = *ring;
            let previous = self.0[next].ring_previous;
            self.0[edge].ring_next = next;
            self.0[edge].ring_previous = previous;
            self.0[next].ring_previous = edge;
            self.0[previous].ring_next = edge;
        }
        edge
    }

    /// Takes an edge out of the parent's list and of the child's ring.
    pub(crate) fn unlink(&mut self, edge: u32, parent_ends: &mut Ends, ring: &mut u32) {
        let Some(gone) = self.0.remove(edge) else { return };
        match gone.list_previous {
            NO_EDGE => parent_ends.first = gone.list_next,
            previous => self.0[previous].list_next = gone.list_next,
        }
        match gone.list_next {
            NO_EDGE => parent_ends.last = gone.list_previous,
            next => self.0[next].list_previous = gone.list_previous,
        }
        parent_ends.n_children -= 1;
        if gone.ring_next == edge {
            *ring = NO_EDGE;
        } else {
            self.0[gone.ring_next].ring_previous = gone.ring_previous;
            self.0[gone.ring_previous].ring_next = gone.ring_next;
            if *ring == edge {
                *ring = gone.ring_next;
            }
        }
    }

    /// The edge behind this one in its parent's list.
    pub(super) fn next_sibling(&self, edge: u32) -> Option<u32> {
        Some(self.0[edge].list_next).filter(|next| *next != NO_EDGE)
    }

    /// The edge behind this one in its child's ring, unless that is `start`.
    pub(super) fn next_parent(&self, edge: u32, start: u32) -> Option<u32> {
        Some(self.0[edge].ring_next).filter(|next| *next != start)
    }

    /// The edges from a parent, in order.
    pub(crate) fn children(&self, ends: Ends) -> impl Iterator<Item = u32> + '_ {
        let first = Some(ends.first).filter(|edge| *edge != NO_EDGE);
        std::iter::successors(first, |edge| self.next_sibling(*edge))
    }

    /// The edges to a child, in the order in which they were made.
    pub(crate) fn parents(&self, ends: Ends) -> impl Iterator<Item = u32> + '_ {
        let first = Some(ends.ring).filter(|edge| *edge != NO_EDGE);
        std::iter::successors(first, move |edge| self.next_parent(*edge, ends.ring))
    }
}
