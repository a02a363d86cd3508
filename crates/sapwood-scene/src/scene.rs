//! The scene: a semantic graph, the views that look at it, and everything compiled for them.
//!
//! This file holds what users call: edits first, then views, then traversals. The work is done
//! in `semantic` and `compile`.

use sapwood_geom::{Bound, FixedMap, fixed_state};
use sapwood_graph::{
    At, Counts, Diagnostic, DrawList, Everything, Interest, Interrupted, Kind, Order, Provide,
    SiteId, Supply, count, diagnostics, discover, draw_list, dump, walk,
};

use crate::column::Column;
use crate::compile::{Cache, Pull};
use crate::log::Event;
use crate::semantic::Graph;
use crate::slots::{SlotKey, SlotValue};
use crate::view::View;
use crate::{
    Attribute, Budget, CancelToken, Component, EditError, Handle, Held, Moving, NodeId, RuleSet,
    Slot, ViewError, ViewId,
};

/// How often a traversal begins again after room was made for it.
const MOST_ATTEMPTS: usize = 64;

/// A semantic graph, the views that look at it, and everything compiled for them.
pub struct Scene {
    graph: Graph,
    cache: Cache,
    views: Column<View>,
    #[cfg(feature = "planted-faults")]
    drops_reads: bool,
}

impl Default for Scene {
    fn default() -> Self {
        Self::new()
    }
}

/// Edits. A refused edit changes nothing.
impl Scene {
    /// An empty scene.
    pub fn new() -> Self {
        Self {
            graph: Graph::new(),
            cache: Cache::new(),
            views: Column::new(),
            #[cfg(feature = "planted-faults")]
            drops_reads: false,
        }
    }

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

/// Questions about the semantic graph.
impl Scene {
    /// A component, while it is in the scene.
    pub fn get<C: Component>(&self, handle: Handle<C>) -> Option<&C> {
        self.graph.component(handle.id()).ok()?.downcast_ref()
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

/// Views.
impl Scene {
    /// Opens a view of everything below `root` under a rule set.
    ///
    /// # Errors
    /// When the root is gone.
    pub fn open_view(
        &mut self,
        root: impl Into<NodeId>,
        rules: &RuleSet,
    ) -> Result<ViewId, EditError> {
        let root = root.into();
        let kind = self.graph.kind(root)?;
        let number = self.views.insert(View {
            root,
            rules: rules.clone(),
            authored_rules: Vec::new(),
            emitted_rules: Vec::new(),
            rules_since: 0,
            values_since: 0,
            held: FixedMap::with_hasher(fixed_state()),
            moving: FixedMap::with_hasher(fixed_state()),
            moving_defaults: FixedMap::with_hasher(fixed_state()).into(),
            tick: 0,
            visited_tick: 0,
            root_site: SiteId(u32::MAX),
            budget: Budget::default(),
            cancel: CancelToken::default(),
        });
        self.views[number].root_site = self.cache.add_root_site(number, root, kind);
        Ok(ViewId(number))
    }

    /// Closes a view; what only it showed is thrown away.
    ///
    /// # Errors
    /// When the view is closed already.
    pub fn close_view(&mut self, view: ViewId) -> Result<(), ViewError> {
        self.views.remove(view.0).ok_or(ViewError::Closed)?;
        self.evict();
        Ok(())
    }

    fn view_mut(&mut self, view: ViewId) -> Result<&mut View, ViewError> {
        self.views.get_mut(view.0).ok_or(ViewError::Closed)
    }

    /// Replaces the rules of a view. What other rules now serve is compiled again when a
    /// traversal reaches it; plans of equal rules stay.
    ///
    /// # Errors
    /// When the view is closed.
    pub fn set_rules(&mut self, view: ViewId, rules: &RuleSet) -> Result<(), ViewError> {
        let revision = self.graph.next_revision();
        let view = self.view_mut(view)?;
        view.rules = rules.clone();
        view.authored_rules.clear();
        view.emitted_rules.clear();
        view.rules_since = revision;
        Ok(())
    }

    /// Sets a held slot above the root of a view.
    ///
    /// # Errors
    /// When the view is closed.
    pub fn set_held<S: Slot<Rate = Held>>(
        &mut self,
        view: ViewId,
        value: S::Value,
    ) -> Result<(), ViewError> {
        let revision = self.graph.next_revision();
        let view = self.view_mut(view)?;
        view.held.insert(SlotKey::of::<S>().type_id(), SlotValue::new::<S>(value));
        view.values_since = revision;
        let root_site = view.root_site;
        self.cache.sites[root_site.0].key.clear();
        Ok(())
    }

    /// Sets a moving slot of a view; runs no `init`.
    ///
    /// # Errors
    /// When the view is closed.
    pub fn set_moving<S: Slot<Rate = Moving>>(
        &mut self,
        view: ViewId,
        value: S::Value,
    ) -> Result<(), ViewError> {
        let view = self.view_mut(view)?;
        view.moving.insert(SlotKey::of::<S>().type_id(), SlotValue::new::<S>(value));
        view.tick += 1;
        Ok(())
    }

    /// Sets how much may be compiled for a view.
    ///
    /// # Errors
    /// When the view is closed.
    pub fn set_budget(&mut self, view: ViewId, budget: Budget) -> Result<(), ViewError> {
        let revision = self.graph.next_revision();
        let view = self.view_mut(view)?;
        if view.budget.emitted_depth != budget.emitted_depth {
            // What failed for its depth, or did not, is looked at again.
            view.rules_since = revision;
        }
        view.budget = budget;
        Ok(())
    }

    /// The token by which any thread can stop compiling for a view.
    ///
    /// # Errors
    /// When the view is closed.
    pub fn cancel_token(&self, view: ViewId) -> Result<CancelToken, ViewError> {
        Ok(self.views.get(view.0).ok_or(ViewError::Closed)?.cancel.clone())
    }
}

/// Traversals. Each compiles what it needs first.
impl Scene {
    /// The view's side of the opening between scene and walks, for foreign traversals.
    ///
    /// # Errors
    /// When the view is closed.
    pub fn supply(&mut self, view: ViewId) -> Result<impl Provide + '_, ViewError> {
        self.pull(view)
    }

    fn pull(&mut self, view: ViewId) -> Result<Pull<'_>, ViewError> {
        let row = self.views.get_mut(view.0).ok_or(ViewError::Closed)?;
        self.graph.pull();
        Ok(Pull::new(
            &self.graph,
            &mut self.cache,
            row,
            view.0,
            #[cfg(feature = "planted-faults")]
            self.drops_reads,
        ))
    }

