//! Revisions and marks.
//!
//! An edit marks the edited node and everything above it. A mark is the revision of the edit;
//! who brings sites up to date clears nothing, but remembers at which revision it did so. A mark
//! stops at a node that was marked since anybody last did: then all above it is marked too.

use super::{Graph, NodeId};

impl Graph {
    /// The number of the edit that is being made. The edits of a bulk scope share one, as long
    /// as nobody looks in between.
    pub(crate) fn next_revision(&mut self) -> u64 {
        if self.bulk.is_none() || self.pulled_at == self.revision {
            self.revision += 1;
        }
        self.revision
    }

    /// Notes that somebody is about to bring sites up to date with all edits made so far.
    pub(crate) fn pull(&mut self) {
        if let Some(edited) = &mut self.bulk {
            let edited = std::mem::take(edited);
            edited.into_iter().for_each(|id| self.mark(id));
        }
        self.pulled_at = self.revision;
    }

    /// Notes that a node was edited, and marks everything above it.
    pub(super) fn touch(&mut self, id: NodeId) {
        let revision = self.next_revision();
        if let Some(node) = self.nodes.get_mut(id) {
            node.edited = revision;
        }
        let driven = self.outdate_driven(id);
        match &mut self.bulk {
            Some(edited) => {
                edited.push(id);
                edited.extend(driven);
            }
            None => {
                self.mark(id);
                driven.into_iter().for_each(|id| self.mark(id));
            }
        }
    }

    /// Runs many edits as one: they share a revision, and marks climb when all are made.
    pub(crate) fn begin_bulk(&mut self) -> bool {
        if self.bulk.is_some() {
            return false;
        }
        self.revision += 1;
        self.bulk = Some(Vec::new());
        true
    }

    /// Ends what [`begin_bulk`](Self::begin_bulk) began.
    pub(crate) fn end_bulk(&mut self) {
        for id in self.bulk.take().unwrap_or_default() {
            self.mark(id);
        }
    }

    fn mark(&mut self, id: NodeId) {
        let revision = self.revision;
        let mut stack: smallvec::SmallVec<[NodeId; 16]> = smallvec::smallvec![id];
        while let Some(id) = stack.pop() {
            let Some(node) = self.nodes.get_mut(id) else { continue };
            if node.edited_below > self.pulled_at && node.edited_below >= node.edited {
                continue;
            }
            node.edited_below = revision;
            #[cfg(feature = "planted-faults")]
            if self.drops_marks && revision.is_multiple_of(5) {
                continue;
            }
            let ends = node.ends;
            for edge in self.edges.parents(ends) {
                stack.push(self.edges.get(edge).parent);
            }
            #[cfg(feature = "planted-faults")]
            if self.skips_askers {
                continue;
            }
            // Who asks for values may get others: it is as if it had been edited itself.
            for index in 0..self.values.askers(id).len() {
                let asker = self.values.askers(id)[index];
                if let Some(node) = self.nodes.get_mut(asker) {
                    node.edited = revision;
                }
                stack.push(asker);
            }
        }
    }
}
