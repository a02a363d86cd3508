//! Finding plans by what was read.
//!
//! The plans of one component under one rule are grouped by what they read; within a group they
//! are found by the values. Nothing is said of the place: a component that reads nothing has one
//! plan however often it occurs.

use sapwood_geom::{Digest, Digester, FixedMap, fixed_state};
use sapwood_graph::{EnvId, Interrupted};
use smallvec::SmallVec;

use super::cache::{Cache, Plan, Target};
use super::pull::{Pull, Pushes};
use crate::column::Column;
use crate::log::Action;
use crate::rules::ReadKey;
use crate::slots::SlotReader;

/// More read sets than this of one component are worth a warning.
const MANY_READ_SETS: usize = 8;

/// Plans of earlier edits with equal reads that a new one is compared with: enough to find the
/// one before when an edit is taken back and made again.
const REMEMBERED: usize = 4;

/// The plans of one component under one rule.
#[derive(Default)]
pub(crate) struct PlanGroup {
    /// The edit that the plans answer to.
    pub(super) revision: u64,
    pub(super) sets: SmallVec<[ReadSet; 1]>,
    /// Plans of earlier edits by the digest of their reads, the latest first: what a new one is
    /// compared with.
    pub(super) outdated: Option<Box<FixedMap<Digest, SmallVec<[u32; REMEMBERED]>>>>,
}

/// The plans that read the same things.
pub(super) struct ReadSet {
    keys: Box<[ReadKey]>,
    plans: ByValues,
}

/// Plans by the digest of the values that they read.
enum ByValues {
    One(Digest, u32),
    Many(Box<FixedMap<Digest, u32>>),
}

impl ByValues {
    fn get(&self, values: Digest) -> Option<u32> {
        match self {
            Self::One(known, plan) => (*known == values).then_some(*plan),
            Self::Many(plans) => plans.get(&values).copied(),
        }
    }

    fn insert(&mut self, values: Digest, plan: u32) {
        match self {
            Self::Many(plans) => {
                plans.insert(values, plan);
            }
            Self::One(known, first) => {
                let mut plans = FixedMap::with_hasher(fixed_state());
                plans.insert(*known, *first);
                plans.insert(values, plan);
                *self = Self::Many(Box::new(plans));
            }
        }
    }

    fn plans(&self) -> SmallVec<[u32; 1]> {
        match self {
            Self::One(_, plan) => smallvec::smallvec![*plan],
            Self::Many(plans) => {
                let mut plans: SmallVec<[u32; 1]> = plans.values().copied().collect();
                plans.sort_unstable();
                plans
            }
        }
    }

    /// Forgets plans; tells whether any is left.
    fn retain(&mut self, keep: &impl Fn(u32) -> bool) -> bool {
        match self {
            Self::One(_, plan) => keep(*plan),
            Self::Many(plans) => {
                plans.retain(|_, plan| keep(*plan));
                !plans.is_empty()
            }
        }
    }
}

impl PlanGroup {
    /// Forgets plans; tells whether any is left.
    pub(super) fn retain(&mut self, keep: &impl Fn(u32) -> bool) -> bool {
        self.sets.retain(|set| set.plans.retain(keep));
        self.outdated = self.outdated.take().and_then(|mut outdated| {
            outdated.retain(|_, plans| {
                plans.retain(|plan| keep(*plan));
                !plans.is_empty()
            });
            (!outdated.is_empty()).then_some(outdated)
        });
        !(self.sets.is_empty() && self.outdated.is_none())
    }

    /// Lays the plans of an earlier edit aside. Older ones with equal reads are forgotten here;
    /// they are discarded when nothing shows them.
    fn outdate(&mut self, plans: &Column<Plan>) {
        let outdated =
            self.outdated.get_or_insert_with(|| Box::new(FixedMap::with_hasher(fixed_state())));
        for plan in self.sets.drain(..).flat_map(|set| set.plans.plans()) {
            let Some(row) = plans.get(plan) else { continue };
            let same = outdated.entry(digest_of_reads(row)).or_default();
            same.truncate(REMEMBERED - 1);
            same.insert(0, plan);
        }
    }
}

