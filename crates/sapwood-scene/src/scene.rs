//! The scene: a semantic graph, the views that look at it, and everything compiled for them.
//!
//! What users call stands here, by concern; the work is done in `semantic` and `compile`.

mod edits;
mod explain;
mod occurrences;
mod traversals;
mod views;

use sapwood_graph::Kind;

use crate::column::Column;
use crate::compile::Cache;
use crate::log::Event;
use crate::semantic::Graph;
use crate::view::View;
use crate::{Component, Handle, NodeId, ViewId};

/// A semantic graph, the views that look at it, and everything compiled for them.
pub struct Scene {
    graph: Graph,
    cache: Cache,
    views: Column<View>,
    /// How many views were ever opened.
    n_opened: u64,
    #[cfg(feature = "planted-faults")]
    drops_reads: bool,
}

impl Default for Scene {
    fn default() -> Self {
        Self::new()
    }
}

impl Scene {
    /// An empty scene.
    pub fn new() -> Self {
        Self {
            graph: Graph::new(),
            cache: Cache::new(),
            views: Column::new(),
            n_opened: 0,
            #[cfg(feature = "planted-faults")]
            drops_reads: false,
        }
    }
}

/// Questions about the semantic graph.
impl Scene {
    /// A component, while it is in the scene, as the inputs make it that drive it; nothing where
    /// what drives it panicked, as views show nothing either.
    pub fn get<C: Component>(&self, handle: Handle<C>) -> Option<&C> {
        self.graph.effective(handle.id()).ok()?.downcast_ref()
    }

    /// A handle on a node, if it holds a component of type `C`.
    pub fn handle<C: Component>(&self, node: NodeId) -> Option<Handle<C>> {
        self.graph.component(node).ok()?.is::<C>().then(|| Handle::new(node))
    }

    /// The kind of a node, while it is in the scene.
    pub fn kind(&self, node: impl Into<NodeId>) -> Option<Kind> {
        self.graph.kind(node.into()).ok()
    }

    /// The children of a node in order.
    pub fn children(&self, node: impl Into<NodeId>) -> impl Iterator<Item = NodeId> + '_ {
        self.graph.children(node.into()).map(|(child, _)| child)
    }

    /// The parents of a node; one that holds it twice is told twice.
    pub fn parents(&self, node: impl Into<NodeId>) -> impl Iterator<Item = NodeId> + '_ {
        self.graph.parents(node.into())
    }

    /// All nodes, in no order that means anything.
    pub fn nodes(&self) -> impl Iterator<Item = NodeId> + '_ {
        self.graph.nodes()
    }

    /// How many nodes there are.
    pub fn n_nodes(&self) -> usize {
        self.graph.len()
    }

    /// The number of the latest edit.
    pub fn revision(&self) -> u64 {
        self.graph.revision
    }

    /// The first fault found in the scene's own structure, in words; for tests. Costs the whole
    /// graph.
    pub fn fault(&self) -> Option<String> {
        self.graph.fault()
    }
}

/// What the compiler does and keeps.
impl Scene {
    /// Turns the event log on or off.
    pub fn set_logging(&mut self, is_on: bool) {
        self.cache.log.is_on = is_on;
    }

    /// The events since the log was taken last.
    pub fn take_log(&mut self) -> Vec<Event> {
        std::mem::take(&mut self.cache.log.events)
    }

    /// Turns check mode on or off: each plan that is used again is made again and compared, and
    /// a difference panics naming the rule. For tests of rules.
    pub fn set_check_mode(&mut self, is_on: bool) {
        self.cache.is_checking = is_on;
    }

    /// How many plans are kept.
    pub fn n_plans(&self) -> usize {
        self.cache.plans.len()
    }

    /// How many sites are kept.
    pub fn n_sites(&self) -> usize {
        self.cache.sites.len()
    }

    /// Throws away everything compiled that no view shows.
    pub fn evict(&mut self) {
        self.cache.evict(self.views.iter().map(|(_, view)| view.root_site));
    }

    fn evict_if_bloated(&mut self, view: ViewId) {
        let spare = self.views.get(view.number).map_or(0, |view| view.budget.spare_plans);
        if self.cache.may_be_bloated(spare) {
            self.evict();
        }
    }

    /// Makes the compiler faulty in one way, to prove that tests notice.
    #[cfg(feature = "planted-faults")]
    pub fn plant(&mut self, fault: crate::PlantedFault) {
        match fault {
            crate::PlantedFault::DroppedMark => self.graph.drops_marks = true,
            crate::PlantedFault::DroppedRead => self.drops_reads = true,
            crate::PlantedFault::DroppedIngredient => self.cache.drops_ingredients = true,
            crate::PlantedFault::EarlyStop => self.cache.stops_early = true,
            crate::PlantedFault::ForgottenForce => self.cache.forgets_forced = true,
            crate::PlantedFault::KeptDriven => self.graph.keeps_driven = true,
            crate::PlantedFault::UnmarkedAsker => self.graph.skips_askers = true,
        }
    }
}
