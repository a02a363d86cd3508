//! The search for a path that a new edge would close into a cycle.
//!
//! It goes from both ends in turns, down from the would-be child and up from the would-be
//! parent, and ends as soon as either side is exhausted: joining a fresh node costs O(1)
//! whatever hangs on the other end.

use sapwood_geom::{FixedMap, fixed_state};

use super::edges::NO_EDGE;
use super::{Graph, NodeId};

impl Graph {
    /// The nodes on a path from `top` down to `bottom`, both included, if there is one.
    pub(super) fn path_between(&self, top: NodeId, bottom: NodeId) -> Option<Vec<NodeId>> {
        if top == bottom {
            return Some(vec![top]);
        }
        let mut down = Side::new(top);
        let mut up = Side::new(bottom);
        loop {
            let (from, edge) = down.next(|node| self.first_child_edge(node))?;
            down.edge = self.edges.next_sibling(edge);
            let child = self.edges.get(edge).child;
            if down.reach(child, from) && up.has(child) {
                return Some(join(&down, child, &up));
            }
            let (from, edge) = up.next(|node| self.first_parent_edge(node))?;
            let start = self.first_parent_edge(from)?;
            up.edge = self.edges.next_parent(edge, start);
            let parent = self.edges.get(edge).parent;
            if up.reach(parent, from) && down.has(parent) {
                return Some(join(&down, parent, &up));
            }
        }
    }

    fn first_child_edge(&self, node: NodeId) -> Option<u32> {
        Some(self.nodes[node].ends.first).filter(|edge| *edge != NO_EDGE)
    }

    fn first_parent_edge(&self, node: NodeId) -> Option<u32> {
        Some(self.nodes[node].ends.ring).filter(|edge| *edge != NO_EDGE)
    }
}

/// One side of the search: what was reached, and from where.
struct Side {
    came_from: FixedMap<NodeId, NodeId>,
    frontier: Vec<NodeId>,
    /// The node whose edges are being looked at, and the next of them.
    node: NodeId,
    edge: Option<u32>,
}

impl Side {
    fn new(start: NodeId) -> Self {
        let mut came_from = FixedMap::with_hasher(fixed_state());
        came_from.insert(start, start);
        Self { came_from, frontier: vec![start], node: start, edge: None }
    }

    /// The next edge to look at, with the node it starts from; nothing when all are done.
    fn next(&mut self, first: impl Fn(NodeId) -> Option<u32>) -> Option<(NodeId, u32)> {
        while self.edge.is_none() {
            self.node = self.frontier.pop()?;
            self.edge = first(self.node);
        }
        Some((self.node, self.edge?))
    }

    fn has(&self, node: NodeId) -> bool {
        self.came_from.contains_key(&node)
    }

    /// Notes that `node` was reached, and tells whether it is new.
    fn reach(&mut self, node: NodeId, from: NodeId) -> bool {
        let is_new = !self.has(node);
        if is_new {
            self.came_from.insert(node, from);
            self.frontier.push(node);
        }
        is_new
    }

    /// The nodes from the start to `node`, both included, last first.
    fn back_from(&self, node: NodeId) -> Vec<NodeId> {
        let mut path = vec![node];
        let mut at = node;
        while let Some(&from) = self.came_from.get(&at).filter(|from| **from != at) {
            path.push(from);
            at = from;
        }
        path
    }
}

fn join(down: &Side, meeting: NodeId, up: &Side) -> Vec<NodeId> {
    let mut path = down.back_from(meeting);
    path.reverse();
    path.extend(up.back_from(meeting).into_iter().skip(1));
    path
}
