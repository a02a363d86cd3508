//! Views: who looks at a scene, with which rules.

use std::any::TypeId;
use std::sync::{Arc, Mutex};

use sapwood_geom::FixedMap;
use sapwood_graph::SiteId;

use crate::slots::{ForcedSlots, SlotKey, SlotValue};
use crate::{Budget, CancelToken, NodeId, RuleSet};

/// A view of a scene: a root, a rule set, and slot values above the root.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ViewId {
    pub(crate) number: u32,
    /// Numbers are used again after views are closed; generations are not.
    pub(crate) generation: u64,
}

pub(crate) struct View {
    pub(crate) generation: u64,
    pub(crate) root: NodeId,
    /// Shared with compiling, which reads them side by side.
    pub(crate) root_values: Arc<RootValues>,
    /// For each kind of authored component by its storage number, the number of the rule that
    /// serves it; `None` where no rule does. Kinds beyond the end have not been met yet.
    pub(crate) authored_rules: Vec<Option<u32>>,
    /// The same for kinds of emitted components.
    pub(crate) emitted_rules: Vec<Option<u32>>,
    /// The revision at which the rules were replaced.
    pub(crate) rules_since: u64,
    /// The revision at which a root value was set.
    pub(crate) values_since: u64,
    pub(crate) moving: FixedMap<TypeId, SlotValue>,
    pub(crate) moving_defaults: Mutex<FixedMap<TypeId, SlotValue>>,
    /// Grows whenever a moving slot is set.
    pub(crate) tick: u64,
    /// The tick for which live values were visited.
    pub(crate) visited_tick: u64,
    pub(crate) root_site: SiteId,
    pub(crate) budget: Budget,
    pub(crate) cancel: CancelToken,
}

/// What holds above a view's root: its rules, and values of held slots.
#[derive(Clone)]
pub(crate) struct RootValues {
    pub(crate) rules: RuleSet,
    pub(crate) held: FixedMap<TypeId, RootValue>,
}

/// The value of a held slot above a view's root.
#[derive(Clone)]
pub(crate) struct RootValue {
    pub(crate) slot: SlotKey,
    pub(crate) value: SlotValue,
    pub(crate) is_forced: bool,
}

impl RootValues {
    /// The slots that are forced above the root.
    pub(crate) fn forced(&self) -> ForcedSlots {
        let forced = self.held.values().filter(|held| held.is_forced);
        let mut slots: ForcedSlots = forced.map(|held| held.slot).collect();
        slots.sort_unstable();
        slots
    }

    /// The value of a slot, unless it is the default.
    pub(crate) fn value(&self, slot: SlotKey) -> Option<SlotValue> {
        if let Some(kind) = slot.served() {
            let rule = self.rules.rule(kind)?;
            return Some(SlotValue::standing_for(rule.identity().digest()));
        }
        self.held.get(&slot.type_id()).map(|held| held.value.clone())
    }
}
