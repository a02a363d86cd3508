//! Visiting: live values follow the moving slots.
//!
//! Only sites that move, or have something moving below them, are gone into. No rule's `init`
//! runs, and nothing is allocated for a site.

use sapwood_graph::SiteId;

use super::pull::Pull;
use crate::log::Action;
use crate::rules::VisitContext;

impl Pull<'_> {
    /// Brings all live values below the root up to date with the view's tick.
    pub(super) fn visit_moving(&mut self) {
        if self.view.visited_tick == self.view.tick {
            return;
        }
        self.view.visited_tick = self.view.tick;
        self.cache.settling += 1;
        let settling = self.cache.settling;
        // Each site twice: on the way down for its live values, on the way up for its bound.
        let mut stack = vec![(self.view.root_site, false)];
        while let Some((site, is_done)) = stack.pop() {
            if is_done {
                if self.cache.sites[site.0].is_closed {
                    let bound = self.bound_of(site);
                    self.cache.sites[site.0].bound = bound;
                }
                continue;
            }
            let row = &mut self.cache.sites[site.0];
            if row.settled_in == settling || !row.is_moving {
                continue;
            }
            row.settled_in = settling;
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
        let plan = self.cache.plan_of(site);
        let cx = VisitContext { moving: &self.view.moving, defaults: &self.view.moving_defaults };
        if let Some(known) = self.cache.rules.get(plan.rule as usize) {
            known.rule.visit(self.cache.data_of(plan), &cx, &mut live);
            let (kind, rule) = (known.identity.kind, known.identity.name);
            self.cache.log.note(Action::Visited, kind, rule);
        }
        self.cache.sites[site.0].live = live;
    }
}
