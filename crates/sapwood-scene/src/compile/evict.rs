//! Evicting: throwing away what no view shows.

use sapwood_geom::{FixedSet, fixed_state};
use sapwood_graph::SiteId;

use super::cache::{Cache, Link, Reachable, Target};
use crate::log::Action;

impl Cache {
    /// Whether so much may have become unreachable that looking for it is worth the time.
    pub(crate) fn may_be_bloated(&self, spare_plans: usize) -> bool {
        let is_more = |n: usize, n_reachable: usize| n > 2 * n_reachable + spare_plans;
        let Reachable { plans, sites } = self.n_reachable;
        is_more(self.plans.len(), plans) || is_more(self.sites.len(), sites)
    }

    /// Throws away every site, plan and emitted component that cannot be reached from `roots`.
    pub(crate) fn evict(&mut self, roots: impl Iterator<Item = SiteId>) {
        let mut sites: FixedSet<u32> = FixedSet::with_hasher(fixed_state());
        let mut stack: Vec<SiteId> = roots.collect();
        while let Some(site) = stack.pop() {
            if sites.insert(site.0) {
                for link in &self.sites[site.0].links {
                    if let Link::Site(child, _) = link {
                        stack.push(*child);
                    }
                }
            }
        }
        let mut plans: FixedSet<u32> = FixedSet::with_hasher(fixed_state());
        let mut stack: Vec<u32> = sites.iter().map(|site| self.sites[*site].plan).collect();
        while let Some(plan) = stack.pop() {
            if plans.insert(plan) {
                stack.extend(self.ingredients_of(plan));
            }
        }
        self.evict_sites(&sites);
        self.evict_plans(&plans);
        self.evict_emitted();
        self.n_reachable = Reachable { plans: plans.len(), sites: sites.len() };
    }

    fn evict_sites(&mut self, keep: &FixedSet<u32>) {
        let gone: Vec<u32> =
            self.sites.iter().map(|(site, _)| site).filter(|site| !keep.contains(site)).collect();
        for site in gone {
            if let Some(row) = self.sites.remove(site) {
                for index in row.indices {
                    self.site_index.remove(&index);
                }
            }
            self.counts.forget(SiteId(site));
        }
    }

    fn evict_plans(&mut self, keep: &FixedSet<u32>) {
        let gone: Vec<u32> =
            self.plans.iter().map(|(plan, _)| plan).filter(|plan| !keep.contains(plan)).collect();
        for plan in gone {
            if let Some(known) = self.rules.get(self.plans[plan].rule as usize) {
                self.log.note(Action::Discarded, &known.identity, self.plans[plan].target);
            }
            self.remove_plan(plan);
        }
        self.groups.retain(|_, group| group.retain(&|plan| keep.contains(&plan)));
    }

    fn evict_emitted(&mut self) {
        let mut keep: FixedSet<u32> = FixedSet::with_hasher(fixed_state());
        for (_, plan) in self.plans.iter() {
            let linked = plan.links.iter().map(|link| link.target);
            for target in linked.chain([plan.target]) {
                if let Target::Emitted(number) = target {
                    keep.insert(number);
                }
            }
        }
        self.emitted.retain(&keep);
    }
}
