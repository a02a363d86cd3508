//! Scopes: what a plan pushes for the children behind its links, each in the scope around it.

use std::sync::Arc;

use smallvec::SmallVec;

use super::{ForcedSlots, PushMode, SlotKey, SlotValue};

/// "Below no push" in links and scopes.
pub(crate) const NO_SCOPE: u32 = u32::MAX;

/// One push, and the next one outside it.
pub(crate) struct Scope {
    pub(crate) outer: u32,
    pub(crate) slot: SlotKey,
    pub(crate) mode: PushMode,
    pub(crate) value: SlotValue,
}

/// All pushes above one link.
#[derive(Clone)]
pub(crate) struct LinkPushes {
    /// The scopes of the link's plan.
    scopes: Arc<[Scope]>,
    /// The innermost one above the link.
    innermost: u32,
}

/// The pushes of one slot at one link.
pub(crate) enum Pushed {
    /// The slot stays as it is.
    Nothing,
    /// The link replaces what is inherited.
    Replaced(SlotValue),
    /// The link merges these values into what is inherited, outermost first.
    Merged(SmallVec<[SlotValue; 2]>),
}

impl Scope {
    /// The scopes from the innermost, `scope`, outwards.
    pub(crate) fn outwards(scopes: &[Scope], scope: u32) -> impl Iterator<Item = &Scope> {
        let first = scopes.get(scope as usize);
        std::iter::successors(first, |scope| scopes.get(scope.outer as usize))
    }
}

impl LinkPushes {
    pub(crate) fn new(scopes: &Arc<[Scope]>, innermost: u32) -> Self {
        Self { scopes: Arc::clone(scopes), innermost }
    }

    /// From the innermost outwards.
    fn outwards(&self) -> impl Iterator<Item = &Scope> {
        Scope::outwards(&self.scopes, self.innermost)
    }

    /// What the link pushes of `slot`, where the inherited value is forced or not.
    pub(super) fn of(&self, slot: SlotKey, mut is_forced: bool) -> Pushed {
        let scopes: SmallVec<[&Scope; 2]> =
            self.outwards().filter(|scope| scope.slot == slot).collect();
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
            [value] if !slot.merges() => Pushed::Replaced(SlotValue::clone(value)),
            values => Pushed::Merged(values.iter().copied().cloned().collect()),
        }
    }

    /// The slots that are forced behind the link, where `forced` are before it.
    pub(super) fn forced(&self, mut forced: ForcedSlots) -> ForcedSlots {
        let scopes: SmallVec<[&Scope; 4]> = self.outwards().collect();
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
}