    /// Compiles what `interest` asks for, walks over it in `order` and calls `visitor` for each
    /// node.
    ///
    /// # Errors
    /// When the view is closed, or compiling was interrupted; nothing is walked then.
    pub fn traverse<I: Interest>(
        &mut self,
        view: ViewId,
        order: Order,
        interest: &I,
        visitor: &mut dyn FnMut(&At<'_, I::State>),
    ) -> Result<(), ViewError> {
        self.discover(view, interest)?;
        walk(&self.pull(view)?, order, interest, visitor);
        self.evict_if_bloated(view);
        Ok(())
    }

    /// Compiles what `interest` asks for. Where a budget runs out, what no view shows any more
    /// makes room, as long as there is any.
    fn discover<I: Interest>(&mut self, view: ViewId, interest: &I) -> Result<(), ViewError> {
        for _ in 0..MOST_ATTEMPTS {
            match discover(&mut self.pull(view)?, interest) {
                Err(Interrupted::Exhausted { .. }) if self.make_room() => {}
                outcome => return Ok(outcome?),
            }
        }
        Ok(discover(&mut self.pull(view)?, interest)?)
    }

    /// Throws away what no view shows, and tells whether that left more of any budget.
    fn make_room(&mut self) -> bool {
        let before = (self.cache.triangles, self.cache.n_parts);
        self.evict();
        before != (self.cache.triangles, self.cache.n_parts)
    }

    /// Compiles everything and reads the result.
    fn complete<R>(
        &mut self,
        view: ViewId,
        read: impl FnOnce(&mut Pull<'_>) -> R,
    ) -> Result<R, ViewError> {
        self.discover(view, &Everything)?;
        let result = read(&mut self.pull(view)?);
        self.evict_if_bloated(view);
        Ok(result)
    }

    /// The bound of everything in a view, in the root's frame. O(1) when nothing has changed.
    ///
    /// # Errors
    /// When the view is closed, or compiling was interrupted.
    pub fn bounds(&mut self, view: ViewId) -> Result<Bound, ViewError> {
        self.complete(view, |pull| {
            let (_, root) = pull.root();
            pull.bound(root).copied().unwrap_or(Bound::EMPTY)
        })
    }

    /// How many components and parts of each kind a view shows, every occurrence counted.
    ///
    /// # Errors
    /// When the view is closed, or compiling was interrupted.
    pub fn count(&mut self, view: ViewId) -> Result<Counts, ViewError> {
        self.complete(view, |pull| {
            let mut memo = pull.take_counts();
            let counts = count(&*pull, &mut memo);
            pull.give_counts(memo);
            counts
        })
    }

    /// What a view draws, in at most `max_rows` rows.
    ///
    /// # Errors
    /// When the view is closed, compiling was interrupted, or there are more rows.
    pub fn draw_list(&mut self, view: ViewId, max_rows: usize) -> Result<DrawList, ViewError> {
        Ok(self.complete(view, |pull| draw_list(&*pull, max_rows))??)
    }

    /// What a view compiled to, as stable text of at most `max_lines` lines.
    ///
    /// # Errors
    /// When the view is closed, or compiling was interrupted.
    pub fn dump(&mut self, view: ViewId, max_lines: usize) -> Result<String, ViewError> {
        self.complete(view, |pull| dump(&*pull, max_lines))
    }

    /// What could not be compiled, each with the links that lead there; at most `limit`.
    ///
    /// # Errors
    /// When the view is closed, or compiling was interrupted.
    pub fn diagnostics(
        &mut self,
        view: ViewId,
        limit: usize,
    ) -> Result<Vec<(Vec<u32>, Diagnostic)>, ViewError> {
        self.complete(view, |pull| diagnostics(&*pull, limit))
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
        let spare = self.views.get(view.0).map_or(0, |view| view.budget.spare_plans);
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
            crate::PlantedFault::EarlyStop => self.cache.stops_early = true,
        }
    }
}