impl Pull<'_> {
    /// The plan of a component in an environment: found, or made.
    pub(super) fn plan_for(
        &mut self,
        target: Target,
        rule: u32,
        env: EnvId,
    ) -> Result<u32, Interrupted> {
        let revision = match target {
            Target::Authored(node) => self.graph.node(node).map_or(0, |node| node.edited),
            Target::View(_) | Target::Emitted(_) => 0,
        };
        if let Some(plan) = self.find(target, rule, revision, env) {
            let identity = self.cache.rules[rule as usize].identity;
            self.cache.log.note(Action::Reused, identity.kind, identity.name);
            if self.cache.is_checking {
                self.check(plan, env)?;
            }
            return Ok(plan);
        }
        let draft = self.init(target, rule, env)?;
        let new = self.publish(target, rule, revision, draft)?;
        let kept = self.equal_outdated(target, rule, new).unwrap_or(new);
        if kept != new {
            self.cache.remove_plan(new);
            self.cache.plans[kept].revision = revision;
        }
        self.enlist(target, rule, kept);
        Ok(kept)
    }

    /// The plan whose reads give the same values in `env`.
    fn find(&mut self, target: Target, rule: u32, revision: u64, env: EnvId) -> Option<u32> {
        let Cache { plans, groups, .. } = &mut *self.cache;
        let group = groups.get_mut(&(target, rule))?;
        if group.revision != revision {
            group.outdate(plans);
            group.revision = revision;
            return None;
        }
        let Self { cache, view, environments, .. } = self;
        let environments = environments.get_mut().unwrap_or_else(|broken| broken.into_inner());
        let pushes = Pushes { cache, view };
        let sets = &cache.groups.get(&(target, rule))?.sets;
        sets.iter().find_map(|set| {
            let mut reader = SlotReader::new(&pushes, environments, env);
            set.plans.get(digest_of(set.keys.iter().map(|key| key.read_again(&mut reader))))
        })
    }

    /// A plan of an earlier edit that reads the same values and is equal.
    fn equal_outdated(&mut self, target: Target, rule: u32, new: u32) -> Option<u32> {
        let group = self.cache.groups.get(&(target, rule))?;
        let plan = &self.cache.plans[new];
        let outdated = group.outdated.as_ref()?.get(&digest_of_reads(plan))?;
        let rows = outdated.iter().filter_map(|old| Some((*old, self.cache.plans.get(*old)?)));
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
    fn enlist(&mut self, target: Target, rule: u32, plan: u32) {
        let Cache { plans, groups, rules, .. } = &mut *self.cache;
        let row = &plans[plan];
        let values = digest_of(row.reads.iter().map(|read| read.value));
        let group = groups.entry((target, rule)).or_default();
        group.revision = row.revision;
        if let Some(same) =
            group.outdated.as_mut().and_then(|outdated| outdated.get_mut(&digest_of_reads(row)))
        {
            same.retain(|outdated| *outdated != plan);
        }
        let asks_same = |set: &&mut ReadSet| {
            let mut pairs = set.keys.iter().zip(&row.reads);
            set.keys.len() == row.reads.len() && pairs.all(|(key, read)| key.asks_same(&read.key))
        };
        if let Some(set) = group.sets.iter_mut().find(asks_same) {
            set.plans.insert(values, plan);
            return;
        }
        let keys = row.reads.iter().map(|read| read.key.clone()).collect();
        group.sets.push(ReadSet { keys, plans: ByValues::One(values, plan) });
        if group.sets.len() == MANY_READ_SETS + 1 {
            let names = |set: &ReadSet| set.keys.iter().map(ReadKey::name).collect::<Vec<_>>();
            tracing::warn!(
                rule = rules[rule as usize].identity.name,
                sets = ?group.sets.iter().map(names).collect::<Vec<_>>(),
                "a component reads different slots in many ways, which makes its plans hard to find",
            );
        }
    }
}

fn digest_of_reads(plan: &Plan) -> Digest {
    digest_of(plan.reads.iter().map(|read| Digest::of(&(&read.key, read.value))))
}

fn digest_of(values: impl Iterator<Item = Digest>) -> Digest {
    let mut digester = Digester::new();
    let mut n = 0u32;
    for value in values {
        digester.add(&value);
        n += 1;
    }
    if n == 0 { Digest(0) } else { digester.finish() }
}
