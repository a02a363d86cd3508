//! The plans of one component under one rule, grouped by what they read.

use sapwood_geom::{Digest, Digester, FixedMap, fixed_state};
use smallvec::SmallVec;

use crate::rules::{Read, ReadKey};

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
    sets: SmallVec<[ReadSet; 1]>,
    /// Plans of earlier edits by the digest of their reads, the latest first: what a new one is
    /// compared with.
    outdated: Option<Box<FixedMap<Digest, SmallVec<[u32; REMEMBERED]>>>>,
}

/// The plans that read the same things.
struct ReadSet {
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
    pub(super) fn outdate<'a>(&mut self, reads_of: impl Fn(u32) -> Option<&'a [Read]>) {
        let outdated =
            self.outdated.get_or_insert_with(|| Box::new(FixedMap::with_hasher(fixed_state())));
        for plan in self.sets.drain(..).flat_map(|set| set.plans.plans()) {
            let Some(reads) = reads_of(plan) else { continue };
            let same = outdated.entry(digest_of_reads(reads)).or_default();
            same.truncate(REMEMBERED - 1);
            same.insert(0, plan);
        }
    }

    /// The plan whose reads give the same values when they are read again.
    pub(super) fn find(
        &self,
        mut read_again: impl FnMut(&ReadKey) -> Option<Digest>,
    ) -> Option<u32> {
        self.sets.iter().find_map(|set| {
            let values: Option<SmallVec<[Digest; 8]>> =
                set.keys.iter().map(&mut read_again).collect();
            set.plans.get(digest_of(values?.into_iter()))
        })
    }

    /// Plans of earlier edits whose reads may equal these, the latest first.
    pub(super) fn outdated_like(&self, reads: &[Read]) -> &[u32] {
        let outdated = self.outdated.as_ref();
        outdated.and_then(|outdated| outdated.get(&digest_of_reads(reads))).map_or(&[], |v| v)
    }

    /// Makes a plan findable by its reads. When there are too many read sets for the first
    /// time, tells the names in each.
    pub(super) fn enlist(&mut self, plan: u32, reads: &[Read]) -> Option<Vec<Vec<&'static str>>> {
        let same = self.outdated.as_mut().and_then(|old| old.get_mut(&digest_of_reads(reads)));
        if let Some(same) = same {
            same.retain(|outdated| *outdated != plan);
        }
        let values = digest_of(reads.iter().map(|read| read.value));
        let asks_same = |set: &&mut ReadSet| {
            let mut pairs = set.keys.iter().zip(reads);
            set.keys.len() == reads.len() && pairs.all(|(key, read)| key.asks_same(&read.key))
        };
        if let Some(set) = self.sets.iter_mut().find(asks_same) {
            set.plans.insert(values, plan);
            return None;
        }
        let keys = reads.iter().map(|read| read.key.clone()).collect();
        self.sets.push(ReadSet { keys, plans: ByValues::One(values, plan) });
        let names = |set: &ReadSet| set.keys.iter().map(ReadKey::name).collect();
        let is_too_many = self.sets.len() == MANY_READ_SETS + 1;
        is_too_many.then(|| self.sets.iter().map(names).collect())
    }
}

fn digest_of_reads(reads: &[Read]) -> Digest {
    digest_of(reads.iter().map(|read| Digest::of(&(&read.key, read.value))))
}

fn digest_of(values: impl Iterator<Item = Digest>) -> Digest {
    let mut digester = Digester::new();
    let mut n = 0u32;
    for value in values {
        digester.add(&value);
        n += 1;
    }
    if n == 0 { Digest::from_bits(0) } else { digester.finish() }
}
