//! The search for a path that a new edge would close into a cycle.
//!
//! It goes from both ends in turns, down from the would-be child and up from the would-be
//! parent, and ends as soon as either side is exhausted: joining a fresh node costs O(1)
//! whatever hangs on the other end.

use sapwood_geom::{FixedMap, fixed_state};
use sapwood_graph::Kind;

use super::edges::{Edge, NO_EDGE};
use super::{EditError, Graph, NodeId};

impl Graph {
    /// Refuses an edge from `parent` down to `child` that would close a cycle.
    pub(super) fn check_acyclic(&self, parent: NodeId, child: NodeId) -> Result<(), EditError> {
        self.path_between(child, parent).map_or(Ok(()), |path| Err(self.cycle(path)))
    }

    /// The error that names a cycle.
    pub(super) fn cycle(&self, path: Vec<NodeId>) -> EditError {
        let kind = |id| self.kind(id).map_or("?", Kind::name);
        EditError::Cycle { path: path.into_iter().map(|id| (id, kind(id))).collect() }
    }

    /// The nodes on a path from `top` down to `bottom`, both included, if there is one.
    fn path_between(&self, top: NodeId, bottom: NodeId) -> Option<Vec<NodeId>> {
        if top == bottom {
            return Some(vec![top]);
        }
        let mut down = Side::new(top);
        let mut up = Side::new(bottom);
        loop {
            let (from, way) = down.next(|node| self.first_way_down(node))?;
            down.way = self.next_way_down(from, way);
            let child = self.end_of(way, |edge| edge.child);
            if down.reach(child, from) && up.has(child) {
                return Some(join(&down, child, &up));
            }
            let (from, way) = up.next(|node| self.first_way_up(node))?;
            up.way = self.next_way_up(from, way);
            let parent = self.end_of(way, |edge| edge.parent);
            if up.reach(parent, from) && down.has(parent) {
                return Some(join(&down, parent, &up));
            }
        }
    }

    fn end_of(&self, way: Way, end: impl FnOnce(&Edge) -> NodeId) -> NodeId {
        match way {
            Way::Edge(edge) => end(self.edges.get(edge)),
            Way::Asked { other, .. } => other,
        }
    }

    fn first_way_down(&self, node: NodeId) -> Option<Way> {
        let first = Some(self.nodes[node].ends.first).filter(|edge| *edge != NO_EDGE);
        first.map(Way::Edge).or_else(|| self.asked_way_down(node))
    }

    fn next_way_down(&self, node: NodeId, way: Way) -> Option<Way> {
        let Way::Edge(edge) = way else { return None };
        let next = self.edges.next_sibling(edge);
        next.map(Way::Edge).or_else(|| self.asked_way_down(node))
    }

    fn asked_way_down(&self, node: NodeId) -> Option<Way> {
        self.values.asked_by(node).map(|other| Way::Asked { other, index: 0 })
    }

    fn first_way_up(&self, node: NodeId) -> Option<Way> {
        let first = Some(self.nodes[node].ends.ring).filter(|edge| *edge != NO_EDGE);
        first.map(Way::Edge).or_else(|| self.asked_way_up(node, 0))
    }

    fn next_way_up(&self, node: NodeId, way: Way) -> Option<Way> {
        match way {
            Way::Edge(edge) => {
                let next = self.edges.next_parent(edge, self.nodes[node].ends.ring);
                next.map(Way::Edge).or_else(|| self.asked_way_up(node, 0))
            }
            Way::Asked { index, .. } => self.asked_way_up(node, index + 1),
        }
    }

    fn asked_way_up(&self, node: NodeId, index: usize) -> Option<Way> {
        let asker = self.values.askers(node).get(index);
        asker.map(|other| Way::Asked { other: *other, index })
    }
}

/// A way from one node to another: an edge, or from a node into the value sub-graph that it
/// asks.
#[derive(Clone, Copy)]
enum Way {
    Edge(u32),
    Asked { other: NodeId, index: usize },
}

/// One side of the search: what was reached, and from where.
struct Side {
    came_from: FixedMap<NodeId, NodeId>,
    frontier: Vec<NodeId>,
    /// The node whose ways are being looked at, and the next of them.
    node: NodeId,
    way: Option<Way>,
}

impl Side {
    fn new(start: NodeId) -> Self {
        let mut came_from = FixedMap::with_hasher(fixed_state());
        came_from.insert(start, start);
        Self { came_from, frontier: vec![start], node: start, way: None }
    }

    /// The next way to look at, with the node it starts from; nothing when all are done.
    fn next(&mut self, first: impl Fn(NodeId) -> Option<Way>) -> Option<(NodeId, Way)> {
        while self.way.is_none() {
            self.node = self.frontier.pop()?;
            self.way = first(self.node);
        }
        Some((self.node, self.way?))
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
