//! What links push, and what a place must know for what is read below its links.

use sapwood_graph::SiteId;
use smallvec::SmallVec;

use super::cache::Cache;
use crate::PushMode;
use crate::rules::Scope;
use crate::slots::{
    Forced, ForcedDescending, ForcedSlots, LinkPushes, Pushed, SlotKey, SlotValue, forced_against,
};
use crate::view::View;

/// What links push, as environments ask for it.
pub(super) struct Pushes<'a> {
    pub(super) cache: &'a Cache,
    pub(super) view: &'a View,
}

impl Pushes<'_> {
    /// The pushes of a link, the innermost first.
    fn scopes(&self, site: SiteId, link: u32) -> impl Iterator<Item = &Scope> {
        let plan = self.cache.plan_of(site);
        Scope::outwards(&plan.scopes, plan.links[link as usize].scope)
    }

    /// The slots whose values above a link decide the value of `slot` below it.
    ///
    /// A push that replaces what is inherited makes the inherited value indifferent, unless that
    /// is forced. What is forced counts as one slot of its own, so that it need not be told for
    /// each slot that is pushed.
    pub(super) fn lifted(&self, site: SiteId, link: u32, slot: SlotKey) -> SmallVec<[SlotKey; 2]> {
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

impl LinkPushes for Pushes<'_> {
    fn push(&self, site: SiteId, link: u32, slot: SlotKey, mut is_forced: bool) -> Pushed<'_> {
        let scopes: SmallVec<[&Scope; 2]> =
            self.scopes(site, link).filter(|scope| scope.slot == slot).collect();
        let mut values: SmallVec<[&SlotValue; 2]> = SmallVec::new();
        for scope in scopes.into_iter().rev() {
            let counts = match scope.mode {
                PushMode::Inherit => false,
                PushMode::Protect => true,
                PushMode::Normal | PushMode::Force => !is_forced,
            };
            if counts {
                is_forced = scope.mode == PushMode::Force;
                if !slot.merges() {
                    values.clear();
                }
                values.push(&scope.value);
            }
        }
        match values.as_slice() {
            [] => Pushed::Nothing,
            [value] if !slot.merges() => Pushed::Replaced(value),
            values => Pushed::Merged(values.iter().copied().cloned().collect()),
        }
    }

    fn forced(&self, site: SiteId, link: u32, mut forced: ForcedSlots) -> ForcedSlots {
        let scopes: SmallVec<[&Scope; 4]> = self.scopes(site, link).collect();
        for scope in scopes.into_iter().rev() {
            match (scope.mode, forced.binary_search(&scope.slot)) {
                (PushMode::Force, Err(place)) => forced.insert(place, scope.slot),
                (PushMode::Protect, Ok(place)) => {
                    forced.remove(place);
                }
                (PushMode::Force | PushMode::Protect | PushMode::Normal | PushMode::Inherit, _) => {
                }
            }
        }
        forced
    }

    fn child_key(&self, site: SiteId, link: u32) -> u64 {
        self.cache.plan_of(site).links[link as usize].key
    }

    fn root_value(&self, slot: SlotKey) -> Option<SlotValue> {
        if let Some(kind) = slot.served() {
            let rule = self.view.rules.rule(kind)?;
            return Some(SlotValue::standing_for(rule.identity().digest()));
        }
        self.view.held.get(&slot.type_id()).map(|held| held.value.clone())
    }
}
