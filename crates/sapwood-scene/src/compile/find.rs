//! Finding plans by what was read.
//!
//! The plans of one component under one rule are grouped by what they read; within a group they
//! are found by the values. Nothing is said of the place: a component that reads nothing has one
//! plan however often it occurs.

use sapwood_graph::{EnvId, Interrupted, SiteId};

use super::batch::Ahead;
use super::cache::{Cache, Plan, Target};
use super::pull::Pull;
use crate::log::Action;
use crate::rules::Memories;
use crate::slots::SlotReader;

impl Pull<'_> {
    /// The plan of a component in an environment: found, or made, of what its `init` came to
    /// `ahead` of its turn if it ran already.
    pub(super) fn plan_for(
        &mut self,
        target: Target,
        rule: u32,
        env: EnvId,
        previous: Option<SiteId>,
        ahead: Option<Ahead>,
    ) -> Result<u32, Interrupted> {
        let memories = self.memories(target, rule, previous);
        let revision = self.revision_of(target);
        // Also where it ran ahead: it may have been made since, as an ingredient of something.
        if let Some(plan) = self.find(target, rule, revision, env, &memories) {
            self.note_reused(plan, env)?;
            return Ok(plan);
        }
        let ahead = ahead.and_then(|ahead| ahead.outcome_for(target, rule, env, previous));
        let new = self.make(target, rule, revision, env, &memories, ahead)?;
        let kept = self.equal_outdated(target, rule, new).unwrap_or(new);
        if kept != new {
            self.cache.remove_plan(new);
            self.cache.plans[kept].revision = revision;
        }
        self.enlist(target, rule, kept);
        Ok(kept)
    }

    /// The edit that plans of a component must answer to.
    pub(super) fn revision_of(&self, target: Target) -> u64 {
        match target {
            Target::Authored(node) => self.graph.node(node).map_or(0, |node| node.edited),
            Target::View(_) | Target::Emitted(_) => 0,
        }
    }

    /// Notes that a plan answers to a place, and distrusts it in check mode.
    pub(super) fn note_reused(&mut self, plan: u32, env: EnvId) -> Result<(), Interrupted> {
        let Plan { target, rule, .. } = self.cache.plans[plan];
        let identity = self.cache.rules[rule as usize].identity;
        self.cache.log.note(Action::Reused, &identity, target);
        if self.cache.is_checking { self.check(plan, env) } else { Ok(()) }
    }

    /// What projections remember of the plan that stood at a place before.
    pub(super) fn memories(&self, target: Target, rule: u32, previous: Option<SiteId>) -> Memories {
        let Some(previous) = previous else { return Memories::default() };
        let plan = self.cache.plan_of(previous);
        let is_same = plan.target == target && plan.rule == rule;
        if is_same { Memories::of(&plan.reads) } else { Memories::default() }
    }

    /// The plan whose reads give the same values in `env`.
    pub(super) fn find(
        &mut self,
        target: Target,
        rule: u32,
        revision: u64,
        env: EnvId,
        memories: &Memories,
    ) -> Option<u32> {
        let Cache { plans, groups, .. } = &mut *self.cache;
        let group = groups.get_mut(&(target, rule))?;
        if group.revision != revision {
            group.outdate(|plan| Some(&*plans.get(plan)?.reads));
            group.revision = revision;
            return None;
        }
        self.cache
            .groups
            .get(&(target, rule))?
            .find(|key| key.read_again(&mut SlotReader::new(&self.environments, env), memories))
    }

    /// A plan of an earlier edit that reads the same values and is equal.
    fn equal_outdated(&mut self, target: Target, rule: u32, new: u32) -> Option<u32> {
        let group = self.cache.groups.get(&(target, rule))?;
        let plan = &self.cache.plans[new];
        let rows = group
            .outdated_like(&plan.reads)
            .iter()
            .filter_map(|old| Some((*old, self.cache.plans.get(*old)?)));
        let mut comparable = rows.filter(|(_, old)| old.reads == plan.reads);
        #[cfg(feature = "planted-faults")]
        if self.cache.stops_early {
            return comparable.next().map(|(old, _)| old);
        }
        let digest = std::cell::OnceCell::new();
        let is_equal = |old: &Plan| {
            self.cache.digest_of(old) == *digest.get_or_init(|| self.cache.digest_of(plan))
        };
        comparable.find(|(_, old)| is_equal(old)).map(|(old, _)| old)
    }

    /// Makes a plan findable by its reads.
    pub(super) fn enlist(&mut self, target: Target, rule: u32, plan: u32) {
        let Cache { plans, groups, rules, .. } = &mut *self.cache;
        let row = &plans[plan];
        let group = groups.entry((target, rule)).or_default();
        group.revision = row.revision;
        if let Some(sets) = group.enlist(plan, &row.reads) {
            tracing::warn!(
                rule = rules[rule as usize].identity.name,
                ?sets,
                "a component reads different slots in many ways, which makes its plans hard to find",
            );
        }
    }
}
