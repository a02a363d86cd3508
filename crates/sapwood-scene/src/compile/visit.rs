//! Visiting: live values follow the moving slots.
//!
//! Only sites that move, or have something moving below them, are gone into. No rule's `init`
//! runs, and nothing is allocated for a site.

use std::panic::{AssertUnwindSafe, catch_unwind};

use sapwood_graph::{Diagnostic, SiteId};

use super::pull::Pull;
use crate::log::Action;
use crate::panic::words_of;
use crate::rules::VisitContext;

impl Pull<'_> {
    /// Brings all live values below the root up to date with the view's tick.
    pub(super) fn visit_moving(&mut self) {
        if self.view.visited_tick != self.view.tick {
            self.view.visited_tick = self.view.tick;
            self.visit_below(self.view.root_site);
        }
    }

    /// Brings all live values at and below a site up to date with the view's tick: for the root
    /// when the tick is new, for any other site when a link leads to it again that nothing led
    /// to while ticks went by.
    pub(super) fn visit_below(&mut self, site: SiteId) {
        let tick = self.view.tick;
        // Each site twice: on the way down for its live values, on the way up for its bound.
        let mut stack = vec![(site, false)];
        while let Some((site, is_done)) = stack.pop() {
            if is_done {
                if self.cache.sites[site.0].is_closed {
                    let bound = self.bound_of(site);
                    self.cache.sites[site.0].bound = bound;
                }
                continue;
            }
            let row = &mut self.cache.sites[site.0];
            if row.visited_tick == tick || !row.is_moving {
                continue;
            }
            row.visited_tick = tick;
            self.visit(site);
            stack.push((site, true));
            let first = stack.len();
            stack.extend(self.linked(site).map(|child| (child, false)));
            stack[first..].reverse();
        }
    }

    /// Brings the live values of one site up to date.
    pub(super) fn visit(&mut self, site: SiteId) {
        let row = &mut self.cache.sites[site.0];
        if row.live.is_empty() {
            return;
        }
        let mut live = std::mem::take(&mut row.live);
        let mut error = None;
        let plan = self.cache.plan_of(site);
        let cx = VisitContext { moving: &self.view.moving, defaults: &self.view.moving_defaults };
        if let Some(known) = self.cache.rules.get(plan.rule as usize) {
            let data = self.cache.data_of(plan);
            let (kind, rule) = (known.identity.kind, known.identity.name);
            let visit = || known.rule.visit(data, &cx, &mut live);
            if let Err(panic) = catch_unwind(AssertUnwindSafe(visit)) {
                let message = format!("visit of rule {rule} panicked: {}", words_of(&*panic));
                error = Some(Box::new(Diagnostic { kind, message }));
            }
            let (identity, target) = (known.identity, plan.target);
            self.cache.log.note(Action::Visited, &identity, target);
        }
        let row = &mut self.cache.sites[site.0];
        row.live = live;
        row.visit_error = error;
    }
}
