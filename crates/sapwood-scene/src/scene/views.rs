//! Opening views, and setting what they look with.

use std::sync::Arc;

use sapwood_geom::{FixedMap, fixed_state};
use sapwood_graph::SiteId;

use super::Scene;
use crate::compile::{Link, NOT_CHECKED};
use crate::slots::{SlotKey, SlotValue};
use crate::view::{RootValue, RootValues, View};
use crate::{
    Budget, CancelToken, EditError, Held, Moving, NodeId, RuleSet, Slot, ViewError, ViewId,
};

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
        self.n_opened += 1;
        let generation = self.n_opened;
        let held = FixedMap::with_hasher(fixed_state());
        let root_values = Arc::new(RootValues { rules: rules.clone(), held });
        let number = self.views.insert(View {
            generation,
            root,
            root_values,
            authored_rules: Vec::new(),
            emitted_rules: Vec::new(),
            rules_since: 0,
            values_since: 0,
            moving: FixedMap::with_hasher(fixed_state()),
            moving_defaults: FixedMap::with_hasher(fixed_state()).into(),
            tick: 0,
            visited_tick: 0,
            root_site: SiteId(u32::MAX),
            budget: Budget::default(),
            cancel: CancelToken::default(),
        });
        self.views[number].root_site = self.cache.add_root_site(number, root, kind);
        Ok(ViewId { number, generation })
    }

    /// Closes a view; what only it showed is thrown away.
    ///
    /// # Errors
    /// When the view is closed already.
    pub fn close_view(&mut self, view: ViewId) -> Result<(), ViewError> {
        self.view_mut(view)?;
        self.views.remove(view.number);
        self.evict();
        Ok(())
    }

    pub(super) fn view_mut(&mut self, view: ViewId) -> Result<&mut View, ViewError> {
        let row = self.views.get_mut(view.number);
        row.filter(|row| row.generation == view.generation).ok_or(ViewError::Closed)
    }

    /// Replaces the rules of a view. What other rules now serve is compiled again when a
    /// traversal reaches it; plans of equal rules stay.
    ///
    /// # Errors
    /// When the view is closed.
    pub fn set_rules(&mut self, view: ViewId, rules: &RuleSet) -> Result<(), ViewError> {
        let revision = self.graph.next_revision();
        let view = self.view_mut(view)?;
        Arc::make_mut(&mut view.root_values).rules = rules.clone();
        view.authored_rules.clear();
        view.emitted_rules.clear();
        view.rules_since = revision;
        let root_site = view.root_site;
        self.distrust_root(root_site);
        Ok(())
    }

    /// Has the root's link checked again: its key says nothing of new values or new rules.
    fn distrust_root(&mut self, root_site: SiteId) {
        let root = &mut self.cache.sites[root_site.0];
        root.key.clear();
        for link in &mut root.links {
            if let Link::Site(_, checked) = link {
                *checked = NOT_CHECKED;
            }
        }
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
        self.change_held::<S>(view, Some((value, false)))
    }

    /// Sets a held slot above the root of a view against every push in the scene that does not
    /// protect itself: one view shows everything as wires, say, whatever style the scene asks
    /// for.
    ///
    /// # Errors
    /// When the view is closed.
    pub fn force_held<S: Slot<Rate = Held>>(
        &mut self,
        view: ViewId,
        value: S::Value,
    ) -> Result<(), ViewError> {
        self.change_held::<S>(view, Some((value, true)))
    }

    /// Lets a held slot above the root of a view have its default again.
    ///
    /// # Errors
    /// When the view is closed.
    pub fn clear_held<S: Slot<Rate = Held>>(&mut self, view: ViewId) -> Result<(), ViewError> {
        self.change_held::<S>(view, None)
    }

    fn change_held<S: Slot<Rate = Held>>(
        &mut self,
        view: ViewId,
        new: Option<(S::Value, bool)>,
    ) -> Result<(), ViewError> {
        let revision = self.graph.next_revision();
        let view = self.view_mut(view)?;
        let slot = SlotKey::of::<S>();
        let held = &mut Arc::make_mut(&mut view.root_values).held;
        match new {
            Some((value, is_forced)) => {
                let value = SlotValue::new::<S>(value);
                held.insert(slot.type_id(), RootValue { slot, value, is_forced });
            }
            None => {
                held.remove(&slot.type_id());
            }
        }
        view.values_since = revision;
        let root_site = view.root_site;
        self.distrust_root(root_site);
        Ok(())
    }

    /// Sets a moving slot of a view; runs no `init`, and allocates nothing where the slot was set
    /// before.
    ///
    /// # Errors
    /// When the view is closed.
    pub fn set_moving<S: Slot<Rate = Moving>>(
        &mut self,
        view: ViewId,
        value: S::Value,
    ) -> Result<(), ViewError> {
        let view = self.view_mut(view)?;
        match view.moving.get_mut(&SlotKey::of::<S>().type_id()) {
            Some(held) => held.set::<S>(value),
            None => {
                let value = SlotValue::new::<S>(value);
                view.moving.insert(SlotKey::of::<S>().type_id(), value);
            }
        }
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
        let row = self.views.get(view.number);
        let row = row.filter(|row| row.generation == view.generation);
        Ok(row.ok_or(ViewError::Closed)?.cancel.clone())
    }
}
