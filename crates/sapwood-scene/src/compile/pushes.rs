//! What a place must know for what is read below its links.

use sapwood_geom::Digest;
use sapwood_graph::SiteId;
use smallvec::SmallVec;

use super::cache::Cache;
use crate::PushMode;
use crate::slots::{Forced, ForcedDescending, NO_SCOPE, Scope, SlotKey, forced_against};

/// What links push, as keys depend on it.
pub(super) struct Pushes<'a> {
    pub(super) cache: &'a Cache,
}

impl Pushes<'_> {
    /// The pushes of a link, the innermost first.
    fn scopes(&self, site: SiteId, link: u32) -> impl Iterator<Item = &Scope> {
        let plan = self.cache.plan_of(site);
        Scope::outwards(&plan.scopes, plan.links[link as usize].scope)
    }

    /// Calls `each` with the slots whose values above a link decide the values of the slots in
    /// `below`, the key of what is behind it; perhaps with some of them several times.
    pub(super) fn each_lifted(
        &self,
        site: SiteId,
        link: u32,
        below: &[(SlotKey, Digest)],
        mut each: impl FnMut(SlotKey),
    ) {
        if self.cache.plan_of(site).links[link as usize].scope == NO_SCOPE {
            below.iter().for_each(|(slot, _)| each(*slot));
        } else {
            let lifted = below.iter().flat_map(|(slot, _)| self.lifted(site, link, *slot));
            lifted.for_each(each);
        }
    }

    /// The slots that the key of a site lacks for what is behind a link of it, sorted.
    pub(super) fn missing(&self, site: SiteId, link: u32, child: SiteId) -> SmallVec<[SlotKey; 4]> {
        let key = &self.cache.sites[site.0].key;
        let mut missing: SmallVec<[SlotKey; 4]> = SmallVec::new();
        // Both keys are sorted, so what is looked for mostly stands right behind what was found.
        let mut next = 0;
        self.each_lifted(site, link, &self.cache.sites[child.0].key, |slot| {
            next = from(key, next, slot);
            if key.get(next).is_none_or(|(known, _)| *known != slot)
                && let Err(place) = missing.binary_search(&slot)
            {
                missing.insert(place, slot);
            }
        });
        missing
    }

    /// Removes from `slots`, which are sorted, those whose values decide what is behind a link.
    pub(super) fn remove_lifted(
        &self,
        site: SiteId,
        link: u32,
        child: SiteId,
        slots: &mut SmallVec<[SlotKey; 16]>,
    ) {
        let below = &self.cache.sites[child.0].key;
        if self.cache.plan_of(site).links[link as usize].scope == NO_SCOPE {
            let mut next = 0;
            slots.retain(|slot| {
                next = from(below, next, *slot);
                below.get(next).is_none_or(|(known, _)| known != slot)
            });
        } else {
            self.each_lifted(site, link, below, |slot| slots.retain(|known| *known != slot));
        }
    }

    /// The slots whose values above a link decide the value of `slot` below it.
    ///
    /// A push that replaces what is inherited makes the inherited value indifferent, unless that
    /// is forced. What is forced counts as one slot of its own, so that it need not be told for
    /// each slot that is pushed.
    fn lifted(&self, site: SiteId, link: u32, slot: SlotKey) -> SmallVec<[SlotKey; 2]> {
        let mut above: SmallVec<[SlotKey; 2]> = smallvec::smallvec![slot];
        if [SlotKey::of::<Forced>(), SlotKey::of::<ForcedDescending>()].contains(&slot) {
            // A forced value that is merged takes part of itself from above.
            let forces = |scope: &&Scope| scope.mode == PushMode::Force && scope.slot.merges();
            let merged = self.scopes(site, link).filter(forces).map(|scope| scope.slot);
            above.extend(merged.filter(|merged| forced_against(*merged) == slot));
            return above;
        }
        let forced = forced_against(slot);
        for scope in self.scopes(site, link).filter(|scope| scope.slot == slot) {
            match scope.mode {
                PushMode::Inherit => continue,
                PushMode::Normal | PushMode::Force if !above.contains(&forced) => {
                    above.push(forced);
                }
                PushMode::Normal | PushMode::Force | PushMode::Protect => {}
            }
            if !slot.merges() {
                above.retain(|above| *above != slot);
            }
        }
        #[cfg(feature = "planted-faults")]
        if self.cache.forgets_forced {
            above.retain(|above| *above != forced);
        }
        above
    }
}

/// The first place in a key whose slot is not below `slot`, looked for from `start` on.
fn from(key: &[(SlotKey, Digest)], start: usize, slot: SlotKey) -> usize {
    let is_behind = start > 0 && key[start - 1].0 >= slot;
    let start = if is_behind { 0 } else { start };
    start + key[start..].iter().take_while(|(known, _)| *known < slot).count()
}
